"""Faults of the machine: processes killed, disks full, folders read-only, memory short.

What was complete stays and is readable; nothing half written is left; nothing hangs; the exit
status says what it was. The first line of each test is "fault: what must be seen".
"""

import json
import os
import random
import resource
import signal
import subprocess
import tempfile
import time
import unittest

import h5py

from running import BINARIES, Case, run

SMALL = ("-mu_d", "0.25", "-delta", "0.25")
SIMULATE = (*SMALL, "-route", "monte_carlo", "-excursions", "2e6", "-seed", "3", "-quantities",
            "sticking,moments")
LONG = (*SMALL, "-route", "monte_carlo", "-excursions", "1e7")
DENSITY = (*SMALL, "-quantities", "sticking,density")


class Faults(Case):
    def names(self):
        return sorted(file.name for file in self.folder.iterdir())

    def start(self, *options, ranks=0, **how):
        command = [str(BINARIES / "stickslip"), *map(str, options)]
        if ranks:
            command = ["mpiexec", "-n", str(ranks), *command]
        process = subprocess.Popen(command, cwd=self.folder, stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, text=True, **how)
        self.addCleanup(process.communicate)
        self.addCleanup(process.kill)
        return process

    def limited(self, kind, amount, *options, timeout=120):
        """A run under a resource limit."""
        process = self.start(*options,
                             preexec_fn=lambda: resource.setrlimit(kind, (amount, amount)))
        _, message = process.communicate(timeout=timeout)
        return process.returncode, message

    def ranks_of(self, parent):
        """Process numbers of both ranks, once they run."""
        for _ in range(600):
            found = subprocess.run(["ps", "--ppid", str(parent), "-o", "pid=,comm="],
                                   capture_output=True, text=True).stdout.split("\n")
            ranks = [int(line.split()[0]) for line in found if "stickslip" in line]
            if len(ranks) == 2:
                return ranks
            time.sleep(0.05)
        self.fail("mpiexec started nothing")


class Killed(Faults):
    def test_a_study_leaves_old_files_and_repeats_its_numbers(self):
        """kill -9 at 8 moments of a study: files are old or whole, the next gives the same bits"""
        options = ("-study", "p", "-delta", "0.5", "-study_steps", "10", "-study_csv", "study.csv",
                   "-output", "study.h5")
        self.run_ok(*options)
        numbers, lines = self.values_of_study(), self.lines_of_study()
        moment, kills = random.Random(1), 0
        for _ in range(8):
            for name in ("study.csv", "study.h5"):
                (self.folder / name).write_text("old")
            process = self.start(*options)
            time.sleep(moment.uniform(0.01, 0.6))
            process.kill()
            process.communicate()
            kills += process.returncode == -signal.SIGKILL
            self.assertIn(self.lines_of_study(), (lines, 1))
            if (self.folder / "study.h5").read_bytes() != b"old":
                self.assertEqual(self.values_of_study(), numbers)
        self.assertGreater(kills, 0)
        self.run_ok(*options)
        self.assertEqual(self.values_of_study(), numbers)

    def lines_of_study(self):
        return len((self.folder / "study.csv").read_text().splitlines())

    def values_of_study(self):
        with h5py.File(self.folder / "study.h5") as file:
            found = {}
            file.visititems(lambda name, item: found.update(
                {name: item[()].tobytes()} if isinstance(item, h5py.Dataset) and
                "seconds" not in name else {}))
        return found

    def test_a_simulation_killed_again_and_again(self):
        """kill -9 at 6 moments of a simulation: whole rounds are kept, the end has the same bits"""
        whole = self.summary(*SIMULATE)["results"]
        moment, file, kills = random.Random(2), self.folder / "kept", 0
        for _ in range(6):
            process = self.start(*SIMULATE, "-checkpoint", file)
            end = time.monotonic() + moment.uniform(0.5, 5)
            while process.poll() is None and time.monotonic() < end:
                time.sleep(0.02)
            kills += process.poll() is None
            process.kill()
            process.communicate()
            if file.exists():
                for state in file.read_text().splitlines()[1:]:
                    self.assertGreaterEqual(json.loads(state)["rounds"], 0)
        self.assertGreater(kills, 0)
        self.assertEqual(self.summary(*SIMULATE, "-checkpoint", file)["results"], whole)

    def test_a_request_to_end(self):
        """what a terminal and a batch system send: one line, the status of the signal, old files stay"""
        (self.folder / "old.json").write_text("old")
        for number in (signal.SIGTERM, signal.SIGINT, signal.SIGXCPU):
            file = self.folder / number.name
            process = self.start(*LONG, "-checkpoint", file, "-summary", "old.json")
            self.wait_for_file(file, process)
            process.send_signal(number)
            out, err = process.communicate(timeout=20)
            self.assertEqual((process.returncode, out), (-number, ""))  # of a shell 128 + number
            self.assertRegex(err, rf"^stickslip: ended by {number.name} after \d+ s, .*\n$")
            self.assertEqual((self.folder / "old.json").read_text(), "old")

    def test_the_terminal_goes(self):
        """a hang-up: ends a run without words, and not one that nohup started"""
        for action, ended in ((signal.SIG_DFL, -signal.SIGHUP), (signal.SIG_IGN, None)):
            file = self.folder / str(ended)
            process = self.start(*LONG, "-checkpoint", file, preexec_fn=lambda: signal.signal(signal.SIGHUP, action))
            self.wait_for_file(file, process)
            process.send_signal(signal.SIGHUP)
            time.sleep(1)
            self.assertEqual(process.poll(), ended)
            process.kill()
            self.assertEqual(process.communicate()[1], "")

    def test_one_rank_of_two(self):
        """kill -9 of one rank of two: the other ends, old files stay"""
        (self.folder / "old.json").write_text("old")
        process = self.start(*LONG, "-summary", "old.json", ranks=2)
        rank = self.ranks_of(process.pid)[1]
        time.sleep(1)
        os.kill(rank, signal.SIGKILL)
        process.communicate(timeout=60)
        self.assertNotEqual(process.returncode, 0)
        self.assertEqual((self.folder / "old.json").read_text(), "old")
        self.assertEqual(self.names(), ["old.json"])


