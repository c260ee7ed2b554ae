"""Identities between results of one case. Each is a generator of (words, one side, other side); ask(quantities, **options)
is the answer of the program to the same case with other questions."""

import math

import numpy
from values import Value, integral

STEPS = 16  # of integrals, an even number of pairs


def grid(end, begin=0.0):
    return tuple(map(float, numpy.linspace(begin, end, STEPS + 1)))


def drag_of(options):
    """b(v) in words."""
    if options["drag"] == "none":
        return "0*v"
    if options["drag"] == "expression":
        return options["drag_expression"]
    return f"0-{options.get('drag_coefficient', 1.0)!r}*v-{options.get('drag_cubic', 0.0)!r}*v^3"


def power(ask, options, random):
    """What the noise and the bias do is what friction and drag take."""
    drag = f"({drag_of(options)})*v"
    f = ask("moments,averages", observable=drag)
    yield "E[(X + g) V]", f["E_XV"] + options.get("bias", 0.0) * f["E_V"], f["friction_power"] - f["pi(f)"]


def averages(ask, options, random):
    """Shares of time, and the law of large numbers over excursions."""
    f = ask("sticking,moments,averages,slip", observable="y==0; v; v*v; abs(v); x*v", distance=1.0)
    for text, key in (("y==0", "P_stick"), ("v", "E_V"), ("v*v", "E_V2"), ("abs(v)", "E_absV"), ("x*v", "E_XV")):
        yield f"pi({text})", f[f"pi({text})"], f[key]
    yield "P_stick + P_slide", f["P_stick"] + f["P_slide"], 1
    yield "P_stick", f["P_stick"], f["mean_stick"] / f["mean_excursion"]
    yield "slip_rate", f["slip_rate"] * f["mean_excursion"], 1
    yield "mean_slip", f["mean_slip"], f["E_absV"] * f["mean_excursion"]
    yield "mean_slip_net", f["mean_slip_net"], f["E_V"] * f["mean_excursion"]


def spectrum(ask, options, random):
    f = ask("moments,spectrum", omega=(0.0, 1.0))
    yield "area of S_v", f["variance_from_spectrum"], f["E_V2"] - f["E_V"] * f["E_V"]
    yield "S_v(0)", f["S_v"][0], f["S_0"]
    yield "2 D", 2 * f["diffusivity"], f["S_0"]


def autocovariance(ask, options, random):
    """E[x(t)] = E[V] t and Var x(t) = 2 int (t - s) C(s) ds."""
    end = random.uniform(0.5, 3)
    f = ask("moments,autocorrelation,displacement", time=grid(end), start="stationary")
    yield "C(0)", f["C_vv"][0], f["E_V2"] - f["E_V"] * f["E_V"]
    yield "E[x(t)]", f["displacement_mean"], f["E_V"] * numpy.array(grid(end))
    yield "Var x(t)", f["displacement_variance"][-1], 2 * integral((end - numpy.array(grid(end))) * f["C_vv"], end / STEPS)


def large_deviations(ask, options, random):
    """theta'(0) = E[V], theta''(0) = S_0, and theta by integration of theta'."""
    end = random.choice((-1, 1)) * 10 ** random.uniform(-1, 1.5)
    f = ask("moments,spectrum", omega=0.0)
    variance = float(f["E_V2"].value - f["E_V"].value ** 2)
    # Where V rarely changes its sign, a tilt of sqrt(Var V)/S_0 already makes it keep one.
    h = min(1e-3 * abs(end), 1e-2 * math.sqrt(variance) / float(f["S_0"].value))
    f = ask("moments,spectrum,large_deviation", tilt=grid(end) + (-2 * h, -h, h, 2 * h), omega=0.0)
    v = f["tilted_velocity"]
    yield "theta(0)", f["theta"][0], 0
    yield "theta'(0)", v[0], f["E_V"]
    yield "theta''(0)", *slope(v[-1] - v[-4], v[-2] - v[-3], h, f["S_0"])
    yield "theta", f["theta"][STEPS], integral(v[:STEPS + 1], end / STEPS)
    yield "theta is convex", at_least_zero(f["theta"][:-4], numpy.array(grid(end)), v[:-4]), 0


def slope(twice, once, h, known):
    """Differences over 4 h and 2 h for a derivative, and what it should be."""
    rough, fine = twice / (4 * h), once / (2 * h)
    return fine.within(rough.value - fine.value), known


def at_least_zero(theta, s, v):
    """By how much theta(s_j) falls below its tangent at s_i, at most; 0 of a convex function."""
    below = [theta[i] + (s[j] - s[i]) * v[i] - theta[j] for i in range(len(s)) for j in (0, i - 1, len(s) - 1)]
    return Value([max(0, float(one.value)) for one in below], [one.error for one in below])


def displacement_transform(ask, options, random):
    """The second derivative of the characteristic function at 0 is -E[x^2]."""
    end, start = random.uniform(0.5, 5), random.choice(("s+", "rest", "stationary"))
    f = ask("displacement", time=end, start=start)
    mean, square = f["displacement_mean"][0], f["displacement_variance"][0] + f["displacement_mean"][0] * f["displacement_mean"][0]
    k = 0.05 / math.sqrt(float(square.value))
    while True:
        f = ask("displacement_transform", time=end, start=start, wavenumber=(k, 2 * k))
        cosine, sine = f["displacement_cosine#0"], f["displacement_sine#0"]
        once, twice = (1 - float(cosine[n].value) for n in (0, 1))
        # Where few bodies move at all, these go much further than the root of the mean square.
        if twice > 3.9 * once or once < 1e-6:
            break
        k /= 8
    fourth = [(1 - cosine[n]) * (2 / ((n + 1) * k) ** 2) for n in (0, 1)]
    third = [sine[n] / ((n + 1) * k) for n in (0, 1)]
    yield "E[x^2] of the transform", extrapolated(*fourth), square
    yield "E[x] of the transform", extrapolated(*third), mean


