"""Hard cases: what breaks naive code, and properties that must hold.

Thresholds meet noise levels, sliding is rarer than 10^-300, time scales lie 24 decades apart, or nothing damps the
velocity. In each case several properties must hold to the digits that the program claims: identities such as the
balance of power, values in extended precision (a program of its own, by Taylor series instead of elements, with 40
digits), other solution methods, and results of neighbouring or rescaled cases. What makes no sense must be refused,
with a reason.

usage: python3 validation/hard/run.py [--quick] [--only WORDS] [--program build/stickslip]
                                      [--report FOLDER]

Cases are in scenes.py, what must hold in properties.py. --only takes cases whose name contains the words.
"""

import pathlib
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from entry import MOST, Entry
from harness import words_of, worse
from properties import BALANCES, FACTOR, PROPERTIES, Found, stored
from scenes import BASE, REFUSED, SCENES


def ratio(row):
    """Of the deviation to what is allowed; a comparison that allows more than MOST of the size fails."""
    _, apart, allowed, size = row
    if allowed > MOST * abs(size or 1):
        return float("inf")
    return apart / allowed if allowed > 0 else (0.0 if apart == 0 else float("inf"))


def worst_of(found, names):
    """The comparison nearest to what is allowed, or beyond it the furthest."""
    rows = [row for name in names for row in PROPERTIES[name](found)]
    return max(rows, key=lambda row: float("inf") if row[1] != row[1] else ratio(row))


def checked(entry, scene):
    """Rows of the table, and the largest ratio of each kind of property."""
    found = Found(entry, scene)
    balances = [name for name in scene.properties if name in BALANCES]
    groups = [("balances", balances)] * bool(balances) + [
        (name, [name]) for name in scene.properties if name not in BALANCES]
    rows, ratios = [], {}
    for kind, names in groups:
        words, apart, allowed, value = row = worst_of(found, names)
        ratios[kind] = ratio(row)
        rows.append((scene.name, scene.why, f"{kind}: {words}", f"{apart / abs(value or 1):.1e}",
                     f"{allowed / abs(value or 1):.1e}", f"{found.seconds():.2f}"))
        if ratios[kind] > 1 or ratios[kind] != ratios[kind]:
            print(f"  beyond: {scene.name}: {words}, {apart:.3e} of {allowed:.3e}", flush=True)
    return rows, ratios, (found.summary["accuracy"]["reached"] or scene.misses
                          or "accuracy" not in found.options)


def refused(entry):
    """Exit status and message of cases that cannot be."""
    rows, wrong = [], 0
    for name, options, status, word in REFUSED:
        words = [str(entry.program.path), *words_of({**BASE, **options})]
        done = subprocess.run(words, capture_output=True, text=True)
        wrong += done.returncode != status or word not in done.stderr
        rows.append((name, str(done.returncode), done.stderr.strip().replace("stickslip: ", "")))
    entry.table("Cases that must be refused, and how they are", ("scene", "exit status", "message"), rows)
    entry.claim("cases that should be refused and are not, or without a reason", wrong, 0.5)


CLAIMS = {"balances": "identities of power, probability, noise, hitting distribution, sticking times",
          "reference": "values in extended precision",
          "by_hand": "sticking times on three levels, by hand",
          "null_vector": "the null vector of the whole generator",
          "lambda_route": "the lambda-problem of the paper",
          "hitting": "hitting times of the paper",
          "fluid_queue": "the fluid queue, which has no grid in v",
          "monte_carlo": "simulation, four standard deviations",
          "scaled": "the same case in units in which tau is 1",
          "neighbour": "mu_d next to a level and on it",
          "near_no_drag": "weak drag and none",
          "finer": "a run to two more digits",
          "transforms": "values, bounds and limits of Laplace transforms",
          "resolvent": "identities of resolvents",
          "spectrum": "sign, area and decay of spectra",
          "direct": "a complex factorisation for each frequency",
          "same": "the case without the small number"}


def main():
    entry = Entry(__doc__, "beyond the paper",
                  ("--only", {"default": "", "metavar": "WORDS", "help": "cases whose name contains these"}))
    only = entry.arguments.only
    table, kinds, missed, count = [], {}, [], 0
    for scene in SCENES:
        if only not in scene.name or (scene.long and entry.quick):
            continue
        rows, ratios, reached = checked(entry, scene)
        table += rows
        count += 1
        for kind, value in ratios.items():
            kinds.setdefault(kind, []).append(value)
        missed += [] if reached else [scene.name]
    entry.text(f"{count} cases. Allowed is {FACTOR} times the error that the program states for what is "
               "compared; both are relative. Of each group the comparison that comes nearest to it is shown.")
    entry.table("What must hold, case by case",
                ("scene", "why hard", "property", "achieved", "allowed", "seconds"), table)
    for kind, values in kinds.items():
        cases = f"{len(values)} case{'s' * (len(values) > 1)}"
        entry.claim(f"{CLAIMS.get(kind, kind)}: deviation over what is allowed, {cases}",
                    worse(*sorted(values, reverse=True)), 1)
    entry.claim(f"cases that missed -accuracy ({'; '.join(missed) or 'none'})", len(missed), 0.5)
    if not only:
        known = stored()
        digits = min(v["digits"] for scene in known.values() for v in scene["values"].values())
        entry.at_least(f"digits in which two computations of the {len(known)} references agree", digits, 17)
        refused(entry)
    entry.end()


main()
