"""Sweeps: each result, drift against the bias, and fragility curves."""

import statistics
from collections.abc import Sequence
from typing import TYPE_CHECKING

from ..results import Result, Results
from ..sweeps import Sweep
from . import style
from .fields import cells_around
from .style import (COLOURS, MARKERS, STYLES, Figure, bars, decades, known, numpy, on_axis, over, scale,
                    styled, symbol, title, units, without, words)

if TYPE_CHECKING:
    from matplotlib.axes import Axes

RING = {"linestyle": "", "marker": "o", "markersize": 10, "markerfacecolor": "none"}  # around points
FEW = 5  # curves distinguished by colour and line style
DRIFT = (("E_V", "drift $E[V]$"), ("diffusivity", "diffusivity $S_0/2$"), ("P_stick", "probability of sticking"))


@styled
def each(sweep: Sweep) -> "dict[str, Figure]":
    """A figure of each result, by key.

    One option is an axis, errors are bars; of two options the second is the axis and the first one distinguishes
    curves, up to five values, or makes a map of more. Further options stay at their first value, which the title
    shows. Points that fell short are marked by crosses, those that warnings concern by rings. An array of more places than the last option has values is
    drawn against its abscissa, a curve for each value of the last option; any other against the last option, a curve for
    each place of its abscissa. There are at most five curves, as the title says; the other options stay at their first
    value.
    """
    return {key: one(sweep, key) for key in sweep}


@styled
def one(sweep: Sweep, key: str) -> "Figure":
    """The figure of one result, as in `each`."""
    axes = Figure(figsize=(6.4, 4.2)).subplots()
    into(axes, sweep, key)
    return axes.figure


def into(axes: "Axes", sweep: Sweep, key: str, label: str | None = None) -> None:
    """One result in axes, as in `each`, beside curves that are there; the label is that of a single curve."""
    if sweep[key].dims == sweep.dims:
        _scalar(axes, sweep, sweep[key], label)
    else:
        _array(axes, sweep, sweep[key])


def _array(axes: "Axes", sweep: Sweep, result: Result) -> None:
    *others, last = sweep.dims
    values = sweep.coords[last]
    if result.abscissa.ndim == 1 and len(result.abscissa) < len(values) and result.abscissa_name != "slip":
        _against_option(axes, sweep, result)
        return
    shown = _some(len(values))
    for n, point in enumerate(shown):
        at = (0,) * len(others) + (point,)
        abscissa = result.abscissa if result.abscissa.ndim == 1 else result.abscissa[at]
        one = Result(result.key, result.value[at], result.error[at], result.unit, result.dims[-1:],
                     result.abscissa_name, abscissa, None if result.ci95 is None else result.ci95[at])
        style.curve(axes, one, n, label=f"{symbol(last)} = {values[point]:g}")
    low, high = numpy.nanmin(result.value), numpy.nanmax(result.value)
    axes.set(xscale=scale(abscissa), xlabel=over(result), ylabel=_label(sweep, result.key),
             **({"yscale": "log", "ylim": (low / 2, high * 2)} if 0 < 100 * low < high else {}))
    _title(axes, sweep, others, len(shown), len(values))
    axes.legend()


def _some(count: int) -> "numpy.ndarray":
    """At most `FEW` places of so many, evenly."""
    return numpy.unique(numpy.linspace(0, count - 1, min(FEW, count)).round().astype(int))


def _against_option(axes: "Axes", sweep: Sweep, result: Result) -> None:
    """A curve over the last swept option for each place of the abscissa, as fragility curves are drawn."""
    *others, last = sweep.dims
    first, x, shown = (0,) * len(others), sweep.coords[last], _some(len(result.abscissa))
    sign = over(result).partition("$")[2].partition("$")[0]
    for n, place in enumerate(shown):
        curve(axes, x, result.value[first][:, place], result.error[first][:, place], n,
              f"${sign}$ = {result.abscissa[place]:g}" if sign else f"{result.abscissa_name} = {result.abscissa[place]:g}",
              None if result.ci95 is None else result.ci95[first][:, place], sweep, first)
    axes.set(xscale=scale(x), xlabel=_label(sweep, last), ylabel=_label(sweep, result.key))
    _title(axes, sweep, others, len(shown), len(result.abscissa))
    axes.legend()


