"""COSMOS V0, V1, V2: strong motion data tape format 1.20 (Consortium of Organizations for Strong-Motion Observation Systems).

Each channel has lines of text, integers and numbers, whose counts and Fortran formats the lines above them state, comments,
and samples. Of the numbers, 62 is the sampling interval of the samples in ms and 63 their duration in s; 34 is the interval
of the recorder in s. Counts of an accelerometer times value 22 [uV], over value 42 [V/g] and the gain, value 47, are g. The
line above the samples has their number, about their duration, unit with its code, and format.
"""

import dataclasses
import re
from collections.abc import Sequence

from ..units import in_si, plain_unit
from .reading import Column, Format, block, counted, kind_in, lasting, numbers

HEADER = re.compile(r"\s*(\d+)\s+(integer|real)-header values follow on\s+(\d+)\s+lines.*?format\s*=\s*(.*)", re.IGNORECASE)
SAMPLES = re.compile(r"\s*(\d+)\s+(.*?)\s*pts,\s*approx\s*([\d.]+)\s*secs?,\s*units\s*=\s*(.*?)\s*(?:\(\s*(\d+)\s*\))?\s*,?\s*"
                     r"format\s*=\s*(.*)", re.IGNORECASE)
DIRECTION = re.compile(r"\s*sta cha\w*:?\s*(.*?)\s*\(rcrdr", re.IGNORECASE)
CODES = {2: "g", 4: "cm/s^2", 5: "cm/s", 6: "cm", 7: "in/s^2", 8: "in/s", 9: "in", 10: "gal", 11: "mg", 12: "ug", 50: "counts",
         51: "v", 52: "mv"}
INTERVAL, DURATION, RECORDER, BIT, SENSITIVITY, GAIN = 61, 62, 33, 21, 41, 46  # places among the numbers, from 0


def _step(real: Sequence[float], count: int, seconds: float) -> tuple[float, str]:
    """Sampling interval [s], and why it is in doubt."""
    place, step = (INTERVAL, real[INTERVAL] / 1000) if real[INTERVAL] > 0 else (RECORDER, real[RECORDER])
    stated = real[DURATION]
    doubt = lasting(step, count, seconds, 1 + step) or (
        lasting(step, count, stated, 2 * step + 1e-3 * stated) if stated > 0 and place == INTERVAL else "")
    return step, f"value {place + 1} of the real header: {doubt}" if doubt else ""


def _in_g(column: Column, real: Sequence[float]) -> Column:
    """Counts of an accelerometer in g, if the header has what that takes."""
    bit, sensitivity, gain = real[BIT], real[SENSITIVITY], real[GAIN] if real[GAIN] > 0 else 1
    if plain_unit(column.unit) != "counts" or column.kind != "acceleration" or bit <= 0 or sensitivity <= 0:
        return column
    note = f"counts became g: times {bit:g} uV over {sensitivity:g} V/g and the gain {gain:g}, as the real header says"
    return dataclasses.replace(column, values=column.values * (bit * 1e-6 / sensitivity / gain), unit="g", notes=(note,))


def _read(lines: list[str]) -> list[Column]:
    columns: list[Column] = []
    real, direction = [-999.0] * 100, ""
    for at, line in enumerate(lines):
        if found := DIRECTION.match(line):
            direction = re.sub(r"^Chan \?:\s*", "", f"Chan {found[1]}") if found[1] else ""
        elif found := HEADER.match(line):
            values = counted(numbers(lines[at + 1:at + 1 + int(found[3])], found[4]), int(found[1]))
            real = [*values, *real[len(values):]] if found[2].lower() == "real" else real
        elif found := SAMPLES.match(line):
            count, code = int(found[1]), CODES.get(int(found[5] or 0), "")
            unit = found[4] or code
            if code and in_si(plain_unit(unit)) != in_si(code):
                raise ValueError(f"line {at + 1}: the unit is {unit}, its code {found[5]} stands for {code}; correct either")
            step, doubt = _step(real, count, float(found[3]))
            kind = kind_in(found[2])
            values = counted(numbers(block(lines, at + 1), found[6]), count)
            columns.append(_in_g(Column(direction or f"{kind or 'channel'} {len(columns)}", values, unit,
                                        None if doubt else step, kind=kind, doubt=doubt), real))
            real, direction = [-999.0] * 100, ""
    return columns


FORMAT = Format("COSMOS", {
    'a line "... Real-header values follow on ... lines, Format="': r"real-header values follow on.*format\s*=",
    'a line "... pts, approx ... secs, units=..., Format="': r"pts,\s*approx.*secs?,\s*units\s*=.*format\s*="}, _read)
