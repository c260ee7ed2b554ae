"""The command line that scripts rely on: options, exit statuses, summary and files."""

import json
import os
import re
import struct
import subprocess
import unittest

import h5py
import numpy

from running import BINARIES, Case, PROGRAMS, SOURCES, run

SMALL = ("-mu_d", "0.25", "-delta", "0.5")


class Refusals(Case):
    """Bad input ends with status 2 and a message, and touches nothing."""

    def refuse(self, *options, message=()):
        kept = self.folder / "kept.json"
        kept.write_text("precious")
        done = run(*options, "-summary", kept, folder=self.folder)
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertEqual(done.stdout, "")
        self.assertEqual(kept.read_text(), "precious")
        self.assertEqual([f.name for f in self.folder.iterdir() if ".part" in f.name], [])
        for part in message:
            self.assertIn(part, done.stderr)

    def test_names(self):
        self.refuse("-detla", "0.5", message=("did you mean -delta?",))
        self.refuse("-mu_s=3", message=("-mu_s=3", "unknown option", "write -mu_s 3"))
        self.refuse("-mu_s", "=", "3", message=("-mu_s = =: is no value", "write -mu_s value, without ="))
        self.refuse("mu_s", "3", message=("mu_s: belongs to no option; did you mean -mu_s?",))
        self.refuse("-slide_mat_mumps_icntl_77", "3", message=("-slide_mat_mumps_icntl_77",))
        self.refuse("scene.opts", message=("belongs to no option",))

    def test_names_of_the_literature_and_of_other_programs(self):
        for words, message in (("-ksp_view", "did you mean -slide_ksp_view?"), ("-pc_type lu", "did you mean -slide_pc_type?"),
                               ("-mu_d=0.5", "write -mu_d 0.5"), ("-sigma 2", "did you mean -noise_deviation?"),
                               ("-record force.csv", "did you mean -noise_file? See docs/recorded_forces.md"),
                               ("-quantities psd", "did you mean spectrum?"),
                               ("-quantities sticking,msd", "-quantities = msd: must be"),
                               ("-quantities msd", "did you mean displacement?"),
                               ("-quantities mfpt", "did you mean first_passage?"),
                               ("-quantities P_stick", "did you mean sticking?"), ("-route mc", "did you mean monte_carlo?")):
            self.refuse(*words.split(), message=(message,))

    def test_solvers(self):
        for pc in ("shell", "mg", "eisenstat", "ml", "hmg", "foo"):
            self.refuse(*SMALL, "-slide_pc_type", pc,
                        message=(f"-slide_pc_type = {pc}: must be elements, lu",))
        self.refuse(*SMALL, "-slide_pc_type", "iluu", message=("did you mean ilu?",))
        self.refuse(*SMALL, "-slide_ksp_type", "gmre", message=("-slide_ksp_type = gmre: must be preonly",
                                                              "did you mean gmres?"))
        self.refuse(*SMALL, "-slide_pc_typ", "lu", message=("-slide_pc_typ:", "did you mean -slide_pc_type?"))
        self.refuse(*SMALL, "-relax_eps_tpye", "x", message=("did you mean -relax_eps_type?",))
        self.refuse(*SMALL, "-quantities", "relaxation", "-relax_eps_ncv", "3", message=("ncv must be at least nev+1",))
        self.run_ok(*SMALL, "-relax_eps_target", "3", "-accuracy", "1e-3")
        self.refuse(*SMALL, "-slide_pc_factor_mat_solver_type", "foo",
                    message=("-slide_pc_factor_mat_solver_type = foo:",))
        for option, choice in (("ksp_rtol", "ksp_type gmres"), ("ksp_gmres_restart", "ksp_type gmres"),
                               ("pc_factor_levels", "pc_type ilu"), ("sub_pc_type", "pc_type bjacobi")):
            self.refuse(*SMALL, f"-slide_{option}", "3",
                        message=(f"-slide_{option}: the solver chosen does not read it; add -slide_{choice}, or",))
        for pc in ("elements", "lu", "qr", "redundant"):
            self.run_ok(*SMALL, "-slide_pc_type", pc, "-accuracy", "1e-3")
        self.run_ok(*SMALL, "-slide_ksp_type", "gmres", "-accuracy", "1e-3")

    def test_observables_with_jumps_and_kinks_in_v(self):
        asks = ("-mu_d", "0.5", "-delta", "0.25", "-lambda", "0", "-time", "1", "-observable")
        for quantity in ("resolvent", "expectation"):
            for observable, message in (("v^2; v>x", "v>x jumps or has a kink at v = "), ("1/(v-2)", "unbounded at v = 2"),
                                     ("rint(40*v)", "65 or more")):
                self.refuse(*asks, observable, "-quantities", quantity,
                            message=(f"-observable = {observable}", message, "-scheme upwind"))
        self.run_ok(*asks, "x==1.25 && v<-3", "-quantities", "resolvent", "-accuracy", "1e-3")

    def test_references_of_unknown_results(self):
        header = "quantity,argument,value,low,high\n"
        file = self.folder / "a.csv"
        file.write_text(header + "P_slide,,0.8,0,1\nP_stik,,0.2,0,1\n")
        self.refuse(*SMALL, "-compare", file, message=("holds P_stik, which is no key", "did you mean P_stick?"))
        file.write_text(header + "P_stick,,0.2,0,1\nvar_slide,,0.2,0,1\n")
        s = self.summary(*SMALL, "-compare", file)
        self.assertEqual(s["comparison"]["left_out"], ["var_slide"])

    def test_every_result_can_be_compared(self):
        every = ("sticking,moments,averages,noise_law,entry_law,laplace,resolvent,relaxation,"
                 "spectrum,duration_density,autocorrelation,expectation,sensitivity,large_deviation")
        every = (*SMALL, "-quantities", every, "-lambda", "1", "-omega", "1", "-time", "1", "-tilt", "-0.5",
                 "-observable", "v^2; x*v", "-accuracy", "1e-3")
        asymmetric = (*every, "-mu_d_minus", "0.3", "-bias", "0.1")
        for asks in (every, asymmetric):
            self.run_ok(*asks, "-summary", "all.json")
            s = self.summary(*asks, "-compare", "all.json")
            self.assertEqual(s["comparison"]["left_out"], [])

    def test_starts_off_the_grid(self):
        asks = ("-mu_d", "0.25", "-delta", "0.25", "-quantities", "expectation", "-observable",
                "v^2", "-time", "1", "-start")
        for start, end in (("1.25,100", "[0, 7.75]"), ("1.25,-100", "[-7.75, 0]")):
            self.refuse(*asks, start, message=(f"-start = {start}: starts at a velocity that no body",
                                            f"take v in {end}"))
        for scheme in (("-scheme", "hp"), ("-scheme", "upwind", "-p", "16")):
            self.refuse(*asks, "0,7.2", *scheme,
                        message=("-start = 0,7.2: starts beyond the largest v", "take |v| at most"))
        self.refuse(*asks, "8,0", message=("-start = 8,0: starts beyond the largest x",
                                        "take |x| at most 7, or -noise_levels full"))
        self.run_ok(*asks, "8,0", "-noise_levels", "full", "-accuracy", "0.1")
        self.run_ok(*asks, "1.25,5", "-accuracy", "1e-4")
        trajectory = (*SMALL, "-quantities", "trajectory", "-trajectory", "t.csv", "-horizon", "1")
        self.refuse(*trajectory, "-start", "1,100", message=("no body reaches",))
        self.run_ok(*trajectory, "-start", "1,100", "-drag", "none")

    def test_files(self):
        self.refuse("-options_file", "/no/such/file", message=("cannot be read",))
        self.refuse("-output", "/no/such/folder/x.h5", message=("-output", "does not exist"))
        broken = self.folder / "broken.opts"
        for text, message in ((b"-mu_s 1\nmu_d 0.5\n", "broken.opts:2"), (b"\xef\xbb\xbf-mu_d 1\n", "byte order mark"),
                              (b"-mu_s 1\n\0\x1b[2J\n", "broken.opts:2: is no text"),
                              (b'-mu_s 1\n-output "run # 3.h5"\n', "broken.opts:2: has a # in quotes"),
                              (b'-output "run.h5\n', "broken.opts:1: has a quote that is not closed"),
                              (b"-mu_s 1\n-tau -1\n", f"({broken}:2)"), (b"-tua 1\n", f"did you mean -tau? ({broken}:1)"),
                              (b"-mu_s 1 -mu_d 0.5\n", "write one -name value a line")):
            broken.write_bytes(text)
            self.refuse("-options_file", broken, message=(message,))
        broken.write_bytes(b'-mu_s 1  # of 1" steel\n')
        self.run_ok("-options_file", broken, *SMALL)

    def test_devices_and_pipes_stay(self):
        pipe = self.folder / "pipe"
        os.mkfifo(pipe)
        for option in ("-summary", "-output", "-checkpoint"):
            done = run(*SMALL, *(("-sweep_mu_d", "1") if option == "-checkpoint" else ()), option, pipe)
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertIn(f"{option} = {pipe}: is a device or a pipe", done.stderr)
            self.assertTrue(pipe.is_fifo())

    def test_the_table_and_a_file_have_places_of_their_own(self):
        with open(self.folder / "table.txt", "w") as table:
            done = subprocess.run([BINARIES / "stickslip", *SMALL, "-summary", "table.txt"], cwd=self.folder,
                                  stdout=table, stderr=subprocess.PIPE, text=True, timeout=60)
        self.assertEqual(done.returncode, 2)
        self.assertIn("-summary = table.txt: is where standard output goes", done.stderr)


