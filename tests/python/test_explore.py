"""The explorer, without a window: its knobs, the newest request, its pictures and files."""

import itertools
import os
import pathlib
import sys
import tempfile
import threading
import time
import types
import unittest
import unittest.mock

import matplotlib
import numpy

SOURCES = pathlib.Path(__file__).resolve().parents[2]
BINARIES = pathlib.Path(os.environ.get("STICKSLIP_BINARIES", SOURCES / "build"))
os.environ["STICKSLIP"] = str(BINARIES / "stickslip")
sys.path.insert(0, str(SOURCES / "python"))
matplotlib.use("Agg")
import matplotlib.pyplot as plt
import stickslip
from stickslip import __main__, cases, explore, knobs, live_pictures, newest
from stickslip.program import BadInput, Cancelled

COARSE = {"accuracy": 1e-2}
ANSWERS = {}


def remembered(cancel, **options):
    """What the program answers; at once, what it was asked before."""
    case = repr(sorted(options.items()))
    if case not in ANSWERS:
        ANSWERS[case] = stickslip.run(cancel=cancel, **options)
    return ANSWERS[case]


class Case(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory(prefix="Reibung µ δ ")
        self.addCleanup(holder.cleanup)
        self.folder = pathlib.Path(holder.name)

    def explorer(self, options=COARSE, scene=None, compute=remembered):
        figure = plt.figure(figsize=explore.FIGURE)
        figure.canvas.draw_idle = lambda: None  # which draws at once where there is no window
        self.addCleanup(plt.close, figure)
        made = explore.Explorer(figure, options, {"delta": 0.5, "mu_d": 0.5, **(scene or {})}, self.folder, compute)
        self.addCleanup(made.solver.close)
        return made

    def until(self, made, holds):
        """Polls until something holds; fails once all results are there and it does not."""
        while not holds():
            working = made.solver.working  # asked first: what it had found until then is polled next
            self.assertTrue(made.poll() or working or holds(), "did not come")
            time.sleep(0.005)

    def settled(self, made):
        self.until(made, lambda: made.status.get_text().endswith(" s"))


class Pictures(Case):
    def test_all_pictures_follow_a_slider(self):
        made = self.explorer()
        self.settled(made)
        shown = made.pictures

        def drawn():
            return [shown.curve_v.get_xdata(),
                    *(shown.curves[key].get_ydata() for key in ("S_v", "f_stick", "f_slide"))]

        before, words = drawn(), shown.words.get_text()
        made.sliders["mu_d"].set_val(0.9)
        self.settled(made)
        for old, new in zip(before, drawn()):
            self.assertFalse(numpy.array_equal(old, new))
        found = stickslip.run(**COARSE, delta=0.5, mu_d=0.9, quantities="sticking")
        self.assertNotEqual(shown.words.get_text(), words)
        self.assertIn(f"{found['P_stick'].value:.6g}", shown.words.get_text())

    def test_parts_are_drawn_as_the_whole_is(self):
        """Every point of the picture, after results, after what is refused, and after it is no longer."""
        made = self.explorer(scene={"mu_s": 1})
        canvas, shown = made.figure.canvas, []
        canvas.blit = shown.append
        self.settled(made)
        canvas.draw()
        self.assertEqual(shown, [])  # there was no whole picture yet
        for option, value in (("mu_d", 0.9), ("bias", 1.5), ("bias", 0.3)):
            made.sliders[option].set_val(value)
            self.until(made, lambda: made.status.get_text().endswith(" s") or made.problem)
            parts = numpy.array(canvas.buffer_rgba())
            canvas.draw()
            self.assertLess((abs(parts.astype(int) - numpy.array(canvas.buffer_rgba())).max(axis=-1) > 8).sum(), 1, option)
        self.assertGreater(len(shown), 9)
        made.save_picture("png")
        before = len(shown)
        made.show("after another resolution the whole is drawn")
        self.assertEqual(len(shown), before)

    def test_a_page_is_sent_one_picture_for_all_regions_of_a_move(self):
        made = self.explorer()
        self.settled(made)
        shown, canvas = [], made.figure.canvas
        canvas.draw()
        canvas.blit = shown.append
        made._show_knobs()
        made.show("two regions")
        self.assertEqual(len(shown), 2)
        canvas.get_diff_image = lambda: None  # as the canvas of a page has
        shown.clear()
        with made.regions.together():
            made._show_knobs()
            with made.regions.together():
                made.show("two regions")
            self.assertEqual(shown, [])
        self.assertEqual(len(shown), 1)
        with made.regions.together():
            pass
        self.assertEqual(len(shown), 1)

    def test_force_is_across_and_velocity_upwards_as_in_every_picture(self):
        made = self.explorer(scene={"bias": 0.6})  # a body that a constant force pulls moves upwards only
        self.settled(made)
        axes, image = made.pictures.density, made.pictures.image
        self.assertIn("force", made.pictures.by_x.get_xlabel())
        self.assertIn("velocity", axes.get_ylabel())
        low, high, slowest, fastest = image.get_extent()
        self.assertLess(abs(low + high), 1e-9)  # levels of the force are even
        self.assertGreater(fastest, -2 * slowest)
        at = numpy.unravel_index(image.get_array().argmax(), image.get_array().shape)
        found = stickslip.run(**COARSE, delta=0.5, mu_d=0.5, bias=0.6, quantities="density").density
        x, v = numpy.linspace(low, high, image.get_array().shape[1]), found.window(1e-3)
        field = found.at(v)
        level, speed = numpy.unravel_index(field.argmax(), field.shape)
        self.assertLess(abs(x[at[1]] - found.x[level]), 0.5)
        self.assertLess(abs(v[at[0]] - v[speed]), 0.02 * numpy.ptp(v))
        self.assertEqual(type(image.norm).__name__, "LogNorm")

    def test_what_is_refused_is_said_beside_its_slider_and_greys_the_pictures(self):
        made = self.explorer()
        self.settled(made)
        made.choose("noise", "periodic")
        self.settled(made)
        self.assertFalse(any(veil.get_visible() for veil in made.pictures.veils))
        made.sliders["periodic_amplitude"].set_val(0.4)
        self.until(made, lambda: made.complaint.get_visible())
        self.assertTrue(all(veil.get_visible() for veil in made.pictures.veils))
        self.assertIn("never slides", made.complaint.get_text().replace("\n", " "))
        self.assertIn("-mu_s = 1", made.status.get_text())
        slider, at = made.sliders["mu_s"].ax.get_position(), made.complaint.get_position()
        self.assertLess(abs(at[1] - slider.y0), 0.05)
        made.sliders["periodic_amplitude"].set_val(1.5)
        self.settled(made)
        self.assertFalse(made.complaint.get_visible())
        self.assertFalse(any(veil.get_visible() for veil in made.pictures.veils))

    def test_of_several_problems_the_one_with_a_slider_is_said_beside_it(self):
        def refused(cancel, **options):
            raise BadInput("-omega = 1: is not\n-bias = 0: cannot be\n-tau = 1: neither")

        made = self.explorer(compute=refused)
        self.until(made, lambda: made.complaint.get_visible())
        self.assertEqual(made.complaint.get_text(), "-bias = 0: cannot be")
        self.assertEqual(made.sliders["bias"].label.get_color(), explore.REFUSED)
        self.assertIn("-omega", made.status.get_text())

    def test_refused_parts_alone_are_greyed(self):
        def no_spectrum(cancel, **options):
            if options["quantities"] == "spectrum":
                raise BadInput("-omega = 1: cannot be had")
            return remembered(cancel, **options)

        made = self.explorer(compute=no_spectrum)
        self.until(made, lambda: made.pictures.quantiles.get_text())
        self.assertEqual([veil.get_visible() for veil in made.pictures.veils], [False, True, False])
        self.assertIn("cannot be had", made.status.get_text())

    def test_what_shows_other_parameters_is_greyed_after_a_while(self):
        wanted = threading.Event()

        def slow_spectrum(cancel, **options):
            if options["quantities"] == "spectrum" and options["mu_d"] == 0.9:
                while not wanted.wait(0.01) and not cancel.is_set():
                    pass
            return remembered(cancel, **options)

        def greyed():
            return [veil.get_visible() for veil in made.pictures.veils]

        made = self.explorer(compute=slow_spectrum)
        self.settled(made)
        self.assertEqual(greyed(), [False, False, False])
        made.sliders["mu_d"].set_val(0.9)
        made.asked_at = float("inf")  # no time passes
        self.until(made, lambda: "spectrum" in made.status.get_text())
        self.assertEqual(greyed(), [False, False, False])
        made.asked_at = 0
        made.poll()
        self.assertEqual(greyed(), [False, True, True])
        wanted.set()
        self.settled(made)
        self.assertEqual(greyed(), [False, False, False])

    def test_a_window_fits_the_screen_and_a_page_one_of_800_pixels(self):
        self.assertLessEqual(explore.FIGURE[1] * explore.PAGE, 800 - explore.BARS)
        figure = plt.figure(figsize=explore.FIGURE, dpi=explore.PAGE)
        self.addCleanup(plt.close, figure)
        explore.fit_screen(figure)  # without a window
        self.assertEqual(figure.dpi, explore.PAGE)
        for height, dots in ((768, 80), (900, 95), (1080, 100), (2160, 100)):
            sizes = []
            window = types.SimpleNamespace(winfo_screenheight=lambda height=height: height)
            figure.canvas.manager = types.SimpleNamespace(window=window, resize=lambda *size, kept=sizes: kept.append(size))
            explore.fit_screen(figure)
            self.assertEqual(figure.dpi, dots)
            self.assertEqual(sizes[-1], (explore.FIGURE[0] * dots, explore.FIGURE[1] * dots))
        figure.canvas.manager = None

    def test_quantiles_invert_the_distribution_function(self):
        t = numpy.geomspace(0.02, 20, 60)
        result = stickslip.results.Result("cdf_stick", 1 - numpy.exp(-t), 0 * t, "", ("time",), "time", t)
        for share in (0.5, 0.9, 0.99):
            self.assertAlmostEqual(float(live_pictures.quantile(result, share)), -numpy.log(1 - share),
                                   delta=0.06 * -numpy.log(1 - share))
        self.assertEqual(live_pictures.quantile(result, 0.001), "< 0.02")
        self.assertEqual(live_pictures.quantile(result, 1 - 1e-12), "> 20")


def refusing(cancel, **options):
    """What computes nothing: for tests of what the knobs stand for."""
    raise BadInput("not computed")


class Newest(Case):
    def test_the_newest_scene_wins_and_the_others_are_ended(self):
        asked, cancelled, running = [], [], threading.Event()

        def slow(cancel, **options):
            asked.append(options["mu_d"])
            running.set()
            if len(asked) == 1:  # the first one never ends by itself
                self.assertTrue(cancel.wait())
                cancelled.append(options["mu_d"])
                raise Cancelled
            raise BadInput(f"answer to {options['mu_d']}")

        made = self.explorer(compute=slow)
        self.assertTrue(running.wait())
        for value in (0.6, 0.7, 0.8):
            made.sliders["mu_d"].set_val(value)
        self.until(made, lambda: made.status.get_text() == "answer to 0.8")
        self.assertEqual(cancelled, [0.5])
        self.assertLessEqual(len(asked), 4)
        self.assertEqual(asked[-1], 0.8)

    def test_results_of_other_parameters_than_the_newest_are_not_shown(self):
        go = threading.Event()
        go.set()

        def answer(cancel, **options):
            go.wait()
            raise BadInput(f"answer to {options['mu_d']}")

        made = self.explorer(compute=answer)
        self.addCleanup(go.set)
        while made.solver.working:
            time.sleep(0.005)
        go.clear()
        made.sliders["mu_d"].set_val(0.6)
        self.assertFalse(made.poll())  # though the answer to 0.5 is there
        go.set()
        self.until(made, lambda: made.status.get_text() == "answer to 0.6")

    def test_curves_are_as_accurate_as_a_screen_shows(self):
        asked, last = {}, threading.Event()

        def noted(cancel, **options):
            asked[options["quantities"]] = options["accuracy"]
            if options["quantities"] == explore.PARTS[-1][1]["quantities"]:
                last.set()
            return cheap[options["quantities"]]

        cheap = {part["quantities"]: stickslip.run(**COARSE, delta=0.5, mu_d=0.5, **part) for _, part in explore.PARTS}
        for accuracy, curves in ((1e-4, 1e-3), (1e-2, 1e-2)):
            made = self.explorer({"accuracy": accuracy}, compute=noted)
            self.assertTrue(last.wait())
            made.solver.close()  # all results are there
            self.assertEqual(list(asked.values()), [accuracy, curves, curves])
            self.assertEqual([made.poll() for _ in range(4)], [True, True, True, False])  # each picture once it is drawn
            last.clear()

    def test_a_run_that_is_cancelled_ends_the_program(self):
        worker = cases.Worker()
        self.addCleanup(worker.end)
        for run in (stickslip.run, worker.run):
            cancel = threading.Event()
            timer = threading.Timer(0.3, cancel.set)
            timer.start()
            self.addCleanup(timer.cancel)
            with self.assertRaises(Cancelled):
                run(cancel=cancel, route="monte_carlo", excursions=10**12, quantities="sticking")

    def test_one_process_answers_until_a_run_is_cancelled(self):
        worker, cancel = cases.Worker(), threading.Event()
        self.addCleanup(worker.end)
        asked = {**COARSE, "delta": 0.5, "quantities": "sticking,density"}
        first = worker.run(cancel=threading.Event(), **asked)
        process = worker._process
        with self.assertRaises(BadInput):
            worker.run(cancel=threading.Event(), mu_d=-1)
        again = worker.run(cancel=threading.Event(), **asked)
        self.assertIs(worker._process, process)
        self.assertEqual(again["P_stick"].value, stickslip.run(**asked)["P_stick"].value)
        numpy.testing.assert_array_equal(again.density.values, first.density.values)
        cancel.set()
        with self.assertRaises(Cancelled):
            worker.run(cancel=cancel, route="monte_carlo", excursions=10**12, quantities="sticking")
        self.assertEqual(worker.run(**asked)["P_stick"].value, first["P_stick"].value)


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

    def test_no_choice_is_refused_at_first(self):
        made = self.explorer(scene={"delta": 0.125}, compute=refusing)
        self.assertLessEqual({"ou", "telegraph", "narrow_band", "filtered", "periodic", "pulses"},
                             set(made.offered["noise"]))
        self.assertEqual(made.offered["drag"], ["linear", "none", "cubic"])  # a formula is no slider
        worker = cases.Worker()
        self.addCleanup(worker.end)
        frictions, noises, drags = (made.offered[name] for name in ("friction", "noise", "drag"))
        turns = zip(itertools.cycle(frictions), noises, itertools.cycle(drags))
        for mu_s, friction, noise, drag in (*((1, *turn) for turn in turns), *((2, "coulomb", noise, "none") for noise in noises)):
            with self.subTest(mu_s=mu_s, friction=friction, noise=noise, drag=drag):
                made.restart()
                made.sliders["mu_s"].set_val(mu_s)
                for choice, word in (("friction", friction), ("noise", noise), ("drag", drag)):
                    made.choose(choice, word)
                asked = {**made.scene(), "quantities": "sticking,moments", "plan": True}
                self.assertGreater(worker.run(**asked).plan["seconds"], 0)

    def test_start_again_takes_back_all_choices_and_moves(self):
        made = self.explorer(compute=refusing)
        begun = made.scene()
        made.choose("noise", "telegraph")
        self.assertEqual(made.scene()["bias"], 0.3)
        made.radios["friction"].set_active(1)
        made.sliders["mu_s_minus"].set_val(0.7)
        made.restart()
        self.assertEqual(made.scene(), begun)
        self.assertEqual(made.sliders["mu_s_minus"].valtext.get_text(), "not given")

    def test_what_a_word_moved_goes_back_with_it(self):
        made = self.explorer(compute=refusing)
        made.choose("noise", "telegraph")
        self.assertIn("bias = 0.3, with which telegraph", made.note)
        made.choose("noise", "ou")
        self.assertEqual(made.scene()["bias"], 0)
        self.assertIn("bias = 0 again, as before telegraph", made.note)
        made.choose("noise", "telegraph")
        made.sliders["bias"].set_val(0.7)  # by the user
        made.choose("noise", "ou")
        self.assertEqual((made.scene()["bias"], made.note), (0.7, ""))

    def test_slow_parts_say_how_long_they_take(self):
        shown = []

        def slow(cancel, **options):
            if options.get("plan"):
                return stickslip.Results({}, plan={"seconds": 34.4})
            shown.append(made.status.get_text())
            return remembered(cancel, **options)

        with unittest.mock.patch.object(newest, "SLOW", 0):
            made = None
            made = self.explorer(compute=lambda **options: slow(**options) if made else refusing(**options))
            said = []
            made.show = lambda text, color="black", show=made.show: (said.append(text), show(text, color))
            made.sliders["mu_d"].set_val(0.6)
            self.settled(made)
        self.assertIn("computing the spectrum, about 34 s; a slider that is moved ends it", said)
        self.assertFalse(any("distribution, about" in text for text in said))

    def test_what_is_not_given_is_left_out_until_it_is_moved(self):
        made = self.explorer(compute=refusing)
        self.assertFalse({"noise_deviation", "mu_s_minus", "mu_d_minus"} & made.scene().keys())
        made.sliders["noise_deviation"].set_val(numpy.log10(0.5))
        self.assertEqual(made.scene()["noise_deviation"], 0.5)
        made.choose("noise", "telegraph")
        self.assertNotIn("noise_deviation", made.scene())

    def test_dynamic_friction_stays_below_static_friction(self):
        made = self.explorer(compute=refusing)
        made.sliders["mu_s"].set_val(0.3)
        self.assertEqual((made.value("mu_s"), made.value("mu_d")), (0.3, 0.3))
        made.sliders["mu_d"].set_val(0.8)
        self.assertEqual((made.value("mu_s"), made.value("mu_d")), (0.8, 0.8))
        for moved, values, along in (
                ("mu_s", {"mu_s": 0.4, "mu_d": 0.5, "mu_d_minus": 0.6}, {"mu_d": 0.4, "mu_d_minus": 0.4}),
                ("mu_d", {"mu_s": 1, "mu_d": 0.5, "mu_s_minus": 0.4}, {"mu_s_minus": 0.5}),
                ("mu_s_minus", {"mu_s": 1, "mu_d": 0.5, "mu_s_minus": 0.4}, {"mu_d_minus": 0.4}),
                ("mu_d_minus", {"mu_s": 1, "mu_d": 0.5, "mu_d_minus": 1.5}, {"mu_s_minus": 1.5}),
                ("mu_d", {"mu_s": 1, "mu_d": 1, "mu_s_minus": 2, "mu_d_minus": 2}, {})):
            self.assertEqual(knobs.carried(moved, values), along, (moved, values))

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

    def test_options_of_the_command_line_count_more_than_those_of_the_file(self):
        words = ["explore", "-mu_d", "0.3", "scene.opts", "-bias", "-0.2", "-plan", "--browser", "-drag", "none"]
        given = __main__.taken_options(words)
        self.assertEqual(given, {"mu_d": "0.3", "bias": "-0.2", "plan": True, "drag": "none"})
        self.assertEqual(words, ["explore", "scene.opts", "--browser"])
        made = self.explorer({**COARSE, "v_max": "6", "mu_d": "0.3"}, {"mu_d": 0.3})
        self.settled(made)
        made.sliders["mu_d"].set_val(0.6)
        self.settled(made)
        made.save_scene()
        again = stickslip.run(**COARSE, options_file=self.folder / "explored.opts", quantities="sticking")
        self.assertEqual((again.options["mu_d"], again.options["v_max"]), ("0.6", "6"))

    def test_a_port_that_cannot_be_is_refused(self):
        for port in (0, 80000):
            with self.assertRaisesRegex(BadInput, "65535"):
                explore.use_backend(True, port)


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