def _scalar(axes: "Axes", sweep: Sweep, result: Result, label: str | None) -> None:
    names, first = sweep.dims[:2], (slice(None),) * min(2, len(sweep.dims)) + (0,) * (len(sweep.dims) - 2)
    value, error = result.value[first], result.error[first]
    ci95 = None if result.ci95 is None else result.ci95[first]
    _title(axes, sweep, sweep.dims[2:])
    if len(names) == 2 and len(value) > FEW:
        _map(axes, sweep, result, first)
        return
    x = sweep.coords[names[-1]]
    rows = [numpy.s_[:]] if len(names) == 1 else range(len(value))
    for n, row in enumerate(rows, len(axes.containers)):
        label = f"{symbol(names[0])} = {sweep.coords[names[0]][row]:g}" if len(names) == 2 else label
        at = first if len(names) == 1 else (row, *first[1:])
        curve(axes, x, value[row], error[row], n, label, None if ci95 is None else ci95[row], sweep, at)
    if label:
        axes.legend()
    axes.set(xscale=scale(x), xlabel=_label(sweep, names[-1]), ylabel=_label(sweep, result.key))
    if scale(x) == "log" and x.max() < 100 * x.min():  # powers of ten alone would be one or two
        decades(axes.xaxis)


def curve(axes: "Axes", x: "numpy.ndarray", value: "numpy.ndarray", error: "numpy.ndarray", n: int = 0,
          label: str | None = None, ci95: "numpy.ndarray | None" = None, sweep: Sweep | None = None,
          at: tuple = ()) -> None:
    """A scalar against a swept option: line and error bars; marks with intervals where simulated. Of the points of a sweep
    at an index those that fell short and those that warnings concern are marked."""
    colour, order = COLOURS[n % len(COLOURS)], numpy.argsort(x)
    if ci95 is not None:
        bars(axes, x[order], value[order], ci95[order], colour, label, MARKERS[n % 5])
    else:
        axes.errorbar(x[order], value[order], yerr=error[order], color=colour, marker=MARKERS[n % 5],
                      linestyle=STYLES[n % len(STYLES)], markersize=4, capsize=2, label=label)
    if sweep is not None:
        short, warned = (sweep.status != "reached")[at], sweep.concerned[at]
        axes.plot(x[short], value[short], linestyle="", marker="x", markersize=9, color=colour)
        axes.plot(x[warned], value[warned], color=colour, **RING)


def _edges(values: "numpy.ndarray") -> "numpy.ndarray":
    """Edges of cells around rising values, halfway between them on their axis."""
    return numpy.exp(cells_around(numpy.log(values))) if scale(values) == "log" else cells_around(values)


def _map(axes: "Axes", sweep: Sweep, result: Result, at: tuple) -> None:
    value = result.value[at]
    down, across = sweep.dims[:2]
    y, x = sweep.coords[down], sweep.coords[across]
    rows, columns = numpy.argsort(y), numpy.argsort(x)
    ordered = value[rows][:, columns]
    # The scales come first: labels of contours stand where there is room on the axes as they are.
    axes.set(xscale=scale(x), yscale=scale(y), xlabel=_label(sweep, across), ylabel=_label(sweep, down))
    axes.set_facecolor("0.8")  # of points without a result
    mesh = axes.pcolormesh(_edges(x[columns]), _edges(y[rows]), ordered, cmap="cividis")
    known = numpy.ma.masked_invalid(ordered)
    if len(columns) > FEW and known.count() > FEW and known.max() > known.min():  # numpy.ptp of NumPy 2 ignores masks
        lines = axes.contour(x[columns], y[rows], known, colors="white", linewidths=0.8)
        axes.clabel(lines, fontsize=7)
    for marked, look in ((sweep.status != "reached", {"linestyle": "", "marker": "x"}), (sweep.concerned, RING)):
        where = numpy.argwhere(marked[at])
        axes.plot(x[where[:, 1]], y[where[:, 0]], color="white", **look)
    axes.figure.colorbar(mesh, ax=axes, label=_label(sweep, result.key))
    for axis, values in ((axes.xaxis, x), (axes.yaxis, y)):
        if scale(values) == "log":
            decades(axis)
    axes.grid(False)


