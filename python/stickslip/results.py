"""What a run computed, as data: results with their errors, fields, and where they come from."""

import dataclasses
import difflib
import html
import json
import math
import os
import pathlib
from collections.abc import Callable, Iterable, Iterator, KeysView, Mapping
from typing import TYPE_CHECKING, Any

from .density import Density
from .needed import needed
from .program import ProgramError, warn
from .views import viewed

if TYPE_CHECKING:
    import h5py
    import numpy
    import pandas
    import xarray
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    Array = numpy.ndarray
numpy = needed("numpy")

PARTS = ("value", "error", "unit", "ci95", "low", "high", "reason")  # of a result; what else there is, is the abscissa


@dataclasses.dataclass(frozen=True, eq=False)
class Result:
    """One quantity. Arithmetic and comparisons, such as `r["P_stick"] * 2`, are those of the value: errors do not go along.

    Attributes
    ----------
    key
        Its name, such as "P_stick".
    value
        A number, or an array.
    error
        Absolute error estimate, of the shape of `value`; NaN where there is none.
    unit
        In words, such as "velocity^2*time"; empty where there is none.
    dims
        Names of the dimensions of `value`: () of a number, ("omega",) of a spectrum. In a sweep the swept options
        come first.
    abscissa_name, abscissa
        What an array depends on, such as "omega", and its values; None for numbers. In a sweep whose points have
        abscissae of their own, `abscissa` has the shape of `value`.
    ci95
        Ends of the 95 % confidence interval in the last dimension, where simulated; else None.
    sweep
        The sweep that it belongs to, or None.
    """

    key: str
    value: "float | Array"
    error: "float | Array"
    unit: str = ""
    dims: tuple[str, ...] = ()
    abscissa_name: str | None = None
    abscissa: "Array | None" = None
    ci95: "tuple[float, float] | Array | None" = None
    sweep: "Results | None" = None

    def __float__(self) -> float:
        return float(self.value)

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> "Array":
        """The value, for `numpy.asarray`."""
        found = numpy.asarray(self.value, dtype)
        return found.copy() if copy else found

    def __format__(self, form: str) -> str:
        """A number in a form such as ".3f"; with its error "S" is 0.15648616(2), and "L" that in \\num{} of siunitx."""
        if form in ("S", "L"):
            short = in_short(self.value, self.error)
            return short if form == "S" else rf"\num{{{short}}}"
        return format(self.value, form) if form else str(self)

    @property
    def _shown(self) -> str:
        if numpy.ndim(self.value) == 0:
            return f"{to_its_error(self.value, self.error)} +- {self.error:.1e}"
        return f"{' x '.join(map(str, numpy.shape(self.value)))} values by {', '.join(self.dims)}"

    def __repr__(self) -> str:
        return f"{self.key} = {self._shown}{f' [{self.unit}]' if self.unit else ''}"

    def _repr_html_(self) -> str:
        if numpy.ndim(self.value) != 1 or numpy.ndim(self.abscissa) != 1:
            return html.escape(repr(self))
        return _table((self.abscissa_name or "", self.key + f" [{self.unit}]" * bool(self.unit), "error"), [
            (f"{x:g}", to_its_error(value, error), f"{error:.1e}")
            for x, value, error in zip(self.abscissa, self.value, self.error)])

    def plot(self, axes: "Axes | None" = None, **look: Any) -> "Axes":
        """Draw an array against what it depends on, or a result of a sweep against the swept options, with errors or
        confidence intervals.

        Parameters
        ----------
        axes
            Where to; without it, the current ones of `matplotlib.pyplot`. Their labels are set, their scales are not.
        look
            `colour`, `style` and `label` of the curve; of a sweep over one option `label`.

        Returns
        -------
        axes

        Raises
        ------
        ValueError
            If this is a number.
        """
        if self.sweep is None and (numpy.ndim(self.value) != 1 or self.abscissa is None):
            raise ValueError(f"{self.key}: is no array over one abscissa; matplotlib's errorbar draws numbers")
        return viewed("picture", self, axes, **look)


