"""Parameters of the model from measurements: stickslip.fit."""

import math
import pickle
import unittest
import warnings
from unittest import mock

import numpy
import scipy.stats
from test_package import PNG, Case  # which says where the program and the package are

import stickslip
from stickslip.cases import Pool
from stickslip.fitting import _axes
from stickslip.likelihood import Axis, Search
from stickslip.measurements import data_sets
from stickslip.reference import declared

COARSE = {"delta": 0.25}
TRUE = {"mu_d": 0.3, "tau": 1.5}
TIMES, DISTANCES = "1e-5:100:300:log", "2e-3:50:200:log"


def drawn(phase, count, seed=1, **options):
    """Durations with the distribution function that the program computes, by its inversion."""
    key = f"cdf_{phase}"
    found = stickslip.run(quantities="slip" if phase == "slip" else "duration_density", accuracy=1e-4,
                          **({"distance": DISTANCES} if phase == "slip" else {"time": TIMES}), **{**COARSE, **TRUE, **options})[key]
    return numpy.interp(numpy.random.default_rng(seed).random(count), found.value, found.abscissa)


class Fits(Case):
    def setUp(self):
        super().setUp()
        warnings.simplefilter("error", UserWarning)

    def within(self, fit, true=TRUE, most=4):
        """That estimates are within `most` standard errors of what was put in."""
        self.assertTrue(fit.converged, fit.message)
        for name, value in true.items():
            self.assertLess(abs(fit.estimates[name] - value), most * fit.errors[name], name)


