"""Pages of the validation report: the first with a table of contents, and one for each entry.

FOLDER/index.html and FOLDER/<case>/index.html, beside which lie the entry's pictures and numbers. They are plain HTML
with formulas in MathML: they need neither scripts nor a network, and lead from one to the next.
"""

import html
import pathlib
import re
import shutil
import struct

from formulas import html_of
from harness import script

STYLE = pathlib.Path(__file__).with_name("report.css")
NUMBER = re.compile(r"|N(?:/N)?|\[N, N\]".replace("N", r"[-+]?\d[\d.]*(?:e[-+]?\d+)?"))  # a fraction, an interval
DOTS_PER_PIXEL = 1.6  # pictures have 200 dots an inch: at this size their letters are as large as those of the text

MODEL = """<p>A body on a rough floor is pushed by a random force <math><mi>X</mi></math> with the correlation time
<math><mi>τ</mi></math>. Its velocity <math><mi>V</mi></math> obeys</p>
<p class="equation"><math displaystyle="true"><mfrac><mrow><mi>d</mi><mi>V</mi></mrow><mrow><mi>d</mi><mi>t</mi></mrow>
</mfrac><mo>=</mo><mi>X</mi><mo>+</mo><mi>b</mi><mo>(</mo><mi>V</mi><mo>)</mo><mo>−</mo><msub><mi>μ</mi><mi>d</mi>
</msub><mspace width="0.2em"/><mi>sign</mi><mo>(</mo><mi>V</mi><mo>)</mo></math> while it slides,</p>
<p class="equation"><math><mi>V</mi><mo>=</mo><mn>0</mn></math> while it sticks, as long as <math><mo>|</mo><mi>X</mi>
<mo>|</mo><mo>≤</mo><msub><mi>μ</mi><mi>s</mi></msub></math>.</p>
"""
INTRODUCTION = (
    "The force X jumps between levels that lie delta apart, so (X, V) is a piecewise deterministic Markov process: the "
    "model of Garnier, Lu and Mertz, called the paper on these pages. The program solves the Kolmogorov and "
    "Fokker-Planck equations of the process, without simulation, and states an error with every result.",
    "No method vouches for itself here. Each entry compares results with something that they were not made from: "
    "closed forms, other equations for the same quantity, simulation, digits that others have printed, solutions in "
    "extended precision. It says what is compared with what, states claims with their verdicts, and shows the numbers. A claim "
    "holds if the largest deviation found is within a tolerance that stands in the script of the entry. Both are "
    "shown.")
TERMS = (
    ("deterministic, computed", "Results of the program by the equations above."),
    ("simulated", "Results of the program by drawing paths at random, with 95 % confidence intervals. Simulation takes "
     "the model alone, and none of these equations."),
    ("z", "Distance of a simulated value from the computed one in standard deviations. The bound on the largest |z| is "
     "one that right values exceed in about one of a thousand reports."),
    ("deviation that goes unnoticed", "How far a computed value could be off, relative to its size, without the "
     "simulation showing it. It says how much the agreement is worth."),
    ("relative", "A deviation divided by the value that it is compared with."),
    ("hp, upwind", "The two discretisations of the velocity: elements of high degree, which the program takes by "
     "default, and the differences of the paper with p points for each noise step."),
    ("names with an underscore", "Keys of results, such as mean_slide, the mean duration of sliding phases. "
     "docs/quantities.md defines all of them."))


def element(name, *content, **attributes):
    """An element of HTML; attributes with a trailing underscore are words of Python."""
    words = "".join(f' {key.rstrip("_")}="{html.escape(str(value))}"' for key, value in attributes.items())
    return f"<{name}{words}>{''.join(content)}</{name}>"


def page(title, depth, *body):
    """A whole page; `depth` folders below that of the report."""
    head = ('<meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">'
            f'<link rel="stylesheet" href="{"../" * depth}{STYLE.name}">' + element("title", html.escape(title)))
    body = "\n".join(body)
    return f'<!DOCTYPE html>\n<html lang="en">{element("head", head)}\n<body>\n{body}\n</body></html>\n'


def table(columns, rows, caption=None, classes=None):
    """Cells are HTML; columns of numbers stand to the right."""
    kinds = classes or [None] * len(columns)

    def cells(name, row, **more):
        return element("tr", *(element(name, cell, **({"class_": kind} if kind else {}), **more)
                               for cell, kind in zip(row, kinds)))

    whole = element("div", element("table", element("thead", cells("th", columns, scope="col")),
                                   element("tbody", *(cells("td", row) for row in rows))), class_="wide")
    return element("figure", element("figcaption", caption), whole) if caption else whole


def verdict(good):
    return element("span", "✓ holds" if good else "✗ fails", class_="holds" if good else "FAILS")


def count(entry, word):
    return sum(part.get("verdict") == word for part in entry["parts"])


def failures(entry):
    """An entry that stopped has no verdicts."""
    return max(count(entry, "FAILS"), int(entry["failed"]))


def size(picture):
    """Width and height of a PNG file, from its header."""
    return struct.unpack(">II", picture.read_bytes()[16:24])


