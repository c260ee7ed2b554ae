"""Text with columns of numbers, or with samples in rows: separators, decimal signs, names and units as the file has them.

Of the lines of text only those directly above the numbers name columns: names, perhaps with units, and perhaps a row of units
below them. Where several rows could, none is taken, and what they might say of times has to be given.
"""

import csv
import re
from collections.abc import Sequence
from typing import TYPE_CHECKING

from ..needed import needed
from ..units import is_unit, kind_of
from .reading import DATE, NUMBER, NUMBERS, ONE, Column, microseconds, numbers, rows

if TYPE_CHECKING:
    import numpy
    Array = numpy.ndarray
numpy = needed("numpy")

UNNAMED = "column {}"
MISSING = ("", "nan", "na", "n/a", "null", "-", "--")
COMMENT = ("#", "%", "//")
MOST = 6     # blocks that a message lists
SAMPLE = 50  # lines that have to agree on how columns are separated
# Readings of a line: separator (None is white space) and decimal sign, the more likely ones first.
READINGS = (("\t", "."), ("\t", ","), (";", "."), (";", ","), ("|", "."), (",", "."), (None, "."), (None, ","))
CLOCK = re.compile(r"(\d+):([0-5]\d):([0-5]\d(?:[.,]\d+)?)")
SPLIT_DATE = re.compile(r"(\d{4}[-/]\d\d[-/]\d\d)\s+(?=\d\d:\d\d)")
IN_BRACKETS = re.compile(r"(.*?)[\s_,/]*(?:\[(.*)\]|\((.*)\))\s*")
BRACKETED = re.compile(r"[\[(].*[\])]")
APART = re.compile(r"(?<=\w)(?:\s+in\s+|\s*/\s*|\s+-\s+|[\s_,.:|]+)(?=\S)")  # R makes "time..ms." of "time (ms)"
FACTOR = re.compile(r"\s*((?:[*×]|(?<=\s)x)\s*1[\d.e^+-]+|\b10\^.*)", re.IGNORECASE)
AMBIGUOUS = ("in", "d", "h", "min", "-", "1")  # are words or parts of names, too
NO_NAME = re.compile(rf"{NUMBER}[,;]?|.*=")  # words of a sentence or of a header of facts
NAMES_OF_TIME = ("t", "time", "times", "timestamp", "datetime", "date", "zeit", "temps", "elapsed", "clock", "tiempo", "tempo")
GLUED = re.compile(r"(t|time|timestamp|elapsed)(s|ms|us|ns|sec|secs|msec|millis|micros|min)", re.IGNORECASE)


def _number(field: str, decimal: str) -> float:
    """Dates in microseconds. Raises ValueError where the field is no number."""
    if field.lower() in MISSING:
        return numpy.nan
    if re.fullmatch(NUMBER, field if decimal == "." else field.replace(".", "x").replace(",", ".")):
        return float(field.replace(decimal, ".").lower().replace("d", "e"))
    if DATE.fullmatch(field):
        return microseconds(field)
    if found := CLOCK.fullmatch(field):
        return 3600 * int(found[1]) + 60 * int(found[2]) + float(found[3].replace(",", "."))
    raise ValueError


def _fields(line: str, delimiter: str | None) -> list[str]:
    fields = SPLIT_DATE.sub(r"\1T", line).split() if delimiter is None else line.strip(" ").split(delimiter)
    if delimiter and '"' in line:
        fields = next(csv.reader([line.strip(" ")], delimiter=delimiter, skipinitialspace=True))
    fields = [field.strip().strip('"').strip() for field in fields]
    return fields[:-1] if delimiter and len(fields) > 1 and not fields[-1] else fields


def _numbers(line: str, reading: tuple[str | None, str]) -> list[float] | None:
    """The numbers of a line, or None where it has something else."""
    try:
        return [_number(field, reading[1]) for field in _fields(line, reading[0])]
    except ValueError:
        return None


def _reading_of(lines: Sequence[str], delimiter: str | None, decimal: str | None) -> tuple[str | None, str]:
    """Separator and decimal sign with which most of the last lines are numbers, as many on each."""
    found: dict[tuple[str | None, str], list] = {}
    for reading in READINGS if delimiter is None else ((delimiter, "."), (delimiter, ",")):
        table: list[list[float]] = []
        for line in reversed(lines[-SAMPLE:] if decimal in (None, reading[1]) else ()):
            row = _numbers(line, reading)
            if row is None or table and len(row) != len(table[0]):
                break
            table.append(row)
        if table and (len(table[0]) > 1 or reading[0] is None) and not numpy.isnan(table).all():
            found[reading] = table
    if not found:
        raise ValueError(f"line {lines[-1]!r}: no numbers in columns")
    best = max(found, key=lambda reading: len(found[reading]))
    if best == (",", ".") and (None, ",") in found and decimal is None:  # 0,5 is one number or two
        times = [row[0] for row in found[best]]
        head = "" if _numbers(lines[0], best) else lines[0]
        if "," not in head if head else len(set(times)) < len(times):
            return None, ","
    return best


