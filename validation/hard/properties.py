"""What must hold in a case. Each property yields (words, deviation, allowed, size) for what it compares;
`allowed` is what the program's own error estimates leave, times FACTOR, unless said otherwise, and
where both sides share the discretisation no more than rounding."""

import decimal
import fractions
import json
import math
import pathlib

from entry import spread
from harness import Program
from reference_arguments import words
from scenes import BASE

FACTOR = 10  # an estimate is no bound: it covers the error in 97 of 100 cases (docs/accuracy.md)
ON_ANY_GRID = 1e-11  # relative: identities that every discretisation keeps
UNDERSHOOT = 1e-4  # of the total probability: entries of coarse discretisations below zero
METHODS_AGREE = 1e-9  # relative: solution methods on one discretisation
LAMBDA_BIAS = 1e-7  # relative: of lambda u at the lambda that the program takes, with room
REFERENCE = pathlib.Path(__file__).resolve().parent / "reference" / "values.json"
Decimal = decimal.Decimal
decimal.getcontext().prec = 60
decimal.getcontext().Emin, decimal.getcontext().Emax = -10**6, 10**6


class Found:
    """A case and what the program prints about it."""

    def __init__(self, entry, scene):
        self.entry, self.scene = entry, scene
        self.options = {**BASE, **scene.options, "quantities": scene.quantities}
        if "degree" in scene.options or "p" in scene.options:
            del self.options["accuracy"]
        self.summary = entry.run(**self.options)
        self.results, self.used = self.summary["results"], self.summary["scene"]
        self.symmetric = "bias" not in self.options and self.options.get("drag") != "expression"

    def seconds(self):
        return self.summary["cost"]["seconds"]

    def again(self, **changes):
        """The same case with other options; None takes one away."""
        options = {**self.options, **changes}
        return self.entry.run(**{k: v for k, v in options.items() if v is not None})["results"]

    def number(self, key):
        found = self.results[key]
        return found["value"], found["error"]

    def column(self, key):
        """(argument, value, error) of an array."""
        found = self.results[key]
        argument = next(name for name in ("k", "lambda", "omega", "time") if name in found)
        return list(zip(found[argument], found["value"], found["error"]))

    def exact(self):
        """The noise chain in 60 digits: N, rate, probability of going up, first and last static level."""
        tau, delta = Decimal(self.used["tau"]), Decimal(self.used["delta"])
        n, bias = self.used["noise_levels_meant"], self.used["bias"]
        slack = fractions.Fraction(1, 10**14)
        last = [math.floor((fractions.Fraction(self.used["mu_s"]) - s * fractions.Fraction(bias)) /
                           fractions.Fraction(self.used["delta"]) + slack) for s in (1, -1)]

        def up(i):
            return Decimal(0 if i == n else 1) if abs(i) == n else (1 - tau * delta**2 * i / 2) / 2
        return n, 2 / (tau * delta) ** 2, up, -last[1], last[0]


def same(words, one, other, most=math.inf):
    """(value, error) twice; relative deviations beyond `most` are not allowed whatever the errors are."""
    size = abs(other[0])
    return words, abs(one[0] - other[0]), min(FACTOR * (one[1] + other[1]), most * size), size


def identity(words, apart, error, size):
    """What every discretisation keeps."""
    return words, apart, min(FACTOR * error, ON_ANY_GRID * abs(size)), size


def power(f):
    """E[(X + g) V] = E[F |V|] - E[b(V) V]."""
    linear = f.used["drag_coefficient"] if f.used["drag"] == "linear" else 0
    terms = [(1, *f.number("E_XV")), (f.used["bias"], *f.number("E_V")),
             (-linear, *f.number("E_V2"))]
    terms += ([(-1, *f.number("friction_power"))] if "friction" in f.used else
              [(-f.used["mu_d"], *f.number("E_absV"))])
    yield identity("power", abs(math.fsum(c * v for c, v, _ in terms)),
                   sum(abs(c) * e for c, _, e in terms), f.number("E_XV")[0])


def probability(f):
    """Shares add up to one, and are those of mean durations."""
    (stick, a), (slide, b) = f.number("P_stick"), f.number("P_slide")
    yield identity("P_stick + P_slide = 1", abs(stick + slide - 1), a + b, 1)
    (mean_stick, c), (mean_slide, d), (whole, e) = map(f.number, ("mean_stick", "mean_slide", "mean_excursion"))
    yield identity("means add up", abs(mean_stick + mean_slide - whole), c + d + e, whole)
    yield identity("P_slide = slide/excursion", abs(slide - mean_slide / whole),
                   b + d / whole + e * slide / whole, slide)


