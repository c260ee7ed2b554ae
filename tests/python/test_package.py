"""The Python package, as a script meets it."""

import contextlib
import dataclasses
import inspect
import io
import itertools
import json
import math
import os
import pathlib
import pickle
import re
import statistics
import subprocess
import sys
import tempfile
import time
import unittest
import warnings
from unittest import mock

import h5py
import numpy

SOURCES = pathlib.Path(__file__).resolve().parents[2]
BINARIES = pathlib.Path(os.environ.get("STICKSLIP_BINARIES", SOURCES / "build"))
os.environ["STICKSLIP"] = str(BINARIES / "stickslip")
sys.path.insert(0, str(SOURCES / "python"))
import stickslip
from stickslip import program, results
from stickslip.plots import fields, style

SMALL = {"mu_d": 0.25, "delta": 0.5, "accuracy": 1e-3}
PNG = b"\x89PNG\r\n\x1a\n"


class Case(unittest.TestCase):
    """A test with a folder of its own, in whose name are a space and letters that are not ASCII."""

    def setUp(self):
        holder = tempfile.TemporaryDirectory(prefix="Reibung µ δ ")
        self.addCleanup(holder.cleanup)
        self.folder = pathlib.Path(holder.name)
        filters = warnings.catch_warnings()
        filters.__enter__()
        self.addCleanup(filters.__exit__)
        warnings.simplefilter("ignore", stickslip.AccuracyWarning)

    def fake(self, text):
        """A program that is found instead of the real one."""
        file = self.folder / "fake program"
        file.write_text(f"#!/bin/sh\n{text}\n")
        file.chmod(0o755)
        return mock.patch.dict(os.environ, STICKSLIP=str(file))

    def python(self, *words, **environment):
        return subprocess.run([sys.executable, *map(str, words)], capture_output=True, text=True, cwd=self.folder,
                              env={**os.environ, "PYTHONPATH": str(SOURCES / "python"), **environment})


class Runs(Case):
    def test_values_and_errors_are_those_that_the_program_prints(self):
        file = self.folder / "summary.json"
        r = stickslip.run(**SMALL, quantities="sticking,spectrum", omega=[0.1, 1, 10], summary=file)
        written = json.loads(file.read_text())["results"]
        self.assertEqual(list(r), list(written))
        for key, parts in written.items():
            self.assertEqual((r[key].key, r[key].unit), (key, parts.get("unit", "")))
            numpy.testing.assert_array_equal(r[key].value, parts["value"])
            numpy.testing.assert_array_equal(r[key].error, parts["error"])
        self.assertIsInstance(r["P_stick"].value, float)
        self.assertEqual(float(r["P_stick"]), r["P_stick"].value)
        numpy.testing.assert_array_equal(r["S_v"].abscissa, [0.1, 1, 10])
        self.assertEqual((r["S_v"].abscissa_name, r["S_v"].dims, r["P_stick"].dims), ("omega", ("omega",), ()))
        printed = subprocess.run([BINARIES / "stickslip", *program.words_of(SMALL), "-quantities", "sticking,spectrum",
                                  "-omega", "0.1,1,10"], capture_output=True, text=True, check=True).stdout
        number = re.search(r"P_stick +0\.(\d{4,}) ", printed)
        self.assertEqual(f"{r['P_stick'].value:.{len(number[1])}f}", f"0.{number[1]}")
        self.assertTrue(r.reached)
        self.assertEqual(r.scene["mu_d"], 0.25)
        self.assertGreater(r.cost["seconds"], 0)

    def test_density_arrives_and_nothing_else_stays(self):
        with mock.patch.dict(os.environ, TMPDIR=str(self.folder)), mock.patch("tempfile.tempdir", None):
            r = stickslip.run(**SMALL, quantities=["sticking", "density"])
            self.assertEqual(list(self.folder.iterdir()), [])
        self.assertAlmostEqual(r.density.mass_at_rest, r["P_stick"].value, delta=1e-12)
        self.assertEqual(r.density.values.shape, (r.density.x.size, r.density.v.size))
        self.assertAlmostEqual(r.density.marginal_x.sum(), 1, delta=1e-9)
        self.assertIsNone(stickslip.run(**SMALL).density)

    def test_densities_are_polynomials_on_elements(self):
        for scheme in ({}, {"scheme": "upwind", "p": 4, "accuracy": 0.1}):
            d = stickslip.run(**{**SMALL, **scheme}, bias=0.1, quantities="density").density
            numpy.testing.assert_allclose(d.at(d.v), d.values, atol=1e-14)
            numpy.testing.assert_allclose(d.marginal(d.v), d.marginal_v, atol=1e-14)
            self.assertAlmostEqual(d.values.sum(0) @ d.weights, d.marginal_v @ d.weights, delta=1e-12)
            numpy.testing.assert_array_equal(d.at(numpy.array([-99, 99])), 0)
            if scheme:  # the upwind scheme has states at v = 0
                continue
            self.assertAlmostEqual(d.marginal_v @ d.weights + d.mass_at_rest, 1, delta=1e-12)
            fine = numpy.concatenate([low + (high - low) * (numpy.arange(2000) + 0.5) / 2000
                                      for low, high in zip(d.cells, d.cells[1:])])
            widths = numpy.repeat(numpy.diff(d.cells), 2000) / 2000
            self.assertAlmostEqual(d.marginal(fine) @ widths, d.marginal_v @ d.weights, delta=1e-6)
            window = d.window(0.01)
            inside = (fine > window[0]) & (fine < window[-1])
            share = (d.marginal(fine) * widths)[inside].sum() / (d.marginal_v @ d.weights)
            self.assertAlmostEqual(share, 0.99, delta=0.01)

    def test_simulated_values_have_intervals(self):
        r = stickslip.run(**SMALL, quantities="sticking,laplace", lambda_=[1, 2], route="monte_carlo", excursions=1000)
        low, high = r["P_stick"].ci95
        self.assertLess(low, r["P_stick"].value)
        self.assertLess(r["P_stick"].value, high)
        self.assertEqual(r["F_slide"].ci95.shape, (2, 2))
        self.assertIsNone(stickslip.run(**SMALL)["P_stick"].ci95)

    def test_results_in_a_notebook(self):
        r = stickslip.run(**SMALL, quantities="sticking,spectrum", omega=[0.1, 1])
        p, s = r["P_stick"], r["S_v"]
        self.assertEqual((p * 2, 1 - p, p / 2, -p, p < 1), (2 * p.value, 1 - p.value, p.value / 2, -p.value, True))
        for found in (s * p, p * s, s * p.value, s.value * p):
            self.assertEqual(found.tolist(), (s.value * p.value).tolist())
        for value, error, short in ((0.15648616, 2e-8, "0.15648616(2)"), (1.3e-9, 2.2e-10, "1.3(2)e-09"), (4938846, 59, "4938850(60)"),
                                    (0.99999, 0.0096, "1.00(1)"), (1, 0, "1"), (1.23e20, 4e17, "1.230(4)e+20"), (0.001, 0.03, "0.00(3)")):
            result = stickslip.Result("a", value, error)
            self.assertEqual((f"{result:S}", f"{result:L}"), (short, rf"\num{{{short}}}"))
        self.assertEqual(r._ipython_key_completions_(), list(r))
        self.assertIn(f"<td>P_stick</td><td>{results.to_its_error(p.value, p.error)} +- {p.error:.1e}</td>", r._repr_html_())
        self.assertIn("<tr><th>omega</th><th>S_v [velocity^2*time]</th><th>error</th></tr><tr><td>0.1</td>", s._repr_html_())
        for function in (stickslip.run, stickslip.sweep, stickslip.map, stickslip.newmark):
            signature = inspect.signature(function)
            self.assertTrue({"mu_d", "lambda_"} <= set(signature.parameters))
            self.assertLess(len(str(signature)), 1000)
            with self.fake("exit 1"):
                self.assertNotIn("mu_d", inspect.signature(function).parameters)
        with self.assertWarnsRegex(UserWarning, "JSON does not hold density; "):
            stickslip.run(**SMALL, quantities="density").save(self.folder / "r.json")

    def test_words_of_options(self):
        self.assertEqual(program.words_of({
            "mu_d": 0.1, "omega": [1, 1e-7], "plan": True, "lambda_": numpy.array([0.3]), "observable": ["v", "x*v"],
            "excursions": numpy.int64(7), "degree": None, "options_file": pathlib.Path("a b")}), [
                "-mu_d", "0.1", "-omega", "1,1e-07", "-plan", "-lambda", "0.3", "-observable", "v; x*v",
                "-excursions", "7", "-options_file", "a b"])

    def test_a_plan(self):
        r = stickslip.run(**SMALL, quantities="sticking,density", plan=True)
        self.assertEqual((len(r), r.density), (0, None))
        file = self.folder / "density.h5"
        stickslip.run(**SMALL, quantities="density", keep=file)
        self.assertIsNone(stickslip.run(**SMALL, quantities="density", keep=file, plan=True).density)
        self.assertGreater(r.plan["steps"][0]["unknowns"], 0)

    def test_ranks(self):
        one, two = (stickslip.run(**SMALL, quantities="sticking", ranks=ranks) for ranks in (0, 2))
        self.assertEqual(two.provenance["ranks"], "2")
        self.assertAlmostEqual(one["P_stick"].value, two["P_stick"].value, delta=1e-9)
        with self.assertRaisesRegex(stickslip.BadInput, r"^-mu_d = 2: .*$") as caught:
            stickslip.run(mu_d=2, ranks=2)
        self.assertNotIn("mpiexec", str(caught.exception))

    def test_progress_is_told_while_the_program_works(self):
        told, go = [], self.folder / "go"

        def tell(line):
            told.append(line)
            go.touch()

        with self.fake(f"echo level 1 >&2; until [ -e '{go}' ]; do sleep 0.01; done; echo stickslip: no. >&2; exit 2"):
            self.assertRaisesRegex(stickslip.BadInput, "^no.$", stickslip.run, progress=tell, timeout=60)
        self.assertEqual(told, ["level 1", "stickslip: no."])
        with contextlib.redirect_stderr(io.StringIO()) as shown:
            stickslip.run(**SMALL, progress=True)
            stickslip.run(**SMALL)
            stickslip.run(**SMALL, progress="off")
            stickslip.sweep(mu_d=[0.25, 0.5], delta=0.5, quantities="sticking", progress=True)
        self.assertRegex(shown.getvalue(), r"^(refinement level \d: .*\n){3}(\d of 2 points; mu_d = .*\n)+$")

    def test_what_is_told_ends_the_program_where_it_fails(self):
        def tell(line):
            raise KeyError(line)

        with self.fake("echo level 1 >&2; sleep 600"):
            self.assertRaisesRegex(KeyError, "level 1", stickslip.run, progress=tell, timeout=60)

    def test_an_accuracy_that_is_missed_is_a_warning(self):
        with self.assertWarnsRegex(stickslip.AccuracyWarning, "take -accuracy") as caught:
            r = stickslip.run(delta=0.5, quantities="sticking", accuracy=1e-15)
        self.assertEqual(caught.filename, __file__)
        self.assertFalse(r.reached)
        self.assertGreater(r["P_stick"].value, 0)


