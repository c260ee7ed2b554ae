"""Formats of records, a file each: how one is recognised, what its header says, how its samples are packed.

A format is recognised by all of its signs or not at all. What has some of them is refused with what is missing, and nothing
is guessed from it; `layout` then reads the numbers alone.
"""

import pathlib
import re

from . import agencies, arrays, cosmos, csmip, fdsn, geonet, peer, smc, tables
from .reading import Column, Format, numeric

FORMATS: tuple[Format, ...] = (peer.FORMAT, cosmos.FORMAT, csmip.FORMAT, geonet.FORMAT, smc.FORMAT, *agencies.FORMATS,
                               *fdsn.FORMATS)
NAMES = ", ".join(["text with columns", *(form.name for form in FORMATS), "SAC", "MiniSEED (by ObsPy)", ".npy", ".mat"])
SPECTRA = re.compile(r"\A.*\bspectr(?:a|um)\b", re.IGNORECASE)
LAYOUTS = ("columns", "rows", "pairs")


def columns_of(path: pathlib.Path, layout: str | None = None, delimiter: str | None = None,
               decimal: str | None = None) -> tuple[str, list[Column]]:
    """Format and columns of a file.

    Raises
    ------
    ValueError
        If it is in none of the formats, or does not hold what its header says.
    """
    if layout not in (None, *LAYOUTS):
        raise ValueError(f"layout = {layout!r}: must be one of {', '.join(LAYOUTS)}")
    data = path.read_bytes()
    if found := arrays.columns_of(path, data):
        return found
    wide = data.startswith((b"\xff\xfe", b"\xfe\xff"))
    text = data.decode("utf-16" if wide else "utf-8-sig", errors="replace").replace("\0", " ")
    lines = re.sub(r"\r*\n|\r", "\n", text).rstrip(" \n\x1a").split("\n")
    if arrays.is_sac(lines):
        return "SAC", [arrays.of_sac(lines)]
    words = "\n".join(line for line in lines if line.strip() and not numeric(line))
    missing = {form: form.missing(words) for form in FORMATS}
    known = next((form for form, lacking in missing.items() if not lacking), None)
    nearest = max(FORMATS, key=lambda form: len(form.signs) - len(missing[form]))
    share = 1 - len(missing[nearest]) / len(nearest.signs)
    try:
        if layout or share < 0.5:
            return "text", tables.columns_of(lines, layout, delimiter, decimal)
        if SPECTRA.search(words):
            raise ValueError("holds spectra, no force or acceleration over time; take the file of the acceleration")
        if not known:
            raise ValueError(f"is no whole file of {nearest.name}, which has {' and '.join(missing[nearest])}")
        if columns := known.read(lines):
            return known.name, [column for column in columns if column.kind == "acceleration"] or columns
        raise ValueError("no samples below its header")
    except (ValueError, IndexError, KeyError, StopIteration) as problem:
        said = str(problem) if isinstance(problem, ValueError) else "its header ends too early"
        if any(word in said for word in ("layout", "spectra", "empty")):
            raise
    if "no numbers" in said and not known:
        said += f"; nearest is {nearest.name}, which has {' and '.join(missing[nearest])}" if share else f"; is none of {NAMES}"
    raise ValueError(f"{f'{known.name}: ' if known and not layout else ''}{said}; fetch it anew, or read its numbers alone: "
                     f"{tables.ways(lines)}")
