"""What the claims of validation/ share: running the program, and verdicts."""

import argparse
import pathlib
import statistics
import sys
import warnings
import zlib

ROOT = pathlib.Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "python"))
import stickslip
from stickslip.program import words_of

warnings.simplefilter("ignore", stickslip.AccuracyWarning)  # a discretisation fixed by hand is not refined

# Open MPI refuses root, and more ranks than cores, without these settings.
MPI_PERMISSIONS = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
                   "OMPI_MCA_rmaps_base_oversubscribe": "1",  # Open MPI 4
                   "PRTE_MCA_rmaps_default_mapping_policy": ":oversubscribe"}  # Open MPI 5


def script(case):
    """The words that run a case of the report alone: a folder's script, or an entry of paper.py."""
    own = f"validation/{case}/run.py"
    return [own] if (ROOT / own).exists() else ["validation/paper.py", case]


def seed_of(options):
    """Seed of what these options simulate: every case has its own, the same one each time. Files are no
    part of a case."""
    scene = {name: value for name, value in options.items() if not isinstance(value, pathlib.Path)}
    return zlib.crc32(" ".join(words_of(scene)).encode())


def simulates(options):
    return (options.get("route") == "monte_carlo"
            or "trajectory" in options.get("quantities", "").split(","))


class Program:
    """The program at a path, on so many ranks if that is no 0."""

    def __init__(self, path, ranks=0):
        self.path, self.ranks = path, ranks

    def results(self, **options):
        """Results of one run. What is simulated without a seed has that of seed_of."""
        if simulates(options):
            options = {"seed": seed_of(options), **options}
        try:
            return stickslip.run(program=self.path, ranks=self.ranks, **options)
        except (stickslip.ProgramError, stickslip.OutOfMemory) as problem:
            sys.exit(f"{' '.join(words_of(options))}\n{problem}")

    def run(self, **options):
        """The summary of one run."""
        return self.results(**options).summary


class Report:
    """Prints verdicts and remembers whether one was bad."""

    def __init__(self):
        self.failed = False

    def claim(self, text, worst, tolerance):
        """Holds if the largest deviation found is within the tolerance; a NaN is not."""
        self.verdict(worst <= tolerance, text, f"largest {worst:.2g}, allowed {tolerance:.3g}")

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


def entries(result):
    """Value, error and confidence interval of each number of a result; None where a method gives none of these."""
    values, errors, ends = (result.get(part) for part in ("value", "error", "ci95"))
    if not isinstance(values, list):
        return [(values, errors, ends)]
    return list(zip(values, errors or [None] * len(values), ends or [None] * len(values)))


def by_place(results):
    """The entries of all results by key and place."""
    return {(key, n): one for key, r in results.items() for n, one in enumerate(entries(r))}


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
