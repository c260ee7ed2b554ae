"""Parameters of the model from measurements: maximum likelihood, which for values with errors is least squares."""

import dataclasses
import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from .calls import Path
from .cases import Pool
from .likelihood import FAR, MOVED, Axis, Search
from .measurements import DataSet, data_sets
from .needed import needed
from .program import warn
from .reference import declared, with_options
from .results import Results, closest
from .views import viewed

if TYPE_CHECKING:
    import numpy
    from matplotlib.figure import Figure
    Array = numpy.ndarray
numpy, stats = needed("numpy"), needed("scipy.stats")

LOOSEST, FINEST, SHARE = 1e-2, 1e-11, 0.1  # accuracy: within these, and that share of the least relative error of data
SEPARATE = 1e-8     # least eigenvalue of the information, its diagonal being 1, of parameters that are told apart
STEPS_PER_MU_S = 8  # noise steps up to mu_s where that is free
BY_LEVELS = ("mu_s", "mu_s_minus", "bias")  # act through the levels of the noise
NOT_HERE = ("accuracy", "study", "plan", "compare", "checkpoint", "summary", "output", "trajectory")


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class Fit:
    """Estimates of parameters.

    Attributes
    ----------
    names, estimates, errors
        Free parameters; their values and standard errors by name, in the units of the options.
    covariance
        Of the estimates, in the order of `names`: the inverse of Fisher's information. NaN at a bound, infinite where the
        data do not tell the parameters apart.
    chi2, degrees_of_freedom
        Of values with errors: sum of squares of residuals in standard errors, and number of values less that of
        parameters; None where there are samples besides.
    log_likelihood
        Of the samples, each observation given that it is at least the smallest observable one.
    observations
        Number of values, and of sampled durations and slips.
    converged, message
        Whether the estimates are the best fit, and what is to be said of them.
    shift
        By which the discretisation of the search moves the estimates, in standard errors.
    evaluations
        Runs of the program.
    results
        Of the model at the estimates, one for each data set.
    """

    names: tuple[str, ...]
    estimates: dict[str, float]
    errors: dict[str, float]
    covariance: "Array"
    chi2: float
    degrees_of_freedom: int | None
    log_likelihood: float
    observations: tuple[int, int]
    converged: bool
    message: str
    shift: float
    evaluations: int
    results: list[Results]
    _search: Search
    _u: "Array"
    _pool: tuple[Any, ...]

    @property
    def sets(self) -> Sequence[DataSet]:
        """The data sets, in order."""
        return self._search.sets

    def __repr__(self) -> str:
        lines = [f"{name} = {self.estimates[name]:.5g} +- {self.errors[name]:.2g}" for name in self.names]
        values, drawn = self.observations
        if values:
            freedom = self.degrees_of_freedom
            lines.append(f"chi^2 = {self.chi2:.4g} of {values} values" + (
                f", {freedom} degrees of freedom, p = {stats.chi2.sf(self.chi2, freedom):.2g}" if freedom else ""))
        if drawn:
            lines.append(f"log likelihood = {self.log_likelihood:.6g} of {drawn} observations")
            lines += [f"{name}: distance {distance:.3g} of the distribution functions, p < {p:.2g}"
                      for name, distance, p in self.distances()]
        return "\n".join([*lines, self.message])

    def distances(self) -> list[tuple[str, float, float]]:
        """How well the samples are met, in the order of the data sets.

        Returns
        -------
        rows
            Of each sample its name, the largest distance of its distribution function from that of the model, and the
            probability of a larger one if the model is right (Kolmogorov and Smirnov). That is an upper limit, as the
            parameters were fitted to the same data.
        """
        samples = [(sample, found) for one, found in zip(self.sets, self.results) for sample in one.samples]
        return [(sample.name, distance := sample.distance(found), float(stats.kstwo.sf(distance, sample.values.size)))
                for sample, found in samples]

    def interval(self, name: str, level: float = 0.95) -> tuple[float, float]:
        """Confidence interval from the standard error, of the logarithm where a parameter is positive, within bounds."""
        n = self._number(name)
        if not 0 < level < 1:
            raise ValueError(f"level = {level}: must be between 0 and 1, such as 0.95")
        axis, u = self._search.axes[n], self._u[n]
        width = stats.norm.ppf((1 + level) / 2) * self.errors[name] / abs(axis.slope(u))
        low, high = sorted((axis.value(u - width), axis.value(u + width)))
        return low, high

    def _number(self, name: str) -> int:
        """Of a free parameter."""
        if name not in self.names:
            raise ValueError(f"{name}: was not fitted; take one of {', '.join(self.names)}")
        return self.names.index(name)

    def profile(self, name: str, points: int = 9, width: float = 2.5) -> "Profile":
        """Twice the rise of chi^2/2 - log likelihood where a parameter is held and the others are fitted.

        Parameters
        ----------
        name
            Of the parameter.
        points
            Number of its values.
        width
            How far they reach, in standard errors.
        """
        n = self._number(name)
        axis, search = self._search.axes[n], self._search
        if not math.isfinite(self.errors[name]):
            raise ValueError(f"{name} has no standard error, which sets the width of the profile: {self.message}")
        reach = width * self.errors[name] / abs(axis.slope(self._u[n]))
        rises: dict[float, float] = {}
        with Pool(*self._pool) as search.pool:
            for way in (-1, 1):
                u = self._u.copy()
                for offset in numpy.linspace(0, way * reach, points // 2 + 1):
                    u = u.copy()
                    u[n] = self._u[n] + offset
                    if search.at(u) is None:
                        break
                    u = search.minimum(u, n) if len(u) > 1 else u
                    rises[axis.value(u[n])] = 2 * (search.at(u).misfit - search.at(self._u).misfit)
        search.pool = None
        return Profile(name, numpy.array(sorted(rises)), numpy.array([rises[value] for value in sorted(rises)]),
                       declared(self._pool[1])[name]["unit"])

    def plot(self, picture: Path | None = None) -> "Figure":
        """Draw the data beside the model: values with their errors, and shares of longer durations."""
        return viewed("picture", self, picture)


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class Profile:
    """Values of a parameter, and by how much twice the misfit rises from the best fit (`rise`)."""

    name: str
    values: "Array"
    rise: "Array"
    unit: str

    def __repr__(self) -> str:
        low, high = self.interval()
        return (f"profile of {self.name} at {len(self.values)} values from {self.values[0]:.4g} to {self.values[-1]:.4g}; "
                f"95 % confidence interval {low:.4g} to {high:.4g}")

    def interval(self, level: float = 0.95) -> tuple[float, float]:
        """Where the rise is below the quantile of chi^2; infinite where the profile does not reach it."""
        limit, best, root = stats.norm.ppf((1 + level) / 2), int(self.rise.argmin()), numpy.sqrt(numpy.maximum(self.rise, 0))
        low, high = (numpy.interp(limit, distance, values, right=end) for distance, values, end in (
            (root[best::-1], self.values[best::-1], -math.inf), (root[best:], self.values[best:], math.inf)))
        return float(low), float(high)

    def plot(self, picture: Path | None = None) -> "Figure":
        """Draw the profile, with the limits of 68 and 95 % confidence intervals."""
        return viewed("picture", self, picture)


@with_options
def fit(data: Mapping[str, Any] | Sequence[Mapping[str, Any]], free: Sequence[str], start: Mapping[str, float] | None = None,
        bounds: Mapping[str, tuple[float, float]] | None = None, *, accuracy: float | None = None, workers: int = 2,
        timeout: float | None = None, program: Path | None = None, **fixed: Any) -> Fit:
    """Estimate parameters of the model from measurements.

    Minimises chi^2/2 - log likelihood: chi^2 of values with normal errors, and the likelihood of independent durations
    and path lengths with densities f(t)/(1 - F(smallest)), by Fisher scoring in a trust region (Nocedal and Wright 2006,
    chapter 4). Densities are interpolated on a grid of logarithms. The search uses one discretisation, so that results
    are smooth in the parameters; it is repeated with a finer one until that would not move the estimates by a tenth of
    their standard errors. A search takes some 30 runs of the program: a second for averages, ten for durations.

    Parameters
    ----------
    data
        Of each key of results (value, standard error), or (abscissa, values, standard errors), as "S_v": (omega, S, error).
        Samples are arrays by name: "sticks", "slides", "excursions" (durations) and "slips" (path lengths); "smallest"
        has by name the smallest that could be observed, "options" what holds for this set alone. A list of such sets
        shares the free parameters.
    free
        Names of parameters of the model that are numbers.
    start
        Where to start, by name; by default where the program starts.
    bounds
        (low, high) by name; by default the range of the option.
    accuracy
        Of the runs that the search begins with; by default chosen from the errors of the data.
    workers, timeout, program
        As for `map`.
    **fixed
        Other options of the program. With mu_s free, delta_per_mu_s = 8 unless given: results are then continuous in it.

    Returns
    -------
    fit

    Raises
    ------
    ValueError
        If data, names, start or bounds do not fit together; BadInput with the program's message.
    ProgramError
        If the model has no results where the search starts.

    Warns
    -----
    UserWarning
        If the best fit was not found, the data do not determine the parameters, or a finer discretisation would move them.

    Examples
    --------
    >>> f = stickslip.fit({"P_stick": (0.27, 0.01), "mean_stick": (0.68, 0.02)}, ["mu_d", "tau"], {"mu_d": 0.4})
    >>> f = stickslip.fit({"sticks": durations, "smallest": {"sticks": 0.05}}, ["tau"])
    >>> f.estimates, f.errors, f.interval("tau"), f.profile("tau").plot("tau.png")
    """
    known = declared(program)
    axes = _axes(free, start or {}, bounds or {}, known)
    sets = [_continuous(one, [axis.name for axis in axes], known) for one in data_sets(data, fixed, program)]
    values = sum(part.value.size for one in sets for part in one.values)
    drawn = sum(sample.values.size for one in sets for sample in one.samples)
    if values + drawn < len(axes):
        raise ValueError(f"free: {len(axes)} parameters of {values + drawn} measurements; measure more, or fix some")
    if accuracy is None:
        accuracy = min([LOOSEST, *(SHARE * numpy.min(part.error / numpy.maximum(abs(part.value), part.error))
                                   for one in sets for part in one.values)])
    search = Search(sets, axes, max(float(accuracy), FINEST))
    with Pool(workers, program, timeout) as search.pool:
        u, fine, shift = search.best(numpy.array([axis.start for axis in axes]))
    search.pool = None
    best, information, distance = search.at(u), search.information(u), search.distance(u)
    inside = [n for n, (axis, x) in enumerate(zip(axes, u)) if not axis.at_bound(x)]
    covariance, together = _covariance(information, inside)
    slope = numpy.array([axis.slope(x) for axis, x in zip(axes, u)])
    covariance *= numpy.outer(slope, slope)
    estimates = {axis.name: axis.value(x) for axis, x in zip(axes, u)}
    notes = _notes(axes, inside, distance, shift, together, search.failure)
    for note in notes:
        warn(note)
    names = tuple(estimates)
    return Fit(names, estimates, dict(zip(names, numpy.sqrt(covariance.diagonal()).tolist())), covariance,
               float(best.residuals @ best.residuals), None if drawn else values - len(axes), float(best.logs.sum()),
               (values, drawn), distance <= FAR, "; ".join(notes) or "converged", shift, search.evaluations,
               fine.results, search, u, (workers, program, timeout))


def _covariance(information: "Array", inside: Sequence[int]) -> "tuple[Array, bool]":
    """Of those parameters that are not at a bound, NaN for others; infinite, and True, where they are not told apart."""
    among, found = numpy.ix_(inside, inside), numpy.full(information.shape, math.nan)
    spread = numpy.sqrt(information.diagonal()[inside])
    scaled = information[among] / numpy.outer(spread, spread)
    together = bool(inside) and numpy.linalg.eigvalsh(scaled)[0] < SEPARATE
    found[among] = math.inf if together else numpy.linalg.inv(scaled) / numpy.outer(spread, spread)
    return found, together


def _notes(axes: Sequence[Axis], inside: Sequence[int], distance: float, shift: float, together: bool,
           failure: Exception | None) -> list[str]:
    notes = [f"{axis.name} went to its bound; it has no standard error there" for n, axis in enumerate(axes)
             if n not in inside]
    if distance > FAR:
        notes.append(f"not converged: derivatives put the best fit {distance:.2g} standard errors away, and no step lowers the "
                     "misfit; start elsewhere, give bounds, or see profile()" + (f" ({failure})" if failure else ""))
    if together:
        notes.append("the data determine combinations of the parameters alone; fix one, or measure more")
    if shift > MOVED:
        notes.append(f"a finer discretisation would move the estimates by about {shift:.2g} standard errors; give accuracy")
    return notes


def _axes(free: Sequence[str], start: Mapping[str, float], bounds: Mapping[str, tuple[float, float]],
          known: Mapping[str, Mapping[str, Any]]) -> list[Axis]:
    names = [free] if isinstance(free, str) else list(free)
    parameters = {name: option for name, option in known.items() if option["group"] == "Model" and option["form"] == "number"}
    if not names or len(set(names)) < len(names):
        raise ValueError(f"free = {names}: must name parameters, each once")
    for what, given in (("free", names), ("start", start), ("bounds", bounds)):
        for name in given:
            if name not in parameters:
                near = closest(name, parameters)
                raise ValueError(f"{what}: {name} is no parameter of the model that is a number; "
                                 + (f"did you mean {near}?" if near else "docs/options.md lists them"))
            if name not in names:
                raise ValueError(f"{what}: {name} is not free; put it into free, or give {name}=... as an option")
    axes = []
    for name in names:
        low, high = (float(end) for end in parameters[name]["range"].strip("[]()").split(","))
        within = bounds.get(name, (low, high))
        if len(within) != 2 or not low <= within[0] < within[1] <= high:
            raise ValueError(f"bounds: {name} = {within} must be (low, high) within {parameters[name]['range']}")
        if name not in start and not parameters[name]["default"]:
            raise ValueError(f"start: lacks {name}, which has no default")
        value = float(start.get(name, parameters[name]["default"] or "nan"))
        if not within[0] < value < within[1]:
            raise ValueError(f"start: {name} = {value:g} must be between {within[0]:g} and {within[1]:g}, its bounds")
        axes.append(Axis(name, value, *map(float, within)))
    return axes


def _continuous(one: DataSet, free: Sequence[str], known: Mapping[str, Mapping[str, Any]]) -> DataSet:
    """The set with options that make results continuous in the free parameters."""
    options = dict(one.options)
    for name in options:
        if name in free:
            raise ValueError(f"free: {name} is given as an option besides; leave one out")
        if name in NOT_HERE or name.startswith("sweep_"):
            raise ValueError(f"{name}: has no place in a fit; leave it out")
    if options.get("route") == "monte_carlo":
        raise ValueError("route = monte_carlo: its results are random; leave it out")
    acting = [name for name in BY_LEVELS if name in free]
    if not acting:
        return one
    mirrored = any(options.get(name) not in (None, 0) for name in ("bias", "mu_s_minus"))
    noises = known["delta_per_mu_s"]["belongs_to"]["noise"]
    if acting != ["mu_s"] or mirrored or "delta" in options or options.get("noise", "ou") not in noises:
        raise ValueError(f"free: {', '.join(acting)} acts through levels of the noise, and results would jump where one is "
                         "passed; fit mu_s without bias, mu_s_minus and delta, with noise=\"ou\" (docs/model.md)")
    return dataclasses.replace(one, options={"delta_per_mu_s": STEPS_PER_MU_S, **options})
