"""Do the tests find planted defects? `run.py [name...] [--list]`; see README.md.

Each defect of defects.toml is planted in a scratch copy of the sources, built and tested: the first
tier of tests, then, if none failed, the second. Prints a table in Markdown; exit status 0 if at
least `--least` of every 30 defects are found.
"""

import argparse
import math
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time
import tomllib

HERE = pathlib.Path(__file__).resolve().parent
SOURCE = HERE.parents[1]
TIERS = (("first", ("-LE", "second")), ("second", ("-L", "second")))
UNTESTED = re.compile(r"build.*|\..*|__pycache__")


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", help="defects to plant; all without names")
    parser.add_argument("--list", action="store_true", help="print the defects and stop")
    parser.add_argument("--jobs", type=int, default=2, help="of the build and of ctest (2)")
    parser.add_argument("--least", type=float, default=28, metavar="N",
                        help="defects of every 30 that must be found (28)")
    parser.add_argument("--timeout", type=int, default=900, metavar="SECONDS",
                        help="for a test that sets no timeout itself (900)")
    parser.add_argument("--skip-unchanged", action="store_true",
                        help="do not test the unchanged sources first")
    parser.add_argument("--scratch", type=pathlib.Path,
                        help="folder for the copy and its build, kept for the next call")
    return parser.parse_args()


def chosen_defects(names):
    """Defects by their names; every `old` must occur exactly once."""
    defects = tomllib.loads((HERE / "defects.toml").read_text())["defect"]
    by_name = {d["name"]: d for d in defects}
    if len(by_name) < len(defects):
        sys.exit("defects.toml: a name occurs twice")
    if unknown := [n for n in names if n not in by_name]:
        sys.exit(f"no such defect: {', '.join(unknown)}; --list prints them")
    for d in defects:
        count = (SOURCE / d["file"]).read_text().count(d["old"])
        if count != 1 or d["old"] == d["new"]:
            sys.exit(f"{d['name']}: `old` occurs {count} times in {d['file']}; it must occur once "
                     "and differ from `new`")
    return [by_name[n] for n in names] or defects


def copy_sources(target):
    """Makes `target` a copy of the sources; files that are equal keep their times."""
    def files(folder):
        for path in sorted(folder.iterdir()):
            if not UNTESTED.fullmatch(path.name):
                yield from files(path) if path.is_dir() else (path,)

    target.mkdir(parents=True, exist_ok=True)
    wanted = {path.relative_to(SOURCE): path for path in files(SOURCE)}
    for path in files(target):
        if path.relative_to(target) not in wanted:
            path.unlink()
    for name, path in wanted.items():
        copy = target / name
        if not copy.exists() or copy.read_bytes() != path.read_bytes():
            copy.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(path, copy)


class Build:
    """A copy of the sources with a build folder of its own."""

    def __init__(self, scratch, options):
        self.source, self.build = scratch, scratch / "build"
        self.options = options
        copy_sources(self.source)
        os.environ.setdefault("CCACHE_BASEDIR", str(scratch))
        launcher = ["-DCMAKE_CXX_COMPILER_LAUNCHER=ccache"] if shutil.which("ccache") else []
        subprocess.run(["cmake", "--log-level=WARNING", "-S", self.source, "-B", self.build, "-G",
                        "Ninja", "-DCMAKE_BUILD_TYPE=Release", *launcher], check=True,
                       stdout=subprocess.DEVNULL)

    def compiles(self):
        made = subprocess.run(["cmake", "--build", self.build, "--parallel",
                               str(self.options.jobs)], capture_output=True, text=True)
        if made.returncode:
            print(made.stdout[-3000:], file=sys.stderr)
        return made.returncode == 0

    def failure(self):
        """Tier, name and kind of the first test that fails, such as Failed or Timeout."""
        for tier, labels in TIERS:
            done = subprocess.run(["ctest", "--test-dir", self.build, "--stop-on-failure",
                                   "--parallel", str(self.options.jobs), "--timeout",
                                   str(self.options.timeout), *labels], capture_output=True,
                                  text=True, errors="replace")
            failed = re.search(r"^\s*\d+ - (.+) \((.+)\)\s*$", done.stdout, re.MULTILINE)
            if failed:
                return tier, failed.group(1), failed.group(2)
            if done.returncode:
                sys.exit(f"ctest: {done.stdout[-2000:]}{done.stderr[-2000:]}")
        return None

    def outcome(self, defect):
        """(tier, test) that finds the defect; tier is `not found` or `invalid` otherwise."""
        file = self.source / defect["file"]
        sound = file.read_text()
        file.write_text(sound.replace(defect["old"], defect["new"]))
        try:
            if not self.compiles():
                return "invalid", "does not compile"
            if not (failed := self.failure()):
                return "not found", ""
            tier, test, kind = failed
            return tier, test + (" (timeout)" if kind == "Timeout" else "")
        finally:
            file.write_text(sound)


def require_sound(build):
    print("building and testing the unchanged sources", flush=True)
    if not build.compiles():
        sys.exit("the unchanged sources do not compile")
    if failed := build.failure():
        sys.exit(f"a test of the unchanged sources fails: {failed[1]} ({failed[2]})")


def plant(defects, build):
    start, outcomes = time.monotonic(), []
    for n, defect in enumerate(defects, 1):
        outcomes.append(build.outcome(defect))
        tier, test = outcomes[-1]
        spent = time.monotonic() - start
        left = spent / n * (len(defects) - n)
        print(f"[{n}/{len(defects)}] {defect['name']}: {tier} {test}; {spent / 60:.1f} min, about "
              f"{left / 60:.1f} min left", flush=True)
    return outcomes


def print_table(defects, outcomes):
    print("\n| defect | file | breaks | tier | found by |\n| --- | --- | --- | --- | --- |")
    for d, (tier, test) in zip(defects, outcomes):
        cells = (d["name"], d["file"], d["breaks"], tier, test)
        print("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")


def main():
    options = arguments()
    defects = chosen_defects(options.names)
    if options.list:
        for d in defects:
            print(f"{d['name']}: {d['file']}: {d['breaks']}")
        return 0
    with tempfile.TemporaryDirectory(prefix="stickslip-mutation-") as temporary:
        build = Build((options.scratch or pathlib.Path(temporary)).resolve(), options)
        if not options.skip_unchanged:
            require_sound(build)
        outcomes = plant(defects, build)
    print_table(defects, outcomes)
    found = sum(tier in ("first", "second") for tier, _ in outcomes)
    least = math.ceil(options.least / 30 * len(defects) - 1e-9)
    print(f"\n{found} of {len(defects)} defects found; {least} are required")
    return 0 if found >= least else 1


if __name__ == "__main__":
    sys.exit(main())
