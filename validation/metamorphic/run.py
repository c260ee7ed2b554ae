"""Random cases that must agree with other cases, and with themselves.

Nobody knows the right numbers of a random case. But reversing all forces and velocities, another order of the states of
the noise, a state that is split in two, other units, the same noise in another form, a sum with a noise that is zero, a
bias in the place of thresholds, next to no bias, and a looser accuracy change results in known ways, while they change
the path through the program. Simulation draws paths under the same model. Identities between quantities need one case
alone. Each value has an error: two values must differ by no more than the sum of both, and in other units, which are
powers of two, by no more than 1e-12.

usage: python3 validation/metamorphic/run.py [--quick] [--cases N] [--seed N] [--jobs N] [--only NAMES] [--each N]
                                             [--program build/stickslip] [--report FOLDER]

Cases (drawn.py) follow from the seed and their number. Each is compared under --each transformations (relations.py) and
one identity (identities.py), of all or of those that --only names. --quick takes 10 cases instead of 1000. A run that takes
longer than two minutes is left out.
"""

import collections
import concurrent.futures
import os
import pathlib
import queue
import random
import shlex
import sys

VALIDATION = pathlib.Path(__file__).resolve().parents[1]
sys.path[:0] = [str(VALIDATION / folder) for folder in ("", "calibration")]
from entry import Entry  # which finds the package
from harness import words_of
from drawn import drawn, in_files
from identities import IDENTITIES
from relations import TRANSFORMATIONS, exactness
from values import Answer, Value, ratio

import stickslip
from stickslip.cases import Worker

SECONDS, QUICK_SECONDS = 120, 6  # the longest run; what takes longer is left out
MISSES, WORST = 1 / 500, 2  # of comparisons, and times what is allowed
SHOWN = 20


class Refused(Exception):
    """The program says why it does not compute this."""


class Late(Exception):
    """A run that takes too long."""


class Runner:
    """Answers cases by processes of the program that stay."""

    def __init__(self, entry, jobs):
        self.entry, self.workers, self.idle = entry, [Worker(entry.program.path) for _ in range(jobs)], queue.SimpleQueue()
        for worker in self.workers:
            self.idle.put(worker)

    def __call__(self, options):
        worker = self.idle.get()
        try:
            summary = worker.run(timeout=QUICK_SECONDS if self.entry.quick else SECONDS, **in_files(options, self.entry)).summary
        except (stickslip.BadInput, stickslip.OutOfMemory, stickslip.Unsolved) as problem:
            raise Refused(str(problem)) from None
        except stickslip.TimedOut as problem:
            raise Late(str(problem)) from None
        finally:
            self.idle.put(worker)
        return Answer(summary, options.get("observable", ""))

    def command(self, options):
        return shlex.join(["stickslip", *words_of(in_files(options, self.entry))])


def compared(exact, answer, other, back):
    """(key, ratio) of what both have."""
    if exact and other.status != answer.status:
        yield f"status {answer.status}, {other.status}", float("inf")
    for key, value in other.values.items():
        found = back(key, value, other)
        if found is None or found[0] not in answer.values:
            continue
        key, value = found
        mine = answer.values[key]
        if exact:
            size = exact * max(abs(mine.value).ravel(), default=0)
            mine, value = Value(mine.value, size), Value(value.value, 0)
        if (times := ratio(mine, value)) is not None:
            yield key, times


def transformed(run, name, options, answer, draw):
    """Rows (relation, key, ratio, command, command of the other case), or None where it does not apply."""
    made = TRANSFORMATIONS[name](options, draw)
    if made is None:
        return None
    other, back = made
    try:
        found = run(other)
    except Refused as reason:
        if name == "simulated" or "noise joins" in str(reason):
            return None
        return [(name, f"refused: {reason}", float("inf"), run.command(options), run.command(other))]
    return [(name, key, times, run.command(options), run.command(other))
            for key, times in compared(exactness(name, options), answer, found, back)]


