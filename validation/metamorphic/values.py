"""Values with errors, as the program states them."""

import re

import numpy

ROUNDING = 1e-11  # of the largest value of a key, beside the errors that the program states


class Value:
    """Numbers with bounds of their errors, which follow through sums and products."""

    __array_ufunc__ = None  # arrays leave arithmetic to this class

    def __init__(self, value, error=0.0):
        self.value, self.error = numpy.asarray(value, float), numpy.asarray(error, float)

    def __add__(self, other):
        other = known(other)
        return Value(self.value + other.value, self.error + other.error)

    def __mul__(self, other):
        other = known(other)
        return Value(self.value * other.value, abs(self.value) * other.error + abs(other.value) * self.error
                     + self.error * other.error)

    def __truediv__(self, other):
        other = known(other)
        return Value(self.value / other.value, (self.error + abs(self.value / other.value) * other.error) / abs(other.value))

    def __neg__(self):
        return Value(-self.value, self.error)

    def __sub__(self, other):
        return self + -known(other)

    def __rsub__(self, other):
        return -self + other

    def __getitem__(self, place):
        return Value(self.value[place], self.error[place])

    __radd__, __rmul__ = __add__, __mul__

    def within(self, doubt):
        """The same with a larger error."""
        return Value(self.value, self.error + abs(doubt))


def known(one):
    return one if isinstance(one, Value) else Value(one)


def ratio(one, other):
    """The largest difference over what both errors allow; None where nothing can be compared."""
    one, other = known(one), known(other)
    if one.value.shape != other.value.shape:
        return None
    apart, allowed = numpy.atleast_1d(abs(one.value - other.value)), numpy.atleast_1d(one.error + other.error)
    counts = numpy.isfinite(apart) & numpy.isfinite(allowed)
    if not counts.any():
        return None
    return float(numpy.max(numpy.where(apart > 0, apart / numpy.maximum(allowed, 1e-300), 0)[counts]))


def integral(values, step):
    """Simpson's rule over an even number of steps, beside the rule with half of them, which bounds its error."""
    def simpson(f, step):
        return (f[:1] + f[-1:] + 4 * f[1::2].sum() + 2 * f[2:-1:2].sum())[0] * step / 3
    whole, rough = simpson(values.value, step), simpson(values.value[::2], 2 * step)
    return Value(whole, simpson(values.error, step) + abs(whole - rough))


class Answer:
    """What the program answers to a case: its status, and a Value for each key. Numbers in the names of keys, such as
    times, are replaced by their place, and one observable by f."""

    def __init__(self, summary, observable=""):
        self.status, self.values, self.units = summary["status"], {}, {}
        for key, result in summary["results"].items():
            name = key.replace(observable, "f") if observable and ";" not in observable else key
            if argument := re.fullmatch(r"(\w+)\([-+.e\d]+\)", key):
                place = sum(other.startswith(f"{argument[1]}#") for other in self.values)
                name = f"{argument[1]}#{place}"
            value = numpy.array(result["value"], float)
            size = numpy.nanmax(abs(value), initial=0.0)
            if "ci95" in result:  # 4.5 standard deviations of a simulation
                low, high = numpy.moveaxis(numpy.array(result["ci95"], float), -1, 0)
                error = 4.5 / 1.96 * numpy.maximum(high - value, value - low)
                error = numpy.where(error > 0, error, numpy.nan)  # what never happened has no interval
            else:
                error = numpy.array(result["error"], float) + ROUNDING * size
            self.values[name], self.units[name] = Value(value, error), result.get("unit", "")

    def __getitem__(self, key):
        return self.values[key]
