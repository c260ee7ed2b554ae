"""Rules that the compiler does not check.

1. A room includes only rooms that come before it; a private header stands beside what reads it.
2. Sources that are compiled once, for both scalar types, see nothing that depends on the type.
3. Every call of PETSc, SLEPc is checked: inside check(...), assigned, returned or cast to void.
4. Functions are short: median at most 8 lines, nine in ten at most 30, none above 60.
5. The sources name neither folders of one machine nor who works on them.
6. Identifiers are the field's: words that have been replaced do not come back.
7. No two rooms have files of one name.
8. No file is longer than 700 lines.
9. What Python files import, they use.
10. What joins text includes the header of it, which older versions of fmt include by another one.
"""

import ast
import pathlib
import re
import statistics
import sys

ROOMS = ("base", "linalg", "model", "case", "generator", "simulation", "quantities", "run", "cli")
LONGEST, LONG, MEDIAN = 60, 30, 8
LONGEST_FILE = 700


def source_files(root, *folders):
    for folder in folders:
        for ending in ("*.hpp", "*.cpp"):
            yield from sorted((root / folder).rglob(ending))


def room_of(path, root):
    parts = path.relative_to(root).parts
    return parts[2] if parts[0] == "include" else parts[1]


def check_order(root):
    for path in source_files(root, "include", "src"):
        own = ROOMS.index(room_of(path, root))
        for line in path.read_text().splitlines():
            found = re.match(r'#include "(?:stickslip|\.\.)/(\w+)/', line)
            if found and ROOMS.index(found.group(1)) > own:
                yield f"{path}: {line} points upwards"
    guide = root / "docs" / "development.md"
    drawn = re.search(r"those to their\nleft:\n\n((?: {4}.+\n)+)", guide.read_text())
    if drawn is None or tuple(re.findall(r"\w+", drawn[1])) != ROOMS:
        yield f"{guide}: the map has another order of rooms"


DEPENDS_ON_SCALARS = re.compile(r"#include <(petsc(vec|mat|ksp|ts)|slepc(?!version)\w*)\.h>"
                                r"|\b(PetscScalar|PetscReal|Vec|Mat|USE_COMPLEX)\b")


def included_headers(path, root):
    for name in re.findall(r'#include "([^"]+)"', path.read_text()):
        for folder in (root / "include", path.parent):
            if (folder / name).exists():  # version.hpp is generated
                yield (folder / name).resolve()


def compiled_once(path, root):
    """Whether the lists of CMake have a source, or a test, among those that see no scalars."""
    tests = path.is_relative_to(root / "tests")
    lists = (root / ("tests" if tests else "") / "CMakeLists.txt").read_text()
    name = str(path.relative_to(root / ("tests" if tests else "src")).with_suffix(""))

    def has(kind):
        patterns = re.search(rf"set\({kind}_{'TESTS' if tests else 'SOURCES'} ([^)]*)\)", lists)[1].split()
        return any(re.fullmatch(pattern.replace("*", "[^/]*"), name) for pattern in patterns)

    return has("PLAIN") or not has("SCALAR")


def check_scalars(root):
    for path in source_files(root, "src", *(f"tests/{room}" for room in ROOMS)):
        if path.suffix == ".hpp" or not compiled_once(path, root):
            continue
        seen, left = {path}, [path]
        while left:
            header = left.pop()
            if DEPENDS_ON_SCALARS.search(without_comments(header.read_text())):
                yield f"{path}: compiled once, and sees the scalar type in {header}"
            new = set(included_headers(header, root)) - seen
            seen |= new
            left += new


def without_comments(text):
    text = re.sub(r"//[^\n]*", "", text)
    return re.sub(r'"(?:[^"\\\n]|\\.)*"', '""', text)


PETSC_CALL = re.compile(r"\b(?:Petsc|Slepc|Vec|Mat|KSP|PC|EPS|ST|IS|TS|BV)[A-Z]\w*\(")
HARMLESS = re.compile(r"(PetscRealPart|PetscImaginaryPart|PetscAbsScalar|PetscObjectComm|PetscConj"
                      r"|PetscDefined|PetscReal|PetscScalar|PetscFailure|PetscOptionsHeadBegin)\($")


def check_petsc_calls(root):
    for path in source_files(root, "include", "src", "tests"):
        text = without_comments(path.read_text())
        for call in PETSC_CALL.finditer(text):
            if HARMLESS.search(call.group(0)):
                continue
            statement = text[max(text.rfind(mark, 0, call.start()) for mark in ";{}") + 1:
                             call.start()]
            if not re.search(r"check\(|=|return|\(void\)|MPI_|auto |const ", statement):
                line = text.count("\n", 0, call.start()) + 1
                yield f"{path}:{line}: {call.group(0)}...) is not checked"


