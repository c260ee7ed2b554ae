"""SMC of the USGS (National Strong-Motion Program): eleven lines of text, 48 integers, 50 numbers, comments, samples.

The 16th integer is the number of comments, the 17th that of values, of ten characters each, in cm and s. The second number is
the sampling rate in Hz; where there is none, values are pairs of time and acceleration.
"""

import re

from .reading import Column, Format, block, counted, kind_in, numbers

INTEGERS, NUMBERS, NONE = 48, 50, 1e38
UNITS = {"acceleration": "cm/s^2", "velocity": "cm/s", "displacement": "cm"}


def _read(lines: list[str]) -> list[Column]:
    first = next(n for n in range(1, len(lines)) if block(lines, n))
    header = numbers(block(lines, first))
    counted(header, INTEGERS + NUMBERS, "the description of the format")
    comments, count, rate = int(header[15]), int(header[16]), header[INTEGERS + 1]
    at = first + len(block(lines, first)) + comments
    said = lines[at - comments:at]
    if not all(line.startswith("|") for line in said):
        raise ValueError(f"line {at}: {comments} lines of comments with a | are announced")
    values = counted(numbers([line for line in lines[at:] if line.strip()], "8E10.4"), count)
    kind = kind_in(lines[0])
    if not kind:
        raise ValueError(f"line 1: {lines[0].strip()!r}: is no acceleration, velocity or displacement")
    name = re.search(r"component\s*=\s*(\S.*?)\s*$", "\n".join(lines[:first]), re.IGNORECASE | re.MULTILINE)
    if 0 < rate < NONE:
        return [Column(name[1] if name else kind, values, UNITS[kind], 1 / rate, kind=kind)]
    return [Column(name[1] if name else kind, values[1::2], UNITS[kind], times=values[::2], kind=kind)]


FORMAT = Format("SMC", {
    'a first line such as "2 CORRECTED ACCELEROGRAM"': r"\A\s*[0-9] +(un)?(corrected|velocity|displacement|response)"}, _read)
