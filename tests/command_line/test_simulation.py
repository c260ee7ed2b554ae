"""Simulated excursions, comparisons with references, and trajectories."""

import csv
import unittest

import h5py
import numpy

from running import Case, SOURCES, run

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

    def test_ranks_give_equal_bits(self):
        options = (*SIMULATE, "-delta", "0", "-excursions", "600")
        self.assertEqual(self.summary(*options, ranks=3)["results"], self.summary(*options)["results"])


class Expressions(Case):
    """Drag laws given as text."""
    LAW = (*SMALL, "-drag", "expression", "-drag_expression")

    def test_a_built_in_law_written_out(self):
        built_in = self.summary(*SMALL, "-drag", "cubic", "-drag_cubic", "1", "-degree", "10")
        written = self.summary(*self.LAW, "-v - v^3", "-degree", "10")
        for key, result in built_in["results"].items():
            self.assert_close(written["results"][key]["value"], result["value"], 1e-13, key)

    def test_simulation_and_upwind_agree_with_elements(self):
        for law, other in (("-tanh(v)", "-2*tanh(v)"), ("-v^5", "-v")):
            with self.subTest(law=law):
                elements = self.summary(*self.LAW, law, "-accuracy", "1e-7")
                (self.folder / "summary.json").rename(self.folder / "elements.json")
                simulate = ("-route", "monte_carlo", "-excursions", "10000", "-compare",
                            "elements.json")
                self.run_ok(*self.LAW, law, *simulate)
                self.run_ok(*self.LAW, other, *simulate, status=3)
                if law == "-tanh(v)":
                    continue  # whose long tail takes a first-order scheme long
                upwind = self.summary(*self.LAW, law, "-scheme", "upwind", "-accuracy", "0.05")
                for key, result in upwind["results"].items():
                    difference = abs(result["value"] - elements["results"][key]["value"])
                    self.assertLessEqual(difference, 1.1 * result["error"] + 1e-9, key)

    def test_friction_that_weakens(self):
        options = (*SMALL, "-friction", "stribeck", "-stribeck_velocity", "0.1", "-quantities",
                   "sticking,moments,averages,entry_law", "-observable", "abs(v)>0.3")
        more = ("-bias", "0.2", "-mu_s_minus", "1.3", "-stribeck_exponent", "2")
        s = self.summary(*options, *more)
        self.assertEqual((s["scene"]["friction"], s["scene"]["stribeck_velocity"]), ("stribeck", 0.1))
        (self.folder / "summary.json").rename(self.folder / "elements.json")
        simulate = ("-route", "monte_carlo", "-excursions", "10000", "-compare", "elements.json")
        self.run_ok(*options, *more, *simulate)
        self.run_ok(*options, *more[:-2], *simulate, status=3)

    def test_files_hold_the_drag_law(self):
        s = self.summary(*self.LAW, "-tanh(v)", "-output", "out.h5")
        self.assertEqual(s["scene"]["drag_expression"], "-tanh(v)")
        self.assertNotIn("drag_coefficient", s["scene"])
        with h5py.File(self.folder / "out.h5") as file:
            self.assertEqual(file["record/options"].attrs["drag_expression"], "-tanh(v)")


class Refusals(Case):
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
        self.assertEqual(self.run_ok(*SIMULATE, "-excursions", "400000", "-compare", file,
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
