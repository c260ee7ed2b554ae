"""Draws the figures of the manual.

usage: python3 docs/figures/make.py [--program build/stickslip] [--complex-program build/stickslip-complex]
                                    [--folder docs/figures] [--figures phases mesh]

Runs the program and writes a PNG for each. mu_s = tau = 1 and b(v) = -v everywhere, mu_d = 1/4 in all runs.
"""

import argparse
import math
import pathlib
import sys
import warnings

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "python"))
import stickslip
from sliding import MU_D, MU_S, sliding_operator
from stickslip.plots.fields import FORCING, SLIDE, STICK, shade
from stickslip.plots.style import ABSCISSAE, COLOURS, MARKERS, STYLES, Figure, numpy, saved, styled

warnings.simplefilter("ignore", stickslip.AccuracyWarning)  # a discretisation fixed by hand is not refined
WIDTH, LARGEST = 7.0, 160_000  # inches of every figure, so that all have letters of one size; bytes of a file
GREY, SINGLE, GROUP = "#777777", COLOURS[4], COLOURS[2]


@styled
def phases(run):
    """One path of X and V with its sticking and sliding phases."""
    path = run(delta=1 / 4, quantities="trajectory", start="0,0", horizon=10, seed=132).trajectory
    time, x, y, v = (path[part] for part in ("time", "x", "y", "v"))
    turns = numpy.flatnonzero(numpy.diff(y)) + 1
    starts, crossings = turns[y[turns - 1] == 0], turns[y[turns - 1] * y[turns] < 0]
    borders = time[[0, *numpy.setdiff1d(turns, crossings), -1]]  # of phases; the first one is of sticking
    figure = Figure(figsize=(WIDTH, 4.6))
    strip, by_x, by_v = figure.subplots(3, 1, sharex=True, gridspec_kw={"height_ratios": (0.42, 1.4, 1.1)})
    phase_strip(strip, borders, *time[starts[:2]])
    by_x.axhspan(-MU_S, MU_S, color="#dddddd", alpha=0.55, linewidth=0, zorder=0)
    by_x.step(time, x, where="post", color=FORCING, linewidth=1)
    by_v.plot(time, v, color=SLIDE, linewidth=1.6)  # events are close together
    for axes, values in ((by_x, x), (by_v, v)):
        for begin, end in zip(borders[::2], borders[1::2]):
            axes.axvspan(begin, end, color=STICK, alpha=0.18, linewidth=0)
        for n in starts:
            axes.plot(time[n], values[n], "^" if y[n] > 0 else "v", color=SLIDE, markersize=7, zorder=4)
            axes.annotate("$s^+$" if y[n] > 0 else "$s^-$", (time[n], values[n]), (-6, 8 * y[n]), va="center",
                          textcoords="offset points", ha="right", color=SLIDE)
        axes.plot(time[crossings], values[crossings], "o", color=SLIDE, markerfacecolor="white", zorder=4)
    for n in crossings:
        by_v.annotate(r"$V$ crosses 0 without sticking: $|X| > \mu_s$", (time[n], 0), (12, 20), va="center",
                      textcoords="offset points", arrowprops={"arrowstyle": "-", "color": GREY, "shrinkB": 4})
    by_x.set(ylabel="force $X$\n[force]", yticks=(-2, -1, 0, 1, 2),
             yticklabels=("$-2$", r"$-\mu_s$", "0", r"$\mu_s$", "2"))
    by_v.set(ylabel="velocity $V$\n[velocity]", xlabel="time $t$  [time]", xlim=borders[[0, -1]],
             ylim=(1.12 * v.min(), v.max() + 0.25))
    figure.align_ylabels((by_x, by_v))
    return figure


