"""How well error estimates hold: random cases against much finer runs.

usage: python3 validation/calibration/run.py [--quick] [--groups NAMES] [--cases N] [--seed N] [--jobs N]
                                             [--csv FILE] [--page docs/accuracy.md] [--program build/stickslip]
                                             [--report FOLDER]

Cases (cases.py) follow from the seed and their number. Each is run at several accuracies, and at a much
higher one, whose values stand for the true ones. A value counts where that run is three times as accurate as
the estimate to be judged. --quick takes 60 cases of scalars and 20 of transforms; without it up to 300 of every group.
--page puts table and picture into the manual.
"""

import concurrent.futures
import csv
import os
import pathlib
import random
import shutil
import sys
import textwrap

import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from cases import GROUPS, QUICK
from entry import Entry, subplots
from harness import words_of

import stickslip
from stickslip.plots.style import COLOURS

SECONDS = 120  # the longest run; a case that takes longer is left out
LEAST = 1e-16  # smaller errors are drawn there
ROUNDING = 4 * numpy.finfo(float).eps
COLUMNS = ("group", "case", "accuracy", "key", "entry", "value", "error", "truth", "truth_error", "command")
COLUMNS_OF_TABLE = ("accuracy", "cases", "values", "not judged, %", "misses", "cases with a miss, %", "worst",
                    "median width", "ninth decile")
MARK, END = "<!-- made by validation/calibration/run.py -->", "<!-- end -->"


class LeftOut(Exception):
    """A case that the program refuses, or that takes too long."""


def results_of(program, options):
    try:
        return stickslip.run(program=program, timeout=SECONDS, **options).summary["results"]
    except (stickslip.BadInput, stickslip.Unsolved, stickslip.TimedOut) as reason:
        raise LeftOut(str(reason)) from None


def pairs(result):
    """Value and error of each entry; null stands for what is no number."""
    return numpy.array([numpy.atleast_1d(numpy.array(result[part], float)) for part in ("value", "error")]).T


def judged(program, seed, group, name, number):
    """Rows of one case."""
    scene = group.scene(random.Random(f"{seed} {name} {number}"))
    options = {**scene, **group.asked}
    truth = results_of(program, {**options, "accuracy": group.truth})
    rows = []
    for accuracy in group.accuracies:
        asked = {**options, "accuracy": accuracy}
        found = results_of(program, asked)
        command = " ".join(["stickslip", *(f"'{w}'" if "*" in w else w for w in words_of(asked))])
        for key, result in found.items():
            for entry, ((value, error), (true, doubt)) in enumerate(zip(pairs(result), pairs(truth[key]))):
                rows.append((name, number, accuracy, key, entry, value, error, true, doubt, command))
    return rows


def group_of(arguments, name):
    return QUICK.get(name, GROUPS[name]) if arguments.quick else GROUPS[name]


def number_of_cases(arguments, name):
    return arguments.cases or group_of(arguments, name).cases


def collect(entry, names):
    """Rows of all cases in their order, and the number of those left out."""
    arguments, rows, left_out = entry.arguments, [], 0
    asked = [(name, number) for name in names for number in range(number_of_cases(arguments, name))]
    with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        running = [pool.submit(judged, entry.program.path, arguments.seed, group_of(arguments, name), name, number)
                   for name, number in asked]
        for count, one in enumerate(running, 1):
            try:
                rows += one.result()
            except LeftOut:
                left_out += 1
            except BaseException:
                pool.shutdown(cancel_futures=True)  # the others are not waited for
                raise
            if count % 50 == 0:
                print(f"{count} of {len(asked)} cases", file=sys.stderr, flush=True)
    return rows, left_out


class Judgement:
    """Ratios of rows that count."""

    def __init__(self, rows):
        _, self.case, _, _, _, self.value, self.error, truth, doubt, _ = (
            numpy.array(column) for column in zip(*rows))
        self.true = numpy.abs(self.value - truth)
        rounding = ROUNDING * numpy.abs(truth)
        counts = (3 * doubt <= self.error) & (self.error > rounding) & numpy.isfinite(self.error)
        self.left_out = 1 - counts.mean()
        self.excess = numpy.zeros(len(counts))
        self.excess[counts] = (self.true - doubt - rounding)[counts] / self.error[counts]
        self.missed = self.excess > 1
        width = self.error[counts] / numpy.maximum(self.true, rounding)[counts]
        self.width, self.tenth = numpy.quantile(width, (0.5, 0.9)) if counts.any() else (0, 0)
        cases = set(self.case)
        self.cases = len(cases)
        self.bad = 100 * len(set(self.case[self.missed])) / len(cases)

    def row(self):
        return (f"{self.cases}", f"{len(self.case)}", f"{100 * self.left_out:.1f}", f"{self.missed.sum()}",
                f"{self.bad:.1f}", f"{self.excess.max():.1f}", f"{self.width:.0f}", f"{self.tenth:.0f}")


