"""Durations of sliding phases, sticking phases and excursions.

The densities of the durations of sliding phases, sticking phases and excursions are computed at the parameters of the
paper's figure. Its Table 1 prints f_stick(0+), the density of sticking times at zero.

The values are compared with the digits of another code, with both columns of the table (Kolmogorov equations and
Monte Carlo), and with simulations of our own. Where the paper disagrees with all of them, the reason is given.

usage: python3 validation/durations/run.py [--quick] [--program build/stickslip] [--report FOLDER]
"""

import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from entry import Entry
from harness import difference, last_place, worse
from known import F_STICK_0, TABLE_1

MU_D = (0.25, 0.5, 0.75, 1)
REASON = ("The row mu_d = mu_s of the paper is off in both of its columns: a grid point of the noise "
          "equals mu_d there, creeps towards v = 0 without ever arriving, and shares the static node "
          "in the paper's grid.")


def pictures(entry):
    items = []
    for mu_d in (0.25, 1) if entry.quick else MU_D:
        for delta in (0.125,) if entry.quick else (1 / 16, 1 / 32):
            times = "0:0.1:201" if mu_d < 1 else "0:0.1:401"
            items.append(entry.results(quantities="duration_density", mu_d=mu_d, delta=delta, time=times,
                                       accuracy=1e-3))
    entry.drawn("durations", "durations.png", "Densities of durations; mu_s = tau = 1, b(v) = -v", *items)


def table_of_the_paper(entry):
    deltas = (1 / 8, 1 / 16) if entry.quick else (1 / 8, 1 / 16, 1 / 32)
    rows, digits, column, beside = [], 0.0, 0.0, []
    for mu_d in MU_D:
        for delta, known, printed in zip(deltas, F_STICK_0[mu_d], TABLE_1[mu_d]):
            scene = {"quantities": "entry_law", "mu_d": mu_d, "delta": delta}
            ours = entry.run(**scene, accuracy=1e-7)["results"]["f_stick_0"]
            # At mu_d = mu_s hardly any sticking phase begins next to an exit, where it may end at once.
            excursions = (20000 if entry.quick else 100000) * (10 if mu_d == 1 else 1)
            simulated = entry.run(**scene, route="monte_carlo",
                                  excursions=excursions)["results"]["f_stick_0"]
            beside.append((ours["value"], ours["error"], simulated))
            low, high = simulated["ci95"]
            rows.append((f"{mu_d:g}", f"1/{1 / delta:.0f}", f"{ours['value']:.8g}",
                         f"[{low:.4g}, {high:.4g}]", printed))
            digits = worse(digits, abs(ours["value"] - float(known)) / last_place(known))
            if mu_d < 1:
                column = worse(column, difference(float(printed.partition("/")[0]), ours["value"]))
    entry.table("f_stick(0+), the density of sticking times at zero",
                ("mu_d", "delta", "deterministic", "simulated, 95 %", "paper, Kolmogorov/Monte Carlo"), rows)
    entry.text(REASON)
    entry.claim("f_stick(0+) against known digits, in units of the last one", digits, 0.6)
    entry.claim("the paper's Kolmogorov column, mu_d < mu_s, relative", column, 5e-3)
    entry.simulated("simulations", beside)


def main():
    entry = Entry(__doc__, "the figure of durations and Table 1")
    pictures(entry)
    table_of_the_paper(entry)
    entry.end()


main()