def figure(part, number, folder):
    width, height = (round(length / DOTS_PER_PIXEL) for length in size(folder / part["picture"]))
    image = f'<img src="{part["picture"]}" alt="{html.escape(part["caption"])}" width="{width}" height="{height}">'
    return element("figure", element("a", image, href=part["picture"]),
                   element("figcaption", element("b", f"Figure {number}."), html_of(part["caption"])))


def numbers(part, number):
    kinds = ["number" if all(map(NUMBER.fullmatch, cells)) else None for cells in zip(*part["rows"])]
    return table(map(html_of, part["columns"]), (map(html_of, row) for row in part["rows"]),
                 element("b", f"Table {number}.") + html_of(part["caption"]), kinds or [None] * len(part["columns"]))


def claims(entry):
    """The claims of an entry in a table."""
    rows = [(verdict(part["verdict"] == "holds"), html_of(part["claim"]), html_of(part["numbers"]))
            for part in entry["parts"] if "claim" in part]
    return element("h2", "Claims") + table(("verdict", "claim", "found"), rows, classes=(None, None, "found")) if rows else ""


def shown(entry, folder):
    """Texts, tables and pictures in their order."""
    counted, found = {"columns": 0, "picture": 0}, []
    for part in entry["parts"]:
        kind = next((kind for kind in counted if kind in part), None)
        if kind:
            counted[kind] += 1
        if kind == "picture":
            found.append(figure(part, counted[kind], folder))
        elif kind == "columns":
            found.append(numbers(part, counted[kind]))
        elif "printed" in part:
            found.append(element("pre", html.escape(part["printed"])))
        elif "text" in part:
            found.append(element("p", html_of(part["text"])))
    return element("h2", "Tables and figures") + "\n".join(found) if found else ""


def links(titles, case):
    """To the entries before and after, and to the first page."""
    names = list(titles)
    n = names.index(case)
    before, after = (f'<a href="../{name}/index.html" rel="{way}">{arrow.format(html_of(titles[name]))}</a>'
                     if name else "<span></span>" for name, way, arrow in (
                         (names[n - 1] if n else None, "prev", "← {}"),
                         (names[n + 1] if n + 1 < len(names) else None, "next", "{} →")))
    return element("nav", before, '<a href="../index.html">Contents</a>', after)


def entry_page(case, entry, titles, folder, quick):
    files = " · ".join(element("a", path.name, href=path.name) for path in sorted(folder.iterdir())
                       if path.suffix in (".json", ".csv"))
    facts = [f"In the paper: {html_of(entry['paper'])}."] if entry["paper"] and "beyond" not in entry["paper"] else []
    command = element("code", f"python3 {' '.join(script(case))}{' --quick' * quick}")
    facts += [f"Claims: {count(entry, 'holds')} hold, {failures(entry)} fail.",
              f"Made in {entry['seconds']:.0f} s by {command}", f"Numbers: {files or 'none'}"]
    way = links(titles, case)
    return page(
        f"{entry['title']} - stickslip", 1, way, element(
            "main", element("h1", html_of(entry["title"])),
            element("p", *(element("span", fact) for fact in facts), class_="facts"),
            element("h2", "What is compared, and why it may be believed"),
            *(element("p", html_of(text)) for text in entry.get("about", ())), claims(entry),
            shown(entry, folder)), way)


def contents(entries):
    rows = [(verdict(not entry["failed"]), f'<a href="{case}/index.html">{html_of(entry["title"])}</a> '
             + element("small", html_of(entry["paper"])), str(count(entry, "holds")), str(failures(entry)),
             f"{entry['seconds']:.0f} s") for case, entry in entries.items()]
    return table(("status", "entry, and where it is in the paper", "hold", "fail", "time"), rows,
                 "Entries with the numbers of their claims that hold and that fail, and the time that each took",
                 (None, None, "number", "number", "number"))


def first_page(entries, note, machine):
    failed = sum(failures(entry) > 0 for entry in entries.values())
    result = (f"{failed} of {len(entries)} entries fail." if failed else f"All {len(entries)} entries hold: "
              f"{sum(count(entry, 'holds') for entry in entries.values())} claims.")
    return page(
        "stickslip: validation", 0, element(
            "main", element("h1", "stickslip: validation"),
            element("p", element("strong", result, class_="FAILS" if failed else "holds"), f" {note}"),
            element("h2", "Contents"), contents(entries),
            element("h2", "What is validated, and how"), MODEL, *(element("p", html_of(text)) for text in INTRODUCTION),
            element("h2", "Terms"), element("dl", *(
                element("dt", html_of(term)) + element("dd", html_of(words)) for term, words in TERMS)),
            element("h2", "Machine"), element("pre", html.escape(machine))))


def write(entries, folder, note, machine, quick):
    """Writes all pages of `entries`, by case; the first page last, once all that it leads to is there."""
    titles = {case: entry["title"] for case, entry in entries.items()}
    shutil.copy(STYLE, folder / STYLE.name)
    for case, entry in entries.items():
        (folder / case).mkdir(exist_ok=True)
        (folder / case / "index.html").write_text(entry_page(case, entry, titles, folder / case, quick))
    part = folder / "index.html.part"
    part.write_text(first_page(entries, note, machine))
    part.replace(folder / "index.html")
