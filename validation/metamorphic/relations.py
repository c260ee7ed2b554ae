"""Relations between the results of two cases. A transformation makes another case of one, and says how keys of the
results there are found in those of the first: it returns (options, back), where back(key, value, answer) gives a pair
(key, value) or None; or None where it does not apply."""

import re

import numpy
import scipy.sparse

from stickslip import noise
from stickslip.reference import declared

OF_NOISES = ("tau", "delta", "levels", "noise_", "telegraph_", "period", "pulse_", "band_", "ground_")  # options
STARTS = ("s+", "s-")


def same(key, value, answer):
    return key, value


def replaced(text, **names):
    """A formula with others in the place of names."""
    return re.sub(r"\b(" + "|".join(names) + r")\b", lambda name: names[name[0]], text)


def continuous(options):
    """Whether the paths of the noise are."""
    return options["noise"] in ("ou", "narrow_band", "filtered") and not options.get("delta")


def states(options):
    """The noise as a chain of states in Python, or None."""
    if continuous(options):
        return None
    if isinstance(options["noise"], noise.Chain):
        return options["noise"]
    word = options["noise"]
    if word == "ou" and "noise_levels" in options:  # the chain of the paper: all jumps have one rate, also at its ends
        share, most = (options["noise_deviation"] / options["delta"]) ** 2 / options["tau"], options["noise_levels"]
        i = numpy.arange(-most, most + 1)
        up = share * (1 - i * (options["delta"] / options["noise_deviation"]) ** 2 / 2)
        up[0], up[-1] = 2 * share, 0
        x, down = options["delta"] * i, up[::-1]
    elif "levels" in options:
        x, up, down = numpy.array(options["levels"]).T
    if word == "file" or (word == "ou" and "noise_levels" in options):
        return noise.Chain(x, scipy.sparse.diags([up[:-1], down[1:]], [1, -1]))
    if word == "telegraph":
        return noise.telegraph(options["telegraph_amplitude"], options["telegraph_rate"])
    if word == "periodic":
        return noise.periodic(options["periodic_amplitude"], options["period"], options["period_phases"])
    return None


def with_noise(options, made):
    """The case under another noise: states, or a word."""
    return {name: value for name, value in options.items() if not name.startswith(OF_NOISES)} | {"noise": made}


EXCHANGED = {"h_plus": "h_minus_from_minus", "h_minus": "h_plus_from_minus", "w_one": "w_one_from_minus",
             "entry_law": "entry_law_minus", "u(f)": "u_minus(f)", "mu(f)": "mu_minus(f)", "w_plus(f)": "w_minus(f)"}
EXCHANGED |= {there: here for here, there in EXCHANGED.items()}
ODD = {"E_V", "mean_slip_net", "displacement_mean", "displacement_atom_at", "displacement_sine",
       "displacement_quantile", "tilted_velocity"}


