"""GeoNet V1A and V2A (GNS Science, New Zealand): three components a file.

Each component has sixteen lines of text, four of ten integers and six of ten numbers, and samples of acceleration, then of
velocity and displacement where there are any, ten a line of eight characters each, in mm/s^2 or in the unit of the text. Of
the integers the 34th to 36th are the numbers of the samples.
"""

import re

from .reading import Column, Format, block, counted, lasting, numbers, numeric

TITLE = re.compile(r"\s*(un)?corrected accelerogram", re.IGNORECASE)
POINTS = re.compile(r"^\s*number of points\s+(\d+)\s+duration\s+([\d.]+)", re.IGNORECASE | re.MULTILINE)
STEP = re.compile(r"^\s*(?:instrument corrected data at|raw readings in units of\s+([\d.]+)\s*(\S+)\s+at intervals of)"
                  r"\s+([\d.]+)\s*s", re.IGNORECASE | re.MULTILINE)
COMPONENT = re.compile(r"^\s*component\s+(\S+)", re.IGNORECASE | re.MULTILINE)
INTEGERS, HEADER, WIDE = 4, 10, 10  # lines of integers, of all numbers of the header; samples in a line


def _component(lines: list[str]) -> Column:
    first = next((n for n in range(len(lines)) if numeric(lines[n])), len(lines))
    found = [pattern.search("\n".join(lines[:first])) for pattern in (POINTS, STEP, COMPONENT)]
    if not all(found):
        raise ValueError(f"component {lines[0].strip()!r}: lacks its number of points, its interval or its direction")
    points, steps, component = found
    body = block(lines, first)
    stated = [int(n) for n in numbers(body[:INTEGERS])[33:36]]
    count, step, factor = int(points[1]), float(steps[3]), float(steps[1] or 1)
    held = [-(-n // WIDE) for n in stated]
    if stated[:1] != [count] or len(body) != HEADER + sum(held):
        raise ValueError(f"component {component[1]}: {len(body) - HEADER} lines of samples, {stated} samples and {count} "
                         "points do not fit together")
    doubt = lasting(step, count, float(points[2]), 2 * step + 0.005)
    return Column(component[1], factor * counted(numbers(body[HEADER:HEADER + held[0]], "10F8.1"), count),
                  steps[2] or "mm/s^2", None if doubt else step, kind="acceleration", doubt=doubt)


def _read(lines: list[str]) -> list[Column]:
    starts = [n for n, line in enumerate(lines) if TITLE.match(line)] + [len(lines)]
    return [_component(lines[low:high]) for low, high in zip(starts, starts[1:])]


FORMAT = Format("GeoNet V1A or V2A", {
    'the line "Corrected accelerogram" or "Uncorrected accelerogram"': rf"^{TITLE.pattern}",
    'a line "Number of points ... Duration ... sec"': POINTS.pattern,
    'a line "Instrument corrected data at ... sec intervals" or "Raw readings in units of ..."': STEP.pattern,
    'a line "Component ..."': COMPONENT.pattern}, _read)
