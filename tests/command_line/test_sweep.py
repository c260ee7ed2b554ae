"""Sweeps: the same bits on any number of ranks and after any interruption, and what they write."""

import csv
import json
import math
import os
import random
import signal
import subprocess
import time
import unittest

import h5py
import numpy

from running import BINARIES, Case, run

SMALL = ("-delta", "0.5", "-sweep_mu_d", "0.25,0.5,1", "-sweep_tau", "0.5:1:2")
MANY = ("-delta", "0.25", "-sweep_mu_d", "0.1:1:6", "-sweep_tau", "0.5:2:8")


class Interrupted(Case):
    def killed_at(self, count, seconds, checkpoint, *options, ranks=0):
        """Starts a sweep and kills all its processes, `seconds` after the checkpoint holds so many
        points; whether that came before its end."""
        command = [str(BINARIES / "stickslip"), *options]
        if ranks:
            command = ["mpiexec", "-n", str(ranks), *command]
        with subprocess.Popen(command, cwd=self.folder, stdout=subprocess.DEVNULL,
                              stderr=subprocess.DEVNULL, start_new_session=True) as process:
            while process.poll() is None and self.points(checkpoint) < count:
                time.sleep(0.001)
            try:
                process.wait(seconds)
                return False
            except subprocess.TimeoutExpired:
                os.killpg(process.pid, signal.SIGKILL)
                return True

    @staticmethod
    def points(checkpoint):
        """Finished points in a checkpoint."""
        return max(0, checkpoint.read_text().count("\n") - 1) if checkpoint.exists() else 0

    def check(self, ranks):
        moment = random.Random(ranks)
        whole, pieces, checkpoint = (self.folder / name for name in ("whole.csv", "pieces.csv", "kept"))
        self.run_ok(*MANY, "-sweep_csv", whole, ranks=ranks)
        options = (*MANY, "-checkpoint", str(checkpoint), "-sweep_csv", str(pieces))
        kills = 0
        while self.points(checkpoint) < 36:
            kills += self.killed_at(self.points(checkpoint) + moment.randrange(9),
                                    moment.uniform(0.001, 0.03), checkpoint, *options, ranks=ranks)
            self.assertFalse(pieces.exists() and self.points(checkpoint) < 48)
        self.assertGreater(kills, 1)
        s = self.summary(*options, ranks=ranks)
        self.assertGreater(s["sweep"]["from_record"], 0)
        self.assertEqual(pieces.read_bytes(), whole.read_bytes())
        self.assertEqual([f.name for f in self.folder.iterdir() if ".part" in f.name], [])

    def test_killed_and_continued(self):
        """kill -9 at random moments of a sweep: finished points are kept, the same CSV in the end"""
        self.check(0)

    def test_killed_and_continued_on_three_ranks(self):
        """kill -9 at random moments of a sweep on three ranks: the same"""
        self.check(3)

    def test_times_come_from_the_checkpoint(self):
        options = (*SMALL, "-checkpoint", "kept")
        first, second = self.summary(*options), self.summary(*options, ranks=2)
        self.assertEqual(second["sweep"]["from_record"], 6)
        self.assertEqual(second["runs"], first["runs"])

    def test_a_lost_checkpoint_ends_all_ranks(self):
        """folder of a checkpoint vanishes under three ranks: a message, status 1, all end"""
        place = self.folder / "place"
        place.mkdir()
        with subprocess.Popen(["mpiexec", "-n", "3", BINARIES / "stickslip", "-delta", "0.25",
                               "-sweep_tau", "0.5:2:4000", "-checkpoint", place / "kept"],
                              stderr=subprocess.PIPE, stdout=subprocess.DEVNULL,
                              text=True) as process:
            self.addCleanup(process.kill)
            self.wait_for_file(place / "kept", process)
            place.rename(self.folder / "moved")  # at once, unlike removing file by file
            _, message = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 1)
        self.assertIn("kept: No such file", message)