def identical(run, name, options, draw):
    """Rows as of transformed()."""
    commands = []
    without = {key: value for key, value in options.items() if key not in (
        "lambda", "omega", "time", "distance", "inverse_distance", "velocity", "wavenumber", "probability", "tilt",
        "observable", "passage", "start")}

    def ask(quantities, **more):
        asked = without | {"quantities": quantities} | more
        commands.append(run.command(asked))
        return run(asked)
    try:
        rows = [(words, ratio(one, other)) for words, one, other in IDENTITIES[name](ask, options, draw)]
    except Refused:
        return None
    return [(name, words, times, commands[0], " and ".join(commands[1:])) for words, times in rows if times is not None]


def of_case(run, number, arguments):
    """Kind of the case, its rows, and what was left out and why."""
    draw = random.Random(f"{arguments.seed} {number}")
    kind, options = drawn(draw)
    rows, left_out = [], []
    try:
        answer = run(options)
    except (Refused, Late) as reason:
        return kind, [], [f"{type(reason).__name__}: {reason}: {run.command(options)}"]
    except stickslip.ProgramError as problem:
        return kind, [("runs", str(problem), float("inf"), run.command(options), "")], []
    for table, most in ((TRANSFORMATIONS, arguments.each), (IDENTITIES, 1)):
        names = [name for name in table if not arguments.only or name in arguments.only.split(",")]
        for name in draw.sample(names, len(names)):
            if most == 0:
                break
            own = random.Random(f"{arguments.seed} {number} {name}")
            try:
                more = (transformed(run, name, options, answer, own) if table is TRANSFORMATIONS
                        else identical(run, name, options, own))
            except Late as reason:
                left_out.append(f"{name}: {reason}: {run.command(options)}")
                continue
            except stickslip.ProgramError as problem:
                more = [(name, str(problem), float("inf"), run.command(options), "")]
            if more:
                rows += more
                most -= 1
    return kind, rows, left_out


def main():
    entry = Entry(__doc__, "beyond the paper",
                  ("--cases", {"type": int, "help": "number of cases"}), ("--seed", {"type": int, "default": 1}),
                  ("--jobs", {"type": int, "default": os.cpu_count()}),
                  ("--each", {"type": int, "default": 2, "help": "transformations of each case"}),
                  ("--only", {"default": "", "metavar": "NAMES", "help": f"of {', '.join([*TRANSFORMATIONS, *IDENTITIES])}"}))
    arguments = entry.arguments
    run = Runner(entry, arguments.jobs)
    count = arguments.cases or (10 if entry.quick else 1000)
    rows, left_out, kinds = [], [], collections.Counter()
    with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        for number, (kind, more, out) in enumerate(pool.map(lambda n: of_case(run, n, arguments), range(count))):
            kinds[kind] += bool(more)
            left_out += out
            rows += [(number, *row) for row in more]
            for name in sorted({row[0] for row in more}):
                _, key, times, here, there = max((row for row in more if row[0] == name), key=lambda row: row[2])
                if not times <= 1:
                    print(f"  case {number}, {name}, {key}: {times:.3g}\n    {here}\n    {there}", flush=True)
    for worker in run.workers:
        worker.end()
    report(entry, rows, left_out, kinds)
    entry.end()


def report(entry, rows, left_out, kinds):
    """Tables and claims."""
    entry.text(f"Seed {entry.arguments.seed}: " + ", ".join(f"{n} of {kind}" for kind, n in sorted(kinds.items()))
               + f"; {len(left_out)} refused or too long.")
    for line in left_out:
        print(f"  {line}")
    table, pairs_missed, pairs = [], 0, 0
    for name in [*TRANSFORMATIONS, *IDENTITIES, "runs"]:
        own = [row for row in rows if row[1] == name]
        if not own:
            continue
        cases, missed = ({row[0] for row in part} for part in (own, [row for row in own if not row[3] <= 1]))
        worst = max(own, key=lambda row: row[3])
        table.append((name, f"{len(cases)}", f"{len(own)}", f"{len(missed)}", f"{worst[3]:.3g}", worst[2].split("\n")[0][:60]))
        pairs, pairs_missed = pairs + len(cases), pairs_missed + len(missed)
    entry.table("Pairs of cases, and identities; keys compared; pairs with a difference above what is allowed",
                ("relation", "pairs", "keys", "misses", "worst", "where"), table)
    entry.claim(f"misses by pair, {pairs_missed} of {pairs}", pairs_missed / pairs, MISSES)
    entry.claim("largest difference over what is allowed", max(row[3] for row in rows), WORST)


main()
