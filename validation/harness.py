"""What the claims of validation/ share: running the program, and verdicts."""

import argparse
import json
import pathlib
import statistics
import subprocess
import sys
import tempfile
import zlib

ROOT = pathlib.Path(__file__).resolve().parents[1]


# Open MPI refuses root, and more ranks than cores, unless told otherwise.
MPI_PERMISSIONS = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
                   "OMPI_MCA_rmaps_base_oversubscribe": "1"}


def words_of(options):
    """Words of a command line; the value None makes a flag of an option."""
    return [word for name, value in options.items()
            for word in (["-" + name] if value is None else ["-" + name, str(value)])]


def seed_of(options):
    """Seed of what these options simulate: every scene has its own, the same one each time. Files are no
    part of a scene."""
    scene = {name: value for name, value in options.items() if not isinstance(value, pathlib.Path)}
    return zlib.crc32(" ".join(words_of(scene)).encode())


def simulates(options):
    return (options.get("route") == "monte_carlo"
            or "trajectory" in options.get("quantities", "").split(","))


class Refused(Exception):
    """The program found the scene or the request invalid."""


class Program:
    def __init__(self, path, launcher=()):
        self.path, self.launcher = path, launcher

    def run(self, **options):
        """The summary of one run; underscores of PETSc's solver prefixes stay as they are. What is
        simulated without a seed has that of seed_of."""
        if simulates(options):
            options = {"seed": seed_of(options), **options}
        with tempfile.TemporaryDirectory() as folder:
            summary = pathlib.Path(folder) / "summary.json"
            words = [*self.launcher, str(self.path), "-summary", str(summary), *words_of(options)]
            try:
                done = subprocess.run(words, capture_output=True, text=True)
            except OSError as problem:
                sys.exit(f"{words[0]} does not run: {problem.strerror}")
            if done.returncode == 2:
                raise Refused(done.stderr.strip())
            if done.returncode not in (0, 3):  # 3: a discretisation fixed by hand is not refined
                sys.exit(f"{' '.join(words)}\n{done.stderr}")
            return json.loads(summary.read_text())


class Report:
    """Prints verdicts and remembers whether one was bad."""

    def __init__(self):
        self.failed = False

    def claim(self, text, worst, tolerance):
        """Holds if the largest deviation found is within the tolerance; a NaN is not."""
        self.verdict(worst <= tolerance, text, f"largest {worst:.1e}, allowed {tolerance:.3g}")

    def at_least(self, text, smallest, bound):
        self.verdict(smallest >= bound, text, f"smallest {smallest:.3g}, wanted {bound:g}")

    def verdict(self, good, text, numbers):
        self.failed |= not good
        print(f"{'holds' if good else 'FAILS'}  {text}: {numbers}", flush=True)


def difference(a, b):
    """Relative to b."""
    return abs(a - b) / abs(b)


def worse(*values):
    """The largest, or NaN if there is one: max() would lose it."""
    return next((v for v in values if v != v), max(values))


def significant(count):
    """|z| that one of `count` independent values passes by chance with probability 1e-3."""
    return statistics.NormalDist().inv_cdf(1 - 1e-3 / (2 * count))


def last_place(text):
    """One unit of the last digit of a number as it was printed."""
    mantissa, _, exponent = text.lower().partition("e")
    digits = len(mantissa.partition(".")[2])
    return 10.0 ** (int(exponent or 0) - digits)


def parser(doc):
    """Command line with the options that every case has."""
    result = argparse.ArgumentParser(description=doc.splitlines()[0])
    result.add_argument("--quick", action="store_true", help="leave out the large cases")
    result.add_argument("--program", default=ROOT / "build" / "stickslip", type=pathlib.Path)
    return result