def noise(f):
    """The distribution of the noise by detailed balance; bodies slide at least while it is above mu_s."""
    n, _, up, lo, hi = f.exact()
    weights = {0: Decimal(1)}
    for i in range(n):
        weights[i + 1] = weights[i] * up(i) / (1 - up(i + 1))
        weights[-i - 1] = weights[-i] * (1 - up(-i)) / up(-i - 1)
    total = sum(weights.values())
    if f.symmetric:
        outside = sum(w for i, w in weights.items() if not lo <= i <= hi) / total
        yield same("P(|X| <= mu_s)", f.number("P_X_le_mu_s"), (float(1 - outside), 0), ON_ANY_GRID)
        slide, error = f.number("P_slide")
        yield identity("P_slide >= P(|X| > mu_s)", max(0.0, float(outside) - slide), error, slide)
    square = sum(w * i * i for i, w in weights.items()) / total * Decimal(f.used["delta"]) ** 2
    yield same("E[X^2]", f.number("E_X2"), (float(square), 0), ON_ANY_GRID)


def entry(f):
    """The hitting distribution at the onset of sticking: sum, sign, and
    f_stick(0+) = Lambda (alpha_k P_k + (1 - alpha_-k) P_-k)."""
    entries = f.column("entry_law")
    yield identity("hitting distribution sums to 1", abs(math.fsum(v for _, v, _ in entries) - 1),
                   sum(e for _, _, e in entries), 1)
    errors = [e for _, _, e in entries]
    for n, (k, v, _) in enumerate(entries):
        # The change between discretisations has its own zeros: there the neighbours show the error.
        near = max(errors[max(0, n - 1):n + 2])
        yield f"entry_law({k:g}) >= 0", max(0.0, -v), min(FACTOR * near, UNDERSHOOT), 1
    _, rate, up, lo, hi = f.exact()
    last, first = float(rate * up(hi)), float(rate * (1 - up(lo)))
    value, error = f.number("f_stick_0")
    yield identity("f_stick(0+)", abs(value - last * entries[-1][1] - first * entries[0][1]),
                   error + last * entries[-1][2] + first * entries[0][2], value)


def sticking_times(f):
    """Mean sticking times by first level. Gaussian elimination loses as many digits as their decades: 400
    are enough."""
    with decimal.localcontext() as context:
        context.prec = 400
        return eliminated(*f.exact()[1:])


def eliminated(rate, up, lo, hi):
    ratio, start = [], []  # T_i = ratio T_{i+1} + start
    for i in range(lo, hi + 1):
        down = (1 - up(i)) if i > lo else Decimal(0)
        pivot = 1 - down * (ratio[-1] if ratio else 0)
        start.append((1 / rate + down * (start[-1] if start else 0)) / pivot)
        ratio.append(up(i) / pivot)
    times = [Decimal(0)]
    for r, s in zip(reversed(ratio), reversed(start)):
        times.append(r * times[-1] + s)
    return times[:0:-1]


def sticking(f):
    """The mean sticking time from the hitting distribution and exact means by level."""
    times, entries = sticking_times(f), f.column("entry_law")
    mean = sum(Decimal(v) * t for (_, v, _), t in zip(entries, times))
    error = sum(Decimal(e) * t for (_, _, e), t in zip(entries, times))
    yield same("mean sticking time by exact means", f.number("mean_stick"), (float(mean), float(error)),
               ON_ANY_GRID)


def stored():
    return json.loads(REFERENCE.read_text())


def reference(f):
    """Every value of reference/values.json that was asked for, against the estimate alone. Entries of a
    hitting distribution are right to an absolute error (docs/accuracy.md): the largest is their size."""
    entry_of_scene = stored().get(f.scene.name, {"arguments": "", "values": {}})
    if entry_of_scene["arguments"] != words(f.scene):
        yield "no reference of these options: run reference/make.py --missing", math.inf, 0, 1
    for key, known in entry_of_scene["values"].items():
        name, _, argument = key.partition(":")
        if name not in f.results or known["digits"] < 17:
            continue
        if argument:
            _, value, error = next(row for row in f.column(name) if row[0] == float(argument))
        else:
            value, error = f.number(name)
        size = (max(v for _, v, _ in f.column(name)) if name == "entry_law"
                else abs(float(known["value"])))
        yield key, float(abs(Decimal(value) - Decimal(known["value"]))), FACTOR * error, size