class Statuses(Case):
    def test_done(self):
        self.assertEqual(run(*SMALL).returncode, 0)

    def test_where_double_precision_ends(self):
        scene = ("-mu_d", "0.5")
        self.run_ok(*scene, "-accuracy", "1e-14")
        self.assertIn("rounding limits", self.run_ok(*scene, "-accuracy", "1e-15", status=3).stdout)
        message = self.run_ok("-accuracy", "1e-16", status=2).stderr
        self.assertIn("double precision allows down to about 1e-14", message)

    def test_accuracy_not_reached_still_writes(self):
        file = self.folder / "s.json"
        done = run(*SMALL, "-degree", "3", "-accuracy", "1e-12", "-summary", file)
        self.assertEqual(done.returncode, 3)
        summary = json.loads(file.read_text())
        self.assertFalse(summary["accuracy"]["reached"])
        self.assertIn("shortfall", summary["accuracy"])
        self.assertGreater(summary["results"]["P_stick"]["value"], 0)

    def test_would_not_fit(self):
        done = run(*SMALL, "-scheme", "upwind", "-p", "9999999")
        self.assertEqual(done.returncode, 4)
        self.assertIn("memory", done.stderr)

    def test_velocity_cut_by_hand_is_judged(self):
        low = run(*SMALL, "-v_max", "1", "-accuracy", "1e-4")
        self.assertEqual(low.returncode, 3)
        self.assertIn("-v_max = 1 excludes", low.stdout)
        self.assertEqual(run(*SMALL, "-v_max", "3.7", "-accuracy", "1e-4").returncode, 0)

    def test_closed_pipe_is_no_crash(self):
        import subprocess
        from running import BINARIES
        line = f"{BINARIES / 'stickslip'} -help | head -1"
        done = subprocess.run(line, shell=True, capture_output=True, text=True)
        self.assertEqual(done.stderr, "")


