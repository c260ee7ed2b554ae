"""The stationary distribution, and a path."""

import dataclasses
from collections.abc import Sequence
from typing import TYPE_CHECKING

from ..needed import needed
from ..results import Results
from .style import (ABSCISSAE, COLOURS, Figure, Line2D, Patch, matplotlib, number, numpy, parameters, styled, title, units,
                    users, without)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
SLIDE, STICK, FORCING = COLOURS[0], COLOURS[1], COLOURS[4]
needed("matplotlib.collections")
CLEAR = 3  # least density that is shown, by the swings of its level and of those beside it
BESIDE = 0.07  # of all levels, to either side


def shade(axes: "Axes", begins: "numpy.ndarray", ends: "numpy.ndarray") -> None:
    """Intervals of time with a coloured ground, all in one collection, since a path may have a hundred thousand of them."""
    times = numpy.column_stack([begins, begins, ends, ends])
    corners = numpy.stack([times, numpy.broadcast_to([0, 1, 1, 0], times.shape)], -1)
    axes.add_collection(matplotlib.collections.PolyCollection(
        corners, color=STICK, alpha=0.18, linewidth=0, transform=axes.get_xaxis_transform()), autolim=False)


def _edges(points: "numpy.ndarray") -> "numpy.ndarray":
    return numpy.concatenate([[points[0]], (points[1:] + points[:-1]) / 2, [points[-1]]])


def cells_around(levels: "numpy.ndarray") -> "numpy.ndarray":
    """Ends of the cells around rising values, the outer ones as wide to both sides; 1 is the width of one alone."""
    if len(levels) == 1:
        return levels[0] + numpy.array([-0.5, 0.5])
    ends = _edges(levels)
    ends[[0, -1]] = 2 * levels[[0, -1]] - ends[[1, -2]]
    return ends


def resolved(density: "numpy.ndarray") -> "numpy.ndarray":
    """A density by [level, velocity], and 0 where it is not resolved: polynomials that swing below 0 on a level swing above
    it as far there and on the levels beside it, which is no density but the error of the discretisation."""
    reach = max(1, round(BESIDE * len(density)))
    swing = numpy.pad(numpy.maximum(-density.min(axis=1), 0), reach)
    swing = numpy.lib.stride_tricks.sliding_window_view(swing, 2 * reach + 1).max(axis=1)
    return numpy.where(density > CLEAR * swing[:, None], density, 0)


