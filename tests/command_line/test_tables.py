"""What people read on standard output: digits, units, and lines of 100 characters."""

import re
import unittest

from running import Case

SMALL = ("-mu_d", "0.25", "-delta", "0.5")
GRIDS = ("-lambda", "0.5,2", "-omega", "0.1,1", "-time", "0.5,1", "-distance", "0.1,1", "-inverse_distance", "1",
         "-velocity", "0.3", "-tilt", "0.5", "-wavenumber", "1", "-probability", "0.9", "-observable", "v^2;stick")
FACTOR = r"(force|velocity|time)(\^\d)?"
PRODUCT = rf"{FACTOR}(\*{FACTOR})*"
UNIT = re.compile(rf"(1|{PRODUCT})(/{FACTOR}|/\({PRODUCT}\))?")


class Width(Case):
    def assert_narrow(self, *options, status=0, **how):
        for line in self.run_ok(*options, status=status, **how).stdout.splitlines():
            self.assertLessEqual(len(line), 100, line)
            self.assertEqual(line, line.rstrip())

    def test_schemes_and_routes(self):
        for options in (("-scheme", "upwind", "-accuracy", "1e-2"), ("-route", "lambda"), ("-route", "null_vector"),
                        ("-route", "hitting", "-quantities", "sticking"),
                        ("-route", "fluid_queue", "-drag", "none", "-quantities", "sticking"),
                        ("-route", "monte_carlo", "-excursions", "1000"),
                        ("-slide_ksp_type", "gmres", "-slide_pc_type", "ilu")):
            with self.subTest(options=options):
                self.assert_narrow(*SMALL, *options)
                self.assert_narrow(*SMALL, *options, "-plan")

    def test_plans_studies_sweeps_and_comparisons(self):
        self.assert_narrow(*SMALL, *GRIDS, "-plan", "-quantities", "sticking,entry_law,laplace,resolvent,spectrum,slip,"
                           "peak,displacement,duration_density,expectation,relaxation,large_deviation,sensitivity")
        for kind in ("p", "delta", "tau"):
            self.assert_narrow(*SMALL, "-study", kind, "-study_steps", "4")
        self.assert_narrow(*SMALL, "-study", "cost", "-study_steps", "4", "-study_repeats", "1",
                           "-quantities", "sticking")
        self.assert_narrow(*SMALL, "-sweep_mu_d", "0.25,0.5", "-sweep_tau", "0.5:1:3", "-route", "monte_carlo",
                           "-excursions", "1000")
        # What misses the accuracy has its reason in lines of its own.
        self.assert_narrow(*SMALL, "-sweep_tau", "0.5,1", "-accuracy", "1e-15", status=3)
        self.assert_narrow(*SMALL, "-accuracy", "1e-15", status=3)
        self.assert_narrow(*SMALL, "-route", "monte_carlo", "-excursions", "1000", "-output", "reference.h5")
        self.assert_narrow(*SMALL, "-compare", "reference.h5")


class Units(Case):
    def units(self, *options):
        found = {}
        for key, result in self.summary(*SMALL, *options)["results"].items():
            if "unit" in result:
                self.assertTrue(UNIT.fullmatch(result["unit"]), f"{key}: {result['unit']}")
                found[key] = result["unit"]
        return found

    def test_no_unit_is_a_nested_fraction(self):
        units = self.units("-friction", "stribeck", "-stribeck_velocity", "0.5", "-mu_d_minus", "0.3",
                           "-accuracy", "1e-2", "-quantities", "sticking,moments,noise_law,averages,entry_law,"
                           "sensitivity,laplace,slip,peak,displacement,autocorrelation,duration_density,"
                           "spectrum,relaxation", *GRIDS)
        for key, unit in (("dP_stick_ddrag_coefficient", "time"), ("dmean_stick_ddrag_coefficient", "time^2"),
                          ("dE_V2_ddrag_coefficient", "velocity^2*time"), ("dE_XV_dmu_d", "velocity"),
                          ("dP_stick_dmu_d", "1/force"), ("dE_XV_dstribeck_velocity", "force"),
                          ("f_slip", "1/(velocity*time)"), ("var_slip", "velocity^2*time^2"),
                          ("friction_power", "force*velocity"), ("S_0", "velocity^2*time")):
            self.assertEqual(units[key], unit)
        self.assertNotIn("dmean_stick_dtau", units)  # a pure number

    def test_simulated(self):
        units = self.units("-route", "monte_carlo", "-excursions", "2000",
                           "-quantities", "sticking,moments,averages,slip,displacement", *GRIDS)
        self.assertEqual(units["slip_rate"], "1/time")


class Words(Case):
    def test_levels_without_an_estimate(self):
        lines = self.run_ok(*SMALL).stdout.splitlines()
        start = next(n for n, line in enumerate(lines) if line.startswith("degree"))
        self.assertEqual([line.split()[-1] == "-" for line in lines[start + 1:start + 4]], [True, True, False])
        self.assertIn("-: no estimate yet; an error estimate compares 3 discretisations", lines)

    def test_checks_of_solution_methods_are_explained(self):
        for options in (("-quantities", "spectrum,duration_density,slip", *GRIDS), ("-route", "lambda"),
                        ("-route", "hitting", "-quantities", "sticking"), ("-route", "null_vector"),
                        ("-route", "fluid_queue", "-drag", "none", "-quantities", "sticking")):
            checks = self.summary(*SMALL, "-accuracy", "1e-3", *options)["cost"]["steps"][-1]["checks"]
            self.assertGreater(len(checks), 1)
            for name in checks:
                self.assertRegex(self.printed, rf"(?m)^{name} = \S+: [a-z]", name)


if __name__ == "__main__":
    unittest.main()
