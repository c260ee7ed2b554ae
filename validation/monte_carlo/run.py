"""The paper's Monte Carlo figure as a table, beside numbers without statistical error.

usage: python3 validation/monte_carlo/run.py [--quick] [--program build/stickslip]

Prints the tables, then each claim of README.md with its verdict; exit status 1 if one fails.
--quick takes 10^5 excursions and delta >= 1/8, and times nothing (a minute instead of a
quarter of an hour).
"""

import collections
import itertools
import math
import os
import pathlib
import statistics
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from harness import (MPI_PERMISSIONS, Program, Report, difference, last_place, parser, significant,
                     worse)
from known import P_X, SIMULATED

QUANTITIES = ("P_stick", "E_V2", "P_X_le_mu_s")
DELTAS = tuple(2.0**-n for n in range(1, 6))
FRICTIONS = (1 / 4, 1 / 2, 3 / 4, 1)
WIDTH = statistics.NormalDist().inv_cdf(0.975)  # half a 95 % confidence interval, in standard deviations

Row = collections.namedtuple("Row", "quantity mu_d delta value low high exact paper")


def printed(quantity, mu_d, delta):
    """What the paper prints as simulated, or nothing."""
    return SIMULATED[quantity].get(delta, "") if mu_d == 1 / 4 else ""


def deviations(row):
    """How far the simulated value is from the exact one, in its standard deviations."""
    return WIDTH * (row.value - row.exact) / (row.high - row.value)


def off(row, excursions):
    """Whether the paper's number is further from the exact one than half the width of a confidence interval
    of 10^6 excursions, as it has, and a unit of its last digit."""
    half = (row.high - row.value) * math.sqrt(excursions / 10**6)
    return abs(float(row.paper) - row.exact) > half + last_place(row.paper)


def rows_of(program, mu_d, delta, excursions):
    """One simulated case and the same by the deterministic method."""
    scene = {"mu_d": mu_d, "delta": delta}
    simulated = program.run(route="monte_carlo", excursions=excursions, **scene)
    exact = program.run(route="excursion", accuracy=1e-8, **scene)["results"]
    return [Row(key, mu_d, delta, simulated["results"][key]["value"],
                *simulated["results"][key]["ci95"], exact[key]["value"],
                printed(key, mu_d, delta)) for key in QUANTITIES]


def figure(program, deltas, excursions):
    """Every point of the figure; each has a seed of its own, so that they are independent."""
    print(f"mu_s = tau = 1, b(v) = -v; {excursions} excursions; a star: further from the\n"
          "deterministic value than an interval of 10^6 excursions and the rounding allow\n"
          "  mu_d  delta  quantity      simulated  95 % confidence      deterministic     z  paper")
    rows = []
    for mu_d, delta in itertools.product(FRICTIONS, deltas):
        for row in rows_of(program, mu_d, delta, excursions):
            star = "*" if row.paper and off(row, excursions) else ""
            print(f"  {mu_d:<5g} 1/{1 / delta:<4g} {row.quantity:<12}  {row.value:.6f}   "
                  f"{row.low:.6f} - {row.high:.6f}  {row.exact:.10f}  {deviations(row):5.2f}  "
                  f"{row.paper}{star}".rstrip(), flush=True)
            rows.append(row)
    print()
    return rows


def binomial_range(trials, probability, tail):
    """The counts that are left when both tails of the binomial distribution are cut off."""
    binomial = [math.comb(trials, n) * probability**n * (1 - probability) ** (trials - n)
                for n in range(trials + 1)]
    low = next(n for n, below in enumerate(itertools.accumulate(binomial)) if below > tail)
    above = next(n for n, over in enumerate(itertools.accumulate(reversed(binomial))) if over > tail)
    return low, trials - above


def claim_coverage(report, text, inside):
    """`inside`: whether each of some independent intervals holds the exact value."""
    low, high = binomial_range(len(inside), 0.95, 1e-3)
    count = sum(inside)
    report.verdict(low <= count <= high, text,
                   f"{count} of {len(inside)}, expected {low} to {high}")