class LeastSquares(Fits):
    def test_values_of_the_model_are_fitted_exactly(self):
        true = stickslip.run(**COARSE, **TRUE, quantities="sticking,spectrum", omega=[0.2, 1, 5])
        S = true["S_v"].value
        fit = stickslip.fit({"P_stick": (true["P_stick"].value, 0.005), "mean_stick": (true["mean_stick"].value, 0.02),
                             "S_v": ([0.2, 1, 5], S, 0.1 * S)}, ["mu_d", "tau"], {"mu_d": 0.5, "tau": 1}, **COARSE)
        for name, value in TRUE.items():
            self.assertLess(abs(fit.estimates[name] - value), 0.02 * fit.errors[name])
        self.assertLess(fit.chi2, 1e-3)
        self.assertEqual((fit.degrees_of_freedom, fit.observations, fit.message), (3, (5, 0), "converged"))
        self.assertRegex(repr(fit), r"mu_d = 0\.3\d* \+- 0\.\d+\ntau = 1\.(5|49).*\nchi\^2 = .* of 5 values, 3 degrees of freedom")
        self.assertEqual(pickle.loads(pickle.dumps(fit)).estimates, fit.estimates)

    def test_errors_are_those_of_derivatives_by_adjoints(self):
        r = stickslip.run(**COARSE, **TRUE, quantities="sticking,sensitivity")
        error = 0.01
        fit = stickslip.fit({"P_stick": (r["P_stick"].value, error)}, "tau", {"tau": 1.2}, mu_d=0.3, **COARSE)
        self.assertAlmostEqual(fit.errors["tau"], error / abs(r["dP_stick_dtau"].value), delta=1e-3 * fit.errors["tau"])
        both = stickslip.fit([{"P_stick": (r["P_stick"].value, error)}] * 4, "tau", {"tau": 1.2}, mu_d=0.3, **COARSE)
        self.assertAlmostEqual(both.errors["tau"], fit.errors["tau"] / 2, delta=1e-3 * fit.errors["tau"])

    def test_sets_share_free_parameters_and_have_options_of_their_own(self):
        sets = []
        for bias in (0, 0.25):
            r = stickslip.run(**COARSE, **TRUE, bias=bias, quantities="moments,sticking")
            sets.append({"E_V2": (r["E_V2"].value, 0.01), "P_stick": (r["P_stick"].value, 0.01), "options": {"bias": bias}})
        fit = stickslip.fit(sets, ["mu_d", "tau"], {"mu_d": 0.5, "tau": 1}, **COARSE)
        self.within(fit, most=0.05)
        self.assertEqual([r.scene["bias"] for r in fit.results], [0, 0.25])

    def test_mu_s_is_fitted_on_a_level(self):
        r = stickslip.run(mu_s=1.1, mu_d=0.5, delta_per_mu_s=4, quantities="sticking")
        data = {key: (r[key].value, 0.01) for key in ("P_stick", "mean_stick")}
        fit = stickslip.fit(data, ["mu_s", "mu_d"], {"mu_s": 1, "mu_d": 0.6}, delta_per_mu_s=4)
        self.within(fit, {"mu_s": 1.1, "mu_d": 0.5}, most=0.05)
        self.assertEqual(stickslip.fit(data, "mu_s", mu_d=0.5).results[0].options["delta_per_mu_s"], "8")

    def test_steps_that_go_too_far_are_taken_back(self):
        data = {"P_stick": (0.409, 0.0048), "mean_stick": (2.318, 0.0366), "E_V2": (0.1802, 0.0041)}
        fit = stickslip.fit(data, ["mu_s", "mu_d", "tau"], {"mu_s": 0.8, "mu_d": 0.24, "tau": 1.2}, delta_per_mu_s=4)
        self.assertTrue(fit.converged)
        self.assertLess(fit.chi2, 1e-3)  # as many parameters as values
        for key, (value, error) in data.items():
            self.assertAlmostEqual(fit.results[0][key].value, value, delta=0.05 * error)

    def test_a_discretisation_that_moves_the_estimates_is_refined(self):
        r = stickslip.run(**COARSE, **TRUE, quantities="sticking", accuracy=1e-9)
        data = {key: (r[key].value, 1e-6) for key in ("P_stick", "mean_stick")}
        fit = stickslip.fit(data, ["mu_d", "tau"], {"mu_d": 0.5, "tau": 1}, accuracy=0.1, **COARSE)
        self.within(fit, most=0.5)
        self.assertLess(fit.shift, 0.1)
        with mock.patch("stickslip.likelihood.ROUNDS", 1), self.assertWarnsRegex(UserWarning, "finer discretisation"):
            coarse = stickslip.fit(data, ["mu_d", "tau"], {"mu_d": 0.5, "tau": 1}, accuracy=0.1, **COARSE)
        far = [coarse.estimates[name] - value for name, value in TRUE.items()]
        self.assertAlmostEqual(math.sqrt(far @ numpy.linalg.solve(coarse.covariance, far)) / coarse.shift, 1, delta=0.1)

    def test_a_best_fit_at_a_bound_is_reported(self):
        r = stickslip.run(**COARSE, **TRUE, quantities="sticking")
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            fit = stickslip.fit({"P_stick": (r["P_stick"].value, 0.001)}, "mu_d", {"mu_d": 0.5}, {"mu_d": (0.4, 0.9)}, tau=1.5,
                                **COARSE)
        self.assertIn("mu_d went to its bound", str(caught[0].message))
        self.assertAlmostEqual(fit.estimates["mu_d"], 0.4, delta=1e-3)
        self.assertTrue(math.isnan(fit.errors["mu_d"]))
        with self.assertRaisesRegex(ValueError, "no standard error"):
            fit.profile("mu_d")

    def test_a_combination_that_the_data_do_not_determine_is_reported(self):
        r = stickslip.run(**COARSE, quantities="moments", mu_d=0.5)
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            fit = stickslip.fit({"E_V2": (r["E_V2"].value, 0.01), "E_absV": (r["E_absV"].value, 0.01)},
                                ["mu_d", "mu_d_minus"], {"mu_d": 0.45, "mu_d_minus": 0.45}, **COARSE)
        self.assertEqual(fit.errors["mu_d"], math.inf)
        self.assertTrue(any("combinations" in str(one.message) for one in caught), [str(one.message) for one in caught])


