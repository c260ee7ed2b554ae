"""Inputs with answers that are known from elsewhere: closed forms, other methods, other programs."""

import unittest

import running

DATA = running.SOURCES / "tests" / "data"


def noise(file):
    return f"-noise file -noise_file {DATA / file} "


SLOPE = "-mu_s 4.759 -mu_d 4.759 -bias 4 -noise_deviation 0.3 -tau 0.05 -drag none -quantities sticking "
EVEN = "-mu_s 0.6 -mu_d 0.42 -drag cubic -drag_coefficient 0.5 -drag_cubic 0.4 "
WHITE = "-mu_s 1 -mu_d 1 -drag none -quantities spectrum "
SIX = "-mu_s 1.3 -mu_d 0.026 -drag expression -drag_expression -1.5*tanh(v)-0.1*v -quantities spectrum -omega "
CUBIC = "-mu_s 0.7 -mu_d 0.4 -tau 4 -delta 0.25 -drag cubic -drag_coefficient 2 -drag_cubic 1 -quantities spectrum "
NEVER_STICKS = "-noise telegraph -telegraph_amplitude 2 -telegraph_rate 1 "

PUSHED = "-noise telegraph -telegraph_amplitude 1 -telegraph_rate 1 -bias 0.3 -mu_d 0.5 "
ALWAYS_MOVES = "-noise telegraph -telegraph_amplitude 0.5 -telegraph_rate 1 -mu_s 1 -mu_d 1 -bias 2 "
# Off, where the force equals friction exactly, and on.
GENE = f"-noise chain -noise_states {DATA}/gene_states.csv -noise_rates {DATA}/gene_rates.csv -mu_s 0.1 -mu_d 0.1 "