def claim_figure(report, rows):
    for key in QUANTITIES:
        claim_coverage(report, f"{key}: intervals of the figure that hold the deterministic value",
                       [row.low <= row.exact <= row.high for row in rows if row.quantity == key])
    allowed = significant(len(rows))
    report.verdict(all(abs(deviations(row)) < allowed for row in rows),
                   f"no disagreement among {len(rows)} values, family-wise level 1e-3",
                   f"largest |z| {max(abs(deviations(row)) for row in rows):.2f}, "
                   f"allowed {allowed:.2f}")
    report.claim("P_X_le_mu_s, deterministic, against the paper's left kernel, relative",
                 worse(*(difference(row.exact, float(P_X[row.delta]))
                         for row in rows if row.quantity == "P_X_le_mu_s")), 1e-13)


def claim_paper(report, rows):
    """P_stick of the paper at delta = 1/32 is off."""
    for row in rows:
        if (row.quantity, row.mu_d, row.delta) != ("P_stick", 1 / 4, 1 / 32):
            continue
        slack = last_place(row.paper)
        inside = row.low - slack <= float(row.paper) <= row.high + slack
        report.verdict(not inside,
                       "P_stick of the paper at mu_d = 1/4, delta = 1/32 is outside our interval",
                       f"{row.paper} against {row.value:.5f} [{row.low:.5f}, {row.high:.5f}], "
                       f"deterministic {row.exact:.8f}")


def coverage(program, report, runs):
    """Many short runs of one case: intervals that are too wide show as well."""
    scene = {"mu_d": 1 / 4, "delta": 1 / 2}
    exact = program.run(route="excursion", accuracy=1e-8, **scene)["results"]
    inside = {key: [] for key in QUANTITIES}
    for seed in range(1, runs + 1):
        found = program.run(route="monte_carlo", excursions=4000, seed=seed, **scene)["results"]
        for key in QUANTITIES:
            low, high = found[key]["ci95"]
            inside[key].append(low <= exact[key]["value"] <= high)
    for key in QUANTITIES:
        claim_coverage(report, f"{key}: intervals of 4000 excursions, mu_d = 1/4, delta = 1/2, "
                       "that hold it", inside[key])


def idle_cores(seconds=1):
    """How many cores nothing uses, as the kernel counts them for a while."""
    def idle_ticks():
        return int(pathlib.Path("/proc/stat").read_text().split()[4])
    before, start = idle_ticks(), time.monotonic()
    time.sleep(seconds)
    return (idle_ticks() - before) / os.sysconf("SC_CLK_TCK") / (time.monotonic() - start)


def two_ranks(program, report):
    """Seconds of one rank over those of two."""
    os.environ |= MPI_PERMISSIONS
    both = {1: program, 2: Program(program.path, ranks=2)}
    free = idle_cores()
    seconds = {ranks: min(run.run(route="monte_carlo", mu_d=1 / 4, delta=1 / 8, excursions=500_000)
                          ["cost"]["simulation"]["seconds"] for _ in range(2))
               for ranks, run in both.items()}
    free = min(free, idle_cores())
    ratio = seconds[1] / seconds[2]
    print(f"\nOne rank {seconds[1]:.2f} s, two ranks {seconds[2]:.2f} s: ratio {ratio:.2f}")
    if free >= 1.9:
        report.at_least("seconds of one rank over those of two", ratio, 1.8)
    else:
        print(f"no claim on two ranks: {free:.1f} cores were idle, two are needed")


def main():
    arguments = parser(__doc__).parse_args()
    program, report, quick = Program(arguments.program), Report(), arguments.quick
    rows = figure(program, DELTAS[:3] if quick else DELTAS, 10**5 if quick else 10**6)
    claim_figure(report, rows)
    claim_paper(report, rows)
    coverage(program, report, 100 if quick else 400)
    if not quick:
        two_ranks(program, report)
    sys.exit(1 if report.failed else 0)


main()
