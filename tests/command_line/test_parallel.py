"""Results do not depend on the number of ranks."""

import concurrent.futures
import subprocess
import unittest

import h5py
import numpy

from running import BINARIES, Case, PROGRAMS, run


class Together(Case):
    def test_single_processes_do_not_disturb_one_another(self):
        def alone(n):
            return run("-delta", "0.5", "-quantities", "sticking", "-output", f"{n}.h5",
                       folder=self.folder)

        with concurrent.futures.ThreadPoolExecutor(8) as pool:
            for done in pool.map(alone, range(24)):
                self.assertEqual((done.returncode, done.stderr), (0, ""))


class OneRankAlone(Case):
    def test_bad_input_of_one_rank_ends_all(self):
        """bad input of one rank of two (its folder is missing): reported once, status 2, all end"""
        (self.folder / "here" / "place").mkdir(parents=True)
        options = [str(BINARIES / "stickslip"), "-delta", "0.5", "-output", "place/out.h5"]
        done = subprocess.run(["mpiexec", "-n", "1", "-wdir", str(self.folder / "here"), *options,
                               ":", "-n", "1", "-wdir", str(self.folder), *options],
                              capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertEqual(done.stderr.count("-output = place/out.h5"), 1)

    def test_ranks_with_different_options(self):
        program = str(BINARIES / "stickslip")
        done = subprocess.run(["mpiexec", "-n", "1", program, "-delta", "0.5", ":", "-n", "1", program, "-mu_s", "3"],
                              capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertIn("rank 1 has other options than rank 0", done.stderr)


class Ranks(Case):
    OPTIONS = ("-mu_d", "0.25", "-delta", "0.25", "-accuracy", "1e-9", "-quantities",
               "sticking,moments,noise_law,entry_law,density", "-output", "out.h5")

    def solve(self, *options, **how):
        summary = self.summary(*options, **how)
        with h5py.File(self.folder / "out.h5") as file:
            return summary["results"], numpy.array(file["density/pdf"])

    def compare(self, *options, **how):
        results, field = self.solve(*options, **how)
        others, other_field = self.solve(*options, ranks=3, **how)
        self.assert_same(others, results, 3)
        numpy.testing.assert_allclose(other_field, field, rtol=1e-9, atol=1e-12)

    def test_hp(self):
        for program in PROGRAMS:
            self.compare(*self.OPTIONS, program=program)

    def test_every_level_a_node(self):
        self.compare(*self.OPTIONS, "-noise_degree", "0", "-slide_pc_type", "lu")

    def test_upwind(self):
        not_reached = 3  # a fixed grid of first order: compared all the same
        self.compare(*self.OPTIONS, "-scheme", "upwind", "-p", "16", status=not_reached)

    def test_without_drag(self):
        self.compare(*self.OPTIONS, "-drag", "none")

    # By models that grow until they are good enough, and eigenvalues of a matrix far from normal:
    # rounding, and with it the number of ranks, decides within the error.
    WITHIN_ERROR = ("relaxation_", "f_slide", "f_stick", "f_excursion", "cdf_", "C_vv", "E(")

    def assert_same(self, many, one, ranks):
        self.assertEqual(many.keys(), one.keys())
        for key, result in one.items():
            value, other = (numpy.atleast_1d(r["value"]) for r in (result, many[key]))
            allowed = 1e-12 * numpy.abs(value)
            if key.startswith(self.WITHIN_ERROR) and key != "f_stick_0":
                error = numpy.atleast_1d(result["error"])
                allowed = numpy.maximum(allowed, 3 * numpy.max(error))
            away = numpy.abs(other - value) - allowed
            self.assertLessEqual(numpy.max(away), 0, f"{key} on {ranks} ranks: {other} {value}")

    def compare_all(self, *options, ranks=3):
        self.assert_same(self.summary(*options, ranks=ranks)["results"], self.summary(*options)["results"], ranks)

    def test_every_quantity(self):
        scene = ("-mu_d", "0.25", "-delta", "0.25", "-observable", "v^2; x*v", "-start", "s+")
        for quantities in (("sticking,moments,noise_law,entry_law,laplace,F_stick,resolvent,"
                            "sensitivity", "-lambda", "0,0.1,1,10"),
                           ("relaxation,spectrum", "-omega", "0.1,1,10"),
                           # One degree: errors of reduced models may ask for another step.
                           ("duration_density,autocorrelation,expectation", "-time", "0.5,1,3",
                            "-degree", "9")):
            with self.subTest(quantities[0]):
                self.compare_all(*scene, "-quantities", *quantities)

    def test_without_symmetry(self):
        self.compare_all("-delta", "0.25", "-bias", "0.3", "-quantities",
                         "sticking,moments,noise_law,spectrum")

    def test_more_ranks_than_levels(self):
        self.compare_all("-delta", "0.5", "-noise_levels", "3", "-mu_d", "0.5", "-accuracy",
                         "1e-8", ranks=5)


if __name__ == "__main__":
    unittest.main()
