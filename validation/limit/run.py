"""The limit delta -> 0: orders over three decades, and limits with their errors.

As the step delta of the noise vanishes the process tends to one with Ornstein-Uhlenbeck noise. The order of this
convergence should be 1 in general, 3/2 for P_stick and 2 for E[V^2] where mu_d = mu_s and sliding phases graze the
static one. Values over three decades of delta must show these orders, whether mu_s is on a level of the noise or
between two.

The limits are compared with values of the same limits that were obtained from larger steps, by removing powers of
delta one by one.

usage: python3 validation/limit/run.py [--quick] [--program build/stickslip] [--report FOLDER]

--quick ends at delta = 2^-9 instead of 2^-13.
"""

import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from entry import Entry, subplots
from harness import difference, worse
from stickslip.plots.style import COLOURS

# mu_s = tau = 1, b(v) = -v; by removing powers of delta one by one from values between 1/4 and 1/64.
KNOWN = {0.25: {"P_stick": 0.1205970417, "E_V2": 0.3097150920},
         1: {"P_stick": 0.516134807, "E_V2": 0.0496223037}}
ORDERS = {0.25: {"P_stick": 1, "E_V2": 1}, 1: {"P_stick": 1.5, "E_V2": 2}}
LABELS = {"P_stick": r"$P_\mathrm{stick}$", "E_V2": "$E[V^2]$"}
FAMILIES = ("on a level", "between levels")


def draw(entry, studies):
    """Distance from the limit against delta, with the slopes of the orders."""
    figure, axes = subplots(1, 2, figsize=(10, 4.2), sharey=True)
    for axis, (mu_d, study) in zip(axes, studies.items()):
        for colour, key in zip(COLOURS, ("P_stick", "E_V2")):
            for marker, family in zip("o^", FAMILIES):
                table = study["tables"][f"{key} {family}"]
                limit = table["limit"][-1]
                apart = [abs(value / limit - 1) for value in table["value"]]
                axis.loglog(table["delta"], apart, marker, color=colour, markersize=4,
                            fillstyle="none", label=rf"{LABELS[key]}, $\mu_s$ {family}")
            order = ORDERS[mu_d][key]
            first, last = table["delta"][0], table["delta"][-1]
            axis.loglog([first, last], [apart[-1] * (d / last) ** order for d in (first, last)],
                        color=colour, linewidth=0.8, label=f"order {order:g}")
        axis.set_title(rf"$\mu_d$ = {mu_d:g}")
        axis.set_xlabel(r"noise step $\delta$  [force]")
        axis.legend(fontsize=8)
    axes[0].set_ylabel("relative distance from the limit")
    entry.figure(figure, "limit.png", "Distance of stationary values from their limits against the noise step; "
                 "mu_s = tau = 1, b(v) = -v")


def main():
    entry = Entry(__doc__, "beyond the paper, which ends at delta = 1/32")
    steps = 8 if entry.quick else 12
    studies = {mu_d: entry.run(study="delta", study_steps=steps, mu_d=mu_d, delta=0.25, accuracy=1e-10,
                               quantities="sticking,moments")["study"] for mu_d in KNOWN}
    draw(entry, studies)
    rows, apart, beyond, orders = [], [], [], []
    for mu_d, known in KNOWN.items():
        for key, value in known.items():
            for family in FAMILIES:
                table = studies[mu_d]["tables"][f"{key} {family}"]
                limit, error = table["limit"][-1], table["limit_error"][-1]
                order = table["order"][-1]
                rows.append((f"{mu_d:g}", key, family, f"{order:.3f}", f"{limit:.12g}", f"{error:.1e}"))
                apart.append(difference(limit, value))
                beyond.append(error / abs(limit))
                orders.append(abs(order - ORDERS[mu_d][key]))
    entry.table("Observed orders of the last three steps, and limits",
                ("mu_d", "value", "mu_s", "order", "limit", "error"), rows)
    entry.claim("limits from values known to ten digits, relative", worse(*apart), 3e-9)
    entry.claim("stated errors of the limits, relative", worse(*beyond), 1e-8 if entry.quick else 1e-9)
    entry.claim("orders from 1, and from 3/2 and 2 at mu_d = mu_s", worse(*orders), 0.1)
    entry.end()


main()
