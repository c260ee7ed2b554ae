"""Extrapolation in p and delta beyond the memory limit of the paper.

The paper extrapolates P_stick from coarse grids to grids that do not fit into memory. The same extrapolation of the
same upwind values is repeated here (in the long form of the report), and both stand beside the value that it aims at,
which hp elements give to nine digits.

usage: python3 validation/extrapolation/run.py [--quick] [--program build/stickslip]
                                               [--report FOLDER]

--quick compares the printed table with converged values, without the 46 upwind runs.
"""

import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from entry import Entry
from harness import difference, worse

PLACES = ((7, 5), (8, 5), (9, 5), (5, 6), (6, 6), (7, 6), (8, 6), (9, 6))
PAPER = (0.1291, 0.1294, 0.1295, 0.1239, 0.1244, 0.1249, 0.1254, 0.1258)


def main():
    entry = Entry(__doc__, "the table of the data-learning heuristics")
    converged = {l: entry.run(quantities="sticking", mu_d=0.25, delta=2.0**-l, accuracy=1e-8)
                 ["results"]["P_stick"]["value"] for l in (5, 6)}
    ours = {}
    if not entry.quick:
        table = entry.run(study="heuristic", mu_d=0.25, quantities="sticking")
        table = table["study"]["tables"]["P_stick"]
        ours = {(k, l): value for k, l, value in zip(table["k"], table["l"], table["extrapolated"])}
    rows = [(f"({k}, {l})", f"{ours[k, l]:.6f}" if ours else "", f"{printed:.4f}",
             f"{converged[l]:.9f}") for (k, l), printed in zip(PLACES, PAPER)]
    entry.table("P_stick by extrapolation at p = 2^k, delta = 2^-l, mu_d = 1/4",
                ("(k, l)", "ours", "paper", "converged in p"), rows)
    last = {place: printed for place, printed in zip(PLACES, PAPER) if place[0] == 9}
    entry.claim("the paper's values at k = 9 from the converged ones, relative",
                worse(*(difference(v, converged[l]) for (_, l), v in last.items())), 1.5e-2)
    if ours:
        entry.claim("our extrapolated values at k = 9 from the converged ones, relative",
                    worse(*(difference(ours[p], converged[p[1]]) for p in last)), 1.5e-2)
    entry.text("The paper's values rise with k; those of the scheme that it prints fall, before and after "
               "extrapolation.")
    entry.text("The paper's first row at (9, 5) compares with 0.1302, a Monte Carlo value that is too "
               "high; the converged one is in the last column. Its second row is P(|X| <= mu_s), "
               "which does not depend on p and needs no extrapolation.")
    entry.end()


main()
