"""Random cases of all kinds of noise, drag, friction and question, each a dictionary of options. A noise of levels stands
in `levels`, as in calibration/cases.py; one of any states is a `stickslip.noise.Chain`."""

import zlib

import cases
import numpy
from cases import log_uniform

from stickslip import noise

OBSERVABLES = ("x*v+v+v^2", "y==0?x+0.5:v", "min(abs(v),0.25)+x", "v>0.25", "y==0", "abs(v)", "x*x*v+abs(x)")
# What each quantity takes; the lists are drawn by their names.
QUESTIONS = {
    "noise_law": "", "entry_law": "", "averages": "observable", "laplace": "lambda", "resolvent": "lambda observable",
    "spectrum": "omega", "noise_spectrum": "omega", "duration_density": "time", "autocorrelation": "time",
    "slip": "distance inverse_distance", "peak": "velocity", "first_passage": "velocity start passage",
    "passage_transform": "lambda velocity start passage", "passage_distribution": "time velocity start passage",
    "displacement": "time start", "expectation": "observable time start", "relaxation": "", "sensitivity": "",
    "large_deviation": "tilt", "displacement_transform": "time start wavenumber",
    "displacement_distribution": "time start distance probability"}
LEAST_ACCURACY = {"displacement_distribution": 3e-2, "slip": 1e-3, "duration_density": 1e-3, "passage_distribution": 1e-3}


def numbers(low, high, count):
    return lambda random, options: tuple(sorted(log_uniform(random, low, high) for _ in range(count)))


def start(random, options):
    word = random.choice(("s+", "s-", "rest", "stationary", "state"))
    if word != "state":
        return word
    return (random.choice(options["levels"])[0], random.uniform(-0.15, 0.15)) if "levels" in options else "rest"


ARGUMENTS = {
    "lambda": numbers(0.1, 10, 2), "omega": numbers(0.03, 30, 3), "time": numbers(0.3, 8, 2),
    "distance": numbers(0.1, 3, 3), "inverse_distance": numbers(0.3, 3, 2), "velocity": numbers(0.02, 0.3, 2),
    "wavenumber": numbers(0.1, 5, 3), "probability": lambda random, options: (0.25, 0.5, 0.875),
    "tilt": lambda random, options: tuple(sorted(random.choice((-1, 1)) * log_uniform(random, 0.03, 30) for _ in range(3))),
    "observable": lambda random, options: random.choice(OBSERVABLES),
    "passage": lambda random, options: random.choice(("both", "up", "down")), "start": start}


def ou(random, scene=cases.quick):
    """With the levels that the program chooses, or fewer; by the upwind scheme now and then. Fine steps take long."""
    options = scene(random) | {"noise": "ou"}
    options["noise_deviation"] = options["tau"] ** -0.5 * random.uniform(1, 1.5)
    if options["noise_deviation"] > 4 * options["delta"]:
        return ou(random, scene)
    if random.random() < 0.5:
        most = 2 * (options["noise_deviation"] / options["delta"]) ** 2
        options["noise_levels"] = max(1, min(int(most), random.randint(2, 10)))
    if random.random() < 0.1:
        options |= {"scheme": "upwind", "p": 4}
    return options


def weakening(random):
    return ou(random, cases.weakening)


def friction_and_drag(random):
    """What a noise is put to."""
    options = cases.quick(random)
    del options["tau"], options["delta"]
    if random.random() < 0.3:
        slope, kink = random.uniform(0.2, 2), random.uniform(0.1, 1)
        options |= {"drag": "expression", "drag_expression": random.choice((
            f"-{slope!r}*v - 2*max(abs(v) - {kink!r}, 0)*sign(v)", f"v > 0 ? -{slope!r}*v : -{kink!r}*v",
            f"-{slope!r}*tanh(v/{kink!r}) - 0.3*v", f"-{slope!r}*v - {kink!r}*max(v - {kink!r}, 0)"))}
        options.pop("drag_coefficient", 0), options.pop("drag_cubic", 0)
    return options


def levels(random):
    """Levels of a file, of which some hold the body."""
    options = random.choice((cases.few, cases.many, cases.pulses))(random)
    return friction_and_drag(random) | {name: options[name] for name in ("noise", "levels")}


