"""Speed: this program beside every alternative, itself with other solvers, and its own limits.

usage: python3 validation/benchmark/run.py [--quick] [--program build/stickslip] [--report FOLDER]

Whole processes, start-up included, on one BLAS thread. All contestants of a group run once a round, in
turns, so that other load on the machine falls on all; a ratio is taken within a round, and its median,
smallest and largest are printed. Writes benchmark.csv and benchmark.png to the folder. Optional: GNU
Octave, SciPy and a reference BLAS; what is not installed is left out, with a message. --quick takes p = 64
instead of 512, one round and no system beyond delta = 1/16.
"""

import csv
import dataclasses
import importlib.util
import json
import math
import os
import pathlib
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

import numpy

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from entry import Entry, subplots
from harness import MPI_PERMISSIONS, difference, words_of, worse
from stickslip.plots.style import COLOURS

LAMBDA = 1e-6  # of the paper's method
EXCURSIONS = 100_000
KEYS = ("P_stick", "E_V2")
LEVELS = {"noise_degree": 0}
MUMPS = {"slide_pc_type": "lu"}
ORDERING = {"slide_mat_mumps_icntl_7": 7}  # MUMPS chooses
NATIVE = {"slide_pc_factor_mat_solver_type": "petsc"}
REFERENCE_BLAS = [pathlib.Path("/usr/lib/x86_64-linux-gnu") / name for name in ("blas", "lapack")]


@dataclasses.dataclass
class Cost:
    """Of one process: wall seconds, largest memory, and what it found."""

    seconds: float
    megabytes: float
    values: dict


def cost_of(words, environment=None):
    """Cost without values, and what the process printed."""
    words = [str(word) for word in words]
    with tempfile.TemporaryFile("w+") as out, tempfile.TemporaryFile("w+") as errors:
        start = time.monotonic()
        process = subprocess.Popen(words, stdout=out, stderr=errors,
                                   env={**os.environ, **MPI_PERMISSIONS, **(environment or {})})
        _, status, usage = os.wait4(process.pid, 0)
        seconds = time.monotonic() - start
        process.returncode = os.waitstatus_to_exitcode(status)
        out.seek(0)
        errors.seek(0)
        if process.returncode not in (0, 3):  # 3: an accuracy missed, as with fixed grids
            sys.exit(f"{' '.join(words)}\n{errors.read()}")
        return Cost(seconds, usage.ru_maxrss / 1024, {}), out.read()


class Ours:
    """This program on one case, by options."""

    def __init__(self, entry, ranks=0, environment=None, **options):
        self.program, self.environment = entry.program.path, environment
        self.launcher = ["mpiexec", "-n", str(ranks)] if ranks else []
        self.options = {"mu_d": 0.25, "quantities": "sticking,moments,noise_law", **options}

    def __call__(self):
        with tempfile.TemporaryDirectory() as folder:
            summary = pathlib.Path(folder) / "summary.json"
            words = [*self.launcher, self.program, "-summary", summary, *words_of(self.options)]
            cost, _ = cost_of(words, self.environment)
            cost.values = json.loads(summary.read_text())
        return cost


class Script:
    """The paper's method by a script of this folder, its interpreter's start included."""

    def __init__(self, *words):
        self.words = words

    def __call__(self):
        cost, out = cost_of(self.words)
        found = {name: float(value) for name, value in map(str.split, out.splitlines())}
        cost.values = {"results": {key: {"value": found[key]} for key in KEYS}}
        return cost


class Rounds:
    """Contestants by name, run in turns; costs by name, one a round."""

    def __init__(self, group, contestants, rounds):
        self.group, self.costs = group, {name: [] for name in contestants}
        start, calls, done = time.monotonic(), rounds * len(contestants), 0
        for _ in range(rounds):
            for name, call in contestants.items():
                self.costs[name].append(call())
                done += 1
                left = (time.monotonic() - start) / done * (calls - done)
                print(f"benchmark: {group}: {name}: {self.costs[name][-1].seconds:.2f} s; "
                      f"{done} of {calls}, about {left:.0f} s left", file=sys.stderr, flush=True)

    def seconds(self, name):
        return statistics.median(cost.seconds for cost in self.costs[name])

    def megabytes(self, name):
        return max(cost.megabytes for cost in self.costs[name])

    def last(self, name):
        return self.costs[name][-1].values

    def ratios(self, name, base):
        """Of seconds, round by round: median, smallest, largest."""
        each = [a.seconds / b.seconds for a, b in zip(self.costs[name], self.costs[base])]
        return statistics.median(each), min(each), max(each)

    def rows(self, base, errors=None):
        for name in self.costs:
            middle, low, high = self.ratios(name, base)
            error = f"{errors[name]:.1e}" if errors else ""
            yield (name, f"{self.seconds(name):.3f}", f"{middle:.2f}", f"{low:.2f} ... {high:.2f}",
                   f"{self.megabytes(name):.0f}", error)


