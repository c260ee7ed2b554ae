"""What -compare found, the convergence that a study found, and error against time of every method."""

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from ..results import Results
from .style import (ABSCISSAE, COLOURS, MARKERS, STYLES, Figure, Line2D, Patch, matplotlib, numpy, paneled, styled, title,
                    units, without, words)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    Rows = dict[str, numpy.ndarray]

OURS, REFERENCE = COLOURS[:2]
WIDTH = 1.96  # of a 95 % confidence interval, in standard deviations to each side
COLUMNS = 3
METHODS = {"hp": ("hp elements", "degree"), "upwind": ("upwind", "p"), "richardson": ("upwind, Richardson", "p"),
           "monte_carlo": ("Monte Carlo", "excursions")}
CONVERGENCE = {"delta": r"step of the noise $\delta$  [force]", "tau": r"correlation time of the noise $\tau$  [time]",
               "p": "velocities of a noise step $p$"}  # what studies vary
PLACES = ("on a level", "between levels")  # of mu_s


@styled
def comparison(items: Sequence[Results]) -> "Figure":
    """Scalars in one panel, in standard deviations of the difference; each array in a panel of its own, with the
    deviations below."""
    (results,) = items
    groups = {key: rows for key, rows in results.comparison.items() if key != "E_V" or rows["value"].any()}
    scalars = {key: rows for key, rows in groups.items() if key in results and not results[key].dims}
    arrays = {key: rows for key, rows in groups.items() if key not in scalars}
    columns = min(COLUMNS, len(arrays)) or 1
    heights = [0.6] + [0.8 + 0.25 * len(scalars)] * bool(scalars) + [3.0 * -(-len(arrays) // columns)] * bool(arrays)
    figure = Figure(figsize=(max(6.4, 3.1 * columns), sum(heights)))
    parts = list(figure.subfigures(len(heights), 1, height_ratios=heights, squeeze=False)[:, 0])
    _legend(parts[0].subplots())
    if scalars:
        _scalars(parts[1].subplots(), scalars)
    if arrays:
        grid = parts[-1].add_gridspec(-(-len(arrays) // columns), columns)
        for n, (key, rows) in enumerate(arrays.items()):
            cell = grid[n // columns, n % columns].subgridspec(2, 1, height_ratios=(3, 1))
            above = parts[-1].add_subplot(cell[0])
            _array(above, parts[-1].add_subplot(cell[1], sharex=above), results, key, rows)
    return figure


def _deviation(rows: "Rows") -> "numpy.ndarray":
    """Of the difference, on the side of the reference on which our values are."""
    half = numpy.where(rows["value"] > rows["reference"], rows["high"] - rows["reference"],
                       rows["reference"] - rows["low"])
    return numpy.maximum(numpy.hypot(half / WIDTH, rows["error"]), 1e-300)


def _bars(rows: "Rows") -> "numpy.ndarray":
    """Lengths of the reference's error bars, downwards and upwards."""
    return numpy.array([rows["reference"] - rows["low"], rows["high"] - rows["reference"]])


def _scalars(axes: "Axes", scalars: "dict[str, Rows]") -> None:
    names = list(scalars)[::-1]
    for n, name in enumerate(names):
        rows, scale = scalars[name], _deviation(scalars[name])
        own = WIDTH * rows["error"] / scale
        axes.barh(n, 2 * own, left=-own, height=0.5, color=OURS, alpha=0.3)
        axes.plot([0, 0], [n - 0.25, n + 0.25], color=OURS, linewidth=2)
        axes.errorbar((rows["reference"] - rows["value"]) / scale, [n], xerr=_bars(rows) / scale, fmt="o",
                      color=REFERENCE, markersize=4, capsize=3)
        axes.text(1.02, n, f"{rows['value'][0]:.6g}", transform=axes.get_yaxis_transform(), va="center", fontsize=8)
    axes.text(1.02, 1.0, "computed", transform=axes.transAxes, va="bottom", fontsize=8)
    axes.axvspan(-WIDTH, WIDTH, color="#777777", alpha=0.1, linewidth=0)
    axes.set(yticks=range(len(names)), yticklabels=names, ylim=(-0.6, len(names) - 0.4),
             xlabel="reference minus computed  [standard deviations of the difference]")
    axes.grid(axis="y", visible=False)


def _array(above: "Axes", below: "Axes", results: Results, key: str, rows: "Rows") -> None:
    order = numpy.argsort(rows["argument"])
    at, value, error, reference, z = (rows[name][order] for name in ("argument", "value", "error", "reference", "z"))
    above.plot(at, value, color=OURS, linewidth=1.4)
    above.fill_between(at, value - WIDTH * error, value + WIDTH * error, color=OURS, alpha=0.3, linewidth=0)
    above.errorbar(at, reference, yerr=_bars(rows)[:, order], fmt="o", color=REFERENCE, markersize=2.5, elinewidth=1,
                   capsize=1.5)
    below.plot(at, -z, "o", color=REFERENCE, markersize=2.5)
    below.axhline(0, color=OURS, linewidth=1)
    below.axhspan(-WIDTH, WIDTH, color="#777777", alpha=0.12, linewidth=0)
    reach = max(3.5, 1.1 * numpy.abs(z).max())
    name = results[key].abscissa_name if key in results else "argument"
    below.set(xlabel=ABSCISSAE.get(name, name), ylim=(-reach, reach))
    below.set_ylabel("deviations", fontsize=8)
    if at[0] > 0 and at[-1] > 30 * at[0]:
        above.set_xscale("log")
    if key == "S_v":
        above.set_yscale("log")
    if key == "entry_law":
        below.xaxis.set_major_locator(matplotlib.ticker.MaxNLocator(integer=True))
    unit = results[key].unit if key in results else ""
    above.set_title(key + units(unit), fontsize=9)
    above.tick_params(labelbottom=False)


def _legend(axes: "Axes") -> None:
    handles = [Line2D([], [], color=OURS, label="computed"), Patch(color=OURS, alpha=0.3, label="computed, 95 %"),
               Line2D([], [], color=REFERENCE, marker="o", markersize=4, label="reference, 95 % confidence interval"),
               Patch(color="#777777", alpha=0.15, label=r"$\pm$1.96 standard deviations")]
    axes.legend(handles=handles, loc="center", ncol=2, columnspacing=1.2)
    axes.axis("off")


@styled
def cost(items: Sequence[Results]) -> "Figure":
    """Error against time of every method of -study cost."""
    (results,) = items
    figure = Figure(figsize=(6.4, 4.2))
    axes = figure.subplots()
    for n, (method, (name, parameter)) in enumerate(METHODS.items()):
        table = results.study.get(method)
        if table is None:
            continue
        axes.plot(table["seconds"], table["error"], color=COLOURS[n], linestyle=STYLES[n], marker=MARKERS[n],
                  markersize=4, label=name)
        ends = (((-7, -3), "right"), ((0, -13), "center")) if method == "monte_carlo" else (
            ((0, 7), "left"), ((7, -3), "left"))
        for end, (shift, side) in zip((0, -1), ends):
            value = table[parameter][end]
            label = (rf"$10^{{{math.log10(value):.0f}}}$ excursions" if parameter == "excursions" else
                    f"{parameter}{' ' if parameter == 'degree' else ' = '}{value:g}")
            axes.annotate(label, (table["seconds"][end], table["error"][end]), textcoords="offset points",
                          xytext=shift, ha=side, fontsize=8, color=COLOURS[n])
    axes.set(xscale="log", yscale="log", xlabel="time  [s]", ylabel="largest relative error")
    axes.margins(x=0.2, y=0.1)
    axes.legend(loc="lower right")
    axes.set_title(title(results), fontsize=9)
    return figure


@styled
def convergence(items: Sequence[Results]) -> "Figure":
    """Each scalar of a study against what it varies, with its limit in the band of the limit's error. Of the upwind scheme
    the values of Richardson's extrapolation are beside."""
    (results,) = items
    over, panels = results.study_kind, dict[str, dict[str, Any]]()
    for name, table in results.study.items():
        kind = next((kind for kind in PLACES if name.endswith(f" {kind}")), "")
        panels.setdefault(name.removesuffix(f" {kind}"), {})[kind] = table
    figure, places = paneled(len(panels))
    for axes, (key, tables) in zip(places, panels.items()):
        for n, (kind, table) in enumerate(tables.items()):
            look = {"color": COLOURS[n], "marker": MARKERS[n], "markersize": 4}
            axes.plot(table[over], table["value"], label=kind or None, **look)
            if "limit" in table:
                limit, error = table["limit"][-1], table["limit_error"][-1]
                axes.axhline(limit, color=COLOURS[n], linewidth=0.8, linestyle="--")
                axes.axhspan(limit - error, limit + error, color=COLOURS[n], alpha=0.2, linewidth=0)
            else:
                axes.plot(table[over], table["richardson"], linestyle="--", label="extrapolated", **look, mfc="white")
        axes.set(xscale="log", xlabel=CONVERGENCE[over], ylabel=words(key) + units(unit_of(results, key)))
        if axes.get_legend_handles_labels()[1]:
            axes.legend(fontsize=8)
    varied = ("tau", "delta") if over == "tau" else (over,)  # delta is a share of the deviation there
    figure.suptitle(title(without(results, varied)), fontsize=10)
    return figure


def unit_of(results: Results, key: str) -> str:
    """Of a scalar, as the runs of a study have it."""
    return next((run[key].unit for run in results.runs if key in run), "")
