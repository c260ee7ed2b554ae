"""Arrays against what they depend on: spectra, durations, slips, anything else; and the correlation time."""

import dataclasses
import re
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from ..results import Result, Results
from .distributions import is_part
from .style import (ABSCISSAE, COLOURS, MARKERS, STYLES, Figure, Line2D, curve, decades, drag, fraction, memory,
                    number, numpy, over, paneled, scale, step, styled, title, units, words)

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# Keys of a panel, label of the values, scales of abscissa and values.
Panel = tuple[tuple[str, ...], str, str, str]
SLIPS: tuple[Panel, ...] = (
    (("f_slip",), "$f_S(d)$  [1/length]", "log", "log"),
    (("cdf_slip",), r"$P(S \leq d)$", "log", "linear"),
    (("F_slip",), r"$E[e^{-s S}]$", "log", "linear"),
    (("P_peak",), "P(largest speed $> w$)", "linear", "log"),
    (("mean_first_passage", "mean_first_passage_rest"), "mean time to $|V| = w$  [time]", "linear", "log"),
    (("first_passage_mean",), "mean time to the speed $w$  [time]", "linear", "log"),
    (("displacement_variance",), "Var $x(t)$  [length$^2$]", "log", "log"),
    (("displacement_mean",), "$E[x(t)]$  [length]", "linear", "linear"))
SPELT = {"mean_first_passage": "from the start of sliding", "mean_first_passage_rest": "from rest"}
DURATIONS = {"f_stick": ("sticking", COLOURS[1]), "f_slide": ("sliding", COLOURS[0]),
             "f_excursion": ("excursion", COLOURS[4])}
OF_A_FORCE = ("slip_begin", "slip_end", "slip_displacement", "slip_peak", "path_force", "path_velocity",
              "path_displacement")
LINES = ("-", (0, (1, 1)), (0, (4, 1.5)))
WHITE_NOISE = {("0", 1): 1.35446038, ("-v", 1): 0.247854704305}  # t_corr for tau -> 0 at mu_d = mu_s = 1


@styled
def spectra(items: Sequence[Results]) -> "Figure":
    """Power spectral densities of the velocity: a panel for each mu_d and delta, a curve for each noise."""
    columns = sorted({number(item, "mu_d") for item in items})
    rows = sorted({step(item) or 0 for item in items}, reverse=True)
    labels = list(dict.fromkeys(memory(item) for item in sorted(items, key=lambda item: -number(item, "tau"))))
    figure = Figure(figsize=(1.2 + 2.3 * max(len(columns), 2), 0.9 + 1.9 * max(len(rows), 1.5)))
    axes = figure.subplots(len(rows), len(columns), sharex=True, sharey=True, squeeze=False)
    seen = numpy.concatenate([item["S_v"].value[item["S_v"].value > 0] for item in items])
    for item in items:
        n = labels.index(memory(item))
        place = axes[rows.index(step(item) or 0)][columns.index(number(item, "mu_d"))]
        curve(place, item["S_v"], n, label=labels[n])
    axes[0][0].set(xscale="log", yscale="log", ylim=(seen.min() / 2, seen.max() * 2))
    for row, delta in zip(axes, rows):
        row[0].set_ylabel(r"$S_v$  [velocity$^2$ time]")
        for place, mu_d in zip(row, columns):
            place.set_title(rf"$\mu_d$ = {fraction(mu_d)}" + (rf", $\delta$ = {fraction(delta)}" if delta else ""),
                            fontsize=9)
            if not place.has_data():
                place.text(0.5, 0.5, "no file", transform=place.transAxes, ha="center")
    for place in axes[-1]:
        place.set_xlabel(ABSCISSAE["omega"])
    if len(items) == 1:
        axes[0][0].set_title("Power spectral density of the velocity", fontsize=9)
        figure.suptitle(title(items[0]), fontsize=10)
        return figure
    handles = {label: handle for place in axes.flat for handle, label in zip(*place.get_legend_handles_labels())}
    axes[0][0].legend(handles.values(), handles, loc="lower left")
    mu_s = ", ".join(f"{x:g}" for x in sorted({number(item, "mu_s") for item in items}))
    figure.suptitle(rf"Power spectral density of the velocity; $\mu_s$ = {mu_s}, "
                    rf"$b(v) = {', '.join(sorted({drag(item) for item in items}))}$", fontsize=10)
    return figure