COLUMNS = ("method", "seconds", "ratio", "in single rounds", "MB", "relative error")


def error_against(known, found):
    return worse(*(difference(found["results"][key]["value"], known["results"][key]["value"])
                   for key in KEYS))


def with_reference_blas():
    if all(folder.is_dir() for folder in REFERENCE_BLAS):
        return {"LD_LIBRARY_PATH": ":".join(map(str, REFERENCE_BLAS))}
    return None


def alternatives(entry, p):
    """Contestants at delta = 1/4."""
    scene = {"delta": 0.25, "accuracy": 1e-8}
    found = {"this program": Ours(entry, **scene),
             "MUMPS": Ours(entry, **scene, **MUMPS),
             "ordering of MUMPS": Ours(entry, **scene, **ORDERING),
             "LU of PETSc": Ours(entry, **scene, **NATIVE)}
    values = (0.25, 0.25, p, LAMBDA)
    if importlib.util.find_spec("scipy"):
        found[f"SciPy, p = {p}"] = Script(sys.executable, HERE / "scipy_paper.py", *values)
    else:
        entry.text(f"SciPy is not installed for {sys.executable}: left out.")
    octave = shutil.which("octave-cli") or shutil.which("octave")
    if octave:
        found[f"Octave, p = {p}"] = Script(octave, "--quiet", "--no-init-file",
                                           "--no-window-system", HERE / "octave" / "paper.m",
                                           *values)
    else:
        entry.text("Octave is not installed: left out.")
    found[f"simulation, {EXCURSIONS} excursions"] = Ours(
        entry, delta=0.25, route="monte_carlo", excursions=EXCURSIONS,
        quantities="sticking,moments")
    return found


def beside_others(entry, rounds):
    p = 64 if entry.quick else 512
    known = Ours(entry, delta=0.25, accuracy=1e-11)().values
    runs = Rounds("delta = 1/4", alternatives(entry, p), rounds)
    errors = {name: error_against(known, runs.last(name)) for name in runs.costs}
    entry.table("delta = 1/4, mu_d = 1/4, mu_s = tau = 1, b(v) = -v, -accuracy 1e-8; the paper's method "
                f"with lambda = {LAMBDA:g}", COLUMNS, runs.rows("this program", errors))
    if not entry.quick:
        for name, faster in (("SciPy", 30), ("Octave", 200)):
            for full in (n for n in runs.costs if n.startswith(name)):
                entry.at_least(f"seconds of {full} over ours", runs.ratios(full, "this program")[0],
                               faster)
                entry.at_least(f"error of {full} over ours", errors[full] / errors["this program"],
                               1e4)
    return runs


def at_small_delta(entry, rounds):
    delta = 1 / 16 if entry.quick else 1 / 64
    scene = {"delta": delta, "accuracy": 1e-8}
    contestants = {"this program": Ours(entry, **scene),
                   "every level a node": Ours(entry, **scene, **LEVELS),
                   "MUMPS": Ours(entry, **scene, **MUMPS),
                   "ordering of MUMPS": Ours(entry, **scene, **ORDERING)}
    plain = with_reference_blas()
    if plain:
        contestants["ordering of MUMPS, reference BLAS"] = Ours(entry, environment=plain, **scene,
                                                                **ORDERING)
    else:
        entry.text("No reference BLAS: left out.")
    runs = Rounds(f"delta = 1/{1 / delta:.0f}", contestants, rounds)
    entry.table(f"delta = 1/{1 / delta:.0f}, else the same", COLUMNS, runs.rows("this program"))
    if plain and not entry.quick:
        entry.at_least("seconds with MUMPS's ordering and reference BLAS over ours",
                       runs.ratios("ordering of MUMPS, reference BLAS", "this program")[0], 40)
    against_arithmetic(entry, runs, scene)
    return runs