class SlowBlas(Case):
    REFERENCE = "/usr/lib/x86_64-linux-gnu/blas/libblas.so.3"

    @unittest.skipUnless(os.path.exists(REFERENCE), "the reference BLAS is not installed")
    def test_is_told(self):
        done = run(*SMALL, environment={"LD_PRELOAD": self.REFERENCE})
        self.assertEqual(done.returncode, 0)
        self.assertIn("slow BLAS", done.stderr)
        self.assertIn("libopenblas0", done.stderr)
        self.assertNotIn("slow BLAS", run(*SMALL).stderr)


class Texts(Case):
    def test_help_and_versions(self):
        for word in ("-help", "--help", "-h"):
            done = run(word)
            self.assertEqual(done.returncode, 0)
            self.assertIn("-mu_d", done.stdout)
        self.assertIn("PETSc 3.", run("-version").stdout)

    def test_help_of_solvers(self):
        own = run("-help_solvers")
        self.assertEqual((own.returncode, own.stderr), (0, ""))
        self.assertIn("-slide_pc_elements_share", own.stdout)
        self.assertNotIn("-slide_mat_mumps_icntl_14", own.stdout)
        names = set(re.findall(r"^ +(-[a-z]\w+)", own.stdout, re.MULTILINE))
        self.assertGreater(len(names), 20)
        self.assertEqual([name for name in names if not name.startswith("-slide_")], [])
        self.assertRegex(own.stdout, r"-slide_pc_type .* elements .*\bilu\b")
        self.assertNotRegex(own.stdout, r"-slide_pc_type .*\bshell\b")
        lu = run("-help_solvers", "-slide_pc_type", "lu").stdout
        self.assertRegex(lu, "-slide_mat_mumps_icntl_7:? <now 2")  # with a colon after PETSc 3.18

    def test_later_options_win(self):
        scene = self.folder / "scene.opts"
        scene.write_text("-mu_d 0.25\n-delta 0.5\n")
        after = self.summary("-options_file", scene, "-mu_d", "0.5")
        before = self.summary("-mu_d", "0.5", "-options_file", scene)
        self.assertEqual(after["scene"]["mu_d"], 0.5)
        self.assertEqual(before["scene"]["mu_d"], 0.25)

    def test_petscrc_is_not_read(self):
        (self.folder / ".petscrc").write_text("-mu_d 0.1\n")
        self.assertEqual(self.summary(*SMALL[2:])["scene"]["mu_d"], 1.0)

    def test_progress_on_request(self):
        self.assertNotIn("refinement level 1:", run(*SMALL).stderr)
        self.assertIn("refinement level 1:", run(*SMALL, "-progress", "on").stderr)

    def test_long_levels_say_how_long(self):
        """The first refinement level, too, before it begins."""
        command = [BINARIES / "stickslip", "-delta", "0.01", "-degree", "16", "-quantities", "spectrum", "-progress", "on"]
        with subprocess.Popen([*map(str, command)], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) as process:
            for line in process.stderr:
                if "refinement level 1:" in line:
                    break
            process.kill()
        self.assertRegex(line, r"refinement level 1:.* unknowns, about \d+ s$")


