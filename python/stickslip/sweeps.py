"""Results of a sweep, as arrays over the swept options."""

import csv
import dataclasses
import math
import pathlib
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from .results import Result, Results, array, options_in, result_of, warnings_in
from .needed import needed

if TYPE_CHECKING:
    import h5py
    import numpy
    Array = numpy.ndarray
numpy = needed("numpy")

STATES = ("reached", "not reached", "failed", "no memory", "refused")


class Sweep(Results):
    """Results of a sweep by key; each is an array with a dimension for every swept option.

    Attributes
    ----------
    dims, coords
        Names of the swept options in the order of the dimensions, and their values by name.
    status
        Of each point: "reached", "not reached", "failed", "no memory" or "refused", where the model is none.
    failures
        Messages of the points that failed, lacked memory or were refused, by their index; their results are NaN.
    shortfalls
        Messages of the points that did not reach the accuracy, by their index; their results are there.
    point_warnings
        What the program warned of at single points, by their index, where the file has it.
    units
        Of the swept options, where the file has them.

    The other attributes are those of `Results`.
    """

    def __init__(self, coords: "Mapping[str, Array]", results: Mapping[str, Result], status: "Array",
                 messages: Mapping[tuple[int, ...], str], *, units: Mapping[str, str] | None = None,
                 point_warnings: Mapping[tuple[int, ...], Sequence[str]] | None = None, **parts: Any) -> None:
        super().__init__({key: dataclasses.replace(one, sweep=self) for key, one in results.items()}, **parts)
        self.point_warnings = {index: list(texts) for index, texts in (point_warnings or {}).items() if texts}
        self.coords = dict(coords)
        self.dims = tuple(self.coords)
        self.status = status
        self.units = dict(units or {})
        texts = {index: messages.get(index) or str(status[index]) for index in numpy.ndindex(status.shape)}
        self.failures = {i: text for i, text in texts.items() if status[i] in STATES[2:]}
        self.shortfalls = {i: text for i, text in texts.items() if status[i] == STATES[1]}

    @property
    def shape(self) -> tuple[int, ...]:
        """Numbers of values of the swept options."""
        return self.status.shape

    @property
    def reached(self) -> bool:
        """Whether every point reached the accuracy asked for."""
        return not self.failures and not self.shortfalls

    def transposed(self, dims: Sequence[str]) -> "Sweep":
        """The same with the swept options in another order.

        Parameters
        ----------
        dims
            All of `self.dims`.

        Returns
        -------
        sweep
        """
        order = tuple(self.dims.index(name) for name in dims)

        def turned(values: Any) -> Any:
            many = hasattr(values, "ndim") and values.ndim >= len(order)
            return values.transpose(*order, *range(len(order), values.ndim)) if many else values

        results = {key: Result(key, turned(one.value), turned(one.error), one.unit,
                               tuple(dims) + one.dims[len(order):], one.abscissa_name,
                               one.abscissa if one.abscissa is None or one.abscissa.ndim == 1 else turned(one.abscissa),
                               turned(one.ci95)) for key, one in self.items()}
        texts = {**self.failures, **self.shortfalls}
        parts = {name: getattr(self, name) for name in
                 ("options", "name", "summary", "scene", "cost", "plan", "provenance", "accuracy", "warnings", "units")}
        texts, warned = ({tuple(index[n] for n in order): text for index, text in by_index.items()}
                         for by_index in (texts, self.point_warnings))
        return Sweep({name: self.coords[name] for name in dims}, results, turned(self.status), texts,
                     point_warnings=warned, **parts)

    @property
    def concerned(self) -> "Array":
        """Whether warnings concern a point, beside those about options without effect, of the shape of `status`."""
        found = numpy.zeros(self.shape, bool)
        for index, texts in self.point_warnings.items():
            found[index] = any(not text.startswith("-") for text in texts)
        return found