def product_speed():
    """Operations a second of a matrix product on one thread."""
    a = numpy.random.default_rng(1).random((768, 768))
    a @ a
    start = time.perf_counter()
    for _ in range(5):
        a @ a
    return 5 * 2 * 768**3 / (time.perf_counter() - start)


def against_arithmetic(entry, runs, scene):
    """Seconds beside those that the operations of an elimination would take as a matrix product."""
    steps = Ours(entry, plan=True, **scene)().values["plan"]["steps"]
    operations = sum(step["factor_operations"] for step in steps)
    ours = runs.last("this program")["cost"]
    start_up = ours["start_up_seconds"]
    limit = operations / product_speed() + start_up
    spent = {phase: sum(step[f"{phase}_seconds"] for step in ours["steps"])
             for phase in ("assembly", "analysis", "factorization", "solve")}
    entry.table("Where the time goes", ("what", "seconds"),
                [("start-up", start_up), *spent.items(),
                 ("an elimination as a matrix product, and start-up", limit),
                 ("the whole process", runs.seconds("this program"))])
    if not entry.quick:
        entry.claim("seconds over those of the arithmetic of an elimination and start-up",
                    runs.seconds("this program") / limit, 3)


def growth(entry, rounds):
    """Time and memory against delta, and what noise nodes save at an intermediate one."""
    finest, between = (4, 4) if entry.quick else (13, 6)
    rows = []
    for n in range(3, finest + 1):
        cost = Ours(entry, delta=2.0**-n, accuracy=1e-8)()
        step = cost.values["cost"]["steps"][-1]
        rows.append((n, cost.seconds, cost.megabytes, step["noise_levels"], step["noise_nodes"],
                     cost.values["accuracy"]["reached"]))
        print(f"benchmark: delta = 2^-{n}: {cost.seconds:.2f} s", file=sys.stderr, flush=True)
    entry.table("Time and memory against delta, -accuracy 1e-8",
                ("delta", "seconds", "MB", "levels on each side", "nodes in all", "reached"),
                [(f"2^-{n}", *row, str(reached)) for n, *row, reached in rows])
    entry.claim("scales where the accuracy was missed", sum(not row[-1] for row in rows), 0.5)
    steps = rows[-1][0] - rows[0][0]
    for what, at, bound in (("time", 1, 0.5), ("memory", 2, 0.5)):
        power = math.log2(rows[-1][at] / rows[0][at]) / steps
        entry.claim(f"power of 1/delta with which {what} grows", power, bound)
    scene = {"delta": 2.0**-between, "accuracy": 1e-8}
    runs = Rounds(f"delta = 2^-{between}", {
        "noise nodes": Ours(entry, **scene),
        "every level a node": Ours(entry, **scene, **LEVELS)}, rounds)
    entry.table(f"delta = 2^-{between}", COLUMNS, runs.rows("noise nodes"))
    return runs


def steps_of(program, known):
    """Least seconds of each step in three runs, the degrees, and the largest relative error of the
    last against the results `known`."""
    runs = [program().values for _ in range(3)]
    seconds = [min(times) for times in
               zip(*([step["seconds"] for step in run["cost"]["steps"]] for run in runs))]
    degrees = [step["degree"] for step in runs[0]["cost"]["steps"]]
    error = worse(*(difference(runs[0]["results"][key]["value"], result["value"])
                    for key, result in known.items() if result["value"] != 0))
    return seconds, degrees, error


