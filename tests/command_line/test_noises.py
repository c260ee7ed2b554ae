"""Noises of the command line: what is refused, what has no effect, and what the summary holds."""

import json
import math
import unittest

import h5py

from running import Case, run

TELEGRAPH = ("-mu_d", "0.5", "-bias", "0.3", "-noise", "telegraph", "-telegraph_amplitude", "1",
             "-telegraph_rate", "1")
HEADER = "x,rate_up,rate_down\n"


class Noises(Case):
    def refuse_file(self, text, *message):
        (self.folder / "levels.csv").write_text(text)
        self.refuse("-noise", "file", "-noise_file", "levels.csv",
                    message=("-noise_file = levels.csv: ", *message))

    def test_what_a_noise_needs(self):
        self.refuse("-noise", "telegraph", "-telegraph_rate", "1",
                    message=("-noise = telegraph: needs -telegraph_amplitude",))
        self.refuse("-noise", "telegraph", "-telegraph_amplitude", "1",
                    message=("-noise = telegraph: needs -telegraph_rate",))
        self.refuse("-noise", "file", message=("-noise = file: needs -noise_file",))

    def test_values_out_of_range(self):
        self.refuse("-noise_deviation", "0", message=("-noise_deviation = 0", "(0, inf)"))
        for option in ("-telegraph_amplitude", "-telegraph_rate"):
            self.refuse(*TELEGRAPH, option, "-1", message=(f"{option} = -1", "(0, inf)"))
        self.refuse("-noise", "telegrah", message=("-noise = telegrah", "did you mean telegraph?"))

    # By a finite element program of its own, with numbers of polynomials and meshes of its own, and
    # for one term by the limit of small steps of -noise ou.
    GAUSSIAN = (
        (("1,1", "-mu_d", "0.25", "-accuracy", "1e-5"),
         {"P_stick": 0.12059704171, "mean_slide": 3.08129985, "mean_stick": 0.42255446, "E_V2": 0.309715092}),
        (("1,1", "-mu_d", "1", "-accuracy", "1e-4"),
         {"P_stick": 0.516134, "E_V2": 0.04962230, "E_absV": 0.09979207}),
        (("1,1; 0.64,5", "-mu_d", "0.5", "-accuracy", "1e-2"),
         {"P_stick": 0.0849877, "mean_slide": 1.178504, "E_V2": 0.2589338, "E_XV": 0.4345693}),
        (("1,0.5,1", "-mu_d", "0.25", "-accuracy", "1e-2"),
         {"P_stick": 0.1640417, "mean_slide": 3.35641, "mean_stick": 0.658634, "E_V2": 0.2965518}))

    def test_gaussian_noise(self):
        for options, right in self.GAUSSIAN:
            summary = self.summary("-noise", "gaussian", "-covariance", *options, "-quantities", "sticking,moments")
            for key, value in right.items():
                found = summary["results"][key]
                self.assertLess(abs(found["value"] - value), found["error"] + 5e-7 * value, (options, key))
                self.assertLess(found["error"], float(options[-1]) * value)
            self.assertEqual(summary["results"]["E_V"]["value"], 0)

    def test_gaussian_noise_between_two_grids(self):
        """Where elements beside mu_d stay as they are, changes say nothing. By thrice as many nodes and graded finer."""
        case = ("-noise", "ou", "-delta", "0", "-tau", "0.78128600705", "-noise_deviation", "0.83553482962", "-mu_d",
                "0.71204369511", "-drag", "cubic", "-drag_coefficient", "0.001026321234", "-drag_cubic", "1.86233621951")
        for degree in range(4, 10):
            summary = self.summary(*case, "-quantities", "sticking", "-degree", str(degree), "-accuracy", "0.01")
            for key, value in {"P_stick": 0.40120310, "mean_stick": 0.6299411, "mean_slide": 0.9401890}.items():
                found = summary["results"][key]
                self.assertLess(abs(found["value"] - value), found["error"] + 3e-7, (degree, key))

    def test_observables_that_jump_with_the_noise(self):
        """No node of the force stands at a jump, and no step of a path ends there."""
        case = ("-noise", "ou", "-delta", "0", "-mu_d", "0.5", "-quantities", "averages", "-observable",
                "(abs(x)<0.1);(abs(x)>0.99)")
        solved = self.summary(*case, "-accuracy", "1e-5")["results"]
        found = solved["pi((abs(x)<0.1))"]
        self.assertLess(abs(found["value"] - math.erf(0.1 / math.sqrt(2))), found["error"] + 1e-10)
        self.assertLess(found["error"], 1e-6)
        simulated = self.summary(*case, "-route", "monte_carlo", "-excursions", "8000", "-seed", "1")["results"]
        for part in ("stick", "slide"):
            for function, share in (("(abs(x)<0.1)", 0.03), ("(abs(x)>0.99)", 0.1)):  # beside mu_s, too
                exact, path = (results[f"pi({function}|{part})"] for results in (solved, simulated))
                self.assertLess(abs(path["value"] - exact["value"]), 2 * path["error"], (function, part))
                self.assertLess(path["error"], share * exact["value"])

    def test_what_gaussian_noise_takes(self):
        noise = ("-noise", "gaussian", "-covariance")
        (self.folder / "terms.csv").write_text("amplitude,decay,frequency,sine\n1,1,0,0\n")
        by_file = self.summary("-noise", "gaussian", "-covariance_file", "terms.csv", "-quantities", "moments")
        by_default = self.summary("-noise", "gaussian", "-quantities", "moments")
        self.assertEqual(by_file["results"], by_default["results"])
        self.refuse(*noise, "1,1", "-covariance_file", "terms.csv", message=("leave one of them out",))
        self.refuse("-noise", "gaussian+telegraph", "-covariance", "1,1", "-telegraph_amplitude", "1",
                    "-telegraph_rate", "1", message=("-noise = gaussian+telegraph: adds chains",))
        self.refuse(*noise, "1", message=("-covariance = 1: has 1 numbers", "amplitude,decay"))
        self.refuse(*noise, "1,1,x", message=('has "x" in the place of a number',))
        self.refuse(*noise, "1,1; 1,-2", message=("term 2: decay = -2 must be positive",))
        self.refuse(*noise, "1,1; -0.9,3", message=("power spectral density", "must not be negative"))
        self.refuse(*noise, "1,1", "-route", "lambda", message=("-route = lambda", "needs a noise of levels"))
        self.refuse(*noise, "1,1", "-quantities", "entry_law", message=("asks for entry_law", "gaussian has none"))
        self.refuse(*noise, "1,1", "-mu_d", "0.5", "-quantities", "expectation", "-observable", "v", "-time", "1",
                    message=("-start = s+: is one level",))
        self.refuse(*noise, "1,1", "-quantities", "slip", "-distance", "1", message=("asks for slip", "mu_d = mu_s"))

    def test_gaussian_noise_is_simulated(self):
        simulated = (*self.BAND, "-route", "monte_carlo", "-excursions", "600")
        self.run_ok(*simulated, "-quantities", "sticking,averages,slip,duration_density", "-observable", "v>0.5",
                    "-time", "1", "-distance", "0.5", "-output", "simulated.h5")
        compared = self.summary(*self.BAND, "-quantities", "sticking", "-accuracy", "0.03", "-compare", "simulated.h5")
        self.assertEqual(len(compared["comparison"]), 4)  # all but one of two shares of the time
        self.refuse(*simulated, "-quantities", "peak", "-velocity", "0.1", message=("asks for peak", "simulated for"))
        self.refuse(*simulated, "-accuracy", "1e-3", message=("-accuracy = 1e-3: is not reached", "take 0.002 or more"))

    GROUND = ("-noise", "filtered", "-ground_frequency", "15.6", "-ground_damping", "0.6", "-noise_deviation", "2",
              "-mu_s", "1.5", "-mu_d", "0.75")
    BAND = ("-noise", "narrow_band", "-band_frequency", "1", "-band_width", "0.5", "-mu_d", "0.25")

    def test_durations_of_gaussian_noise(self):
        # (1 - F)' = -f, integrated by Simpson's rule in log t, and the fall of long rests at the rate 2 (test_stick_distribution).
        times = [0.5 * 2 ** (n / 4) for n in range(9)]
        found = self.summary("-noise", "ou", "-delta", "0", "-mu_d", "0.5", "-quantities", "phase_durations",
                             "-time", ",".join(map(repr, times + [4, 6])), "-accuracy", "1e-3")["results"]
        for phase in ("slide", "stick"):
            f, cdf = found[f"f_{phase}"]["value"], found[f"cdf_{phase}"]["value"]
            weights = [1, 4, 2, 4, 2, 4, 2, 4, 1]
            rise = math.log(2) / 12 * sum(w * t * value for w, t, value in zip(weights, times, f))
            self.assertAlmostEqual(rise, cdf[8] - cdf[0], delta=1e-4)
        stick = found["f_stick"]
        self.assertAlmostEqual(stick["value"][10] / stick["value"][9], math.exp(-4), delta=1e-5)
        self.refuse("-noise", "ou", "-delta", "0", "-mu_d", "0.5", "-quantities", "phase_durations", "-time", "0:1:3",
                    message=("-time", "includes 0", "infinite"))
        at_balance = ("-noise", "ou", "-delta", "0", "-quantities", "phase_durations", "-time", "1")
        self.refuse(*at_balance, message=("mu_d = mu_s", "infinitely often"))

    # By -delta 1/16, 1/32 and 1/64, extrapolated twice: results are of first order in the step.
    LIMITS = (
        (("passage_transform", "-velocity", "0.3", "-lambda", "1"), "F_passage(0.3)", 0.270516, 2e-6),
        (("passage_distribution", "-velocity", "0.3", "-time", "1"), "cdf_passage(0.3)", 0.327744, 2e-5),
        (("displacement_transform", "-wavenumber", "2", "-time", "3"), "displacement_cosine(3)", 0.445180, 2e-5))

    def test_passages_and_displacements_of_gaussian_noise(self):
        for quantity, key, right, error in self.LIMITS:
            found = self.summary("-noise", "ou", "-delta", "0", "-mu_d", "0.5", "-accuracy", "1e-3", "-start", "rest",
                                 "-quantities", *quantity)["results"][key]
            self.assertLess(abs(found["value"][0] - right), found["error"][0] + error, key)
            self.assertLess(found["error"][0], 1e-3, key)

    # u(f) and h- of -noise ou by -delta 1/40, 1/20 and 1/10, extrapolated twice; w+, h- and u of the band by 120 000
    # simulated excursions, within 0.5 %.
    RESOLVENTS = (
        (("-noise", "ou", "-delta", "0", "-mu_d", "0.5", "-bias", "0.2"), "1e-3", 3e-4,
         {"u(v^2)": 0.267943, "h_minus": 0.224592, "mu(v)": 0.159407, "u_minus(stick)": 0.452669}),
        (BAND, "0.1", 0.01, {"u(v^2)": 0.4602, "h_minus": 0.1903, "w_one": 1.512, "u(stick)": 0.2138}))

    def test_the_resolvent_of_gaussian_noise(self):
        for case, accuracy, share, right in self.RESOLVENTS:
            found = self.summary(*case, "-accuracy", accuracy, "-quantities", "sticking,averages,resolvent",
                                 "-observable", "v^2;v;stick", "-lambda", "1e-7,0.5")["results"]
            for key, value in right.items():
                self.assertLess(abs(found[key]["value"][1] - value), found[key]["error"][1] + share * value, key)
            for f in ("v^2", "stick"):
                mean, limit = found[f"pi({f})"], found[f"pi_lambda({f})"]
                self.assertLess(abs(limit["value"][0] - mean["value"]), limit["error"][0] + mean["error"], f)
            if case is self.BAND:
                self.assert_close(found["w_one"]["value"][0], found["mean_excursion"]["value"], 1e-6)
            ends = (found[key]["value"][1] for key in ("h_plus", "h_minus"))
            self.assert_close(sum(ends) + 0.5 * found["w_one"]["value"][1], 1, 1e-9)
        asks = ("-observable", "v", "-lambda", "1", "-quantities", "resolvent")
        self.refuse(*self.BAND, *asks, "-route", "monte_carlo", message=("asks for resolvent", "simulated for noises"))

    def test_sensitivities_of_gaussian_noise(self):
        ou = ("-noise", "ou", "-delta", "0")
        # By differences of runs 1 and 2 % apart, of accuracy 1e-7, extrapolated.
        at = {"tau": 1, "noise_deviation": 1.1, "mu_s": 1, "mu_d": 0.5, "drag_coefficient": 0.8}
        right = {"dP_stick_dtau": 0.06155476, "dmean_stick_dtau": 0.4054473, "dE_XV_dnoise_deviation": 1.0624718,
                 "dmean_slide_dmu_s": 1.314672, "dmean_stick_dmu_d": 0.208903, "dE_V2_ddrag_coefficient": -0.5577778}
        stated = [word for name, value in at.items() for word in (f"-{name}", str(value))]
        found = self.summary(*ou, *stated, "-quantities", "sticking,moments,sensitivity", "-accuracy", "1e-4")["results"]
        for key, value in right.items():
            self.assertLess(abs(found[key]["value"] - value), found[key]["error"] + 2e-6 * abs(value), key)
            self.assertLess(found[key]["error"], 1e-3 * abs(value), key)
        # By units: no share of the time changes if all forces grow, nor if all times do.
        ground = {"ground_frequency": 15.6, "ground_damping": 0.6, "noise_deviation": 2, "mu_s": 1.5, "mu_d": 0.75,
                  "drag_coefficient": 1}
        cases = ((found, at, {"tau": 1, "drag_coefficient": -1}),
                 (self.summary(*self.GROUND, "-quantities", "sticking,sensitivity", "-degree", "4", status=3)["results"],
                  ground, {"ground_frequency": 1, "drag_coefficient": 1}))
        for results, values, times in cases:
            for powers in (dict.fromkeys(("noise_deviation", "mu_s", "mu_d"), 1), times):
                parts = [power * values[name] * results[f"dP_stick_d{name}"]["value"] for name, power in powers.items()]
                self.assertLess(abs(sum(parts)), 2e-3 * max(map(abs, parts)), powers)
        self.assertIn("dP_stick_dground_damping", cases[1][0])
        self.refuse("-noise", "ou", "-spring_stiffness", "1", "-mu_d", "0.5", "-quantities", "sticking,sensitivity",
                    message=("derivatives are not found for a body on a spring", "leave -spring_stiffness out"))

    def test_gaussian_noises_by_name(self):
        ground = self.summary(*self.GROUND, "-accuracy", "1e-3")
        for key, value in {"P_stick": 0.057558, "mean_slide": 0.330008, "E_V2": 0.0337518, "E_XV": 0.1310128}.items():
            found = ground["results"][key]
            self.assertLess(abs(found["value"] - value), found["error"] + 4e-5 * value, key)
        by_terms, by_name = (self.summary(*noise, "-mu_d", "0.25", "-accuracy", "0.03", "-quantities", "sticking,moments")["results"]
                             for noise in (("-noise", "gaussian", "-covariance", "1,1; 0.64,5"),
                                           ("-noise", "gaussian+ou", "-covariance", "1,1", "-tau", "0.2",
                                            "-noise_deviation", "0.8", "-delta", "0")))
        for key, result in by_terms.items():
            self.assert_close(by_name[key]["value"], result["value"], 1e-6)

    def test_gaussian_noises_have_no_step(self):
        self.refuse(*self.BAND, "-delta", "1", message=("-delta = 1", "a step between levels", "lattice(delta)"))
        self.refuse("-delta", "0", "-noise_levels", "5", message=("-noise_levels = 5: counts levels", "leave it out"))
        self.refuse("-delta", "0", "-study", "delta", message=("needs a noise of levels", "such as 0.125"))
        self.refuse("-noise", "gaussian+ou", "-covariance", "1,1", "-delta", "0", "-study", "delta",
                    message=("needs a noise of levels", "take a chain"))
        smooth = (*self.BAND[:-3], "0.001", "-mu_d", "0.5")
        self.refuse(*smooth, message=("-band_width = 0.001: the covariance falls", "too smooth", "take a larger"))
        both = ("-noise", "narrow_band+telegraph", *self.BAND[2:], "-telegraph_amplitude", "1", "-telegraph_rate", "1")
        self.refuse(*both, message=("adds chains, and narrow_band noise is none", "lattice(delta)"))
        with_ou = ("-noise", "gaussian+ou", "-mu_d", "0.5")
        self.refuse(*with_ou, message=("adds chains, and gaussian noise is none", "give -delta 0"))
        self.run_ok(*with_ou, "-delta", "0", "-plan")

    def test_the_density_of_a_noise_without_levels(self):
        summary = self.summary(*self.BAND, "-quantities", "sticking,moments,density", "-accuracy", "0.01", "-output", "d.h5")
        with h5py.File(self.folder / "d.h5") as file:
            x, v, pdf, weights, rest, marginal = (file["density"][name][:] for name in (
                "x", "v", "pdf", "weights", "atom", "marginal_x"))
        self.assert_close(rest.sum(), summary["results"]["P_stick"]["value"], 1e-3)
        self.assert_close(marginal.sum(), 1, 1e-6)
        self.assert_close((marginal * x**2).sum(), 1, 1e-5)
        mass = pdf * weights
        self.assert_close(mass.sum(), summary["results"]["P_slide"]["value"], 1e-3)
        self.assert_close((mass * v**2).sum(), summary["results"]["E_V2"]["value"], 1e-3)
        self.assert_close((mass * v * x[:, None]).sum(), summary["results"]["E_XV"]["value"], 1e-3)

    def test_files_that_cannot_be_read(self):
        for name in ("none.csv", "."):  # a folder is no file
            self.refuse("-noise", "file", "-noise_file", name,
                        message=(f"-noise_file = {name}: cannot be read",))

    def test_files_of_another_form(self):
        self.refuse_file("", "Header missing")
        self.refuse_file("a,rate_up,rate_down\n-1,1,0\n1,0,1\n", 'column "a"', "x,rate_up,rate_down")
        self.refuse_file("x,rate_up\n-1,1\n1,0\n", "rate_down")
        self.refuse_file(HEADER + "-1,1,0\n1,0\n", "line 3")
        self.refuse_file(HEADER + "-1,1,0\n0,one,1\n1,0,1\n", "line 3", "rate_up = one")
        self.refuse_file(HEADER + "-1,1,0\n0,1,nan\n1,0,1\n", "line 3", "rate_down = nan")

    def refuse_chain(self, states, rates, *message):
        (self.folder / "states.csv").write_text("x\n" + "".join(f"{x}\n" for x in states))
        (self.folder / "rates.csv").write_text("from,to,rate\n" + "".join(f"{row}\n" for row in rates))
        self.refuse("-noise", "chain", "-noise_states", "states.csv", "-noise_rates", "rates.csv",
                    message=message)

    def test_chains(self):
        ring = ["0,1,1", "1,2,1", "2,0,1"]
        rates, states = "-noise_rates = rates.csv: ", "-noise_states = states.csv: "
        self.refuse("-noise", "chain", message=("-noise = chain: needs -noise_states",))
        self.refuse_chain([-2, 0, 2], [*ring[:2], "2,0,-1"], rates, "line 4: rate = -1")
        self.refuse_chain([-2, 0, 2], [*ring[:2], "2,0,inf"], rates, "line 4: rate = inf")
        self.refuse_chain([-2, 0, 2], [*ring, "2,3,1"], rates, "line 5: there is no state 3", "from 0 to 2")
        self.refuse_chain([-2, 0, 2], [*ring, "0.5,1,1"], rates, "line 5: there is no state 0.5")
        self.refuse_chain([-2, 0, 2], [*ring, "1,1,1"], rates, "line 5: state 1 jumps to itself")
        self.refuse_chain([-2, 0, 2], [*ring, "0,1,2"], rates, "line 5: line 2 has the rate from state 0")
        self.refuse_chain([-2, 0, "two"], ring, states, "line 4: x = two")
        self.refuse_chain([-2, 0, 2], ring[:2], states, "line 2: state 0 is never reached")
        self.refuse_chain([-2, 0, 2, 3], [*ring, "3,0,1"], states, "line 5: state 3 is never reached")
        self.refuse_chain([-2, 0, 2, 3], ["0,1,1", "1,0,1", "2,3,1", "3,2,1"], states, "line 4")
        self.refuse_chain([-0.2, 0, 0.2], ring, "-mu_s = 1: holds the body on all")

    def test_groups_of_levels_need_neighbours(self):
        chain = ("-mu_d", "0.5", "-noise", "chain", "-noise_states", "states.csv", "-noise_rates", "rates.csv")
        (self.folder / "states.csv").write_text("x\n-2\n0.3\n2\n")
        (self.folder / "rates.csv").write_text("from,to,rate\n0,2,1\n2,1,1\n1,0,2\n")
        self.refuse(*chain, "-noise_degree", "3",
                    message=("-noise_degree = 3", "a noise that jumps to neighbours alone"))
        for options in ((), ("-route", "hitting"), ("-route", "fluid_queue", "-drag", "none"),
                        ("-quantities", "sticking,sensitivity"),
                        ("-route", "monte_carlo", "-excursions", "1000", "-quantities", "peak", "-velocity", "0.1")):
            self.assertEqual(run(*chain, *options, folder=self.folder).returncode, 0, options)

    def test_neighbours_as_a_chain_give_the_digits_of_levels(self):
        (self.folder / "levels.csv").write_text(HEADER + "-2,1,0\n-0.6,0.7,0.5\n0.6,0.4,0.7\n2,0,1\n")
        (self.folder / "states.csv").write_text("x\n2\n-2\n0.6\n-0.6\n")  # in another order
        (self.folder / "rates.csv").write_text(
            "from,to,rate\n1,3,1\n3,2,0.7\n3,1,0.5\n2,0,0.4\n2,3,0.7\n0,2,1\n")
        quantities = ("-mu_d", "0.5", "-quantities",
                      "sticking,moments,laplace,spectrum,slip,entry_law,displacement,resolvent,peak,sensitivity",
                      "-lambda", "0.5", "-omega", "0,1", "-time", "1", "-observable", "x*v",
                      "-velocity", "0.3", "-start", "stationary")
        found = [self.values(*quantities, *noise) for noise in (
            ("-noise", "file", "-noise_file", "levels.csv"),
            ("-noise", "chain", "-noise_states", "states.csv", "-noise_rates", "rates.csv"))]
        self.assertEqual(found[0], found[1])

    def values(self, *options):
        done = run(*options, "-summary", "summary.json", folder=self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        results = json.loads((self.folder / "summary.json").read_text())["results"]
        return {key: result["value"] for key, result in results.items()}

    def test_options_of_another_noise(self):
        for option, value in (("-telegraph_amplitude", "1"), ("-telegraph_rate", "1"), ("-noise_file", "x.csv")):
            self.refuse(option, value, message=(f"{option} = {value}: belongs to -noise",))
        self.refuse(*TELEGRAPH, "-noise_file", "x.csv", message=("-noise_file = x.csv: belongs to -noise file, and -noise is telegraph",))
        for study in ("delta", "heuristic"):
            self.refuse(*TELEGRAPH, "-study", study, "-quantities", "sticking",
                        message=(f"-study = {study}", "-noise telegraph does not have"))
        self.refuse(*TELEGRAPH, "-sweep_tau", "1,2", message=("-tau = 1 has no effect with -noise telegraph",))

    def test_options_without_effect(self):
        for option in ("-tau", "-delta", "-noise_levels", "-noise_deviation"):
            with self.subTest(option=option):
                done = self.run_ok(*TELEGRAPH, option, "1", "-quantities", "sticking")
                self.assertIn(f"{option} = 1 has no effect with -noise telegraph; leave it out", done.stderr)
        self.assertEqual(self.run_ok(*TELEGRAPH, "-quantities", "sticking").stderr, "")


class Summary(Case):
    def test_the_summary_tells_the_noise(self):
        s = self.summary(*TELEGRAPH, "-quantities", "sticking")
        self.assertEqual([s["scene"][key] for key in ("noise", "telegraph_amplitude", "telegraph_rate")],
                         ["telegraph", 1, 1])
        self.assertNotIn("tau", s["scene"])
        self.assert_close(s["results"]["P_stick"]["value"], 3 / 8, 1e-12)
        self.assertEqual(self.summary("-noise_deviation", "0.9")["scene"]["noise_deviation"], 0.9)

    def test_two_levels_of_a_file_are_the_telegraph(self):
        (self.folder / "two.csv").write_text("# X = +-1\n" + HEADER + " -1, 1, 0\n1,0,1\n")
        ask = ("-quantities", "sticking,moments,noise_law,entry_law")
        telegraph, file = (self.summary(*TELEGRAPH[:4], *noise, *ask) for noise in (
            TELEGRAPH[4:], ("-noise", "file", "-noise_file", "two.csv")))
        self.assertEqual(file["scene"]["noise_file"], "two.csv")
        self.assertEqual(telegraph["results"], file["results"])


if __name__ == "__main__":
    unittest.main()