class Failures(Case):
    def test_bad_input_is_told_in_the_words_of_the_program(self):
        for options, message in (({"mu_d": 2}, r"^-mu_d = 2: must be in \[0, mu_s\]"),
                              ({"detla": 0.5}, "did you mean -delta?")):
            with self.assertRaisesRegex(ValueError, message) as caught:
                stickslip.run(**options)
            self.assertIs(type(caught.exception), stickslip.BadInput)

    def test_what_does_not_fit_in_memory(self):
        with self.assertRaisesRegex(stickslip.OutOfMemory, "GB of memory"):
            stickslip.run(delta=1e-4, scheme="upwind", p=4000)

    def test_a_program_that_is_killed(self):
        with self.fake("echo last words >&2; kill -SEGV $$"):
            self.assertRaisesRegex(stickslip.ProgramError, "(?s)killed by SIGSEGV.*last words", stickslip.run)
        with self.fake("exit 137"):  # as a shell or mpiexec tells it
            self.assertRaisesRegex(stickslip.ProgramError, "killed by SIGKILL", stickslip.run)
        with self.fake("seq 100; exit 1"):
            with self.assertRaisesRegex(stickslip.ProgramError, "(?s)exit status 1.*\n100$") as caught:
                stickslip.run()
        self.assertLess(len(str(caught.exception)), 200)
        with self.fake("exit 0"):
            self.assertRaisesRegex(stickslip.ProgramError, "wrote no results", stickslip.run)

    def test_what_cannot_be_solved(self):
        with self.fake("echo rounding leaves nothing >&2; exit 3"):
            self.assertRaisesRegex(stickslip.Unsolved, "^rounding leaves nothing$", stickslip.run)

    def test_what_mpi_prints_is_not_the_message(self):
        frame, printed = "-" * 74, self.folder / "printed"
        printed.write_text(f"{frame}\nWARNING: no device\n{frame}\n[host:1] btl_tcp: no network\n[host:2] "
                           f"stickslip: -a = 1: wrong\n-b = 2: wrong\n{frame}\nMPI_ABORT was invoked\n{frame}\n")
        with self.fake(f"cat '{printed}' >&2; exit 2"):
            self.assertRaisesRegex(stickslip.BadInput, r"^-a = 1: wrong\n-b = 2: wrong$", stickslip.run)

    def test_results_of_before_are_not_taken_for_those_of_now(self):
        file = self.folder / "summary.json"
        stickslip.run(**SMALL, summary=file)
        with self.fake("exit 0"):
            self.assertRaisesRegex(stickslip.ProgramError, "wrote no results", stickslip.run, summary=file)

    def test_a_program_that_takes_too_long_is_ended_with_its_children(self):
        pid = self.folder / "pid"
        for patience in (0.5, 5, 50):  # a busy machine may need some time to start the child
            with self.fake(f"sleep 600 & echo $! > '{pid}'; wait"):
                self.assertRaises(stickslip.TimedOut, stickslip.run, timeout=patience)
            if pid.exists() and pid.read_text():
                break
        status, end = pathlib.Path("/proc", pid.read_text().strip(), "stat"), time.monotonic() + 60
        while status.exists() and status.read_text().split()[2] != "Z":
            self.assertLess(time.monotonic(), end, "the child goes on")
            time.sleep(0.01)

    def test_where_the_program_is_looked_for(self):
        with self.fake("exit 0"):
            self.assertEqual(stickslip.find_program(), self.folder / "fake program")
        with mock.patch.dict(os.environ, STICKSLIP="/none"):
            self.assertRaisesRegex(stickslip.ProgramError, "STICKSLIP names /none", stickslip.find_program)
        package = self.folder / "python" / "stickslip"
        with mock.patch.object(program, "PACKAGE", package), mock.patch.dict(os.environ, PATH=str(self.folder)):
            os.environ.pop("STICKSLIP")
            with self.assertRaisesRegex(stickslip.ProgramError, "STICKSLIP.*beside the package.*PATH"):
                stickslip.find_program()
            installed = self.folder / "lib" / "python3" / "dist-packages" / "stickslip"
            for place, package in (("stickslip", package), ("bin/stickslip", installed), ("build/stickslip", package)):
                file = self.folder / place
                file.parent.mkdir(exist_ok=True)
                file.write_text("")
                file.chmod(0o755)
                with mock.patch.object(program, "PACKAGE", package):
                    self.assertEqual(stickslip.find_program(), file)

    def test_the_program_of_the_sources_that_pip_installed_from(self):
        packages = self.folder / "venv" / "lib" / "python3.11" / "site-packages"
        record = packages / "stickslip-1.0.0.dist-info" / "direct_url.json"
        file = self.folder / "my sources" / "build" / "stickslip"
        for place in (record, file):
            place.parent.mkdir(parents=True)
        record.write_text(json.dumps({"dir_info": {}, "url": (self.folder / "my sources" / "python").as_uri()}))
        with mock.patch.object(program, "PACKAGE", packages / "stickslip"), mock.patch.dict(os.environ, PATH="/none"):
            os.environ.pop("STICKSLIP")
            with self.assertRaisesRegex(stickslip.ProgramError, str(file)):
                stickslip.find_program()
            file.write_text("")
            file.chmod(0o755)
            self.assertEqual(stickslip.find_program(), file)

    def test_what_mpiexec_refuses(self):
        for printed, words in (("mpiexec has detected an attempt to run as root.", "to run as root.*OMPI_ALLOW_RUN_AS_ROOT=1 and "
                                "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 in the environment"),
                               ("There are not enough slots available in the system", "more ranks than there are cores; set "
                                "OMPI_MCA_rmaps_base_oversubscribe=1 and PRTE_MCA_rmaps_default_mapping_policy=:oversubscribe")):
            mpiexec = self.folder / "mpiexec"
            mpiexec.write_text(f"#!/bin/sh\necho '{printed}' >&2; seq 100 >&2; exit 1\n")
            mpiexec.chmod(0o755)
            with mock.patch.dict(os.environ, PATH=f"{self.folder}:{os.environ['PATH']}"):
                self.assertRaisesRegex(stickslip.ProgramError, words, stickslip.run, ranks=2)
        with mock.patch.dict(os.environ, PATH="/none"):
            self.assertRaisesRegex(stickslip.ProgramError, "mpiexec does not run.*openmpi-bin", stickslip.run, ranks=2)

    @staticmethod
    def advice(name):
        return f"pip install {name}, or on Debian apt-get install python3-{name}"

    def test_a_missing_module_is_one_sentence(self):
        for name, script in (("numpy", "import stickslip"),
                             ("h5py", "import stickslip; stickslip.load('a.h5')"),
                             ("matplotlib", "import stickslip.plots")):
            done = self.python("-c", f"import sys; sys.modules['{name}'] = None; {script}")
            self.assertEqual(done.stderr.splitlines()[-1],
                             f"ImportError: stickslip needs {name} for this: {self.advice(name)}")

    def test_the_command_line_tells_a_missing_module_in_one_sentence(self):
        stickslip.run(**SMALL, quantities="density", keep=self.folder / "density.h5")
        for name in ("numpy", "h5py", "matplotlib"):
            with tempfile.TemporaryDirectory() as hidden:
                pathlib.Path(hidden, f"{name}.py").write_text(f"raise ModuleNotFoundError('none', name='{name}')\n")
                done = self.python("-m", "stickslip", "plot", "density.h5",
                                   PYTHONPATH=f"{hidden}:{SOURCES / 'python'}")
            self.assertEqual((done.returncode, done.stdout, done.stderr), (
                1, "", f"stickslip needs {name} for this: {self.advice(name)}\n"))

    def test_matplotlib_is_imported_only_to_draw(self):
        done = self.python("-c", "import sys, stickslip; print('matplotlib' in sys.modules, 'h5py' in sys.modules)")
        self.assertEqual(done.stdout, "False False\n", done.stderr)


