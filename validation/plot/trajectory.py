"""Draws a simulated path: in the plane of forcing and velocity, and both against time.

usage: python3 trajectory.py FILE.h5 PICTURE.png
       python3 trajectory.py FILE.csv PICTURE.png

Files come from `stickslip -quantities trajectory -horizon 20 -output FILE.h5 -trajectory FILE.csv`;
a CSV file does not tell the scene, so that its picture has no marks at mu_s and mu_d. Short
horizons are best: a picture holds some hundred jumps of the noise.
"""

import pathlib

import matplotlib
import numpy

from results import COLOURS, File, arguments_of, one_file, plt

SLIDE, STICK = COLOURS[:2]
FORCING = COLOURS[4]


class Path:
    """The states just after each event, and what is known of the scene."""

    def __init__(self, name):
        self.file = None if pathlib.Path(name).suffix == ".csv" else File(name)
        columns = self.file.group("trajectory") if self.file else \
            dict(zip(("time", "x", "y", "v"), numpy.loadtxt(name, delimiter=",", skiprows=1).T))
        self.time, self.x, self.y, self.v = (columns[key] for key in ("time", "x", "y", "v"))
        self.stuck = self.y[:-1] == 0  # from each event to the next
        self.wait = numpy.diff(self.time)

    def known(self, option):
        """A parameter of the scene, or nothing."""
        return self.file.number(option) if self.file else None

    def title(self):
        if not self.file:
            return ""
        mu_s, mu_d = map(self.known, ("mu_s", "mu_d"))
        return (rf"$\mu_s$ = {mu_s:g}, $\mu_d$ = {mu_d:g}, {self.file.noise()}, "
                rf"$b(v) = {self.file.drag()}$")

    def stays(self):
        """Begin and end of each time of rest."""
        steps = numpy.diff(numpy.concatenate([[0], self.stuck, [0]]))
        return zip(self.time[numpy.flatnonzero(steps > 0)], self.time[numpy.flatnonzero(steps < 0)])

    def time_at_rest(self):
        """By level of the forcing."""
        levels = numpy.unique(self.x[:-1][self.stuck])
        return levels, [self.wait[self.stuck & (self.x[:-1] == x)].sum() for x in levels]


def draw_plane(axes, path):
    """Slides are vertical, jumps of the noise horizontal."""
    x, v = path.x, path.v
    slides = [((a, b), (a, c)) for a, b, c, rests in zip(x, v, v[1:], path.stuck) if not rests]
    jumps = [((a, c), (b, c)) for a, b, c in zip(x, x[1:], v[1:]) if a != b]
    collection = matplotlib.collections.LineCollection
    axes.add_collection(collection(jumps, color="#999999", linewidth=0.5))
    axes.add_collection(collection(slides, color=SLIDE, linewidth=1.1))
    levels, rest = path.time_at_rest()
    if len(levels):
        axes.scatter(levels, 0 * levels, s=6 + 60 * numpy.array(rest) / max(rest), color=STICK,
                     zorder=3)
    mu_s, mu_d = path.known("mu_s"), path.known("mu_d")
    if mu_s:
        axes.plot([-mu_s, mu_s], [0, 0], "|", color="black", markersize=13, zorder=4)
        axes.plot([-mu_d, mu_d], [0, 0], "o", color="black", markerfacecolor="white", markersize=5,
                  zorder=4)
    axes.set(xlabel="forcing $x$  [force]", ylabel="velocity $v$  [velocity]")
    axes.margins(0.05)
    axes.autoscale_view()


def draw_times(by_v, by_x, path):
    for axes in (by_v, by_x):
        for begin, end in path.stays():
            axes.axvspan(begin, end, color=STICK, alpha=0.18, linewidth=0)
    by_v.plot(path.time, path.v, color=SLIDE, linewidth=1.1)  # events are close together
    by_v.set(ylabel="velocity $v$\n[velocity]")
    by_x.step(path.time, path.x, where="post", color=FORCING, linewidth=0.8)
    if path.known("mu_s"):
        for sign in (-1, 1):
            by_x.axhline(sign * path.known("mu_s"), color="#777777", linewidth=1, linestyle="--")
    by_x.set(xlabel="time $t$  [time]", ylabel="forcing $x$\n[force]")
    by_v.margins(x=0)


def draw_legend(axes, path):
    """In a row of its own: paths reach every corner of a panel."""
    line, patch = plt.Line2D, matplotlib.patches.Patch
    handles = [line([], [], color=SLIDE, label="sliding"),
               line([], [], color="#999999", label="jump of the noise"),
               line([], [], color=STICK, marker="o", linestyle="", label="rest (area: time)"),
               patch(color=STICK, alpha=0.18, label="rest")]
    if path.known("mu_s"):
        handles += [line([], [], color="#777777", marker="|", markersize=10, linestyle="--",
                         linewidth=1, markeredgecolor="black", label=r"$\pm\mu_s$"),
                    line([], [], color="black", marker="o", markerfacecolor="white", markersize=5,
                         linestyle="", label=r"$\pm\mu_d$")]
    axes.legend(handles=handles, loc="center", ncol=len(handles), columnspacing=1.4)
    axes.axis("off")


def draw(path, picture):
    figure = plt.figure(figsize=(8.6, 4.3), layout="constrained")
    grid = figure.add_gridspec(3, 2, width_ratios=(1, 1.5), height_ratios=(1, 1, 0.14))
    by_v = figure.add_subplot(grid[0, 1])
    by_x = figure.add_subplot(grid[1, 1], sharex=by_v)
    by_v.tick_params(labelbottom=False)
    draw_plane(figure.add_subplot(grid[:2, 0]), path)
    draw_times(by_v, by_x, path)
    draw_legend(figure.add_subplot(grid[2, :]), path)
    figure.suptitle(path.title(), fontsize=10)
    figure.savefig(picture, dpi=160)


def main():
    arguments = arguments_of(__doc__)
    draw(Path(one_file(arguments, "one picture holds one path")), arguments.picture)


if __name__ == "__main__":
    main()
