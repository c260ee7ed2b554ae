"""Makes the validation report: every figure and table of the paper, and what goes beyond it.

usage: python3 validation/report.py [--quick] [--program build/stickslip] [--cases A,B] [--without A,B]
                                    FOLDER

Runs the cases of validation/, two at a time, and writes FOLDER/index.html, from which pages of all entries are
reached. --without leaves cases out, as ctest does with those that it runs by themselves; the page names them. Exit
status 1 if a claim failed; the report is written all the same.
"""

import concurrent.futures
import json
import os
import pathlib
import platform
import subprocess
import sys
import threading
import time

import pages
from harness import ROOT, parser, script

CASES = ("paths", "averages", "points", "spectra", "correlation_time", "laplace", "durations",
         "extrapolation", "limit", "cost", "scan", "effects", "weakening", "noises", "queues", "slips",
         "displacements", "fits", "calibration", "metamorphic", "hard", "faults")  # in the order of the paper
LONGEST = ("displacements", "fits", "noises", "calibration", "metamorphic", "slips", "hard",
           "extrapolation")  # they begin first


class Progress:
    """A line whenever a case begins or ends."""

    def __init__(self, count):
        self.count, self.done, self.start, self.lock = count, 0, time.monotonic(), threading.Lock()

    def tell(self, words, ended=False):
        with self.lock:
            self.done += ended
            seconds = time.monotonic() - self.start
            print(f"report: {self.done} of {self.count} done, {seconds:.0f} s: {words}",
                  file=sys.stderr, flush=True)


def made(case, arguments, progress):
    """Runs a case; its entry."""
    folder = arguments.folder / case
    file, *name = script(case)
    words = [sys.executable, str(ROOT / file), *name, "--program", str(arguments.program), "--report", str(folder),
             *["--quick"] * arguments.quick]
    progress.tell(f"{case} begins")
    (folder / "entry.json").unlink(missing_ok=True)
    done = subprocess.run(words, capture_output=True, text=True)
    if (folder / "entry.json").exists():
        entry = json.loads((folder / "entry.json").read_text())
    else:
        entry = {"title": case, "paper": "", "failed": True, "seconds": 0,
                 "parts": [{"text": "The case stopped:"}, {"printed": (done.stderr or done.stdout)[-2000:]}]}
    progress.tell(f"{case} {'FAILS' if entry['failed'] else 'holds'}", ended=True)
    return entry


def machine(program):
    version = subprocess.run([str(program), "-version"], capture_output=True, text=True).stdout
    return (f"{platform.node()}, {platform.machine()}, {os.cpu_count()} cores, {platform.system()} "
            f"{platform.release()}; {time.strftime('%Y-%m-%d %H:%M UTC', time.gmtime())}\n{version}")


def note(cases, quick):
    """What the first page says of the form of the report."""
    left_out = [case for case in CASES if case not in cases]
    return (("The quick form: fewer cases and simulations. " if quick else "")
            + (f"Left out: {', '.join(left_out)}. " if left_out else "") + "Each entry runs alone too.")


def main():
    options = parser(__doc__)
    options.add_argument("--cases", default=",".join(CASES), help="a comma list of them")
    options.add_argument("--without", default="", help="a comma list of those to leave out")
    options.add_argument("folder", type=pathlib.Path)
    arguments = options.parse_args()
    cases, without = (words.split(",") for words in (arguments.cases, arguments.without))
    unknown = sorted({*cases, *without} - {*CASES, ""})
    if unknown:
        options.error(f"no case {', '.join(unknown)}; there are {', '.join(CASES)}")
    cases = [case for case in CASES if case in cases and case not in without]
    arguments.program = arguments.program.resolve()
    arguments.folder.mkdir(parents=True, exist_ok=True)
    duration = "four minutes" if arguments.quick else "about an hour"
    print(f"report: {len(cases)} entries; all {len(CASES)} take {duration} on two idle cores",
          file=sys.stderr, flush=True)
    progress = Progress(len(cases))
    # The longest first, so that no core waits for one of them at the end; timings last and alone.
    order = sorted(cases, key=lambda case: LONGEST.index(case) if case in LONGEST else len(LONGEST))
    with concurrent.futures.ThreadPoolExecutor(max_workers=min(2, os.cpu_count() or 1)) as pool:
        made_by = {case: pool.submit(made, case, arguments, progress)
                   for case in order if case != "cost"}
        entries = {case: future.result() for case, future in made_by.items()}
    if "cost" in cases:
        entries["cost"] = made("cost", arguments, progress)
    entries = {case: entries[case] for case in cases}
    pages.write(entries, arguments.folder, note(cases, arguments.quick), machine(arguments.program), arguments.quick)
    print(arguments.folder / "index.html")
    sys.exit(any(entry["failed"] for entry in entries.values()))


if __name__ == "__main__":
    main()
