"""Random chains of forces against simulation and the null vector of the whole generator.

Chains of 2 to 40 states have rates between few or all of these, with and without a mirror image, under all drag laws,
a bias, thresholds by direction, and friction that weakens. Nobody chose them because they are easy.

Each is compared with its simulation, and with the null vector of the whole generator, which gives the stationary
distribution without excursions, in units of the errors that both methods state.

usage: python3 validation/chains/run.py [--quick] [--program build/stickslip] [--report FOLDER]

--quick takes 6 instead of 60, and simulates a tenth.
"""

import pathlib
import sys

import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from entry import Entry, deviation
from harness import by_place, worse
from stickslip.noise import Chain

DRAGS = ({"drag": "none"}, {"drag_coefficient": 0.7}, {"drag": "cubic", "drag_coefficient": 0.4, "drag_cubic": 0.3},
         {"drag": "expression", "drag_expression": "v>0?0-2*v:0-0.5*v"},
         {"drag": "expression", "drag_expression": "0-v-0.3*v*abs(v)"})
ASKED = {"quantities": "sticking,moments,averages,resolvent,slip", "observable": "min(abs(v),0.5)*x",
         "lambda": "0.4,3", "inverse_distance": "0.5"}

LONG = 200.0  # mean time between two sticking phases, beyond which simulation takes too long


def half_chain(rng):
    """Forces and rates of 1 to 20 states that all reach one another around a ring, besides jumps at random."""
    count = int(rng.integers(1, 21))
    rates = rng.lognormal(0, 1, (count, count)) * (rng.random((count, count)) < rng.choice([0.05, 0.3, 1]))
    for n in range(count):
        rates[n, (n + 1) % count] += rng.lognormal()
    return rng.choice([0.8, 1.5]) * rng.standard_normal(count) + rng.choice([0, 0.5]), rates


def drawn(rng):
    """A chain of two halves, each the other's mirror image or not, and the options of a scene."""
    forces, rates = half_chain(rng)
    more_forces, more_rates = (-forces, rates) if (mirrored := rng.random() < 0.4) else half_chain(rng)
    across = rng.lognormal(0, 1, (len(forces), len(more_forces)))
    generator = numpy.block([[rates, across], [across if mirrored else rng.lognormal(0, 1, across.T.shape), more_rates]])
    if mirrored:
        generator[len(forces):, :len(forces)] = across
    mu_s = rng.uniform(0.4, 1.2)
    options = {"mu_s": mu_s, "mu_d": mu_s * rng.uniform(0.4, 1), **DRAGS[rng.integers(len(DRAGS))]}
    if rng.random() < 0.3:
        options["mu_s_minus"] = mu_s * rng.uniform(1, 1.5)
        options["mu_d_minus"] = options["mu_s_minus"] * rng.uniform(0.5, 1)
    elif rng.random() < 0.3:
        options |= {"friction": "stribeck", "stribeck_velocity": rng.uniform(0.2, 2)}
    if rng.random() < 0.5:
        options["bias"] = rng.uniform(-0.3, 0.3)
    return Chain(numpy.concatenate([forces, more_forces]), generator), options


def moves_and_rests(chain, options):
    """Whether bodies start and stop, and no mean force carries them off without drag."""
    up, down = options["mu_s"], options.get("mu_s_minus", options["mu_s"])
    force = chain.x + options.get("bias", 0)
    held = min(options["mu_d"], options.get("mu_d_minus", options["mu_d"]))
    starts, rests = (force > up) | (force < -down), (force <= up) & (force >= -down)
    return starts.any() and rests.any() and (options.get("drag") != "none" or abs(chain.stationary @ force) < 0.6 * held)


def main():
    entry = Entry(__doc__, "beyond the paper")
    rng, known, far, rows = numpy.random.default_rng(39), [], [], []
    count, excursions = (6, 3000) if entry.quick else (60, 30000)
    while len(rows) < count:
        chain, options = drawn(rng)
        if not moves_and_rests(chain, options):
            continue
        scene = {"noise": chain, **options}
        exact = by_place(entry.run(**scene, **ASKED, accuracy=1e-6)["results"])
        if exact["mean_excursion", 0][0] > LONG:
            continue
        simulated = by_place(entry.run(**scene, **ASKED, route="monte_carlo", excursions=excursions)["results"])
        beside = [(*exact[place][:2], {"value": value, "ci95": ends}) for place, (value, _, ends) in simulated.items()
                  if place in exact and ends is not None and ends[0] < ends[1]]
        other = by_place(entry.run(**scene, quantities="sticking,moments", route="null_vector", accuracy=1e-6)["results"])
        gaps = [abs(value - exact[place][0]) / (error + exact[place][1] + 1e-13 * abs(value))
                for place, (value, error, _) in other.items() if place in exact and value]
        known += beside
        far += gaps
        what = ", ".join(f"{name} {value}" if isinstance(value, str) else f"{name} {value:.3g}"
                         for name, value in options.items())
        rows.append((str(len(chain.x)), what, max(abs(deviation(*one)) for one in beside), max(gaps)))
    entry.table("Random chains, the farthest result of each by simulation and by the null vector",
                ("states", "scene", "largest |z|", "null vector, by both errors"), rows)
    z = numpy.array([deviation(*one) for one in known])
    entry.at_least(f"share of {len(z)} confidence intervals at 95 % that hold the value", (abs(z) < 1.96).mean(), 0.9)
    entry.claim("largest |z|", abs(z).max(), 4.5)
    entry.claim("distance from the null vector, by the errors of both", worse(*far), 1)
    entry.end()


main()
