"""Every solution method for the stationary numbers, on the same discretisations, in one table.

usage: python3 validation/routes/run.py [--quick] [--program build/stickslip]

Prints the table, then each claim of README.md with its verdict; exit status 1 if one fails.
--quick takes delta = 1/2 alone: on finer grids the search for lambda takes long.
"""

import itertools
import math
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from harness import Program, Report, difference, parser

KEYS = ("P_stick", "E_V2", "P_X_le_mu_s")
OBSERVABLES = "stick;v^2;|x|<=mu_s"
ROUTES = ("excursion", "lambda", "hitting", "resolvent", "null_vector")


def numbers_by(program, route, scene):
    """KEYS by one method: value and the error that the method itself states, and the solver's seconds."""
    if route == "resolvent":
        found = program.run(quantities="resolvent", observable=OBSERVABLES, **{"lambda": 0}, **scene)
        names = [f"pi({f})" for f in OBSERVABLES.split(";")]
        values = {key: found["results"][name]["value"][0] for key, name in zip(KEYS, names)}
    else:
        asked = "sticking" if route == "hitting" else "sticking,moments,noise_law"
        found = program.run(quantities=asked, route=route, **scene)
        values = {key: found["results"][key]["value"] for key in KEYS if key in found["results"]}
    step = found["cost"]["steps"][-1]
    return values, step.get("checks", {}), step["seconds"]


def binomial(delta, tau=1, mu_s=1):
    """P(|X| <= mu_s) of the full chain: x = delta (B - N), B binomial of 2N trials."""
    n, k = round(2 / (tau * delta**2)), round(mu_s / delta)
    return sum(math.comb(2 * n, n + i) for i in range(-k, k + 1)) / 4**n


def common_table(program, report, runs, tolerance, routes, claim):
    """Prints one row per method for each scene and discretisation; claims that all agree with the first one."""
    worst, worst_lambda, ratio = 0.0, 0.0, 0.0
    mass, negative, binomial_error = 0.0, 0.0, 0.0
    for (delta, mu_d), chosen in runs:
        scene = {"delta": delta, "mu_d": mu_d, "noise_levels": "full", "accuracy": 1e-9, **chosen}
        rows = {route: numbers_by(program, route, scene) for route in routes}
        reference, _, seconds = rows["excursion"]
        label = " ".join(f"{name} = {value}" for name, value in chosen.items() if name != "scheme")
        print(f"\ndelta = {delta:g}  mu_d = {mu_d:g}  {chosen['scheme']}  {label}")
        for route, (values, checks, _) in rows.items():
            cells = "  ".join(f"{values[key]:.15f}" if key in values else " " * 17 for key in KEYS)
            print(f"  {route:<12}{cells}")
            apart = max(difference(values[key], reference[key]) for key in values)
            if route == "lambda":
                worst_lambda = max(worst_lambda, apart / max(checks["largest_relative_bias"], 1e-11))
            else:
                worst = max(worst, apart)
            if "P_X_le_mu_s" in values and route != "lambda":
                binomial_error = max(binomial_error,
                                     difference(values["P_X_le_mu_s"], binomial(delta)))
        if "null_vector" in rows:
            checks = rows["null_vector"][1]
            mass = max(mass, checks["norm_pi_M_over_norm_M"])
            negative = max(negative, -checks["most_negative_pi"])
            if seconds > 0.05:  # less is timer noise
                ratio = max(ratio, rows["null_vector"][2] / seconds)
    print()
    report.claim(f"{claim}: methods agree, relative", worst, tolerance)
    report.claim(f"{claim}: lambda differs by its own bias, times", worst_lambda, 2)
    report.claim(f"{claim}: P_X_le_mu_s is the binomial sum, relative", binomial_error, 1e-10)
    if "null_vector" in routes:
        report.claim(f"{claim}: ||pi M|| / ||M||", mass, 1e-10)
        report.claim(f"{claim}: most negative entry of pi", negative, 1e-15)
        print(f"{claim}: seconds of null_vector over those of excursion, at most {ratio:.1f}")


def first_order_values(program, report, quick):
    """P_stick of the paper's scheme and method at lambda = 1e-6, also by a script of its own."""
    worst = 0.0
    for delta, points, value in ((1 / 2, 64, 0.29655524), (1 / 2, 512, 0.29022545),
                                 (1 / 4, 64, 0.2030130), (1 / 4, 256, 0.198250)):
        if quick and delta < 1 / 2 and points > 64:
            continue
        scene = {"delta": delta, "mu_d": 0.25, "noise_levels": "full", "scheme": "upwind",
                 "p": points, "quantities": "sticking"}
        found = program.run(route="lambda", **{"lambda": 1e-6}, **scene)["results"]["P_stick"]
        limit = program.run(**scene)["results"]["P_stick"]
        print(f"  delta = {delta:g}  p = {points:<4} lambda = 1e-6: {found['value']:.10f}"
              f"  lambda -> 0: {limit['value']:.10f}  other code {value}")
        digits = len(repr(value).split(".")[1])
        worst = max(worst, abs(found["value"] - value) / (5e-8 + 0.5 * 10.0**-digits))
    report.claim("upwind P_stick at lambda = 1e-6 against another code, in units of its rounding",
                 worst, 1)


def fluid_queue(program, report):
    """b = 0: the queue against known digits."""
    worst = 0.0
    for (delta, mu_d), digits in {
            (1 / 2, 1): (0.493915875516, 0.543424039081, None),
            (1 / 4, 1): (0.453441658945, 0.566213687113, 0.308665061),
            (1 / 4, 1 / 4): (0.0444301477306, 29.5037230587, None)}.items():
        found = program.run(delta=delta, mu_d=mu_d, drag="none", noise_levels="full", accuracy=1e-10,
                            quantities="sticking,moments,entry_law", route="fluid_queue")["results"]
        for key, value in zip(("P_stick", "E_V2", "f_stick_0"), digits):
            if value:
                print(f"  delta = {delta:g}  mu_d = {mu_d:g}  {key} {found[key]['value']:.13g}")
                last = 0.5 * 10.0 ** -(len(repr(value).split(".")[1]))
                worst = max(worst, abs(found[key]["value"] - value) / (2 * last))
    report.claim("fluid queue against known digits, in units of the last one", worst, 1)


def main():
    arguments = parser(__doc__).parse_args()
    program, report = Program(arguments.program), Report()
    points = {1 / 2: (16, 64)} if arguments.quick else dict.fromkeys((1 / 2, 1 / 4, 1 / 8), (16, 64, 256))
    scenes = list(itertools.product(points, (1 / 4, 1)))
    upwind = [(scene, {"scheme": "upwind", "p": p}) for scene in scenes for p in points[scene[0]]]
    common_table(program, report, upwind, 1e-9, ROUTES, "upwind")
    on_hp = [(scene, {"scheme": "hp", "degree": 9}) for scene in scenes]
    common_table(program, report, on_hp, 1e-10, ROUTES[:4], "hp")
    print("\nThe paper's scheme")
    first_order_values(program, report, arguments.quick)
    print("\nWithout drag")
    fluid_queue(program, report)
    sys.exit(1 if report.failed else 0)


main()