def phase_strip(axes, borders, start, end):
    """Phases as bars, with a bracket over an excursion."""
    for n, (left, right) in enumerate(zip(borders, borders[1:])):
        axes.barh(0, right - left, left=left, height=1, color=(STICK, SLIDE)[n % 2], alpha=(0.35, 0.25)[n % 2])
        if right - left > 0.8:  # wide enough for the word
            axes.text((left + right) / 2, 0, ("sticking", "sliding")[n % 2], ha="center", va="center", fontsize=8)
    axes.plot([start, start, end, end], [0.8, 1.2, 1.2, 0.8], color="black", linewidth=1)
    axes.text((start + end) / 2, 1.35, "one excursion", ha="center", va="bottom")
    axes.set(ylim=(-0.5, 2.4))
    axes.axis("off")


@styled
def stick_slip(run):
    """A path of force and velocity beside the stationary distribution of both."""
    path = run(delta=1 / 8, quantities="trajectory", start="0,0", horizon=40, seed=4).trajectory
    found = run(delta=1 / 8, quantities="density", accuracy=1e-8).density
    figure = Figure(figsize=(WIDTH, 3.6))
    (by_x, of_x), (by_v, of_v) = figure.subplots(2, 2, sharex="col", sharey="row", gridspec_kw={"width_ratios": (2.7, 1)})
    by_x.axhspan(-MU_S, MU_S, color="#dddddd", alpha=0.55, linewidth=0, zorder=0)
    by_x.step(path["time"], path["x"], where="post", color=FORCING, linewidth=0.8)
    by_v.plot(path["time"], path["v"], color=SLIDE, linewidth=1.4)
    steps = numpy.diff(numpy.concatenate([[0], path["y"][:-1] == 0, [0]]))
    for axes in (by_x, by_v):
        shade(axes, path["time"][numpy.flatnonzero(steps > 0)], path["time"][numpy.flatnonzero(steps < 0)])
    by_x.margins(x=0)
    v, delta = found.window(1e-4), found.x[1] - found.x[0]
    of_x.barh(found.x, found.marginal_x / delta, delta, color=SLIDE, label="sliding")
    of_x.barh(found.x, found.at_rest / delta, delta, color=STICK, label="at rest")
    of_v.plot(found.marginal(v), v, color=SLIDE)
    of_v.axhline(0, color=STICK, linewidth=1.4, zorder=1)
    of_v.text(0.96, 0.96, f"at rest:\n{found.mass_at_rest:.9f}", color=STICK, ha="right", va="top", fontsize=8,
              transform=of_v.transAxes)
    of_x.legend(fontsize=7, loc="upper right", handlelength=1)
    by_x.set(ylabel="force $X$\n[force]", yticks=(-2, -1, 0, 1, 2), yticklabels=("$-2$", r"$-\mu_s$", "0", r"$\mu_s$", "2"),
             ylim=(-3.6, 3.6), title="a path, at rest where it is orange")
    by_v.set(ylabel="velocity $V$\n[velocity]", xlabel="time $t$  [time]", ylim=(-2.4, 2.4))
    of_x.set(title="the distribution")
    of_v.set(xlabel="probability density", xlim=(0, None))
    figure.align_ylabels((by_x, by_v))
    return figure


@styled
def balance(_, mu_d=0.5, force=0.92):
    """Friction against velocity; friction and drag against a constant force below mu_s."""
    figure = Figure(figsize=(WIDTH, 3.2))
    law, motion = figure.subplots(1, 2, gridspec_kw={"width_ratios": (1.15, 1)})
    v = numpy.linspace(0, 1, 1001)
    for axes in (law, motion):
        axes.plot([0, 0], [-MU_S, MU_S], color=STICK, lw=3.5, solid_capstyle="butt", zorder=3, label="static range")
    for n, v_s in enumerate((0, 0.05, 0.2)):
        friction = mu_d + ((MU_S - mu_d) * numpy.exp(-v / v_s) if v_s else 0 * v)
        look = {"color": (SLIDE, *COLOURS[2:])[n], "linestyle": STYLES[n]}
        law.plot(v, friction, label=f"Stribeck, $v_s$ = {v_s}" if v_s else "Coulomb", **look)
        law.plot(-v, -friction, **look)
        if v_s != 0.05:
            motion.plot(v, friction + v, **look)
            equilibria(motion, v, force - friction - v, force, look["color"], 0.018 * (n - 1))
    law.set(xlim=(-1, 1), xticks=(-1, 0, 1), xlabel="velocity $v$  [velocity]",
            ylabel=r"friction $F(|v|)\,\mathrm{sign}\,v$  [force]",
            yticks=(-MU_S, -mu_d, 0, mu_d, MU_S), yticklabels=(r"$-\mu_s$", r"$-\mu_d$", "0", r"$\mu_d$", r"$\mu_s$"))
    law.legend(loc="upper left", fontsize=8, handlelength=1.7, borderaxespad=0.2)
    motion.axhline(force, color=FORCING, linewidth=1, zorder=1)
    motion.plot(0, force, "o", color=STICK, markersize=7, zorder=4)
    motion.text(0.69, force - 0.035, "force $X$", ha="right", va="top")
    motion.set(xlim=(-0.015, 0.7), ylim=(0.4, 1.25), xlabel="velocity $v$  [velocity]",
               ylabel="friction and drag $F(v) - b(v)$  [force]")
    return figure


