"""Volumes 1 and 2 of CSMIP (California Strong Motion Instrumentation Program), old and new layout, several channels a file.

A line above the samples has their number, interval or rate, unit, and often their Fortran format; older volumes have the unit
with the peak. Old films (volume 1) have pairs of time [s] and acceleration [g/10] instead, of seven characters each, behind
100 integers and 50 numbers.
"""

import re

from .reading import KINDS, Column, Format, block, counted, numbers, numeric, pairs

SAMPLES = re.compile(r"\s*(\d+)\s+(?:points of (acc|vel|dis)\w* data equally spaced at\s*([\d.]+)\s*sec"
                     r"|(?:acc)\w* points at\s*([\d.]+)\s*(?:pts|points|samples)/sec)", re.IGNORECASE)
UNIT = re.compile(r"\b(?:in units(?: of)?|in|units:)\s+([a-z%][\w/^*%]*)", re.IGNORECASE)
FORM = re.compile(r"\(\s*(\d*[FEDG]\d+\.?\d*)\s*\)", re.IGNORECASE)
DIRECTION = re.compile(r".*\bchan\w*\s+(\d+):\s*(\S+(?: \S+)?)|\s*comp\s+([a-z\d]+)", re.IGNORECASE)
PEAK = re.compile(r"\s*peak\s+acceleration\s*=\s*\S+\s+(\S+)", re.IGNORECASE)
PAIRS = re.compile(r"\s*no\. of points\s*=\s*(\d+)", re.IGNORECASE)
TENTHS = re.compile(r"\s*units (?:of uncor\w* \w+ )?are sec and g/10", re.IGNORECASE)


def _even(lines: list[str], at: int, found: re.Match, name: str, unit: str) -> Column:
    line = lines[at]
    stated, form = UNIT.search(line, found.end()), FORM.search(line)
    values = counted(numbers(block(lines, at + 1), form[1] if form else ""), int(found[1]), f"line {at + 1}")
    return Column(name, values, stated[1] if stated else unit, float(found[3]) if found[3] else 1 / float(found[4]),
                  kind=KINDS[(found[2] or "acc").lower()])


def _pairs(lines: list[str], at: int, count: int, name: str) -> Column:
    """Of the lines of numbers below those of text the last ones, five pairs each."""
    first = next(n for n in range(at, len(lines)) if numeric(lines[n]))
    values = numbers(block(lines, first)[-(-(-count // 5)):], "10F7.3")
    return pairs(name, counted(values, 2 * count), "g/10", "acceleration")


def _read(lines: list[str]) -> list[Column]:
    columns: dict[str, Column] = {}
    name, unit, points, announced, film = "", "", 0, set(), not any(map(SAMPLES.match, lines))
    for at, line in enumerate(lines):
        if found := DIRECTION.match(line):
            name = f"Chan {found[1]}: {found[2]}" if found[1] else found[3]
            announced.add(found[1] or found[3])
        elif found := PAIRS.match(line):
            points = int(found[1])
        elif found := PEAK.match(line):
            unit = found[1]
        elif film and TENTHS.match(line):
            columns[name] = _pairs(lines, at + 1, points, name)
        elif found := SAMPLES.match(line):
            column = _even(lines, at, found, name or f"channel {len(columns)}", unit)
            if column.kind == "acceleration" or column.name not in columns:
                columns[column.name] = column
                unit = ""
        elif re.search(r"points of (acc|vel|dis)\w* data", line, re.IGNORECASE):
            raise ValueError(f"line {at + 1}: {line.strip()[:60]!r}: needs the number of points, their interval and unit")
    if len(columns) < len(announced):
        raise ValueError(f"has {len(announced)} channels, and samples of {len(columns)}: {', '.join(columns)}")
    return list(columns.values())


FORMAT = Format("CSMIP", {
    'the line "Corrected accelerogram" or "Uncorrected accelerogram"': r"^\s*(file\s+\d+ of )?(un)?corrected accelerogram",
    'a line "... points of accel data equally spaced at ... sec, in ..."':
        rf"^(?:{SAMPLES.pattern}|{TENTHS.pattern})"}, _read)
