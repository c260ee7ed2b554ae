"""A drag law, a noise, a quantity and an output with files of their own: all that the program does with them follows
from what they declare."""

import csv
import os
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "command_line"))
import unittest

from running import BINARIES, SOURCES, Case, run

sys.path.insert(0, str(SOURCES / "python"))
import matplotlib.pyplot as plt
import stickslip
from stickslip import explore
from stickslip.plots import style

PROGRAM = "stickslip-extended"
MODEL = ("-mu_d", "0.5", "-accuracy", "1e-5")
DRAG = ("-drag", "quadratic", "-drag_quadratic", "2")
WAITING = (*MODEL, "-quantities", "waiting")
NOISE = ("-noise", "three_levels", "-step_force", "2", "-step_rate", "0.5", "-step_end_rate", "3")
QUADRATIC, PULSES = (*MODEL, *DRAG), (*MODEL, *NOISE)


class Extension(Case):
    def solved(self, *options):
        return self.summary(*options, program=PROGRAM)

    def test_help_lists_what_they_declare(self):
        text = self.run_ok("-help", program=PROGRAM).stdout
        for part in ("-drag_quadratic", "c2 of the quadratic drag law", "-sweep_drag_quadratic", "-step_force",
                     "three_levels"):
            self.assertIn(part, text)

    def test_values_are_validated(self):
        for options, part in (((*QUADRATIC, "-drag_quadratic", "-1"), "-drag_quadratic = -1: must be a number in (0, inf)"),
                              ((*MODEL, "-step_rate", "1"), "belongs to -noise three_levels, and -noise is ou"),
                              ((*MODEL, "-noise", "three_levels"), "-noise = three_levels: needs -step_force"),
                              ((*MODEL, "-drag", "quadratc"), "did you mean quadratic?")):
            done = run(*options, program=PROGRAM, folder=self.folder)
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertIn(part, done.stderr)
        done = self.run_ok(*MODEL, "-drag_quadratic", "2", program=PROGRAM)
        self.assertIn("-drag_quadratic = 2 has no effect with -drag linear", done.stderr)

    def test_the_drag_law_is_that_of_its_formula(self):
        own = self.solved(*QUADRATIC)
        self.assertIn("drag_quadratic = 2", self.printed)
        self.assertEqual((own["scene"]["drag"], own["scene"]["drag_quadratic"]), ("quadratic", 2))
        formula = self.solved(*MODEL, "-drag", "expression", "-drag_expression", " -2*v*abs(v)")
        self.assertEqual(own["results"], formula["results"])

    def test_the_noise_is_that_of_its_levels(self):
        own = self.solved(*PULSES)
        self.assertEqual(own["scene"]["step_end_rate"], 3)
        (self.folder / "levels.csv").write_text("x,rate_up,rate_down\n-2,3,0\n0,0.5,0.5\n2,0,3\n")
        levels = self.solved(*MODEL, "-noise", "file", "-noise_file", "levels.csv")
        self.assertEqual(own["results"], levels["results"])

    def test_both_are_simulated_and_a_checkpoint_knows_their_values(self):
        both = ("-mu_d", "0.5", *DRAG, *NOISE)
        computed = self.folder / "computed.json"
        self.run_ok(*both, "-summary", computed, program=PROGRAM)
        simulation = (*both, "-route", "monte_carlo", "-excursions", "20000", "-checkpoint", "simulation.h5")
        self.run_ok(*simulation, "-compare", computed, program=PROGRAM)
        for change in (("-drag_quadratic", "2.5"), ("-step_rate", "0.6")):
            done = run(*simulation, *change, program=PROGRAM, folder=self.folder)
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertIn(change[0], done.stderr)

    def test_a_sweep(self):
        self.run_ok(*QUADRATIC[:-2], "-sweep_drag_quadratic", "1,2", "-sweep_csv", "sweep.csv", program=PROGRAM)
        lines = (self.folder / "sweep.csv").read_text().splitlines()
        rows = list(csv.DictReader(line for line in lines if not line.startswith("#")))
        single = self.solved(*QUADRATIC)["results"]["E_V2"]["value"]
        self.assertEqual([float(row["drag_quadratic"]) for row in rows], [1, 2])
        self.assert_close(float(rows[1]["E_V2"]), single, 1e-12)

    def test_a_quantity_is_in_the_help_and_in_the_plan(self):
        text = self.run_ok("-help", program=PROGRAM).stdout
        self.assertIn("mean time to the next start of a sliding phase: mean_waiting.", " ".join(text.split()))
        self.assertIn("| `mean_waiting` |", self.run_ok("-reference_quantities", program=PROGRAM).stdout)
        plan = self.solved(*WAITING, "-plan")["plan"]
        self.assertEqual([task["name"] for task in plan["tasks"]], ["stationary distribution", "waiting times"])
        self.assertEqual((plan["factorizations"], plan["solves"]), (1, 5))
        done = run(*MODEL, "-quantities", "wating", program=PROGRAM, folder=self.folder)
        self.assertIn("did you mean waiting?", done.stderr)

    def test_a_quantity_is_computed_beside_others(self):
        for bias in (), ("-bias", "0.3"):
            results = self.solved(*MODEL, *bias, "-quantities", "waiting,laplace", "-lambda", "1")["results"]
            mean, variance = (results[key]["value"] for key in ("mean_excursion", "var_excursion"))
            self.assert_close(results["mean_waiting"]["value"], (variance + mean**2) / (2 * mean), 1e-12)
            self.assertEqual(results["mean_waiting"]["unit"], "time")
            self.assertLess(results["mean_waiting"]["error"], 1e-5 * results["mean_waiting"]["value"])

    def test_a_quantity_is_simulated(self):
        for bias in (), ("-bias", "0.3"):
            computed = self.folder / "computed.json"
            self.run_ok(*WAITING, *bias, "-summary", computed, program=PROGRAM)
            simulation = ("-mu_d", "0.5", *bias, "-route", "monte_carlo", "-excursions", "20000")
            self.run_ok(*simulation, "-compare", computed, program=PROGRAM)
            self.run_ok(*simulation, "-quantities", "waiting", "-checkpoint", "simulation.h5", program=PROGRAM)
            done = run(*simulation, "-quantities", "sticking", "-checkpoint", "simulation.h5", program=PROGRAM,
                       folder=self.folder)
            self.assertIn("-quantities", done.stderr)
            (self.folder / "simulation.h5").unlink()

    def test_a_sweep_of_a_quantity(self):
        self.run_ok(*WAITING[2:], "-sweep_mu_d", "0.5,0.75", "-sweep_csv", "sweep.csv", program=PROGRAM)
        lines = (self.folder / "sweep.csv").read_text().splitlines()
        rows = list(csv.DictReader(line for line in lines if not line.startswith("#")))
        single = self.solved(*WAITING)["results"]["mean_waiting"]["value"]
        self.assert_close(float(rows[0]["mean_waiting"]), single, 1e-12)

    def test_an_output_holds_the_results(self):
        results = self.solved(*QUADRATIC, "-quantities", "sticking,entry_law", "-markdown", "table.md")["results"]
        rows = [line.strip("| ").split(" | ") for line in (self.folder / "table.md").read_text().splitlines()]
        self.assertEqual(rows[0], ["quantity", "value", "error"])
        scalars = {key: r for key, r in results.items() if not isinstance(r["value"], list)}
        self.assertEqual({key: (float(value), float(error)) for key, value, error in rows[2:]},
                         {key: (r["value"], r["error"]) for key, r in scalars.items()})

    def test_an_output_is_an_option_as_others_are(self):
        for page in ("-help", "-reference", "-completion"):
            self.assertIn("-markdown", self.run_ok(page, program=PROGRAM).stdout)
        for options, part in ((("-markdown", "none/table.md"), "-markdown = none/table.md: is in a folder that does not"),
                              (("-markdown", "table.md", "-sweep_mu_d", "0.5,1"), "is a file for one run, not for a"),
                              (("-markdwn", "table.md"), "did you mean -markdown?")):
            done = run(*MODEL, *options, program=PROGRAM, folder=self.folder)
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertIn(part, done.stderr)

    def test_other_names_of_options_and_words(self):
        for options, meant in ((("-newton_drag", "1"), "-drag_quadratic"), (("-drag", "newton"), "quadratic")):
            done = run(*MODEL, *options, program=PROGRAM, folder=self.folder)
            self.assertIn(f"did you mean {meant}?", done.stderr)

    def use_in_python(self):
        os.environ["STICKSLIP"] = str(BINARIES / PROGRAM)
        self.addCleanup(os.environ.pop, "STICKSLIP")

    def test_python(self):
        self.use_in_python()
        results = stickslip.run(mu_d=0.5, accuracy=1e-5, drag="quadratic", drag_quadratic=2)
        self.assertEqual(results["E_V2"].value, self.solved(*QUADRATIC)["results"]["E_V2"]["value"])
        results = stickslip.run(mu_d=0.5, accuracy=1e-5, quantities="waiting")
        self.assertEqual(results["mean_waiting"].value, self.solved(*WAITING)["results"]["mean_waiting"]["value"])

    def test_pictures_name_their_parameters(self):
        self.use_in_python()
        both = {"mu_d": 0.5, "accuracy": 1e-2, "drag": "quadratic", "drag_quadratic": 2, "noise": "three_levels",
                "step_force": 2, "step_end_rate": 3}
        self.assertEqual(style.title(stickslip.run(**both)),
                         r"$\mu_s$ = 1, $\mu_d$ = 0.5, $F$ = 2, $\nu$ = 1, step_end_rate = 3, $b(v) = -2 v |v|$")
        axes = stickslip.sweep(**{**both, "step_rate": [0.5, 1]}).plot()["P_stick"].axes[0]
        self.assertEqual(axes.get_xlabel(), r"rate of the pulses $\nu$  [1/time]")

    def test_the_explorer_has_their_sliders(self):
        self.use_in_python()
        asked = []
        made = explore.Explorer(plt.figure(), {}, {}, compute=lambda cancel, **options: asked.append(options))
        self.addCleanup(made.solver.close)

        def shown():
            return {option for option, slider in made.sliders.items() if slider.ax.get_visible()}

        own = {"drag_quadratic", "step_force", "step_rate"}
        self.assertFalse(own & shown())
        made.choose("drag", "quadratic")
        made.choose("noise", "three_levels")
        self.assertEqual(own | {"mu_s", "mu_d", "mu_s_minus", "mu_d_minus", "bias", "spring_stiffness"}, shown())
        self.assertIn("$c_2$", made.sliders["drag_quadratic"].label.get_text())
        self.assertEqual({option: made.scene()[option] for option in own},
                         {"drag_quadratic": 2, "step_force": 2, "step_rate": 0.5})


if __name__ == "__main__":
    unittest.main()