def chain(random):
    """Any states, some with the same force, on a ring with chords; or a sum."""
    x = [level[0] for level in cases.few(random)["levels"]]
    x += random.choices(x, k=random.randint(0, 3))
    random.shuffle(x)
    rates = numpy.zeros((len(x), len(x)))
    for n in range(len(x)):
        rates[n, (n + 1) % len(x)] = log_uniform(random, 0.1, 5)
        rates[n, random.randrange(len(x))] += log_uniform(random, 0.05, 2)
    made = noise.Chain(x, rates)
    if random.random() < 0.2:
        made += noise.telegraph(random.uniform(0.1, 1), log_uniform(random, 0.2, 3))
    return friction_and_drag(random) | {"noise": made}


NAMED = {
    "telegraph": lambda random: {"telegraph_amplitude": random.uniform(0.3, 1.6), "telegraph_rate": log_uniform(random, 0.1, 5)},
    "periodic": lambda random: {"periodic_amplitude": random.uniform(1.1, 2), "period": log_uniform(random, 1, 10),
                                "period_phases": 2 * random.randint(2, 6)},
    "pulses": lambda random: {"pulse_height": random.uniform(0.8, 2.5), "pulse_rate": log_uniform(random, 0.1, 1),
                              random.choice(("pulse_duration", "pulse_decay")): log_uniform(random, 0.2, 1),
                              "pulse_steps": random.randint(2, 4), "pulse_sign": random.choice(("both", "up", "down"))},
    "ou": lambda random: {"tau": log_uniform(random, 0.3, 3), "delta": 0.5, "noise_deviation": 0.75, "noise_levels": 3}}

BANDS = {
    "narrow_band": lambda random: {"band_frequency": log_uniform(random, 0.5, 4), "band_width": random.uniform(0.2, 1)},
    "filtered": lambda random: {"ground_frequency": log_uniform(random, 1, 8), "ground_damping": random.uniform(0.3, 0.9)}}


def named(random):
    """A noise by its name, or the sum of two."""
    words = random.sample(sorted(NAMED), random.choice((1, 1, 2)))
    options = friction_and_drag(random) | {"noise": "+".join(words)}
    for word in words:
        options |= NAMED[word](random)
    if "pulse_decay" not in options:
        options.pop("pulse_steps", 0)
    return options


def gaussian(random):
    """Gaussian noise of continuous paths."""
    word = random.choice(("ou", "narrow_band", "filtered"))
    own = {"tau": log_uniform(random, 0.2, 4), "delta": 0} if word == "ou" else BANDS[word](random)
    return friction_and_drag(random) | own | {"noise": word, "noise_deviation": log_uniform(random, 0.7, 2)}


# What there is of it.
OF_GAUSSIAN = ("averages", "autocorrelation", "laplace", "noise_law", "relaxation", "slip", "spectrum")
SCENES = {"gaussian": gaussian, "ou": ou, "ou, weakening": weakening, "levels": levels, "any states": chain, "by name": named}


def drawn(random):
    """Kind and options of a case."""
    kind = random.choice(sorted(SCENES))
    options = SCENES[kind](random)
    if "friction" not in options and "mu_s_minus" not in options and options["mu_d"] < 1 and random.random() < 0.15:
        options |= {"friction": "stribeck", "stribeck_velocity": log_uniform(random, 0.05, 2)}
    quantity = random.choice(OF_GAUSSIAN if kind == "gaussian" else sorted(QUESTIONS))
    accuracy = max(random.choice((1e-2, 1e-3, 1e-5)), LEAST_ACCURACY.get(quantity, 0), 1e-3 * (kind == "gaussian"))
    options |= {"quantities": f"sticking,moments,{quantity}", "accuracy": accuracy}
    for argument in QUESTIONS[quantity].split():
        options[argument] = ARGUMENTS[argument](random, options)
    return kind, options


def in_files(options, entry):
    """The options for the program, with levels and states in files of an entry."""
    if isinstance(options.get("noise"), noise.Chain):
        made = options["noise"]
        name = f"{zlib.crc32(made.x.tobytes() + made.rates.toarray().tobytes()):08x}.csv"
        files = {part: entry.file(f"{part}_{name}") for part in ("noise_states", "noise_rates")}
        made.save(*files.values())
        return options | {"noise": "chain", **files}
    return cases.levels_in_file(options, entry)
