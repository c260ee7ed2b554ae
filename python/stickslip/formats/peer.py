"""AT2, VT2, DT2 of PEER (Pacific Earthquake Engineering Research Center): four lines of text, samples in rows.

One of the lines has NPTS and DT [s], another the quantity and its unit: ACCELERATION TIME SERIES IN UNITS OF G.
"""

import re

from ..units import in_si, kind_of
from .reading import NUMBER, Column, Format, counted, kind_in, numbers

TEXT = 5  # lines that may have the header
UNITS = [re.compile(pattern, re.IGNORECASE) for pattern in (
    r"\bunits?\b(?:\s+(?:of|are|is|in))*[\s:=]+\(?\s*([a-z%][\w/^*%.-]*)", r"\bin\s+(\S+)\s+units",
    r"\b(?:acc|vel|dis)\w*.*\bin\s+(\S+)", r"[(\[]\s*(\S+)\s*[)\]]")]


def _read(lines: list[str]) -> list[Column]:
    at = next(n for n, line in enumerate(lines) if "NPTS" in line.upper())
    stated = {name: re.search(pattern, lines[at], re.IGNORECASE) for name, pattern in (
        ("NPTS", r"NPTS\s*[=:]\s*(\d+)"), ("DT", rf"DT\s*[=:]\s*({NUMBER})\s*([a-z]*)"))}
    plain = re.match(rf"\s*(\d+)\s+({NUMBER})", lines[at])  # older files: 5366 0.0100 NPTS, DT
    if not (stated["NPTS"] or plain):
        raise ValueError(f"line {at + 1}: {lines[at].strip()}: needs NPTS= and DT=, such as NPTS= 5366, DT= .01 SEC")
    count = int((stated["NPTS"] or plain)[1])
    step = float(stated["DT"][1]) if stated["DT"] else float(plain[2]) if plain else None
    if stated["DT"] and kind_of(stated["DT"][2]) == "time":
        step *= in_si(stated["DT"][2])[0]
    found = [(line, match[1].rstrip(".,-")) for pattern in UNITS for line in lines[:at] if (match := pattern.search(line))]
    said, unit = next(((line, unit) for line, unit in found if kind_of(unit)), ("", ""))
    kind = kind_in(said) or kind_of(unit) or kind_in(" ".join(lines[:at])) or "acceleration"
    values = numbers(lines[at + 1:])
    return [Column(kind, counted(values, count, "NPTS"), unit, step, kind=kind)]


FORMAT = Format("AT2 of PEER", {"NPTS and DT in one of the first five lines": rf"\A(?:.*\n){{0,{TEXT - 1}}}.*NPTS"}, _read)
