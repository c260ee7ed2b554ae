"""Text of FDSN web services (EarthScope): GeoCSV 2.0, and the time series TSPAIR and SLIST.

Times are absolute there and become seconds from the first sample; pieces of one channel, each below its own header, follow
each other with gaps.
"""

import re
from collections.abc import Sequence
from typing import TYPE_CHECKING

from ..needed import needed
from .reading import DATE, Column, Format, counted, keys, microseconds, numbers, table

if TYPE_CHECKING:
    import numpy
    Array = numpy.ndarray
numpy = needed("numpy")

SERIES = re.compile(r"TIMESERIES\s+(\S+),\s*(\d+) samples,\s*([\d.]+) sps,\s*([^,\s]+),\s*(TSPAIR|SLIST),\s*\w+"
                    r"(?:,\s*(\S.*?))?\s*$", re.IGNORECASE)


def from_first(name: str, unit: str, pieces: "Sequence[tuple[Array, Array]]") -> Column:
    """A column of pieces (times [microseconds], values), with times from the first sample."""
    times, values = (numpy.concatenate(part) for part in zip(*pieces))
    first = numpy.datetime64(int(times[0]), "us")
    return Column(name, values, unit, times=(times - times[0]) / 1e6, notes=(f"times are from the first sample, {first}",))


def _dated(lines: list[str], delimiter: str | None, at: int) -> "tuple[Array, list[Array]]":
    """Times [microseconds] of lines with a date, and the columns of the other numbers."""
    fields = [[field.strip() for field in line.split(delimiter)] for line in lines]
    wrong = next((row for row in fields if len(row) != len(fields[0]) or not DATE.fullmatch(row[at])), None)
    if wrong:
        raise ValueError(f"{wrong}: needs a time such as 2001-01-31T23:59:58.5Z, and {len(fields[0]) - 1} values")
    times = numpy.array([microseconds(row.pop(at)) for row in fields], float)
    return times, table([" ".join(row) for row in fields], len(fields[0]))


def _series(lines: list[str]) -> list[Column]:
    heads = [n for n, line in enumerate(lines) if SERIES.match(line)]
    channels: dict[tuple[str, str], list] = {}
    for low, high in zip(heads, [*heads[1:], len(lines)]):
        name, count, rate, start, form, unit = SERIES.match(lines[low]).groups()
        body = [line for line in lines[low + 1:high] if line.strip()]
        times, (values, *_) = _dated(body, None, 0) if form.upper() == "TSPAIR" else (None, [numbers(body)])
        counted(values, int(count))
        even = microseconds(start) + 1e6 / float(rate) * numpy.arange(len(values))
        channels.setdefault((name, unit or ""), []).append((even if times is None else times, values))
    return [from_first(name, unit, pieces) for (name, unit), pieces in channels.items()]


def _geocsv(lines: list[str]) -> list[Column]:
    heads = [n for n, line in enumerate(lines) if re.match(r"#\s*dataset\s*:", line, re.IGNORECASE)] + [len(lines)]
    channels: dict[tuple[str, str], list] = {}
    for low, high in zip(heads, heads[1:]):
        comments = [line for line in lines[low:high] if line.startswith("#")]
        body = [line for line in lines[low:high] if line.strip() and not line.startswith("#")]
        said = keys(comments)
        delimiter = said.get("DELIMITER", ",") or " "
        units = [unit.strip() for unit in said["FIELD_UNIT"].split(",")]
        names = [name.strip() for name in body[0].split(delimiter)]
        at = next((n for n, unit in enumerate(units) if re.match(r"ISO.?8601|UTC", unit, re.IGNORECASE)), None)
        if len(names) != len(units) or at is None and len(units) > 1:
            raise ValueError(f"field_unit: {said['FIELD_UNIT']} and the columns {', '.join(names)}: needs as many units, one "
                             "of them ISO_8601 or UTC")
        times, columns = (None, [numbers(body[1:])]) if at is None else _dated(body[1:], delimiter, at)
        if times is None:
            times = microseconds(said["START_TIME"]) + 1e6 / float(said["SAMPLE_RATE_HZ"]) * numpy.arange(len(columns[0]))
        counted(times, int(said.get("SAMPLE_COUNT", len(times))))
        values = [n for n in range(len(units)) if n != at]
        for n, column in zip(values, columns):
            name = said.get("SID", names[n]) if len(values) == 1 else names[n]
            channels.setdefault((name, units[n]), []).append((times, column))
    return [from_first(name, unit, pieces) for (name, unit), pieces in channels.items()]


FORMATS = (
    Format("TSPAIR or SLIST", {
        'a line "TIMESERIES ..., ... samples, ... sps, ..., SLIST, ..."': rf"^{SERIES.pattern}"}, _series),
    Format("GeoCSV", {'a line "# dataset: GeoCSV"': r"^#\s*dataset\s*:\s*GeoCSV",
                      'a line "# field_unit:"': r"^#\s*field_unit\s*:"}, _geocsv))