class Reference(Case):
    def test_help_lists_what_the_program_lists(self):
        for function in (stickslip.run, stickslip.sweep):
            shown = inspect.getdoc(function)
            self.assertRegex(shown, "(?s)^Run the program .*Parameters\n-----.*\n  -mu_d  .*\n  -quantities  ")
        printed = subprocess.run([BINARIES / "stickslip", "-help"], capture_output=True, text=True, check=True).stdout
        options = printed[printed.index("Model."):printed.index("Other:")].splitlines()
        self.assertEqual(sorted({*options} - {*shown.splitlines()}), [])

    def test_help_without_a_program(self):
        with mock.patch.dict(os.environ, STICKSLIP="/none"):
            self.assertRegex(inspect.getdoc(stickslip.run), "(?s)^Run the program once.*STICKSLIP names /none")
        with self.fake("exit 1"):
            self.assertRegex(inspect.getdoc(stickslip.run), "could not be asked")

    def test_public_names(self):
        self.assertEqual(dir(stickslip), sorted(stickslip.__all__))
        for name in dir(stickslip):
            self.assertTrue(hasattr(stickslip, name), name)

    def test_one_version(self):
        self.assertRegex((SOURCES / "CMakeLists.txt").read_text(), rf"project\(stickslip VERSION {stickslip.__version__} ")
        self.assertRegex((SOURCES / "CITATION.cff").read_text(), rf"\nversion: {stickslip.__version__}\n")

    def test_the_latest_change_is_that_version_and_its_date_is_that_of_the_citation(self):
        date = re.search(r"\ndate-released: (\S+)\n", (SOURCES / "CITATION.cff").read_text())[1]
        released = re.findall(r"^## \[(\d.*)\] - (.*)$", (SOURCES / "CHANGELOG.md").read_text(), re.MULTILINE)
        self.assertEqual(released[0], (stickslip.__version__, date))


