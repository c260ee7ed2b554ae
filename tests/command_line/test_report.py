"""Pictures of what the program wrote, and what the report is made with."""

import ast
import contextlib
import html.parser
import importlib.util
import io
import os
import pathlib
import struct
import subprocess
import sys
import unittest
from unittest import mock

from running import BINARIES, SOURCES, Case

sys.path.insert(0, str(SOURCES / "validation"))
import entry
import formulas
import harness
import pages
import report

SCENE = ("-mu_d", "0.25", "-delta", "0.5")
PNG = b"\x89PNG"


def plot(*words, folder):
    return subprocess.run([sys.executable, "-m", "stickslip", "plot", *words], capture_output=True, text=True,
                          cwd=folder, env={**os.environ, "PYTHONPATH": str(SOURCES / "python")})


class Pictures(Case):
    def drawn(self, *words):
        """The pictures that it names."""
        done = plot(*words, folder=self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        names = done.stdout.split()
        for name in names:
            self.assertTrue((self.folder / name).read_bytes().startswith(PNG), name)
        return names

    def refused(self, *words, message):
        done = plot(*words, folder=self.folder)
        self.assertEqual((done.returncode, done.stdout), (2, ""), done.stderr)
        for part in (words[0], message):
            self.assertIn(part, done.stderr)
        self.assertEqual(list(self.folder.glob("*.png")), [])

    def test_files_that_cannot_be_drawn_are_refused(self):
        self.run_ok(*SCENE, "-output", "scalars.h5", "-quantities", "noise_law,trajectory")
        (self.folder / "text.h5").write_text("text")
        (self.folder / "cut.h5").write_bytes((self.folder / "scalars.h5").read_bytes()[:-9])
        (self.folder / "foreign.csv").write_text("a,b\n1,2\n")
        self.refused("none.h5", message="no such file")
        self.refused("text.h5", message="HDF5")
        self.refused("cut.h5", message="HDF5")
        self.refused("foreign.csv", message="neither a sweep nor a path")
        self.run_ok(*SCENE, "-output", "scalars.h5", "-quantities", "noise_law")
        self.refused("scalars.h5", message="nothing to draw; ask the program")
        self.run_ok(*SCENE, "-output", "path.h5", "-quantities", "trajectory")
        for picture in ("none/path.png", "path.foo"):
            done = plot("path.h5", picture, folder=self.folder)
            self.assertEqual(done.returncode, 2)
            self.assertIn(picture, done.stderr)


class Report(unittest.TestCase):
    def test_every_simulated_scene_has_its_own_seed(self):
        scene = {"route": "monte_carlo", "mu_d": 0.25, "delta": 0.5}
        others = ({**scene, "mu_d": 0.5}, {**scene, "delta": 0.25}, {**scene, "quantities": "laplace"})
        seeds = [harness.seed_of(one) for one in (scene, *others)]
        self.assertEqual(len(set(seeds)), 4)
        self.assertEqual(harness.seed_of({**scene, "output": pathlib.Path("f.h5")}), seeds[0])

    def test_seeds_reach_the_program(self):
        program = harness.Program("program")
        with mock.patch("subprocess.Popen", side_effect=OSError) as run:
            for options, seeded in (({"route": "monte_carlo"}, True), ({"mu_d": 1}, False),
                                    ({"quantities": "sticking,trajectory"}, True)):
                self.assertRaises(SystemExit, program.run, **options)
                self.assertEqual("-seed" in run.call_args.args[0], seeded)

    def test_pictures_ask_the_program_that_is_drawn(self):
        program = SOURCES / "other" / "stickslip"
        with mock.patch("sys.argv", ["run.py", "--program", str(program)]), mock.patch.dict("os.environ"):
            entry.Entry("Title.", "paper").scratch.cleanup()
            self.assertEqual(os.environ["STICKSLIP"], str(program))

    def test_tables_have_no_empty_column(self):
        with mock.patch("sys.argv", ["run.py"]), mock.patch.dict("os.environ"):
            made = entry.Entry("Title.", "paper")
            made.scratch.cleanup()
        with contextlib.redirect_stdout(io.StringIO()):
            made.table("caption", ("a", "b", "c"), [("1", "", 2.0), ("", "", 3.0)])
        self.assertEqual((made.parts[0]["columns"], made.parts[0]["rows"]),
                         (["a", "c"], [["1", "2"], ["", "3"]]))


class Page(html.parser.HTMLParser):
    """What a page holds; an error where elements are not closed in their order."""

    VOID = ("meta", "link", "img", "br")

    def __init__(self, path):
        super().__init__()
        self.path, self.open, self.links, self.images, self.elements = path, [], [], [], []
        self.feed(path.read_text())
        self.close()
        if self.open:
            raise ValueError(f"{path}: {self.open} is not closed")

    def handle_starttag(self, tag, attrs):
        given = dict(attrs)
        self.elements.append((tag, given))
        self.links += [given[name] for name in ("href", "src") if name in given]
        if tag == "img":
            self.images.append((given, list(self.open)))
        if tag not in self.VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        if not self.open or self.open.pop() != tag:
            raise ValueError(f"{self.path}: </{tag}> at {self.getpos()}")

    def tags(self, tag):
        return [given for name, given in self.elements if name == tag]


def made_up(**more):
    return {"title": "Values at mu_d < mu_s", "about": ["Why <b> is no tag."], "paper": "Table 1", "failed": False,
            "seconds": 3.2, **more, "parts": [
                {"text": "P_stick & more"}, {"picture": "a.png", "caption": 'The "first" picture, E[V^2] > 0'},
                {"caption": "Numbers", "columns": ["mu_d", "found"], "rows": [["1/4", "0.5"], ["1", "-1e-3"]]},
                {"verdict": "FAILS" if more.get("failed") else "holds", "claim": "|z|",
                 "numbers": "largest 2, allowed 4"}]}


class Pages(Case):
    def written(self, entries):
        """Pages of these entries by their path below the report."""
        for case in entries:
            (self.folder / case).mkdir(exist_ok=True)
            (self.folder / case / "a.png").write_bytes(PNG + bytes(12) + struct.pack(">II", 1600, 800))
        pages.write(entries, self.folder, "A note.", "a machine", quick=True)
        return self.found()

    def found(self):
        return {str(path.relative_to(self.folder)): Page(path) for path in self.folder.rglob("*.html")}

    def check(self, found):
        """Links lead to files, pictures have captions and words in their place, and nothing comes from outside."""
        for page in found.values():
            for link in page.links:
                self.assertTrue((page.path.parent / link).resolve().is_file(), f"{page.path}: {link}")
            for given, around in page.images:
                self.assertTrue(given["alt"])
                self.assertIn("figure", around)
            self.assertEqual(len(page.tags("figcaption")), len(page.tags("figure")))
            self.assertEqual((page.tags("script"), page.tags("html")), ([], [{"lang": "en"}]))
            self.assertEqual([given["name"] for given in page.tags("meta") if "name" in given], ["viewport"])

    def test_every_entry_has_a_page_that_links_reach(self):
        found = self.written({name: made_up() for name in ("one", "two", "three")})
        self.check(found)
        self.assertEqual(sorted(found), ["index.html", "one/index.html", "three/index.html", "two/index.html"])
        for name in ("one", "two", "three"):
            self.assertIn(f"{name}/index.html", found["index.html"].links)
            self.assertIn("../index.html", found[f"{name}/index.html"].links)
        steps = {name: {given["rel"]: given["href"] for given in found[f"{name}/index.html"].tags("a")
                        if "rel" in given} for name in ("one", "two", "three")}
        self.assertEqual(steps, {"one": {"next": "../two/index.html"}, "three": {"prev": "../two/index.html"},
                                 "two": {"prev": "../one/index.html", "next": "../three/index.html"}})

    def test_a_page_shows_all_parts(self):
        page = self.written({"one": made_up()})["one/index.html"]
        text = page.path.read_text()
        for words in ("Why &lt;b&gt; is no tag.", "<figcaption><b>Table 1.</b>Numbers</figcaption>",
                      "<figcaption><b>Figure 1.</b>The", '<td class="number">-1e-3</td>', "largest 2, allowed 4",
                      "&amp; more", "validation/paper.py one --quick"):
            self.assertIn(words, text)
        self.assertEqual(page.images[0][0], {"src": "a.png", "alt": 'The "first" picture, E[V^2] > 0',
                                             "width": "1000", "height": "500"})

    def test_failures_are_on_the_first_page(self):
        stopped = {**made_up(failed=True), "parts": [{"printed": "no <program>"}]}
        for failed in (made_up(failed=True), stopped):
            text = self.written({"one": made_up(), "two": failed})["index.html"].path.read_text()
            self.assertIn("1 of 2 entries fail.", text)
            self.assertEqual((text.count("✓ holds"), text.count("✗ fails")), (1, 1))
        self.assertIn("no &lt;program&gt;", (self.folder / "two" / "index.html").read_text())

    def test_every_case_says_what_it_compares(self):
        scripts = (SOURCES / "validation").glob("*/run.py")
        folders = {path.parent.name for path in scripts if "Entry(" in path.read_text()}
        self.assertEqual(folders - set(report.CASES), {"benchmark"})
        for name in report.CASES:
            file, *function = harness.script(name)
            tree = ast.parse((SOURCES / file).read_text())
            node = next(node for node in tree.body if getattr(node, "name", "") in function) if function else tree
            doc = ast.get_docstring(node)
            self.assertGreater(len(" ".join(entry.about(doc))), 150, name)


class Formulas(unittest.TestCase):
    def test_formulas_are_found_between_words(self):
        for text, there in (
                ("at mu_d = 1/4, a value", "at <math><msub><mi>μ</mi><mi>d</mi></msub><mo>=</mo><mn>1</mn><mo>/</mo>"
                 "<mn>4</mn></math>\u2060, a value"),
                ("P_stick", "<math><msub><mi>P</mi><mtext>stick</mtext></msub></math>"),
                ("as tau -> 0.", "as <math><mi>τ</mi><mo>→</mo><mn>0</mn></math>\u2060."),
                ("lambda-problem", "<math><mi>λ</mi></math>\u2060-problem"),
                ("below 1e-9", "below <math><msup><mn>10</mn><mn>−9</mn></msup></math>"),
                ("b(v) = -v", '<math><mi>b</mi><mrow><mo form="prefix">(</mo><mi>v</mi><mo form="postfix">)</mo></mrow>'
                 '<mo>=</mo><mo form="prefix">−</mo><mi>v</mi></math>'),
                ("dE_X_dmu_d_minus", "<math><mrow><mi>∂</mi><msub><mi>E</mi><mi>X</mi></msub></mrow><mo>/</mo>"
                 "<mrow><mi>∂</mi><msup><mrow><msub><mi>μ</mi><mi>d</mi></msub></mrow><mo>−</mo></msup></mrow></math>"),
                ("E_X2", '<math><mi>E</mi><mrow><mo form="prefix">[</mo><msup><mrow><mi>X</mi></mrow><mrow><mn>2</mn>'
                 '</mrow></msup><mo form="postfix">]</mo></mrow></math>')):
            self.assertEqual(formulas.html_of(text), there)

    def test_words_numbers_and_commands_stay(self):
        for text in ("a body", "0.03 s", "-1.5e-3", "2.5e-7", "[0.1, 0.2]", "v>0?0-2*v:0-0.5*v", "0-v*abs(v)", "50 E(y==0)",
                     "Garnier's (9, 5) of 0.1302"):
            self.assertEqual(formulas.html_of(text), text.replace(">", "&gt;"))
        self.assertEqual(formulas.html_of("-mu_d, mean_slide[0]"), "<code>-mu_d</code>, <code>mean_slide[0]</code>")
        self.assertEqual(formulas.html_of("stickslip -mu_d 1 -tau 2"), "<code>stickslip -mu_d 1 -tau 2</code>")


def case(name):
    """The module of a case of validation/ that can be imported."""
    spec = importlib.util.spec_from_file_location(name, SOURCES / "validation" / name / "run.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


class Faults(unittest.TestCase):
    """The case of the report that shows them; ctest runs the faults themselves without it."""

    def test_it_names_tests_that_there_are(self):
        faults, loader = case("faults"), unittest.TestLoader()
        loader.loadTestsFromNames(faults.QUICK + faults.LONG)
        self.assertEqual(loader.errors, [])

    def test_a_fault_that_is_not_seen_fails(self):
        class Lost(unittest.TestCase):
            def runTest(self):
                """disk full: nothing half written"""
                self.fail("half written")

        result = case("faults").Timed()
        with contextlib.redirect_stderr(io.StringIO()):
            Lost().run(result)
        self.assertEqual(result.rows[0][:3], ("disk full", "nothing half written", "FAILS"))

    def test_damaged_input_is_counted(self):
        shown = mock.Mock()
        with mock.patch.dict("os.environ", STICKSLIP_BINARIES=str(BINARIES)):
            case("faults").fuzz_runs(shown, 3)
        self.assertRegex(shown.text.call_args.args[0], "runs")
        self.assertEqual(shown.claim.call_args.args[1:], (0, 0.5))


if __name__ == "__main__":
    unittest.main()