@styled
def density(items: Sequence[Results]) -> "Figure":
    """The stationary distribution of (X, V), or of (P, V) with a spring, its marginals, and the static states. What is not
    resolved is white."""
    (results,) = items
    tied = bool(results.density.position)
    field = results.density.by_position() if tied else results.density.by_force()
    # Polynomials along the position swing where hardly any probability is.
    clear = field.marginal_x > -2 * field.marginal_x.min()
    field = dataclasses.replace(field, **{name: numpy.where(clear, getattr(field, name).T, 0).T for name in (
        "values", "at_rest", "marginal_x")})
    x, v, ends = field.x, field.window(1e-4), cells_around(field.x)
    width = numpy.diff(ends)
    figure = Figure(figsize=(7.2, 5.2))
    (plane, by_v), (by_x, corner) = figure.subplots(
        2, 2, sharex="col", sharey="row", gridspec_kw={"width_ratios": (3, 1), "height_ratios": (3, 1.2)})
    corner.axis("off")

    pdf = numpy.maximum(resolved(field.at(v)).T / width, 1e-300)
    seen = numpy.flatnonzero(field.marginal_x > 1e-4 * field.marginal_x.max())
    image = plane.pcolormesh(ends, _edges(v), pdf, norm=matplotlib.colors.LogNorm(1e-5 * pdf.max(), pdf.max()),
                             cmap="Blues", rasterized=True)
    stuck = field.at_rest > 0
    plane.scatter(x[stuck], 0 * x[stuck], s=900 * field.at_rest[stuck], color=STICK, zorder=3)
    margin = 0.03 * numpy.ptp(v)  # rest is seen whole where no body moves to one of the sides
    plane.set(xlim=(ends[seen[0]], ends[seen[-1] + 1]), ylim=(min(v[0], -margin), max(v[-1], margin)),
              ylabel="velocity $v$  [velocity]")
    figure.colorbar(image, ax=by_v, label=f"density of sliding  [1/({'length' if tied else 'force'} velocity)]")

    marginal = field.marginal(v)
    by_v.plot(marginal, v, color=SLIDE)
    by_v.set(xlabel="density of $V$  [1/velocity]", xlim=(0, 1.05 * marginal.max()))
    by_v.xaxis.tick_top()
    by_v.xaxis.set_label_position("top")  # below, it would part the plane from the levels
    by_v.tick_params(labeltop=True, labelbottom=False)
    if stuck.any():
        by_v.axhline(0, color=STICK, linewidth=1, zorder=1)  # behind the curve, which has its shape here
        by_v.plot(1, 0, ">", color=STICK, markersize=5, clip_on=False, transform=by_v.get_yaxis_transform())
    by_x.bar(x, field.marginal_x - field.at_rest, width * 0.9, field.at_rest, color=SLIDE)
    by_x.bar(x, field.at_rest, width * 0.9, color=STICK)
    by_x.set(**dict(xlabel="position $p$  [length]", ylabel="$P(P = p)$") if tied else
             dict(xlabel="force $x$  [force]", ylabel="$P(X = x)$"))
    corner.legend(handles=[  # here, as the panels are full
        Patch(color=SLIDE, label="sliding"), Patch(color=STICK, label="sticking"),
        Line2D([], [], color=STICK, marker="o", linestyle="", label="at rest, by area"),
        Line2D([], [], color=STICK, marker=">", linewidth=1, label=r"$P_\mathrm{stick}\,\delta(v)$")],
        loc="upper left", borderaxespad=0, labelspacing=0.8)
    figure.suptitle(rf"{title(results)}: $P_\mathrm{{stick}}$ = {results.density.mass_at_rest:.4g}", fontsize=10)
    return figure


@styled
def trajectory(items: Sequence[Results]) -> "Figure":
    """A path: in the plane of force and velocity, and both against time. A CSV file has no marks at mu_s, mu_d."""
    (results,) = items
    figure = Figure(figsize=(8.6, 4.3))
    grid = figure.add_gridspec(3, 2, width_ratios=(1, 1.5), height_ratios=(1, 1, 0.14))
    by_v = figure.add_subplot(grid[0, 1])
    by_x = figure.add_subplot(grid[1, 1], sharex=by_v)
    by_v.tick_params(labelbottom=False)
    _plane(figure.add_subplot(grid[:2, 0]), results)
    _times(by_v, by_x, results)
    handles = [Line2D([], [], color=SLIDE, label="sliding"),
               Line2D([], [], color="#999999", label="jump of the noise"),
               Line2D([], [], color=STICK, marker="o", linestyle="", label="rest (area: time)"),
               Patch(color=STICK, alpha=0.18, label="rest")]
    if results.options:
        handles += [Line2D([], [], color="#777777", marker="|", markersize=10, linestyle="--", linewidth=1,
                           markeredgecolor="black", label=r"$\pm\mu_s$"),
                    Line2D([], [], color="black", marker="o", markerfacecolor="white", markersize=5, linestyle="",
                           label=r"$\pm\mu_d$")]
    legend = figure.add_subplot(grid[2, :])  # paths reach every corner of a panel
    legend.legend(handles=handles, loc="center", ncol=len(handles), columnspacing=1.4)
    legend.axis("off")
    figure.suptitle(title(results), fontsize=10)
    return figure


