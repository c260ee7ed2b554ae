"""Results as tables of pandas and data sets of xarray."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from .needed import needed
from .program import ProgramError
from .reference import declared
from .results import Result, Results, closest, parameter
from .views import view

if TYPE_CHECKING:
    import pandas
    import xarray
numpy = needed("numpy")


def _unit(results: Results, name: str) -> str:
    """Of an option or an abscissa: as the file has it, or as the program says; empty where neither does."""
    return getattr(results, "units", {}).get(name) or _known(name).get("unit", "")


def _known(name: str) -> Mapping[str, Any]:
    """What the program declares of an option; nothing where there is none to ask, or none of that name."""
    try:
        return declared().get(name, {})
    except ProgramError:
        return {}


def _columns(results: Results, result: Result) -> dict[str, Any]:
    """Swept options, abscissa, value, error and interval of a result, a row each."""
    value = numpy.asarray(result.value, float)
    swept = getattr(results, "coords", {})
    grids = {name: numpy.asarray(swept[name]).reshape([-1 if m == n else 1 for m in range(value.ndim)])
             for n, name in enumerate(result.dims) if name in swept}
    if result.abscissa is not None:
        grids[result.abscissa_name] = result.abscissa
    found = {name: numpy.broadcast_to(grid, value.shape).ravel() for name, grid in grids.items()}
    found |= {"value": value.ravel(), "error": numpy.asarray(result.error, float).ravel()}
    if result.ci95 is not None:
        found |= dict(zip(("low", "high"), numpy.asarray(result.ci95, float).reshape(-1, 2).T))
    return found


@view("table", Results)
def to_pandas(results: Results, options: Sequence[str] = ()) -> "pandas.DataFrame":
    """One row for each number, in the order of the results; what a result does not have is NaN."""
    pandas = needed("pandas")
    tables = [pandas.DataFrame({"key": key, **_columns(results, one), "unit": one.unit}) for key, one in results.items()]
    table = pandas.concat(tables, ignore_index=True) if tables else pandas.DataFrame(columns=["key", "value", "error", "unit"])
    for at, name in enumerate(options, 1):
        if name not in results.options:
            raise KeyError(f"{name}: is no option" + (f"; did you mean {near}?" if (near := closest(name, results.options))
                                                      else ""))
        table.insert(at, name, parameter(results.options[name]))
    last = [name for name in ("value", "error", "low", "high", "unit") if name in table]
    return table[[name for name in table if name not in last] + last]


@view("dataset", Results)
def to_xarray(results: Results) -> "xarray.Dataset":
    """Variables by key, with their errors as KEY_error and the ends of intervals as KEY_low and KEY_high."""
    swept = {name: (name, values, {"units": _unit(results, name)}) for name, values in getattr(results, "coords", {}).items()}
    variables, coords = {}, dict(swept)
    for key, one in results.items():
        dims, name, attributes = one.dims, one.abscissa_name, {"units": one.unit}
        if one.abscissa is not None:
            axis = {"units": _unit(results, name)}
            same = name not in coords or numpy.array_equal(coords[name][1], one.abscissa)
            if one.abscissa.ndim > 1:  # each point of a sweep has its own
                dims = (*dims[:-1], f"{key}_number")
                coords[f"{key}_{name}"] = (dims, one.abscissa, axis)
            else:  # another result may have other values of the same
                named = name if same else f"{key}_{name}"
                dims = (*dims[:-1], named)
                coords[named] = (named, one.abscissa, axis)
        variables[key] = (dims, one.value, attributes)
        variables[f"{key}_error"] = (dims, one.error, attributes)
        if one.ci95 is not None:
            ends = numpy.asarray(one.ci95, float)
            variables |= {f"{key}_{end}": (dims, ends[..., n], attributes) for n, end in enumerate(("low", "high"))}
    return needed("xarray").Dataset(variables, coords, {
        name: text for name, text in results.options.items() if text and _known(name).get("group") != "Output"})
