"""What a run costs over the whole range of an option.

One option at a time goes from end to end, everything else as in mu_s = tau = 1, mu_d = 1/2, delta = 1/4. The largest
jump from one value to the next shows where a user who moves an option a little waits much longer.

Nothing is claimed, as seconds depend on the machine and on what else it does.

usage: python3 validation/scan/run.py [--quick] [--program build/stickslip] [--report FOLDER]

--quick takes every third value.
"""

import pathlib
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from entry import Entry

SCENE = {"mu_d": 0.5, "delta": 0.25, "accuracy": 1e-6}
LEAST = 1  # seconds that nobody waits for, and that a busy machine takes for nothing
# What is asked for, the option, and its values.
SCANS = (
    ("sticking,moments", "delta", (1, 0.3, 0.1, 0.03, 0.01, 0.003, 0.001, 0.0003, 0.0001)),
    ("sticking,moments", "tau", (0.0003, 0.003, 0.01, 0.03, 0.1, 0.3, 1, 3, 5)),
    ("sticking,moments", "mu_d", (0.01, 0.03, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99, 1)),
    ("sticking,moments", "drag_coefficient", (0, 1e-4, 1e-2, 0.1, 1, 10, 100, 1000)),
    ("sticking,moments", "bias", (1e-6, 1e-3, 0.1, 0.3, 0.5, 0.9, 1.5, 3)),
    ("laplace", "lambda", (1e-8, 1e-4, 1e-2, 1, 10, 100, 1e3, 1e4, 1e6)),
    ("resolvent", "lambda", (1e-8, 1e-4, 1e-2, 1, 10, 100, 1e3, 1e4)),
    ("spectrum", "omega", (1e-3, 0.1, 1, 10, 100, 127, 129, 300, 1e3, 1e4, 1e6)),
    ("duration_density", "time", (1e-4, 1e-2, 0.1, 1, 10, 100, 1e3)),
    ("autocorrelation", "time", (1e-4, 1e-2, 0.1, 1, 10, 100, 1e3)),
)


def form(option, value):
    """A list that ends at the value, for what takes lists."""
    return f"{value / 100:g}:{value:g}:20" if option in ("omega", "time") else f"{value:g}"


def scan(entry, quantities, option, values):
    """Seconds by value, and whether the accuracy was reached."""
    found = []
    for value in values:
        options = {**SCENE, "quantities": quantities, option: form(option, value)}
        if quantities == "resolvent":
            options["observable"] = "v^2"
        start = time.monotonic()
        summary = entry.run(**options)
        found.append((value, time.monotonic() - start, summary["accuracy"]["reached"]))
        print(f"scan: {quantities} at {option} = {value:g}: {found[-1][1]:.2f} s", file=sys.stderr,
              flush=True)
    return found


def main():
    entry = Entry(__doc__, "beyond the paper")
    rows = []
    for quantities, option, values in SCANS:
        found = scan(entry, quantities, option, values[::3] if entry.quick else values)
        seconds = [max(s, LEAST) for _, s, _ in found]
        largest = max(max(b / a, a / b) for a, b in zip(seconds, seconds[1:]))
        slowest = max(found, key=lambda one: one[1])
        missed = [f"{value:g}" for value, _, reached in found if not reached]
        rows.append((quantities, option, f"{found[0][0]:g} ... {found[-1][0]:g}",
                     f"{min(s for _, s, _ in found):.2f} ... {slowest[1]:.2f}", f"{slowest[0]:g}",
                     f"{largest:.1f}", ", ".join(missed)))
    entry.table("Seconds over the range of an option",
                ("quantities", "option", "range", "seconds", "slowest at", "largest jump",
                 "accuracy missed at"), rows)
    entry.end()


main()
