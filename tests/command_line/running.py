"""Runs the built programs as a user would; shared by the command-line tests."""

import json
import os
import pathlib
import subprocess
import tempfile
import time
import unittest

BINARIES = pathlib.Path(os.environ["STICKSLIP_BINARIES"])
SOURCES = pathlib.Path(__file__).resolve().parents[2]
VARIANTS = os.environ.get("STICKSLIP_VARIANTS", "real,complex").split(",")
PROGRAMS = ("stickslip", "stickslip-complex") if "complex" in VARIANTS else ("stickslip",)


def run(*options, program="stickslip", ranks=0, folder=None, environment=None):
    """The finished process; options are words of the command line."""
    command = [str(BINARIES / program), *map(str, options)]
    if ranks:
        command = ["mpiexec", "-n", str(ranks), *command]
    return subprocess.run(command, capture_output=True, text=True, cwd=folder, timeout=600,
                          env={**os.environ, **(environment or {})})


def relative_difference(a, b):
    return 0 if a == b else abs(a - b) / max(abs(a), abs(b))


class Case(unittest.TestCase):
    """A test with a folder of its own."""

    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.folder = pathlib.Path(holder.name)

    def run_ok(self, *options, status=0, folder=None, **how):
        done = run(*options, folder=folder or self.folder, **how)
        self.assertEqual(done.returncode, status, done.stderr)
        return done

    def refuse(self, *options, message):
        """Bad input: status 2, all parts of the message on standard error, nothing else."""
        done = run(*options, folder=self.folder)
        self.assertEqual(done.returncode, 2, done.stdout + done.stderr)
        self.assertEqual(done.stdout, "")
        for part in message:
            self.assertIn(part, done.stderr)

    def summary(self, *options, **how):
        """Runs to the end and returns what -summary wrote; `printed` is what went to standard output."""
        file = self.folder / "summary.json"
        self.printed = self.run_ok(*options, "-summary", file, **how).stdout
        return json.loads(file.read_text())

    def wait_for_file(self, file, process, lines=0):
        """Until a process wrote it, with that many lines; a failure if it ends first, or takes two minutes."""
        end = time.monotonic() + 120
        while not file.exists() or file.read_bytes().count(b"\n") < lines:
            if process.poll() is not None or time.monotonic() > end:
                process.kill()
                self.fail(f"{file.name} was not written")
            time.sleep(0.02)

    def assert_close(self, found, expected, tolerance, message=None):
        self.assertLessEqual(relative_difference(found, expected), tolerance, message)