class Summary(Case):
    def test_layout(self):
        s = self.summary(*SMALL, "-quantities", "sticking,moments,noise_law,entry_law")
        self.assertEqual(list(s), ["scene", "results", "accuracy", "cost", "plan", "provenance", "warnings"])
        for key in ("P_stick", "P_slide", "mean_stick", "mean_slide", "mean_excursion", "E_V2",
                    "E_absV", "E_XV", "E_V", "P_X_le_mu_s", "E_X2", "f_stick_0"):
            self.assertIn("value", s["results"][key])
            self.assertGreaterEqual(s["results"][key]["error"], 0)
        entries = s["results"]["entry_law"]
        self.assertEqual(entries["k"], [-2, -1, 0, 1, 2])
        self.assertEqual(len(entries["value"]), 5)
        self.assertEqual(len(entries["error"]), 5)
        self.assertAlmostEqual(sum(entries["value"]), 1, 12)
        for key in ("assemblies", "factorizations_real", "factorizations_complex", "solves",
                    "unknowns"):
            self.assertIn(key, s["plan"])
        self.assertEqual(s["provenance"]["options"]["delta"], "0.5")

    def test_only_what_is_asked(self):
        s = self.summary(*SMALL, "-quantities", "noise_law")
        self.assertEqual(set(s["results"]), {"P_X_le_mu_s", "E_X2"})
        self.assertEqual(s["plan"]["assemblies"], 0)
        self.assertEqual(s["results"]["P_X_le_mu_s"]["value"], 51766 / 65536)

    @unittest.skipIf(len(PROGRAMS) < 2, "built with real scalars alone")
    def test_build_variants_agree(self):
        options = (*SMALL, "-quantities", "sticking,moments,entry_law", "-accuracy", "1e-10")
        real, complex_ = (self.summary(*options, program=program)["results"] for program in PROGRAMS)
        self.assertEqual(list(real), list(complex_))
        for key, result in real.items():
            for a, b in zip(numpy.atleast_1d(result["value"]),
                            numpy.atleast_1d(complex_[key]["value"])):
                self.assert_close(a, b, 1e-12, key)

    def test_solver_can_be_replaced(self):
        usual = self.summary(*SMALL)
        other = self.summary(*SMALL, "-slide_pc_factor_mat_solver_type", "klu")
        self.assert_close(usual["results"]["P_stick"]["value"],
                          other["results"]["P_stick"]["value"], 1e-12)

    def test_a_solver_that_does_not_converge(self):
        done = self.run_ok(*SMALL, *"-slide_ksp_type gmres -slide_pc_type none -slide_ksp_max_it 1".split(), status=3)
        self.assertIn("or a larger -slide_ksp_max_it", done.stderr)
        self.run_ok(*SMALL, *"-slide_ksp_type gmres -slide_pc_type none -slide_ksp_max_it 1".split(),
                    "-slide_ksp_error_if_not_converged", status=3)

    def test_the_matrix_is_written(self):
        fixed = (*SMALL, "-degree", "4", "-layers", "3")
        step = self.summary(*fixed, "-slide_mat_view", "binary:matrix.petsc", status=3)["cost"]["steps"][-1]
        code, rows, columns, entries = struct.unpack(">4i", (self.folder / "matrix.petsc").read_bytes()[:16])
        self.assertEqual((code, rows, columns, entries), (1211216, step["unknowns"], step["unknowns"], step["nonzeros"]))
        self.assertEqual((self.folder / "matrix.petsc").stat().st_size, 16 + 4 * rows + 12 * entries)


