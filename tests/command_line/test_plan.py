"""Only what a scene calls for: plans, and effects that are not asked for."""

import json
import unittest

from running import Case, SOURCES

SMALL = ("-mu_d", "0.25", "-delta", "0.5")


class Plans(Case):
    def test_nothing_is_computed(self):
        done = self.run_ok(*SMALL, "-plan", "-quantities", "sticking,density",
                           "-output", "density.h5")
        self.assertNotIn("P_stick", done.stdout)
        self.assertIn("1 transposed", done.stdout)
        self.assertEqual(list(self.folder.iterdir()), [])

    def test_shipped_scenes_warn_of_nothing(self):
        for file in sorted((SOURCES / "options").rglob("*.opts")):
            if "\n-sweep_" in file.read_text():
                continue  # which has no plan; test_scenes runs it
            path = ("-trajectory", self.folder / "path.csv") if file.stem == "trajectory" else ()
            with self.subTest(scene=file.name):
                self.assertEqual(self.run_ok("-options_file", file, "-plan", *path, folder=SOURCES).stderr, "")

    def test_what_does_not_fit(self):
        """The table shows it, as far as it is known; then the message of the run."""
        done = self.run_ok("-plan", "-scheme", "upwind", "-p", "100000", "-delta", "0.01", status=4)
        self.assertEqual(done.stdout.count("too large"), 2)
        self.assertIn("factorisations", done.stdout)
        self.assertIn("of memory, and", done.stderr)

    def test_words(self):
        for words in (("-plan",), ("-plan", "yes")):
            self.assertIn("nonzeros", self.run_ok(*SMALL, *words).stdout)
        self.assertIn("P_stick", self.run_ok(*SMALL, "-plan", "no").stdout)
        self.assertIn("-plan = maybe", self.run_ok(*SMALL, "-plan", "maybe", status=2).stderr)

    def test_summary_agrees_with_the_run(self):
        asked = ("-quantities", "sticking,entry_law,laplace", "-lambda", "0.5,2")
        plan = self.summary(*SMALL, *asked, "-plan")["plan"]
        run = self.summary(*SMALL, *asked)
        steps = len(run["cost"]["steps"])
        self.assertEqual(plan["assemblies"] * steps, run["plan"]["assemblies"])
        self.assertEqual(plan["factorizations"] * steps, run["plan"]["factorizations_real"])
        self.assertEqual(plan["solves"] * steps, run["plan"]["solves"])
        self.assertFalse(plan["adaptive"])
        for predicted, made in zip(plan["steps"], run["cost"]["steps"]):
            self.assertEqual(predicted["unknowns"], made["unknowns"])
            self.assertEqual(predicted["nonzeros"], made["nonzeros"])

    def test_other_routes(self):
        self.assertIn("closed-form results", self.run_ok("-quantities", "noise_law", "-plan").stdout)
        self.assertIn("are simulated",
                      self.run_ok(*SMALL, "-route", "monte_carlo", "-plan").stdout)
        self.assertIn("v of both signs", self.run_ok(*SMALL, "-route", "hitting", "-quantities",
                                                     "sticking", "-plan").stdout)
        for more in (("-study", "p"), ("-sweep_tau", "1,2")):
            self.assertIn("-plan", self.run_ok("-plan", *more, status=2).stderr)


class UnaskedEffects(Case):
    """A term with coefficient 0 leaves no trace, to the last bit."""

    ASKED = ("-quantities", "sticking,moments,noise_law,entry_law,spectrum", "-omega", "1")

    def of(self, *options):
        s = self.summary(*SMALL, *self.ASKED, *options)
        return json.dumps(s["results"]), s["plan"]

    def test_zero_coefficients(self):
        plain = self.of()
        for options in (("-bias", "0"), ("-bias", "-0.0"),
                        ("-drag", "cubic", "-drag_cubic", "0"),
                        ("-horizon", "50"), ("-excursions", "10"), ("-study", "none")):
            with self.subTest(options=options):
                self.assertEqual(self.of(*options), plain)
        none = self.of("-drag", "none")
        self.assertEqual(self.of("-drag_coefficient", "0"), none)
        self.assertNotEqual(none, plain)


if __name__ == "__main__":
    unittest.main()
