"""Text of FDSN web services (EarthScope): GeoCSV 2.0, and the time series TSPAIR and SLIST.

Times are absolute there and become seconds from the first sample; pieces of one channel, each below its own header, follow
each other with gaps.
"""

import re
from collections.abc import Sequence
from typing import TYPE_CHECKING

from ..needed import needed
from . import tables
from .reading import Column, Format, counted, microseconds, numbers

if TYPE_CHECKING:
    import numpy
    Array = numpy.ndarray
numpy = needed("numpy")

SERIES = re.compile(r"TIMESERIES\s+(\S+),\s*(\d+) samples,\s*([\d.]+) sps,\s*([^,\s]+),\s*(TSPAIR|SLIST),\s*\w+"
                    r"(?:,\s*(\S.*?))?\s*$", re.IGNORECASE)


def _joined(pieces: "Sequence[tuple[str, str, Array, Array]]") -> list[Column]:
    """Columns of pieces (name, unit, times [microseconds], values), with times from the first sample."""
    found = []
    for name, unit in dict.fromkeys(piece[:2] for piece in pieces):
        times, values = (numpy.concatenate(part) for part in zip(*[piece[2:] for piece in pieces if piece[:2] == (name, unit)]))
        first = numpy.datetime64(int(times[0]), "us")
        found.append(Column(name, values, unit, times=(times - times[0]) / 1e6,
                            notes=(f"times are from the first sample, {first}",)))
    return found


def _even(start: str, rate: str, count: int) -> "Array":
    return microseconds(start) + 1e6 / float(rate) * numpy.arange(count)


def _series(lines: list[str]) -> list[Column]:
    heads, pieces = [n for n, line in enumerate(lines) if SERIES.match(line)], []
    for low, high in zip(heads, [*heads[1:], len(lines)]):
        name, count, rate, start, form, unit = SERIES.match(lines[low]).groups()
        if form.upper() == "TSPAIR":
            times, values = (column.values for column in tables.columns_of(lines[low + 1:high], "columns", None, "."))
        else:
            values = numbers(lines[low + 1:high])
            times = _even(start, rate, len(values))
        pieces.append((name, unit or "", times, counted(values, int(count))))
    return _joined(pieces)


def _geocsv(lines: list[str]) -> list[Column]:
    heads, pieces = [n for n, line in enumerate(lines) if re.match(r"#\s*dataset\s*:", line, re.IGNORECASE)], []
    for low, high in zip(heads, [*heads[1:], len(lines)]):
        stated = [line.lstrip("# ").partition(":") for line in lines[low:high] if line.startswith("#")]
        said = {key.strip().upper(): value.strip() for key, _, value in stated}
        delimiter = said.get("DELIMITER", ",").strip("'\"").replace("\\t", "\t") or None
        units = [unit.strip() for unit in re.split(rf"[,{re.escape(delimiter or '')}]", said["FIELD_UNIT"])]
        body = [line for line in lines[low:high] if not line.startswith("#")]
        columns = tables.columns_of(body, "columns", delimiter if delimiter in body[0] else None, ".")
        times = next((column.values for column in columns if column.kind == "date"), None)
        if len(columns) != len(units) or times is None and len(units) > 1:
            raise ValueError(f"field_unit: {said['FIELD_UNIT']} for {len(columns)} columns: needs as many units, one of them "
                             "of dates such as 2001-01-31T23:59:58.5Z")
        if times is None:
            times = _even(said["START_TIME"], said["SAMPLE_RATE_HZ"], len(columns[0].values))
        counted(times, int(said.get("SAMPLE_COUNT", len(times))))
        pieces += [(said.get("SID", column.name) if len(units) < 3 else column.name, unit, times, column.values)
                   for column, unit in zip(columns, units) if column.kind != "date"]
    return _joined(pieces)


FORMATS = (
    Format("TSPAIR or SLIST", {
        'a line "TIMESERIES ..., ... samples, ... sps, ..., SLIST, ..."': rf"^{SERIES.pattern}"}, _series),
    Format("GeoCSV", {'a line "# dataset: GeoCSV"': r"^#\s*dataset\s*:\s*GeoCSV",
                      'a line "# field_unit:"': r"^#\s*field_unit\s*:"}, _geocsv))
