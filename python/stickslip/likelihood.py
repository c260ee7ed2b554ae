"""The misfit of the model to measurements, and the parameters where it is least."""

import dataclasses
import math
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

from .cases import Pool
from .measurements import DataSet
from .needed import needed
from .results import Results

if TYPE_CHECKING:
    import numpy
    Array = numpy.ndarray
numpy, optimize, special = needed("numpy"), needed("scipy.optimize"), needed("scipy.special")

STEP = 0.005  # of differences, of the logarithm of a positive parameter
FAR = 0.05    # distance to the best fit in standard errors that counts as having arrived
MOVED = 0.1   # shift by the discretisation in standard errors that calls for a finer one
STUCK, LONGEST = 6, 40  # steps that end a search: so many without progress, and at most
ROUNDS = 3    # of finer and finer discretisations
FINER, HIGHEST = 2, 24  # degrees more, and the highest one
OWN = ("scheme", "degree", "layers", "noise_degree", "p", "route")  # fix the discretisation, where given


class Axis:
    """A free parameter between bounds, by a number u without bounds: the logarithm of a positive parameter."""

    def __init__(self, name: str, start: float, low: float, high: float) -> None:
        self.name, self.low, self.high = name, low, high
        self._scale = abs(start) or 1.0
        self.start = self.of(start)

    def of(self, value: float) -> float:
        """u of a value."""
        if math.isinf(self.low):
            return value / self._scale if math.isinf(self.high) else -math.log(self.high - value)
        return math.log(value - self.low) if math.isinf(self.high) else float(
            special.logit((value - self.low) / (self.high - self.low)))

    def value(self, u: float) -> float:
        """The value of u."""
        if math.isinf(self.low):
            return u * self._scale if math.isinf(self.high) else self.high - math.exp(-u)
        return self.low + (math.exp(u) if math.isinf(self.high) else (self.high - self.low) * float(special.expit(u)))

    def at_bound(self, u: float) -> bool:
        """Whether u went so far that the value is as good as at a bound."""
        return any(math.isfinite(end) and abs(self.value(u) - end) < 1e-3 * abs(self.value(self.start) - end)
                   for end in (self.low, self.high))

    def slope(self, u: float) -> float:
        """d value/du, by a symmetric difference of this smooth function."""
        return (self.value(u + 1e-5) - self.value(u - 1e-5)) / 2e-5


@dataclasses.dataclass(frozen=True, eq=False)
class Model:
    """What the model says of the data at some parameters: residuals of values in standard errors, log densities of
    observations; of each sample its size, log densities on a grid, and probabilities around its points."""

    residuals: "Array"
    logs: "Array"
    grids: "list[tuple[int, Array, Array]]"
    results: list[Results]

    @property
    def misfit(self) -> float:
        """chi^2/2 - log likelihood."""
        return float(self.residuals @ self.residuals / 2 - self.logs.sum())


class _Enough(Exception):
    """Ends a search."""


