"""Many cases by few processes: stickslip.map, and the program's option -cases."""

import contextlib
import io
import json
import os
import signal
import subprocess
import unittest
import warnings
from unittest import mock

import numpy
from test_package import BINARIES, SMALL, Case  # which says where the program and the package are

import stickslip
from stickslip.cases import Pool

PROGRAM = BINARIES / "stickslip"
FAST = {"delta": 0.5, "accuracy": 1e-3}


def answers(lines, *words, status=0):
    """What the program answers to lines of cases."""
    done = subprocess.run([PROGRAM, *words, "-cases", "-"], input=lines, capture_output=True, text=True, timeout=600)
    if done.returncode != status:
        raise AssertionError(f"exit status {done.returncode}: {done.stderr}")
    return [json.loads(line) for line in done.stdout.splitlines()]


class Cases(Case):
    def test_each_line_is_answered_as_a_run_of_its_own(self):
        lines = ("-mu_d 0.25\n\n-mu_d 0.5 -quantities averages -observable 'v^2; stick'\n-mu_d 0.25 -tau 2\n"
                 "-mu_d 0.25 -sweep_tau 1,2\n-drag_expression -v*abs(v) -drag expression\n-mu_d 0.25\n")
        found = answers(lines, "-delta", "0.5")
        self.assertEqual([one["status"] for one in found], [0] * 7)
        file = self.folder / "one.json"
        for one, words in zip(found, (["-mu_d", "0.25"], [], ["-mu_d", "0.5", "-quantities", "averages", "-observable",
                                                              "v^2; stick"])):
            subprocess.run([PROGRAM, "-delta", "0.5", *words, "-summary", file], check=True, capture_output=True)
            alone = json.loads(file.read_text())
            self.assertEqual(one.keys(), {*alone, "status"})
            for part in ("results", "scene", "plan", "accuracy"):
                self.assertEqual(one[part], alone[part])
            self.assertEqual({**one["provenance"]["options"], "summary": str(file)}, alone["provenance"]["options"])
        self.assertEqual(found[6]["results"], found[0]["results"])  # whatever came between
        self.assertEqual(len(found[4]["runs"]), 2)

    def test_what_is_wrong_with_a_case_is_its_own(self):
        found = answers("-mu_d 2\n-detla 1\n-help\n-observable 'v\n-options_file none.opts\nstray\n-cases -\n-mu_d 0.25\n",
                        "-delta", "0.5", status=2)
        self.assertEqual([one["status"] for one in found], [2] * 7 + [0])
        for one, said in zip(found, ("-mu_d = 2", "did you mean -delta", "-help", "quote", "none.opts", "stray", "-cases")):
            self.assertIn(said, one["message"])
        self.assertEqual(found[7]["results"], answers("-mu_d 0.25\n", "-delta", "0.5")[0]["results"])

    def test_no_failure_ends_the_others(self):
        lines = "-summary /proc/none.json\n-sweep_mu_d 0.25,0.5 -relax_eps_max_it 1 -quantities relaxation\n-mu_d 0.25\n"
        first, second, last = answers(lines, "-delta", "0.5", status=3)
        self.assertEqual(first["status"], 1)
        self.assertIn("cannot write", first["message"])
        self.assertEqual([run["status"] for run in second["runs"]], ["failed", "failed"])
        self.assertEqual(last["results"], answers("-mu_d 0.25\n", "-delta", "0.5")[0]["results"])

    def test_files_and_statuses(self):
        (self.folder / "cases.txt").write_text("-summary one.json\n-accuracy 1e-9 -degree 2\n")
        done = subprocess.run([PROGRAM, "-delta", "0.5", "-cases", "cases.txt"], cwd=self.folder, capture_output=True,
                              text=True)
        one, other = map(json.loads, done.stdout.splitlines())
        self.assertEqual((done.returncode, one["status"], other["status"]), (3, 0, 3))
        self.assertEqual(json.loads((self.folder / "one.json").read_text())["results"], one["results"])
        self.assertIn("shortfall", other["accuracy"])
        for name in ("none.txt", self.folder):
            done = subprocess.run([PROGRAM, "-cases", name], capture_output=True, text=True)
            self.assertEqual((done.returncode, done.stdout), (2, ""))
            self.assertIn("cannot be read", done.stderr)
        done = subprocess.run(["mpiexec", "-n", "2", PROGRAM, "-cases", "-"], input="-mu_d 0.25\n", capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stdout), (2, ""))
        self.assertEqual(done.stderr.count("runs on one rank"), 1)


