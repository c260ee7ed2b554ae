"""Spectrum of the velocity against references.

usage: python3 validation/dynamics/run.py [--quick] [--program build/stickslip]
                                          [--complex-program build/stickslip-complex]

Prints the tables, then each claim of README.md with its verdict; exit status 1 if one fails.
--quick takes fewer cases and frequencies (half a minute instead of half an hour).
"""

import cmath
import itertools
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
import known
from harness import ROOT, Program, Report, difference, last_place, parser, worse
from stickslip import BadInput


class Variance:
    """E[V^2] twice, from every spectrum that is computed on the way."""

    def __init__(self):
        self.deviation, self.relative, self.runs = 0.0, 0.0, 0
        self.asked = 0.0  # relative difference over the accuracy asked for

    def spectrum(self, program, **scene):
        """A run with the reduced model; S_v and all that belongs to it."""
        found = program.run(quantities="spectrum,moments", **scene)
        one, other = (found["results"][key] for key in ("variance_from_spectrum", "E_V2"))
        apart = abs(one["value"] - other["value"])
        self.deviation = worse(self.deviation, apart / (one["error"] + other["error"]))
        self.relative = worse(self.relative, apart / other["value"])
        asked = found["accuracy"]["asked"]
        self.asked = worse(self.asked, apart / other["value"] / asked)
        self.runs += 1
        return found

    def claim(self, report):
        print(f"\nE[V^2] and the integral of S_v, {self.runs} spectra: "
              f"relative difference at most {self.relative:.1e}")
        report.claim("variance_from_spectrum is E_V2, in units of the errors stated",
                     self.deviation, 1)
        report.claim("variance_from_spectrum is E_V2, in units of the accuracy asked for",
                     self.asked, 1)


def direct(program, **scene):
    return program.run(quantities="spectrum", spectrum_solver="direct", **scene)


def known_spectrum(programs, report, variance):
    """S_v at four frequencies by both solvers, digits of another code."""
    print("S_v at omega = 0, 0.1, 1, 10; mu_d = 1/4, mu_s = tau = 1")
    worst = 0.0
    for delta, digits in known.S_V.items():
        scene = {"mu_d": 0.25, "delta": delta, "omega": "0,0.1,1,10", "accuracy": 1e-9}
        by = {"krylov": variance.spectrum(programs["real"], **scene),
              "direct": direct(programs["complex"], **scene)}
        print(f"  delta = {delta:<5g} other code " + "".join(f"{d:>20}" for d in digits))
        for solver, found in by.items():
            values = found["results"]["S_v"]["value"]
            print(f"  {'':<13} {solver:<10} " + "".join(f"{v:20.14g}" for v in values))
            worst = worse(worst, *(abs(v - float(d)) / last_place(d)
                                   for v, d in zip(values, digits)))
    report.claim("S_v against known digits, in units of the last one", worst, 0.6)


def collocation_spectrum(programs, report, variance, quick):
    """S_v without the discretisation that the solvers share, where the noise has five levels: digits of a dense
    Chebyshev collocation with one polynomial of degree 100 in v."""
    low = {0: "0.919664537054", 1: "0.239211472608", 10: "1.51479449146e-4"}
    high = {30: "1.91750941314e-6", 50: "2.4895403e-7"}
    print("\nS_v at delta = tau = 1, mu_d = 1/4\n  omega        collocation  "
          f"{'krylov':>20}{'direct':>20}")
    for name, digits in (("omega <= 10", low),) if quick else (("omega <= 10", low),
                                                                ("omega = 30, 50", high)):
        scene = {"mu_d": 0.25, "delta": 1, "omega": ",".join(map(str, digits)), "accuracy": 1e-9}
        by = {"krylov": variance.spectrum(programs["real"], **scene),
              "direct": direct(programs["complex"], **scene)}
        values = {solver: found["results"]["S_v"]["value"] for solver, found in by.items()}
        for row in zip(digits, digits.values(), *values.values()):
            print("  {:<5g}  {:>17}  {:20.14g}{:20.14g}".format(*row))
        for solver in by:
            report.claim(f"{solver} against collocation, {name}, relative", worse(*(
                difference(v, float(d)) for v, d in zip(values[solver], digits.values()))), 1e-7)


def last_seconds(found):
    return found["cost"]["steps"][-1]["seconds"]


def compared(programs, variance, scene):
    """The reduced model, S_v of direct solves on finer elements, and the seconds of each solver on
    the last discretisation of the reduced model."""
    krylov = variance.spectrum(programs["real"], **scene)
    step = krylov["cost"]["steps"][-1]
    same = {name: step[name] for name in ("degree", "layers", "noise_levels", "v_max")}
    finer = same | {"degree": min(16, step["degree"] + 4), "layers": step["layers"] + 2}
    slow = last_seconds(direct(programs["complex"], **scene, **same))
    again = variance.spectrum(programs["real"], **scene)  # short runs: the better of two
    reference = direct(programs["complex"], **scene, **finer)["results"]["S_v"]["value"]
    return krylov, reference, min(last_seconds(krylov), last_seconds(again)), slow