def columns_of(lines: Sequence[str], layout: str | None, delimiter: str | None, decimal: str | None) -> list[Column]:
    """The columns of a text; with the layout rows or pairs its channels.

    Raises
    ------
    ValueError
        If lines have no numbers, or not the same number of them, or if columns without names may be samples in rows.
    """
    if layout in ("rows", "pairs"):
        return _channels(lines, layout, delimiter)
    comments = {n for n, line in enumerate(lines) if line.lstrip().startswith(COMMENT)}
    numbered = [(n, line.strip().lstrip("#%/ ") if n in comments else line) for n, line in enumerate(lines) if line.strip()]
    plain = [line for n, line in numbered if n not in comments]
    if not plain:
        raise ValueError("is empty; give a file with samples")
    reading = _reading_of(plain, delimiter, decimal)
    count, heads, table = len(_fields(plain[-1], reading[0])), [], []
    for n, line in numbered:
        values = None if n in comments else _numbers(line, reading)
        if values is not None and len(values) == count:
            table.append(values)
        elif table and n not in comments:
            raise ValueError(f"line {n + 1}: {line.strip()!r}: needs {count} numbers; correct or remove the line")
        elif not table:
            heads.append(_fields(re.sub(r"\s+(?=[\[(])", "", line) if reading[0] is None else line, reading[0]))
    names, units, doubt = _names(heads, count)
    values = numpy.array(table).T
    words = reading[0] is None and not _proper(names) and not any(units)  # of a sentence, perhaps
    if layout is None and (names[0] == UNNAMED.format(0) or words):
        parts = [re.split(r"[,;\s]+", " ".join(head)) for head in heads]
        _require_columns(values, [head for head in parts if len(head) > 2 and all(map(ONE.fullmatch, head))])
    last = _fields(plain[-1], reading[0])
    units = ["us" if DATE.fullmatch(field) else "s" if CLOCK.fullmatch(field) else unit for field, unit in zip(last, units)]
    return [Column(name, column, unit, doubt=doubt, kind="date" if DATE.fullmatch(field) else "")
            for name, unit, column, field in zip(names, units, values, last)]


def _require_columns(values: "Array", above: Sequence[Sequence[str]]) -> None:
    """Refuses columns without names that may be rows: without rising times, or where all numbers of the file rise, or every
    second one, or below lines with other counts of numbers."""
    count, flat = len(values), values.T.ravel()

    def rise(numbers: "Array") -> bool:
        return bool((numpy.diff(numbers) > 0).all())

    short = bool(above) and values.shape[1] == 1  # the last row of a file of rows
    if above and not short:
        raise ValueError(f"layout: rows of {count} numbers below {len(above[0])}, {above[0][0]} ...: leave those lines out, or "
                         'say layout="columns"')
    pairs = count % 2 == 0 and rise(flat[::2])
    if short or count > 1 and (not rise(values[0]) or rise(flat) or count > 2 and pairs):
        count = len(above[0]) if short else count
        raise ValueError(f"layout: {count} columns of one kind without names: layout=\"rows\" takes "
                         "the samples of each row one after the other, with step="
                         + (', layout="pairs" pairs of time and value' if pairs or short else "")
                         + ('' if short else '; layout="columns" takes a column alone'))