class Misunderstandings(Case):
    """What Python programmers try first is done, or refused with what to do instead."""

    def refused(self, words, call, kind=ValueError):
        with self.assertRaises(kind) as problem:
            call()
        for word in words:
            self.assertIn(word, str(problem.exception))

    def test_numbers_have_the_digits_that_their_errors_allow(self):
        for value, error, shown in ((0.15648616853236222, 3.2e-10, "0.1564861685"), (1234.5678, 20.0, "1.23e+03"),
                                    (-0.00123456, 1e-5, "-0.00123"), (1e-3, 5.0, "0.001"), (0.1, 0.0, "0.10000000000000001"),
                                    (0.123456789, float("nan"), "0.1234568"), (0.0, 1e-3, "0")):
            self.assertEqual(results.to_its_error(value, error), shown)

    def test_a_key_that_was_not_computed_has_its_quantity(self):
        r = stickslip.run(**SMALL, quantities="sticking", plan=True)
        self.assertIn("plan", repr(r))
        r = stickslip.run(**SMALL, quantities="sticking")
        self.refused(['quantities="moments" computes it; there are P_stick'], lambda: r["E_V2"], KeyError)
        self.refused(["did you mean P_stick?"], lambda: r["p_stick"], KeyError)
        with self.fake("exit 1"):
            self.refused(["there are P_stick"], lambda: r["E_V2"], KeyError)

    def test_powers_of_python(self):
        one, other = (stickslip.run(**SMALL, quantities="averages", observable=power) for power in ("v**2", "v^2"))
        self.assertEqual(one["pi(v^2)"].value, other["pi(v^2)"].value)

    def test_texts_that_look_like_options(self):
        self.refused(["-drag = -v^3", "drag_expression"], lambda: stickslip.run(drag="-v^3"))
        self.assertEqual(program.words_of({"bias": -0.5, "drag_expression": "-v**3", "rate": -numpy.inf}),
                         ["-bias", "-0.5", "-drag_expression", "-v^3", "-rate", "-inf"])

    def test_sequences_in_a_single_run(self):
        self.refused(["mu_d", "stickslip.sweep"], lambda: stickslip.run(mu_d=[0.3, 0.4]))
        self.refused(["mu_d", "stickslip.sweep"], lambda: stickslip.map([{"mu_d": numpy.array([0.3, 0.4])}]))
        self.assertEqual(stickslip.run(**{**SMALL, "mu_d": [0.3]}, quantities="sticking").scene["mu_d"], 0.3)

    def test_what_cannot_be_swept(self):
        self.refused(["noise", "stickslip.map"], lambda: stickslip.sweep(noise=["ou", "telegraph"]))
        self.refused(["-sweep_mu_d"], lambda: stickslip.sweep(mud=[0.1, 0.2]))
        found = stickslip.sweep(**{**SMALL, "mu_d": (x for x in (0.25, 0.5))}, quantities="sticking")
        self.assertEqual(found.coords["mu_d"].tolist(), [0.25, 0.5])

    def test_arrays_in_the_place_of_records_and_chains(self):
        t = numpy.arange(5.0)
        record = stickslip.Record(t, t * t)
        for noise in (t, (t, t)):
            self.refused(["noise", "stickslip.Record"], lambda: stickslip.run(noise=noise))
        for force in (t, (t, t), {"time": t}):
            self.refused(["force_file", "stickslip.Record"], lambda: stickslip.run(force_file=force))
        self.refused(["Record(time, value)"], lambda: stickslip.read_record(t), TypeError)
        self.refused(["Record(time, value)"], lambda: stickslip.noise.record(t), TypeError)
        self.assertEqual((len(record), numpy.asarray(record).tolist()), (5, (t * t).tolist()))

    def test_ranks_and_times_that_cannot_be(self):
        for ranks in (-1, True, 1.5):
            self.refused(["ranks"], lambda: stickslip.run(ranks=ranks))
        self.refused(["timeout"], lambda: stickslip.run(timeout=-1))


class Sweeps(Case):
    def test_shapes_names_and_order(self):
        asked = {"delta": 0.5, "quantities": "sticking,spectrum", "omega": [1, 2, 3, 4], "accuracy": 1e-3}
        s = stickslip.sweep(tau=[1, 0.5, 2], mu_d=[0.5, 0.25], **asked)
        self.assertEqual((s.dims, s.shape, s.reached), (("tau", "mu_d"), (3, 2), True))
        self.assertEqual(s["P_stick"].value.shape, (3, 2))
        self.assertEqual((s["S_v"].value.shape, s["S_v"].dims), ((3, 2, 4), ("tau", "mu_d", "omega")))
        numpy.testing.assert_array_equal(s["S_v"].abscissa, [1, 2, 3, 4])
        numpy.testing.assert_array_equal(s.coords["tau"], [1, 0.5, 2])
        one = stickslip.run(tau=2, mu_d=0.5, **asked)
        for key in ("P_stick", "S_v"):
            numpy.testing.assert_array_equal(s[key].value[2, 0], one[key].value)
            numpy.testing.assert_array_equal(s[key].error[2, 0], one[key].error)

    def test_arrays_of_different_length_end_with_nan(self):
        s = stickslip.sweep(mu_s=[1, 2], delta=0.5, quantities="entry_law", accuracy=1e-3)
        self.assertEqual((s["entry_law"].value.shape, s["entry_law"].abscissa.shape), ((2, 9), (2, 9)))
        self.assertTrue(numpy.isnan(s["entry_law"].value[0, 5:]).all())

    def test_points_that_fail_are_nan_with_their_message(self):
        with self.assertWarnsRegex(stickslip.AccuracyWarning, "2 of 2 points.*delta = 0.0001: about"):
            s = stickslip.sweep(delta=[1, 1e-4], scheme="upwind", p=200, quantities="sticking")
        self.assertEqual((list(s.failures), list(s.shortfalls), s.reached), ([(1,)], [(0,)], False))
        self.assertIn("GB of memory", s.failures[1,])
        self.assertEqual(list(numpy.isnan(s["P_stick"].value)), [False, True])

    def test_points_that_the_model_refuses_are_nan_with_their_message(self):
        with self.assertWarnsRegex(stickslip.AccuracyWarning, "1 of 4 points"):
            s = stickslip.sweep(mu_s=[0.5, 1], mu_d=[0.25, 0.75], delta=0.25, quantities="sticking", accuracy=1e-3)
        self.assertEqual((list(s.failures), s.status[0, 1]), ([(0, 1)], "refused"))
        self.assertIn("must be in [0, mu_s]", s.failures[0, 1])
        self.assertEqual(numpy.isnan(s["P_stick"].value).tolist(), [[False, True], [False, False]])

    def test_nothing_to_sweep(self):
        self.assertRaisesRegex(ValueError, "sequence of values", stickslip.sweep, **SMALL)
        self.assertRaisesRegex(stickslip.BadInput, "seed: cannot be swept", stickslip.sweep, seed=[1, 2])

    def test_simulated_intervals_follow_the_order(self):
        s = stickslip.sweep(tau=[1, 1.5, 2], mu_d=[0.25, 0.5], delta=0.5, quantities="sticking", route="monte_carlo",
                            excursions=200)
        self.assertEqual(s["P_stick"].ci95.shape, (3, 2, 2))
        self.assertTrue((s["P_stick"].ci95[..., 0] < s["P_stick"].value).all())