# Command line, key, right value, its relative precision, where it comes from. A run has to reach its accuracy and to
# state an error that covers the difference.
RIGHT = [
    (SLOPE + "-delta 0.02", "P_stick", 0.98986751487933, 1e-13, "fluid queue; simulation agrees"),
    (SLOPE + "-delta 0.03", "P_stick", 0.9901919937, 1e-9, "the same chain from a file"),
    (noise("pulses1e6.csv") + "-mu_s 0.5 -mu_d 0.5 -drag none", "P_stick", 0.17157287525381, 1e-12,
     "3 - 2 sqrt(2), pulses of no duration"),
    (noise("onoff3.csv") + "-mu_s 1.7 -mu_d 1.7 -drag none -speed_limit 0.5", "P_stick", 0.727076041303699, 1e-14,
     "fluid queue with a finite buffer"),
    (noise("eight_levels_even.csv") + EVEN + '-quantities resolvent -observable min(abs(v),0.4) -lambda 0.5',
     "mu(min(abs(v),0.4))", 0, 0, "mirror symmetry"),
    (noise("eight_levels_even.csv") + EVEN + "-quantities averages -observable v*abs(x)", "pi(v*abs(x))", 0, 0,
     "mirror symmetry"),
    (noise("below_zero.csv") + "-mu_s 0.5 -mu_d 0.5 -quantities averages -observable (v>0.3)*(x>0)",
     "pi((v>0.3)*(x>0))", 0, 0, "x is never positive"),
    (noise("pulses1e6.csv") + "-mu_s 0.5 -mu_d 0.5 -drag_coefficient 0.3", "P_stick", 0.286478143, 6e-9,
     "the same with -v_max 200"),
    ("-mu_s 1 -mu_d 1 -bias 0.9 -noise_deviation 0.1 -delta 0.05 -drag none", "P_stick", 0.742568542298927, 1e-13,
     "fluid queue"),
    ("-mu_s 1 -mu_d 0.8 -mu_s_minus 1e12 -drag none -bias 0.3", "E_V2", 3.41180160460, 5e-12, "fluid queue"),
    ("-mu_s 1 -mu_d 0.8 -mu_s_minus 1e12 -drag none -bias -0.3", "P_stick", 0.7685816999975, 1e-12,
     "fluid queue"),
    (noise("quoted_header.csv") + "-quantities noise_law", "E_X2", 1.5, 1e-15, "three levels alike"),
    ("-mu_d 0", "P_stick", 0.07530091, 1e-7, "the limit of small mu_d, and of the route null_vector"),
    ("-mu_s 1e-8 -mu_d 1e-8 -tau 0.002 -delta 2.7950849718747373 -drag expression -drag_expression -tanh(v)", "E_V2",
     2.464393, 1e-6, "the same at -accuracy 1e-8"),
    ("-drag_coefficient 1e-6 -bias 0.5 -mu_d 0.5 -delta 0.25", "E_XV", 0.999194051, 2e-9,
     "mu_d E|V| + c E[V^2] - bias E[V]"),
    (noise("on_off.csv") + "-mu_s 0.8 -mu_d 0.5 -bias -0.6 -drag none", "P_stick", 7 / 22, 1e-14,
     "no mean acceleration: 0.4 in half of the time, -1.1 in the rest of the sliding time"),
    (ALWAYS_MOVES + "-quantities moments,spectrum", "E_V", 1, 1e-14, "E X + g - mu over c"),
    (ALWAYS_MOVES + "-quantities moments,spectrum", "E_V2", 13 / 12, 1e-12, "telegraph noise through a linear filter"),
    (ALWAYS_MOVES + "-quantities moments,spectrum", "S_0", 0.25, 1e-10, "that of the noise over c^2"),
    (ALWAYS_MOVES + "-quantities averages -observable v<0.9", "pi(v<0.9)", 0.4, 1e-9, "V is uniform from 0.5 to 1.5"),
    (GENE + "-quantities moments", "E_V", 0.4, 1e-14, "V is Beta(2, 3)"),
    (GENE + "-quantities moments", "E_V2", 0.2, 1e-14, "V is Beta(2, 3)"),
    (GENE + "-quantities averages -observable v<0.5", "pi(v<0.5)", 0.6875, 1e-9, "V is Beta(2, 3)"),
    (NEVER_STICKS + "-quantities moments", "E_V2", 1 / 3, 1e-15, "moments of the two densities"),
    ("-noise_levels full -tau 3 -delta 0.281 -noise_deviation 0.42 -quantities noise_law", "E_X2", 0.17457228, 1e-7,
     "birth-death chain that jumps inwards at the rate Lambda from its ends"),
    (WHITE + "-tau 1e-5 -delta 39.528470752104745 -accuracy 1e-2", "S_0", 9.9999, 1e-5,
     "white noise, 10/mu^4, with its first correction"),
    (WHITE + "-tau 1e-5 -delta 39.528470752104745 -accuracy 1e-3", "S_0", 9.9999, 1e-5, "the same"),
    (WHITE + "-tau 1e-4 -delta 12.5 -accuracy 1e-3", "S_0", 9.99939, 1e-6, "the same"),
    (noise("pulses100.csv") + "-mu_s 0.5 -mu_d 0.5 -drag none -quantities spectrum -accuracy 1e-2", "S_0",
     203.593098283, 1e-9, "closed form of the fluid queue in 60 digits"),
    (noise("six_levels.csv") + SIX + "25", "S_v", 3.2550586283e-7, 1e-10, "collocation, and another code's elements"),
    (noise("six_levels.csv") + SIX + "100,25,4", "S_v", 1.283445886e-9, 1e-7, "complex solves on finer elements"),
    (noise("five_levels.csv") + "-mu_s 1.3 -mu_d 0.13 -drag_coefficient 0.3 -quantities spectrum -omega 4,0.3 "
     "-accuracy 1e-3", "S_v", 3.39391094e-4, 1e-8, "collocation"),
    (CUBIC + "-omega 50,10", "S_v", 1.031693678618e-8, 1e-9, "complex solves at degree 19"),
    ("-mu_s 1 -mu_d 0.5 -delta 0.25 -quantities spectrum -omega 1e3,1", "S_v", 1.882297346e-12, 1e-7,
     "the same at -accuracy 1e-8, waves on two levels alike"),
    # By other discretisations, which agree to 12 digits; the last by exact rational arithmetic of the static chain.
    *((f"-mu_d {mu_d} -delta {delta} -accuracy 1e-10 -quantities sticking,moments", key, value, 2e-9, "another program")
      for mu_d, delta, values in (
          (0.25, 0.5, {"P_stick": 0.289297540641, "E_V2": 0.288358457137, "mean_excursion": 4.7812073925}),
          (0.25, 0.125, {"P_stick": 0.156486168586, "E_V2": 0.306452606532, "mean_excursion": 3.7767781834}),
          (0.25, 0.03125, {"P_stick": 0.1291435895, "E_V2": 0.3090088885, "mean_excursion": 3.57029236}),
          (1, 0.125, {"P_stick": 0.52607882989, "E_V2": 0.04951670286}))
      for key, value in values.items()),
    *(("-mu_s 6 -mu_d 0.25 -delta 0.25 -accuracy 1e-10 -quantities sticking", key, value, 2e-9, "static chain")
      for key, value in (("P_slide", 8.13129791773e-9), ("mean_slide", 4.96357308), ("mean_stick", 6.1042813677e8))),
    ("-mu_d 0.25 -delta 0.25 -drag none -accuracy 1e-10", "E_V2", 29.5037230587, 2e-9, "fluid queue"),
    ("-delta 0.25 -drag none -accuracy 1e-10 -quantities entry_law", "f_stick_0", 0.308665061, 2e-9, "fluid queue"),
    *((f"-mu_d 0.5 -delta 0.25 -friction stribeck -stribeck_velocity {v} -accuracy 1e-9 -quantities sticking,moments",
       key, value, 2e-10, "elements of degree 24 in other code") for v, values in (
           (0.1, (0.42027641456, 1.19379291929, 0.15566674581, 0.22351933315)),
           (0.02, (0.34589070474, 1.65983452192, 0.17162127108, 0.25442017700)))
      for key, value in zip(("P_stick", "mean_slide", "E_V2", "E_absV"), values)),
    *((f"-mu_d 0.5 -delta 0.25 -accuracy 1e-8 -quantities averages -observable {f}", f"pi({f})", value, 1e-11, "other elements")
      for f, value in (("abs(v)>0.5", 0.198608934333), ("min(abs(v),0.5)", 0.202385358765))),
    # P_stick = (mu_d - g)/(mu_d + a - g) whatever the rate; with linear drag E[V] is mean force less friction.
    (PUSHED + "-drag none", "P_stick", 1 / 6, 1e-11, "closed form"),
    (PUSHED + "-drag none", "mean_slide", 5, 1e-11, "closed form"),
    (PUSHED + "-drag none -route fluid_queue", "mean_slide", 5, 1e-11, "closed form"),
    *((PUSHED + f"-accuracy 1e-8 -route {route}", "E_V", 0.25, 1e-7, "closed form") for route in ("lambda", "null_vector")),
]