class Maps(Case):
    def test_results_are_those_of_run_in_the_order_of_the_cases(self):
        cases = [{"mu_d": mu_d, "quantities": words} for mu_d in (0.25, 0.5) for words in ("sticking", "spectrum", "density")]
        found = stickslip.map(cases, workers=2, **FAST, omega=[0.5, 2])
        for case, one in zip(cases, found):
            alone = stickslip.run(**case, **FAST, omega=[0.5, 2])
            self.assertEqual(list(one), list(alone))
            for key in alone:
                numpy.testing.assert_array_equal(one[key].value, alone[key].value)
                numpy.testing.assert_array_equal(one[key].error, alone[key].error)
        numpy.testing.assert_array_equal(found[2].density.values, stickslip.run(**cases[2], **FAST).density.values)
        self.assertEqual(stickslip.map([]), [])
        self.assertEqual(stickslip.map([{"mu_d": 0.5}], mu_d=0.25, **FAST)[0].scene["mu_d"], 0.5)

    def test_options_of_any_kind(self):
        from stickslip import noise
        chain = noise.Chain([-1.5, 0, 1.5], [[0, 1, 0], [1, 0, 1], [0, 1, 0]])
        odd = {"observable": ["v^2", 'abs(v) > 0.5'], "quantities": "averages", "lambda_": None}
        found = stickslip.map([{"noise": chain, "mu_d": 0.5}, odd, {"sweep_mu_d": [0.25, 0.5]}],
                              accuracy=1e-3)
        self.assertEqual(found[0]["P_stick"].value, stickslip.run(noise=chain, mu_d=0.5, accuracy=1e-3)["P_stick"].value)
        self.assertIn("pi(v^2)", found[1])
        self.assertEqual(found[2].dims, ("mu_d",))

    def test_failures_are_raised_or_returned(self):
        cases = [{"mu_d": 0.25}, {"mu_d": 2}, {"noise": "telegraph", "telegraph_amplitude": 0.5, "telegraph_rate": 1},
                 {"mu_d": 0.5, "observable": "v\nx"}, {"mu_d": 0.25}]
        found = stickslip.map(cases, workers=1, failures="return", **FAST)
        self.assertEqual([type(one) for one in found[1:4]], [stickslip.BadInput] * 3)
        self.assertIn("-mu_d = 2", str(found[1]))
        self.assertEqual(found[0]["P_stick"].value, found[4]["P_stick"].value)
        with self.assertRaisesRegex(stickslip.BadInput, "case 1: -mu_d = 2"):
            stickslip.map(cases, **FAST)
        for wrong in ({"cases": {"mu_d": 1}}, {"cases": [], "workers": 0}, {"cases": [], "failures": "ignore"}):
            with self.assertRaises(ValueError):
                stickslip.map(**wrong)

    def test_keywords_of_the_function_in_a_case(self):
        for own in ("timeout", "keep", "ranks", "progress"):
            with self.assertRaisesRegex(ValueError, rf"cases\[1\]: {own} is no option of a case"):
                stickslip.map([SMALL, {**SMALL, own: 1}])
        with self.assertRaisesRegex(ValueError, "map: keep is no option"):
            stickslip.map([SMALL], keep="file.h5")

    def test_a_table_with_what_the_cases_differ_in(self):
        rows = stickslip.map([{"mu_d": 0.25}, {"mu_d": 0.5, "drag": "none"}], delta=0.5, quantities="sticking")
        tables = [r.to_pandas("mu_d", "drag") for r in rows]
        self.assertEqual(list(tables[0]), ["key", "mu_d", "drag", "value", "error", "unit"])
        self.assertEqual([(t.mu_d[0], t.drag[4]) for t in tables], [(0.25, "linear"), (0.5, "none")])
        with self.assertRaisesRegex(KeyError, "mud: is no option; did you mean mu_d?"):
            rows[0].to_pandas("mud")

    def test_progress(self):
        told = []
        stickslip.map([SMALL, {"mu_d": 5}, SMALL], failures="return", progress=lambda *counts: told.append(counts))
        self.assertEqual(told, [(1, 3), (2, 3), (3, 3)])
        with contextlib.redirect_stderr(io.StringIO()) as shown:
            stickslip.map([SMALL, SMALL], progress=True)
        self.assertRegex(shown.getvalue(), r"\r1 of 2 cases, about \d+ s left *\r2 of 2 cases, \d+ s\n *$")

    def test_an_accuracy_that_is_missed_is_a_warning(self):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            found = stickslip.map([{"mu_d": 0.25}, {"mu_d": 0.5, "degree": 2, "accuracy": 1e-9}], **FAST)
        self.assertEqual([one.reached for one in found], [True, False])
        self.assertIn("1 of 2 cases fell short: case 1: ", str(caught[0].message))

    def test_a_process_that_is_killed_is_started_anew(self):
        long = {"delta": 0.5, "route": "monte_carlo", "excursions": 1e12}
        with Pool(1) as pool:
            before = pool.results([SMALL])[0]
            worker = pool._workers[0]._process
            killer = subprocess.Popen(["sh", "-c", f"sleep 1; kill -SEGV {worker.pid}"])
            killed, after = pool.results([long, SMALL])
            killer.wait()
            self.assertRegex(str(killed), "SIGSEGV|exit status")
            self.assertEqual(type(killed), stickslip.ProgramError)
            self.assertEqual(after["P_stick"].value, before["P_stick"].value)
            idle = pool._workers[0]._process
            self.assertNotEqual(idle.pid, worker.pid)
            idle.kill()
            idle.wait()
            self.assertEqual(pool.results([SMALL])[0]["P_stick"].value, before["P_stick"].value)
        self.assertIsNotNone(worker.poll())

    def test_a_case_that_takes_too_long(self):
        late, quick = stickslip.map([{"delta": 0.5, "route": "monte_carlo", "excursions": 1e12}, SMALL], failures="return",
                                    workers=1, timeout=10)
        self.assertIsInstance(late, stickslip.TimedOut)
        self.assertIn("P_stick", quick)

    def test_a_program_that_answers_nothing(self):
        with self.fake("echo here >&2; exit 7"):
            found = stickslip.map([SMALL, SMALL], failures="return")
        for one in found:
            self.assertRegex(str(one), "exit status 7:\nhere")
        with self.fake('while read line; do echo \'{"status":1,"message":"no"}\'; done'):
            self.assertEqual([str(one) for one in stickslip.map([SMALL] * 3, failures="return")], ["no"] * 3)
        with mock.patch.dict(os.environ, STICKSLIP="/nowhere"), self.assertRaises(stickslip.ProgramError):
            stickslip.map([SMALL])

    def test_no_process_stays(self):
        with Pool(2) as pool:
            pool.results([SMALL] * 4)
            processes = [worker._process for worker in pool._workers if worker._process]
            self.assertTrue(processes)
        for process in processes:
            self.assertEqual(process.poll(), -signal.SIGKILL)


if __name__ == "__main__":
    unittest.main()
