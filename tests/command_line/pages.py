"""Runs what pages of the manual show, and compares what is printed with what stands there.

    python3 tests/command_line/pages.py [PAGE.md ...]            complaints, with their lines
    python3 tests/command_line/pages.py --write [PAGE.md ...]    renews the outputs and the pictures instead

A block of `sh` or `python` is run in a folder that looks like that of the sources, one after the other; a block of
`text` after it holds what is printed to standard output (printed.py says how closely it has to agree). A block is left
alone where the line before it is <!-- not run: reason -->. Pictures are those of a folder with the name of the page:
the commands of docs/gallery.md make docs/gallery/*.png.
"""

import argparse
import dataclasses
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

import printed

SOURCES = pathlib.Path(__file__).resolve().parents[2]
BINARIES = pathlib.Path(os.environ.get("STICKSLIP_BINARIES", SOURCES / "build"))
PAGES = ("README.md", "docs/tutorial.md", "docs/gallery.md", "docs/output.md", "docs/named_noises.md",
         "docs/displacement_distribution.md", "docs/given_force.md", "docs/recorded_forces.md",
         "docs/slips.md", "docs/spring.md", "docs/starting_points.md", "docs/white_noise.md", "docs/fitting.md",
         "docs/record_to_decision.md", "docs/compared.md", "docs/fragility.md")
MARK = re.compile(r"<!-- not run: \S.* -->")
FENCE = re.compile(r"(```+)\s*(.*)")
PICTURE = re.compile(r"!\[[^\]]*\]\(([^)#:]+\.png)\)")
LARGEST_PICTURE = 200_000  # bytes
ALIKE = 0.03               # mean difference of two pictures of the same, whose times differ
NOTHING_IS_BUILT = """
ensure_packages() { :; }
build() { :; }
case ${1:-} in
  build | test | report | fuzz)
    usage | grep -q "bootstrap $1 " || { say "unknown command $1"; exit 2; }
    exit ;;
esac
"""


@dataclasses.dataclass
class Block:
    """A fenced block: `begin` and `end` are the lines of its text, from 0."""

    language: str
    begin: int
    end: int
    text: str
    marked: bool


def blocks_of(page):
    """The fenced blocks of a page.

    Raises ValueError where a fence does not say what it holds.
    """
    lines, found, n = page.split("\n"), [], 0
    while n < len(lines):
        fence = FENCE.fullmatch(lines[n])
        if fence:
            begin = n + 1
            n = next((m for m in range(begin, len(lines)) if lines[m] == fence[1]), len(lines))
            marked = begin > 1 and bool(MARK.fullmatch(lines[begin - 2]))
            if fence[2] not in ("sh", "python", "text") and not marked:
                raise ValueError(f"line {begin}: a block is sh, python or text, or <!-- not run: reason --> before it")
            found.append(Block(fence[2], begin, n, "".join(line + "\n" for line in lines[begin:n]), marked))
        n += 1
    return found


def steps_of(page):
    """Pairs of a block that is run and the block of its output, or None."""
    found = []
    for block in (block for block in blocks_of(page) if not block.marked):
        if block.language != "text":
            found.append((block, None))
        elif found and found[-1][1] is None:
            found[-1] = (found[-1][0], block)
        else:
            raise ValueError(f"line {block.begin}: text that no command before it prints")
    return found


