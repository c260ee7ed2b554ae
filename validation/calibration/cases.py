"""Random cases by group: what is asked for, at which accuracies, how parameters are drawn, and what is the truth."""

import dataclasses
import math
import zlib


def log_uniform(random, low, high):
    return math.exp(random.uniform(math.log(low), math.log(high)))


def drag(random):
    kind = random.choice(("linear", "none", "quadratic", "cubic"))
    weak = random.random() < 0.2
    first = log_uniform(random, 1e-3, 0.1) if weak else random.uniform(0, 2)
    second = random.uniform(0.05, 2)
    if kind == "quadratic":
        return {"drag": "expression", "drag_expression": f"-{first!r}*v - {second!r}*v*abs(v)"}
    options = {"drag": kind}
    if kind != "none":
        options["drag_coefficient"] = first
    if kind == "cubic":
        options["drag_cubic"] = second
    return options


def noise(random, finest=0.05, coarsest=0.5):
    """Dyadic steps as people take them, and any."""
    delta = log_uniform(random, finest, coarsest)
    if random.random() < 0.5:
        delta = 2.0 ** math.floor(math.log2(delta))
    tau = log_uniform(random, 0.1, 5)
    while tau * delta > 1.2:  # the noise needs levels within its standard deviation
        tau /= 1.7
    return {"tau": tau, "delta": delta}


def thresholds(random, delta):
    """mu_d anywhere, at mu_s, or on a level; by direction, or with a bias, now and then."""
    kind = random.random()
    mu_d = random.uniform(0.05, 1)
    if kind > 0.7:
        mu_d = min(1, max(1, round(mu_d / delta)) * delta)
    elif kind > 0.5:
        mu_d = 1
    options = {"mu_s": 1, "mu_d": mu_d}
    kind = random.random()
    if kind < 0.1:
        options |= {"mu_s_minus": random.uniform(1, 1.5), "mu_d_minus": random.uniform(0.1, 1)}
    elif kind < 0.4:
        options["bias"] = random.uniform(0, 0.95)
    return options


def coulomb(random, **steps):
    options = drag(random) | noise(random, **steps)
    options |= thresholds(random, options["delta"])
    if options["drag"] == "none" and "bias" in options:
        options["bias"] *= options["mu_d"]  # or the body runs away
    return options


def fine(random):
    return coulomb(random, finest=0.005, coarsest=0.03)


def quick(random):
    return coulomb(random, finest=0.15)


def telegraph(random):
    """One level of the force holds a body at rest, the other one moves it."""
    amplitude = random.uniform(0.6, 1.4)
    bias = random.uniform(abs(1 - amplitude) + 0.05, 0.9)
    options = drag(random)
    slowest = bias + 0.05 if options["drag"] == "none" else 0.05
    return options | {"mu_s": 1, "mu_d": random.uniform(slowest, 1), "bias": bias, "noise": "telegraph",
                      "telegraph_amplitude": amplitude, "telegraph_rate": log_uniform(random, 0.1, 5)}


def weakening(random):
    options = drag(random) | noise(random)
    return options | {"mu_s": 1, "mu_d": random.uniform(0.05, 0.95), "friction": "stribeck",
                      "stribeck_velocity": log_uniform(random, 0.01, 10),
                      "stribeck_exponent": random.choice((1, 2))}


