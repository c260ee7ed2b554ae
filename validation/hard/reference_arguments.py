"""The case as reference.cpp takes it."""

import fractions
import math

from scenes import BASE


def levels(o):
    """N, first and last static level, in exact arithmetic up to the rounding of the options."""
    delta, tau = fractions.Fraction(o["delta"]), fractions.Fraction(o["tau"])
    slack = fractions.Fraction(1, 10**14)
    meant = math.floor(2 / (tau * delta**2) + slack)
    cut = o.get("noise_levels", "full")
    bias, mu_s = (fractions.Fraction(o.get("bias", 0)), fractions.Fraction(o["mu_s"]))
    return (meant if cut == "full" else cut, -math.floor((mu_s + bias) / delta + slack),
            math.floor((mu_s - bias) / delta + slack))


def drag(o):
    """Coefficients above and below v = 0, and the cubic one."""
    kind, c = o.get("drag", "linear"), o.get("drag_coefficient", 1)
    return {"linear": (c, c, 0), "none": (0, 0, 0), "cubic": (c, c, o.get("drag_cubic", 0)),
            "expression": (3, 0.5, 0)}[kind]


def arguments(scene):
    o = {**BASE, **scene.options}
    n, lo, hi = levels(o)
    numbers = [o["mu_d"], o["tau"], o["delta"], *drag(o), o.get("bias", 0)]
    # Series of exp(-lambda t) are long: large arguments are left to asymptotics.
    asked = [(name, text) for name in ("lambda", "omega") for text in o.get(name, "").split(",")
             if text and float(text) <= 20]
    return [n, lo, hi, *map(repr, numbers)], [word for pair in asked for word in pair]


def words(scene):
    """What is stored beside the values, to detect a case that has changed since."""
    return " ".join(map(str, sum(arguments(scene), [])))