class Search:
    """The misfit of parameters u, its gradient and its expected second derivatives, by runs of the program."""

    def __init__(self, sets: Sequence[DataSet], axes: Sequence[Axis], accuracy: float) -> None:
        self.sets, self.axes = sets, axes
        self.pool: Pool | None = None
        self.methods: list[dict[str, Any]] = [{"accuracy": accuracy} for _ in sets]
        self.refined = self.evaluations = 0
        self.failure: Exception | None = None
        self._known: dict[bytes, Any] = {}

    def models(self, points: Iterable["Array"], finer: bool = False) -> list[Model | Exception]:
        """Models at points, by the discretisation of the search or a finer one."""
        points, methods, refined = list(points), self.methods, self.refined + finer
        if finer:
            methods = [{"accuracy": method["accuracy"] / 10, **({"degree": min(method["degree"] + FINER, HIGHEST)}
                                                                if "degree" in method else {})} for method in methods]
        asked = [one.asked(refined) for one in self.sets]
        found = self.pool.results([{**case, **method, **{axis.name: axis.value(u) for axis, u in zip(self.axes, point)}}
                                   for point in points for case, method in zip(asked, methods)])
        self.evaluations += len(found)
        return [self._model(found[n:n + len(asked)], refined) for n in range(0, len(found), len(asked))]

    def _model(self, runs: list[Results | Exception], refined: int) -> Model | Exception:
        for run in runs:
            if isinstance(run, Exception):
                return run
        residuals, logs, grids = [numpy.zeros(0)], [numpy.zeros(0)], []
        for one, run in zip(self.sets, runs):
            residuals += [(values.of(run) - values.value) / values.error for values in one.values]
            for sample in one.samples:
                log, grid, weights = sample.of(run, refined)
                logs.append(log)
                grids.append((log.size, grid, weights))
        return Model(numpy.concatenate(residuals), numpy.concatenate(logs), grids, runs)

    def at(self, u: "Array") -> Model | None:
        """The model, or None where there is none."""
        if u.tobytes() not in self._known:
            self._known[u.tobytes()] = self.models([u])[0]
        found = self._known[u.tobytes()]
        if isinstance(found, Exception):
            self.failure = found
            return None
        return found

    def slopes(self, u: "Array") -> "tuple[Array, Array, list[Array]]":
        """Derivatives of residuals, log densities of observations and those on grids, parameter by parameter: symmetric
        differences, one-sided where a neighbour is beyond what the model allows."""
        key = b"slopes" + u.tobytes()
        if key not in self._known:
            centre, rows = self.at(u), []
            near = self.models(u + sign * STEP * unit for unit in numpy.eye(len(u)) for sign in (1, -1))
            for up, down in zip(near[::2], near[1::2]):
                if isinstance(up, Exception) and isinstance(down, Exception):
                    raise up
                length = STEP * (2 - isinstance(up, Exception) - isinstance(down, Exception))
                up, down = (centre if isinstance(one, Exception) else one for one in (up, down))
                rows.append(((up.residuals - down.residuals) / length, (up.logs - down.logs) / length,
                             [(a[1] - b[1]) / length for a, b in zip(up.grids, down.grids)]))
            self._known[key] = (numpy.array([row[0] for row in rows]), numpy.array([row[1] for row in rows]),
                                [numpy.array(parts) for parts in zip(*(row[2] for row in rows))])
        return self._known[key]

    def gradient(self, u: "Array") -> "Array":
        """Of the misfit."""
        residuals, logs, _ = self.slopes(u)
        return residuals @ self.at(u).residuals - logs.sum(1)

    def information(self, u: "Array") -> "Array":
        """Fisher's: of values J^T J, of each sample n times the mean product of derivatives of the log density."""
        residuals, _, grids = self.slopes(u)
        return residuals @ residuals.T + sum(n * (slope * weights) @ slope.T
                                             for slope, (n, _, weights) in zip(grids, self.at(u).grids))

    def distance(self, u: "Array", held: int | None = None) -> float:
        """To the best fit of all parameters but one that is held, in standard errors."""
        some = [n for n in range(len(u)) if n != held]
        gradient, information = self.gradient(u)[some], self.information(u)[numpy.ix_(some, some)]
        return math.sqrt(abs(gradient @ numpy.linalg.pinv(information, hermitian=True) @ gradient))

    def minimum(self, u: "Array", held: int | None = None) -> "Array":
        """Fisher scoring in a trust region, all parameters but one that is held."""
        some, visited = [n for n in range(len(u)) if n != held], [u]

        def whole(part: "Array") -> "Array":
            found = u.copy()
            found[some] = part
            return found

        def misfit(part: "Array") -> float:
            model = self.at(whole(part))
            return math.inf if model is None else model.misfit

        def curvature(part: "Array") -> "Array":
            found = self.information(whole(part))[numpy.ix_(some, some)]
            return found + 1e-9 * numpy.trace(found) * numpy.eye(len(some))

        def look(part: "Array") -> None:
            visited.append(whole(part))
            stuck = len(visited) > STUCK and all((one == visited[-1]).all() for one in visited[-STUCK:])
            if stuck or self.distance(visited[-1], held) <= FAR / 5:
                raise _Enough

        try:
            optimize.minimize(misfit, u[some], method="dogleg", jac=lambda part: self.gradient(whole(part))[some],
                              hess=curvature, callback=look, options={
                                  "gtol": 0, "maxiter": LONGEST, "initial_trust_radius": 0.5, "max_trust_radius": 2.0})
        except _Enough:
            pass
        return visited[-1]

    def fix_discretisation(self, runs: Sequence[Results]) -> None:
        """The degrees of these runs from now on, so that results are smooth in the parameters."""
        self._known.clear()
        for one, run, method in zip(self.sets, runs, self.methods):
            if run.cost.get("steps") and not any(name in one.options for name in OWN):
                method["degree"] = run.cost["steps"][-1]["degree"]

    def shift(self, u: "Array", fine: Model) -> float:
        """How far the discretisation moves the estimates, in standard errors: the finer model less that of the search,
        projected on the derivatives by the parameters."""
        (residuals, logs, _), here = self.slopes(u), self.at(u)
        force = residuals @ (fine.residuals - here.residuals) + logs @ (fine.logs - here.logs)
        return math.sqrt(abs(force @ numpy.linalg.pinv(self.information(u)) @ force))

    def best(self, u: "Array") -> "tuple[Array, Model, float]":
        """The best fit; a finer model there, and the shift by the discretisation."""
        fine = self.models([u])[0]
        for n in range(ROUNDS):
            if isinstance(fine, Exception):
                raise fine
            self.fix_discretisation(fine.results)
            if n == 0:
                self._check_effects(u)
            u = self.minimum(u)
            fine = self.models([u], finer=True)[0]
            if isinstance(fine, Exception):
                raise fine
            shift = self.shift(u, fine)
            if n + 1 == ROUNDS or shift <= MOVED and self.distance(u) <= FAR:
                return u, fine, shift
            self.refined += 1
            for method in self.methods:
                method["accuracy"] /= 10
        raise AssertionError

    def _check_effects(self, u: "Array") -> None:
        if self.at(u) is None:
            raise self.failure
        residuals, logs, _ = self.slopes(u)
        for axis, slope in zip(self.axes, numpy.hstack([residuals, logs])):
            if abs(slope).max() < 1e-9:
                raise ValueError(f"free: {axis.name} has no effect on these data at the start; leave it out, measure what "
                                 "depends on it, or start elsewhere")