def _title(axes: "Axes", sweep: Sweep, held: Sequence[str], shown: int = 0, count: int = 0) -> None:
    """The parameters that were not swept; in another line the first values of those that the picture holds, and how many
    curves of all are shown."""
    first = [f"{symbol(name)} = {sweep.coords[name][0]:g}, the first of {len(sweep.coords[name])} values" for name in held]
    picked = [f"{shown} of {count} values"] * (shown < count) + ["rings: points with warnings"] * bool(sweep.concerned.any())
    axes.set_title("\n".join(filter(None, [title(without(sweep, sweep.dims)), ", ".join([*first, *picked])])), fontsize=9)


def _label(sweep: Sweep, name: str) -> str:
    if name in sweep:
        return words(name) + units(sweep[name].unit)
    return on_axis(name) + units(sweep.units.get(name) or known().get(name, {}).get("unit", ""))


@styled
def drift(items: Sequence[Results]) -> "Figure":
    """Drift, diffusivity and probability of sticking against the bias."""
    (sweep,) = items
    if any(key not in sweep for key, _ in DRIFT):
        raise ValueError("drift needs a sweep of the bias with -quantities sticking,moments,spectrum")
    figure = Figure(figsize=(6.4, 3.8))
    axes = figure.subplots()
    for n, (key, label) in enumerate(DRIFT):
        curve(axes, sweep.coords["bias"], sweep[key].value, sweep[key].error, n, label, sweep[key].ci95)
    axes.set(xlabel="bias $g$  [force]", ylim=(0, None), xlim=(0, None))
    axes.legend(loc="best")
    return figure


@styled
def fragility(items: Sequence[Results]) -> "Figure":
    """P(|x(t)| > d) over the strength that was swept, for each d of which the distances have both signs, and the lognormal
    distribution function nearest to it, whose median and logarithmic standard deviation the legend has."""
    (sweep,) = items
    axes, normal = Figure(figsize=(6.4, 4.2)).subplots(), statistics.NormalDist()
    (name, strength), keys = *sweep.coords.items(), [key for key in sweep if key.startswith("displacement_cdf(")]
    fine = numpy.linspace(strength.min(), strength.max(), 201)
    for key in keys:
        d, cdf, error = sweep[key].abscissa, sweep[key].value, sweep[key].error
        for high in numpy.flatnonzero((d > 0) & numpy.isin(-d, d)):
            low, n = numpy.flatnonzero(d == -d[high])[0], len(axes.containers)
            p, bar = 1 - cdf[:, high] + cdf[:, low], error[:, high] + error[:, low]
            inside, label = (p > bar) & (p < 1 - bar), f"$P(|x({key[17:-1]})| > {d[high]:g})$"
            if inside.sum() > 1:
                z = numpy.array([normal.inv_cdf(one) for one in p[inside]])
                slope, begin = numpy.polyfit(numpy.log(strength[inside]), z, 1, w=numpy.exp(-z**2 / 2))  # nearest in p
                axes.plot(fine, [normal.cdf(begin + slope * x) for x in numpy.log(fine)], color=COLOURS[n % 5], zorder=1)
                label += f": median {numpy.exp(-begin / slope):.3g}, deviation of the logarithm {1 / slope:.2g}"
            axes.errorbar(strength, p, bar, fmt=MARKERS[n % 5], color=COLOURS[n % 5], markersize=4, capsize=2, label=label)
    if not axes.containers:
        raise ValueError("fragility needs a sweep with displacement_distribution whose -distance has both signs, such as -0.1,0.1")
    axes.set(xlabel=_label(sweep, name), ylabel="probability of exceedance", ylim=(-0.02, 1.02))
    _title(axes, sweep, ())
    axes.legend(fontsize=8)
    return axes.figure
