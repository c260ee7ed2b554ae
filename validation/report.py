"""Makes the validation report: every figure and table of the paper, and what goes beyond it.

usage: python3 validation/report.py [--quick] [--program build/stickslip] [--cases A,B] [--without A,B]
                                    FOLDER

Runs the cases of validation/, two at a time, and writes FOLDER/index.html with all pictures inside.
--without leaves cases out, as ctest does with those that it runs by themselves; the page names them. Exit
status 1 if a claim failed; the report is written all the same.
"""

import base64
import concurrent.futures
import html
import json
import os
import pathlib
import platform
import subprocess
import sys
import threading
import time

from harness import ROOT, parser

CASES = ("paths", "averages", "points", "spectra", "correlation_time", "laplace", "durations",
         "extrapolation", "limit", "cost", "scan", "effects", "weakening", "noises", "queues", "chains", "slips", "fits",
         "calibration", "combinations", "hard", "faults")  # in the order of the paper
STYLE = """
body { font: 15px/1.5 sans-serif; max-width: 62em; margin: 2em auto; padding: 0 1em; color: #222 }
h2 { margin-top: 2.2em; border-top: 1px solid #ccc; padding-top: 0.8em }
img { max-width: 100% } figcaption, .source { color: #555; font-size: 13px }
table { border-collapse: collapse; font-size: 13px; margin: 0.8em 0 }
th, td { padding: 2px 10px; text-align: right; border-bottom: 1px solid #e4e4e4 }
caption { text-align: left; font-weight: bold; padding-bottom: 4px }
.holds::before { content: "\\2713 "; color: #009e73 } .FAILS { font-weight: bold }
.FAILS::before { content: "\\2717 fails: "; color: #d55e00 } .claims { font-size: 13px }
summary { cursor: pointer }
"""
LONGEST = ("calibration", "combinations", "slips", "hard", "extrapolation")  # they begin first
LONG = 14  # rows of a table that is shown collapsed


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
    words = [sys.executable, str(ROOT / "validation" / case / "run.py"), "--program",
             str(arguments.program), "--report", str(folder)] + ["--quick"] * arguments.quick
    progress.tell(f"{case} begins")
    (folder / "entry.json").unlink(missing_ok=True)
    done = subprocess.run(words, capture_output=True, text=True)
    if (folder / "entry.json").exists():
        entry = json.loads((folder / "entry.json").read_text())
    else:
        entry = {"title": case, "paper": "", "failed": True, "seconds": 0,
                 "parts": [{"text": f"stopped: {(done.stderr or done.stdout)[-2000:]}"}]}
    progress.tell(f"{case} {'FAILS' if entry['failed'] else 'holds'}", ended=True)
    return entry


def escaped(words):
    return html.escape(words, quote=False)


def table_html(part):
    cells = "".join(f"<th>{escaped(c)}</th>" for c in part["columns"])
    rows = "".join("<tr>" + "".join(f"<td>{escaped(c)}</td>" for c in row) + "</tr>"
                   for row in part["rows"])
    table = f"<table><caption>{escaped(part['caption'])}</caption><tr>{cells}</tr>{rows}</table>"
    if len(part["rows"]) <= LONG:
        return table
    return f"<details><summary>{escaped(part['caption'])}</summary>{table}</details>"


def part_html(part, folder):
    if "picture" in part:
        data = base64.b64encode((folder / part["picture"]).read_bytes()).decode()
        return (f'<figure><img alt="{escaped(part["caption"])}" src="data:image/png;base64,{data}">'
                f"<figcaption>{escaped(part['caption'])}</figcaption></figure>")
    if "columns" in part:
        return table_html(part)
    if "claim" in part:
        return (f'<div class="claims {part["verdict"]}">{escaped(part["claim"])}: '
                f"{escaped(part['numbers'])}</div>")
    return f"<p>{escaped(part['text'])}</p>"


def entry_html(case, entry, folder):
    parts = "\n".join(part_html(part, folder) for part in entry["parts"])
    return (f'<h2 id="{case}">{escaped(entry["title"])}</h2>\n<p class="source">{escaped(entry["paper"])}; '
            f"{entry['seconds']:.0f} s; python3 validation/{case}/run.py</p>\n{parts}\n")


def count(entry, verdict):
    return sum(part.get("verdict") == verdict for part in entry["parts"])


def contents_html(entries):
    rows = "".join(
        f'<tr><td style="text-align:left"><a href="#{case}">{escaped(entry["title"])}</a></td>'
        f"<td>{count(entry, 'holds')}</td>"
        # A case that stopped has no verdicts.
        f"<td>{max(count(entry, 'FAILS'), int(entry['failed']))}</td></tr>"
        for case, entry in entries.items())
    return f"<table><tr><th>case</th><th>claims that hold</th><th>that fail</th></tr>{rows}</table>"


def machine(program):
    version = subprocess.run([str(program), "-version"], capture_output=True, text=True).stdout
    return (f"{platform.node()}, {platform.machine()}, {os.cpu_count()} cores, {platform.system()} "
            f"{platform.release()}; {time.strftime('%Y-%m-%d %H:%M UTC', time.gmtime())}\n{version}")


def page(entries, arguments):
    body = "".join(entry_html(case, entry, arguments.folder / case)
                   for case, entry in entries.items())
    form = "The quick form: fewer cases and simulations. " if arguments.quick else ""
    left_out = [case for case in CASES if case not in entries]
    if left_out:
        form += f"Left out: {', '.join(left_out)}. "
    return ("<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
            f"<title>stickslip: validation</title><style>{STYLE}</style></head><body>\n"
            "<h1>stickslip: validation</h1>\n<p>The figures and tables of the paper of Garnier, Lu and "
            "Mertz in their order, with the numbers that it prints beside ours, and what goes beyond. "
            f"{form}Each case runs alone too.</p>\n{contents_html(entries)}"
            f"<pre>{escaped(machine(arguments.program))}</pre>\n{body}</body></html>\n")


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
    part = arguments.folder / "index.html.part"
    part.write_text(page(entries, arguments))
    part.replace(arguments.folder / "index.html")
    print(arguments.folder / "index.html")
    sys.exit(any(entry["failed"] for entry in entries.values()))


main()