def few(random, most=5):
    """Levels of a file with random rates, even or anywhere: some hold the body, the outer ones move it."""
    count = random.randint(3, most)
    rates = [log_uniform(random, 0.05, 20) for _ in range(count - 1)], [log_uniform(random, 0.05, 20) for _ in range(count - 1)]
    if random.random() < 0.4:
        half = sorted(random.uniform(0.1, 2) for _ in range(count // 2))
        half[-1] = random.uniform(1.2, 2.5)
        x = [-one for one in reversed(half)] + [0.0] * (count % 2) + half
        rates = rates[0], rates[0][::-1]
    else:
        x = sorted(random.uniform(-0.95, 0.95) for _ in range(count - 2))
        x = [-random.uniform(0.96, 2.5), *x, random.uniform(1.2, 2.5)]
    if not any(abs(one) <= 1 for one in x):
        x[(count - 1) // 2] = -0.5  # between those that move the body either way
    levels = list(zip(x, [*rates[0], 0.0], [0.0, *rates[1]]))
    options = drag(random)
    while options["drag"] == "none":
        options = drag(random)
    return options | {"mu_s": 1, "mu_d": random.uniform(0.05, 1), "noise": "file", "levels": levels}


def started(random):
    """From a state that moves slower than the strongest level can make it: paths without jumps have kinks in time."""
    options = few(random) | {"mu_d": random.uniform(0.05, 0.8)}
    level = random.choice(options["levels"])[0]
    return options | {"start": f"{level!r},{random.uniform(0.02, 0.15)!r}"}


def many(random):
    return few(random, 9)


def levels_in_file(options, entry):
    """The options for the program, with the levels in a file of an entry."""
    if "levels" not in options:
        return options
    text = "x,rate_up,rate_down\n" + "".join(f"{x!r},{up!r},{down!r}\n" for x, up, down in options["levels"])
    file = entry.file(f"levels_{zlib.crc32(text.encode()):08x}.csv")
    file.write_text(text)
    return {name: value for name, value in options.items() if name != "levels"} | {"noise_file": file}


def pulses(random):
    """Rare strong levels beside one that holds the body."""
    strong, rare, back = random.uniform(1.5, 6), log_uniform(random, 1e-3, 0.3), log_uniform(random, 1, 30)
    weak = random.uniform(-0.3, 0.3)
    levels = [(-strong * random.uniform(0.5, 1), back, 0), (weak, rare, rare * random.uniform(0, 1)), (strong, 0, back)]
    return few(random) | {"levels": levels}


def weak_friction(random):
    """Friction that the noise hardly feels, and a short memory."""
    tau, mu_s = log_uniform(random, 0.01, 0.1), log_uniform(random, 0.02, 0.3)
    return {"mu_s": mu_s, "mu_d": mu_s * random.uniform(0.3, 1), "tau": tau, "drag_coefficient": random.uniform(0.2, 2),
            "delta": random.uniform(0.2, 0.6) / math.sqrt(tau)}


def gaussian(random):
    """Continuous paths, where elements and modes stand for levels: an Ornstein-Uhlenbeck process."""
    mu_d = random.choice((1, 0.5, 0.25, random.uniform(0.02, 0.99)))
    options = drag(random) | {"noise": "ou", "delta": 0, "tau": random.uniform(0.1, 3), "mu_s": 1, "mu_d": mu_d,
                              "noise_deviation": random.uniform(0.4, 2)}
    kind = random.random()
    if kind < 0.35:
        options["bias"] = random.uniform(-0.9, 0.9) * mu_d
    elif kind < 0.5:
        options["mu_s_minus"] = random.uniform(1, 1.6)
    elif kind < 0.6 and mu_d < 1:
        options |= {"friction": "stribeck", "stribeck_velocity": random.uniform(0.1, 1)}
    return options


def band(random):
    """Noise that turns before it is damped, and such that does not."""
    options = {name: value for name, value in gaussian(random).items() if name not in ("delta", "tau")}
    return options | {"noise": "narrow_band", "band_width": random.uniform(0.4, 1), "band_frequency": random.uniform(0.2, 2)}


@dataclasses.dataclass(frozen=True)
class Group:
    what: str
    scene: object  # of a random.Random
    asked: dict
    accuracies: tuple = (1e-2, 1e-4, 1e-6)
    truth: float | str = 1e-9  # the accuracy of a finer run, or "direct": direct.py, or "complex": of stickslip-complex
    most: float = 10  # runs of 100 with an estimate too small; arrays have many values
    worst: float = 3  # error by estimate
    cases: int = 60


TIMES = {"time": "0.1,0.5,1,3,8"}
SCALARS = {"quantities": "sticking,moments"}
GROUPS = {
    "scalars": Group("Coulomb friction", coulomb, SCALARS, (1e-2, 1e-4, 1e-6, 1e-8), 1e-12, most=2, cases=300),
    "nodes": Group("noise levels on nodes", fine, SCALARS, truth=1e-10, most=3),
    "telegraph": Group("telegraph noise", telegraph, SCALARS, truth=1e-10, most=3),
    "gaussian": Group("continuous Ornstein-Uhlenbeck noise", gaussian, SCALARS, (1e-2, 1e-4, 1e-6), 1e-8, most=3),
    "bands": Group("narrow bands, continuous", band, SCALARS, (3e-2, 1e-2), 3e-4, most=3, cases=20),
    "weakening": Group("Stribeck friction", weakening, SCALARS, truth=1e-10, most=3),
    "transforms": Group("transforms and hitting distributions", coulomb,
                        {"quantities": "entry_law,laplace", "lambda": "0.1,0.5,2,8"}, most=5),
    "spectra": Group("power spectral densities", quick, {"quantities": "spectrum", "omega": "0.1,0.5,2,8,30"}, cases=40),
    "durations": Group("densities of durations", quick, {"quantities": "duration_density", **TIMES}, truth=1e-8, cases=20),
    "short_times": Group("durations and slips under telegraph noise", telegraph, {
        "quantities": "duration_density,slip", "time": "0.02,0.1,0.5,2", "distance": "0.02,0.1,0.5,2"},
        (1e-2, 1e-3), 1e-5, cases=20),
    "slips": Group("slips and displacement", quick, {
        "quantities": "slip,peak,displacement", "distance": "0.1,0.3,1,3", "inverse_distance": "0.3,1,5",
        "velocity": "0.1,0.3", **TIMES}, (1e-2, 1e-4), 1e-6, cases=12),
    "passages": Group("first passages", quick, {
        "quantities": "passage_transform,passage_distribution", "lambda": "0.1,1,5", "velocity": "0.1,0.3",
        "start": "rest", **TIMES}, (1e-2, 1e-4), 1e-6, cases=12),
    "few_levels": Group("few levels: scalars", many, SCALARS, truth="direct", most=3, cases=40),
    "few_spectra": Group("few levels: spectra", many, {"quantities": "spectrum", "omega": "0.01,0.1,0.5,2,8,30"},
                         truth="direct", cases=30),
    "few_modes": Group("few levels: relaxation modes", many, {"quantities": "relaxation"}, truth="direct", cases=30),
    "few_times": Group("few levels: durations, slips and autocovariance", few, {
        "quantities": "duration_density,slip,autocorrelation", "time": "1,3,8", "distance": "0.5,2,5"},
        (1e-2, 1e-4), "direct", cases=12),
    "pulses": Group("pulses: spectra and modes", pulses,
                    {"quantities": "sticking,spectrum,relaxation", "omega": "0.001,0.1,1,10"}, truth="direct", cases=30),
    "pulse_times": Group("pulses: durations, slips and autocovariance", pulses, {
        "quantities": "duration_density,slip,autocorrelation", "time": "1,5,30", "distance": "0.5,2,5"},
        (1e-2, 1e-4), "direct", cases=12),
    "jumps": Group("observables that jump", few, {
        "quantities": "averages,expectation", "observable": "stick;abs(v)>0.2", "time": "1,3,8", "start": "s+"},
        (1e-2, 1e-4), "direct", cases=12),
    "starts": Group("starts from a state: velocity and displacement", started, {
        "quantities": "displacement,expectation", "observable": "v", "time": "0.1,0.3,1,3"}, (1e-2, 1e-4, 1e-6), "direct",
        cases=20),
    "weak_friction": Group("weak friction, short memory: spectra", weak_friction,
                           {"quantities": "spectrum", "omega": "0.1,1,5,30"}, truth="complex", cases=20),
    "far_spectra": Group("omega far above and below the rates", quick,
                         {"quantities": "spectrum", "omega": "1e-4,1e-2,1,1e2,1e3"}, truth="complex", cases=20),
}
# What --quick takes: transforms at coarse steps of the noise, which take a fraction of the time.
QUICK = {"scalars": dataclasses.replace(GROUPS["scalars"], cases=16),
         "transforms": dataclasses.replace(GROUPS["transforms"], scene=quick, cases=10)}