def single_degrees(entry):
    """What refinement costs beside the one discretisation that would have been enough."""
    scenes = [(1e-6, 0.25, 1 / 4), (1e-8, 0.25, 1 / 16)]
    if not entry.quick:
        scenes += [(1e-4, 0.5, 1 / 16), (1e-6, 1, 1 / 16), (1e-8, 0.25, 1 / 64), (1e-8, 1, 1 / 16),
                   (1e-10, 0.25, 1 / 16)]
    rows = []
    for accuracy, mu_d, delta in scenes:
        scene = {"mu_d": mu_d, "delta": delta, "quantities": "sticking,moments"}
        finest = {**scene, "accuracy": max(1e-3 * accuracy, 1e-12)}
        known = Ours(entry, **finest)().values["results"]
        scene["accuracy"] = accuracy
        seconds, degrees, error = steps_of(Ours(entry, **scene), known)
        # A fixed degree is compared with that below. Its seconds are those of the run after, where
        # it comes first: later steps find the memory that the first one had to ask the system for.
        fixed = {degree: steps_of(Ours(entry, degree=degree, **scene), known)
                 for degree in range(2, degrees[-1] + 2)}
        best = None
        for degree in range(2, degrees[-1] + 1):
            its_error, (its_seconds, *_), (first, *_) = fixed[degree][2], *fixed[degree + 1][:2]
            assert first == degree
            if its_error <= accuracy and (best is None or its_seconds < best[1]):
                best = degree, its_seconds, its_error
        rows.append((f"{accuracy:g}", f"{mu_d:g}", f"1/{1 / delta:.0f}", str(best[0]),
                     f"{best[2]:.1e}", f"{best[1]:.4f}", " ".join(map(str, degrees)),
                     f"{error:.1e}", f"{sum(seconds):.4f}", f"{sum(seconds) / best[1]:.2f}"))
        print(f"benchmark: single degrees: {len(rows)} of {len(scenes)} cases", file=sys.stderr,
              flush=True)
    entry.table("Refinement beside the cheapest single degree that is accurate enough",
                ("accuracy", "mu_d", "delta", "degree", "its error", "seconds", "ours", "error",
                 "seconds in all", "ratio"), rows)
    if not entry.quick:
        entry.claim("median of seconds of refinement over those of the best single degree",
                    statistics.median(float(row[-1]) for row in rows), 1.5)


def other_limits(entry, rounds):
    """A spectrum beside sticking, and start-up."""
    runs = Rounds("spectrum and start", {
        "sticking": Ours(entry, delta=0.25, accuracy=1e-6, quantities="sticking"),
        "200 frequencies": Ours(entry, delta=0.25, accuracy=1e-6, quantities="spectrum",
                                omega="0.01:20:200:log"),
        "start-up, noise law": Ours(entry, delta=0.25, quantities="noise_law")}, rounds)
    entry.table("delta = 1/4, -accuracy 1e-6", COLUMNS, runs.rows("sticking"))
    entry.claim("seconds of 200 frequencies over those of sticking",
                runs.ratios("200 frequencies", "sticking")[0], 4)
    entry.claim("seconds of start-up", runs.seconds("start-up, noise law"), 0.1)
    return runs


def drawn(entry, groups):
    """The CSV of all single runs, and the picture made of it."""
    with open(entry.file("benchmark.csv"), "w", newline="") as file:
        lines = csv.writer(file)
        lines.writerow(("group", "method", "round", "seconds", "megabytes"))
        for runs in groups:
            for name, costs in runs.costs.items():
                lines.writerows((runs.group, name, n + 1, f"{cost.seconds:.6g}",
                                 f"{cost.megabytes:.4g}") for n, cost in enumerate(costs))
    entry.figure(picture(groups), "benchmark.png", "Seconds of whole processes, each dot one run")


def picture(groups):
    """Seconds of every run, by group and method."""
    rows = sum(len(runs.costs) for runs in groups) + len(groups)
    figure, axes = subplots(figsize=(7, 0.8 + 0.26 * rows))
    at, places, labels = 0, [], []
    for n, runs in enumerate(groups):
        axes.text(0.01, at, runs.group, transform=axes.get_yaxis_transform(), fontsize=9, fontweight="bold",
                  va="center")
        at += 1
        for method, costs in runs.costs.items():
            seconds, colour = [cost.seconds for cost in costs], COLOURS[n % len(COLOURS)]
            axes.plot(seconds, [at] * len(seconds), "o", color=colour, markersize=4, alpha=0.6)
            axes.plot(statistics.median(seconds), at, "|", color=colour, markersize=14)
            places.append(at)
            labels.append(method)
            at += 1
    axes.set(xscale="log", xlabel="wall time of the process  [s]", ylim=(at - 0.5, -0.8))
    axes.set_yticks(places, labels)
    return figure


def main():
    for threads in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS"):
        os.environ[threads] = "1"
    entry = Entry(__doc__, "beyond the paper")
    rounds = 1 if entry.quick else 3
    beside = beside_others(entry, rounds)
    groups = [other_limits(entry, 3 * rounds), beside, at_small_delta(entry, rounds),
              growth(entry, rounds)]
    single_degrees(entry)
    drawn(entry, groups)
    entry.end()


main()
