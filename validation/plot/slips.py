"""Draws slips: their lengths, their largest speeds, first passages, and the displacement.

usage: python3 slips.py FILE.h5|FILE.json... PICTURE.png

Files come from `stickslip -quantities slip,peak,displacement -distance 0.01:10:31:log -velocity 0.1:2:20
-time 0.01:10:31:log -output FILE.h5`, or from -summary FILE.json. Each quantity in a file has a panel. Lines
are computed, marks with 95 % intervals simulated; S_0 t is there where spectrum was asked for too.
"""

import json
import pathlib
import sys

import numpy
from results import COLOURS, STYLES, File, arguments_of, plt

# Quantities of a panel, abscissa, its label, label of the values, scales.
PANELS = (
    (("f_slip",), "distance", "path length $d$  [length]", "$f_S(d)$  [1/length]", "log", "log"),
    (("cdf_slip",), "distance", "path length $d$  [length]", r"$P(S \leq d)$", "log", "linear"),
    (("F_slip",), "inverse_distance", "$s$  [1/length]", r"$E[e^{-s S}]$", "log", "linear"),
    (("P_peak",), "velocity", "$w$  [velocity]", "P(largest speed $> w$)", "linear", "log"),
    (("mean_first_passage", "mean_first_passage_rest"), "velocity", "$w$  [velocity]",
     "mean time to $|V| = w$  [time]", "linear", "log"),
    (("displacement_variance",), "time", "$t$  [time]", "Var $x(t)$  [length$^2$]", "log", "log"),
    (("displacement_mean",), "time", "$t$  [time]", "$E[x(t)]$  [length]", "linear", "linear"))
SPELT = {"mean_first_passage": "from the start of a slide", "mean_first_passage_rest": "from rest"}


def results_of(name):
    """Datasets of each result by name, simulated ones with low and high."""
    if not name.endswith(".json"):
        group = File(name).file.get("results", {})
        return {key: {part: values[()] for part, values in result.items()} for key, result in group.items()}
    try:
        results = json.loads(pathlib.Path(name).read_text()).get("results", {})
    except (OSError, ValueError, AttributeError):
        sys.exit(f"{name}: cannot be read as a summary; the program writes it with -summary {name}")
    for result in results.values():
        result.update((part, numpy.array(result[part], float)) for part in result if part not in ("unit", "ci95"))
        if "ci95" in result:  # null where an interval is infinite
            result["low"], result["high"] = numpy.array(result.pop("ci95"), float).T
    return results


def draw_result(axes, abscissa, result, colour, style, label):
    x, value = result[abscissa], result["value"]
    if "low" in result:
        sides = numpy.maximum([value - result["low"], result["high"] - value], 0)
        axes.errorbar(x, value, yerr=sides, fmt="o", color=colour, markersize=3, capsize=2, linewidth=1,
                      markerfacecolor=colour if style == STYLES[0] else "white", label=label)
    else:
        axes.plot(x, value, color=colour, linestyle=style, label=label, marker="." if x.size == 1 else "")


def draw_panel(axes, panel, files):
    keys, abscissa, x_label, y_label, x_scale, y_scale = panel
    for n, (name, results) in enumerate(files.items()):
        colour = COLOURS[n % len(COLOURS)]
        for key, style in zip(keys, STYLES):
            if key in results:
                words = ([name] if len(files) > 1 else []) + ([SPELT[key]] if key in SPELT else [])
                draw_result(axes, abscissa, results[key], colour, style, ", ".join(words) or None)
        if "displacement_variance" in keys and {keys[0], "S_0"} <= results.keys():
            t = results[keys[0]]["time"]
            axes.plot(t, results["S_0"]["value"] * t, color="#888888", linewidth=0.9, linestyle=STYLES[3],
                      zorder=1, label=None if n else "$S_0 t$")
    axes.set(xlabel=x_label, ylabel=y_label, xscale=x_scale, yscale=y_scale)
    if y_scale == "linear" and "displacement_mean" not in keys:
        axes.set_ylim(0, 1.03)
    if axes.get_legend_handles_labels()[1]:
        axes.legend(fontsize=8)


def draw(files, picture):
    panels = [panel for panel in PANELS if any(
        key in results and numpy.any(results[key]["value"]) for key in panel[0] for results in files.values())]
    if not panels:
        sys.exit("no slips in these files; they come from -quantities slip,peak,displacement with -distance, "
                 "-velocity and -time")
    columns = min(len(panels), 2 if len(panels) in (2, 4) else 3)
    rows = -(-len(panels) // columns)
    figure = plt.figure(figsize=(0.6 + 3.4 * columns, 0.2 + 2.8 * rows), layout="constrained")
    for n, panel in enumerate(panels):
        draw_panel(figure.add_subplot(rows, columns, n + 1), panel, files)
    figure.savefig(picture, dpi=150)


def main():
    arguments = arguments_of(__doc__)
    draw({pathlib.Path(name).stem: results_of(name) for name in arguments.files}, arguments.picture)


if __name__ == "__main__":
    main()
