"""Rules of the texts: pages, options files, docstrings, comments and messages.

1. Words of our own do not stand where the field has words (PHRASES).
2. A page of docs/ has at most 250 lines, options.md aside; README.md has at most 70.
3. A line of prose has at most 120 characters, tables, code and generated pages aside.
4. A cell of a table has at most 300 characters.
5. Relative links lead to files and headings that exist, and no text names a page that does not exist.

usage: python3 prose.py FOLDER
"""

import ast
import io
import pathlib
import re
import sys
import tokenize

LONGEST_PAGE, LONGEST_README, LONGEST_LINE, LONGEST_CELL = 250, 70, 120, 300
GENERATED = ("docs/options.md",)
HISTORY = ("CHANGELOG.md",)  # speaks of what was

# Regular expression, and what to write instead. A blank stands for any gap, a line's end included.
PHRASES = (
    (r"stationary laws?|stationarylaw", "stationary distribution"),
    (r"entry laws?", "hitting distribution at the onset of sticking"),
    (r"(?<!drag\s)(?<!friction\s)(?<!force\s)laws? of (?!motion|drag|friction|force|large numbers)", "distribution of"),
    (r"(?:binomial|normal|exponential|beta|closed|duration) laws?", "... distribution"),
    (r"(?:a|the|mean|each|every|long|short|shortest|exact|of) stay(?= |s? of|[.,;:)])", "sticking phase, sticking time"),
    (r"(?:mean|long|short|shortest|exact|of|all) stays", "sticking phases, sticking times"),
    (r"(?:a|the|mean|each|every|one|next|first|long|rare|of|between) slides?", "sliding phase"),
    (r"(?:velocity|v) cuts?|cuts? of the (?:velocity|axis)", "truncation velocity"),
    (r"(?:velocity|hp|upwind) ax[ei]s", "velocity discretisation"),
    (r"half lines?", "velocity branch"),
    (r"rungs?", "refinement level"),
    (r"ladders?", "refinement sequence"),
    (r"eliminations? by levels", "block-tridiagonal LU along the noise"),
    (r"shells? (?:\{|of levels|i and -i)|(?:noise|level) shells?", "level pair"),
    (r"nested (?:discretisations?|steps?|refinements?)", "two-level p-correction"),
    (r"(?:un)?folded|folding", "symmetry-reduced"),
    (r"ledgers?", "solver statistics"),
    (r"conduct(?:s|ed|ing)?", "run"),
    (r"sweep records?|records? of (?:a|the) sweep", "sweep checkpoint"),
    (r"fore(?:told|tells?|telling)", "predicted, predict"),
    (r"h(?:olds?|eld|olding) (?:\w+ )?against", "compare with"),
    (r"(?:is|are|was|were|be|being) told(?! apart)", "reported, printed"),
    (r"go(?:es)? on (?:where|from where)", "resume"),
    (r"deal(?:s|t|ing)? out", "distribute"),
    (r"95 ?% (?!confidence)(?:\w+ )?intervals?", "95 % confidence interval"),
    (r"in the middle(?! of| between)", "median"),
    (r"prices? of|at (?:the|a) price", "cost"),
    (r"twins?", "build variant"),
    (r"plain(?:,? and| or|,) transposed|plain solves?", "forward (solve)"),
    (r"last correction", "iterative refinement"),
    (r"chance_of_falling|high_?modes", "(the new name)"))
PATTERNS = [(re.compile(rf"(?<![\w`-])(?:{phrase})(?![\w`-])".replace(" ", r"\s+"), re.IGNORECASE), instead)
            for phrase, instead in PHRASES]


class Text:
    """Lines of prose of a file, by number; gaps are empty."""

    def __init__(self, path, lines):
        self.path, self.lines = path, lines

    @property
    def text(self):
        return "\n".join(self.lines)

    def line_at(self, offset):
        return self.text.count("\n", 0, offset) + 1


def pages(root):
    """README.md, CONTRIBUTING.md, docs/ and the README files elsewhere, without build folders."""
    found = [root / "README.md", root / "CONTRIBUTING.md", *sorted((root / "docs").glob("*.md"))]
    found += [p for p in sorted(root.rglob("README.md")) if p not in found and not is_built(p, root)]
    return [p for p in found if p.is_file() and p.relative_to(root).as_posix() not in HISTORY]


def is_built(path, root):
    return any(part.startswith((".", "build", "_")) for part in path.relative_to(root).parts[:-1])


def comments_and_strings(source):
    """Lines with the comments and string literals of C++ alone; a literal that goes on has no gap."""
    kept = []
    for line in source.splitlines():
        parts = re.findall(r'"(?:[^"\\]|\\.)*"|//.*', line)
        kept.append(" | ".join(re.sub(r'^(//[/<!]*|")|"$', "", part).replace("\\n", " ") for part in parts))
    return kept


