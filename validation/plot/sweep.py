"""Draws a picture of each scalar of a sweep.

usage: python3 sweep.py FILE.h5|FILE.csv [-o FOLDER]

Files come from `stickslip -sweep_mu_d 0.1:1:10 [-sweep_tau 0.5:2:4] -output FILE.h5` or
`-sweep_csv FILE.csv`. One option is an axis, error estimates are bars; of two options the second is
the axis and the first one tells curves apart, up to five values, or makes a map of more. Further
options stay at their first value. Points that fell short are marked by crosses. Prints the pictures' names.
"""

import argparse
import csv
import math
import pathlib
import re
import sys

import numpy

from results import COLOURS, STYLES, File, plt

FEW = 5  # curves told apart by colour and line style


class Sweep:
    """Axes, and each scalar with its error as an array over them."""

    def __init__(self, axes, scalars, status, units):
        self.axes, self.scalars, self.status, self.units = axes, scalars, status, units

    def label(self, name):
        unit = self.units.get(name, "")
        return name + (f"  [{unit}]" if unit else "")

    def of_two(self):
        """The same with the first value of every axis but the first two."""
        first = (slice(None), slice(None)) + (0,) * (len(self.axes) - 2)
        cut = {key: tuple(part[first] for part in pair) for key, pair in self.scalars.items()}
        rest = dict(list(self.axes.items())[:2])
        return Sweep(rest, cut, self.status[first], self.units)


def from_hdf5(name):
    file = File(name)
    group = file.group("sweep")
    axes = {axis: group[axis] for axis in file.file["sweep"].attrs["axes"].split(",")}
    shape = tuple(len(values) for values in axes.values())
    scalars = {key: (group[key], group[key + "_error"]) for key in group
               if key + "_error" in group and group[key].shape == shape}
    units = {key: str(data.attrs.get("unit", "")) for key, data in file.file["sweep"].items()}
    return Sweep(axes, scalars, group["status"] == 0, units)


def from_csv(name):
    try:
        with open(name, newline="") as file:
            head, *rows = csv.reader(file)
    except (OSError, ValueError):
        sys.exit(f"{name}: cannot be read; the program writes it with -sweep_csv {name}")
    keys = [key for key in head if key + "_error" in head]
    if head[-1] != "status" or not keys:
        sys.exit(f"{name}: not the CSV file of a sweep")
    columns = dict(zip(head, zip(*rows)))
    axes = {}
    for axis in head[:head.index(keys[0])]:
        axes[axis] = numpy.array(list(dict.fromkeys(map(float, columns[axis]))))
    shape = tuple(len(values) for values in axes.values())

    def grid(key):
        return numpy.array([float(x) if x else math.nan for x in columns[key]]).reshape(shape)

    reached = numpy.array([x == "reached" for x in columns["status"]]).reshape(shape)
    return Sweep(axes, {key: (grid(key), grid(key + "_error")) for key in keys}, reached, {})


def scale(values):
    """Logarithmic where neighbours differ by a factor rather than by a distance."""
    values = numpy.sort(values)
    even = len(values) > 2 and values[0] > 0 and numpy.ptp(numpy.diff(numpy.log(values))) < 1e-6
    return "log" if even else "linear"


def curve(axes, x, value, error, reached, n=0, label=None):
    colour = COLOURS[n % len(COLOURS)]
    order = numpy.argsort(x)
    axes.errorbar(x[order], value[order], yerr=error[order], color=colour, marker="os^Dv"[n % 5],
                  linestyle=STYLES[n % len(STYLES)], markersize=4, capsize=2, label=label)
    axes.plot(x[~reached], value[~reached], linestyle="", marker="x", markersize=9, color=colour)


def draw_map(figure, axes, sweep, key, value):
    (down, y), (across, x) = sweep.axes.items()
    rows, columns = numpy.argsort(y), numpy.argsort(x)
    mesh = axes.pcolormesh(x[columns], y[rows], value[rows][:, columns], shading="nearest",
                           cmap="cividis")
    short = numpy.argwhere(~sweep.status)
    axes.plot(x[short[:, 1]], y[short[:, 0]], linestyle="", marker="x", color="white")
    figure.colorbar(mesh, label=sweep.label(key))
    axes.set(xscale=scale(x), yscale=scale(y), xlabel=sweep.label(across), ylabel=sweep.label(down))
    axes.grid(False)


def draw(sweep, key, picture):
    value, error = sweep.scalars[key]
    figure, axes = plt.subplots(figsize=(6.4, 4.2), layout="constrained")
    names = list(sweep.axes)
    if len(names) == 2 and len(sweep.axes[names[0]]) > FEW:
        draw_map(figure, axes, sweep, key, value)
    else:
        x = sweep.axes[names[-1]]
        if len(names) == 1:
            curve(axes, x, value, error, sweep.status)
        else:
            for n, fixed in enumerate(sweep.axes[names[0]]):
                curve(axes, x, value[n], error[n], sweep.status[n], n,
                      f"{names[0]} = {fixed:g}")
            axes.legend()
        axes.set(xscale=scale(x), xlabel=sweep.label(names[-1]), ylabel=sweep.label(key))
    figure.savefig(picture, dpi=160)
    plt.close(figure)


def main():
    parser = argparse.ArgumentParser(description=__doc__, usage=argparse.SUPPRESS,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file", metavar="FILE.h5|FILE.csv")
    parser.add_argument("-o", dest="folder", metavar="FOLDER", type=pathlib.Path,
                        default=pathlib.Path("."), help="where the pictures go (default: here)")
    arguments = parser.parse_args()
    sweep = (from_csv if arguments.file.endswith(".csv") else from_hdf5)(arguments.file)
    if len(sweep.axes) > 2:
        fixed = ", ".join(f"{name} = {values[0]:g}" for name, values in list(sweep.axes.items())[2:])
        print(f"more than two options are swept; drawn at {fixed}", file=sys.stderr)
        sweep = sweep.of_two()
    arguments.folder.mkdir(parents=True, exist_ok=True)
    for key in sweep.scalars:
        name = re.sub(r"[^\w.+-]", "_", key)  # keys of observables hold anything
        draw(sweep, key, arguments.folder / f"{name}.png")
        print(arguments.folder / f"{name}.png")


if __name__ == "__main__":
    main()