def judge(entry, name, rows):
    """The rows of its table."""
    group, table, bad = GROUPS[name], [], []
    for accuracy in group.accuracies:
        judgement = Judgement([row for row in rows if row[2] == accuracy])
        table.append((f"{group.what}, {accuracy:g}", *judgement.row()))
        bad.append(judgement.bad)
    entry.claim(f"runs of 100 with an estimate too small, {group.what}", sum(bad) / len(bad), group.most)
    excess = Judgement(rows).excess
    entry.claim(f"error by estimate, {group.what}", excess.max(), group.worst)
    worst = numpy.argsort(-excess, kind="stable")[:5]
    entry.table(f"{group.what}, largest errors by their estimates", ("by estimate", "value", "command"),
                [(f"{excess[n]:.2f}", f"{rows[n][3]}[{rows[n][4]}]", rows[n][-1]) for n in worst])
    return table


def write_page(page, table, words, picture):
    """The table between its marks, the picture beside the page."""
    lines = [*textwrap.wrap(words, 118), "", f"| {' | '.join(COLUMNS_OF_TABLE)} |", "|" + " --- |" * len(COLUMNS_OF_TABLE),
             *(f"| {' | '.join(row)} |" for row in table)]
    before, rest = page.read_text().split(MARK)
    after = rest[rest.index(END):]
    page.write_text(before + MARK + "\n".join(["", *lines, after]))
    shutil.copy(picture, page.with_suffix(".png"))


def draw(rows):
    """Error estimates against true errors, relative to the size of the value."""
    accuracy, value, error, truth = (numpy.array([row[COLUMNS.index(key)] for row in rows], float)
                                     for key in ("accuracy", "value", "error", "truth"))
    size = numpy.maximum(numpy.abs(truth), 1e-300)
    true, estimate = numpy.abs(value - truth) / size, error / size
    figure, axes = subplots(figsize=(6, 5.5))
    for n, one in enumerate(sorted(set(accuracy), reverse=True)):
        of = (accuracy == one) & (estimate > 0)
        axes.loglog(numpy.maximum(true[of], LEAST), estimate[of], ".", color=COLOURS[n % len(COLOURS)], markersize=3,
                    alpha=0.5, label=f"accuracy {one:g}")
    line = numpy.array([LEAST, 1])
    for factor, style in ((1, "-"), (10, "--"), (100, ":")):
        axes.loglog(line, factor * line, color="black", linestyle=style, linewidth=1,
                    label="equal" if factor == 1 else f"{factor} times the error")
    axes.set(xlabel="true error, relative", ylabel="estimate, relative", ylim=(LEAST, None))
    axes.legend(fontsize=8)
    return figure


def main():
    entry = Entry(__doc__, "beyond the paper",
                  ("--groups", {"metavar": "NAMES", "help": f"of {', '.join(GROUPS)}"}),
                  ("--cases", {"type": int, "help": "number of cases of each group"}),
                  ("--seed", {"type": int, "default": 1}),
                  ("--jobs", {"type": int, "default": os.cpu_count()}),
                  ("--csv", {"type": pathlib.Path, "help": "leave every value judged in this file"}),
                  ("--page", {"type": pathlib.Path, "help": "put table and picture into this page"}))
    arguments = entry.arguments
    names = arguments.groups.split(",") if arguments.groups else [*(QUICK if entry.quick else GROUPS)]
    if unknown := sorted(set(names) - set(GROUPS)):
        sys.exit(f"no group {', '.join(unknown)}; there are {', '.join(GROUPS)}")
    rows, left_out = collect(entry, names)
    file = arguments.csv or entry.file("calibration.csv")
    with open(file, "w", newline="") as stream:
        csv.writer(stream).writerows([COLUMNS, *rows])
    counts = ", ".join(f"{number_of_cases(arguments, name)} of {GROUPS[name].what}" for name in names)
    words = f"Cases of seed {arguments.seed}: {counts}; {left_out} of them refused or too long."
    entry.text(words)
    table = [line for name in names for line in judge(entry, name, [row for row in rows if row[0] == name])]
    entry.table("estimates against errors", COLUMNS_OF_TABLE, table)
    entry.figure(draw(rows), "calibration.png", "Each dot is a value. Below the first line the estimate is too "
                 "small; above the others it is 10 and 100 times too wide.")
    if arguments.page:
        write_page(arguments.page, table, words, entry.file("calibration.png"))
    entry.end()


main()