class Disks(Faults):
    def check_too_large(self, status, message, *kept):
        self.assertEqual(status, 1, message)
        self.assertIn("stickslip: ", message)
        self.assertEqual(self.names(), sorted(kept))
        for name in kept:
            self.assertEqual((self.folder / name).read_text(), "old")

    def test_no_room(self):
        """no room for the field, the summary: status 1, the old file stays, no half one"""
        # A limit of file sizes, which needs no rights, behaves as a full disk does.
        for option, name in (("-output", "o.h5"), ("-summary", "s.json")):
            (self.folder / name).write_text("old")
            status, message = self.limited(resource.RLIMIT_FSIZE, 2000, *DENSITY[:-2], option, name)
            self.check_too_large(status, message, name)
            self.assertIn(f"cannot write {name}", message)
            (self.folder / name).unlink()
        (self.folder / "o.h5").write_text("old")
        self.check_too_large(*self.limited(resource.RLIMIT_FSIZE, 10000, *DENSITY, "-output",
                                           "o.h5"), "o.h5")

    def test_a_sweep_keeps_what_fitted(self):
        """no room for the checkpoint of a sweep: status 1, the points that fitted are kept"""
        options = ("-delta", "0.5", "-sweep_mu_d", "0.1:1:8", "-checkpoint", "kept")
        status, message = self.limited(resource.RLIMIT_FSIZE, 9000, *options)
        self.assertEqual(status, 1, message)
        self.assertIn("cannot write kept", message)
        self.assertTrue((self.folder / "kept").read_text().endswith("}\n"))
        held = self.summary(*options)["sweep"]["from_record"]
        self.assertGreater(held, 0)
        self.assertLess(held, 8)

    @unittest.skipUnless(os.path.exists("/dev/full"), "no /dev/full")
    def test_standard_output_to_a_full_disk(self):
        """no room for standard output: status 1, the files are there"""
        with open("/dev/full", "w") as full:
            done = subprocess.run([BINARIES / "stickslip", *SMALL, "-summary", "s.json"],
                                  cwd=self.folder, stdout=full, stderr=subprocess.PIPE, text=True,
                                  timeout=60)
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn("standard output", done.stderr)
        self.assertIn("results", json.loads((self.folder / "s.json").read_text()))

    def test_a_folder_that_cannot_be_written(self):
        """read-only folder: status 2 before anything is computed"""
        if os.geteuid() == 0:
            place = "/proc/self"  # root writes anywhere else
        else:
            place = tempfile.mkdtemp(dir=self.folder)
            os.chmod(place, 0o500)
        for option in ("-summary", "-output"):
            done = run(*SMALL, option, f"{place}/file.h5")
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertIn(option, done.stderr)

    def test_files_open_elsewhere(self):
        """output open elsewhere: its reader keeps the old one; one being written is refused"""
        self.run_ok(*SMALL, "-output", "o.h5")
        with h5py.File(self.folder / "o.h5") as reader:
            old = reader["results/P_stick/value"][()]
            self.run_ok("-mu_d", "0.5", "-delta", "0.25", "-output", "o.h5")
            self.assertEqual(reader["results/P_stick/value"][()], old)
        with h5py.File(self.folder / "o.h5") as file:
            self.assertNotEqual(file["results/P_stick/value"][()], old)
        with h5py.File(self.folder / "o.h5", "r+"):
            done = run(*SMALL, "-compare", "o.h5", folder=self.folder)
        self.assertEqual(done.returncode, 2)
        self.assertIn("another program is writing it", done.stderr)