def _of_values(name: str) -> Callable[..., Any]:
    def operation(self: Result, *other: Any) -> Any:
        return getattr(numpy.asarray(self), name)(*map(numpy.asarray, other))
    return operation


for _name in ("neg", "abs", "lt", "le", "gt", "ge", *(side + name for side in ("", "r") for name in (
        "add", "sub", "mul", "truediv", "pow"))):
    setattr(Result, f"__{_name}__", _of_values(f"__{_name}__"))


class Results(Mapping):
    """Results of one run, by key.

    Attributes
    ----------
    scene, options
        Parameters as they were used, and every option as text; empty where it belongs to no effect in use.
    cost, plan, provenance
        Seconds and sizes, counts of what was done, versions and machine.
    accuracy
        `asked`, `reached` and, if missed, `shortfall`.
    density
        The stationary distribution, or None.
    trajectory
        `time`, `x`, `y`, `v` of one path just after each event, or None.
    modes
        Modes of the generator by group ("relaxation_even"), if asked for.
    comparison
        With `compare`: by key the columns `argument`, `value`, `error`, `reference`, `low`, `high` and `z`; or None.
    study
        With `study`: tables by name, each with columns by name; or None. `runs` has the results of its runs, and the
        results by key are the limits, where the study has limits.
    warnings
        What the program warned of, in sentences.
    summary
        All that `-summary` wrote; empty after reading HDF5.
    name
        Of the file, without its folder and ending; empty after a run.
    """

    def __init__(self, results: Mapping[str, Result], *, options: Mapping[str, str] | None = None, name: str = "",
                 summary: Mapping[str, Any] | None = None, **parts: Any) -> None:
        self._results = dict(results)
        self.name = name
        self.summary: dict[str, Any] = dict(summary or {})
        self.options: dict[str, str] = dict(options or {})
        self.scene: dict[str, Any] = parts.get("scene", {})
        self.cost: dict[str, Any] = parts.get("cost", {})
        self.plan: dict[str, Any] = parts.get("plan", {})
        self.provenance: dict[str, Any] = parts.get("provenance", {})
        self.accuracy: dict[str, Any] = parts.get("accuracy", {})
        self.warnings: list[str] = list(parts.get("warnings", ()))
        self.density: Density | None = parts.get("density")
        self.trajectory: "dict[str, Array] | None" = parts.get("trajectory")
        self.modes: dict[str, Any] = parts.get("modes", {})
        self.comparison: "dict[str, dict[str, Array]] | None" = parts.get("comparison")
        self.study: "dict[str, dict[str, Array]] | None" = parts.get("study")
        self.study_kind: str = parts.get("study_kind", "")
        self.runs: list[Results] = parts.get("runs", [])

    def __getitem__(self, key: str) -> Result:
        if key in self._results:
            return self._results[key]
        computed, near = _computed_by(str(key)), closest(str(key), self._results)
        there = f"{computed}there are {', '.join(self._results) or 'no scalars and arrays'}"
        raise KeyError(f"{key}: " + (f"did you mean {near}?" if near and not computed else there))

    def keys(self) -> "KeysView[str]":
        """Keys of the results, as of a dict."""
        return self._results.keys()

    def __contains__(self, key: object) -> bool:
        return key in self._results

    def __iter__(self) -> Iterator[str]:
        return iter(self._results)

    def __len__(self) -> int:
        return len(self._results)

    __eq__, __hash__ = object.__eq__, object.__hash__  # arrays have no truth value

    def __repr__(self) -> str:
        if self:
            return "\n".join(map(repr, self.values()))
        held = [part for part in ("density", "trajectory", "modes", "comparison", "study", "runs", "plan", "summary")
                if getattr(self, part)]
        return f"<{type(self).__name__} without scalars and arrays; there are {', '.join(held) or 'options'}>"

    def _repr_html_(self) -> str:
        """A table, as notebooks show it."""
        rows = [(key, one._shown, one.unit) for key, one in self.items()]
        return _table(("", "value +- error", "unit"), rows) if rows else html.escape(repr(self))

    def _ipython_key_completions_(self) -> list[str]:
        return list(self)

    @property
    def slips(self) -> "Array":
        """The slips under a given force, a row each: begin, end [time], displacement and peak velocity. The fields of the
        array have these names; `pandas.DataFrame(r.slips)` is a table.

        Raises
        ------
        KeyError
            If these are no results of one run under a given force.
        """
        if "slip_count" not in self or self["slip_count"].dims:
            raise KeyError("slips: one run with quantities=\"given_force\" has them; slip_begin and so on of a sweep are arrays")
        names = ("begin", "end", "displacement", "peak")
        columns = [self[f"slip_{name}"].value for name in names] if "slip_begin" in self else numpy.empty((4, 0))
        return numpy.array(list(zip(*columns)), [(name, float) for name in names])

    @property
    def reached(self) -> bool:
        """Whether the accuracy asked for was reached."""
        return bool(self.accuracy.get("reached", True))

    def plot(self, picture: str | pathlib.Path | None = None, kind: str | None = None) -> "dict[str, Figure]":
        """Draw what there is.

        Parameters
        ----------
        picture
            Where to save; of several figures each has its name appended. Those of a sweep, one for each result, go into
            a folder: sweep.png and sweep both name the folder sweep. With `kind` a sweep has one figure, saved there.
        kind
            One of `stickslip.plots.KINDS`, or a key of a sweep; without it, all that fit.

        Returns
        -------
        figures
            By kind; those of a sweep by the key of the result.
        """
        return viewed("picture", self, picture, kind)

    def to_pandas(self, *options: str) -> "pandas.DataFrame":
        """A table with a row for each number.

        Parameters
        ----------
        options
            Names of options that get a column too, such as those in which the cases of `map` differ.

        Returns
        -------
        table
            Columns `key`, the swept options and what arrays depend on (NaN where a result does not depend on it), `value`
            and `error` [unit], for simulated results the ends `low` and `high` of 95 % confidence intervals, and `unit`.

        Raises
        ------
        KeyError
            If there is no such option.
        ImportError
            Without pandas.

        Examples
        --------
        >>> rows = stickslip.map([{"mu_d": 0.25}, {"mu_d": 0.5, "tau": 2}], quantities="sticking")
        >>> pandas.concat([r.to_pandas("mu_d", "tau") for r in rows])
        """
        return viewed("table", self, options)

    def to_xarray(self) -> "xarray.Dataset":
        """A data set with a variable for each key.

        Returns
        -------
        dataset
            Dimensions are the swept options, then what an array depends on; both are coordinates. Beside KEY stands
            KEY_error, for simulated results KEY_low and KEY_high, the ends of 95 % confidence intervals. Attributes
            `units` are those of the program, attributes of the data set its options. Where results depend on different
            values of the same, such as lags, the later ones have dimensions KEY_NAME of their own; where points of a
            sweep do, the dimension is KEY_number and the coordinate KEY_NAME.

        Raises
        ------
        ImportError
            Without xarray.
        """
        return viewed("dataset", self)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the summary as JSON, which `stickslip.load` reads.

        Parameters
        ----------
        path
            Ends with .json. Fields (density, path, modes) are in HDF5 files alone, which `run(keep=...)` leaves; a warning
            names those that are left out.

        Raises
        ------
        ValueError
            If the path ends otherwise, or these results come from HDF5 or CSV and have no summary.
        """
        path = pathlib.Path(path)
        if path.suffix != ".json":
            raise ValueError(f"path = {path}: must end with .json; run(keep=...) leaves HDF5, to_pandas() writes tables")
        if not self.summary:
            raise ValueError(f"results of {self.name or 'a file'} have no summary; copy the file that they come from")
        path.write_text(json.dumps(self.summary, indent=1) + "\n")
        if left := ", ".join(part for part in ("density", "trajectory", "modes") if getattr(self, part)):
            warn(f"{path}: JSON does not hold {left}; run(keep=...) leaves HDF5, which does")


def to_its_error(value: float, error: float) -> str:
    """A number to the first digit of its error, as the program prints it; all digits of what is exact."""
    if not (math.isfinite(error) and error > 0 and value and math.isfinite(value)):
        return f"{value:.17g}" if error == 0 else f"{value:.7g}"
    digits = math.floor(math.log10(abs(value))) - math.floor(math.log10(error)) + 1
    return f"{value:.{min(max(digits, 1), 17)}g}"


def in_short(value: float, error: float) -> str:
    """A number with the first digit of its error in brackets: 0.15648616(2), 1.3(2)e-09. All digits of what is exact."""
    if not (math.isfinite(error) and error > 1e-16 * abs(value)):
        return to_its_error(value, error)
    power = math.floor(math.log10(max(abs(value), error)))
    scale = 0 if -5 < power < 15 else power
    digit, place = (int(part) for part in f"{error:.0e}".split("e"))
    decimals = max(scale - place, 0)
    digits = f"{round(value, -place) / 10**scale:.{decimals}f}({digit * 10**max(place - scale, 0)})"
    return digits + (f"e{scale:+03d}" if scale else "")


def _table(head: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    """A table as HTML."""
    def line(cells: Iterable[str], mark: str) -> str:
        return "<tr>" + "".join(f"<{mark}>{html.escape(cell)}</{mark}>" for cell in cells) + "</tr>"
    return f"<table>{line(head, 'th')}{''.join(line(row, 'td') for row in rows)}</table>"


def closest(name: str, names: Iterable[str]) -> str | None:
    """The most similar of some names, first of all one that differs in the case of letters; None if none is similar."""
    alike = [other for other in names if other.lower() == name.lower()]
    return next(iter(alike or difflib.get_close_matches(name, names, 1, 0.6)), None)


def _computed_by(key: str) -> str:
    """Which quantity a key of the program belongs to; empty where there is none to ask, or it does not know it."""
    from .reference import keys
    try:
        return f'quantities="{keys()[key][0]}" computes it; ' if key in keys() else ""
    except ProgramError:
        return ""


def array(values: Any) -> "Array":
    """Numbers of JSON; null, which stands for what is no number, becomes NaN."""
    return numpy.asarray(values, float)


def _number(values: "Array") -> "float | Array":
    return float(values) if values.ndim == 0 else values


def result_of(key: str, parts: Mapping[str, Any]) -> Result:
    """A result of the summary, or of /results of HDF5."""
    name = next((part for part in parts if part not in PARTS), None)
    value = array(parts["value"])
    ci95 = None
    if "ci95" in parts:  # null where an interval is infinite
        ends = parts["ci95"] if value.ndim else [parts["ci95"]]
        ci95 = numpy.array([[-math.inf if low is None else low, math.inf if high is None else high]
                            for low, high in ends], float)
    elif "low" in parts:
        ci95 = numpy.stack([array(parts["low"]), array(parts["high"])], -1).reshape(-1, 2)
    if ci95 is not None and not value.ndim:
        ci95 = tuple(ci95[0].tolist())
    error = array(parts.get("error")) if "error" in parts else numpy.full(value.shape, math.nan)
    return Result(key, _number(value), _number(error), str(parts.get("unit", "")), (name,) if name else (), name,
                  array(parts[name]) if name else None, ci95)


def from_summary(tree: Mapping[str, Any], name: str = "") -> Results:
    """Results of one run, or of a study, from the tree of a summary."""
    parts = {key: tree[key] for key in ("scene", "cost", "plan", "accuracy", "provenance", "warnings") if key in tree}
    options = tree.get("provenance", {}).get("options", {})
    if "comparison" in tree:
        parts["comparison"] = _comparison(tree["comparison"]["rows"])
    if "study" in tree:
        parts["study"] = {title: {column: array(values) for column, values in table.items() if isinstance(values, list)}
                          for title, table in tree["study"]["tables"].items()}
        parts["study_kind"] = tree["study"]["kind"]
        parts["runs"] = [from_summary({"provenance": tree["provenance"], **run}) for run in tree["runs"]]
    results = {key: result_of(key, result) for key, result in tree.get("results", {}).items()}
    results |= _limits(parts.get("study", {}))
    return Results(results, options=options, name=name, summary=tree, **parts)


def _limits(tables: "Mapping[str, Mapping[str, Array]]") -> dict[str, Result]:
    """What the tables of a study have as limits in their last rows."""
    return {name: Result(name, float(table["limit"][-1]), float(table["limit_error"][-1]))
            for name, table in tables.items() if "limit" in table}


def _comparison(rows: list[dict[str, Any]]) -> "dict[str, dict[str, Array]]":
    """Columns by quantity, as HDF5 has them."""
    found: dict[str, dict[str, list]] = {}
    for row in rows:
        columns = found.setdefault(row["quantity"], {})
        low, high = row["ci95"]
        row = {**row, "argument": row.get("argument"), "low": low, "high": high}
        for column in ("argument", "value", "error", "reference", "low", "high", "z"):
            columns.setdefault(column, []).append(row[column])
    return {key: {column: array(values) for column, values in columns.items()} for key, columns in found.items()}


def _datasets(group: "h5py.Group") -> dict[str, Any]:
    """Datasets and groups by name, to any depth."""
    return {key: _datasets(part) if hasattr(part, "items") else part[()] for key, part in group.items()}


def from_hdf5(file: "h5py.File", name: str = "") -> Results:
    """Results of an open file of -output."""
    record, options = dict(file["record"].attrs), options_in(file)
    parts: dict[str, Any] = {
        "provenance": record, "warnings": warnings_in(record), "cost": {"seconds": float(record.get("seconds", math.nan))}, **fields(file),
        "scene": {key: parameter(value) for key, value in options.items()},
        "accuracy": {"asked": parameter(options.get("accuracy", "")),
                     "reached": str(record.get("accuracy_reached", "yes")) == "yes"}}
    if "comparison" in file:
        parts["comparison"] = _datasets(file["comparison"])
    if "study" in file:
        parts |= {"study": _datasets(file["study"]), "study_kind": str(file["study"].attrs["kind"])}
    results = {}
    for group, data in file.get("results", {}).items():
        key = group.replace(":", "/")  # names of groups have no /
        results[key] = result_of(key, {**dict(data.attrs), **_datasets(data)})
    results |= _limits(parts.get("study", {}))
    return Results(results, options=options, name=name, **parts)


def options_in(file: "h5py.File") -> dict[str, str]:
    """The options as used, by name; those without effect are empty."""
    record = file["record"].attrs
    unused = str(record.get("options_without_effect", "")).split(",")
    return dict.fromkeys(filter(None, unused), "") | {
        key: str(value) for key, value in file["record/options"].attrs.items()}


def warnings_in(record: dict[str, Any]) -> list[str]:
    """The warnings among the attributes of /record of HDF5, taken out of them."""
    return str(record.pop("warnings", "")).splitlines()


def parameter(text: str) -> Any:
    """A number where the option is one."""
    try:
        return float(text)
    except ValueError:
        return text


def fields(file: "h5py.File") -> dict[str, Any]:
    """What only HDF5 holds: density, path and modes."""
    found: dict[str, Any] = {"modes": {key: _datasets(file[key]) for key in file if key.startswith("relaxation")}}
    if "density" in file:
        data = _datasets(file["density"])
        found["density"] = Density(
            *(data[part] for part in ("x", "v", "pdf", "atom", "marginal_x", "marginal_v", "weights", "cells")),
            float(file["density"].attrs.get("error_of_distribution_function_of_speed", math.nan)),
            data.get("state", numpy.arange(len(data["x"]))).astype(int),
            data.get("position", {}))
    if "trajectory" in file:
        found["trajectory"] = _datasets(file["trajectory"])
    return found


def reading(path: pathlib.Path, kind: str, option: str, read: Callable[[], Any]) -> Any:
    """What `read` returns; a file that is not of its kind is reported as such."""
    try:
        return read()
    except FileNotFoundError:
        raise FileNotFoundError(f"{path}: no such file; the program writes it with {option} {path}") from None
    except (OSError, ValueError, KeyError, IndexError, TypeError, AttributeError) as problem:
        reason = str(problem).splitlines()[0] if str(problem) else type(problem).__name__
        raise ValueError(f"{path}: cannot be read as {kind} of this program: {reason}") from None