class Folder:
    """A folder like that of the sources after ./bootstrap build, in which nothing is installed or built."""

    def __init__(self, place):
        self.place = pathlib.Path(place)
        (self.place / "build").mkdir()
        for name in ("stickslip", "stickslip-complex"):
            (self.place / "build" / name).symlink_to(BINARIES / name)
        for name in ("options", "python"):
            (self.place / name).symlink_to(SOURCES / name)
        script = (SOURCES / "bootstrap").read_text()
        head, begin, rest = script.partition("\ncommand=")
        (self.place / "bootstrap").write_text(head + NOTHING_IS_BUILT + begin + rest)
        (self.place / "bootstrap").chmod(0o755)
        commands = self.place / ".commands"  # python3 is the one with the modules, not the first one in PATH
        commands.mkdir()
        (commands / "python3").symlink_to(sys.executable)
        self.environment = {**os.environ, "PATH": f"{commands}:{os.environ['PATH']}", "PYTHONDONTWRITEBYTECODE": "1",
                            "STICKSLIP": str(BINARIES / "stickslip")}

    def run(self, block):
        """The finished process of a block."""
        python = block.language == "python"
        command = [sys.executable, "-c"] if python else ["bash", "-euo", "pipefail", "-c"]
        environment = {**self.environment, "PYTHONPATH": "python"} if python else self.environment
        return subprocess.run([*command, block.text], cwd=self.place, env=environment, capture_output=True, text=True,
                              timeout=600)


def pictures_of(name, page):
    """Pictures of the page in the folder of its name: where they are, and their names."""
    own = (SOURCES / name).with_suffix("")
    for link in PICTURE.findall(page):
        place = (SOURCES / name).parent / link
        yield place, place.name if place.parent == own else None


def difference_of(one, other):
    """Mean difference of two pictures, whose points are from 0 to 1."""
    import matplotlib.image
    one, other = (matplotlib.image.imread(picture) for picture in (one, other))
    return abs(one - other).mean() if one.shape == other.shape else 1


def picture_complaints(name, page, folder):
    for place, own in pictures_of(name, page):
        if not place.is_file():
            yield f"{name}: {place.name} is not there"
        elif own and not (folder / own).is_file():
            yield f"{name}: {own} is made by no command"
        elif own and difference_of(place, folder / own) > ALIKE:
            yield f"{name}: {own} looks otherwise"
        elif own and place.stat().st_size > LARGEST_PICTURE:
            yield f"{name}: {own} has {place.stat().st_size} bytes"


def outputs_of(page, folder):
    """Steps of a page with what they print, as they are run."""
    for block, expected in steps_of(page):
        done = folder.run(block)
        if done.returncode != 0:
            raise ValueError(f"line {block.begin + 1}: exit status {done.returncode}\n{done.stderr}")
        yield block, expected, done.stdout


def complaints_about(name, folder):
    """What a page has otherwise than its commands, in sentences."""
    page = (SOURCES / name).read_text()
    try:
        for _, expected, output in outputs_of(page, Folder(folder)):
            if expected:
                for what in printed.differences(expected.text, output):
                    yield f"{name}:{expected.begin + 1}: {what}"
    except ValueError as problem:
        yield f"{name}, {problem}"
        return
    yield from picture_complaints(name, page, pathlib.Path(folder))


def renewal_of(name, folder):
    """Writes the outputs and pictures of a page that changed; complaints if a command fails."""
    page = (SOURCES / name).read_text()
    lines = page.split("\n")
    try:
        outputs = list(outputs_of(page, Folder(folder)))
    except ValueError as problem:
        return [f"{name}, {problem}"]
    for _, expected, output in reversed(outputs):
        if expected:
            lines[expected.begin:expected.end] = printed.renewed(expected.text, output).rstrip("\n").split("\n")
    (SOURCES / name).write_text("\n".join(lines))
    for place, own in pictures_of(name, page):
        made = pathlib.Path(folder) / (own or "")
        if own and made.is_file() and not (place.is_file() and difference_of(place, made) == 0):
            place.parent.mkdir(exist_ok=True)
            shutil.copy(made, place)
    return []


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pages", nargs="*", default=PAGES, metavar="PAGE.md")
    parser.add_argument("--write", action="store_true", help="renew outputs and pictures")
    arguments = parser.parse_args()
    failed = False
    for name in arguments.pages:
        with tempfile.TemporaryDirectory() as folder:
            for what in (renewal_of if arguments.write else complaints_about)(name, folder):
                failed = True
                print(what)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
