"""One entry of the validation report: a case that prints its tables and verdicts, draws its pictures,
and leaves both in a folder for the report."""

import json
import os
import pathlib
import sys
import tempfile
import time

from harness import Program, Report, parser, significant, worse

MOST = 0.5  # the largest relative deviation that any claim allows


def plots():
    """The pictures of the package; imported where there is something to draw."""
    import matplotlib
    import stickslip.plots.style
    matplotlib.rcParams.update(stickslip.plots.style.LOOK)
    return stickslip.plots


def subplots(*shape, **keywords):
    """A figure in the style of the package, and its axes."""
    sharey = keywords.pop("sharey", False)
    figure = plots().style.Figure(**keywords)
    return figure, figure.subplots(*shape, sharey=sharey)


def about(doc):
    """The paragraphs of a docstring between title and usage."""
    paragraphs = doc.partition("\nusage:")[0].split("\n\n")[1:]
    return [" ".join(paragraph.split()) for paragraph in paragraphs if paragraph.strip()]


class Entry(Report):
    """What `doc` says in its first line is the title; its paragraphs up to the usage say what is compared with what,
    and why that may be believed; `paper` names the figure or table; options of its own are (name, arguments of
    add_argument)."""

    def __init__(self, doc, paper, *more):
        super().__init__()
        options = parser(doc)
        options.add_argument("--report", type=pathlib.Path, metavar="FOLDER",
                             help="leave pictures and entry.json in this folder")
        for name, keywords in more:
            options.add_argument(name, **keywords)
        self.arguments = options.parse_args()
        self.quick = self.arguments.quick
        self.program = Program(self.arguments.program)
        os.environ["STICKSLIP"] = str(self.arguments.program.resolve())  # pictures ask it for symbols and words
        self.scratch = tempfile.TemporaryDirectory()
        self.folder = (self.arguments.report or pathlib.Path(self.scratch.name)).resolve()
        self.folder.mkdir(parents=True, exist_ok=True)
        self.parts = []
        self.head = {"title": doc.splitlines()[0].rstrip("."), "about": about(doc), "paper": paper}
        self.start = time.monotonic()

    def text(self, words):
        print(words)
        self.parts.append({"text": words})

    def table(self, caption, columns, rows):
        """Cells are texts or numbers; a number is shown with six digits. Empty columns are left out."""
        cells = [[cell if isinstance(cell, str) else f"{cell:.6g}" for cell in row] for row in rows]
        filled = [n for n in range(len(columns)) if not cells or any(row[n] for row in cells)]
        columns, *cells = ([row[n] for n in filled] for row in (columns, *cells))
        widths = [max(map(len, column)) for column in zip(columns, *cells)]
        print(f"\n{caption}")
        for row in (columns, *cells):
            print("  " + "  ".join(cell.rjust(width) for cell, width in zip(row, widths)))
        self.parts.append({"caption": caption, "columns": columns, "rows": cells})

    def file(self, name):
        return self.folder / name

    def picture(self, name, caption):
        """`name` is a file in the folder by now."""
        self.parts.append({"picture": name, "caption": caption})

    def figure(self, figure, name, caption):
        figure.savefig(self.file(name))
        self.picture(name, caption)

    def drawn(self, kind, name, caption, *results):
        """A picture of the package."""
        self.figure(plots().KINDS[kind][1](results), name, caption)

    def results(self, **options):
        """Results of one run."""
        return self.program.results(**options)

    def run(self, **options):
        """The summary of one run."""
        return self.program.run(**options)

    def verdict(self, good, text, numbers):
        super().verdict(good, text, numbers)
        self.parts.append({"verdict": "holds" if good else "FAILS", "claim": text,
                           "numbers": numbers})

    def simulated(self, text, known):
        """Claims for values with their errors and simulated results: all agree, and so narrow are the
        intervals that a value off by MOST would have been noticed."""
        allowed = significant(len(known))
        self.claim(f"largest |z| of {text}", worse(*(abs(deviation(*one)) for one in known)), allowed)
        self.claim(f"deviation that goes unnoticed in {text}, relative", worse(*(
            allowed * spread(value, error, estimate) / abs(value)
            for value, error, estimate in known)), MOST)

    def end(self):
        """Writes the entry; exit status 1 if a claim failed."""
        self.head |= {"failed": self.failed, "seconds": time.monotonic() - self.start,
                      "parts": self.parts}
        self.file("entry.json").write_text(json.dumps(self.head, indent=1))
        self.scratch.cleanup()
        sys.exit(1 if self.failed else 0)


def spread(value, error, estimate):
    """Standard deviation of a simulated result on the side of `value`, which has an error of its own."""
    low, high = estimate["ci95"]
    half = high - estimate["value"] if value > estimate["value"] else estimate["value"] - low
    return ((half / 1.96) ** 2 + error**2) ** 0.5


def deviation(value, error, estimate):
    """In standard deviations of a simulated result."""
    sigma = spread(value, error, estimate)
    return (value - estimate["value"]) / sigma if sigma > 0 else 0.0
