"""How well error estimates hold: random cases against direct solves and much finer runs.

An error estimate is worth something if it is hardly ever too small and not much too large. Parameters are drawn at
random, and every value that the program gives is compared with the truth: by kind of result, a run at a much higher
accuracy, dense complex solves of another discretisation, or direct solves without reduced models. A value counts
where the truth is known three times as well as the estimate claims. So the true error stands beside the estimate,
value by value.

usage: python3 validation/calibration/run.py [--quick] [--groups NAMES] [--cases N] [--seed N] [--jobs N]
                                             [--csv FILE] [--page docs/accuracy.md] [--program build/stickslip]
                                             [--complex-program build/stickslip-complex] [--report FOLDER]

Cases (cases.py) follow from the seed and their number. Each is run at several accuracies. Truths are found in run.py
and direct.py, or by stickslip-complex. Runs that take over 20 times what -plan predicts are listed. --quick
takes 16 cases of scalars and 10 of transforms; without it up to 300 of every group.
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

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # cases run side by side
import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
import direct
from cases import GROUPS, QUICK, levels_in_file
from entry import Entry, subplots
from harness import ROOT, words_of

import stickslip
from stickslip.plots.style import COLOURS

SECONDS = 120  # the longest run; a case that takes longer is left out
LEAST = 1e-16  # smaller errors are drawn there
SLOW, LEAST_SECONDS = 20, 1.0  # times the prediction, of runs that take so long
ROUNDING = 4 * numpy.finfo(float).eps
COLUMNS = ("group", "case", "accuracy", "key", "entry", "value", "error", "truth", "truth_error", "command")
COLUMNS_OF_TABLE = ("accuracy", "cases", "values", "not judged, %", "misses", "cases with a miss, %", "worst",
                    "median width", "ninth decile")
MARK, END = "<!-- made by validation/calibration/run.py -->", "<!-- end -->"


class LeftOut(Exception):
    """A case that the program refuses, or that takes too long."""


def run(program, options):
    try:
        return stickslip.run(program=program, timeout=SECONDS, **options).summary
    except (stickslip.BadInput, stickslip.Unsolved, stickslip.TimedOut) as reason:
        raise LeftOut(str(reason)) from None


def pairs(result):
    """Value and error of each entry; null stands for what is no number."""
    return numpy.array([numpy.atleast_1d(numpy.array(result[part], float)) for part in ("value", "error")]).T


def truth_of(entry, options, truth):
    """Values and doubts by key."""
    if truth == "direct":
        return {key: numpy.array(pair).T for key, pair in direct.truth(options).items()}
    program, more = entry.program.path, {"accuracy": truth}
    if truth == "complex":
        program, more = entry.arguments.complex_program, {"accuracy": 1e-8, "spectrum_solver": "direct"}
    return {key: pairs(result) for key, result in run(program, {**levels_in_file(options, entry), **more})["results"].items()}


def known(truth, key, values):
    """Pairs of truth and doubt beside the values; nothing where the truth is not known."""
    if key in truth:
        return truth[key]
    if "rates" not in truth or not key.startswith("relaxation") or key.endswith("frequency"):
        return None
    rates = truth["rates"]
    nearest = [numpy.abs(rates[:, 0].real - value).argmin() for value in values]
    return [(rates[n, 0].real, rates[n, 1].real) for n in nearest]


def too_slow(entry, asked, summary):
    """Seconds by prediction, if there are far too many."""
    seconds = summary["cost"]["seconds"] - summary["cost"]["start_up_seconds"]
    if entry.quick or seconds < LEAST_SECONDS:
        return 0
    ratio = seconds / max(run(entry.program.path, {**asked, "plan": True})["plan"]["seconds"], 1e-3)
    return ratio if ratio > SLOW else 0


def judged(entry, name, number):
    """Rows of one case, and its runs that were too slow."""
    group = group_of(entry.arguments, name)
    scene = group.scene(random.Random(f"{entry.arguments.seed} {name} {number}"))
    options = {**scene, **group.asked}
    truth = truth_of(entry, options, group.truth)
    rows, slow = [], []
    for accuracy in group.accuracies:
        asked = {**levels_in_file(options, entry), "accuracy": accuracy}
        summary = run(entry.program.path, asked)
        found = summary["results"]
        command = " ".join(["stickslip", *(f"'{w}'" if "*" in w else w for w in words_of(asked))])
        if ratio := too_slow(entry, asked, summary):
            slow.append((ratio, command))
        for key, result in found.items():
            values = pairs(result)
            if (true := known(truth, key, values[:, 0])) is None:
                continue
            for n, ((value, error), (exact, doubt)) in enumerate(zip(values, true)):
                rows.append((name, number, accuracy, key, n, value, error, exact, doubt, command))
    return rows, slow


def group_of(arguments, name):
    return QUICK.get(name, GROUPS[name]) if arguments.quick else GROUPS[name]


def number_of_cases(arguments, name):
    return arguments.cases or group_of(arguments, name).cases


def collect(entry, names):
    """Rows of all cases in their order, runs that were too slow, and the number of cases left out."""
    arguments, rows, slow, left_out = entry.arguments, [], [], 0
    asked = [(name, number) for name in names for number in range(number_of_cases(arguments, name))]
    with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        running = [pool.submit(judged, entry, *one) for one in asked]
        for count, one in enumerate(running, 1):
            try:
                more = one.result()
                rows, slow = rows + more[0], slow + more[1]
            except LeftOut:
                left_out += 1
            except stickslip.ProgramError as problem:
                entry.verdict(False, f"{one[0]}, case {one[1]}, runs", str(problem))
            except BaseException:
                pool.shutdown(cancel_futures=True)  # the others are not waited for
                raise
            if count % 50 == 0:
                print(f"{count} of {len(asked)} cases", file=sys.stderr, flush=True)
    return rows, slow, left_out


class Judgement:
    """Ratios of rows that count."""

    def __init__(self, rows):
        group, case, _, _, _, self.value, self.error, truth, doubt, _ = (
            numpy.array(column) for column in zip(*rows))
        self.case = numpy.array([f"{a} {b}" for a, b in zip(group, case)])
        self.true = numpy.abs(self.value - truth)
        rounding = ROUNDING * numpy.abs(truth)
        counts = (3 * doubt <= self.error) & (self.error > rounding) & numpy.isfinite(self.error)
        self.counts, self.left_out = counts, 1 - counts.mean()
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
    entry.table(f"Largest errors by their estimates, {group.what}", ("by estimate", "value", "command"),
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
    """Error estimates against true errors, relative to the size of the value: how many values are where, and each of
    those whose estimate is too small. Values that are not judged would show errors of the truth."""
    judged = Judgement(rows)
    size = numpy.maximum(numpy.abs(numpy.array([row[COLUMNS.index("truth")] for row in rows], float)), 1e-300)
    true, estimate, missed = (part[judged.counts] for part in (
        numpy.maximum(judged.true / size, LEAST), judged.error / size, judged.missed))
    figure, axes = subplots(figsize=(6, 5.2))
    cells = axes.hexbin(true, estimate, xscale="log", yscale="log", bins="log", gridsize=70, mincnt=1, cmap="cividis_r",
                        linewidths=0.1)
    figure.colorbar(cells, label="values")
    axes.plot(true[missed], estimate[missed], "o", color=COLOURS[1], markersize=3, markeredgewidth=0,
              label="estimate too small")
    line = numpy.array([LEAST, true.max()])
    for factor, style in ((1, "-"), (10, "--"), (100, ":")):
        axes.plot(line, factor * line, color="black", linestyle=style, linewidth=1,
                  label="equal" if factor == 1 else f"{factor} times the error")
    axes.set(xlabel="true error, relative", ylabel="estimate, relative", ylim=(LEAST, None))
    axes.legend(fontsize=8, loc="lower right")
    return figure


def main():
    entry = Entry(__doc__, "beyond the paper",
                  ("--groups", {"metavar": "NAMES", "help": f"of {', '.join(GROUPS)}"}),
                  ("--cases", {"type": int, "help": "number of cases of each group"}),
                  ("--seed", {"type": int, "default": 1}),
                  ("--jobs", {"type": int, "default": os.cpu_count()}),
                  ("--complex-program", {"type": pathlib.Path, "default": ROOT / "build" / "stickslip-complex"}),
                  ("--csv", {"type": pathlib.Path, "help": "leave every value judged in this file"}),
                  ("--page", {"type": pathlib.Path, "help": "put table and picture into this page"}))
    arguments = entry.arguments
    names = arguments.groups.split(",") if arguments.groups else [*(QUICK if entry.quick else GROUPS)]
    if unknown := sorted(set(names) - set(GROUPS)):
        sys.exit(f"no group {', '.join(unknown)}; there are {', '.join(GROUPS)}")
    rows, slow, left_out = collect(entry, names)
    file = arguments.csv or entry.file("calibration.csv")
    with open(file, "w", newline="") as stream:
        csv.writer(stream).writerows([COLUMNS, *rows])
    counts = ", ".join(f"{number_of_cases(arguments, name)} of {GROUPS[name].what}" for name in names)
    words = f"Cases of seed {arguments.seed}: {counts}; {left_out} of them refused or too long."
    entry.text(words)
    table = [line for name in names for line in judge(entry, name, [row for row in rows if row[0] == name])]
    entry.table("Estimates compared with errors, by kind of result and accuracy", COLUMNS_OF_TABLE, table)
    if slow:
        entry.table(f"Runs over {SLOW} times their prediction", ("times", "command"),
                    [(f"{ratio:.0f}", command) for ratio, command in sorted(slow, reverse=True)])
    misses = Judgement(rows)
    entry.text(f"In all, {100 * misses.missed.mean():.2f} % of the values and {misses.bad:.1f} % of the cases have an "
               f"estimate too small, the worst by {misses.excess.max():.3g}; {len(slow)} runs took over {SLOW} times "
               "their prediction.")
    entry.figure(draw(rows), "calibration.png", "How many values have which error and estimate. Below the first "
                 "line the estimate is too small; above the others it is 10 and 100 times too wide.")
    if arguments.page:
        write_page(arguments.page, table, words, entry.file("calibration.png"))
    entry.end()


main()
