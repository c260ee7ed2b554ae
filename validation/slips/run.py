"""Slips, first passages and displacement: closed forms, white noise, other formulas, simulation.

Path lengths of sliding phases, times to reach a velocity, and the displacement in a given time are compared with what
they were not made from. In telegraph noise without drag they have closed forms. In white noise without drag (compared
in the long form of the report) the mean first passage to |V| = w is (e^(mu w) - 1 - mu w)/mu^2 and the diffusivity
5/mu^4.

Other formulas lead to the same numbers: mean_slip = E_absV mean_excursion, the variance of the displacement grows at
the rate S_0, its mean is E_V t, and it is twice the integral of (t - s) C(s) over s, where C is the autocorrelation
of the velocity, computed by itself. Simulation follows paths.

usage: python3 validation/slips/run.py [--quick] [--program build/stickslip] [--report FOLDER]

--quick simulates a tenth of the excursions, leaves white noise out, and counts costs at a larger
delta.
"""

import math
import pathlib
import sys

import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from entry import Entry, deviation
from harness import difference, worse

# One value of X drives, the other holds: V > 0 rises with P, falls with Q, at jumps with the rate KAPPA.
TELEGRAPH = {"noise": "telegraph", "telegraph_amplitude": 1, "telegraph_rate": 1.7, "bias": 0.3, "mu_s": 1,
             "mu_d": 0.5, "drag": "none"}
P, Q, KAPPA = 1 + 0.3 - 0.5, 0.5 + 1 - 0.3, 1.7
SPEEDS = (0.2, 0.6, 3, 8)
SCENES = {"symmetric": {"mu_d": 0.45, "delta": 0.25},
          "with a bias": {"mu_d": 0.6, "delta": 0.3, "bias": 0.25},
          "weakening friction": {"friction": "stribeck", "stribeck_velocity": 0.3, "mu_d": 0.5, "delta": 0.25,
                                 "drag_coefficient": 0.5}}
ASKED = {"quantities": "slip,peak,displacement", "velocity": "0.3,1,2", "distance": "0.05,0.3,1,4",
         "inverse_distance": "0.2,1,5", "time": "0.3,2,20"}


def text_of(numbers):
    return ",".join(repr(float(n)) for n in numbers)


def telegraph_peak(w):
    """P(peak > w) = (Q - P)/(Q exp(r w) - P), r = KAPPA (1/P - 1/Q)."""
    return (Q - P) / (Q * math.exp(KAPPA * (1 / P - 1 / Q) * w) - P)


def telegraph_passage(w):
    """Mean time to V = w from the start of a sliding phase: P u' = KAPPA D - 1, u(w) = 0 for u(v) with X driving, and
    D' = r D - (1/P + 1/Q), D(0) = -1/KAPPA for what it has more than with X holding."""
    r, s = KAPPA * (1 / P - 1 / Q), 1 / P + 1 / Q
    return (w - KAPPA * (s * w / r - (1 / KAPPA + s / r) * math.expm1(r * w) / r)) / P


def telegraph_lengths():
    """E[S] and E[S^2]: polynomials m in v with P m+' = KAPPA (m+ - m-) - f+, -Q m-' = KAPPA (m- - m+) - f-,
    m-(0) = 0, first for f = v, then for f = 2 v m."""
    def solved(f):
        n = f.shape[1] + 1  # coefficients by power; the highest has one power more than f
        a, b = numpy.zeros((2 * n + 3, 2 * n)), numpy.zeros(2 * n + 3)
        for side, (rate, row) in enumerate(((P, 0), (-Q, n + 1))):
            for k in range(n):
                if k:
                    a[row + k - 1, side * n + k] += rate * k
                a[row + k, side * n + k] -= KAPPA
                a[row + k, (1 - side) * n + k] += KAPPA
            b[row:row + n - 1] = -f[side]
        a[-1, n] = 1
        return numpy.linalg.lstsq(a, b, rcond=None)[0].reshape(2, n)
    once = solved(numpy.array([[0, 1.0]] * 2))
    twice = solved(numpy.hstack([numpy.zeros((2, 1)), 2 * once]))
    return once[0, 0], twice[0, 0]


def telegraph(entry):
    found = entry.run(**TELEGRAPH, **ASKED | {"velocity": text_of(SPEEDS), "quantities": "slip,peak,sticking"},
                      accuracy=1e-10)["results"]
    length, square = telegraph_lengths()
    known = {"mean_slip": length, "var_slip": square - length**2, "mean_slip_net": length,
             "var_slip_net": square - length**2}
    rows = [(key, "", found[key]["value"], value, difference(found[key]["value"], value))
            for key, value in known.items()]
    for n, w in enumerate(SPEEDS):
        passage = telegraph_passage(w)
        for key, value in (("P_peak", telegraph_peak(w)), ("mean_first_passage", passage),
                           ("mean_first_passage_rest", passage + 0.5 / KAPPA)):
            rows.append((key, f"{w:g}", found[key]["value"][n], value, difference(found[key]["value"][n], value)))
    entry.table("Telegraph noise without drag by closed forms: a = 1, kappa = 1.7, mu_s = 1, mu_d = 1/2, bias 0.3",
                ("quantity", "w", "found", "closed form", "relative difference"), rows)
    entry.claim("telegraph noise against closed forms, relative", worse(*(row[-1] for row in rows)), 1e-9)


