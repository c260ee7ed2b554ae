"""What the same numbers cost elsewhere: the paper's method in SciPy and in Octave, and simulation.

usage: python3 validation/peers/run.py [--quick] [--full] [--program build/stickslip]
                                       [--delta 0.25] [--mu_d 0.25]

Optional: SciPy and Octave are no requirement of the program, and what is not installed is left out.
--full takes p = 512 points for each noise step, as the paper does, instead of 128; --quick takes 16.
"""

import importlib.util
import os
import pathlib
import shutil
import statistics
import subprocess
import sys
import time

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from harness import Program, difference, parser, worse

REPEATS = 3
LAMBDA = 1e-6
EXCURSIONS = 100_000
KEYS = ("P_stick", "E_V2")


def whole_process(program, **options):
    """Seconds from start to end of a process of this program, and what it found."""
    start = time.monotonic()
    results = program.run(quantities="sticking,moments", **options)["results"]
    return time.monotonic() - start, {key: results[key]["value"] for key in KEYS}


def script(*words):
    """Seconds that a script of this folder states, without its interpreter's start, and values."""
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, words))}\n{done.stderr}")
    found = {name: float(value) for name, value in map(str.split, done.stdout.splitlines())}
    return found.pop("seconds"), found


def methods(program, scene, p):
    """What to call for each method, and what is left out."""
    values = (scene["delta"], scene["mu_d"], p, LAMBDA)
    by = {"this program, -accuracy 1e-8": lambda: whole_process(program, accuracy=1e-8, **scene)}
    left_out = []
    if importlib.util.find_spec("scipy"):
        by[f"paper's method, SciPy, p = {p}"] = lambda: script(
            sys.executable, HERE / "scipy_paper.py", *values)
    else:
        left_out.append(f"SciPy: not installed for {sys.executable}")
    octave = shutil.which("octave-cli") or shutil.which("octave")
    if octave:
        by[f"paper's method, Octave, p = {p}"] = lambda: script(
            octave, "--quiet", "--no-init-file", "--no-window-system",
            HERE / "octave" / "paper.m", *values)
    else:
        left_out.append("Octave: not installed")
    by[f"simulation, {EXCURSIONS:g} excursions"] = lambda: whole_process(
        program, route="monte_carlo", excursions=EXCURSIONS, **scene)
    return by, left_out


def measured(by):
    """Median seconds and values of each method; the repetitions of all take turns."""
    seconds = {name: [] for name in by}
    values = {}
    for _ in range(REPEATS):
        for name, call in by.items():
            spent, values[name] = call()
            seconds[name].append(spent)
    return {name: statistics.median(spent) for name, spent in seconds.items()}, values


def main():
    options = parser(__doc__)
    options.add_argument("--full", action="store_true", help="p = 512")
    options.add_argument("--delta", type=float, default=0.25)
    options.add_argument("--mu_d", type=float, default=0.25)
    arguments = options.parse_args()
    for threads in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS"):
        os.environ[threads] = "1"
    program = Program(arguments.program)
    scene = {"delta": arguments.delta, "mu_d": arguments.mu_d}
    p = 512 if arguments.full else 16 if arguments.quick else 128

    reference = whole_process(program, accuracy=1e-10, **scene)[1]
    by, left_out = methods(program, scene, p)
    seconds, values = measured(by)
    errors = {name: worse(*(difference(values[name][key], reference[key]) for key in KEYS))
              for name in by}

    print(f"mu_s = tau = 1, mu_d = {arguments.mu_d:g}, delta = {arguments.delta:g}, b(v) = -v; "
          f"median of {REPEATS}, one core each")
    print(f"\n{'method':<36}{'seconds':>9}  {'ratio':>7}  largest relative error of P_stick, E_V2")
    ours = next(iter(seconds.values()))
    for name, spent in seconds.items():
        print(f"{name:<36}{spent:9.3f}  {spent / ours:7.1f}  {errors[name]:.1e}")
    for line in left_out:
        print(f"left out: {line}")


main()