def function_lengths(path):
    """Lines of each block that follows a parameter list at namespace or class level."""
    lines = without_comments(path.read_text()).splitlines()
    start = None
    for number, line in enumerate(lines):
        indent = len(line) - len(line.lstrip())
        opens = re.search(r"\)\s*(const|noexcept|override|->\s*[\w:<>]+|\s)*(:.*)?\{\s*$", line)
        if start is None and opens and indent <= 4:
            head = number
            while head > 0 and not re.search(r"[;{}]\s*$|^\s*$|:\s*$", lines[head - 1]):
                head -= 1
            start, depth = head, len(lines[head]) - len(lines[head].lstrip())
        elif start is not None and line.strip().startswith("}") and indent == depth:
            yield number - start + 1
            start = None


def check_function_lengths(root):
    lengths = []
    for path in source_files(root, "include", "src"):
        for length in function_lengths(path):
            lengths.append(length)
            if length > LONGEST:
                yield f"{path}: a function of {length} lines"
    lengths.sort()
    if statistics.median(lengths) > MEDIAN:
        yield f"median function length {statistics.median(lengths)}"
    if lengths[int(0.9 * len(lengths))] > LONG:
        yield f"nine in ten functions have up to {lengths[int(0.9 * len(lengths))]} lines"


def check_words(root):
    forbidden = re.compile(r"\"/(work|home|root|tmp)/|\bTODO\b|\bFIXME\b")
    for path in source_files(root, "include", "src", "tests"):
        for number, line in enumerate(path.read_text().splitlines(), 1):
            if forbidden.search(line):
                yield f"{path}:{number}: {line.strip()}"


REPLACED = re.compile(r"\b(StationaryLaw|DurationLaw|Laws?|append_law|law_of_level|Ladder|climb|rung|rungs_|Ledger|ledger_?"
                      r"|folded|Rest|RestCoupling|RestChain|rest_coupling_?|(with|has|owner_of)_rest_?|rest_below"
                      r"|(lowest|highest)_rest_|Half|(one|from|of)_half|halves_?|cut_(mass|for_waves)|excess(_at)?|HpAxis"
                      r"|UpwindAxis|Conducted|conduct|kMostCorrections|price(_of_a_digit)?|tell_hang|chance_of_falling"
                      r"|[Ff]oretold|StayFlow|StayDifferences|\w*stays?(_by_tau)?_?|QueuedSlide|SlideTransforms"
                      r"|slide_transforms|HighModes)\b")


def check_vocabulary(root):
    for path in source_files(root, "include", "src", "tests"):
        for number, line in enumerate(without_comments(path.read_text()).splitlines(), 1):
            found = REPLACED.search(line)
            if found:
                yield f"{path}:{number}: {found.group(0)} has another name now"


def check_joins(root):
    for path in source_files(root, "include", "src", "tests"):
        text = path.read_text()
        if "fmt::join(" in text and "#include <fmt/ranges.h>" not in text:
            yield f"{path}: fmt::join needs <fmt/ranges.h>"


def check_files(root):
    rooms = {}
    for path in source_files(root, "include", "src"):
        rooms.setdefault(path.stem, set()).add(room_of(path, root))
        length = len(path.read_text().splitlines())
        if length > LONGEST_FILE:
            yield f"{path}: {length} lines"
    for stem, where in sorted(rooms.items()):
        if len(where) > 1:
            yield f"files named {stem} in {' and '.join(sorted(where))}"


def names_in(annotation):
    """Names in an annotation that is written as text."""
    texts = (node.value for node in ast.walk(annotation) if isinstance(node, ast.Constant) and isinstance(node.value, str))
    return {name for text in texts for name in re.findall(r"\w+", text)}


def check_imports(root):
    for path in sorted(path for folder in ("python", "docs", "tests", "validation") for path in (root / folder).rglob("*.py")):
        nodes = list(ast.walk(ast.parse(path.read_text())))
        used = {node.id for node in nodes if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load)}
        for node in nodes:
            for part in ("annotation", "returns"):
                used |= names_in(getattr(node, part)) if getattr(node, part, None) else set()
            if isinstance(node, ast.Assign) and getattr(node.targets[0], "id", "") == "__all__":
                used |= set(ast.literal_eval(node.value))
        for node in nodes:
            for name in node.names if isinstance(node, ast.Import | ast.ImportFrom) else ():
                if (name.asname or name.name.partition(".")[0]) not in used:
                    yield f"{path}:{node.lineno}: {name.name} is imported and not used"


def main():
    root = pathlib.Path(sys.argv[1]).resolve()
    complaints = [text for rule in (check_order, check_scalars, check_petsc_calls, check_function_lengths,
                                    check_words, check_vocabulary, check_joins, check_files,
                                    check_imports) for text in rule(root)]
    print("\n".join(complaints) or "sources follow the rules")
    sys.exit(1 if complaints else 0)


main()
