"""Draws what -compare found: reference values with their 95 % intervals around ours.

usage: python3 comparison.py FILE.h5 PICTURE.png

Files come from `stickslip -compare REFERENCE -output FILE.h5`. Scalars share the first panel, in
standard deviations of the difference; each array has a panel of its own, with the deviations below.
"""

import numpy

from results import COLOURS, File, arguments_of, one_file, plt

OURS, REFERENCE = COLOURS[:2]
WIDTH = 1.96  # of a 95 % interval, in standard deviations to each side
ABSCISSAE = {"S_v": r"$\omega$  [1/time]", "entry_law": "level $i$"}
COLUMNS = 3


def abscissa(key):
    if key.startswith("F_"):
        return r"$\lambda$  [1/time]"
    return ABSCISSAE.get(key, "time $t$  [time]")


def deviation(rows):
    """Of the difference, on the side of the reference on which our values are."""
    half = numpy.where(rows["value"] > rows["reference"], rows["high"] - rows["reference"],
                       rows["reference"] - rows["low"])
    return numpy.maximum(numpy.hypot(half / WIDTH, rows["error"]), 1e-300)


def bar_of(rows):
    """Lengths of the reference's error bars, downwards and upwards."""
    return numpy.array([rows["reference"] - rows["low"], rows["high"] - rows["reference"]])


def draw_scalars(axes, scalars):
    names = list(scalars)[::-1]
    for n, name in enumerate(names):
        rows, scale = scalars[name], deviation(scalars[name])
        value, own = rows["value"], WIDTH * rows["error"] / scale
        place = (rows["reference"] - value) / scale
        bar = bar_of(rows) / scale
        axes.barh(n, 2 * own, left=-own, height=0.5, color=OURS, alpha=0.3)
        axes.plot([0, 0], [n - 0.25, n + 0.25], color=OURS, linewidth=2)
        axes.errorbar(place, [n], xerr=bar, fmt="o", color=REFERENCE, markersize=4, capsize=3)
        axes.text(1.02, n, f"{value[0]:.6g}", transform=axes.get_yaxis_transform(), va="center",
                  fontsize=8)
    axes.text(1.02, 1.0, "our value", transform=axes.transAxes, va="bottom", fontsize=8)
    axes.axvspan(-WIDTH, WIDTH, color="#777777", alpha=0.1, linewidth=0)
    axes.set(yticks=range(len(names)), yticklabels=names, ylim=(-0.6, len(names) - 0.4),
             xlabel="reference minus ours  [standard deviations of the difference]")
    axes.grid(axis="y", visible=False)


def draw_array(above, below, file, key, rows):
    order = numpy.argsort(rows["argument"])
    at, value, reference = (rows[name][order] for name in ("argument", "value", "reference"))
    above.plot(at, value, color=OURS, linewidth=1.4)
    above.errorbar(at, reference, yerr=bar_of(rows)[:, order], fmt="o", color=REFERENCE,
                   markersize=2.5, elinewidth=1, capsize=1.5)
    below.plot(at, -rows["z"][order], "o", color=REFERENCE, markersize=2.5)
    below.axhline(0, color=OURS, linewidth=1)
    below.axhspan(-WIDTH, WIDTH, color="#777777", alpha=0.12, linewidth=0)
    reach = max(3.5, 1.1 * numpy.abs(rows["z"]).max())
    below.set(xlabel=abscissa(key), ylim=(-reach, reach))
    below.set_ylabel("deviations", fontsize=8)
    if at[0] > 0 and at[-1] > 30 * at[0]:
        above.set_xscale("log")
    if key == "S_v":
        above.set_yscale("log")
    if key == "entry_law":
        below.xaxis.set_major_locator(plt.MaxNLocator(integer=True))
    unit = file.unit(key)
    above.set_title(f"{key}  [{unit}]" if unit else key, fontsize=9)
    above.tick_params(labelbottom=False)


def draw_legend(axes):
    handles = [plt.Line2D([], [], color=OURS, label="ours"),
               plt.Rectangle((0, 0), 1, 1, color=OURS, alpha=0.3, label="our 95 % interval"),
               plt.Line2D([], [], color=REFERENCE, marker="o", markersize=4,
                          label="reference, 95 %"),
               plt.Rectangle((0, 0), 1, 1, color="#777777", alpha=0.15,
                             label=r"$\pm$1.96 deviations")]
    axes.legend(handles=handles, loc="center", ncol=len(handles), columnspacing=1.2)
    axes.axis("off")


def draw_arrays(figure, file, arrays):
    columns = min(COLUMNS, len(arrays))
    grid = figure.add_gridspec(-(-len(arrays) // columns), columns)
    for n, (key, rows) in enumerate(arrays.items()):
        cell = grid[n // columns, n % columns].subgridspec(2, 1, height_ratios=(3, 1))
        above = figure.add_subplot(cell[0])
        draw_array(above, figure.add_subplot(cell[1], sharex=above), file, key, rows)


def draw(file, picture):
    groups = file.groups("comparison")
    groups.pop("E_V", None)  # 0 by symmetry on both sides
    scalars = {key: rows for key, rows in groups.items() if file.is_scalar(key)}
    arrays = {key: rows for key, rows in groups.items() if key not in scalars}
    columns = min(COLUMNS, len(arrays)) or 1
    heights = [0.4] + [0.8 + 0.25 * len(scalars)] * bool(scalars)
    heights += [3.0 * -(-len(arrays) // columns)] * bool(arrays)
    figure = plt.figure(figsize=(max(6.4, 3.1 * columns), sum(heights)), layout="constrained")
    parts = list(figure.subfigures(len(heights), 1, height_ratios=heights, squeeze=False)[:, 0])
    draw_legend(parts[0].add_subplot())
    if scalars:
        draw_scalars(parts[1].add_subplot(), scalars)
    if arrays:
        draw_arrays(parts[-1], file, arrays)
    figure.savefig(picture, dpi=160)


def main():
    arguments = arguments_of(__doc__)
    draw(File(one_file(arguments, "it holds one comparison")), arguments.picture)


if __name__ == "__main__":
    main()
