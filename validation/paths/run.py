"""Paths of the process, and how long they rest.

The pictures show what the process does: the force jumps from level to level, the velocity follows it, and the body
sticks while the force is small.

A path is drawn at random and knows nothing of the equations that give the probability of sticking. So the share of
time that a long path spends at rest is compared with P_stick. Excursions from rest are independent, which gives the
standard deviation of that share; four of them are allowed.

usage: python3 validation/paths/run.py [--quick] [--program build/stickslip] [--report FOLDER]
"""

import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from entry import Entry

entry = Entry(__doc__, "the figures of paths in the introduction")
for mu_d in (1, 0.25):
    entry.drawn("trajectory", f"path_{mu_d:g}.png",
                f"One path, mu_s = 1, mu_d = {mu_d:g}, delta = 1/4, tau = 1, b(v) = -v",
                entry.results(quantities="trajectory", mu_d=mu_d, delta=0.25, horizon=20))

# A long path rests for the share of time that the stationary distribution gives.
horizon = 2000 if entry.quick else 20000
path = entry.results(quantities="trajectory", mu_d=0.25, delta=0.5, horizon=horizon).trajectory
known = entry.run(quantities="sticking", mu_d=0.25, delta=0.5, accuracy=1e-8)["results"]
time, y = path["time"], path["y"]
share = float(sum((time[1:] - time[:-1])[y[:-1] == 0]) / time[-1])
entry.table("Share of time at rest on a long path", ("horizon", "share", "P_stick"),
            [(horizon, share, known["P_stick"]["value"])])
# Excursions are independent; the shares of one have a standard deviation of about 0.3.
entry.claim("share of time at rest, distance from P_stick",
            abs(share - known["P_stick"]["value"]), 4 * 0.3 * (4.8 / horizon) ** 0.5)
entry.end()