def by_hand(f):
    """Three levels: sticking times are exponential with rate 1/2, whatever else happens."""
    for key, value in (("mean_stick", 2), ("f_stick_0", 0.5)):
        yield same(key, f.number(key), (value, 0))


SHARED = ("P_stick", "P_slide", "E_V2", "E_absV", "E_XV", "f_stick_0", "mean_slide", "mean_stick")


def compared(f, other, keys=SHARED, factors=None, most=math.inf):
    for key in keys:
        if key in f.results and key in other:
            factor = (factors or {}).get(key, 1)
            yield same(key, f.number(key), (other[key]["value"] * factor, other[key]["error"] * factor),
                       most)


def null_vector(f):
    """By SLEPc, on both signs of v."""
    yield from compared(f, f.again(route="null_vector", quantities="sticking,moments"),
                        most=METHODS_AGREE)


def lambda_route(f):
    """lambda u_lambda of the full grid, at the lambda that the program takes; with its bias."""
    yield from compared(f, f.again(route="lambda", quantities="sticking,moments"), most=LAMBDA_BIAS)


def hitting(f):
    """R^, R-check and R."""
    yield from compared(f, f.again(route="hitting", quantities="sticking"), most=METHODS_AGREE)


def fluid_queue(f):
    """No grid in v at all."""
    yield from compared(f, f.again(route="fluid_queue", quantities="sticking,moments,entry_law",
                                   noise_levels="full"))


def monte_carlo(f):
    """Simulated excursions; 4 standard deviations are allowed."""
    simulated = f.again(route="monte_carlo", quantities="sticking,moments", excursions=200000,
                        accuracy=None)
    for key in ("P_stick", "E_V2", "E_XV", "mean_slide", "mean_stick"):
        value, error = f.number(key)
        yield (key, abs(value - simulated[key]["value"]), 4 * spread(value, error, simulated[key]),
               value)


def scaled(f):
    """The same case in units in which tau is 1: forces by sqrt(tau), drag by 1/tau."""
    tau = f.options["tau"]
    root = math.sqrt(tau)
    other = f.again(tau=1, **{key: f.options[key] * root for key in ("mu_s", "mu_d", "delta")},
                    drag_coefficient=f.options.get("drag_coefficient", 1) * tau)
    factors = {"E_V2": tau, "E_absV": root, "f_stick_0": 1 / tau, "mean_slide": tau, "mean_stick": tau}
    yield from compared(f, other, factors=factors)


def neighbour(f):
    """Within 1e-9 of the case with mu_d on the grid: nothing depends on the side."""
    other = f.again(mu_d=round(f.options["mu_d"], 9))
    for what, apart, allowed, value in compared(f, other):
        yield what, apart, allowed + 1e-9 * value, value


def as_if_plain(f):
    """The case without the small number."""
    other = f.again(**({"bias": 0} if "bias" in f.options else {"mu_s": round(f.options["mu_s"], 9)}))
    yield from compared(f, other)


def near_no_drag(f):
    """Drag changes E[V^2] by about c E[V^2] times the time of relaxation: 1e-3 allowed."""
    other = f.again(drag="none", drag_coefficient=None)
    for what, apart, _, value in compared(f, other):
        yield what, apart, 1e-3 * value, value


def finer(f):
    """A run to two more digits."""
    yield from compared(f, f.again(accuracy=1e-2 * f.options["accuracy"]))


