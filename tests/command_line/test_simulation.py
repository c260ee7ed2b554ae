"""Simulated excursions, their checkpoints, comparisons with references, and trajectories."""

import csv
import json
import signal
import subprocess
import unittest

import h5py
import numpy

from running import BINARIES, Case, SOURCES, run

SMALL = ("-mu_d", "0.25", "-delta", "0.25")
SIMULATE = (*SMALL, "-route", "monte_carlo")
EVERYTHING = ("-quantities",
              "sticking,moments,noise_law,entry_law,laplace,duration_density,spectrum",
              "-lambda", "0.5,2", "-time", "0.5,1,3", "-omega", "0,1")


class Simulated(Case):
    def test_intervals_in_both_files(self):
        s = self.summary(*SIMULATE, *EVERYTHING, "-excursions", "5000", "-output", "out.h5")
        with h5py.File(self.folder / "out.h5") as file:
            for key, result in s["results"].items():
                group = file["results"][key]
                numpy.testing.assert_array_equal(group["value"], result["value"])
                if key == "E_V":  # 0 by symmetry, not simulated
                    continue
                ends = numpy.array(result["ci95"])
                numpy.testing.assert_array_equal(group["low"], ends[..., 0])
                numpy.testing.assert_array_equal(group["high"], ends[..., 1])
                self.assertTrue(numpy.all(ends[..., 0] <= result["value"]), key)
                self.assertTrue(numpy.all(ends[..., 1] >= result["value"]), key)

    def test_computed_results_have_no_intervals(self):
        self.assertNotIn("ci95", self.summary(*SMALL)["results"]["P_stick"])

    def test_ranks_give_equal_bits(self):
        for options in ((*EVERYTHING, "-excursions", "20000"), ("-delta", "0", "-excursions", "600")):
            alone = self.summary(*SIMULATE, *options)["results"]
            for ranks in (1, 2, 3):
                self.assertEqual(self.summary(*SIMULATE, *options, ranks=ranks)["results"], alone)

    def test_seeds(self):
        options = (*SIMULATE, "-excursions", "1000")
        first, same, other = (self.summary(*options, "-seed", seed)["results"]
                              for seed in (1, 1, 2))
        self.assertEqual(first, same)
        self.assertNotEqual(first["P_stick"], other["P_stick"])

    def test_accuracy(self):
        few = run(*SIMULATE, "-excursions", "5000", "-accuracy", "1e-4", folder=self.folder)
        self.assertEqual(few.returncode, 3)
        self.assertIn("it would take about -excursions", few.stdout + few.stderr)
        s = self.summary(*SIMULATE, "-excursions", "1e8", "-accuracy", "0.02")
        self.assertTrue(s["accuracy"]["reached"])
        for key, result in s["results"].items():
            self.assertLessEqual(result["error"], 0.02 * abs(result["value"]), key)