@styled
def durations(items: Sequence[Results]) -> "Figure":
    """Densities of the durations of sticking, sliding and excursions. Files that differ by delta alone share a panel,
    the finest drawn solid."""
    panels: dict[Any, list[Results]] = {}
    for item in items:
        key = (number(item, "mu_s"), number(item, "mu_d"), memory(item), drag(item))
        panels.setdefault(key, []).append(item)
    deltas = sorted({step(item) or 0 for item in items})
    if len(deltas) > len(LINES):
        raise ValueError(f"{len(deltas)} values of delta; at most {len(LINES)} can be distinguished")
    lines = dict(zip(deltas, LINES))
    kinds = [key for key in DURATIONS if any(key in item for item in items)]
    columns = min(len(panels), 2)
    rows = -(-len(panels) // columns)
    figure = Figure(figsize=(max(5.4, 0.6 + 3.9 * columns), 0.3 + 2.9 * rows))
    grid = figure.add_gridspec(rows + 1, columns, height_ratios=[0.3] + [2.9] * rows)
    _duration_legend(figure.add_subplot(grid[0, :]), kinds, lines)
    for n, ((mu_s, mu_d, noise, force), same) in enumerate(panels.items()):
        axes = figure.add_subplot(grid[1 + n // columns, n % columns])
        for item in same:
            for key in filter(item.__contains__, kinds):
                curve(axes, item[key], colour=DURATIONS[key][1], style=lines[step(item) or 0])
        axes.set_title(rf"$\mu_s$ = {mu_s:g}, $\mu_d$ = {mu_d:g}, {noise}, $b(v) = {force}$" if len(deltas) > 1 else
                       title(same[0]), fontsize=9)
        axes.set(xlabel="duration  [time]", ylabel="probability density  [1/time]", ylim=(0, None))
        if all(scale(item["f_slide"].abscissa) == "log" for item in same):
            highest = max(item[key].value.max() for item in same for key in kinds if key in item)
            axes.set(xscale="log", yscale="log", ylim=(1e-5 * highest, 2 * highest))
        axes.margins(x=0.02 if any(item["f_slide"].ci95 is not None for item in same) else 0)  # bars are seen whole
    return figure


def _duration_legend(axes: "Axes", kinds: Sequence[str], lines: dict[float, Any]) -> None:
    """In a row of its own: curves reach every corner of a panel."""
    handles = [Line2D([], [], color=colour, label=label) for label, colour in map(DURATIONS.get, kinds)]
    handles += [Line2D([], [], color="#888888", linestyle=line, label=rf"$\delta$ = {fraction(delta)}")
                for delta, line in lines.items() if delta and len(lines) > 1]
    axes.legend(handles=handles, loc="center", ncol=len(handles), columnspacing=1.2)
    axes.axis("off")


@styled
def slips(items: Sequence[Results]) -> "Figure":
    """Path lengths, largest speeds, first passages and displacement; S_0 t where a spectrum was asked for too."""
    wanted = [panel for panel in SLIPS if any(
        key in item and numpy.any(item[key].value) for key in panel[0] for item in items)]
    asked = [panel for panel in SLIPS if any(key in item for key in panel[0] for item in items)]
    return _panels(items, wanted or asked)


def other_arrays(items: Sequence[Results]) -> list[str]:
    """Keys of the arrays that no other picture shows."""
    shown = {"S_v", *DURATIONS, *(key.replace("f_", "cdf_") for key in DURATIONS),
             *(key for panel in SLIPS for key in panel[0]), *OF_A_FORCE}
    return list(dict.fromkeys(key for item in items for key, result in item.items()
                              if result.dims and key not in shown and not is_part(key)))


@styled
def arrays(items: Sequence[Results]) -> "Figure":
    """Every array that no other picture shows, in panels of their own; those that differ in an argument alone, such as
    f_passage(1) and f_passage(2), share one."""
    groups: dict[str, list[str]] = {}
    for key in other_arrays(items):
        stem = re.sub(r"\([-+.e\d]+\)$", "", key)
        full = len(groups.get(stem, ())) >= len(STYLES) or len(items) > 1
        groups.setdefault(key if full else stem, []).append(key)

    def panel(stem: str, keys: Sequence[str]) -> Panel:
        result = next(item[keys[0]] for item in items if keys[0] in item)
        name = stem if len(keys) > 1 else keys[0]
        return tuple(keys), words(name) + units(result.unit), scale(result.abscissa), "linear"
    return _panels(items, [panel(*group) for group in groups.items()])


def _against(item: Results, key: str) -> Result:
    """A result with what its picture has it over: a rate function over the velocity whose rate it is."""
    if key == "rate_function" and "tilted_velocity" in item:
        return dataclasses.replace(item[key], abscissa=item["tilted_velocity"].value, abscissa_name="tilted_velocity")
    return item[key]


def _panels(items: Sequence[Results], panels: Sequence[Panel]) -> "Figure":
    figure, places = paneled(len(panels))
    for axes, panel in zip(places, panels):
        _panel(axes, panel, items)
    if len(titles := set(map(title, items))) == 1:
        figure.suptitle(*titles, fontsize=10)
    return figure


def _panel(axes: "Axes", panel: Panel, items: Sequence[Results]) -> None:
    keys, y_label, x_scale, y_scale = panel
    for n, item in enumerate(items):
        for m, (key, style) in enumerate(zip(keys, STYLES)):
            if key in item:
                parts = [item.name if len(items) > 1 else "", SPELT.get(key, words(key) if len(keys) > 1 else "")]
                result, arguments = _against(item, key), len(keys) > 1 and key not in SPELT
                curve(axes, result, m if arguments else n, style=style, label=", ".join(filter(None, parts)) or None)
                axes.set_xlabel(over(result))
        if "displacement_variance" in keys and {keys[0], "S_0"} <= item.keys():
            t = item[keys[0]].abscissa
            axes.plot(t, item["S_0"].value * t, color="#888888", linewidth=0.9, linestyle=STYLES[3], zorder=1,
                      label=None if n else "$S_0 t$")
    axes.set(ylabel=y_label, xscale=x_scale, yscale=y_scale)
    if axes.get_xlabel() in (ABSCISSAE["k"], ABSCISSAE["mode"]):
        axes.xaxis.get_major_locator().set_params(integer=True)
    low, high = axes.get_ylim()
    if y_scale == "log" and high < 100 * low:  # powers of ten alone would be one or two
        decades(axes.yaxis)
    if keys[0] in ("cdf_slip", "F_slip"):
        axes.set_ylim(0, 1.03)
    if axes.get_legend_handles_labels()[1]:
        axes.legend(fontsize=8)


@styled
def correlation_time(items: Sequence[Results]) -> "Figure":
    """Correlation time of the velocity against that of the noise; files that differ by tau alone make a curve."""
    curves: dict[Any, list[tuple[float, float, float]]] = {}
    for item in items:
        key = (drag(item), number(item, "mu_d"), number(item, "mu_s"), step(item) or 0)
        curves.setdefault(key, []).append((number(item, "tau"), item["t_corr"].value, item["t_corr"].error))
    curves = dict(sorted(curves.items(), key=lambda curve: (curve[0][0] == "0", -curve[0][1])))
    same_noise = len({key[2:] for key in curves}) == 1
    figure = Figure(figsize=(6.4, 4.0))
    axes = figure.subplots()
    for n, ((force, mu_d, mu_s, delta), points) in enumerate(curves.items()):
        label = rf"$\mu_d$ = {mu_d:g}, $b(v) = {force}$"
        if not same_noise:
            label += rf", $\mu_s$ = {mu_s:g}, $\delta$ = {fraction(delta)}"
        colour = COLOURS[n % len(COLOURS)]
        tau, value, error = zip(*sorted(points))
        axes.errorbar(tau, value, error, color=colour, linestyle=STYLES[n % len(STYLES)], marker=MARKERS[n % 5],
                      markersize=4, capsize=2, label=label)
        if mu_d == mu_s and (force, mu_d) in WHITE_NOISE:
            axes.plot(0, WHITE_NOISE[force, mu_d], marker=(3, 0, -90), markersize=8, color=colour,
                      transform=axes.get_yaxis_transform(), clip_on=False, zorder=3)
    axes.axvline(1 / 8, color="#777777", linewidth=1, linestyle=":")
    axes.text(1 / 8, 0.02, r" $\tau$ = 1/8", transform=axes.get_xaxis_transform(), color="#555555")
    axes.set_xscale("log", base=2)
    axes.xaxis.set_major_formatter(lambda x, _: fraction(x))
    axes.set(xlabel=r"correlation time of the noise $\tau$  [time]",
             ylabel=r"correlation time of the velocity $t_\mathrm{corr}$  [time]", ylim=(0, None))
    if same_noise:
        _, _, mu_s, delta = next(iter(curves))
        axes.set_title(rf"$\mu_s$ = {mu_s:g}, $\delta$ = {fraction(delta)}; triangles on the left: white noise, "
                       r"$\tau \to 0$", fontsize=9)
    axes.legend(loc="best")
    return figure