def white_noise(entry):
    """b = 0, mu_s = mu_d = 1; corrections are powers of tau^1/2."""
    taus = [0.04 / 2**n for n in range(6)]
    speeds, rows = (1, 2), []
    for tau in taus:
        found = entry.run(drag="none", mu_d=1, tau=tau, delta=0.5, quantities="spectrum,peak,displacement",
                          velocity=text_of(speeds), time="1e3,2e3", start="rest", accuracy=1e-5)["results"]
        early, late = found["displacement_variance"]["value"]
        rows.append([*found["mean_first_passage_rest"]["value"], found["S_0"]["value"] / 2, (late - early) / 2e3])
    known = [math.exp(w) - 1 - w for w in speeds] + [5, 5]
    powers = numpy.vander(numpy.sqrt(taus), increasing=True)
    limit = numpy.linalg.solve(powers, numpy.array(rows))[0]
    entry.table("Limits in white noise: b = 0, mu = 1", (
        "tau", "time to |V| = 1", "time to |V| = 2", "S_0/2", "(Var x(2 t) - Var x(t))/(2 t), t = 1000"), [
            *([tau, *row] for tau, row in zip(taus, rows)), ["0", *limit], ["known", *known]])
    entry.claim("(e^(mu w) - 1 - mu w)/mu^2 and 5/mu^4 as tau -> 0, relative",
                worse(*map(difference, limit, known)), 1e-3)


def other_formulas(entry, name, scene):
    wanted = {"time": "0.3,2,200,400", "quantities": "sticking,moments,spectrum,slip,displacement"}
    found = entry.run(**scene, **wanted, start="stationary", accuracy=1e-8)["results"]
    value = {key: result["value"] for key, result in found.items()}
    times, variance = found["displacement_variance"]["time"], value["displacement_variance"]
    entry.claim(f"mean_slip = E_absV mean_excursion, {name}, relative",
                difference(value["mean_slip"], value["E_absV"] * value["mean_excursion"]), 1e-12)
    entry.claim(f"growth of the variance by S_0, {name}, relative",
                difference((variance[-1] - variance[-2]) / (times[-1] - times[-2]), value["S_0"]), 1e-6)
    entry.claim(f"mean displacement E_V t, {name}, relative to E_absV t", worse(*(
        abs(mean - value["E_V"] * t) / (value["E_absV"] * t)
        for t, mean in zip(times, value["displacement_mean"]))), 1e-7)
    t = times[1]
    nodes, weights = numpy.polynomial.legendre.leggauss(24)
    s = t * (nodes + 1) / 2
    c = entry.run(**scene, quantities="autocorrelation", time=text_of(s), accuracy=1e-8)["results"]["C_vv"]
    entry.claim(f"2 int (t - s) C(s) ds, {name}, relative", difference(
        t * ((t - s) * c["value"] * weights).sum(), variance[1]), 1e-6)
    rest = entry.run(**scene, quantities="displacement", time="200,400", start="rest", accuracy=1e-7)["results"]
    early, late = rest["displacement_variance"]["value"]
    entry.claim(f"growth of the variance by S_0 from rest, {name}, relative",
                difference((late - early) / 200, value["S_0"]), 1e-5)


def simulation(entry, name, scene):
    found = entry.results(**scene, **ASKED, accuracy=1e-4)
    count = 5 * 10**3 if entry.quick else 5 * 10**4
    result = entry.results(**scene, **ASKED, route="monte_carlo", excursions=count)
    found.name, result.name = "computed", "simulated"
    beside = []
    for key, simulated in result.items():
        if key == "f_slip":  # a histogram: its cells are no points
            continue
        for value, mean, ends in zip(*map(numpy.atleast_1d, (found[key].value, simulated.value)),
                                     numpy.atleast_2d(simulated.ci95)):
            if value and numpy.isfinite(ends).all():
                beside.append((value, 0, {"value": mean, "ci95": ends}))
    entry.claim(f"largest |z| of {len(beside)} simulated values, {name}",
                worse(*(abs(deviation(*one)) for one in beside)), 4.5)
    entry.drawn("slips", f"{name}.png".replace(" ", "_"), f"Slips, {name}: lines computed, marks simulated.",
                found, result)


def costs(entry):
    """In units of the stationary distribution, at one degree."""
    halvings = 4 if entry.quick else 5
    scene, rows = {"mu_d": 0.45, "delta": 2.0**-halvings, "degree": 9}, []
    asked = {"sticking": {}, "slip": {"inverse_distance": "0.2,1,5"}, "slip, with f_slip": {"distance": ASKED["distance"]},
             "peak": {"velocity": "0.5,1,2"}, "displacement": {"time": "0.3,2,20"}}
    for name, more in asked.items():
        added = name.partition(",")[0]
        wanted = {**more, "quantities": added if added == "sticking" else f"sticking,{added}"}
        run = entry.run(**scene, **wanted)
        seconds = sum(step["seconds"] for step in run["cost"]["steps"])
        rows.append((name, seconds, seconds / (rows[0][1] if rows else seconds), f"{run['plan']['factorizations_real']}",
                     f"{run['plan']['solves']}"))
    entry.table(f"Costs at delta = 1/{2**halvings}, degree 9", (
        "quantities besides sticking", "seconds", "times sticking alone", "factorisations", "solves planned"), rows)


def main():
    entry = Entry(__doc__, "beyond the paper")
    telegraph(entry)
    if not entry.quick:
        white_noise(entry)
    for name, scene in SCENES.items():
        other_formulas(entry, name, scene)
    for name, scene in SCENES.items():
        simulation(entry, name, scene)
    costs(entry)
    entry.end()


main()
