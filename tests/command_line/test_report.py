"""Pictures of what the program wrote, and what the report is made with."""

import contextlib
import importlib.util
import io
import os
import pathlib
import subprocess
import sys
import unittest
from unittest import mock

from running import BINARIES, SOURCES, Case

sys.path.insert(0, str(SOURCES / "validation"))
import entry
import harness

SCENE = ("-mu_d", "0.25", "-delta", "0.5")
PNG = b"\x89PNG"


def plot(*words, folder):
    return subprocess.run([sys.executable, "-m", "stickslip", "plot", *words], capture_output=True, text=True,
                          cwd=folder, env={**os.environ, "PYTHONPATH": str(SOURCES / "python")})


class Pictures(Case):
    def drawn(self, *words):
        """The pictures that it names."""
        done = plot(*words, folder=self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        names = done.stdout.split()
        for name in names:
            self.assertTrue((self.folder / name).read_bytes().startswith(PNG), name)
        return names

    def test_the_script_follows_what_is_in_the_file(self):
        self.run_ok(*SCENE, "-route", "monte_carlo", "-excursions", "1000", "-output", "reference.h5")
        for options, pictures in (
                (("-quantities", "density,spectrum", "-omega", "0.1,1,10"),
                 ["f_density.png", "f_spectra.png"]),
                (("-quantities", "trajectory", "-horizon", "10"), ["f.png"]),
                (("-quantities", "duration_density", "-time", "0:1:5", "-accuracy", "1e-2"), ["f.png"]),
                (("-quantities", "slip,peak,displacement", "-distance", "1,2", "-velocity", "0.5", "-time", "1,2",
                  "-accuracy", "1e-2"), ["f.png"]),
                (("-compare", "reference.h5"), ["f.png"]),
                (("-quantities", "noise_law", "-sweep_tau", "0.5,1"), ["f/E_X2.png", "f/P_X_le_mu_s.png"])):
            self.run_ok(*SCENE, *options, "-output", "f.h5")
            self.assertEqual(sorted(self.drawn("f.h5")), pictures)

    def test_noises_without_a_step(self):
        (self.folder / "levels.csv").write_text("x,rate_up,rate_down\n-1,1,0\n0.5,1,1\n2,0,2\n")
        for noise in (("-noise", "file", "-noise_file", "levels.csv"),
                      ("-noise", "telegraph", "-telegraph_amplitude", "1", "-telegraph_rate", "2", "-bias", "0.2")):
            self.run_ok("-mu_d", "0.5", *noise, "-quantities", "density,spectrum,duration_density,trajectory",
                        "-omega", "0.1,1,10", "-time", "0:1:5", "-horizon", "10", "-accuracy", "1e-2", "-output", "f.h5")
            self.assertEqual(sorted(self.drawn("f.h5")), [
                f"f_{kind}.png" for kind in ("density", "durations", "spectra", "trajectory")])

    def test_csv_of_paths_and_sweeps(self):
        self.run_ok(*SCENE, "-quantities", "trajectory", "-horizon", "10", "-trajectory", "path.csv")
        self.run_ok(*SCENE, "-quantities", "noise_law", "-sweep_tau", "0.5,1", "-sweep_csv", "s.csv")
        self.assertEqual(self.drawn("path.csv", "named.png"), ["named.png"])
        self.assertIn("s/E_X2.png", self.drawn("s.csv"))

    def refused(self, *words, message):
        done = plot(*words, folder=self.folder)
        self.assertEqual((done.returncode, done.stdout), (2, ""), done.stderr)
        for part in (words[0], message):
            self.assertIn(part, done.stderr)
        self.assertEqual(list(self.folder.glob("*.png")), [])

    def test_files_that_cannot_be_drawn_are_refused(self):
        self.run_ok(*SCENE, "-output", "scalars.h5", "-quantities", "noise_law,trajectory")
        (self.folder / "text.h5").write_text("text")
        (self.folder / "cut.h5").write_bytes((self.folder / "scalars.h5").read_bytes()[:-9])
        (self.folder / "foreign.csv").write_text("a,b\n1,2\n")
        self.refused("none.h5", message="no such file")
        self.refused("text.h5", message="HDF5")
        self.refused("cut.h5", message="HDF5")
        self.refused("foreign.csv", message="neither a sweep nor a path")
        self.run_ok(*SCENE, "-output", "scalars.h5", "-quantities", "noise_law")
        self.refused("scalars.h5", message="nothing to draw; ask the program")
        self.run_ok(*SCENE, "-output", "path.h5", "-quantities", "trajectory")
        for picture in ("none/path.png", "path.foo"):
            done = plot("path.h5", picture, folder=self.folder)
            self.assertEqual(done.returncode, 2)
            self.assertIn(picture, done.stderr)

    def test_bootstrap_draws(self):
        file = self.folder / "path.h5"
        self.run_ok(*SCENE, "-output", file, "-quantities", "trajectory", "-horizon", "10")
        done = subprocess.run([SOURCES / "bootstrap", "plot", file], capture_output=True, text=True)
        self.assertEqual(done.stdout, f"{file.with_suffix('.png')}\n", done.stderr)
        done = subprocess.run([SOURCES / "bootstrap", "plot", "none.h5"], capture_output=True)
        self.assertEqual(done.returncode, 2)


class Report(unittest.TestCase):
    def test_every_simulated_scene_has_its_own_seed(self):
        scene = {"route": "monte_carlo", "mu_d": 0.25, "delta": 0.5}
        others = ({**scene, "mu_d": 0.5}, {**scene, "delta": 0.25}, {**scene, "quantities": "laplace"})
        seeds = [harness.seed_of(one) for one in (scene, *others)]
        self.assertEqual(len(set(seeds)), 4)
        self.assertEqual(harness.seed_of({**scene, "output": pathlib.Path("f.h5")}), seeds[0])

    def test_seeds_reach_the_program(self):
        program = harness.Program("program")
        with mock.patch("subprocess.Popen", side_effect=OSError) as run:
            for options, seeded in (({"route": "monte_carlo"}, True), ({"mu_d": 1}, False),
                                    ({"quantities": "sticking,trajectory"}, True)):
                self.assertRaises(SystemExit, program.run, **options)
                self.assertEqual("-seed" in run.call_args.args[0], seeded)

    def test_tables_have_no_empty_column(self):
        with mock.patch("sys.argv", ["run.py"]), contextlib.redirect_stdout(io.StringIO()):
            made = entry.Entry("Title.", "paper")
            made.scratch.cleanup()
            made.table("caption", ("a", "b", "c"), [("1", "", 2.0), ("", "", 3.0)])
        self.assertEqual((made.parts[0]["columns"], made.parts[0]["rows"]),
                         (["a", "c"], [["1", "2"], ["", "3"]]))


def case(name):
    """The module of a case of validation/ that can be imported."""
    spec = importlib.util.spec_from_file_location(name, SOURCES / "validation" / name / "run.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


class Faults(unittest.TestCase):
    """The case of the report that shows them; ctest runs the faults themselves without it."""

    def test_it_names_tests_that_there_are(self):
        faults, loader = case("faults"), unittest.TestLoader()
        loader.loadTestsFromNames(faults.QUICK + faults.LONG)
        self.assertEqual(loader.errors, [])

    def test_a_fault_that_is_not_seen_fails(self):
        class Lost(unittest.TestCase):
            def runTest(self):
                """disk full: nothing half written"""
                self.fail("half written")

        result = case("faults").Timed()
        with contextlib.redirect_stderr(io.StringIO()):
            Lost().run(result)
        self.assertEqual(result.rows[0][:3], ("disk full", "nothing half written", "FAILS"))

    def test_damaged_input_is_counted(self):
        shown = mock.Mock()
        with mock.patch.dict("os.environ", STICKSLIP_BINARIES=str(BINARIES)):
            case("faults").fuzz_runs(shown, 3)
        self.assertRegex(shown.text.call_args.args[0], "runs")
        self.assertEqual(shown.claim.call_args.args[1:], (0, 0.5))


if __name__ == "__main__":
    unittest.main()