def extrapolated(once, twice):
    """Of values at k and 2 k with errors of the order k^2."""
    best = (4 * once - twice) * (1 / 3)
    return best.within(0.05 * (best.value - once.value))


def of_distribution(f, density, distribution, step):
    """The integral of a density is what its distribution function rises by; that rises from 0 to 1."""
    rise = f[distribution][-1] - f[distribution][0]
    yield f"integral of {density}", integral(f[density], step), rise
    below = numpy.minimum(0, f[density].value)
    yield f"{density} >= 0", Value(below, f[density].error), 0
    inside = numpy.clip(f[distribution].value, 0, 1)
    yield f"0 <= {distribution} <= 1", f[distribution], inside


def durations(ask, options, random):
    begin = random.uniform(0.05, 1)
    step = random.uniform(0.3, 3) / STEPS
    f = ask("sticking,duration_density", time=grid(begin + step * STEPS, begin))
    for word in ("slide", "stick", "excursion"):
        yield from of_distribution(f, f"f_{word}", f"cdf_{word}", step)


def displacement_distribution(ask, options, random):
    end, start = random.uniform(1, 8), random.choice(("s+", "rest", "stationary"))
    f = ask("displacement", time=end, start=start)
    mean, deviation = float(f["displacement_mean"].value[0]), math.sqrt(max(0, float(f["displacement_variance"].value[0])))
    begin = mean + random.uniform(-1.5, 0.5) * deviation
    step = deviation / STEPS
    f = ask("displacement_distribution", time=end, start=start, accuracy=3e-2, probability=(0.25, 0.5),
            distance=grid(begin + step * STEPS, begin))
    if not begin < float(f["displacement_atom_at"].value[0]) < begin + step * STEPS or f["displacement_atom"].value[0] == 0:
        yield from of_distribution(f, "displacement_density#0", "displacement_cdf#0", step)


def transforms(ask, options, random):
    """At lambda = 0, and between transforms of phases and excursions."""
    z = 10 ** random.uniform(-1, 1)
    f = ask("sticking,laplace,resolvent", observable="y==0", **{"lambda": (0.0, z)})
    yield "F_slide(0)", f["F_slide"][0], 1
    begin = "" if "h_plus" in f.values else "_from_minus"  # no slide may begin upwards
    h = f["h_plus" + begin] + f["h_minus" + begin]
    yield "h+ + h-(0)", h[0], 1
    yield "h+ + h- + lambda w(1)", h[1] + z * f["w_one" + begin][1], 1


def first_passages(ask, options, random):
    """The mean of a passage by its transform at small lambda."""
    common = {"velocity": random.uniform(0.02, 0.2), "start": random.choice(("s+", "rest")), "passage": "both"}
    f = ask("first_passage", **common)
    mean, variance = f["first_passage_mean"][0], f["first_passage_variance"][0]
    h = 0.01 * float(mean.value / (variance.value + mean.value**2))
    f = ask("passage_transform", **common, **{"lambda": (h, 2 * h)})
    first, second = ((1 - f["F_passage#0"][n]) * (1 / ((n + 1) * h)) for n in (0, 1))
    best = 2 * first - second
    yield "mean passage of the transform", best.within(0.1 * (best.value - first.value)), mean


def expectation(ask, options, random):
    """int E[V(s)] ds = E[x(t)] from any start."""
    end, start = random.uniform(0.3, 3), random.choice(("s+", "s-", "rest"))
    f = ask("displacement,expectation", time=grid(end), start=start, observable="v")
    yield "E[x(t)]", integral(f["E(f)"], end / STEPS), f["displacement_mean"][-1]


def sensitivity(ask, options, random):
    """Derivatives by differences, thresholds of both directions apart."""
    names = ("mu_d", "drag_coefficient", "stribeck_velocity")
    name = random.choice([one for one in names if options.get(one)])
    f = ask("sticking,moments,sensitivity", accuracy=1e-8)
    h = 1e-4 * options[name]
    there = {n: ask("sticking,moments", accuracy=1e-10, **{name: options[name] + n * h}) for n in (-2, -1, 1, 2)}
    for key in ("P_stick", "mean_slide", "E_V2", "E_absV", "E_V"):
        if f"d{key}_d{name}" in f.values:
            values = [there[n][key] for n in (-2, -1, 1, 2)]
            yield f"d{key}/d{name}", *slope(values[3] - values[0], values[2] - values[1], h, f[f"d{key}_d{name}"])


def onset(ask, options, random):
    """Hitting distributions sum to 1."""
    f = ask("entry_law")
    for key in ("entry_law", "entry_law_minus"):
        if key in f.values:
            yield f"sum of {key}", Value(f[key].value.sum(), f[key].error.sum()), 1


IDENTITIES = {f.__name__: f for f in (power, averages, spectrum, autocovariance, large_deviations, displacement_transform,
                                      durations, displacement_distribution, transforms, first_passages, expectation,
                                      sensitivity, onset)}