# Command line, exit status, what is said.
SAID = [
    ("-mu_s 20 -mu_d 20 -bias 1 -noise_deviation 0.5 -tau 0.01 -delta 0.05 -drag none", 2,
     ("-mu_s = 20", "never slides", "P_stick = 1", "below 11")),
    (NEVER_STICKS + "-quantities sticking,moments,slip", 2, ("-mu_s = 1", "never sticks", "sticking and slip")),
    (NEVER_STICKS + "-quantities moments -route monte_carlo", 2, ("-route = monte_carlo", "never sticks")),
    ("-quantities averages -observable stick*x;foo(v);v^2;x+", 2, ("foo(v): Unexpected", "x+: Unexpected")),
    (noise("record.csv"), 2, ("not a CSV file of levels", "docs/recorded_forces.md")),
    ("-mu_d 0 -drag none", 2, ("-mu_d = 0", "nothing that slows")),
    ("-speed_limit 1 -v_max 1 -drag none", 2, ("-speed_limit = 1", "-v_max")),
]


class Cases(running.Case):
    def test_values(self):
        results = {}  # of each line once
        for line, key, value, precision, source in RIGHT:
            with self.subTest(line=line, key=key, source=source):
                if line not in results:
                    results[line] = self.summary(*line.split())["results"]
                found = results[line][key]
                at, error = (x[0] if isinstance(x, list) else x for x in (found["value"], found["error"]))
                self.assertLessEqual(abs(at - value), error + precision * abs(value), f"{at} instead of {value}")

    def test_messages(self):
        for line, status, parts in SAID:
            with self.subTest(line=line):
                said = self.run_ok(*line.split(), status=status).stderr
                for part in parts:
                    self.assertIn(part, said)


if __name__ == "__main__":
    unittest.main()