class Likelihood(Fits):
    def test_durations_give_back_what_they_were_drawn_with(self):
        fit = stickslip.fit({"sticks": drawn("stick", 400)}, ["mu_d", "tau"], {"mu_d": 0.5, "tau": 1}, **COARSE)
        self.within(fit)
        self.assertEqual(fit.observations, (0, 400))
        wrong = drawn("stick", 400, tau=1)
        other = stickslip.fit({"sticks": wrong}, ["mu_d", "tau"], {"mu_d": 0.5, "tau": 1}, **COARSE)
        self.assertGreater(abs(other.estimates["tau"] - 1.5), 4 * fit.errors["tau"])

    def test_what_is_too_short_to_be_seen_is_not_mistaken_for_missing(self):
        sticks = drawn("stick", 800)
        seen = sticks[sticks > 1]
        fit = stickslip.fit({"sticks": seen, "smallest": {"sticks": 1}}, "tau", mu_d=0.3, **COARSE)
        self.within(fit, {"tau": 1.5})
        ((name, distance, p),) = fit.distances()
        table = stickslip.run(quantities="duration_density", time=TIMES, accuracy=1e-4, **COARSE, mu_d=0.3,
                              tau=fit.estimates["tau"])["cdf_stick"]
        missed = numpy.interp(1, table.abscissa, table.value)
        right = scipy.stats.kstest(seen, lambda t: (numpy.interp(t, table.abscissa, table.value) - missed) / (1 - missed))
        self.assertEqual(name, "sticks")
        self.assertAlmostEqual(distance, right.statistic, delta=2e-3)
        self.assertAlmostEqual(p, right.pvalue, delta=0.05)
        naive = stickslip.fit({"sticks": seen}, "tau", mu_d=0.3, **COARSE)
        self.assertLess(naive.distances()[0][2], 1e-6)
        self.assertGreater(abs(naive.estimates["tau"] - 1.5), 4 * naive.errors["tau"])

    def test_slips_and_values_count_together(self):
        slips = drawn("slip", 200)
        alone = stickslip.fit({"slips": slips}, "mu_d", {"mu_d": 0.5}, tau=1.5, **COARSE)
        self.within(alone, {"mu_d": 0.3})
        error = alone.errors["mu_d"]
        r = stickslip.run(**COARSE, **TRUE, quantities="sticking,sensitivity")
        both = stickslip.fit({"slips": slips, "P_stick": (r["P_stick"].value, error * abs(r["dP_stick_dmu_d"].value))},
                             "mu_d", {"mu_d": 0.5}, tau=1.5, **COARSE)
        self.assertAlmostEqual(both.errors["mu_d"], error / math.sqrt(2), delta=0.05 * error)
        self.assertIsNone(both.degrees_of_freedom)
        self.assertIn("of 1 values\nlog likelihood", repr(both))
        for wrong in (lambda: both.interval("mu"), lambda: both.profile("mu")):
            self.assertRaisesRegex(ValueError, "mu: was not fitted; take one of", wrong)
        self.assertRaisesRegex(ValueError, "level = 95", both.interval, both.names[0], 95)

    def test_information_is_that_of_scores_and_of_second_differences(self):
        sticks = drawn("stick", 20000)
        search = Search(data_sets({"sticks": sticks}, COARSE), _axes(["mu_d", "tau"], TRUE, {}, declared()), 1e-3)
        u = numpy.array([axis.start for axis in search.axes])
        with Pool(2) as search.pool:
            search.fix_discretisation(search.models([u])[0].results)
            scores, information = search.slopes(u)[1], search.information(u)
            gradient, step = search.gradient(u), 0.01
            rise = [search.at(u + sign * numpy.array([0, step])).misfit for sign in (-1, 0, 1)]
            few = Search(data_sets({"sticks": [0.4, 1, 2], "smallest": {"sticks": 0.2}}, COARSE), search.axes, 1e-3)
            few.pool = search.pool
            weights = few.models([u])[0].grids[0][2]
        self.assertAlmostEqual(weights.sum(), 1, delta=1e-3)  # what few observations leave out below and above included
        self.assertGreater(weights[0] + weights[-1], 0.1)
        numpy.testing.assert_allclose(scores @ scores.T, information, rtol=0.05)
        self.assertAlmostEqual((rise[0] - 2 * rise[1] + rise[2]) / step**2, information[1, 1], delta=0.05 * information[1, 1])
        self.assertAlmostEqual((rise[2] - rise[0]) / 2 / step, gradient[1], delta=0.01 * math.sqrt(information[1, 1]))
        self.assertLess(gradient @ numpy.linalg.solve(information, gradient), scipy.stats.chi2.isf(1e-4, 2))

    def test_a_profile_has_the_interval_of_the_standard_error_where_data_are_many(self):
        fit = stickslip.fit({"sticks": drawn("stick", 2000)}, "tau", mu_d=0.3, **COARSE)
        profile = fit.profile("tau", 5)
        for one, other in zip(profile.interval(), fit.interval("tau")):
            self.assertAlmostEqual(one, other, delta=0.1 * fit.errors["tau"])
        self.assertEqual(profile.rise.min(), 0)
        self.assertEqual(profile.interval(0.9999)[0], -math.inf)
        curve, points = profile.plot(self.folder / "profile.png").axes[0].lines[:2]
        self.assertEqual(points.get_ydata().tolist(), profile.rise.tolist())
        middle = (profile.values[0] + profile.values[1]) / 2  # of a parabola nearly
        expected = (numpy.sqrt(profile.rise[:2]).mean()) ** 2
        self.assertAlmostEqual(numpy.interp(middle, curve.get_xdata(), curve.get_ydata()), expected, delta=0.01 * expected)
        fit.plot(self.folder / "fit.png")
        for name in ("profile.png", "fit.png"):
            self.assertTrue((self.folder / name).read_bytes().startswith(PNG))