class Expressions(Case):
    """Drag laws given as text."""
    LAW = (*SMALL, "-drag", "expression", "-drag_expression")

    def test_a_built_in_law_written_out(self):
        built_in = self.summary(*SMALL, "-drag", "cubic", "-drag_cubic", "1", "-degree", "10")
        written = self.summary(*self.LAW, "-v - v^3", "-degree", "10")
        for key, result in built_in["results"].items():
            self.assert_close(written["results"][key]["value"], result["value"], 1e-13, key)

    def test_simulation_and_upwind_agree_with_elements(self):
        for law, other in (("-tanh(v)", "-2*tanh(v)"), ("-v - 0.1*v*abs(v)", "-v - v*abs(v)"),
                           ("-v^5", "-v")):
            with self.subTest(law=law):
                elements = self.summary(*self.LAW, law, "-accuracy", "1e-7")
                (self.folder / "summary.json").rename(self.folder / "elements.json")
                simulate = ("-route", "monte_carlo", "-excursions", "10000", "-compare",
                            "elements.json")
                self.run_ok(*self.LAW, law, *simulate)
                self.run_ok(*self.LAW, other, *simulate, status=3)
                upwind = self.summary(*self.LAW, law, "-scheme", "upwind", "-accuracy", "0.05")
                for key, result in upwind["results"].items():
                    difference = abs(result["value"] - elements["results"][key]["value"])
                    self.assertLessEqual(difference, 1.1 * result["error"] + 1e-9, key)

    def test_friction_that_weakens(self):
        options = (*SMALL, "-friction", "stribeck", "-stribeck_velocity", "0.1", "-quantities",
                   "sticking,moments,averages,entry_law", "-observable", "abs(v)>0.3")
        for more, other in ((("-stribeck_exponent", "2"), ("-stribeck_exponent", "1")),
                            (("-bias", "0.2", "-mu_s_minus", "1.3"), ("-bias", "0.3"))):
            with self.subTest(more=more):
                s = self.summary(*options, *more)
                self.assertEqual(s["scene"]["friction"], "stribeck")
                self.assertEqual(s["scene"]["stribeck_velocity"], 0.1)
                (self.folder / "summary.json").rename(self.folder / "elements.json")
                simulate = ("-route", "monte_carlo", "-excursions", "10000", "-compare",
                            "elements.json")
                self.run_ok(*options, *more, *simulate)
                self.run_ok(*options, *other, *simulate, status=3)

    def test_files_hold_the_drag_law(self):
        s = self.summary(*self.LAW, "-tanh(v)", "-output", "out.h5")
        self.assertEqual(s["scene"]["drag_expression"], "-tanh(v)")
        self.assertNotIn("drag_coefficient", s["scene"])
        with h5py.File(self.folder / "out.h5") as file:
            self.assertEqual(file["record/options"].attrs["drag_expression"], "-tanh(v)")

    def test_a_checkpoint_of_another_law(self):
        options = ("-route", "monte_carlo", "-excursions", "2000", "-checkpoint", "run.checkpoint")
        self.run_ok(*self.LAW, "-tanh(v)", *options)
        self.run_ok(*self.LAW, "-tanh(v)", *options)
        other = self.run_ok(*self.LAW, "-tanh(2*v)", *options, status=2)
        self.assertIn('-drag_expression "-tanh(v)", not "-tanh(2*v)"', other.stderr)

    def test_a_checkpoint_of_other_friction(self):
        options = (*SMALL, "-route", "monte_carlo", "-excursions", "2000", "-checkpoint",
                   "run.checkpoint", "-friction", "stribeck", "-stribeck_velocity")
        self.run_ok(*options, "0.1")
        other = self.run_ok(*options, "0.2", status=2)
        self.assertIn("-stribeck_velocity", other.stderr)


class Refusals(Case):
    def test_months(self):
        self.refuse("-mu_s", "6", "-mu_d", "0.25", *SIMULATE[2:], message=("-excursions", "days"))
        self.refuse(*SIMULATE, "-excursions", "1e15", message=("-excursions", "days"))

    def test_choices_of_a_grid(self):
        for option, value in (("-degree", "5"), ("-layers", "3"), ("-p", "8"), ("-scheme", "hp")):
            self.refuse(*SIMULATE, option, value, message=(option, "does not apply to -route monte_carlo"))

    def test_numbers(self):
        self.refuse(*SIMULATE, "-excursions", "1", message=("-excursions = 1",))
        self.refuse(*SIMULATE, "-excursions", "2.5", message=("-excursions = 2.5",))
        self.refuse(*SIMULATE, "-seed", "-1", message=("-seed = -1",))
        self.refuse(*SMALL, "-quantities", "trajectory", "-trajectory", "t.csv", "-horizon", "0",
                    message=("-horizon = 0",))
        self.refuse(*SMALL, "-quantities", "trajectory", "-trajectory", "t.csv", "-horizon", "1e9",
                    message=("-horizon", "jumps"))

    def test_trajectory_without_a_file(self):
        self.refuse(*SMALL, "-quantities", "trajectory",
                    message=("-quantities", "-output FILE.h5 or -trajectory FILE.csv"))

    def test_questions_it_cannot_answer(self):
        self.refuse(*SIMULATE, "-quantities", "relaxation", message=("relaxation", "monte_carlo"))


