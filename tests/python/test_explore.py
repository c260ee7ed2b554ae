"""The explorer, without a window: its knobs, the newest request, its pictures and files."""

import os
import pathlib
import sys
import tempfile
import threading
import time
import unittest

import matplotlib
import numpy

SOURCES = pathlib.Path(__file__).resolve().parents[2]
BINARIES = pathlib.Path(os.environ.get("STICKSLIP_BINARIES", SOURCES / "build"))
os.environ["STICKSLIP"] = str(BINARIES / "stickslip")
sys.path.insert(0, str(SOURCES / "python"))
matplotlib.use("Agg")
import matplotlib.pyplot as plt
import stickslip
from stickslip import explore
from stickslip.program import BadInput, Cancelled

SECONDS = 60  # until what never comes is given up
COARSE = {"accuracy": 1e-2}


class Case(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory(prefix="Reibung µ δ ")
        self.addCleanup(holder.cleanup)
        self.folder = pathlib.Path(holder.name)

    def explorer(self, options=COARSE, scene=None, compute=stickslip.run):
        figure = plt.figure(figsize=(13, 8))
        self.addCleanup(plt.close, figure)
        made = explore.Explorer(figure, options, {"delta": 0.5, "mu_d": 0.5, **(scene or {})}, self.folder, compute)
        self.addCleanup(made.solver.close)
        return made

    def until(self, holds, poll=lambda: None):
        end = time.monotonic() + SECONDS
        while not holds():
            self.assertLess(time.monotonic(), end, "did not come")
            poll()
            time.sleep(0.005)

    def settled(self, made):
        self.until(lambda: made.status.get_text().endswith(" s"), made.poll)


class Pictures(Case):
    def test_all_pictures_follow_a_slider(self):
        made = self.explorer()
        self.settled(made)
        before = [made.curve_v.get_ydata(), made.curves["S_v"].get_ydata(), made.curves["f_slide"].get_ydata()]
        words = made.words.get_text()
        made.sliders["mu_d"].set_val(0.9)
        self.settled(made)
        after = [made.curve_v.get_ydata(), made.curves["S_v"].get_ydata(), made.curves["f_slide"].get_ydata()]
        for old, new in zip(before, after):
            self.assertFalse(numpy.array_equal(old, new))
        found = stickslip.run(**COARSE, delta=0.5, mu_d=0.9, quantities="sticking")
        self.assertNotEqual(made.words.get_text(), words)
        self.assertIn(f"{found['P_stick'].value:.6g}", made.words.get_text())
        self.assertGreater(made.image.get_array().max(), 0)

    def test_what_the_program_says_is_shown(self):
        made = self.explorer()
        self.settled(made)
        made.sliders["mu_d"].set_val(2.5)
        self.until(lambda: "mu_d" in made.status.get_text() and "computing" not in made.status.get_text(), made.poll)


class Newest(Case):
    def test_the_newest_scene_wins_and_the_others_are_ended(self):
        asked, cancelled, running = [], [], threading.Event()

        def slow(cancel, **options):
            asked.append(options["mu_d"])
            running.set()
            if len(asked) == 1:  # the first one never ends by itself
                self.assertTrue(cancel.wait(SECONDS))
                cancelled.append(options["mu_d"])
                raise Cancelled
            raise BadInput(f"answer to {options['mu_d']}")

        made = self.explorer(compute=slow)
        self.assertTrue(running.wait(SECONDS))
        for value in (0.6, 0.7, 0.8):
            made.sliders["mu_d"].set_val(value)
        self.until(lambda: made.status.get_text() == "answer to 0.8", made.poll)
        self.assertEqual(cancelled, [0.5])
        self.assertLessEqual(len(asked), 4)
        self.assertEqual(asked[-1], 0.8)

    def test_a_run_that_is_cancelled_ends_the_program(self):
        cancel = threading.Event()
        timer = threading.Timer(0.3, cancel.set)
        timer.start()
        self.addCleanup(timer.cancel)
        start = time.monotonic()
        with self.assertRaises(Cancelled):
            stickslip.run(cancel=cancel, route="monte_carlo", excursions=10**12, quantities="sticking")
        self.assertLess(time.monotonic() - start, SECONDS / 2)


class Knobs(Case):
    def test_choices_show_the_sliders_that_belong_to_them(self):
        def shown():
            return {option for option, slider in made.sliders.items() if slider.ax.get_visible()}

        made = self.explorer()
        self.assertNotIn("telegraph_rate", shown())
        made.choose("noise", "telegraph")
        self.assertLessEqual({"telegraph_rate", "telegraph_amplitude"}, shown())
        self.assertFalse({"tau", "delta", "delta_per_mu_s"} & made.scene().keys())
        self.assertEqual(made.scene()["noise"], "telegraph")
        made.choose("drag", "none")
        self.assertNotIn("drag_coefficient", made.scene())

    def test_sliders_complete_every_noise_that_is_offered(self):
        made = self.explorer()
        noises = made.offered["noise"]
        self.assertLessEqual({"ou", "telegraph", "narrow_band", "filtered", "periodic", "pulses"}, set(noises))
        for noise in set(noises) - {"telegraph"}:  # with which bodies rest and slide only where there is a bias
            made.choose("noise", noise)
            self.assertGreater(stickslip.run(**made.scene(), plan=True).plan["seconds"], 0)

    def test_logarithmic_sliders_give_rounded_values(self):
        made = self.explorer(scene={"tau": 2.0})
        self.assertEqual(made.scene()["tau"], 2.0)
        made.sliders["tau"].set_val(numpy.log10(0.123456))
        self.assertEqual(made.scene()["tau"], 0.123)

    def test_mu_s_stays_on_a_noise_level(self):
        made = self.explorer()
        self.assertEqual(made.scene()["delta"], 0.5)
        made.sliders["mu_s"].set_val(1.07)
        self.assertEqual(made.scene()["delta"], 1.07 / 2)
        made.sliders["delta_per_mu_s"].set_val(3)
        self.assertEqual(made.scene()["delta"], 1.07 / 3)
        self.settled(made)
        by_file = self.folder / "steps.opts"
        by_file.write_text("-mu_d 0.4\n-delta_per_mu_s 2\n")
        made = self.explorer({**COARSE, "options_file": by_file}, {"mu_d": 0.4, "delta_per_mu_s": "2"})
        made.sliders["mu_s"].set_val(0.93)
        self.assertEqual(made.scene(), {"mu_s": 0.93, "delta_per_mu_s": 2})
        self.settled(made)

    def test_of_a_scene_in_a_file_only_what_was_moved_changes(self):
        file = self.folder / "scene.opts"
        file.write_text("-mu_d 0.4\n-delta 0.5\n-mu_s_minus 1.5\n")
        made = self.explorer({**COARSE, "options_file": file}, {"mu_d": 0.4})
        self.settled(made)
        self.assertEqual(made.scene(), {})
        made.sliders["mu_d"].set_val(0.6)
        self.assertEqual(made.scene(), {"mu_d": 0.6})
        self.settled(made)
        made.save_scene()
        again = stickslip.run(**COARSE, options_file=self.folder / "explored.opts", quantities="sticking")
        self.assertEqual((again.scene["mu_d"], again.scene["mu_s_minus"]), (0.6, 1.5))


class Files(Case):
    def test_scenes_and_pictures_are_saved_and_nothing_is_overwritten(self):
        made = self.explorer()
        self.settled(made)
        for name, save in (("explored.opts", made.save_scene), ("explored.png", lambda: made.save_picture("png")),
                           ("explored.pdf", lambda: made.save_picture("pdf"))):
            self.assertIn(name, save())
            first = (self.folder / name).read_bytes()
            save()
            self.assertEqual((self.folder / name).read_bytes(), first)
            self.assertTrue((self.folder / name.replace(".", "-2.")).exists())
        self.assertEqual((self.folder / "explored.png").read_bytes()[:4], b"\x89PNG")
        self.assertEqual((self.folder / "explored.pdf").read_bytes()[:4], b"%PDF")
        saved = stickslip.run(**COARSE, options_file=self.folder / "explored.opts", quantities="sticking")
        self.assertEqual(saved.scene["mu_d"], 0.5)
        self.assertTrue(made.sliders["mu_d"].ax.get_visible())


if __name__ == "__main__":
    unittest.main()