@styled
def given_force(items: Sequence[Results]) -> "Figure":
    """Force, velocity and displacement of the motion under a given force over time; slips are shaded."""
    (results,) = items
    figure = Figure(figsize=(7.2, 5.2))
    rows = figure.subplots(3, 1, sharex=True)
    of_record = results["path_force"].unit not in ("", "force")  # whose units results then have
    for axes, (key, label, unit, colour) in zip(rows, (("path_force", "force $x$", "force", FORCING),
                                                       ("path_velocity", "velocity $v$", "velocity", SLIDE),
                                                       ("path_displacement", "displacement", "length", SLIDE))):
        if "slip_begin" in results:
            shade(axes, results["slip_begin"].value, results["slip_end"].value)
        axes.plot(results[key].abscissa, results[key].value, color=colour, linewidth=1.1)
        axes.set_ylabel(f"{label}\n{units(results[key].unit if of_record else unit).strip()}")
    if results.options:
        for sign, mu in ((1, "mu_s"), (-1, "mu_s_minus")):
            mu = number(results, mu if results.options.get(mu) else "mu_s")
            level = sign * mu - number(results, "bias")
            if abs(level) < 2 * abs(results["path_force"].value).max():
                rows[0].axhline(level, color="#777777", linewidth=1, linestyle="--")
        noise = [name for name in parameters(results) if name == "noise" or "noise" in users(results, name)]
        figure.suptitle(title(without(results, noise)), fontsize=10)
    rows[0].margins(x=0)
    rows[2].set_xlabel("time $t$  [s]" if of_record else ABSCISSAE["time"])
    return figure


def _plane(axes: "Axes", results: Results) -> None:
    """Sliding is vertical, jumps of the noise are horizontal."""
    time, x, y, v = (results.trajectory[part] for part in ("time", "x", "y", "v"))
    stuck, wait = y[:-1] == 0, numpy.diff(time)  # from each event to the next
    slides = [((a, b), (a, c)) for a, b, c, rests in zip(x, v, v[1:], stuck) if not rests]
    jumps = [((a, c), (b, c)) for a, b, c in zip(x, x[1:], v[1:]) if a != b]
    collection = matplotlib.collections.LineCollection
    axes.add_collection(collection(jumps, color="#999999", linewidth=0.5))
    axes.add_collection(collection(slides, color=SLIDE, linewidth=1.1))
    levels = numpy.unique(x[:-1][stuck])
    if levels.size:
        rest = numpy.array([wait[stuck & (x[:-1] == level)].sum() for level in levels])
        axes.scatter(levels, 0 * levels, s=6 + 60 * rest / max(rest.max(), 1e-300), color=STICK, zorder=3)
    if results.options:
        for option, form in (("mu_s", {"marker": "|", "markersize": 13}),
                             ("mu_d", {"marker": "o", "markerfacecolor": "white", "markersize": 5})):
            mu = number(results, option)
            axes.plot([-mu, mu], [0, 0], linestyle="", color="black", zorder=4, **form)
    axes.set(xlabel="force $x$  [force]", ylabel="velocity $v$  [velocity]")
    axes.margins(0.05)
    axes.autoscale_view()


def _times(by_v: "Axes", by_x: "Axes", results: Results) -> None:
    time, x, y, v = (results.trajectory[part] for part in ("time", "x", "y", "v"))
    steps = numpy.diff(numpy.concatenate([[0], y[:-1] == 0, [0]]))
    for axes in (by_v, by_x):
        shade(axes, time[numpy.flatnonzero(steps > 0)], time[numpy.flatnonzero(steps < 0)])
    by_v.plot(time, v, color=SLIDE, linewidth=1.1)  # events are close together
    by_v.set(ylabel="velocity $v$\n[velocity]")
    by_x.step(time, x, where="post", color=FORCING, linewidth=0.8)
    for sign in (-1, 1) if results.options else ():
        by_x.axhline(sign * number(results, "mu_s"), color="#777777", linewidth=1, linestyle="--")
    by_x.set(xlabel="time $t$  [time]", ylabel="force $x$\n[force]")
    by_v.margins(x=0)
