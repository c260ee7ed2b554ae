"""What accuracy costs in time.

Four methods repeat a case with increasing resolution, simulation among them and the upwind scheme of the paper. The
picture shows the largest relative error of each against the seconds that it took.

Times depend on the machine. The claims therefore leave wide margins: they say that the scheme of the paper takes many
times as long, and that it is still wrong in the third digit.

usage: python3 validation/cost/run.py [--quick] [--program build/stickslip] [--report FOLDER]
"""

import pathlib
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from entry import Entry
from harness import difference


def seconds_of_paper(entry):
    """The lambda problem of the paper at p = 512 on the full grid: seconds and relative error."""
    p = 64 if entry.quick else 512
    start = time.monotonic()
    found = entry.run(route="lambda", scheme="upwind", p=p, mu_d=0.25, delta=0.25,
                      quantities="sticking", **{"lambda": 1e-6})
    whole = time.monotonic() - start
    last = found["cost"]["steps"][-1]["seconds"]
    return p, min(last, whole), found["results"]["P_stick"]["value"]


def main():
    entry = Entry(__doc__, "beyond the paper: its method, this program and simulation")
    steps = 5 if entry.quick else 8
    found = entry.results(study="cost", mu_d=0.25, delta=0.25, study_steps=steps,
                          study_repeats=1 if entry.quick else 3, quantities="sticking,moments")
    entry.drawn("cost", "cost.png", "Largest relative error of sticking and moments against "
                "time; mu_d = 1/4, delta = 1/4, mu_s = tau = 1, b(v) = -v", found)
    for line in found.summary["study"]["conclusions"]:
        entry.text(line)
    hp = found.study["hp"]
    fast = hp["seconds"][hp["error"] < 1e-9].min()
    p, slow, value = seconds_of_paper(entry)
    known = entry.run(quantities="sticking", mu_d=0.25, delta=0.25, accuracy=1e-9)["results"]
    error = difference(value, known["P_stick"]["value"])
    entry.table("One system each", ("method", "seconds", "relative error of P_stick"),
                [("hp at 1e-9", fast, "below 1e-9"),
                 (f"the paper's lambda problem, p = {p}, full grid", slow, error)])
    entry.at_least(f"seconds of the paper's method at p = {p} over those of hp at 1e-9",
                   slow / fast, 3 if entry.quick else 100)
    entry.at_least(f"error of the paper's method at p = {p}", error, 1e-3)
    entry.end()


main()
