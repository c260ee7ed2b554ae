"""What the program warns of reaches those who run it from Python."""

import pathlib
import subprocess
import unittest
import warnings

from test_package import BINARIES, Case, stickslip

WARNED = {"mu_s": 1.1, "mu_d": 0.5, "delta": 0.5, "quantities": "noise_law"}
TEXT = "mu_s = 1.1 acts as 1 on bodies at rest"


def caught(act):
    """What a call returns, and the texts that it warns of."""
    with warnings.catch_warnings(record=True) as found:
        warnings.simplefilter("always")
        return act(), [str(one.message) for one in found]


class Warnings(Case):
    def test_a_run(self):
        printed = subprocess.run([BINARIES / "stickslip", "-mu_s", "1.1", "-mu_d", "0.5", "-delta", "0.5", "-quantities",
                                  "noise_law", "-seed", "3"], capture_output=True, text=True, check=True).stderr
        with self.assertWarnsRegex(UserWarning, TEXT) as place:
            stickslip.run(**WARNED)
        self.assertEqual(pathlib.Path(place.filename), pathlib.Path(__file__))
        with self.assertWarnsRegex(UserWarning, TEXT):
            eval("run(**options)", {"run": stickslip.run, "options": WARNED})  # where globals have no name
        r, texts = caught(lambda: stickslip.run(**WARNED, seed=3, keep=self.folder / "r.h5"))
        self.assertEqual([f"stickslip: {text}" for text in texts], printed.splitlines())
        self.assertEqual(len(texts), 2)
        r.save(self.folder / "r.json")
        for held in (r, stickslip.load(self.folder / "r.h5"), stickslip.load(self.folder / "r.json")):
            self.assertEqual(held.warnings, texts)
        self.assertNotIn("warnings", stickslip.load(self.folder / "r.h5").provenance)
        quiet, texts = caught(lambda: stickslip.run(**{**WARNED, "mu_s": 1}))
        self.assertEqual((quiet.warnings, texts), ([], []))

    def test_many_cases(self):
        rows, texts = caught(lambda: stickslip.map([{}, {"mu_s": 1}, {"delta": 0.25}, {}], **WARNED))
        self.assertEqual([len(row.warnings) for row in rows], [1, 0, 1, 1])
        self.assertEqual([text.partition(": mu_s")[0] for text in texts], ["case 0 and 1 more", "case 2"])

    def test_a_sweep(self):
        options = {**WARNED, "mu_s": [0.5, 0.7, 1, 1.1], "mu_d": [0.25, 0.5]}
        s, texts = caught(lambda: stickslip.sweep(**options, seed=3))
        self.assertEqual(len(texts), 2)
        self.assertRegex(texts[0], "^-seed = 3 has no effect")
        self.assertRegex(texts[1], "^at .*mu_s = 0.7.* and 3 more points: mu_s = 0.7 acts as 0.5")
        self.assertEqual(s.warnings, texts)
        self.assertEqual(s.concerned.tolist(), [[n, n] for n in (False, True, False, True)])
        self.assertIn(TEXT, s.point_warnings[3, 0][1])
        for turned in (s, s.transposed(["mu_d", "mu_s"])):
            axes = turned.plot(kind="E_X2")["E_X2"].axes[0]
            rings = [line for line in axes.lines if line.get_markerfacecolor() == "none"]
            self.assertEqual(sum(len(ring.get_xdata()) for ring in rings), 4)
            self.assertIn("rings: points with warnings", axes.get_title())
        self.assertNotIn("rings", stickslip.sweep(mu_s=[0.5, 1], delta=0.5, quantities="noise_law").plot()["E_X2"]
                         .axes[0].get_title())

    def test_where_no_level_holds_the_body_none_acts_otherwise(self):
        r, texts = caught(lambda: stickslip.run(mu_s=1, mu_d=0.5, delta=0.75, bias=4, quantities="moments"))
        self.assertEqual(texts, [])
        self.assertGreater(r["E_V"].value, 3)


if __name__ == "__main__":
    unittest.main()