def mirror(options, random):
    """All forces and velocities reversed."""
    other = dict(options)
    for name, value in options.items():
        if name in ("bias", "tilt"):
            other[name] = tuple(-one for one in value) if name == "tilt" else -value
        elif name == "levels":
            other[name] = [(-x, down, up) for x, up, down in reversed(value)]
        elif name == "noise" and isinstance(value, noise.Chain):
            # In the reverse order, as levels of equal force keep that of the list.
            other[name] = noise.Chain(-value.x[::-1], value.rates[::-1][:, ::-1])
        elif name == "pulse_sign" or name == "passage":
            other[name] = {"up": "down", "down": "up"}.get(value, value)
        elif name == "drag_expression":
            other[name] = f"0-({replaced(value, v='(0-v)')})"
        elif name == "observable":
            other[name] = replaced(value, v="(0-v)", x="(0-x)", y="(0-y)")
        elif name == "start":
            other[name] = ({"s+": "s-", "s-": "s+"}.get(value, value) if isinstance(value, str)
                           else tuple(-one for one in value))
        elif name == "distance" and "displacement_distribution" in options["quantities"]:
            other[name] = tuple(-one for one in value)
        elif name == "probability":
            other[name] = tuple(1 - one for one in value)
    sided = "mu_s_minus" in options
    if sided:
        for name in ("mu_s", "mu_d"):
            other[name], other[f"{name}_minus"] = options[f"{name}_minus"], options[name]

    def back(key, value, answer):
        exchanged = EXCHANGED.get(key)
        if exchanged not in answer.values and key in ("u(f)", "mu(f)"):  # symmetric: u(s+) + u(s-) = 2 pi/lambda
            return None if key == "u(f)" else (key, -value)
        if key == "entry_law" and exchanged not in answer.values:  # symmetric: from s+ alone
            return None
        key = exchanged if exchanged in answer.values else key
        if key.startswith("entry_law"):
            return key, value[::-1]
        if "P_X_le_mu_s" in key or (sided and key.endswith("_dmu_s")):  # of one direction
            return None if sided else (key, value)
        if sided and "_dmu_d" in key:
            key = key.removesuffix("_minus") if key.endswith("_minus") else f"{key}_minus"
        if key.startswith("displacement_cdf"):
            return key, 1 - value
        return key, -value if key.partition("#")[0] in ODD or key.startswith("dE_V_") else value
    return other, back


# Integrals over time of an observable, of which the program does not know the unit.
OVER_TIME = {"u(f)", "u_minus(f)", "w_plus(f)", "w_minus(f)", "mu(f)", "mu_minus(f)"}


def other_units(options, random):
    """Time and length in units that are powers of four: only exponents of numbers change, also in square roots."""
    if options.get("scheme") == "upwind":
        return None  # speeds j delta/p, a force taken for a speed: another grid in another unit of time
    time, length = (2.0 ** random.choice((-30, -8, 6, 20)) for _ in range(2))
    units = {"time": time, "length": length, "velocity": length / time, "force": length / time**2}

    def size(unit):
        return eval(unit.replace("^", "**").replace(" ", "*"), {}, units) if unit else 1.0
    force, velocity = size("force"), size("velocity")
    v, x = f"(v*{1 / velocity!r})", f"(x*{1 / force!r})"
    other = {}
    for name, value in options.items():
        unit = declared().get(name, {}).get("unit", "")
        if name == "levels":
            value = [(x * force, up / time, down / time) for x, up, down in value]
        elif isinstance(value, noise.Chain):
            value = noise.Chain(value.x * force, value.rates / time)
        elif name == "drag_expression":
            value = f"{force!r}*({replaced(value, v=v)})"
        elif name == "observable":
            value = replaced(value, v=v, x=x)
        elif name == "start" and not isinstance(value, str):
            value = (value[0] * force, value[1] * velocity)
        elif unit:
            value = tuple(each * size(unit) for each in value) if isinstance(value, tuple) else value * size(unit)
        other[name] = value

    def back(key, value, answer):
        return key, value * (1 / size("time" if key in OVER_TIME else answer.units[key]))
    return other, back


def permuted(options, random):
    """The states of the noise in another order."""
    chain = states(options)
    if chain is None:
        return None
    order = random.sample(range(len(chain.x)), len(chain.x))
    return with_noise(options, noise.Chain(chain.x[order], chain.rates[order][:, order])), without_levels


def split(options, random):
    """A state of the noise as two, between which the noise jumps as it likes."""
    chain = states(options)
    if chain is None or not isinstance(options.get("start", ""), str):
        return None
    if "levels" not in options and (options.get("start") in STARTS or "resolvent" in options["quantities"]):
        return None  # of many starts the most frequent may be another one
    count, n, share = len(chain.x), random.randrange(len(chain.x)), random.uniform(0.2, 0.8)
    rates = numpy.zeros((count + 1, count + 1))
    rates[:count, :count] = chain.rates.toarray()
    rates[:, count] = (1 - share) * rates[:, n]
    rates[:count, n] *= share
    rates[count, :count] = rates[n, :count]
    rates[n, count], rates[count, n] = random.uniform(0.1, 2), random.uniform(0.1, 2)
    return with_noise(options, noise.Chain(numpy.append(chain.x, chain.x[n]), rates)), of_more_states


