"""Laplace transform of the duration of sliding phases.

F_slide(lambda) and F_stick(lambda) are the Laplace transforms of the durations of sliding and sticking phases.

At lambda = 1 they are compared with a Chebyshev collocation in Python, another discretisation of the same equations
that converges to twelve digits. Over four decades of lambda they are compared with the mean of exp(-lambda T) over
durations T that were drawn at random.

usage: python3 validation/laplace/run.py [--quick] [--program build/stickslip] [--report FOLDER]
"""

import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from entry import Entry, subplots
from harness import difference, worse
from known import F_1
from stickslip.plots.style import COLOURS, curve

MU_D = (0.25, 0.5, 1)
LAMBDA = "0.01:100:25:log"


def draw(entry, found):
    figure, panels = subplots(1, 2, figsize=(8.4, 3.5))
    for axes, key, label in zip(panels, ("F_slide", "F_stick"),
                                (r"$F_\mathrm{slide}(\lambda)$", r"$F_\mathrm{stick}(\lambda)$")):
        for n, mu_d in enumerate(MU_D):
            known, simulated = found[mu_d]
            curve(axes, known[key], n, label=rf"$\mu_d$ = {mu_d:g}")
            curve(axes, simulated[key], colour=COLOURS[n])
        axes.set(xscale="log", yscale="log", xlabel=r"$\lambda$  [1/time]", ylabel=label)
    panels[0].legend()
    entry.figure(figure, "laplace.png", "Curves: deterministic; dots: simulated, with 95 % confidence "
                 "intervals. "
                 "delta = tau = mu_s = 1, b(v) = -v")


def main():
    entry = Entry(__doc__, "the figure of the Laplace transform of the dynamic duration")
    found = {}
    for mu_d in MU_D:
        scene = {"quantities": "laplace", "mu_d": mu_d, "delta": 1, "lambda": LAMBDA}
        found[mu_d] = (entry.results(**scene, accuracy=1e-9),
                       entry.results(**scene, route="monte_carlo", excursions=100000 if entry.quick else 1000000))
    draw(entry, found)
    rows, away, beside = [], [], []
    for mu_d, digits in F_1.items():
        values = entry.run(quantities="laplace", mu_d=mu_d, delta=1, accuracy=1e-11,
                           **{"lambda": 1})["results"]
        for key, digit in zip(("F_slide", "F_stick"), digits):
            value = values[key]["value"][0]
            rows.append((f"{mu_d:g}", key, f"{value:.14f}", digit))
            away.append(difference(value, float(digit)))
    entry.table("Transforms at lambda = 1, by the program and by collocation",
                ("mu_d", "quantity", "value", "collocation"), rows)
    entry.claim("F_slide(1), F_stick(1) against collocation, relative", worse(*away), 1e-11)
    for known, simulated in found.values():
        for key in ("F_slide", "F_stick"):
            for n, value in enumerate(known[key].value):
                one = {"value": simulated[key].value[n], "ci95": simulated[key].ci95[n]}
                # Where a million excursions see a handful, no interval is normal.
                if value > 1e-3:
                    beside.append((value, known[key].error[n], one))
    entry.simulated("simulated transforms above 1e-3", beside)
    entry.end()


main()
