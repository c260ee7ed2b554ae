"""SMC of the USGS (National Strong-Motion Program): eleven lines of text, 48 integers, 50 numbers, comments, samples.

The 16th integer is the number of comments, the 17th that of values, of ten characters each, in cm and s. The second number is
the sampling rate in Hz; where there is none, values are pairs of time and acceleration. A row of what a buffer had left may
follow the values.
"""

import re

from .reading import FLAGS, Column, Format, block, counted, kind_in, numbers, pairs

INTEGERS, NUMBERS, LINES, ROW, NONE = 48, 50, 16, 8, 1e38  # LINES: of integers and numbers
UNITS = {"acceleration": "cm/s^2", "velocity": "cm/s", "displacement": "cm"}


def _read(lines: list[str]) -> list[Column]:
    first = next(n for n in range(1, len(lines)) if len(block(lines[:n + LINES], n)) == LINES)
    described = lines[first:first + LINES]
    header = numbers(described)
    counted(header, INTEGERS + NUMBERS, "the description of the format")
    comments, count, rate = int(header[15]), int(header[16]), header[INTEGERS + 1]
    at = first + len(described) + comments
    if not all(line.startswith("|") for line in lines[at - comments:at]):
        raise ValueError(f"line {at}: {comments} lines of comments with a | are announced")
    values = numbers(lines[at:], "8E10.4")
    values = counted(values[:count] if count < len(values) <= count + ROW else values, count)
    kind = "spectrum" if "response" in lines[0].lower() else kind_in(lines[0])
    said = re.search(r"component\s*=\s*(\S.*?)\s*$", "\n".join(lines[:first]), FLAGS)
    name, unit = said[1] if said else kind or "value", UNITS.get(kind, "")
    if 0 < rate < NONE:
        return [Column(name, values, unit, 1 / rate, kind=kind)]
    return [pairs(name, values, unit, kind)]


FORMAT = Format("SMC", {'a first line such as "2 CORRECTED ACCELEROGRAM"':
                        r"\A\s*[0-9] +(un)?(corrected|velocity|displacement|response|unknown)"}, _read)