class Hdf5(Case):
    OPTIONS = (*SMALL, "-quantities", "sticking,moments,noise_law,entry_law,density")

    def test_same_numbers_as_the_summary(self):
        s = self.summary(*self.OPTIONS, "-output", "out.h5")
        with h5py.File(self.folder / "out.h5") as file:
            for key, result in s["results"].items():
                group = file["results"][key]
                numpy.testing.assert_array_equal(group["value"], result["value"])
                numpy.testing.assert_array_equal(group["error"], result["error"])
            self.assertEqual(file["record/options"].attrs["delta"], "0.5")
            self.assertIn("commit", file["record"].attrs)

    def test_axes_are_dimension_scales(self):
        asked = ("-quantities", "density,spectrum,relaxation,trajectory", "-omega", "1,2,4", "-accuracy", "1e-2")
        self.run_ok(*SMALL, *asked, "-output", "run.h5")
        self.run_ok(*SMALL, *asked[:4], "-sweep_tau", "1,2", "-quantities", "slip,spectrum", "-distance", "0.1,0.3",
                    "-output", "sweep.h5")
        axes = {"run": {"density/pdf": ["x", "v"], "density/atom": ["x"], "density/weights": ["v"],
                        "relaxation_odd/mode_1/real": ["x", "v"], "trajectory/v": ["time"],
                        "results/S_v/value": ["omega"], "results/S_v/error": ["omega"], "results/S_0/value": []},
                "sweep": {"sweep/S_v": ["tau", "omega"], "sweep/S_v_error": ["tau", "omega"],
                          "sweep/cdf_slip": ["tau", "distance"], "sweep/seconds": ["tau"]}}
        for name, held in axes.items():
            with h5py.File(self.folder / f"{name}.h5") as file:
                for path, names in held.items():
                    found = [dim[0].name.rpartition("/")[2] for dim in file[path].dims]
                    self.assertEqual(found, names, path)
                empty = []
                file.visititems(lambda path, item: empty.extend(k for k, value in item.attrs.items() if str(value) == ""))
                self.assertEqual(empty, [], name)
                self.assertIn("noise_file", file["record"].attrs["options_without_effect"].split(","))

    def test_density(self):
        for program in PROGRAMS:
            s = self.summary(*self.OPTIONS, "-output", "out.h5", program=program)
            with h5py.File(self.folder / "out.h5") as file:
                d = {name: numpy.array(file["density"][name]) for name in file["density"]}
            self.assertEqual(d["pdf"].shape, (len(d["x"]), len(d["v"])))
            self.assertTrue(numpy.all(numpy.diff(d["v"]) > 0))
            # pi is invariant under (x, v) -> (-x, -v).
            numpy.testing.assert_allclose(d["pdf"], d["pdf"][::-1, ::-1], rtol=1e-12, atol=1e-14)
            self.assertAlmostEqual(d["atom"].sum(), s["results"]["P_stick"]["value"], 12)
            self.assertAlmostEqual(d["marginal_x"].sum(), 1, 12)
            self.assertIn("out.h5:/density/pdf", (self.folder / "out.xdmf").read_text())

    def test_rows_of_the_density_are_those_of_x(self):
        self.summary(*SMALL, "-bias", "0.4", "-quantities", "density", "-output", "out.h5")
        with h5py.File(self.folder / "out.h5") as file:
            d = {name: numpy.array(file["density"][name]) for name in file["density"]}
        sliding = numpy.trapezoid if hasattr(numpy, "trapezoid") else numpy.trapz
        of_rows = sliding(d["pdf"], d["v"], axis=1)
        numpy.testing.assert_allclose(of_rows, d["marginal_x"] - d["atom"], atol=0.02)

    def test_an_old_file_is_replaced_whole(self):
        (self.folder / "out.h5").write_text("old")
        self.run_ok(*self.OPTIONS, "-output", "out.h5")
        with h5py.File(self.folder / "out.h5") as file:
            self.assertIn("results", file)
        self.assertEqual(sorted(f.name for f in self.folder.iterdir()), ["out.h5", "out.xdmf"])


class Sources(unittest.TestCase):
    def test_version_matches_the_changelog(self):
        version = run("-version").stdout.split()[1]
        self.assertIn(f"## [{version}]", (SOURCES / "CHANGELOG.md").read_text())


if __name__ == "__main__":
    unittest.main()