def without_levels(key, value, answer):
    return None if key.startswith("entry_law") else (key, value)


def of_more_states(key, value, answer):
    """Where states are doubled, these have modes of their own."""
    return None if key.startswith(("entry_law", "relaxation")) else (key, value)


def as_states(options, random):
    """ou, telegraph noise, ... as levels in a file or as states and rates."""
    chain = states(options)
    if chain is None or isinstance(options["noise"], noise.Chain):
        return None
    if "levels" in options or not chain.neighbours_only or random.random() < 0.5:
        return with_noise(options, chain), without_levels
    up, down = numpy.append(chain.rates.diagonal(1), 0), numpy.append(0, chain.rates.diagonal(-1))
    levels = [tuple(map(float, level)) for level in zip(chain.x, up, down)]
    return with_noise(options, "file") | {"levels": levels}, same


def zero_noise(options, random):
    """The sum of the noise and another one that is zero."""
    rate = random.uniform(0.2, 3)
    chain = states(options)
    if isinstance(options["noise"], noise.Chain) or (chain is not None and random.random() < 0.5):
        return with_noise(options, chain + noise.Chain([0, 0], [[0, rate], [rate, 0]])), of_more_states
    if "telegraph" in options["noise"] or continuous(options):
        return None
    return options | {"noise": f"{options['noise']}+telegraph", "telegraph_amplitude": 1e-30,
                      "telegraph_rate": rate}, of_more_states


def looser(options, random):
    """A looser accuracy."""
    return (options | {"accuracy": min(0.1, options["accuracy"] * random.choice((10, 100)))}), same


def thresholds(options, random):
    """A bias as thresholds by direction."""
    bias = options.get("bias", 0)
    values = {"mu_s": options["mu_s"] - bias, "mu_d": options["mu_d"] - bias}
    values |= {f"{name}_minus": options.get(f"{name}_minus", options[name]) + bias for name in ("mu_s", "mu_d")}
    if not bias or min(values.values()) <= 0.01:
        return None
    other = {name: value for name, value in options.items() if name != "bias"} | values

    def back(key, value, answer):
        gone = "P_X_le_mu_s" in key or key.startswith("friction_power") or re.search("_dmu_[sd]", key)
        return None if gone else (key, value)
    return other, back


def no_symmetry(options, random):
    """Next to no bias, which takes the path without symmetry."""
    return None if "bias" in options else (options | {"bias": 1e-300}, without_levels)


def each_level(options, random):
    """Every level of the noise as a node."""
    return None if options["noise"] != "ou" or "scheme" in options or continuous(options) else (options | {"noise_degree": 0}, same)


CELLS = ("f_", "displacement_density", "fwhm", "t_corr")  # histograms, and what a sample cannot have


def simulated(options, random):
    """Simulation, within 4.5 standard deviations."""
    other = {name: value for name, value in options.items() if name != "accuracy"}
    other |= {"route": "monte_carlo", "excursions": 20000, "seed": random.randrange(2**31)}
    return other, lambda key, value, answer: None if key.startswith(CELLS) else (key, value)


TRANSFORMATIONS = {f.__name__: f for f in (mirror, other_units, permuted, split, as_states, zero_noise, looser,
                                           thresholds, no_symmetry, each_level, simulated)}


def exactness(name, options):
    """By how much results may differ, relative to the largest value of a key, where only exponents of numbers differ; None
    where errors say so. Kinks of a drag law are found to the last digit but one, and elimination on nodes of continuous
    noise turns that into 1e-8."""
    continuous = options.get("noise") in ("gaussian", "narrow_band", "filtered") or options.get("delta") == 0
    return None if name != "other_units" else 1e-6 if continuous and "drag_expression" in options else 1e-12
