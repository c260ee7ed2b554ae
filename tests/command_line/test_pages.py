"""What the pages of the manual show is what the program prints; and the comparison itself."""

import pathlib
import tempfile
import unittest

import pages
import printed

TABLE = """\
mu_s = 1   mu_d = 0.5   tau = 1   delta = 0.125   drag linear, c = 1

quantity                            value     error  relative
P_stick               0.26763461567621299   6.4e-08   2.4e-07
mean_stick            0.67989483749273938   2.2e-08   3.2e-08  time
E_V                                     0   0.0e+00   0.0e+00  velocity
S_v by omega
           0.001      0.57387055793035813   3.9e-10
              50   3.0809511993204307e-07   2.4e-14

degree layers  levels  nodes  unknowns       MB  assembly  analysis    factor     solve   total s  largest relative error
     6      8      56     59      3009        1     0.001     0.000     0.003     0.001     0.005  to compare with
     7      8      59     63      4284        2     0.002     0.000     0.004     0.001     0.007  3.0e-07 mean_slide
krylov_pairs = 14
accuracy 1e-06 reached; 0.04 s in all, 0.02 s of it start-up
"""
SWEEP = """\
       mu_d        tau            P_stick    error            P_slide    error
       0.25        0.5      0.03380222946  1.7e-09       0.9661977705  1.7e-09

        0.5        0.5      0.08021118866  1.5e-08       0.9197888113  1.5e-08

2 of 2 points reached the accuracy; 2.15 s in all, 0.06 s of it start-up
"""
COST = """\
hp: error is the largest relative one of a scalar
           degree            error          seconds        megabytes
                2   0.001398055098      0.003453841                1
               12  4.640732243e-14      0.202100236               28

hp: one more digit costs 1.44 times the time; 1e-6 takes about 0.0056 s
"""
COMPARISON = """\
quantity          argument             value         reference 95 % confidence     z  verdict
E_V2                            0.1780263033      0.1767987401 [0.1750339, 0.1785636]    1.36  agrees
"""


class Comparison(unittest.TestCase):
    def differ(self, page, output, *changes):
        """How many lines of a page differ from an output, after the output was changed from one text to another."""
        for old, new in changes:
            self.assertIn(old, output)
            output = output.replace(old, new)
        return len(printed.differences(page, output))

    def test_everything_agrees_with_itself(self):
        for text in (TABLE, SWEEP, COST, COMPARISON):
            self.assertEqual(printed.differences(text, text), [])
            self.assertEqual(printed.renewed(text, text), text)

    def test_a_digit_beyond_the_error(self):
        self.assertEqual(self.differ(TABLE, TABLE, ("0.26763461567621299", "0.26763477")), 1)
        self.assertEqual(self.differ(TABLE, TABLE, ("0.57387055793035813", "0.5738705590")), 1)
        self.assertEqual(self.differ(TABLE, TABLE, ("3.0809511993204307e-07", "3.0809541993204307e-07")), 1)
        self.assertEqual(self.differ(TABLE, TABLE, ("E_V                                     0",
                                                    "E_V                                 1e-99")), 1)
        self.assertEqual(self.differ(SWEEP, SWEEP, ("0.03380222946", "0.03380223346")), 1)
        self.assertEqual(self.differ("P = 0.25 +- 3e-02", "P = 0.33 +- 3e-02"), 1)

    def test_a_number_without_an_error(self):
        self.assertEqual(self.differ(COMPARISON, COMPARISON, ("0.1780263033", "0.1780263034")), 0)
        self.assertEqual(self.differ(COMPARISON, COMPARISON, ("0.1780263033", "0.1780263036")), 1)
        self.assertEqual(self.differ(TABLE, TABLE, ("4284", "4290")), 1)
        self.assertEqual(self.differ(TABLE, TABLE, ("krylov_pairs = 14", "krylov_pairs = 18")), 1)

    def test_a_word(self):
        self.assertEqual(self.differ(TABLE, TABLE, ("mean_stick", "mean_stay")), 1)
        self.assertEqual(self.differ(TABLE, TABLE, ("reached", "NOT reached")), 1)
        self.assertEqual(self.differ(COMPARISON, COMPARISON, ("agrees", "DISAGREES")), 1)

    def test_lines(self):
        lines = TABLE.splitlines(keepends=True)
        self.assertEqual(self.differ(TABLE, TABLE + "more\n"), 1)
        self.assertGreaterEqual(self.differ(TABLE, "".join(lines[:3] + lines[4:])), 1)
        self.assertEqual(self.differ(TABLE, "".join(lines[:-1])), 1)
        self.assertEqual(self.differ("...\n" + lines[4] + "...\n", TABLE), 0)
        self.assertEqual(self.differ("...\n" + lines[4] + "...\n", TABLE, ("mean_stick", "mean_slide")), 1)
        self.assertEqual(self.differ("...\n" + lines[-1], TABLE), 0)
        self.assertEqual(self.differ("...\n" + lines[-2], TABLE), 1)
        self.assertEqual(self.differ(lines[0] + "...\n", TABLE), 0)
        self.assertEqual(self.differ("", TABLE) + self.differ(TABLE, ""), 1 + len(lines))


