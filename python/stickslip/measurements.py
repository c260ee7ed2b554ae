"""What a fit is made to: values with errors and samples of durations and slips, as the program is asked for them."""

import dataclasses
import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from .calls import Path
from .needed import needed
from .reference import keys
from .results import Results, closest

if TYPE_CHECKING:
    import numpy
    Array = numpy.ndarray
numpy, interpolate = needed("numpy"), needed("scipy.interpolate")

# Samples: the phase in the keys f_ and cdf_ of their density and distribution function, which are over an option.
PHASES = {"sticks": ("stick", "time"), "slides": ("slide", "time"), "excursions": ("excursion", "time"),
          "slips": ("slip", "distance")}
PARTS = ("options", "smallest")  # of a data set, besides
POINTS = 40       # on which densities are computed
BEYOND = 2        # times the largest observation, where the grid ends
SMALLEST = 1e-14  # share of the largest density that counts as 0


@dataclasses.dataclass(frozen=True, eq=False)
class Values:
    """A key of results, the quantity that has it and the option that it is over (empty where there are none), what it is
    over (None for a scalar), values and their standard errors, of one shape (n,)."""

    key: str
    quantity: str
    option: str
    over: "Array | None"
    value: "Array"
    error: "Array"

    def of(self, results: Results) -> "Array":
        """The same of the model."""
        return numpy.atleast_1d(at(results, self.key, self.over))


@dataclasses.dataclass(frozen=True, eq=False)
class Sample:
    """Durations or path lengths of a quantity in rising order, all at least `smallest`, which could be observed."""

    name: str
    quantity: str
    values: "Array"
    smallest: float

    def grid(self, refined: int) -> "Array":
        """Evenly spaced logarithms from the smallest to beyond the largest observation; each refinement halves steps."""
        return numpy.geomspace(self.values[0], BEYOND * self.values[-1], 2**refined * (POINTS - 1) + 1)

    def missed(self, results: Results) -> float:
        """Probability of what is too short to be observed."""
        return float(at(results, f"cdf_{PHASES[self.name][0]}", self.smallest)) if self.smallest else 0.0

    def distance(self, results: Results) -> float:
        """Largest distance of the distribution functions of the observations and of the model, given that it is observed,
        which is interpolated in the logarithm (Kolmogorov's statistic)."""
        cdf, n = results[f"cdf_{PHASES[self.name][0]}"], self.values.size
        below = numpy.interp(numpy.log(self.values), numpy.log(cdf.abscissa), cdf.value)
        model = (below - (missed := self.missed(results))) / (1 - missed)
        steps = numpy.arange(n + 1) / n
        return float(max((steps[1:] - model).max(), (model - steps[:-1]).max()))

    def of(self, results: Results, refined: int) -> "tuple[Array, Array, Array]":
        """Logarithms of the density, given that it is observed, at the observations and on the grid, and probabilities
        around the points of the grid."""
        phase, grid = PHASES[self.name][0], self.grid(refined)
        density = at(results, f"f_{phase}", grid)
        missed = self.missed(results)
        low, high = at(results, f"cdf_{phase}", grid[[0, -1]])
        log = numpy.log(numpy.maximum(density, SMALLEST * density.max()) / (1 - missed))
        weights = numpy.exp(log) * grid * math.log(grid[1] / grid[0])  # trapezia of even steps in the logarithm
        weights[[0, -1]] = weights[[0, -1]] / 2 + numpy.array([low - missed, 1 - high]) / (1 - missed)
        return interpolate.CubicSpline(numpy.log(grid), log)(numpy.log(self.values)), log, weights


@dataclasses.dataclass(frozen=True, eq=False)
class DataSet:
    """What was measured under the same options."""

    values: tuple[Values, ...]
    samples: tuple[Sample, ...]
    options: dict[str, Any]

    def asked(self, refined: int) -> dict[str, Any]:
        """Options that ask the program for all of it, densities on grids that were so often refined."""
        words = {one.quantity for one in (*self.values, *self.samples)} - {""}
        words.update(_words(self.options.get("quantities", ())))
        over: dict[str, list[Array]] = {}
        for one in self.values:
            if one.over is not None:
                over.setdefault(one.option, []).append(one.over)
        for sample in self.samples:
            option = PHASES[sample.name][1]
            over.setdefault(option, []).append(sample.grid(refined))
            over[option] += [numpy.array([sample.smallest])] * (sample.smallest > 0)
        return {**self.options, "quantities": sorted(words),
                **{option: numpy.unique(numpy.concatenate(parts)) for option, parts in over.items()}}


