"""Results do not depend on the number of ranks."""

import concurrent.futures
import subprocess
import unittest

import h5py
import numpy

from stickslip import BINARIES, Case, TWINS, run


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
        """The second rank alone runs in another folder, where the file of -output has no place."""
        (self.folder / "here" / "place").mkdir(parents=True)
        options = [str(BINARIES / "stickslip"), "-delta", "0.5", "-output", "place/out.h5"]
        done = subprocess.run(["mpiexec", "-n", "1", "-wdir", str(self.folder / "here"), *options,
                               ":", "-n", "1", "-wdir", str(self.folder), *options],
                              capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertEqual(done.stderr.count("-output = place/out.h5"), 1)


class Ranks(Case):
    OPTIONS = ("-mu_d", "0.25", "-delta", "0.25", "-accuracy", "1e-9", "-quantities",
               "sticking,moments,noise_law,entry_law,density", "-output", "out.h5")

    def solve(self, *options, **how):
        summary = self.summary(*options, **how)
        with h5py.File(self.folder / "out.h5") as file:
            return summary["results"], numpy.array(file["density/pdf"])

    def compare(self, *options, **how):
        results, field = self.solve(*options, **how)
        for ranks in (1, 2, 3):
            others, other_field = self.solve(*options, ranks=ranks, **how)
            for key, result in results.items():
                numpy.testing.assert_allclose(others[key]["value"], result["value"], rtol=1e-12,
                                              atol=0, err_msg=f"{key} on {ranks} ranks")
            numpy.testing.assert_allclose(other_field, field, rtol=1e-9, atol=1e-12)

    def test_hp(self):
        for twin in TWINS:
            self.compare(*self.OPTIONS, twin=twin)

    def test_upwind(self):
        not_reached = 3  # a fixed grid of first order: compared all the same
        self.compare(*self.OPTIONS, "-scheme", "upwind", "-p", "16", status=not_reached)

    def test_without_drag(self):
        self.compare(*self.OPTIONS, "-drag", "none")

    def test_more_ranks_than_levels(self):
        few = ("-delta", "0.5", "-noise_levels", "3", "-mu_d", "0.5", "-accuracy", "1e-8")
        one = self.summary(*few)["results"]
        many = self.summary(*few, ranks=5)["results"]
        for key, result in one.items():
            self.assert_close(many[key]["value"], result["value"], 1e-12, key)


if __name__ == "__main__":
    unittest.main()
