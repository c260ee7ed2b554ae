"""A body on a spring: values of other methods, what must hold whatever the numbers, and what is refused."""

import json
import math

import h5py
import numpy

from running import Case, run

SPRING = ("-spring_stiffness", "1", "-mu_d", "0.5")
TELEGRAPH = ("-noise", "telegraph", "-telegraph_amplitude", "1.5", "-telegraph_rate", "0.5")
THREE = "x,rate_up,rate_down\n-1.5,1,0\n0,0.5,0.5\n1.5,0,1\n"
MOMENTS = ("-quantities", "sticking,moments", "-accuracy", "1e-2")


class Spring(Case):
    def expect(self, options, right):
        """Values within their errors, to the digits that are known, and errors as asked for."""
        results = self.summary(*options)["results"]
        for key, (value, known) in right.items():
            found = results[key]
            self.assertLessEqual(abs(found["value"] - value), found["error"] + known, (options, key))
            self.assertLess(found["error"], 1e-2 * abs(value), (options, key))
        return results

    def roughly(self, *options):
        """Results of a coarse discretisation, whether or not they are as accurate as asked for."""
        run(*options, "-degree", "4", "-accuracy", "1e-2", "-summary", "rough.json", folder=self.folder)
        return json.loads((self.folder / "rough.json").read_text())["results"]

    # By a program that solves all states of (f, p, v) at once with sparse factors, on meshes of its own.
    def test_coloured_noise(self):
        results = self.expect((*SPRING, *MOMENTS), {
            "P_stick": (0.238315, 1e-6), "mean_stick": (0.476246, 1e-6), "mean_slide": (1.52215, 1e-5),
            "E_V2": (0.1171895, 1e-7), "E_absV": (0.222021, 1e-6), "E_P2": (0.373925, 1e-6), "E_XP": (0.2282, 1e-6)})
        self.assertEqual(results["E_P"]["value"], 0)
        balance = 0.5 * results["E_absV"]["value"] + results["E_V2"]["value"]  # the power of friction and drag
        self.assertAlmostEqual(results["E_XV"]["value"] / balance, 1, delta=1e-6)
        self.assertAlmostEqual(results["E_XV"]["value"] / results["E_XP"]["value"], 1, delta=1e-4)
        self.expect(("-spring_stiffness", "0.1", *SPRING[2:], *MOMENTS),
                    {"P_stick": (0.230268, 1e-6), "E_P2": (5.27643, 1e-5)})

    # Event-driven simulation of 4e8 jumps agrees to 1e-4; at no position do both levels hold the body.
    def test_telegraph_noise(self):
        results = self.expect((*SPRING, *TELEGRAPH, *MOMENTS), {
            "P_stick": (0.249885, 3e-6), "mean_slide": (6.0037, 1e-4), "E_V2": (0.337178, 1e-6),
            "E_P2": (0.752678, 1e-6), "E_XP": (0.551169, 1e-6)})
        self.assertAlmostEqual(results["mean_stick"]["value"], 2, delta=1e-10)

    def test_three_levels(self):
        (self.folder / "three.csv").write_text(THREE)
        self.expect(("-spring_stiffness", "1", "-mu_d", "0.5", "-drag_coefficient", "0.5", "-noise", "file",
                     "-noise_file", "three.csv", *MOMENTS),
                    {"P_stick": (0.350535, 2e-6), "mean_stick": (1.81273, 1e-5), "E_V2": (0.2829587, 1e-7),
                     "E_P2": (0.651836, 1e-6)})

    # Without friction everything is Gaussian; what little of it there is counts to first order.
    def test_next_to_no_friction(self):
        once, twice = (self.summary("-spring_stiffness", "1", "-mu_s", mu, "-mu_d", mu, "-quantities", "moments",
                                    "-accuracy", "1e-2")["results"] for mu in ("1e-3", "2e-3"))
        for key, value in {"E_P2": 2 / 3, "E_V2": 1 / 3, "E_XP": 1 / 3, "E_XV": 1 / 3,
                           "E_absV": math.sqrt(2 / math.pi / 3)}.items():
            found = 2 * once[key]["value"] - twice[key]["value"]
            self.assertLess(abs(found - value), 3 * once[key]["error"] + 1e-5, key)

    def test_the_density_of_the_position(self):
        for noise, options, bias in (("ou", (), 0.7), ("telegraph", TELEGRAPH, 0)):
            results = self.summary(*SPRING, *options, "-bias", bias, "-quantities", "sticking,moments,density", "-accuracy",
                                   "1e-2", "-output", "d.h5")["results"]
            with h5py.File(self.folder / "d.h5") as file:
                v, weights = (file["density"][name][()] for name in ("v", "weights"))
                p, pdf, atom, marginal = (file["density/position"][name][()] for name in ("p", "pdf", "atom", "marginal_p"))
            numpy.testing.assert_allclose(pdf @ weights + atom, marginal, atol=1e-12, err_msg=noise)
            for key, found in {"P_stick": atom.sum(), "E_P": marginal @ p, "E_P2": marginal @ p**2, "E_V2": weights @ (
                    pdf.sum(axis=0) * v**2)}.items():
                self.assertAlmostEqual(found, results[key]["value"], delta=2e-3, msg=(noise, key))

    def test_bias_is_a_shift(self):
        options = (*SPRING, *TELEGRAPH, *MOMENTS, "-degree", "4")
        without = self.summary(*options, status=3)["results"]
        results = self.summary(*options, "-bias", "0.7", status=3)["results"]
        for key in ("P_stick", "mean_slide", "E_V2", "E_XV"):
            self.assertAlmostEqual(results[key]["value"] / without[key]["value"], 1, delta=1e-10)
        self.assertEqual(results["E_V"]["value"], 0)
        self.assertEqual(without["E_P"]["value"], 0)
        self.assertAlmostEqual(results["E_P"]["value"], 0.7, delta=1e-9)
        self.assertAlmostEqual(results["E_P2"]["value"], without["E_P2"]["value"] + 0.7**2, delta=1e-9)

    def test_friction_by_direction_shifts_the_body(self):
        options = (*SPRING, *TELEGRAPH, "-mu_s_minus", "1.2", "-mu_d_minus", "0.6", *MOMENTS)
        results = self.summary(*options)["results"]
        power = results["E_XV"]["value"]
        self.assertGreater(results["E_P"]["value"], 5 * results["E_P"]["error"])
        self.assertAlmostEqual(power / (results["E_V2"]["value"] + 0.55 * results["E_absV"]["value"]), 1, delta=1e-6)

    def test_simulation(self):
        """Beside the solution, and for more levels than that takes."""
        asked = (*SPRING, "-quantities", "sticking,moments,noise_law")
        simulated = ("-route", "monte_carlo", "-excursions", "1500")
        noise = (*TELEGRAPH, "-mu_s_minus", "1.2", "-mu_d_minus", "0.6", "-bias", "0.3")
        right = self.summary(*asked, *noise, "-accuracy", "1e-2")["results"]
        found = self.summary(*asked, *noise, *simulated)["results"]
        for key in ("P_stick", "mean_slide", "E_V2", "E_absV", "E_XV", "E_P", "E_P2", "E_XP", "P_X_le_mu_s", "E_X2"):
            off = abs(found[key]["value"] - right[key]["value"])
            self.assertLess(off, 4 * found[key]["error"] / 1.96 + right[key]["error"] + 1e-12, key)
        many = self.summary(*SPRING, "-delta", "0.25", "-noise_levels", "24", *MOMENTS[:2], *simulated)["results"]
        self.assertLess(abs(many["P_stick"]["value"] - 0.2749), 4 * many["P_stick"]["error"] / 1.96)
        self.assertGreater(abs(many["P_stick"]["value"] - 0.31024), 6 * many["P_stick"]["error"] / 1.96)

    def test_functions_of_the_position(self):
        """Those that moments have by sums of their own; and beside simulation."""
        for bias, friction in ((0, ()), (0.3, ("-mu_s_minus", "1.2", "-mu_d_minus", "0.6"))):
            asked = (*SPRING, *TELEGRAPH, "-bias", bias, *friction, "-quantities", "moments,averages",
                     "-observable", "p;p^2;x*p;stick*p^2")
            right = self.roughly(*asked)
            for f, key in {"p": "E_P", "p^2": "E_P2", "x*p": "E_XP"}.items():
                self.assertAlmostEqual(right[f"pi({f})"]["value"], right[key]["value"], delta=1e-12, msg=f)
            self.assertLess(right["pi(stick*p^2)"]["value"], 0.9 * right["pi(p^2)"]["value"])
        found = self.summary(*asked, "-route", "monte_carlo", "-excursions", "1000")["results"]
        for f in ("p", "p^2", "x*p", "stick*p^2"):
            off = abs(found[f"pi({f})"]["value"] - right[f"pi({f})"]["value"])
            self.assertLess(off, 4 * found[f"pi({f})"]["error"] / 1.96 + 1e-2, f)

    # By a program that moves 4e5 bodies each by closed forms from one jump of the noise to the next.
    def test_starts_from_a_position(self):
        mean = self.roughly(*SPRING, *TELEGRAPH, "-quantities", "expectation", "-observable", "p", "-time", "1", "-start",
                            "-1.5,0.3,0.8")["E(p)"]
        self.assertLess(abs(mean["value"][0] - 0.40914), mean["error"][0] + 4 * 3.1e-4)
        passage = self.roughly(*SPRING, *TELEGRAPH, "-quantities", "first_passage", "-velocity", "0.8", "-start",
                               "1.5,0,0.9")
        mean = passage["first_passage_mean"]
        self.assertLess(abs(mean["value"][0] - 3.4846), mean["error"][0] + 4 * 6.7e-3)
        # Mirror images, one held under any noise.
        asked = (*SPRING, *TELEGRAPH, "-quantities", "first_passage", "-velocity", "0.8", "-start")
        for start, mirrored in (("1.5,0.2,-0.7", "-1.5,-0.2,0.7"), ("rest,0.9", "rest,-0.9")):
            means = [self.roughly(*asked, at)["first_passage_mean"]["value"][0] for at in (start, mirrored)]
            self.assertAlmostEqual(means[0] / means[1], 1, delta=1e-9)

    def test_given_force(self):
        """A constant force on a body without drag: half a swing to twice the distance at which the spring holds it."""
        (self.folder / "record.csv").write_text("time,force\n0,1.9\n10,1.9\n")
        asked = ("-quantities", "given_force", "-force_file", "record.csv", "-spring_stiffness", "4", "-mu_d", "0.5",
                 "-drag", "none")
        summary = self.summary(*asked)
        results = summary["results"]
        self.assertAlmostEqual(results["final_displacement"]["value"], 2 * 1.4 / 4, delta=1e-13)
        self.assertAlmostEqual(results["slip_end"]["value"][0], math.pi / 2, delta=1e-13)
        self.assertAlmostEqual(results["largest_speed"]["value"], 1.4 / 2, delta=1e-13)
        self.assertEqual(summary["scene"]["spring_stiffness"], 4)
        without = self.summary(*asked[:4], *asked[6:])["results"]
        self.assertAlmostEqual(without["final_displacement"]["value"], 1.4 / 2 * 100, delta=1e-10)

    def test_what_is_refused(self):
        self.refuse(*SPRING, "-quantities", "displacement", "-time", "1", "-start", "stationary",
                    message=("asks for displacement, and a spring keeps the body in one place",))
        self.refuse(*SPRING, "-quantities", "expectation", "-observable", "v^2", "-time", "1", "-start", "rest",
                    message=("-start = rest: does not say at which position", "write for example -start 0,0,1"))
        self.refuse(*SPRING, *TELEGRAPH, "-quantities", "first_passage", "-velocity", "0.5", "-start", "-1.4,0,1",
                    message=("-start = -1.4,0,1: must start on a noise level", "take x = -1.5"))
        self.refuse(*SPRING, *TELEGRAPH, "-quantities", "passage_distribution", "-velocity", "0.5", "-time", "1", "-start",
                    "1.5,0,0", message=("has paths that reach the speed all at once",))
        self.refuse(*SPRING, *TELEGRAPH, "-quantities", "first_passage", "-velocity", "0.5", "-start", "1.5,0,9",
                    message=("is further out than bodies are followed", "take p in [-2.08, 2.08]"))
        self.refuse(*SPRING, "-route", "lambda", message=("-route = lambda: needs a noise of levels alone",))
        self.refuse(*SPRING, "-route", "monte_carlo", "-quantities", "spectrum", "-omega", "1",
                    message=("asks for spectrum, which are not simulated with -spring_stiffness",))
        self.refuse(*SPRING, "-delta", "0.25",
                    message=("-spring_stiffness = 1: takes more than 3000 pairs", "or -route monte_carlo"))
        self.refuse(*SPRING, "-noise", "narrow_band", "-band_frequency", "1", "-band_width", "1",
                    message=("-spring_stiffness = 1: goes with noise of levels, or with one",))
        self.refuse("-spring_stiffness", "0", message=("-spring_stiffness = 0", "(0, inf)"))
        self.refuse(*SPRING, "-noise", "telegraph", "-telegraph_amplitude", "0.9", "-telegraph_rate", "1",
                    message=("all levels of the noise", "P_stick = 1"))