class Numbers(Case):

    def test_ranks(self):
        self.run_ok(*MANY, "-sweep_csv", "one.csv")
        self.run_ok(*MANY, "-sweep_csv", "three.csv", ranks=3)
        self.assertEqual((self.folder / "three.csv").read_bytes(), (self.folder / "one.csv").read_bytes())


class Files(Case):
    def test_all_tell_the_same(self):
        done = self.run_ok(*SMALL, "-summary", "s.json", "-output", "s.h5", "-sweep_csv", "s.csv")
        runs = json.loads((self.folder / "s.json").read_text())["runs"]
        with open(self.folder / "s.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        with h5py.File(self.folder / "s.h5") as file:
            sweep = {name: numpy.array(values) for name, values in file["sweep"].items()}
            self.assertEqual(file["sweep"].attrs["axes"], "mu_d,tau")
            self.assertEqual(file["sweep/mean_stick"].attrs["unit"], "time")
            self.assertEqual(file["record/options"].attrs["sweep_mu_d"], "0.25,0.5,1")
            self.assertIn("commit", file["record"].attrs)
        numpy.testing.assert_array_equal(sweep["mu_d"], [0.25, 0.5, 1])
        numpy.testing.assert_array_equal(sweep["tau"], [0.5, 1])
        for n, (entry, row) in enumerate(zip(runs, rows)):
            place = numpy.unravel_index(n, (3, 2))
            self.assertEqual(float(row["mu_d"]), sweep["mu_d"][place[0]])
            self.assertEqual(entry["scene"]["tau"], sweep["tau"][place[1]])
            self.assertEqual((row["status"], sweep["status"][place]), ("reached", 0))
            self.assertEqual(entry["cost"]["seconds"], sweep["seconds"][place])
            for key, result in entry["results"].items():
                self.assertEqual(sweep[key][place], result["value"])
                self.assertEqual(sweep[key + "_error"][place], result["error"])
                self.assertEqual(float(row[key]), result["value"])
                self.assertEqual(float(row[key + "_error"]), result["error"])
                decimals = -math.floor(math.log10(result["error"])) if result["error"] else 0
                self.assertIn(f" {result['value']:.{decimals}f} ", done.stdout)

    def test_arrays_of_different_length(self):
        s = self.summary("-delta", "0.5", "-sweep_mu_s", "1,2", "-quantities", "entry_law,laplace",
                         "-lambda", "0.5,1,2", "-output", "s.h5")
        with h5py.File(self.folder / "s.h5") as file:
            sweep = {name: numpy.array(values) for name, values in file["sweep"].items()}
        self.assertEqual(sweep["F_slide"].shape, (2, 3))
        self.assertEqual(sweep["entry_law"].shape, (2, 9))
        numpy.testing.assert_array_equal(sweep["F_slide_lambda"], [[0.5, 1, 2]] * 2)
        for n, length in enumerate((5, 9)):
            law = s["runs"][n]["results"]["entry_law"]
            for name, values in (("entry_law", law["value"]), ("entry_law_k", law["k"])):
                numpy.testing.assert_array_equal(sweep[name][n][:length], values)
                self.assertTrue(numpy.isnan(sweep[name][n][length:]).all())

    def test_numbers_of_an_option_are_columns(self):
        """As the rows of the summary, and in the table as long as they are few."""
        asked = ("-delta", "0.5", "-sweep_tau", "0.5,1", "-quantities", "F_stick,entry_law", "-accuracy", "1e-3")
        for count, shown in ((2, True), (9, False)):
            rates = [0.5 * n for n in range(1, count + 1)]
            done = self.run_ok(*asked, "-lambda", ",".join(map(str, rates)), "-sweep_csv", "s.csv", "-summary", "s.json")
            runs = json.loads((self.folder / "s.json").read_text())["runs"]
            with open(self.folder / "s.csv", newline="") as file:
                rows = list(csv.DictReader(file))
            for entry, row in zip(runs, rows):
                result = entry["results"]["F_stick"]
                for n, rate in enumerate(rates):
                    self.assertEqual(float(row[f"F_stick[{rate:g}]"]), result["value"][n])
                    self.assertEqual(float(row[f"F_stick[{rate:g}]_error"]), result["error"][n])
                self.assertEqual(len(row), 2 * count + 4)  # and f_stick_0, but no entry_law, whose levels are nobody's
            self.assertEqual("F_stick[1]" in done.stdout, shown)
            self.assertEqual("F_stick by lambda: in the files" in done.stdout, not shown)
            self.assertIn("entry_law by k: in the files", done.stdout)

    def test_progress_on_request(self):
        self.assertEqual(run(*SMALL).stderr, "")
        self.assertIn("6 of 6 points; ", run(*SMALL, "-progress", "on").stderr)


class Ends(Case):
    def refuse(self, *options, message):
        before = {f.name: f.read_bytes() for f in self.folder.iterdir()}
        done = run(*options, "-sweep_csv", "out.csv", folder=self.folder)
        self.assertEqual((done.returncode, done.stdout), (2, ""), done.stderr)
        self.assertEqual({f.name: f.read_bytes() for f in self.folder.iterdir()}, before)
        for part in message:
            self.assertIn(part, done.stderr)

    def test_bad_input(self):
        self.refuse("-sweep_mu_d", "3,2", "-checkpoint", "kept", message=("at mu_d = 2: ",))
        self.refuse("-sweep_mud", "0.5", message=("did you mean -sweep_mu_d?",))
        self.refuse("-sweep_tau", "0", message=("-sweep_tau = 0", "(0, inf)"))
        self.refuse("-sweep_tau", "1,2", "-study", "p", message=("-study = p",))
        self.refuse("-sweep_tau", "1,2", "-quantities", "density", message=("density",))

    def test_foreign_and_damaged_checkpoints(self):
        kept = self.folder / "kept"
        self.run_ok(*SMALL, "-checkpoint", kept)
        good = kept.read_text()
        for message, *other in (("-accuracy", "-accuracy", "1e-5"),
                             ("-sweep_tau", "-sweep_tau", "0.5:1:3"),
                             ('-mu_s "1", not "swept"', "-sweep_mu_s", "1,2"),
                             ("-slide_mat_mumps_icntl_7", "-slide_mat_mumps_icntl_7", "0")):
            self.refuse(*SMALL, "-checkpoint", kept, *other, message=("-checkpoint", message))
        self.refuse(*SMALL, "-checkpoint", kept, "-route", "monte_carlo", message=("-route",))
        for bad in ("precious", good + "{}\n", good.replace('"reached"', '"well"', 1)):
            kept.write_text(bad)
            self.refuse(*SMALL, "-checkpoint", kept, message=("-checkpoint", "remove it"))

    def test_every_rank_knows_a_foreign_checkpoint_but_one_reports(self):
        (self.folder / "kept").write_text("precious")
        done = run(*SMALL, "-checkpoint", "kept", ranks=3, folder=self.folder)
        self.assertEqual(done.returncode, 2)
        self.assertEqual(done.stderr.count("is no checkpoint of a sweep"), 1)

    def test_refused_points_stop_no_other_and_are_not_kept(self):
        options = ("-delta", "0.5", "-accuracy", "1e-4", "-sweep_mu_d", "2,0.5", "-sweep_csv",
                   "s.csv", "-output", "s.h5", "-checkpoint", "kept")
        for kept in (0, 1):
            s = self.summary(*options, status=3)
            self.assertEqual(s["sweep"]["from_record"], kept)
            self.assertEqual([r["status"] for r in s["runs"]], ["refused", "reached"])
            self.assertIn("must be in [0, mu_s]", s["runs"][0]["message"])
            self.assertIn(",refused\n", (self.folder / "s.csv").read_text())
            with h5py.File(self.folder / "s.h5") as file:
                self.assertEqual(file["sweep/status"][:].tolist(), [4, 0])
                self.assertTrue(math.isnan(file["sweep/P_stick"][0]))


if __name__ == "__main__":
    unittest.main()