def transforms(f):
    """F(0) = 1, bounds, order, log-convexity, both ends in lambda."""
    _, rate, _, _, _ = f.exact()
    columns = {name: f.column(name) for name in ("F_slide", "F_stick", "F_excursion")}
    means = dict(zip(columns, ("mean_slide", "mean_stick", "mean_excursion")))
    variances = dict(zip(columns, ("var_slide", "var_stick", "var_excursion")))
    for name, rows in columns.items():
        (mean, off), variance = f.number(means[name]), f.number(variances[name])[0]
        yield f"{name}(0) = 1", abs(rows[0][1] - 1), FACTOR * rows[0][2], 1
        for (a, x, e), (b, y, d) in zip(rows, rows[1:]):
            yield f"{name} falls at {b:g}", max(0.0, y - x), FACTOR * (e + d), x
            bound = math.exp(-b * mean) if b * mean < 700 else 0.0
            yield (f"{name}({b:g}) >= exp(-lambda mean)", max(0.0, bound - y),
                   FACTOR * d + bound * b * off, max(bound, y))
        for (a, x, e), (b, y, d), (c, z, g) in zip(rows, rows[1:], rows[2:]):
            if z > 0:
                theta = (c - b) / (c - a)
                bound = x**theta * z ** (1 - theta)
                spread = bound * (theta * e / x + (1 - theta) * g / z)
                yield f"{name} log-convex at {b:g}", max(0.0, y - bound), FACTOR * (d + spread), bound
        for b, y, d in rows:
            if not 1e-11 < b * mean < 1e-3:  # below, 1 - F is rounding; above, a term is missing
                continue
            yield (f"(1 - {name})/lambda at {b:g}", abs(1 - y - b * mean),
                   FACTOR * (d + b * off) + b * b * (variance + mean**2), max(b * mean, 1e-300))
    for (b, x, e), (_, y, d), (_, z, g) in zip(*columns.values()):
        yield f"F_excursion <= F_slide at {b:g}", max(0.0, z - x), FACTOR * (e + g), x or 1
        yield f"F_excursion <= F_stick at {b:g}", max(0.0, z - y), FACTOR * (d + g), y or 1
    start, error = f.number("f_stick_0")
    b, y, d = columns["F_stick"][-1]
    if b > 1e3 * float(rate):
        yield (f"lambda F_stick at {b:g} = f_stick(0+)", abs(b * y - start),
               FACTOR * (b * d + error + start * float(rate) / b), start)


def resolvent(f):
    """h+ + h- + lambda w(1) = 1 at every lambda; pi is the stationary average for lambda -> 0."""
    columns = zip(*(f.column(name) for name in ("h_plus", "h_minus", "w_one")))
    for (b, x, e), (_, y, d), (_, z, g) in columns:
        yield f"h+ + h- + lambda w(1) at {b:g}", abs(x + y + b * z - 1), FACTOR * (e + d + b * g), 1
    yield same("pi(stick) at 1e-14", f.column("pi(stick)")[0][1:], f.number("P_stick"))
    for (b, u, e), (_, p, d), (_, m, g) in zip(*(f.column(f"{name}(stick)") for name in ("u", "pi", "mu"))):
        yield f"u = pi/lambda + mu at {b:g}", abs(b * u - p - b * m), FACTOR * (b * e + d + b * g), p


def spectrum(f):
    """Positive, flat at 0, of area E[V^2], and falling as omega^-4: V' jumps."""
    rows = f.column("S_v")
    for omega, value, error in rows:
        yield f"S_v({omega:g}) > 0", max(0.0, -value), 0, 1
    yield same("S_v(1e-12) = S_v(0)", rows[1][1:], rows[0][1:])
    yield same("S_0 = S_v(0)", f.number("S_0"), rows[0][1:])
    yield same("area", f.number("variance_from_spectrum"), f.number("E_V2"))
    (a, x, e), (b, y, d) = rows[-2:]
    if a < 1e6:
        return
    # The next term is smaller by (rates of the process / omega)^2 or, with waves, a power less.
    yield (f"omega^4 S_v at {b:g}", abs(y * b**4 - x * a**4),
           FACTOR * (e * a**4 + d * b**4) + 1e-6 * x * a**4, x * a**4)


def direct(f):
    """One complex factorisation for each frequency, by the build with complex scalars."""
    complex_program = f.entry.program.path.with_name("stickslip-complex")
    found = Program(complex_program).run(**{**f.options, "quantities": "spectrum", "spectrum_solver": "direct"})
    if not found["accuracy"]["reached"]:
        raise ValueError(found["accuracy"]["shortfall"])
    other = found["results"]["S_v"]
    for (omega, value, error), x, e in zip(f.column("S_v"), other["value"], other["error"]):
        yield same(f"S_v({omega:g})", (value, error), (x, e))


PROPERTIES = {f.__name__: f for f in (
    power, probability, noise, entry, sticking, reference, by_hand, null_vector, lambda_route, hitting,
    fluid_queue, monte_carlo, scaled, neighbour, near_no_drag, finer, transforms, resolvent, spectrum, direct)}
PROPERTIES["same"] = as_if_plain
BALANCES = ("power", "probability", "noise", "entry", "sticking")
