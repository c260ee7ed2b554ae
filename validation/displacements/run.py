"""Distributions of displacements of random cases against simulation.

Quantiles are found by inversion of characteristic functions of reduced models, and their errors by what changes with
the poles, the range of wavenumbers and the discretisation. Paths know of none of these. Noise, drag, friction, bias,
start and time are drawn at random, and the share of simulated paths that end below a quantile is compared with its
probability, in units of the standard error of that share and the error of the distribution function there.

usage: python3 validation/displacements/run.py [--quick] [--cases N] [--seed N] [--jobs N] [--program build/stickslip]
                                               [--report FOLDER]

--quick takes 3 instead of 60, and simulates a third. A case that takes longer than two minutes is left out.
"""

import concurrent.futures
import math
import os
import pathlib
import random
import sys

import numpy

VALIDATION = pathlib.Path(__file__).resolve().parents[1]
sys.path[:0] = [str(VALIDATION / folder) for folder in ("", "calibration")]
import cases
from entry import Entry
from harness import entries, seed_of, words_of

import stickslip

SECONDS = 120  # the longest run
SCENES = (cases.coulomb, cases.quick, cases.telegraph, cases.weakening, cases.few)
PROBABILITIES = (0.1, 0.35, 0.65, 0.9)
ACCURACY = 0.03
NEXT = 1e-7  # relative, to either side of a quantile
LIST = ",".join(map(str, PROBABILITIES))


def drawn(entry, number):
    """The options of a case."""
    draw = random.Random(f"{entry.arguments.seed} {number}")
    scene = cases.levels_in_file(draw.choice(SCENES)(draw), entry)
    return scene | {"start": draw.choice(("rest", "stationary")), "time": cases.log_uniform(draw, 0.1, 10),
                    "quantities": "displacement_distribution"}


def compared(entry, number):
    """The command, and of each quantile its probability, z, the share of paths, its standard error and the error of the
    distribution function. A quantile d has P(x < d) <= p <= P(x <= d), and z = 0 within an atom."""
    options = drawn(entry, number)

    def run(key, **more):
        results = stickslip.run(program=entry.program.path, timeout=SECONDS, **options, **more).summary["results"]
        return next(entries(results[name]) for name in results if name.startswith(key))

    found = run("displacement_quantile", probability=LIST, accuracy=ACCURACY)
    quantiles = [(p, d) for p, (d, error, _) in zip(PROBABILITIES, found) if error is not None]
    if not quantiles:
        raise stickslip.Unsolved("no quantile has an error estimate")
    distance = ",".join(repr(d + side * NEXT * (abs(d) or 1)) for _, d in quantiles for side in (-1, 1))
    known = run("displacement_cdf", distance=distance, accuracy=ACCURACY)
    simulated = run("displacement_cdf", distance=distance, route="monte_carlo", seed=seed_of(options),
                    excursions=10**4 if entry.quick else 3 * 10**4)
    shares = [(share, (high - low) / 3.92, error) for (_, error, _), (share, _, (low, high)) in zip(known, simulated)]
    rows = []
    for (p, _), below, at_most in zip(quantiles, shares[::2], shares[1::2]):
        share, sigma, error = below if below[0] > p else at_most
        far = max(below[0] - p, 0) + min(at_most[0] - p, 0)
        rows.append((p, far / math.hypot(sigma, error), share, sigma, error))
    return " ".join(words_of(options)), rows


def main():
    entry = Entry(__doc__, "beyond the paper", ("--cases", {"type": int, "help": "number of cases"}),
                  ("--seed", {"type": int, "default": 1}), ("--jobs", {"type": int, "default": os.cpu_count()}))
    arguments, table, all_rows, left_out = entry.arguments, [], [], {}
    count = arguments.cases or (3 if entry.quick else 60)
    with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        running = [pool.submit(compared, entry, number) for number in range(count)]
        for number, one in enumerate(running):
            try:
                command, rows = one.result()
            except (stickslip.BadInput, stickslip.Unsolved, stickslip.TimedOut) as reason:
                left_out[number] = str(reason)
                continue
            print(f"case {number} of {count}", file=sys.stderr, flush=True)
            all_rows += rows
            p, z, *others = max(rows, key=lambda row: abs(row[1]))
            table.append((f"{number}", p, f"{z:.2f}", *others, command))
    entry.table("The quantile of each case whose simulated share is farthest from its probability",
                ("case", "probability", "z", "share", "standard error", "error", "command"), table)
    if left_out:
        entry.table("Left out", ("case", "reason"), [(f"{number}", reason) for number, reason in left_out.items()])
    z, errors = (numpy.array([row[n] for row in all_rows]) for n in (1, -1))
    entry.text(f"{len(z)} quantiles of {count} cases, {len(left_out)} of which were refused or too long. Errors of the "
               f"distribution function: {numpy.median(errors):.2g} in the median, at most {errors.max():.2g}.")
    entry.claim("largest |z|", abs(z).max(), 4)
    entry.claim("mean square of z", (z**2).mean(), 1.5)
    entry.end()


main()