def python_texts(source):
    """Lines with the comments and string literals of Python alone."""
    lines = [""] * (source.count("\n") + 2)
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        text = token.string
        if token.type == tokenize.STRING:
            try:
                value = ast.literal_eval(text)
            except (ValueError, SyntaxError):  # with braces: as it stands
                value = text
            if isinstance(value, bytes):
                continue
            text = value if '"""' in text else value.replace("\n", " ")
        elif token.type != tokenize.COMMENT:
            continue
        for n, part in enumerate(text.split("\n"), token.start[0] - 1):
            lines[n] += (" | " if lines[n] else "") + part.lstrip("#")
    return lines


def texts(root):
    for path in pages(root):
        yield Text(path, path.read_text().splitlines())
    for path in sorted((root / "options").rglob("*.opts")):
        yield Text(path, [line.partition("#")[2] for line in path.read_text().splitlines()])
    for folder in ("python", "validation", "tests"):
        for path in sorted((root / folder).rglob("*.py")):
            if path.parent.name != "lint" and not is_built(path, root):
                yield Text(path, python_texts(path.read_text()))
    for folder in ("include", "src", "tests"):
        for ending in ("*.hpp", "*.cpp"):
            for path in sorted((root / folder).rglob(ending)):
                yield Text(path, comments_and_strings(path.read_text()))


def check_phrases(root):
    for text in texts(root):
        for pattern, instead in PATTERNS:
            for found in pattern.finditer(text.text):
                words = " ".join(found.group(0).split())
                yield f"{text.path}:{text.line_at(found.start())}: \"{words}\": write {instead}"


def prose(page):
    """Number and text of the lines that are neither code nor table."""
    fenced = False
    for number, line in enumerate(page.read_text().splitlines(), 1):
        if line.lstrip().startswith(("```", "~~~")):
            fenced = not fenced
        elif not fenced and not line.startswith("    "):
            yield number, line


def check_lengths(root):
    for page in pages(root):
        name = page.relative_to(root).as_posix()
        lines = len(page.read_text().splitlines())
        most = LONGEST_README if name == "README.md" else LONGEST_PAGE
        if name not in GENERATED and (name == "README.md" or page.parent == root / "docs") and lines > most:
            yield f"{page}: {lines} lines: at most {most}, split or shorten it"
        for number, line in prose(page):
            if line.lstrip().startswith("|"):
                widest = max(map(len, re.split(r"(?<!\\)\|", line)))
                if widest > LONGEST_CELL and name not in GENERATED:
                    yield f"{page}:{number}: a cell of {widest} characters: at most {LONGEST_CELL}, write prose below"
            elif len(line) > LONGEST_LINE and name not in GENERATED and not re.match(r"\s*(!?\[[^]]*\]\([^)]*\)|<)", line):
                yield f"{page}:{number}: {len(line)} characters: at most {LONGEST_LINE}, wrap the line"


def headings(page):
    """Anchors of a page's headings."""
    for _, line in prose(page):
        if line.startswith("#"):
            title = re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", line.lstrip("#").strip()).lower()
            yield re.sub(r"[^\w\- ]", "", title).replace(" ", "-")


def check_links(root):
    for page in pages(root):
        for number, line in prose(page):
            for target in re.findall(r"\]\(([^)\s]+)[^)]*\)", re.sub(r"`[^`]*`", "``", line)):
                if re.match(r"[a-z]+:", target):
                    continue
                name, _, anchor = target.partition("#")
                place = page.parent / name if name else page
                if not place.exists():
                    yield f"{page}:{number}: {target} leads nowhere: correct or remove the link"
                elif anchor and place.suffix == ".md" and anchor not in headings(place):
                    yield f"{page}:{number}: {target}: the page has no such heading"


def check_names(root):
    """Pages that texts name, with docs/ before them anywhere, by their names alone on pages."""
    existing = {p.name for p in (*root.glob("*.md"), *(root / "docs").glob("*.md"))}
    for text in texts(root):
        for found in re.finditer(r"(?<![\w/])docs/([\w.-]+\.(?:md|png|svg))\b", text.text):
            if not (root / "docs" / found.group(1)).is_file():
                yield f"{text.path}:{text.line_at(found.start())}: {found.group(0)} does not exist: name another page"
        if text.path.suffix == ".md":  # links have a rule of their own
            for found in re.finditer(r"\[[^]]*\]\([^)]*\)|(?<![\w/.-])([\w-]+\.md)\b", text.text):
                if found.group(1) and found.group(1) not in existing:
                    yield f"{text.path}:{text.line_at(found.start())}: {found.group(1)} does not exist: name another page"


def main():
    root = pathlib.Path(sys.argv[1]).resolve()
    complaints = [text for rule in (check_phrases, check_lengths, check_links, check_names) for text in rule(root)]
    print("\n".join(complaints) or "texts follow the rules")
    sys.exit(1 if complaints else 0)


main()