class Refusals(Fits):
    def test_what_does_not_fit_together_is_refused_before_anything_runs(self):
        good = {"P_stick": (0.4, 0.01)}
        for arguments, said in (
                (([], "mu_d"), "no measurement"), (({}, "mu_d"), "no measurement"), (({"options": {}}, "mu_d"), "no measurement"),
                (({"P_stick": 0.4}, "mu_d"), r"P_stick must be \(value, error\)"),
                (({"P_stick": (0.4,)}, "mu_d"), r"\(value, error\)"),
                (({"S_v": (0.4, 0.1)}, "mu_d"), r"\(omega values, values, errors\)"),
                (({"S_v": ([1, 2], [1, 2], [1])}, "mu_d"), "one length"),
                (({"P_stick": (0.4, 0)}, "mu_d"), "not positive"), (({"P_stick": (math.nan, 1)}, "mu_d"), "not finite"),
                (({"P_stik": (0.4, 0.1)}, "mu_d"), "did you mean P_stick"), (({"stick": [1]}, "mu_d"), "sticks"),
                (({"sticks": [1, math.inf]}, "mu_d"), "positive numbers"), (({"sticks": []}, "mu_d"), "at least one"),
                (({"sticks": [0, 1]}, "mu_d"), "positive numbers"),
                (({"sticks": [0.1, 1], "smallest": {"sticks": 0.2}}, "mu_d"), "1 of 2 values below"),
                (({"sticks": [1], "smallest": 0.2}, "mu_d"), "must name samples"),
                (({"sticks": [1], "smallest": {"slides": 0.2}}, "mu_d"), "must name samples"),
                ((good, []), "each once"), ((good, ["mu_d", "mu_d"]), "each once"), ((good, "mud"), "did you mean mu_d"),
                ((good, "noise_levels"), "no parameter of the model that is a number"), ((good, ["mu_d", "tau"]), "2 parameters of 1"),
                ((good, "mu_d", {"tau": 1}), "tau is not free"), ((good, "mu_d", {}, {"tau": (1, 2)}), "tau is not free"),
                ((good, "mu_d", {"mu_d": 0.5}, {"mu_d": (0.6, 0.9)}), "between 0.6 and 0.9"),
                ((good, "mu_d", {"mu_d": math.nan}), "must be between"), ((good, "mu_d", {}, {"mu_d": (0.9, 0.6)}), "bounds"),
                ((good, "mu_d", {}, {"mu_d": (-1, 0.6)}), "bounds"), ((good, "noise_deviation"), "has no default")):
            with self.subTest(said=said), self.assertRaisesRegex(ValueError, said):
                stickslip.fit(*arguments, **COARSE)

    def test_options_that_have_no_place(self):
        good = {"P_stick": (0.4, 0.01)}
        for options, said in (({"free": "mu_d", "mu_d": 0.5}, "besides"), ({"free": "mu_d", "sweep_tau": [1]}, "sweep_tau"),
                              ({"free": "mu_d", "study": "p"}, "study"), ({"free": "mu_d", "route": "monte_carlo"}, "random"),
                              ({"free": "mu_s", "delta": 0.25}, "levels"), ({"free": "bias"}, "levels"),
                              ({"free": "mu_s", "bias": 0.1}, "levels"), ({"free": "mu_s", "noise": "telegraph"}, "levels")):
            with self.subTest(said=said), self.assertRaisesRegex(ValueError, said):
                stickslip.fit(good, start={}, **options)

    def test_what_the_program_refuses_or_does_not_depend_on(self):
        with self.assertRaisesRegex(stickslip.BadInput, "mu_d = 2"):
            stickslip.fit({"P_stick": (0.4, 0.01)}, "mu_d", {"mu_d": 2}, **COARSE)
        with self.assertRaisesRegex(ValueError, "mu_d has no effect"):
            stickslip.fit({"P_X_le_mu_s": (0.4, 0.01)}, "mu_d", {"mu_d": 0.5}, **COARSE)


class Axes(unittest.TestCase):
    def test_values_come_back_within_bounds(self):
        for low, high in ((0, math.inf), (-math.inf, math.inf), (-math.inf, 3), (-1, 2)):
            axis = Axis("x", 0.5, low, high)
            self.assertAlmostEqual(axis.value(axis.start), 0.5)
            for u in (-20, -1, 0, 2, 20):
                self.assertTrue(low <= axis.value(u) <= high)
                self.assertGreater(axis.slope(u), 0)
            self.assertAlmostEqual(axis.of(axis.value(0.7)), 0.7)


if __name__ == "__main__":
    unittest.main()