def data_sets(data: Mapping[str, Any] | Sequence[Mapping[str, Any]], fixed: Mapping[str, Any],
              program: Path | None = None) -> list[DataSet]:
    """The data as given to `fit`, checked.

    Raises
    ------
    ValueError
        With what is wrong and what to give instead.
    """
    sets = [data] if isinstance(data, Mapping) else list(data)
    if not sets or not all(isinstance(one, Mapping) and set(one) - set(PARTS) for one in sets):
        raise ValueError('data: holds no measurement; give values with their errors by key, as in {"P_stick": (0.27, 0.01)}, '
                         'or samples, as in {"sticks": durations}; a list of such for several sets')
    known, found = keys(program), []
    for one in sets:
        options = {name.rstrip("_"): value for name, value in {**fixed, **one.get("options", {})}.items()}
        smallest = one.get("smallest", {})
        if not isinstance(smallest, Mapping) or set(smallest) - set(one) or set(smallest) - set(PHASES):
            raise ValueError(f'smallest = {smallest}: must name samples of the set, as in {{"sticks": 0.05}}')
        measured = {name: part for name, part in one.items() if name not in PARTS}
        found.append(DataSet(tuple(_values(key, part, options, known) for key, part in measured.items()
                                   if key not in PHASES),
                             tuple(_sample(name, part, smallest.get(name, 0.0), known) for name, part in measured.items()
                                   if name in PHASES), options))
    return found


def _values(key: str, given: Any, options: Mapping[str, Any], known: Mapping[str, tuple[str, str]]) -> Values:
    if key not in known and not (options.get("quantities") and "(" in key):
        near = closest(key, [*known, *PHASES])
        raise ValueError(f"data: {key} is no key of results" + (f"; did you mean {near}?" if near else
                         " (docs/quantities.md) and no sample; samples are " + ", ".join(PHASES)))
    quantity, over = known.get(key, ("", ""))
    form = f"({over} values, values, errors)" if over else "(value, error)"
    try:
        parts = [numpy.atleast_1d(numpy.asarray(part, float)) for part in given]
    except (TypeError, ValueError):
        parts = []
    if len(parts) != 2 + bool(over) or len({part.shape for part in parts}) > 1 or parts[0].ndim > 1 or not parts[0].size:
        raise ValueError(f"data: {key} must be {form}, errors being standard errors, arrays of one length")
    if not all(numpy.isfinite(part).all() for part in parts) or not (parts[-1] > 0).all():
        raise ValueError(f"data: {key} has values that are not finite, or errors that are not positive; leave them out")
    return Values(key, quantity, over, parts[0] if over else None, *parts[-2:])


def _sample(name: str, given: Any, smallest: float, known: Mapping[str, tuple[str, str]]) -> Sample:
    values = numpy.sort(numpy.asarray(given, float).ravel())
    wrong = values[~(numpy.isfinite(values) & (values > 0))]
    if wrong.size or not values.size:
        raise ValueError(f"data: {name} has {wrong.size} of {values.size} values that are not positive numbers"
                         + (f", such as {wrong[0]:g}; leave them out" if wrong.size else "; give at least one"))
    if not 0 <= smallest < math.inf:
        raise ValueError(f"smallest = {smallest:g}: of {name}, must be a number >= 0")
    if values[0] < smallest:
        raise ValueError(f"data: {name} has {(values < smallest).sum()} of {values.size} values below the smallest observable "
                         f"one, {smallest:g}; the least is {values[0]:g}: leave them out, or state a smaller one")
    return Sample(name, known[f"f_{PHASES[name][0]}"][0], values, float(smallest))


def at(results: Results, key: str, over: "Array | float | None") -> "Array":
    """Values of a key at some of what it is over."""
    if over is None:
        return results[key].value
    return numpy.asarray(results[key].value)[numpy.searchsorted(results[key].abscissa, over)]


def _words(quantities: Any) -> Sequence[str]:
    return [word for word in quantities.split(",") if word] if isinstance(quantities, str) else list(quantities)
