"""The same bodies in other units of length: the same results, to rounding, and the same statuses."""

import json
import re
import unittest

from running import Case, relative_difference, run

# Eigenvalues and reduced models stop where they are good enough: they differ by more, but for the powers of two, in
# which no number is rounded.
SEARCHED = ("linear", "without drag", "passages")
# {1} stands for a force, speed or length of 1 m, {0.5} for one of 0.5 m; {/2} for 2 in 1/m, {//3} in 1/m^2.
NOISE = "-tau 1 -noise_deviation {1} -delta {0.25} -accuracy 1e-4 "
OF_BODIES = "-mu_s {1} -mu_d {0.5} " + NOISE
EXPRESSION = OF_BODIES + "-drag expression -drag_expression "
CASES = {
    "linear": OF_BODIES + "-quantities sticking,moments,spectrum,phase_durations,slip,relaxation,autocorrelation,"
              "laplace,peak -omega 0,1 -time 0.5,2 -lambda 0.5 -distance {0.5},{2} -velocity {0.5}",
    "cubic and a bias": OF_BODIES + "-drag cubic -drag_coefficient 0.3 -drag_cubic {//0.1} -bias {0.1}",
    "without drag": OF_BODIES + "-drag none -quantities sticking,moments,displacement -time 1,4",
    "Stribeck": OF_BODIES + "-friction stribeck -stribeck_velocity {0.3} -drag_coefficient 0.5",
    "pulses": "-mu_s {1} -mu_d {0.5} -noise pulses -pulse_height {1.5} -pulse_rate 1 -pulse_duration 1 -accuracy 1e-4",
    "a force beyond a speed": EXPRESSION + "'-0.5*v-5*max(v-{0.5},0)'",
    "a clipped force": EXPRESSION + "'-0.2*v-max(-{0.3},min({0.3},v))'",
    "a bump": EXPRESSION.replace("{0.25}", "{0.5} -noise_levels 4") + "'-0.5*v-{5}*exp(-((v-{0.9})/{0.001})^2)'",
    "a rising force": EXPRESSION + "'{0.3}*(1-exp(-{/10}*abs(v)))*sign(v)-v'",
    "a saturating force": EXPRESSION + "'-{0.4}*tanh(v/{0.5})' -bias {0.2}",
    "observables": OF_BODIES + "-quantities averages -observable "
                   "'v>{0.3};abs(v)*exp(-((v-{0.7})/{0.01})^2)/{1};v>{1}?(v/{1})^2:1'",
    "passages": OF_BODIES + "-drag_coefficient 0.5 -quantities first_passage,displacement,displacement_distribution "
                "-velocity {0.5},{1} -time 3 -distance {0.5},{1} -start rest -accuracy 3e-2",
    "a large bias": EXPRESSION + "-v -bias {3.5}",
    "a jump, which is refused": EXPRESSION + "'abs(v)<{1}?-v:-1.1*v'",
    "an infinite slope, which is refused": EXPRESSION + "'-sqrt(abs(v)/{1})*sign(v)*{1}'",
    "no end, which is refused": EXPRESSION + "'{0.6}*tanh(v/{1})'",
}
SIMULATION = " -route monte_carlo -excursions 2000 -accuracy 1e-9 "


def words(case, unit):
    def scaled(found):
        power = (1, -1, -2)[found.group(1).count("/")]
        return repr(float(found.group(2)) * unit ** power)
    text = re.sub(r"\{(/*)([\d.]+)\}", scaled, case)
    return [word.strip("'") for word in re.findall(r"'[^']*'|\S+", text)]


def power_of_length(unit):
    sign = -1 if unit.startswith("1/") else 1
    return sign * sum(int(power or 1) for power in re.findall(r"(?:force|velocity)(?:\^(\d+))?", unit))


class Units(Case):
    def results(self, case, unit):
        """The status, and the values in metres by key."""
        file = self.folder / "summary.json"
        file.unlink(missing_ok=True)
        done = run(*words(case, unit), "-summary", file, folder=self.folder)
        if done.returncode == 2:
            return 2, {}
        found = {}
        for key, result in enumerate(json.loads(file.read_text())["results"].values()):  # names hold numbers
            values = result["value"]
            power = power_of_length(result.get("unit", ""))
            for n, value in enumerate(values if isinstance(values, list) else [values]):
                found[key, n] = value / unit ** power if isinstance(value, float) else value
        return done.returncode, found

    def compare(self, case, tolerance, units):
        status, expected = self.results(case, 1)
        for unit in units:
            with self.subTest(unit=unit, case=case):
                other, found = self.results(case, unit)
                self.assertEqual(other, status)
                self.assertEqual(found.keys(), expected.keys())
                for key, value in expected.items():
                    if value is None or found[key] is None:
                        self.assertEqual(found[key], value, key)
                    else:
                        self.assertLess(relative_difference(found[key], value), tolerance, key)

    def test_length(self):
        for name, case in CASES.items():
            self.compare(case, 1e-12, (2.0 ** 20,) if name in SEARCHED else (2.0 ** 20, 1e9))
            self.assertEqual("refused" in name, self.results(case, 1)[0] == 2, name)

    def test_simulation(self):
        for name in ("a force beyond a speed", "a bump"):
            self.compare(CASES[name].replace("-accuracy 1e-4", SIMULATION), 1e-9, (1e6,))


if __name__ == "__main__":
    unittest.main()