class Tables(Case):
    def test_scalars_and_arrays_of_a_run(self):
        r = stickslip.run(**SMALL, quantities="sticking,spectrum", omega=[0.1, 1, 10])
        numpy.testing.assert_array_equal(numpy.asarray(r["S_v"]), r["S_v"].value)
        self.assertEqual(numpy.array(r["P_stick"]) + 0, r["P_stick"].value)
        table = r.to_pandas()
        rows = table[table.key == "S_v"]
        for column, expected in (("omega", [0.1, 1, 10]), ("value", r["S_v"].value), ("error", r["S_v"].error)):
            numpy.testing.assert_array_equal(rows[column], expected)
        self.assertEqual((len(table), rows.unit.iloc[0]), (len(r) - 1 + 3, "velocity^2*time"))
        self.assertTrue(table[table.key == "P_stick"].omega.isna().all())
        data = r.to_xarray()
        self.assertEqual(float(data.S_v.sel(omega=1)), r["S_v"].value[1])
        self.assertEqual(float(data.S_v_error.sel(omega=1)), r["S_v"].error[1])
        self.assertEqual((data.S_v.units, data.omega.units, data.mu_d), ("velocity^2*time", "1/time", "0.25"))

    def test_sweeps(self):
        s = stickslip.sweep(mu_d=[0.25, 0.5], tau=[0.5, 1, 2], delta=0.5, quantities="sticking,spectrum", omega=[1, 2],
                            accuracy=1e-2)
        table, data = s.to_pandas(), s.to_xarray()
        for (i, mu_d), (j, tau) in itertools.product(enumerate([0.25, 0.5]), enumerate([0.5, 1, 2])):
            here = table[(table.mu_d == mu_d) & (table.tau == tau)]
            self.assertEqual(here[here.key == "P_stick"].value.item(), s["P_stick"].value[i, j])
            self.assertEqual(here[(here.key == "S_v") & (here.omega == 2)].error.item(), s["S_v"].error[i, j, 1])
            self.assertEqual(float(data.P_stick.sel(mu_d=mu_d, tau=tau)), s["P_stick"].value[i, j])
            self.assertEqual(float(data.S_v_error.sel(mu_d=mu_d, tau=tau, omega=2)), s["S_v"].error[i, j, 1])
        self.assertEqual((data.S_v.dims, data.tau.units), (("mu_d", "tau", "omega"), "time"))

    def test_results_that_depend_on_other_values_of_the_same(self):
        one, two = (stickslip.Result(key, numpy.ones(n), numpy.zeros(n), "", ("level",), "level", numpy.arange(n))
                    for key, n in (("a", 2), ("b", 3)))
        data = stickslip.Results({"a": one, "b": two}).to_xarray()
        self.assertEqual((data.a.dims, data.b.dims), (("level",), ("b_level",)))

    def test_units_without_a_program(self):
        r = stickslip.run(**SMALL, quantities="spectrum", omega=[1, 2])
        with self.fake("exit 1"):
            self.assertEqual(r.to_xarray().omega.units, "")

    def test_missing_modules_are_one_sentence(self):
        for name in ("pandas", "xarray"):
            done = self.python("-c", f"import sys; sys.modules['{name}'] = None; import stickslip; "
                               f"stickslip.Results({{}}).to_{name}()")
            self.assertEqual(done.stderr.splitlines()[-1], "ImportError: stickslip needs "
                             f"{name} for this: {Failures.advice(name)}")

    def test_short_texts(self):
        r = stickslip.run(**SMALL, quantities="sticking,spectrum", omega=[1, 2])
        self.assertRegex(repr(r["P_stick"]), r"^P_stick = 0\.\d+ \+- \de-\d\d$".replace(r"\de", r"\d\.\de"))
        self.assertEqual(repr(r["S_v"]), "S_v = 2 values by omega [velocity^2*time]")
        self.assertEqual(f"{r['P_stick']:.3f}", f"{r['P_stick'].value:.3f}")
        self.assertEqual(list(r.keys()), list(r))
        self.assertNotIn("=", repr(r.keys()))
        self.assertEqual(repr(r).splitlines(), [repr(one) for one in r.values()])

    def test_limits_of_a_study_are_its_results(self):
        # Without drag V has the density exp(-|v|)/2 under white noise and mu_d = 1.
        names = {"summary": self.folder / "study.json", "output": self.folder / "study.h5"}
        r = stickslip.run(study="tau", study_steps=5, drag="none", quantities="moments,spectrum", omega=1, **names)
        for found in (r, *map(stickslip.load, names.values())):
            for key, limit in (("E_V2", 2), ("E_absV", 1), ("S_0", 10)):
                self.assertLessEqual(abs(found[key].value - limit), found[key].error)
                self.assertLess(found[key].error, 1e-2)
        self.assertEqual(repr(r).splitlines()[0], repr(r["E_V2"]))

    def test_pickled_results(self):
        s = stickslip.sweep(mu_d=[0.25, 0.5], delta=0.5, quantities="sticking", accuracy=1e-2)
        numpy.testing.assert_array_equal(pickle.loads(pickle.dumps(s))["P_stick"].value, s["P_stick"].value)


class Files(Case):
    def test_saved_results(self):
        for found in (stickslip.run(**SMALL, quantities="sticking,spectrum", omega=[1, 2]),
                      stickslip.sweep(mu_d=[0.25, 0.5], delta=0.5, quantities="sticking", accuracy=1e-2)):
            found.save(self.folder / "µ.json")
            self.same(found, stickslip.load(self.folder / "µ.json"))
        self.assertRaisesRegex(ValueError, "path = .*a.h5: must end with .json", found.save, self.folder / "a.h5")
        stickslip.run(**SMALL, quantities="sticking", keep=self.folder / "r.h5")
        self.assertRaisesRegex(ValueError, "results of r have no summary", stickslip.load(self.folder / "r.h5").save, "a.json")

    def same(self, a, b):
        self.assertEqual(set(a), set(b))
        for key in a:
            for part in ("value", "error", "abscissa", "ci95"):
                one, other = (getattr(r[key], part) for r in (a, b))
                self.assertEqual(one is None, other is None, (key, part))
                if one is not None:
                    numpy.testing.assert_array_equal(one, other)
            self.assertEqual((a[key].dims, a[key].unit), (b[key].dims, b[key].unit))

    def test_json_and_hdf5_hold_the_same(self):
        for more in ({}, {"route": "monte_carlo", "excursions": 500}):
            names = {"summary": self.folder / "µ 1.json", "keep": self.folder / "µ 1.h5"}
            r = stickslip.run(**SMALL, quantities="sticking,laplace", lambda_=[0.5, 2], **more, **names)
            for file in names.values():
                self.same(r, stickslip.load(file))
                self.assertEqual(stickslip.load(file).options["mu_d"], "0.25")
        r = stickslip.run(**SMALL, quantities="resolvent", observable=["x/2", "v^2"], lambda_=1, **names)
        self.assertIn("pi(x/2)", r)
        self.same(r, stickslip.load(names["keep"]))

    def test_files_of_sweeps(self):
        names = {"summary": self.folder / "s.json", "keep": self.folder / "s.h5"}
        s = stickslip.sweep(mu_d=[0.25, 0.5], tau=[1, 1.5, 2], delta=0.5, quantities="sticking,spectrum", omega=[1, 2],
                            accuracy=1e-2, sweep_csv=self.folder / "s.csv", **names)
        for file in names.values():
            self.same(s, stickslip.load(file))
        table = stickslip.load(self.folder / "s.csv")
        self.assertEqual((table.dims, set(table)), (s.dims, set(s) - {"S_v"} | {"S_v[1]", "S_v[2]"}))
        for key in table:
            whole = s[key.partition("[")[0]].value
            numpy.testing.assert_array_equal(table[key].value, whole[..., int(key[4]) - 1] if "[" in key else whole)

    def test_studies_and_comparisons(self):
        names = {"summary": self.folder / "s.json", "keep": self.folder / "s.h5"}
        study = stickslip.run(delta=0.5, study="p", study_steps=4, quantities="sticking", **names)
        other = stickslip.load(names["keep"])
        self.assertEqual((study.study_kind, set(study.study)), ("p", set(other.study)))
        numpy.testing.assert_array_equal(study.study["P_stick"]["value"], other.study["P_stick"]["value"])
        self.assertGreater(study.runs[0]["P_stick"].value, 0)
        reference = self.folder / "reference.h5"
        stickslip.run(**SMALL, route="monte_carlo", excursions=500, keep=reference)
        r = stickslip.run(**SMALL, compare=reference, **names)
        other = stickslip.load(names["keep"])
        for key, rows in r.comparison.items():
            for column in ("value", "reference", "low", "high", "z"):
                numpy.testing.assert_array_equal(rows[column], other.comparison[key][column])

    def test_foreign_files(self):
        with h5py.File(self.folder / "foreign.h5", "w") as file:
            file["x"] = 1
        for name, text, message in (("a.json", "{}", "JSON"), ("b.json", "[", "JSON"), ("c.csv", "a,b\n1,2\n", "CSV"),
                                 ("d.h5", "text", "HDF5"), ("foreign.h5", None, "HDF5")):
            if text:
                (self.folder / name).write_text(text)
            self.assertRaisesRegex(ValueError, f"{name}: cannot be read as {message}", stickslip.load, self.folder / name)
        self.assertRaisesRegex(FileNotFoundError, "no such file", stickslip.load, self.folder / "none.h5")


