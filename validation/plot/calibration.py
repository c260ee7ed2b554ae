"""Draws error estimates against true errors.

usage: python3 calibration.py FILE.csv PICTURE.png

FILE.csv comes from `validation/calibration/run.py --csv FILE.csv`. Each dot is a value, relative to its size.
"""

import csv

import numpy
from results import COLOURS, arguments_of, plt

LEAST = 1e-16  # smaller errors are drawn there


def main():
    arguments = arguments_of(__doc__)
    with open(arguments.files[0], newline="") as file:
        rows = list(csv.DictReader(file))
    value, error, truth, accuracy = (numpy.array([float(row[key]) for row in rows])
                                     for key in ("value", "error", "truth", "accuracy"))
    size = numpy.maximum(numpy.abs(truth), 1e-300)
    true, estimate = numpy.abs(value - truth) / size, error / size
    figure, axes = plt.subplots(figsize=(6, 5.5), layout="constrained")
    for n, one in enumerate(sorted(set(accuracy), reverse=True)):
        of = (accuracy == one) & (estimate > 0)
        axes.loglog(numpy.maximum(true[of], LEAST), estimate[of], ".", color=COLOURS[n % len(COLOURS)], markersize=3,
                    alpha=0.5, label=f"accuracy {one:g}")
    line = numpy.array([LEAST, 1])
    for factor, style in ((1, "-"), (10, "--"), (100, ":")):
        axes.loglog(line, factor * line, color="black", linestyle=style, linewidth=1,
                    label="equal" if factor == 1 else f"{factor} times the error")
    axes.set_xlabel("true error, relative")
    axes.set_ylabel("estimate, relative")
    axes.set_ylim(LEAST, None)
    axes.legend(fontsize=8)
    figure.savefig(arguments.picture, dpi=150)


main()