def _names(heads: Sequence[Sequence[str]], count: int) -> tuple[list[str], list[str], str]:
    """Names and units of columns, and what is in doubt about them."""
    none, fitting = [""] * count, [head for head in heads if len(head) == count]
    unnamed = [UNNAMED.format(n) for n in range(count)]
    above = [head for head in heads[-2:] if len(head) == count and not any(map(NO_NAME.fullmatch, head))]
    last = bool(above) and above[-1] is heads[-1]
    units = [head for head in above if any(head) and all(BRACKETED.fullmatch(field) or is_unit(field) for field in head)]
    names = [head for head in above if head not in units]
    if last and len(units) == len(names) == 1 and (len(fitting) == 2 or _proper(names[0])):
        return names[0], [field.strip("[]()") for field in units[0]], ""
    if last and units and len(fitting) == 1:
        plain = [field.strip("[]()") for field in units[0]]
        stated = count > 1 and any(kind_of(unit) == "time" or "/" in unit for unit in plain)
        return (unnamed, plain, "") if stated else (plain, none, "")
    if last and not units and (len(fitting) == 1 or _proper(names[-1])):
        found, units_of = zip(*map(name_and_unit, names[-1]))
        return list(found), list(units_of), ""
    if not last and not any(map(_proper, fitting)):
        return unnamed, none, ""
    return unnamed, none, (f"{len(fitting)} lines could name the columns, and none is directly above the numbers with names of "
                           "times or known units")


def _proper(head: Sequence[str]) -> bool:
    """Whether one of the names is of a time, or has a known unit."""
    return any(name.lower() in NAMES_OF_TIME or unit and is_unit(unit) for name, unit in map(name_and_unit, head))


def name_and_unit(name: str) -> tuple[str, str]:
    """Name of a column and the unit that stands in brackets or behind it: "a [g]", "a_g", "t/ms", "time in ms", "timeMs". A
    factor between both, as in "t x 1000 [s]", makes a unit that is not known."""
    if factor := FACTOR.search(name):
        return name[:factor.start()], re.sub(r"[\[\]()]", "", factor[0]).strip()
    if found := IN_BRACKETS.fullmatch(name):
        return found[1].strip() or name, (found[2] or found[3] or "").strip()
    if (kind_of(name) == "time" and name.lower() not in ("h", "d", "min", "ns")) or "/" in name and kind_of(name):
        return name, name
    apart = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", name)
    parts = [(apart[:gap.start()], gap[0].strip(), apart[gap.end():].rstrip(".")) for gap in APART.finditer(apart.rstrip("."))]
    if glued := GLUED.fullmatch(name):
        parts.append((glued[1], "", glued[2]))
    for head, between, unit in parts:
        kind = kind_of(unit)
        clear = unit.lower() not in AMBIGUOUS and (kind in ("time", "acceleration") or len(unit) > 1 or unit == "N")
        if is_unit(unit) and (between or clear) or kind == "time" and head.lower() in NAMES_OF_TIME:
            return head, unit
    first, _, rest = re.sub(r"[_,:;/]+", " ", apart).strip().partition(" ")
    return (first, rest.strip()) if first.lower() in NAMES_OF_TIME and rest.strip() else (name, "")


def _channels(lines: Sequence[str], layout: str, delimiter: str | None) -> list[Column]:
    """Blocks of rows of as many numbers, the last of which may have fewer: channels, named by the line of text above."""
    channels: list[tuple[str, list[str]]] = []
    name, wide, ended = "", 0, True
    for line in lines:
        plain = line.replace(delimiter or ("\t" if "\t" in line else ";" if ";" in line else ","), " ")
        if line.strip() and not NUMBERS.fullmatch(plain):
            name, ended = line.strip().lstrip("#%/ ")[:60], True
        elif line.strip():
            count = len(rows([plain])[0])
            if ended or count > wide:
                channels.append((name, []))
                wide = count
            channels[-1][1].append(plain)
            ended = count < wide
    if not channels:
        raise ValueError("no numbers in rows; give a file with samples")
    found = []
    for n, (name, block) in enumerate(channels):
        values = numbers(block)
        name = name or f"block {n} of {len(values)}"
        if layout == "pairs" and len(values) % 2:
            raise ValueError(f"{name}: {len(values)} numbers are no pairs; correct the last row")
        found.append(Column(name, values) if layout == "rows" else Column(name, values[1::2], times=values[::2], time_unit=""))
    return found


def ways(lines: Sequence[str]) -> str:
    """How the numbers of lines can be read without what the text says, in words; what was tried."""
    found = []
    for layout, how in (("rows", "samples one after the other"), ("columns", "a column each")):
        try:
            columns = columns_of(lines, layout, None, None)
        except ValueError:
            continue
        usable = [n for n, column in enumerate(columns) if column.kind != "date"]
        largest = sorted(usable, key=lambda n: -len(columns[n].values))[:MOST]
        found.append(f'layout="{layout}" ({how}) with step=, unit= and column= of ' + ", ".join(
            f"{n} ({columns[n].name}: {len(columns[n].values)})" for n in sorted(largest)))
    return " or ".join(found) or "by a stickslip.Record(time, value, unit) of your own arrays"