class Pictures(Case):
    def plot(self, *words):
        done = self.python("-m", "stickslip", "plot", *words)
        self.assertEqual(done.returncode, 0, done.stderr)
        for name in done.stdout.splitlines():
            data = (self.folder / name).read_bytes()
            begin = {".svg": b"<?xml", ".pdf": b"%PDF"}.get(pathlib.Path(name).suffix, PNG)
            self.assertTrue(data.startswith(begin), name)
            self.assertGreater(len(data), 5000, name)
        return sorted(done.stdout.splitlines())

    def test_every_kind_of_results(self):
        """With the number of axes in the picture, and of bands, bars or marks where errors belong."""
        mc = {"route": "monte_carlo", "excursions": 500}
        stickslip.run(**SMALL, quantities="sticking,laplace", lambda_=[1, 2], **mc, keep=self.folder / "reference.h5")
        for kind, axes, options in (
                ("density", 5, {"quantities": "density"}),
                ("trajectory", 4, {"quantities": "trajectory", "horizon": 5}),
                ("given_force", 3, {"quantities": "trajectory", "force_file": SOURCES / "options" / "given_force.csv"}),
                ("spectra", 1, {"quantities": "spectrum", "omega": [0.1, 1]}),
                ("durations", 2, {"quantities": "duration_density", "time": "0:1:5", "accuracy": 1e-2}),
                ("durations", 2, {"quantities": "phase_durations", "time": [1, 2], "accuracy": 1e-2}),
                ("slips", 4, {"quantities": "slip,peak", "distance": [1, 2], "velocity": [0.1, 0.2], "accuracy": 1e-2}),
                ("slips", 2, {"quantities": "displacement", "time": [1, 2], "bias": 0.1}),
                ("displacements", 3, {"quantities": "displacement_distribution", "distance": [-1, -0.5, 0.5, 1],
                                      "probability": 0.9, "start": "rest", "time": 2, "accuracy": 0.05}),
                ("arrays", 3, {"quantities": "laplace", "lambda": [1, 2]}),
                ("comparison", 8, {"quantities": "sticking,laplace", "lambda": [1, 2],
                                   "compare": self.folder / "reference.h5"}),
                ("convergence", 5, {"quantities": "sticking", "study": "delta", "study_steps": 4, "accuracy": 1e-2}),
                ("convergence", 5, {"quantities": "sticking", "study": "p", "study_steps": 4}),
                ("cost", 1, {"quantities": "sticking", "study": "cost", "study_steps": 4, "study_repeats": 1}),
                ("spectra", 1, {"quantities": "spectrum", "omega": [0.1, 1], **mc})):
            r = stickslip.run(**{**SMALL, **options})
            picture = self.folder / "µ.png"
            figure = r.plot(picture, kind)[kind]
            self.assertEqual(sum(len(part.get_axes()) for part in (*figure.subfigs, figure) if part is not figure
                                 or not figure.subfigs), axes, kind)
            self.assertTrue(picture.read_bytes().startswith(PNG), kind)
            self.assertGreater(picture.stat().st_size, 5000)
            if kind in ("spectra", "slips", "displacements", "arrays", "durations"):
                marked = figure.axes[-1]
                self.assertTrue(marked.containers if "route" in options else marked.collections, kind)

    def test_what_the_discretisation_does_not_resolve_is_not_drawn(self):
        density = numpy.array([[1, 0.7, 0.3, -0.2, 0.1], [0.65, 0.2, 0, 0.1, 0.1], [1e-9, 0, 1e-8, 0, 1e-30]])
        self.assertEqual(fields.resolved(density).tolist(), [[1, 0.7, 0, 0, 0], [0.65, 0, 0, 0, 0], density[2].tolist()])
        found = stickslip.run(**SMALL, quantities="density")
        self.assertLess(found.density.at(found.density.window(1e-4)).min(), 0)  # so that there is something to leave out
        mesh = found.plot()["density"].axes[0].collections[0].get_array()
        self.assertEqual(sorted(set(numpy.sign(mesh).ravel().tolist())), [1])

    def test_axes_of_ones_own(self):
        axes = style.Figure().subplots()
        r = stickslip.run(**SMALL, quantities="spectrum", omega=[0.1, 1, 10])
        self.assertIs(r["S_v"].plot(axes, label="one"), axes)
        self.assertEqual(axes.lines[0].get_ydata().tolist(), r["S_v"].value.tolist())
        self.assertIn("[velocity$^2$ time]", axes.get_ylabel())
        self.assertIn("omega", axes.get_xlabel())
        self.assertRaisesRegex(ValueError, "S_0", r["S_0"].plot, axes)
        self.assertIn('<img src="data:image/png;base64,', r.plot()._repr_html_())
        self.assertIn("density", stickslip.plots.KINDS)
        axes = style.Figure().subplots()
        for drag in (1, 2):
            s = stickslip.sweep(tau=[1, 2], delta=0.5, drag_coefficient=drag, quantities="noise_law")
            self.assertIs(s["E_X2"].plot(axes, label=f"drag {drag}"), axes)
        self.assertEqual(axes.get_legend_handles_labels()[1], ["drag 1", "drag 2"])
        self.assertNotEqual(*(one.lines[0].get_color() for one in axes.containers))
        self.assertEqual(axes.get_title(), "")  # of neither
        s = stickslip.sweep(mu_d=[0.1, 0.2, 0.3, 0.4, 0.5, 0.6], tau=[1, 2], delta=0.5, quantities="noise_law")
        axes = style.Figure().subplots()
        s["E_X2"].plot(axes)
        self.assertEqual(len(axes.figure.axes), 2)  # a map with its scale
        s.plot(self.folder / "maps")
        self.assertTrue((self.folder / "maps" / "E_X2.png").is_file())

    def test_slips_are_a_table_and_points(self):
        force = {"quantities": "given_force", "force_file": SOURCES / "options" / "given_force.csv"}
        r = stickslip.run(**force)
        self.assertEqual(r.slips.dtype.names, ("begin", "end", "displacement", "peak"))
        self.assertEqual(r.slips["end"].tolist(), r["slip_end"].value.tolist())
        self.assertEqual(len(stickslip.run(**force, force_scale=1e-9).slips), 0)
        axes = r["slip_displacement"].plot(style.Figure().subplots())
        self.assertEqual(axes.lines[0].get_linestyle(), "None")
        self.assertEqual((axes.get_xlabel(), axes.get_ylabel()), ("number of the slip", "displacement of a slip  [length]"))
        s = stickslip.sweep(**force, mu_s=[1, 1.1, 1.2, 1.3, 1.4, 1.5, 1.6])
        self.assertRaises(KeyError, lambda: s.slips)
        counts = s["slip_count"].value
        self.assertLess(counts.min(), counts.max())
        self.assertEqual(s["slip_end"].abscissa.tolist(), list(range(1, int(counts.max()) + 1)))
        data = s.to_xarray()
        self.assertEqual((data.slip_begin.dims, data.slip_peak.dims), (("mu_s", "slip"),) * 2)
        numpy.testing.assert_array_equal(data.slip_begin.notnull().sum("slip"), counts)
        self.assertNotIn("", data.attrs.values())
        self.assertEqual((data.attrs["quantities"], "summary" in data.attrs), ("given_force", False))  # a file of this run
        axes = s.plot(kind="slip_peak")["slip_peak"].axes[0]
        self.assertEqual({line.get_linestyle() for line in axes.lines}, {"None"})
        self.assertEqual(axes.get_xlabel(), "number of the slip")

    def test_fragility_curves(self):
        """Exceedances that are lognormal, with 1/4 of them below 0."""
        strength, d, normal = numpy.array([0.5, 1, 1.5, 2, 3]), numpy.array([-2, -0.1, 0.1, 1]), statistics.NormalDist(0.2, 0.5)
        p = numpy.array([normal.cdf(math.log(s)) for s in strength])
        cdf = numpy.column_stack([0 * p, p / 4, 1 - 0.75 * p, 1 - 0 * p])
        s = stickslip.Sweep({"noise_deviation": strength}, {"displacement_cdf(8)": stickslip.Result(
            "displacement_cdf(8)", cdf, 0 * cdf + 1e-4, "", ("noise_deviation", "distance"), "distance", d)},
            numpy.full(5, "reached", object), {})
        axes = s.plot(kind="fragility")["fragility"].axes[0]
        self.assertEqual(axes.get_legend_handles_labels()[1], [
            f"$P(|x(8)| > 0.1)$: median {math.exp(0.2):.3g}, deviation of the logarithm 0.5"])
        line, points = axes.lines[0], axes.lines[1]
        numpy.testing.assert_allclose(points.get_ydata(), p, rtol=1e-12)
        numpy.testing.assert_allclose(line.get_ydata(), [normal.cdf(math.log(x)) for x in line.get_xdata()], atol=1e-3)

    def test_atoms_hide_no_density(self):
        r = stickslip.run(**SMALL, quantities="displacement_distribution", distance=[-1, -0.5, 0.5, 1], start="rest",
                          time=[1, 2], route="monte_carlo", excursions=100)
        atom = stickslip.Result("displacement_atom", numpy.array([0.2, 0.1]), numpy.zeros(2), "", ("time",), "time", numpy.array([1, 2]))
        where = dataclasses.replace(atom, key="displacement_atom_at", value=numpy.zeros(2))
        r = stickslip.Results({**r, atom.key: atom, where.key: where}, options=r.options)
        for items in ([r], [r, r]):
            figure = stickslip.plots.draw(items, kind="displacements")["displacements"]
            scale = figure.axes[-1]
            self.assertEqual([line.get_ydata()[0] for line in scale.lines[:2]], [0.2, 0.1])
            self.assertNotEqual(*(line.get_marker() for line in scale.lines[:2]))
            self.assertLessEqual(max(stem.get_linewidth()[0] for stem in scale.collections), 1)
        slips = stickslip.run(**SMALL, quantities="peak", velocity=[0.1, 0.2])
        figures = [stickslip.plots.draw(items, kind="slips")["slips"] for items in ([slips], [slips, slips])]
        self.assertEqual(*(figure._suptitle.get_text() for figure in figures))
        self.assertIn("mu_d", figures[0]._suptitle.get_text())

    def test_labels_are_words(self):
        for key, label in (("P_stick", r"probability of sticking $P_\mathrm{stick}$"), ("displacement_cdf(8)", r"$P(x(8) \leq d)$"),
                           ("displacement_cosine", r"$E[\cos k x(t)]$"), ("pi(v^2)", "pi(v^2)")):
            self.assertEqual(style.words(key), label)

    def test_panels_of_arrays(self):
        options = {**SMALL, "accuracy": 1e-2, "tilt": [-0.2, 0, 0.2], "time": [1, 2], "wavenumber": [0, 1]}
        r = stickslip.run(**options, quantities="large_deviation,displacement_transform")
        panels = {axes.get_ylabel(): axes for axes in r.plot(kind="arrays")["arrays"].axes}
        self.assertEqual(len(panels), 5)
        rate = panels["rate function $I(u)$  [1/time]"]
        self.assertEqual(rate.lines[0].get_xdata().tolist(), r["tilted_velocity"].value.tolist())
        self.assertIn("velocity", rate.get_xlabel())
        labels = panels[r"$E[\cos k x(t)]$"].get_legend_handles_labels()[1]
        self.assertEqual(labels, [r"$E[\cos k x(1)]$", r"$E[\cos k x(2)]$"])

    def test_sweeps_say_what_was_not_swept(self):
        s = stickslip.sweep(mu_d=[0.25, 0.5], tau=[1, 2], delta=[0.5, 0.25], quantities="sticking", accuracy=1e-1)
        axes = s.plot(kind="P_stick")["P_stick"].axes[0]
        self.assertEqual(axes.get_title(), r"$\mu_s$ = 1, $b(v) = -v$" + "\n" + r"$\delta$ = 0.5, the first of 2 values")
        self.assertTrue(axes.get_xlabel().endswith("[time]"))
        s = stickslip.sweep(tau=[1, 2], delta=0.5, quantities="sticking", accuracy=1e-1)
        self.assertEqual(s.plot(kind="P_stick")["P_stick"].axes[0].get_title(),
                         r"$\mu_s$ = 1, $\mu_d$ = 1, $\delta$ = 1/2, $b(v) = -v$")

    def test_the_limit_of_a_study_is_drawn_in_its_error(self):
        r = stickslip.run(mu_d=0.25, delta=0.5, accuracy=1e-2, quantities="sticking", study="delta", study_steps=4)
        axes = r.plot()["convergence"].axes[0]
        table = r.study["P_stick on a level"]
        self.assertEqual(axes.lines[0].get_ydata().tolist(), table["value"].tolist())
        self.assertEqual(axes.lines[1].get_ydata()[0], table["limit"][-1])
        ends = axes.patches[0].get_extents().transformed(axes.transData.inverted())
        self.assertAlmostEqual((ends.y1 - ends.y0) / 2, table["limit_error"][-1], delta=1e-9)
        self.assertEqual(axes.get_legend_handles_labels()[1], ["on a level", "between levels"])
        self.assertIn("duration", r.plot()["convergence"].axes[2].get_ylabel())
        self.assertIn("[time]", r.plot()["convergence"].axes[2].get_ylabel())

    def test_errors_of_sweeps_are_drawn(self):
        for more in ({}, {"route": "monte_carlo", "excursions": 500}):
            s = stickslip.sweep(mu_d=[0.25, 0.5], tau=[1, 1.5, 2], delta=0.5, quantities="sticking", accuracy=1e-1,
                                **more)
            figure = s.plot()["P_stick"]
            self.assertEqual(len(figure.axes[0].containers), 2)  # a curve with bars for each mu_d
        for more in ({"accuracy": 1e-2}, {"route": "monte_carlo", "excursions": 500}):
            s = stickslip.sweep(mu_s=[1, 1.5], mu_d=[0.25, 0.5, 0.75], delta=0.5, quantities="laplace,entry_law",
                                lambda_=[1, 2, 3], **more)
            figures = s.plot()
            self.assertEqual(set(figures), set(s))
            for key in ("F_slide", "entry_law"):
                axes = figures[key].axes[0]
                bars = "route" in more or key == "entry_law"
                self.assertEqual(len(axes.containers if bars else axes.collections), 3, key)
        s = stickslip.sweep(mu_d=[0.1, 0.2, 0.3, 0.4, 0.5, 0.6], tau=[1, 2], delta=0.5, quantities="noise_law")
        self.assertEqual(len(s.plot()["E_X2"].axes), 2)  # a map with its scale

    def test_a_map_of_a_plane_with_a_refused_corner(self):
        values = numpy.geomspace(0.125, 4, 6)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", stickslip.AccuracyWarning)
            s = stickslip.sweep(mu_s=values, mu_d=values, delta=0.125, quantities="sticking", accuracy=1e-2)
        self.assertEqual(set(s.failures), {(s, d) for s in range(6) for d in range(s + 1, 6)})
        axes = s.plot()["P_stick"].axes[0]
        mesh = next(one for one in axes.collections if hasattr(one, "get_coordinates"))
        numpy.testing.assert_allclose(mesh.get_coordinates()[0, :, 0], values[0] * 2.0 ** (numpy.arange(7) - 0.5))
        self.assertEqual(numpy.ma.count_masked(mesh.get_array()), len(s.failures))
        self.assertGreater(len(axes.texts), 0)  # contours with their levels

    def test_titles_say_what_the_parameters_are(self):
        coulomb = r"$\mu_s$ = 1, $\mu_d$ = 0.25, "
        levels = self.folder / "levels.csv"
        levels.write_text("x,rate_up,rate_down\n-2,1,0\n0,1,1\n2,0,1\n")
        for options, title in (
                ({}, coulomb + r"$\tau$ = 1, $\delta$ = 1/2, $b(v) = -v$"),
                ({"delta": None, "delta_per_mu_s": 2, "noise_deviation": 0.8, "noise_levels": "full", "bias": 0.1},
                 coulomb + r"$\tau$ = 1, $\sigma$ = 0.8, $\delta$ = 1/2, $b(v) = -v$, $g$ = 0.1"),
                ({"friction": "stribeck", "stribeck_velocity": 0.3, "drag": "cubic", "drag_cubic": 2, "mu_s_minus": 2},
                 coulomb + r"$\mu_s^-$ = 2, $v_s$ = 0.3, $\gamma$ = 1, $\tau$ = 1, $\delta$ = 1/2, $b(v) = -v - 2 v^3$"),
                ({"drag": "cubic", "drag_coefficient": 0, "drag_cubic": 1},
                 coulomb + r"$\tau$ = 1, $\delta$ = 1/2, $b(v) = -v^3$"),
                ({"noise": "telegraph", "telegraph_amplitude": 2, "telegraph_rate": 3, "drag": "none", "delta": None},
                 coulomb + r"$a$ = 2, $\kappa$ = 3, $b(v) = 0$"),
                ({"noise": "file", "noise_file": levels, "drag": "expression", "drag_expression": " -2*v", "delta": None},
                 coulomb + r"levels of levels.csv, $b(v) = -2*v$")):
            file = self.folder / "density.h5"
            self.assertEqual(style.title(stickslip.run(**{**SMALL, **options}, quantities="density", keep=file)), title)
            self.assertEqual(style.title(stickslip.load(file)), title)

    def test_pictures_without_a_program_have_the_names_of_options(self):
        density = stickslip.run(**SMALL, quantities="density")
        sweep = stickslip.sweep(tau=[1, 2], delta=0.5, quantities="noise_law")
        with self.fake(f"echo asked >> '{self.folder}/asked'; exit 1"):
            figure = density.plot(self.folder / "density.png")["density"]
            self.assertIn("mu_s = 1, mu_d = 0.25, ", figure._suptitle.get_text())
            self.assertEqual(sweep.plot()["E_X2"].axes[0].get_xlabel(), "tau")
        self.assertEqual((self.folder / "asked").read_text(), "asked\n")  # once for all symbols

    def test_slips_are_shaded_behind_the_path(self):
        r = stickslip.run(quantities="given_force", force_file=SOURCES / "options" / "given_force.csv")
        for axes, key in zip(r.plot()["given_force"].axes, ("path_force", "path_velocity", "path_displacement")):
            values = r[key].value
            self.assertLess(numpy.ptp(axes.get_ylim()), 1.2 * numpy.ptp(values))
            (shade,) = axes.collections
            self.assertEqual(len(shade.get_paths()), r["slip_count"].value)

    def test_arrays_of_a_sweep_over_what_has_more_values(self):
        options = {"delta": 1, "noise_deviation": 2, "quantities": "displacement_distribution", "start": "rest", "time": 1,
                   "route": "monte_carlo", "excursions": 100}
        for taus, distances, curves, over, said in (
                ([1, 2, 3], [0.1, 0.2], ["$d$ = 0.1", "$d$ = 0.2"], "tau", ""),
                ([1, 2], [0.1, 0.2], ["$\\tau$ = 1", "$\\tau$ = 2"], "displacement $d$", ""),
                (range(1, 7), range(1, 9), [f"$\\tau$ = {n}" for n in (1, 2, 3, 5, 6)], "displacement $d$", "5 of 6 values")):
            s = stickslip.sweep(tau=list(taus), distance=list(distances), **options)
            (axes,) = s.plot(kind="displacement_cdf(1)")["displacement_cdf(1)"].axes
            self.assertEqual([text.get_text() for text in axes.get_legend().texts], curves)
            self.assertIn(over, axes.get_xlabel())
            self.assertEqual(axes.get_title().partition("\n")[2], said)

    def test_command_line(self):
        file = self.folder / "λ 1.h5"
        stickslip.run(**SMALL, quantities="density,spectrum", omega=[0.1, 1], keep=file)
        self.assertEqual(self.plot(file.name), ["λ 1_density.png", "λ 1_spectra.png"])
        self.assertEqual(self.plot(file.name, file.name, "both.png"), ["both.png"])
        stickslip.sweep(tau=[1, 2], delta=0.5, quantities="noise_law", sweep_csv=self.folder / "s.csv")
        self.assertEqual(self.plot("s.csv"), ["s/E_X2.png", "s/P_X_le_mu_s.png"])
        self.assertEqual(self.plot("--kind", "E_X2", "s.csv"), ["s.png"])
        for name in ("e.svg", "e.pdf", "e.png"):
            self.assertEqual(self.plot("-o", name, "--kind", "E_X2", "s.csv"), [name])
        width = int.from_bytes((self.folder / "e.png").read_bytes()[16:20], "big")
        self.assertEqual(width, 6.4 * 200)  # inches of the figure, points of an inch in print


if __name__ == "__main__":
    unittest.main()
