"""Paths of the process.

usage: python3 validation/paths/run.py [--quick] [--program build/stickslip] [--report FOLDER]
"""

import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from entry import Entry

import h5py

entry = Entry(__doc__, "the figures of paths in the introduction")
for mu_d in (1, 0.25):
    name = f"path_{mu_d:g}"
    entry.run(output=name + ".h5", quantities="trajectory", mu_d=mu_d, delta=0.25, horizon=20)
    entry.drawn("trajectory.py", name + ".png",
                f"One path, mu_s = 1, mu_d = {mu_d:g}, delta = 1/4, tau = 1, b(v) = -v",
                entry.file(name + ".h5"))

# A long path rests for the share of time that the stationary law gives.
horizon = 2000 if entry.quick else 20000
entry.run(output="long.h5", quantities="trajectory", mu_d=0.25, delta=0.5, horizon=horizon)
known = entry.run(quantities="sticking", mu_d=0.25, delta=0.5, accuracy=1e-8)["results"]
with h5py.File(entry.file("long.h5")) as file:
    time, y = file["trajectory/time"][:], file["trajectory/y"][:]
share = float(sum((time[1:] - time[:-1])[y[:-1] == 0]) / time[-1])
entry.file("long.h5").unlink()
entry.table("Share of time at rest on a long path", ("horizon", "share", "P_stick"),
            [(horizon, share, known["P_stick"]["value"])])
# Excursions are independent; the shares of one have a standard deviation of about 0.3.
entry.claim("share of time at rest, distance from P_stick",
            abs(share - known["P_stick"]["value"]), 4 * 0.3 * (4.8 / horizon) ** 0.5)
entry.end()