def equilibria(axes, v, net, force, colour, shift):
    """Where the net force vanishes, terminal velocities filled, others open; arrows have the sign of dV/dt."""
    zeros = numpy.flatnonzero(net[1:] * net[:-1] < 0)
    for n in zeros:
        axes.plot(v[n], force, "o", color=colour, markerfacecolor=colour if net[n] > 0 else "white", zorder=4)
    for low, high in zip([0, *v[zeros]], [*v[zeros], 0.7]):
        middle = (low + high) / 2
        length = min(0.035, 0.3 * (high - low)) * numpy.sign(numpy.interp(middle, v, net))
        axes.annotate("", (middle + length, force + shift), (middle - length, force + shift),
                      arrowprops={"arrowstyle": "->", "color": colour, "linewidth": 1.3})


@styled
def mesh(run, delta=1 / 32):
    """Velocity elements with their degrees, groups of noise levels, and the nodes of both; x >= 0."""
    grid = sliding_operator(run, delta, degree=5)
    figure = Figure(figsize=(WIDTH, 5.2))
    (above, corner), (plane, beside) = figure.subplots(
        2, 2, sharex="col", sharey="row", gridspec_kw={"width_ratios": (5.5, 1), "height_ratios": (1, 3.4)})
    corner.axis("off")
    ends = numpy.maximum(grid.ends, grid.ends[1] / 4)  # on a logarithmic axis
    for (first, last), count in zip(grid.groups, grid.nodes):
        colour, left, width = SINGLE if count == 1 else GROUP, (first - 0.5) * delta, (last + 1 - first) * delta
        above.bar(left, last + 1 - first, width, align="edge", color=colour, alpha=0.55, edgecolor="white", lw=0.4)
        plane.axvspan(left, left + width, facecolor=colour, alpha=0.09 * (count > 1), linewidth=0)
    single = numpy.repeat(grid.nodes == 1, grid.nodes)
    for part, colour, name in ((single, SINGLE, "single level"), (~single, GROUP, "node of a group")):
        x, v = numpy.meshgrid(grid.x[part], grid.v)
        plane.plot(x.ravel(), v.ravel(), ".", color=colour, markersize=2.4, markeredgewidth=0, label=name)
    plane.hlines(ends, -1, grid.ends[-1] + 1, color="#999999", linewidth=0.7, zorder=0)
    speeds = numpy.geomspace(ends[0], ends[-1], 200)
    plane.plot(MU_D + speeds, speeds, color=STICK, linewidth=1.4, label=r"$x - \mu_d + b(v) = 0$")
    for mu, name in ((MU_D, r"$\mu_d$"), (MU_S, r"$\mu_s$")):
        above.text(mu, 1.02, name, transform=above.get_xaxis_transform(), ha="center", va="bottom")
        for axes in (above, plane):
            axes.axvline(mu, color=GREY, linestyle="--", linewidth=1)
    beside.barh(ends[:-1], numpy.histogram(grid.v, grid.ends)[0] - 1, numpy.diff(ends), align="edge", color=SLIDE,
                alpha=0.35, edgecolor="white")
    above.set(ylabel="levels of\na group", yscale="log", yticks=(1, 10, 100))
    plane.set(ylabel="velocity $v$  [velocity]", yscale="log", ylim=ends[[0, -1]])
    plane.set_xscale("function", functions=(lambda x: numpy.sign(x) * abs(x)**0.5, lambda root: root * abs(root)))
    plane.set(xlabel=r"force $x$  [force], axis: $\sqrt{x}$", xlim=(-delta / 2, (grid.groups[-1][1] + 0.5) * delta),
              xticks=(0, 0.25, 0.5, 1, 2, 4, 6), xticklabels=("0", "1/4", "1/2", "1", "2", "4", "6"))
    beside.set(xlabel="degree", xticks=range(6))
    plane.legend(loc="lower right", markerscale=4, frameon=True, framealpha=1, edgecolor="white")
    for axes in (plane, above, beside):
        axes.grid(False)
    return figure


