"""Friction that weakens with the speed, and drag that rises.

Stribeck friction falls from mu_s to mu_d as the speed passes v_s, with an exponent gamma. The values known for it
come from elements of one degree in Python, which share no code with the program. Friction that weakens and drag that
rises may be the same force: as tau -> 0 both must give the same numbers, those of white noise, which are integrals
over a known density.

The upwind scheme must halve its error on a grid twice as fine, and simulation solves nothing. For v_s -> 0 and for large v_s the values must tend to those of
Coulomb friction with mu_d and with mu_s.

usage: python3 validation/weakening/run.py [--quick] [--program build/stickslip] [--report FOLDER]

--quick simulates 10^4 excursions instead of 3*10^5, and takes fewer speeds.
"""

import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from entry import Entry, subplots
from harness import difference, worse
from stickslip.plots.style import COLOURS
from stickslip.plots.sweeping import curve

SCENE = {"mu_s": 1, "mu_d": 0.5, "tau": 1, "delta": 0.25, "friction": "stribeck"}
# Elements of one degree without any grading at v*, in Python.
KNOWN = {0.1: {"P_stick": 0.42027641456, "mean_slide": 1.19379291929, "E_V2": 0.15566674581,
               "E_absV": 0.22351933315},
         0.02: {"P_stick": 0.34589070474, "mean_slide": 1.65983452192, "E_V2": 0.17162127108,
                "E_absV": 0.25442017700}}
# Density exp(-int (F - b)) of F - b = 0.5 - 0.3 (1 - exp(-10 v)) + v, by quadrature.
WHITE = {"E_V2": 0.851842127, "E_absV": 0.727691750}
RISING = {"mu_s": 0.5, "mu_d": 0.5, "drag": "expression",
          "drag_expression": "0.3*(1-exp(-10*abs(v)))*sign(v) - v"}
WEAKENING = {"mu_s": 0.5, "mu_d": 0.2, "friction": "stribeck", "stribeck_velocity": 0.1}
SIMULATED = {"gamma = 1": {"stribeck_velocity": 0.1},
             "gamma = 2, bias, by direction": {"stribeck_velocity": 0.2, "stribeck_exponent": 2,
                                               "bias": 0.2, "mu_s_minus": 1.3}}
ASKED = "sticking,moments,averages,noise_law,entry_law,spectrum,laplace"
SLOW = {"mu_s": 0.5, "mu_d": 0.1, "tau": 10, "delta": 0.05, "friction": "stribeck",
        "stribeck_velocity": 0.05}


def known(entry):
    rows, found = [], []
    for velocity, values in KNOWN.items():
        results = entry.run(**SCENE, stribeck_velocity=velocity, accuracy=1e-10)["results"]
        for key, value in values.items():
            found.append(abs(results[key]["value"] - value))
            rows.append((f"{velocity}", key, f"{results[key]['value']:.14g}", f"{value:.12g}"))
    entry.table("Stribeck friction and values known for it: mu_d = 1/2, delta = 1/4, linear drag",
                ("v_s", "quantity", "found", "known"), rows)
    entry.claim("from known values", worse(*found), 1e-9)


def white_noise(entry):
    """Errors are of the order of tau, tau^2 and so on."""
    rows, found = [], []
    for name, scene in (("drag that rises", RISING), ("friction that weakens", WEAKENING)):
        runs = [entry.run(**scene, tau=tau, delta=0.125 / tau**0.5, quantities="moments",
                          accuracy=1e-7)["results"] for tau in (4.0**-n for n in range(3, 7))]
        for key, expected in WHITE.items():
            values = [r[key]["value"] for r in runs]
            limits = values
            for power in (4, 16, 64):
                limits = [(power * b - a) / (power - 1) for a, b in zip(limits, limits[1:])]
            found.append(difference(limits[-1], expected))
            rows.append((name, key, *values, limits[-1], expected))
    entry.table("The same force as drag and as friction, tau -> 0",
                ("scene", "quantity", "tau = 4^-3", "4^-4", "4^-5", "4^-6", "extrapolated", "in white noise"), rows)
    entry.claim("limits from those in white noise, relative", worse(*found), 1e-3)


def methods(entry):
    """The same numbers by another scheme, and by simulation."""
    scene = {**SCENE, "stribeck_velocity": 0.1}
    exact = entry.run(**scene, quantities="sticking,moments", accuracy=1e-8)["results"]
    upwind = [entry.run(**scene, scheme="upwind", p=p)["results"]["P_stick"]["value"]
              - exact["P_stick"]["value"] for p in (128, 256)]
    entry.claim("upwind differences: error at p = 256 over that at 128, from 1/2",
                abs(upwind[1] / upwind[0] - 0.5), 0.05)
    excursions = 10**4 if entry.quick else 3 * 10**5
    for name, options in SIMULATED.items():
        asked = {**SCENE, **options, "quantities": ASKED, "omega": "0,1,5", "lambda": "0.5,2"}
        computed = entry.run(**asked, accuracy=1e-7)["results"]
        simulated = entry.run(**asked, route="monte_carlo", excursions=excursions)["results"]
        beside = [(computed[k]["value"], computed[k]["error"], s) for k, s in simulated.items()
                  if "ci95" in s and not isinstance(s["value"], list) and k in computed]
        entry.simulated(f"simulations, {name}", beside)


def draw(swept, ends):
    """P_stick and E[V^2] against the speed within which friction falls, between their limits."""
    figure, axes = subplots(figsize=(6.4, 3.8))
    for n, (key, label) in enumerate((("P_stick", "probability of sticking"), ("E_V2", "$E[V^2]$"))):
        curve(axes, swept.coords["stribeck_velocity"], swept[key].value, swept[key].error, n, label)
        for end, place in zip(ends, ((0, 0.2), (0.8, 1))):
            axes.axhline(end[key]["value"], *place, color=COLOURS[n], linewidth=0.8)
    axes.set(xlabel="$v_s$  [velocity]", xscale="log", ylim=(0, None))
    axes.legend(loc="best")
    return figure


def between(entry):
    """From Coulomb friction to a dynamic friction of mu_s."""
    count = 5 if entry.quick else 41
    ends = [entry.run(mu_s=1, mu_d=mu_d, delta=0.25, accuracy=1e-8)["results"] for mu_d in (0.5, 1)]
    options = {k: v for k, v in SCENE.items() if k != "tau"}
    swept = entry.results(**options, stribeck_velocity=1, accuracy=1e-7,
                          sweep_stribeck_velocity=f"1e-4:1e3:{count}:log")
    far = [difference(swept[key].value[place], end[key]["value"])
           for place, end in ((0, ends[0]), (-1, ends[1])) for key in ("P_stick", "E_V2")]
    entry.claim("v_s = 1e-4 from Coulomb friction, v_s = 1e3 from mu_d = mu_s, relative",
                worse(*far), 2e-3)
    entry.figure(draw(swept, ends), "weakening.png", "P_stick and E[V^2] as friction falls later and "
                 "later, from Coulomb friction (left) to mu_d = mu_s (right).")


def distribution(entry):
    entry.drawn("density", "slow.png", "The stationary distribution in slow noise (tau = 10) "
                "under friction that weakens: bodies move at speeds of their own, and leave those "
                "between them and rest.", entry.results(**SLOW, quantities="density,sticking", accuracy=1e-8))


def main():
    entry = Entry(__doc__, "beyond the paper")
    known(entry)
    white_noise(entry)
    methods(entry)
    between(entry)
    distribution(entry)
    entry.end()


main()
