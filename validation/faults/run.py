"""Faults of the machine and damaged input: nothing is lost, hangs or is half written.

Faults are provoked: processes are killed, disks are full, folders are read-only, memory runs out, one of several
ranks has bad input. Each must be reported with its exit status, and files must be whole or absent.

Input is damaged at random, bit by bit and line by line, and given to whole runs and to each reader alone. A refusal
with a message is right, and so is a result where the damage leaves valid input. A crash, a hang or a message from
within is a fault.

usage: python3 validation/faults/run.py [--quick] [--program build/stickslip] [--report FOLDER]

The faults are tests of tests/command_line, damaged input comes from tests/fuzz. The readers alone are tried where
fuzz_readers stands beside the program.
"""

import os
import pathlib
import subprocess
import sys
import time
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from entry import Entry
from harness import MPI_PERMISSIONS, ROOT

QUICK = ("test_faults.Disks", "test_faults.Memory", "test_faults.OneRank",
         "test_parallel.OneRankAlone.test_bad_input_of_one_rank_ends_all")
LONG = ("test_faults.Killed", "test_sweep.Interrupted.test_killed_and_continued",
        "test_sweep.Interrupted.test_killed_and_continued_on_three_ranks",
        "test_sweep.Interrupted.test_a_lost_checkpoint_ends_all_ranks")
SEED = "2"  # ctest has the first


class Timed(unittest.TestResult):
    """Rows of the table, one a test."""

    def __init__(self):
        super().__init__()
        self.rows = []

    def startTest(self, test):
        super().startTest(test)
        self.start = time.monotonic()

    def stopTest(self, test):
        super().stopTest(test)
        bad = [words for tests in (self.failures, self.errors) for t, words in tests if t is test]
        skipped = any(t is test for t, _ in self.skipped)
        fault, _, seen = (test.shortDescription() or test.id()).partition(": ")
        how = "FAILS" if bad else "cannot be provoked here" if skipped else "yes"
        self.rows.append((fault, seen, how, f"{time.monotonic() - self.start:.1f}"))
        for words in bad:
            print(words, file=sys.stderr)


def faults(entry):
    os.environ |= {"STICKSLIP_BINARIES": str(entry.program.path.resolve().parent),
                   **MPI_PERMISSIONS}
    sys.path.insert(0, str(ROOT / "tests" / "command_line"))
    result = Timed()
    names = QUICK if entry.quick else QUICK + LONG
    unittest.defaultTestLoader.loadTestsFromNames(names).run(result)
    entry.table("Faults that are provoked, and what must be seen",
                ("fault", "what must be seen", "seen", "seconds"), result.rows)
    lost = sum(how == "FAILS" for _, _, how, _ in result.rows)
    entry.claim(f"faults of {len(result.rows)} that lose, hang or leave something half", lost, 0.5)


def fuzz_runs(entry, count):
    done = subprocess.run([sys.executable, ROOT / "tests" / "fuzz" / "programs.py", str(count), SEED],
                          capture_output=True, text=True)
    *found, counts = done.stdout.strip().splitlines() or [done.stderr[-500:]]
    entry.text(f"Damaged input to whole runs: {counts}")
    entry.claim(f"faults of {count} whole runs with damaged input",
                max(sum(line.startswith("run ") for line in found), done.returncode), 0.5)


def fuzz_readers(entry, count):
    program = entry.program.path.resolve().parent / "fuzz_readers"
    if not program.exists():
        entry.text("fuzz_readers is not built here: the readers alone were not tried.")
        return
    done = subprocess.run([program, str(count), SEED], capture_output=True, text=True)
    lines = [line.rsplit(maxsplit=4) for line in done.stdout.splitlines()]
    rows = [row for row in lines if len(row) == 5 and row[1].isdigit()]
    entry.table("Damaged input to the readers", ("input", "all", "taken", "refused", "faults"), rows)
    entry.claim("readers with faults", sum(row[4] != "0" for row in rows[:-1])
                + (done.returncode != 0 or not rows), 0.5)


def main():
    entry = Entry(__doc__, "beyond the paper")
    faults(entry)
    fuzz_runs(entry, 100 if entry.quick else 1000)
    fuzz_readers(entry, 2000 if entry.quick else 10000)
    entry.end()


if __name__ == "__main__":
    main()