class Checkpoints(Case):
    OPTIONS = (*SIMULATE, *EVERYTHING, "-excursions", "2000000")

    def simulate(self, *options, **how):
        return self.summary(*self.OPTIONS, *options, **how)["results"]

    def interrupt(self, file):
        """Kills a run soon after its first checkpoint."""
        command = [BINARIES / "stickslip", *self.OPTIONS, "-checkpoint", file]
        with subprocess.Popen([*map(str, command)], stdout=subprocess.DEVNULL,
                              cwd=self.folder) as process:
            self.addCleanup(process.kill)
            self.wait_for_file(file, process, lines=2)
            process.send_signal(signal.SIGKILL)
            return process.wait()

    def test_killed_and_continued(self):
        file = self.folder / "run.checkpoint"
        self.assertEqual(self.interrupt(file), -signal.SIGKILL)
        kept = json.loads(file.read_text().splitlines()[1])
        self.assertGreater(kept["rounds"], 0)
        self.assertLess(kept["rounds"], 2000000 // (64 * 256))
        continued = self.simulate("-checkpoint", file)
        self.assertEqual(continued, self.simulate())
        self.assertEqual([f.name for f in self.folder.iterdir() if ".part" in f.name], [])

    def test_more_excursions_later_on_other_ranks(self):
        file = self.folder / "run.checkpoint"
        few = (*SIMULATE, "-excursions", "20000")
        more = (*SIMULATE, "-excursions", "40000")
        self.summary(*few, "-checkpoint", file)
        self.assertEqual(self.summary(*more, "-checkpoint", file, ranks=2)["results"],
                         self.summary(*more)["results"])

    def test_damaged_and_foreign(self):
        file = self.folder / "run.checkpoint"
        few = (*SIMULATE, "-excursions", "20000", "-checkpoint", file)
        self.run_ok(*few)
        good = file.read_text()
        for options, message in (((), "damaged"), (("-seed", "2"), '-seed "1", not "2"'),
                              (("-mu_d", "0.3"), '-mu_d "0.25", not "0.3"')):
            file.write_text(good if options else good[:-100])
            done = run(*few, *options, folder=self.folder)
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertIn(message, done.stderr)
            self.assertIn("-checkpoint", done.stderr)


class Compared(Case):
    # Of a million excursions by one plain loop with random numbers of its own, and with jumps 2 % too fast.
    LOOP = SOURCES / "tests/data/plain_loop.csv"
    TOO_FAST = SOURCES / "tests/data/plain_loop_fast.csv"

    def test_agrees_with_the_plain_loop(self):
        file = self.LOOP
        s = self.summary(*SMALL, "-compare", file)
        self.assertFalse(s["comparison"]["disagrees"])
        self.assertEqual(s["comparison"]["left_out"], [])
        table = run(*SMALL, "-compare", file, folder=self.folder).stdout
        self.assertIn(f"comparison with {file}", table)
        self.assertIn("agrees", table)

    def test_a_jump_rate_off_by_two_per_cent_is_seen(self):
        file = self.TOO_FAST
        s = self.summary(*SMALL, "-compare", file, status=3)
        self.assertTrue(s["comparison"]["disagrees"])
        table = run(*SMALL, "-compare", file, folder=self.folder)
        self.assertIn("DISAGREES", table.stdout)
        self.assertEqual(self.run_ok(*SIMULATE, "-excursions", "1000000", "-compare", file,
                                     status=3).returncode, 3)

    def test_files_of_this_program(self):
        self.run_ok(*SIMULATE, *EVERYTHING, "-excursions", "20000", "-output", "simulated.h5",
                    "-summary", "simulated.json")
        for name in ("simulated.h5", "simulated.json"):
            # Questions and arguments come from the file.
            s = self.summary(*SMALL, "-compare", name)
            self.assertFalse(s["comparison"]["disagrees"], name)
            self.assertEqual(s["comparison"]["left_out"], [], name)
            self.assertEqual(s["results"]["F_slide"]["lambda"], [0.5, 2])
            self.assertEqual(s["results"]["cdf_stick"]["time"], [0.5, 1, 3])

    def test_nothing_in_common_is_no_agreement(self):
        (self.folder / "other.csv").write_text("quantity,argument,value,low,high\nS_v,1,0.3,0.2,0.4\n")
        done = run(*SMALL, "-quantities", "sticking", "-compare", "other.csv", folder=self.folder)
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertIn("NOTHING was compared", done.stdout)

    def test_a_checkpoint_of_questions_from_another_file(self):
        for value in ("1", "2"):
            (self.folder / f"{value}.csv").write_text(
                f"quantity,argument,value,low,high\nF_slide,{value},0.5,0,1\n")
        options = (*SIMULATE, "-excursions", "20000", "-checkpoint", "run.checkpoint", "-compare")
        self.run_ok(*options, "1.csv")
        done = run(*options, "2.csv", folder=self.folder)
        self.assertEqual(done.returncode, 2, done.stdout)
        self.assertIn("-checkpoint", done.stderr)

    def test_bad_files(self):
        header = "quantity,argument,value,low,high\n"
        for name, text, message in (
                ("none.csv", None, "cannot be read"),
                ("a.txt", header, ".h5, .json or .csv"),
                ("a.csv", header + "P_stick,,x,,\n", "line 2"),
                ("b.csv", header, "holds no values"),
                ("c.csv", "P_stick,1\n", "not a CSV file of reference values"),
                ("a.json", "{", "not a JSON summary"),
                ("a.h5", "text", "not a readable HDF5 file")):
            if text is not None:
                (self.folder / name).write_text(text)
            done = run(*SMALL, "-compare", name, folder=self.folder)
            self.assertEqual(done.returncode, 2, name + done.stdout)
            self.assertEqual(done.stdout, "")
            self.assertIn(f"-compare = {name}", done.stderr)
            self.assertIn(message, done.stderr)

    def test_hdf5_of_others(self):
        with h5py.File(self.folder / "a.h5", "w") as file:
            file["values"] = [1.0, 2.0]
        done = run(*SMALL, "-compare", "a.h5", folder=self.folder)
        self.assertEqual(done.returncode, 2)
        self.assertIn("has no group /results", done.stderr)


class Trajectories(Case):
    OPTIONS = (*SMALL, "-quantities", "trajectory", "-horizon", "30", "-start", "0.5,-0.75",
               "-trajectory", "path.csv", "-output", "path.h5")

    def columns(self):
        with open(self.folder / "path.csv", newline="") as file:
            rows = list(csv.reader(file))
        self.assertEqual(rows[0], ["time", "x", "y", "v"])
        return numpy.array(rows[1:], dtype=float).T

    def test_both_files(self):
        self.run_ok(*self.OPTIONS)
        t, x, y, v = self.columns()
        with h5py.File(self.folder / "path.h5") as file:
            for name, column in zip(("time", "x", "y", "v"), (t, x, y, v)):
                numpy.testing.assert_array_equal(file["trajectory"][name], column)
        self.assertEqual((t[0], t[-1]), (0, 30))
        self.assertEqual((x[0], y[0], v[0]), (0.5, -1, -0.75))
        self.assertTrue(numpy.all(numpy.diff(t) > 0))
        self.assertTrue(numpy.all(numpy.isin(numpy.diff(x), (-0.25, 0, 0.25))))
        self.assertTrue(numpy.all(v[y == 0] == 0))
        self.assertTrue(numpy.all(v * y >= 0))

    def test_seed_and_ranks(self):
        found = []
        for how in ({}, {"ranks": 2}, {"seed": 2}):
            self.run_ok(*self.OPTIONS, "-seed", how.pop("seed", 1), **how)
            found.append(self.columns())
        numpy.testing.assert_array_equal(found[0], found[1])
        self.assertFalse(numpy.array_equal(found[0], found[2]))

    def test_beside_computed_results(self):
        s = self.summary(*SMALL, "-quantities", "sticking,trajectory", "-trajectory", "path.csv")
        self.assertEqual(s["results"], self.summary(*SMALL, "-quantities", "sticking")["results"])
        self.assertEqual(self.columns()[0][-1], 100)


if __name__ == "__main__":
    unittest.main()