class Markdown(unittest.TestCase):
    def test_blocks(self):
        page = "```sh\na\nb\n```\nwords\n```text\nc\n```\n<!-- not run: long -->\n```sh\nd\n```\n```python\ne\n```\n"
        steps = [(run.language, run.text, expected and expected.text) for run, expected in pages.steps_of(page)]
        self.assertEqual(steps, [("sh", "a\nb\n", "c\n"), ("python", "e\n", None)])

    def test_what_is_not_clear_is_refused(self):
        for page in ("```\na\n```", "```c\na\n```", "<!-- not run: -->\n```\na\n```", "```text\na\n```",
                     "```sh\na\n```\n```text\nb\n```\n```text\nc\n```"):
            with self.assertRaises(ValueError, msg=page):
                pages.steps_of(page)


class Pages(unittest.TestCase):
    def complaints(self, name):
        with tempfile.TemporaryDirectory() as folder:
            return list(pages.complaints_about(name, folder))

    def of_text(self, text):
        with tempfile.TemporaryDirectory() as folder:
            page = pathlib.Path(folder) / "page.md"
            page.write_text(text)
            return self.complaints(str(page))

    def test_nothing_is_installed_or_built(self):
        self.assertEqual(self.of_text("```sh\n./bootstrap build\n./bootstrap test --all\n./bootstrap report\n```\n"
                                      "```text\n```"), [])
        self.assertIn("unknown command rebuild", self.of_text("```sh\n./bootstrap rebuild\n```")[0])

    def test_what_fails_or_prints_otherwise(self):
        small = "-delta 0.5 -quantities noise_law"
        self.assertIn("-detla", self.of_text(f"```sh\nbuild/stickslip {small} -detla 1\n```")[0])
        block = f"```sh\n./bootstrap run {small}\n```\n```text\n...\nE_X2   %s 1e-15 1e-15 force^2\n...\n```"
        self.assertEqual(self.of_text(block % 1), [])
        self.assertEqual(len(self.of_text(block % 1.1)), 1)
        self.assertIn("ZeroDivisionError", self.of_text("```python\nimport stickslip\n1 / 0\n```")[0])
        self.assertIn("is not there", self.of_text("![A picture](none.png)")[0])

    def test_pages_of_the_manual(self):
        for name in pages.PAGES:
            with self.subTest(page=name):
                self.assertEqual(self.complaints(name), [])

    def test_every_picture_of_the_gallery_is_shown(self):
        page = (pages.SOURCES / "docs/gallery.md").read_text()
        self.assertEqual({place.name for place, _ in pages.pictures_of("docs/gallery.md", page)},
                         {file.name for file in (pages.SOURCES / "docs/gallery").iterdir()})


if __name__ == "__main__":
    unittest.main()