@styled
def sparsity(run):
    """Pattern of the sliding operator: all elements, the first one, and the noise at one velocity node."""
    grid = sliding_operator(run, delta=1 / 8, degree=4)
    count, elements = len(grid.x), numpy.searchsorted(grid.v, grid.ends)
    (v, n), (w, m) = (numpy.divmod(part, count) for part in (grid.row, grid.column))
    mirrored, single = n + m == count - 1, numpy.repeat(grid.nodes == 1, grid.nodes)
    kinds = ((n == m, SLIDE, "transport"), ((n != m) & ~mirrored, SINGLE, "noise jumps"),
             ((n != m) & mirrored, STICK, "reflection at $v = 0$"))
    figure = Figure(figsize=(WIDTH, 4.6))
    axes = figure.subplot_mosaic([["all", "first"], ["all", "noise"]], gridspec_kw={"width_ratios": (2.1, 1)})
    first, look = (v < elements[1]) & (w < elements[1]), {"marker": "s", "linestyle": "", "markeredgewidth": 0}
    for part, colour, label in kinds:
        for name, seen, size in (("all", part, 1), ("first", part & first, 1.2)):
            axes[name].plot(grid.column[seen], grid.row[seen], color=colour, markersize=size, label=label, **look)
    here, single = (v == w) & (v == elements[-1] // 2), single[n] & single[m]
    for part, colour, label in ((single & here, SINGLE, "single levels"), (~single & here, GROUP, "groups")):
        axes["noise"].plot(m[part], n[part], color=colour, markersize=2.6, label=label, **look)
    for name, borders, title in (("all", elements * count, f"{count * elements[-1]} unknowns, by velocity element"),
                                 ("first", numpy.arange(elements[1] + 1) * count, "element 1, by velocity node"),
                                 ("noise", numpy.cumsum([0, *grid.nodes]), "one velocity node, by group")):
        for lines in (axes[name].hlines, axes[name].vlines):
            lines(borders - 0.5, *borders[[0, -1]], color="#cccccc", linewidth=0.6, zorder=0)
        axes[name].set(xlim=borders[[0, -1]] - 0.5, ylim=borders[[-1, 0]] - 0.5, aspect="equal", xticks=(), yticks=())
        axes[name].set_title(title, fontsize=9)
        axes[name].grid(False)
    axes["all"].set(yticks=(elements[1:] + elements[:-1]) / 2 * count, yticklabels=range(1, len(elements)))
    axes["all"].legend(loc="upper right", markerscale=6)
    axes["noise"].legend(loc="lower left", markerscale=3, handletextpad=0, fontsize=8)
    return figure


@styled
def convergence(run):
    """Relative errors of hp elements against degree, of the upwind scheme against points, of both against unknowns."""
    asked = {"delta": 1 / 4, "quantities": "sticking,moments"}
    exact, degrees, points = run(accuracy=1e-13, **asked), numpy.arange(2, 12), 2**numpy.arange(1, 8)
    schemes = (("hp", degrees, [run(degree=d, noise_degree=d - 1, **asked) for d in degrees]),
               ("upwind", points, [run(scheme="upwind", p=p, **asked) for p in points]))
    figure = Figure(figsize=(WIDTH, 3.6))
    *by_scheme, by_size = figure.subplots(1, 3, sharey=True, gridspec_kw={"width_ratios": (1.3, 1, 1)})
    for at, (name, parameter, found) in zip(by_scheme, schemes):
        unknowns = [r.cost["steps"][-1]["unknowns"] for r in found]
        for n, (key, label) in enumerate((("P_stick", r"$P_\mathrm{stick}$"), ("E_V2", "$E[V^2]$"))):
            error = numpy.array([abs(r[key].value / exact[key].value - 1) for r in found])
            look = {"color": COLOURS[n], "marker": MARKERS[n], "linestyle": STYLES[n], "markersize": 4}
            by_size.plot(unknowns, error, **look)
            factor, order = (error[0] / error[-1])**(1 / (len(found) - 1)), math.log2(error[-2] / error[-1])
            slope = f"factor {factor:.0f} a degree" if name == "hp" else f"order {order:.2f}"
            at.plot(parameter, error, label=f"{label}: {slope}", **look)
        at.legend(loc="upper right" if name == "hp" else "lower left", fontsize=8, handlelength=2.2)
        by_size.text(1.4 * unknowns[len(found) // 2], error[len(found) // 2], name, va="bottom")
    by_scheme[0].set(yscale="log", xlabel="degree of hp elements", ylabel="relative error", xticks=range(2, 12, 3))
    by_scheme[1].set(xscale="log", xlabel="upwind points $p$")
    by_size.set(xscale="log", xlabel="unknowns")
    return figure


@styled
def reduced_model(run):
    """S_v of a reduced model, and its error estimate beside the difference from direct solves."""
    asked = {"delta": 1 / 8, "quantities": "spectrum"}
    model = run(omega="0.01:100:58:log", **asked)
    s, pairs = model["S_v"], model.cost["steps"][-1]["checks"]["krylov_pairs"]
    direct = run(omega=s.abscissa[::3], spectrum_solver="direct", accuracy=1e-9, **asked)["S_v"]
    figure = Figure(figsize=(WIDTH, 3.2))
    value, error = figure.subplots(1, 2)
    points = {"linestyle": "", "marker": "o", "markerfacecolor": "white", "color": STICK}
    value.loglog(s.abscissa, s.value, color=SLIDE, label=f"reduced model, size {pairs:.0f}")
    value.loglog(direct.abscissa, direct.value, label="direct solves", **points)
    error.loglog(s.abscissa, s.error / s.value, color=SLIDE, label="error estimate")
    error.loglog(direct.abscissa, abs(s.value[::3] / direct.value - 1), label="difference from direct solves", **points)
    value.set(xlabel=ABSCISSAE["omega"], ylabel=r"$S_v$  [velocity$^2$ time]")
    error.set(xlabel=ABSCISSAE["omega"], ylabel="relative to $S_v$", ylim=(2e-12, 3e-6))
    value.legend(loc="lower left")
    error.legend(loc="upper left")
    return figure


FIGURES = {draw.__name__: draw for draw in (phases, stick_slip, balance, mesh, sparsity, convergence, reduced_model)}


def main():
    parser = argparse.ArgumentParser(usage=__doc__.split("usage: ")[1].split("\n\n")[0])
    parser.add_argument("--program", type=pathlib.Path, default=ROOT / "build" / "stickslip")
    parser.add_argument("--complex-program", type=pathlib.Path, default=ROOT / "build" / "stickslip-complex")
    parser.add_argument("--folder", type=pathlib.Path, default=pathlib.Path(__file__).resolve().parent)
    parser.add_argument("--figures", nargs="+", choices=FIGURES, default=list(FIGURES))
    given = parser.parse_args()

    def run(**options):
        direct = options.get("spectrum_solver") == "direct"
        return stickslip.run(program=given.complex_program if direct else given.program, mu_d=MU_D, **options)

    for name in given.figures:
        file = saved(FIGURES[name](run), given.folder / f"{name}.png")
        if file.stat().st_size > LARGEST:
            sys.exit(f"{file} has more than {LARGEST} bytes")


main()