def _gathered(key: str, points: Sequence[Result | None], dims: tuple[str, ...], shape: tuple[int, ...]) -> Result:
    """One result of all points, NaN where a point has none."""
    first = next(point for point in points if point is not None)
    length = max(numpy.size(point.value) for point in points if point is not None)
    inner = (length,) if first.dims else ()

    def filled(part: str, more: tuple[int, ...] = ()) -> "Array":
        whole = numpy.full((len(points), *inner, *more), math.nan)
        for n, point in enumerate(points):
            if point is not None:
                values = numpy.asarray(getattr(point, part), float)
                whole[(n, slice(values.shape[0])) if inner else n] = values
        return whole.reshape(*shape, *inner, *more)

    abscissa = _common(filled("abscissa")) if inner else None
    return Result(key, filled("value"), filled("error"), first.unit, dims + first.dims, first.abscissa_name, abscissa,
                  None if first.ci95 is None else filled("ci95", (2,)))


def _common(abscissa: "Array") -> "Array":
    """One abscissa where all points have it, or the beginning of it, as points with fewer slips do."""
    rows = abscissa.reshape(-1, abscissa.shape[-1])
    longest = rows[numpy.isnan(rows).sum(axis=1).argmin()]
    return longest if (numpy.isnan(rows) | (rows == longest)).all() else abscissa


def from_summary(tree: Mapping[str, Any], name: str = "") -> Sweep:
    """A sweep from the tree of a summary."""
    coords = {axis: numpy.array(values, float) for axis, values in tree["sweep"]["axes"].items()}
    shape = tuple(map(len, coords.values()))
    runs = sorted(tree["runs"], key=lambda run: run["point"])
    points = [{key: result_of(key, parts) for key, parts in run.get("results", {}).items()} for run in runs]
    results = {key: _gathered(key, [point.get(key) for point in points], tuple(coords), shape)
               for key in dict.fromkeys(key for point in points for key in point)}
    status = numpy.array([run["status"] for run in runs], object).reshape(shape)
    messages = {index: run.get("message", "") for index, run in zip(numpy.ndindex(shape), runs)}
    warned = {index: run.get("warnings", ()) for index, run in zip(numpy.ndindex(shape), runs)}
    return Sweep(coords, results, status, messages, name=name, summary=tree, cost=tree.get("cost", {}),
                 warnings=tree.get("warnings", ()), point_warnings=warned, options=tree["provenance"].get("options", {}), provenance=tree["provenance"])


def from_hdf5(file: "h5py.File", name: str = "") -> Sweep:
    """A sweep from an open file of -output."""
    group, record = file["sweep"], dict(file["record"].attrs)
    axes = str(group.attrs["axes"]).split(",")
    coords = {axis: group[axis][:] for axis in axes}
    shape = tuple(map(len, coords.values()))
    results = {}
    for key, data in group.items():
        if key + "_error" in group:
            inner = str(data.attrs["abscissa"]) if "abscissa" in data.attrs else None
            ends = [group[key + end][()] for end in ("_low", "_high") if key + end in group]
            named = key.replace(":", "/")
            results[named] = Result(
                named, data[()], group[key + "_error"][()], str(data.attrs.get("unit", "")),
                tuple(axes) + ((inner,) if inner else ()), inner,
                _common(group[f"{key}_{inner}"][()]) if inner else None, numpy.stack(ends, -1) if ends else None)
    status = numpy.array([STATES[int(code)] for code in group["status"][()].ravel()], object).reshape(shape)
    options = options_in(file)
    return Sweep(coords, results, status, {}, name=name, options=options, warnings=warnings_in(record), provenance=record,
                 units={axis: str(group[axis].attrs.get("unit", "")) for axis in axes})


def from_csv(path: pathlib.Path) -> Sweep:
    """A sweep from the file of -sweep_csv, whose columns are scalars, such as displacement_cdf(10)[0.1]."""
    with open(path, newline="") as file:
        head, *rows = csv.reader(file)
    columns = dict(zip(head, zip(*rows)))
    keys = [key for key in head if key + "_error" in head]
    coords = {axis: numpy.array(list(dict.fromkeys(map(float, columns[axis])))) for axis in head[:head.index(keys[0])]}
    shape = tuple(map(len, coords.values()))

    def grid(key: str) -> "Array":
        return array([float(text) if text else None for text in columns[key]]).reshape(shape)

    results = {key: Result(key, grid(key), grid(key + "_error"), dims=tuple(coords)) for key in keys}
    return Sweep(coords, results, numpy.array(columns["status"], object).reshape(shape), {}, name=path.stem)
