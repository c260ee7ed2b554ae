"""Recomputes values.json: compiles reference.cpp, runs it for every case with the property "reference".

usage: python3 validation/hard/reference/make.py [--compiler c++] [--only WORDS] [--missing] [--jobs 1]

Each case is computed twice, in 60 digits with series that reach half their radius and in 50 digits
with series that reach 0.4 of it: other pieces, other lengths, other rounding. The digits on which the two
agree are stored with the value.
"""

import argparse
import concurrent.futures
import decimal
import json
import math
import pathlib
import subprocess
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from reference_arguments import arguments, words
from scenes import SCENES

RUNS = ((60, "0.5"), (50, "0.4"))


def computed(program, scene, share):
    scene_words, asked = arguments(scene)
    line = [str(program), *map(str, scene_words), share, *asked]
    done = subprocess.run(line, capture_output=True, text=True, check=True)
    return dict(line.split() for line in done.stdout.splitlines())


def agreeing(a, b):
    """Digits that two texts have in common; None where the value is zero by symmetry."""
    a, b = decimal.Decimal(a), decimal.Decimal(b)
    if abs(a) < decimal.Decimal("1e-40") and abs(b) < decimal.Decimal("1e-40"):
        return None
    return 40 if a == b else max(0, min(40, math.floor(-float((abs(a - b) / abs(a)).log10()))))


def reference(programs, scene):
    start = time.monotonic()
    first, second = (computed(programs[digits], scene, share) for digits, share in RUNS)
    values = {key: {"value": text, "digits": agreeing(text, second[key])}
              for key, text in first.items() if agreeing(text, second[key]) is not None}
    worst = min(v["digits"] for v in values.values())
    print(f"{scene.name}: {len(values)} values, at least {worst} digits, "
          f"{time.monotonic() - start:.0f} s", flush=True)
    return {"arguments": words(scene), "values": values}


def main():
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("--compiler", default="c++")
    options.add_argument("--only", default="", help="cases whose name contains this")
    options.add_argument("--missing", action="store_true",
                         help="only cases without values, or with values of other options")
    options.add_argument("--jobs", type=int, default=1)
    given = options.parse_args()
    target = HERE / "values.json"
    table = json.loads(target.read_text()) if target.exists() else {}
    wanted = [s for s in SCENES if "reference" in s.properties and given.only in s.name
              and not (given.missing and table.get(s.name, {}).get("arguments") == words(s))]
    with tempfile.TemporaryDirectory() as folder:
        programs = {}
        for digits, _ in RUNS:
            programs[digits] = pathlib.Path(folder) / f"reference{digits}"
            subprocess.run([given.compiler, "-O2", "-std=c++17", f"-DDIGITS={digits}", "-o",
                            str(programs[digits]), str(HERE / "reference.cpp")], check=True)
        with concurrent.futures.ThreadPoolExecutor(given.jobs) as pool:
            for scene, found in zip(wanted, pool.map(lambda s: reference(programs, s), wanted)):
                table[scene.name] = found
                target.write_text(json.dumps(table, indent=1) + "\n")


main()
