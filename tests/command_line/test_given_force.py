"""The motion under a given force: what is refused and what has no effect, and what files hold."""

import csv
import json
import unittest

from running import SOURCES, Case

RECORD = SOURCES / "options" / "given_force.csv"
ASKED = ("-quantities", "given_force", "-force_file")
HEADER = "time,force\n"


class GivenForce(Case):
    def refuse_file(self, text, *message):
        (self.folder / "record.csv").write_text(text)
        self.refuse(*ASKED, "record.csv", message=("-force_file = record.csv: ", *message, "; write CSV with the"))

    def test_files_that_are_no_record(self):
        self.refuse(*ASKED, "none.csv", message=("-force_file = none.csv: cannot be read", "write CSV"))
        self.refuse_file("", "Header missing")
        self.refuse_file(HEADER + "0,1\n", "has 1 samples")
        self.refuse_file(HEADER + "0,1\n1,2\n1,3\n", "line 4: time = 1 must be above 1")
        self.refuse_file(HEADER + "0,1\n# note\n1,2\n0.5,3\n", "line 5: time = 0.5 must be above 1")
        self.refuse_file(HEADER + "0,1\n1,nan\n2,0\n", "line 3: force = nan")
        self.refuse_file(HEADER + "0,1\n1,\n2,0\n", "line 3: force =  is no")
        self.refuse_file(HEADER + "0,1\n1\n2,0\n", "line 3")
        self.refuse_file("time;force\n0;1\n1;2\n", "time", "commas between numbers")
        self.refuse_file(HEADER + "0,0,1\n1,0,2\n", "line 2")  # decimal commas
        self.refuse_file("t,f\n0,1\n1,2\n", "time")
        even = "".join(f"{n / 10},1\n" for n in (*range(20), *range(25, 40)))
        self.refuse_file(HEADER + even, "line 22: time = 2.5 follows 1.9, where steps are 0.1: samples are missing")

    def test_samples_in_rows(self):
        given = [line.split(",") for line in RECORD.read_text().splitlines()[2:]]
        force = [value for _, value in given]
        (self.folder / "rows.txt").write_text("# made\n" + "".join(" ".join(force[n:n + 7]) + "\n" for n in range(0,
                                                                                                                  len(force),
                                                                                                                  7)))
        (self.folder / "commas.txt").write_text("\n".join(", ".join(force[n:n + 4]) for n in range(0, len(force), 4)))
        right = self.summary(*ASKED, RECORD)["results"]
        for name in ("rows.txt", "commas.txt"):
            found = self.summary(*ASKED, name, "-sample_layout", "rows", "-sample_step", "0.1")
            self.assert_close(found["results"]["final_displacement"]["value"], right["final_displacement"]["value"], 1e-12)
            self.assertEqual(found["results"]["slip_count"]["value"], right["slip_count"]["value"])
            self.assertEqual((found["scene"]["sample_layout"], found["scene"]["sample_step"]), ("rows", 0.1))
        rows = (*ASKED, "rows.txt", "-sample_layout", "rows")
        self.refuse(*rows, message=("-sample_layout = rows: rows have no times", "add -sample_step"))
        self.refuse(*ASKED, RECORD, "-sample_step", "0.1",
                    message=("-sample_step = 0.1: has no effect on columns", "add -sample_layout rows"))
        self.refuse(*rows, "-sample_step", "-1", message=("must be a number in (0, inf)",))
        (self.folder / "rows.txt").write_text(HEADER + "0,1\n1,2\n")
        self.refuse(*rows, "-sample_step", "0.1", message=("line 1: time is no finite number",))
        (self.folder / "rows.txt").write_text("1")
        self.refuse(*rows, "-sample_step", "0.1", message=("has 1 samples",))
        self.refuse(*ASKED, "rows.txt", message=("-sample_layout rows",))

    def test_rest(self):
        """Under a force of 2 a body with friction 1 reaches the velocity 1 in a time 1, and then stops in 1 more: 1/2 + 1/2."""
        (self.folder / "record.csv").write_text(HEADER + "0,2\n1,2\n")
        still = (*ASKED, "record.csv", "-drag", "none", "-mu_d", "1", "-force_interpolation", "constant")
        moving = self.summary(*still)["results"]
        self.assert_close(moving["final_displacement"]["value"], 0.5, 1e-12)
        rested = self.summary(*still, "-force_rest", "5")  # 2 lasts until the first sample of the rest
        self.assert_close(rested["results"]["final_displacement"]["value"], 4, 1e-12)
        self.assertEqual(rested["results"]["path_velocity"]["value"][-1], 0)
        self.assertEqual(rested["scene"]["force_rest"], 5)
        short = self.summary(*still, "-force_rest", "0.5")["results"]
        self.assert_close(short["final_displacement"]["value"], 1.125, 1e-12)
        self.refuse(*still, "-force_rest", "-1", message=("must be a number in [0, inf)",))

    def test_one_sample_that_is_appended(self):
        even = HEADER + "".join(f"{n / 10},2\n" for n in range(20))
        (self.folder / "record.csv").write_text(even + "2.0,0\n12,0\n")
        appended = self.summary(*ASKED, "record.csv", "-drag", "none")["results"]
        (self.folder / "record.csv").write_text(even + "12,0\n")
        self.refuse(*ASKED, "record.csv",
                    message=("samples are missing; for no force at the end leave this one out", "add -force_rest 10.1"))
        (self.folder / "record.csv").write_text(even)
        rested = self.summary(*ASKED, "record.csv", "-drag", "none", "-force_rest", "10.1")["results"]
        self.assert_close(rested["final_displacement"]["value"], appended["final_displacement"]["value"], 1e-12)

    def test_uneven_records_have_no_gaps(self):
        (self.folder / "record.csv").write_text(HEADER + "0,0\n1,2\n1.001,0\n9,0\n")
        self.run_ok(*ASKED, "record.csv")

    def test_what_it_needs_and_excludes(self):
        self.refuse("-quantities", "given_force", message=("but none is given", "add for example -force_file"))
        for method in ("monte_carlo", "null_vector"):
            self.refuse(*ASKED, RECORD, "-route", method, message=("does not give given_force",))
        self.refuse(*ASKED, RECORD, "-study", "p", message=("must be sticking, moments and noise_law",))
        self.refuse(*ASKED, RECORD, "-speed_limit", "1", message=("-speed_limit = 1: does not bound",))
        self.refuse(*ASKED, RECORD, "-sweep_tau", "1,2", message=("-sweep_tau: -tau = ", "has no effect"))
        self.refuse(*ASKED, RECORD, "-force_interpolation", "cubic", message=("linear or constant",))
        self.refuse(*ASKED, RECORD, "-mu_d", "2", message=("must be in [0, mu_s]",))

    def test_options_without_effect_are_named(self):
        for option, value in (("-tau", "2"), ("-delta", "0.5"), ("-noise", "telegraph"), ("-telegraph_rate", "3"),
                              ("-seed", "3"), ("-horizon", "3")):
            done = self.run_ok(*ASKED, RECORD, option, value)
            self.assertIn(f"{option} = {value} has no effect on the quantities asked for", done.stderr)
        done = self.run_ok("-quantities", "noise_law", "-force_file", RECORD, "-force_scale", "2")
        for option in ("-force_file", "-force_scale"):
            self.assertIn(f"{option} = ", done.stderr)

    def test_no_noise_is_looked_at(self):
        # No noise would move this body, and with ground accelerations in other units -delta would be fine.
        done = self.run_ok(*ASKED, RECORD, "-mu_s", "500", "-mu_d", "400", "-force_scale", "981")
        self.assertNotIn("tau", done.stdout)
        self.assertNotIn("noise", done.stdout)
        # Without drag and with a bias above mu_d, a record ends even where the noise would not.
        self.run_ok(*ASKED, RECORD, "-mu_d", "0.2", "-bias", "0.4", "-drag", "none")

    def test_a_velocity_at_the_first_sample(self):
        """10 m/s against 0.3 * 9.8 m/s^2: v^2/(2 mu g) = 17.0068 m."""
        (self.folder / "still.csv").write_text("# unit: m/s^2\n" + HEADER + "0,0\n10,0\n")
        block = (*ASKED, "still.csv", "-mu_s", "2.94", "-mu_d", "2.94", "-drag", "none", "-start")
        results = self.summary(*block, "0,10", folder=self.folder)["results"]
        self.assert_close(results["final_displacement"]["value"], 100 / 5.88, 1e-14)
        self.assert_close(results["slip_end"]["value"][0], 10 / 2.94, 1e-14)
        self.assert_close(self.summary(*block, "0,-10", folder=self.folder)["results"]["final_displacement"]["value"],
                          -100 / 5.88, 1e-14)
        self.run_ok(*block, "rest")
        self.refuse(*block, "2,10", message=("must be rest or 0,v under a given force", "take -start 0,10"))
        self.refuse(*block, "s+", message=("must be rest or 0,v",))
        done = self.run_ok(*block, "0,10", "-sweep_mu_d", "1,2.94", folder=self.folder)
        self.assertNotIn("tau", done.stdout)

    def test_units_of_the_record(self):
        (self.folder / "pulse.csv").write_text("# unit: m/s^2\n" + HEADER + "0,1\n1,4\n2,0\n")
        options = (*ASKED, "pulse.csv", "-mu_s", "1", "-mu_d", "1", "-drag", "none")
        self.assertIn("force of pulse.csv, at most 4 m/s^2 at time 1 s", self.run_ok(*options, folder=self.folder).stdout)
        results = self.summary(*options, folder=self.folder)["results"]
        for key, unit in (("final_displacement", "m"), ("largest_speed", "m/s"), ("slip_begin", "s"),
                          ("path_force", "m/s^2"), ("path_displacement", "m"), ("slip_peak", "m/s")):
            self.assertEqual(results[key]["unit"], unit, key)
        self.refuse_file("# unit: g\n" + HEADER + "0,1\n1,2\n", "unit: g: must be m/s^2")

    def test_vertical_accelerations(self):
        """Friction is mu (1 + a/g), with a times the size of -force_scale; what lifts off is refused."""
        def final(rows, *more):
            (self.folder / "v.csv").write_text("time,force,vertical\n" + rows)
            options = (*ASKED, "v.csv", "-mu_s", "2", "-mu_d", "2", "-drag", "none", "-start", "0,10", *more)
            return self.summary(*options, folder=self.folder)["results"]["final_displacement"]["value"]
        self.assert_close(final("0,0,5\n20,0,5\n", "-force_gravity", "10"), 100 / (2 * 3), 1e-14)
        self.assert_close(final("0,0,-5\n20,0,-5\n", "-force_gravity", "10"), 100 / (2 * 1), 1e-14)
        self.assert_close(final("0,0,5\n20,0,5\n", "-force_gravity", "10", "-force_scale", "-2"), 100 / (2 * 4), 1e-14)
        self.assert_close(final("0,0,5\n20,0,5\n", "-force_gravity", "10", "-force_interpolation", "constant"), 100 / 6, 1e-14)
        vertical = (*ASKED, "v.csv", "-mu_s", "2")
        self.refuse(*vertical, message=("its unit is not known", "add -force_gravity"))
        self.refuse(*vertical, "-force_gravity", "4", "-force_scale", "-1", "-friction", "stribeck", "-stribeck_velocity", "1",
                    message=("-friction = stribeck: does not go with a column vertical",))
        (self.folder / "v.csv").write_text("time,force,vertical\n0,0,0\n1,0,-5\n2,0,0\n")
        self.refuse(*vertical, "-force_gravity", "4", message=("lifts the body off the ground at time 1", "-force_gravity = 4"))
        self.run_ok(*vertical, "-force_gravity", "4", "-force_scale", "0.5")
        done = self.run_ok(*ASKED, RECORD, "-force_gravity", "9.81")
        self.assertIn("-force_gravity = 9.81 has no effect without a column vertical", done.stderr)

    def test_files(self):
        text = self.run_ok(*ASKED, RECORD, "-drag", "none", "-mu_d", "1", "-summary", "s.json", "-output", "h.h5",
                           "-trajectory", "p.csv", folder=self.folder).stdout
        self.assertIn("accuracy 1e-06 reached", text)
        summary = json.loads((self.folder / "s.json").read_text())
        results = summary["results"]
        rows = list(csv.DictReader((self.folder / "p.csv").read_text().splitlines()))
        given = [line.split(",") for line in RECORD.read_text().splitlines()[2:]]
        self.assertEqual([[float(row["time"]), float(row["force"])] for row in rows],
                         [[float(time), float(force)] for time, force in given])
        for key, name in (("path_velocity", "velocity"), ("path_displacement", "displacement")):
            self.assertEqual([float(row[name]) for row in rows], results[key]["value"])
            self.assertEqual(len(results[key]["error"]), len(rows))
        self.assertEqual(results["final_displacement"]["value"], results["path_displacement"]["value"][-1])
        self.assertEqual(len(results["slip_end"]["value"]), results["slip_count"]["value"])
        self.assertAlmostEqual(sum(results["slip_displacement"]["value"]), results["final_displacement"]["value"], 13)
        self.assertAlmostEqual(max(results["slip_peak"]["value"]), results["largest_speed"]["value"], 14)
        slid = sum(e - b for b, e in zip(results["slip_begin"]["value"], results["slip_end"]["value"]))
        self.assertAlmostEqual(slid / 20, results["sliding_share"]["value"], 13)
        self.assertEqual(summary["scene"]["force_file"], str(RECORD))
        self.assertNotIn("tau", summary["scene"])

    def test_scale_and_sign(self):
        one = self.summary(*ASKED, RECORD, "-force_scale", "2", "-mu_s", "2", "-mu_d", "2")["results"]
        other = self.summary(*ASKED, RECORD, "-force_scale", "-1")["results"]
        self.assert_close(one["final_displacement"]["value"], -2 * other["final_displacement"]["value"], 1e-13)
        constant = self.summary(*ASKED, RECORD, "-force_interpolation", "constant")["results"]
        self.assertNotAlmostEqual(constant["final_displacement"]["value"], -other["final_displacement"]["value"], 3)

    def test_beside_the_noise(self):
        text = self.run_ok("-quantities", "sticking,trajectory", "-force_file", RECORD, "-accuracy", "1e-3").stdout
        for key in ("P_stick", "final_displacement", "tau = 1"):
            self.assertIn(key, text)

    def test_sweep_plan_and_comparison(self):
        options = (*ASKED, RECORD, "-drag", "none", "-mu_d", "0.8")
        self.run_ok(*options, "-sweep_mu_s", "0.8,1,3", "-sweep_force_scale", "1,1.5", "-summary", "sweep.json",
                    "-output", "sweep.h5", folder=self.folder)
        runs = json.loads((self.folder / "sweep.json").read_text())["runs"]
        self.assertEqual(len(runs), 6)
        alone = self.summary(*options, "-mu_s", "1", "-force_scale", "1.5")["results"]
        self.assertEqual(runs[3]["results"]["final_displacement"]["value"], alone["final_displacement"]["value"])
        self.assertEqual(runs[4]["results"]["slip_count"]["value"], 0)  # the force stays below 3
        self.assertIn("no linear system", self.run_ok(*options, "-plan").stdout)
        self.run_ok(*options, "-output", "a.h5", folder=self.folder)
        done = self.run_ok(*options, "-compare", "a.h5", folder=self.folder)
        self.assertIn("no significant disagreement", done.stdout)
        self.run_ok(*options, "-force_scale", "1.01", "-compare", "a.h5", folder=self.folder, status=3)

    def test_a_body_that_friction_holds(self):
        """Forces from -3 to 2 do not move a body that 3 and 1 + 1 hold; a little more of one does."""
        (self.folder / "record.csv").write_text(HEADER + "0,2\n1,-3\n2,0\n")
        held = (*ASKED, "record.csv", "-mu_s", "3", "-mu_d", "1", "-bias", "1", "-mu_s_minus", "2", "-drag", "none")
        done = self.run_ok(*held)
        for part in ("never moves: forces of record.csv reach from -3 to 2, and friction holds it from -3 to 2",
                     "are both in one unit"):
            self.assertIn(part, done.stderr)
        for more in (("-mu_s", "2.99"), ("-mu_s_minus", "1.99"), ("-force_scale", "1.01"), ("-bias", "1.01")):
            self.assertNotIn("never moves", self.run_ok(*held, *more).stderr)

    def test_errors_hold(self):
        # Where the force hardly exceeds static friction, its rounding decides on a slip.
        (self.folder / "record.csv").write_text(HEADER + "0,0\n1,1.000000000000002\n2,0\n3,2\n4,0\n")
        done = self.run_ok(*ASKED, "record.csv", "-mu_d", "0.5", folder=self.folder, status=3)
        self.assertIn("rounding decides how often the body slips", done.stdout.replace("\n  ", " "))


if __name__ == "__main__":
    unittest.main()