class Memory(Faults):
    def test_little_address_space(self):
        """ulimit -v of 200 MB: the version is printed, and a run refused, without threads that try for ever"""
        for options, wanted in ((("-version",), 0), (SMALL, 4)):
            status, message = self.limited(resource.RLIMIT_AS, 200_000 << 10, *options, timeout=20)
            self.assertEqual(status, wanted, message)

    def test_limits(self):
        """ulimit -v of 400, 500, 600 MB: reported before it is allocated or when it runs out, status 4"""
        for megabytes in (400, 500, 600):
            status, message = self.limited(resource.RLIMIT_AS, megabytes << 20, "-mu_d", "0.25",
                                        "-delta", "0.0078125", "-accuracy", "1e-10",
                                        "-slide_pc_type", "elements", "-noise_degree", "0",
                                        "-summary", "s.json")
            self.assertIn(status, (3, 4), message)
            self.assertNotIn("Segmentation", message)
            if status == 4:
                self.assertIn("memory", message)
                self.assertEqual(self.names(), [])

    def test_workspace_of_mumps(self):
        """workspace of MUMPS too small: enlarged once, same numbers; a limit of yours is explained"""
        usual = self.summary(*SMALL)["results"]
        tight = self.summary(*SMALL, "-slide_mat_mumps_icntl_14", "-90")["results"]
        for key, result in usual.items():
            self.assert_close(tight[key]["value"], result["value"], 1e-12, key)
        done = run("-mu_d", "0.25", "-delta", "0.0625", "-slide_mat_mumps_icntl_23", "1")
        self.assertEqual(done.returncode, 3)
        self.assertIn("ICNTL(23) is too small", done.stderr)


class OneRank(Faults):
    def test_a_checkpoint_that_cannot_be_written_ends_all(self):
        """folder of a checkpoint vanishes under rank 0 of two: its message, status 1, all end"""
        place = self.folder / "place"
        place.mkdir()
        process = self.start(*LONG, "-checkpoint", place / "kept", ranks=2)
        self.wait_for_file(place / "kept", process)
        place.rename(self.folder / "moved")
        _, message = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 1, message)
        self.assertIn("kept", message)

    def test_no_room_on_two_ranks(self):
        """no room for the field of two ranks: all end, no half file"""
        process = self.start("-mu_d", "0.25", "-delta", "0.015625", "-accuracy", "1e-9",
                             "-quantities", "sticking,density", "-output", "o.h5", ranks=2)
        for rank in self.ranks_of(process.pid):  # mpiexec itself keeps its room
            resource.prlimit(rank, resource.RLIMIT_FSIZE, (10000, 10000))
        _, message = process.communicate(timeout=60)
        self.assertNotEqual(process.returncode, 0, message)
        self.assertFalse((self.folder / "o.h5").exists())

    def test_out_of_memory(self):
        """one of two ranks that share the points of a sweep cannot allocate: both end or go on"""
        process = self.start("-mu_d", "0.25", "-delta", "0.015625", "-accuracy", "1e-10",
                             "-sweep_tau", "0.5,1", "-sweep_ranks", "2", ranks=2)
        rank = self.ranks_of(process.pid)[1]
        time.sleep(0.5)
        resource.prlimit(rank, resource.RLIMIT_AS, (1 << 20, 1 << 20))
        _, message = process.communicate(timeout=100)
        self.assertNotEqual(process.returncode, 0, message)


if __name__ == "__main__":
    unittest.main()