def solvers(programs, report, variance, quick):
    """The reduced model against one complex factorisation for each frequency."""
    steps = (1, 1 / 2, 1 / 4)
    scenes = list(itertools.product((1 / 4, 1 / 2, 1), steps, steps))
    count = 200
    if quick:
        scenes, count = [(1 / 4, 1 / 4, 1), (1 / 2, 1 / 2, 1 / 2), (1, 1, 1 / 4)], 40
    print(f"\nkrylov and direct at {count} frequencies from 1e-3 to 50; mu_s = 1\n"
          "  mu_d  delta   tau  unknowns  pairs    krylov s    direct s  ratio  largest difference")
    worst, ratio = dict.fromkeys(steps, 0.0), float("inf")
    for mu_d, delta, tau in scenes:
        scene = {"mu_d": mu_d, "delta": delta, "tau": tau, "omega": f"1e-3:50:{count}:log",
                 "accuracy": 1e-7}
        row = f"  {mu_d:<5g} {delta:<5g} {tau:>5g}"
        try:
            krylov, reference, fast, slow = compared(programs, variance, scene)
        except BadInput as message:
            print(f"{row}  left out: {str(message).splitlines()[0]}")
            continue
        apart = worse(*map(difference, krylov["results"]["S_v"]["value"], reference))
        worst[delta] = worse(worst[delta], apart)
        if delta == 1 / 4:
            ratio = min(ratio, slow / fast)
        step = krylov["cost"]["steps"][-1]
        print(f"{row}  {step['unknowns']:>8}  {step['checks']['krylov_pairs']:>5.0f}  {fast:10.3f}"
              f"  {slow:10.3f}  {slow / fast:5.0f}  {apart:.1e}"
              + ("" if krylov["accuracy"]["reached"] else "  accuracy not reached"), flush=True)
    for delta, largest in worst.items():
        report.claim(f"krylov at -accuracy 1e-7 against direct on finer elements, delta = {delta:g}, "
                     "relative", largest, 1e-7)
    if not quick:
        report.at_least("seconds of direct over those of krylov, same discretisation, delta = 1/4",
                        ratio, 100)


def white_noise_spectrum(omega, mu):
    """S_v of dV = -mu sign(V) dt + sqrt(2) dW."""
    if omega == 0:
        return 10 / mu**4
    r = (mu - cmath.sqrt(mu**2 + 4j * omega)) / 2
    bracket = 2 / (1j * omega * mu**3) + (mu / omega**2) * (1 / mu**2 - 1 / (mu - r) ** 2)
    return 2 * (mu * bracket).real


def towards_white_noise(program, variance, drag, delta, frequencies):
    """Columns of S_v, one for each frequency, and of t_corr for falling tau."""
    rows, times = [], []
    for tau in (1 / 8, 1 / 32, 1 / 128):
        found = variance.spectrum(program, mu_d=1, drag=drag, tau=tau, delta=delta,
                                  omega=",".join(map(str, frequencies)))["results"]
        rows.append(found["S_v"]["value"])
        times.append(found["t_corr"]["value"])
        print(f"  {drag:<7} {delta:<5g}  1/{1 / tau:<4.0f} {times[-1]:.8f}"
              + "".join(f"  {v:10.7f}" for v in rows[-1]), flush=True)
    return list(zip(*rows)), times


def slowest_fall(sequences):
    """The largest quotient of neighbours."""
    return worse(*(b / a for sequence in sequences for a, b in itertools.pairwise(sequence)))


def white_noise(programs, report, variance, quick):
    """tau -> 0 at mu_d = mu_s = 1, with and without drag."""
    limits = {"none": ({w: white_noise_spectrum(w, 1) for w in (0, 0.5, 1, 3)},
                       known.T_CORR["none"]),
              "linear": ({0: 0.466391682733}, known.T_CORR["linear"])}
    deltas = (1,) if quick else (1 / 2, 1 / 4)
    print("\nTowards white noise: mu_d = mu_s = 1\n  drag    delta  tau    t_corr    "
          + "".join(f"     S_v({w:g})" for w in limits["none"][0]))
    away, time_away, extrapolated, unresolved = [], [], [], []
    for drag, (limit, limit_time) in limits.items():
        by_delta = [towards_white_noise(programs["real"], variance, drag, delta, limit)
                    for delta in deltas]
        print(f"  {drag:<7} {'':<5}  {'0':<6} {limit_time:.8f}"
              + "".join(f"  {v:10.7f}" for v in limit.values()))
        columns, times = by_delta[-1]
        time_away.append([difference(t, limit_time) for t in times])
        for column, coarse, end in zip(columns, by_delta[0][0], limit.values()):
            away.append([difference(v, end) for v in column])
            extrapolated.append(difference((4 * column[-1] - column[-2]) / 3, end))
            unresolved += [abs(v - c) / abs(v - end) for v, c in zip(column, coarse)]
    report.claim("S_v: distance from the white-noise limit, over that at four times tau",
                 slowest_fall(away), 0.3)
    report.claim("S_v at tau = 1/128 from the limit, relative", worse(*(a[-1] for a in away)), 0.02)
    report.claim("S_v from tau = 1/32, 1/128 extrapolated to 0, relative",
                 worse(*extrapolated), 5e-3)
    report.claim("t_corr: distance from the limit, over that at four times tau",
                 slowest_fall(time_away), 0.7)
    report.claim("t_corr at tau = 1/128 from the limit, relative",
                 worse(*(t[-1] for t in time_away)), 3e-3)
    if not quick:
        report.claim("change of S_v from delta = 1/2 to 1/4 over the distance from the limit",
                     worse(*unresolved), 0.05)


def main():
    options = parser(__doc__)
    options.add_argument("--complex-program", type=pathlib.Path,
                         default=ROOT / "build" / "stickslip-complex")
    arguments = options.parse_args()
    programs = {"real": Program(arguments.program), "complex": Program(arguments.complex_program)}
    report, variance = Report(), Variance()
    known_spectrum(programs, report, variance)
    collocation_spectrum(programs, report, variance, arguments.quick)
    solvers(programs, report, variance, arguments.quick)
    white_noise(programs, report, variance, arguments.quick)
    variance.claim(report)
    sys.exit(1 if report.failed else 0)


main()
