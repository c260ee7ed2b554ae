"""Draws the seconds of every run of the benchmark, by method.

usage: python3 benchmark.py FILE.csv PICTURE.png

The file comes from `python3 validation/benchmark/run.py --report FOLDER`.
"""

import csv
import statistics

from results import COLOURS, arguments_of, plt


def read(name):
    """Seconds by group and method, in the order of the file."""
    groups = {}
    with open(name, newline="") as file:
        for line in csv.DictReader(file):
            methods = groups.setdefault(line["group"], {})
            methods.setdefault(line["method"], []).append(float(line["seconds"]))
    return groups


def draw(groups, picture):
    rows = sum(map(len, groups.values())) + len(groups)
    figure, axes = plt.subplots(figsize=(7, 0.8 + 0.26 * rows), layout="constrained")
    at, places, labels = 0, [], []
    for n, (group, methods) in enumerate(groups.items()):
        axes.text(0.01, at, group, transform=axes.get_yaxis_transform(), fontsize=9,
                  fontweight="bold", va="center")
        at += 1
        for method, seconds in methods.items():
            colour = COLOURS[n % len(COLOURS)]
            axes.plot(seconds, [at] * len(seconds), "o", color=colour, markersize=4, alpha=0.6)
            axes.plot(statistics.median(seconds), at, "|", color=colour, markersize=14)
            places.append(at)
            labels.append(method)
            at += 1
    axes.set(xscale="log", xlabel="wall time of the process  [s]", ylim=(at - 0.5, -0.8))
    axes.set_yticks(places, labels)
    figure.savefig(picture, dpi=160)


def main():
    arguments = arguments_of(__doc__)
    draw(read(arguments.files[0]), arguments.picture)


if __name__ == "__main__":
    main()
