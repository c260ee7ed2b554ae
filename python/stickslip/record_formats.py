"""Columns of numbers in files of measured records, with their names and units as the files have them."""

import dataclasses
import pathlib
import re
from collections.abc import Sequence
from typing import TYPE_CHECKING

from .needed import needed

if TYPE_CHECKING:
    import numpy
    Array = numpy.ndarray
numpy = needed("numpy")

NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eEdD][-+]?\d+)?"
MISSING = ("", "nan", "na", "n/a", "null", "-", "--")
DATE = re.compile(r"\d{4}-\d\d-\d\d[T ]\d\d:\d\d(?::\d\d(?:\.\d+)?)?Z?")
COMMENT = ("#", "%", "//")
SAMPLE = 50  # lines that have to agree on how columns are separated
# Readings of a line: separator (None is white space) and decimal sign, the more likely ones first.
READINGS = (("\t", "."), ("\t", ","), (";", "."), (";", ","), ("|", "."), (",", "."), (None, "."), (None, ","))
IN_BRACKETS = re.compile(r"(.*?)[\s_,]*[\[(]([^\])]*)[\])]\s*")
BEHIND = re.compile(r"(.+?)(?:_|\s|,|\sin\s)+(s|ms|us|min|%?g|mg|gal|mgal|(?:[cm]?m|ft|in)/s(?:\^2|2|/s|\*\*2))", re.IGNORECASE)
COSMOS = re.compile(r"^\s*(\d+)\s+([^\n]*?)\s*pts,\s*approx\s+([\d.]+)\s+secs,\s*units=\s*([^\s(,]+)[^\n]*"
                    r"Format=\s*\(\s*\d*[A-Z](\d+)[^\n]*\n", re.IGNORECASE | re.MULTILINE)
CSMIP = re.compile(r"^\s*(\d+) points of (accel) data equally spaced at\s*([\d.]+)\s*sec[^\n]*?in\s+([^\s.(]+)[^\n]*?"
                   r"\(\s*\d*[A-Z](\d+)[^\n]*\n", re.IGNORECASE | re.MULTILINE)
REAL_HEADER = re.compile(r"^\s*\d+ Real-header values follow on\s+(\d+) lines[^\n]*\n", re.IGNORECASE | re.MULTILINE)
COSMOS_STEP = 33  # place of the sampling interval among the numbers of the real header, from 0; in ms
SAC_NUMBERS, SAC_INTEGERS, SAC_LINES = 14, 8, 30  # lines of numbers, of integers, and of the whole header


@dataclasses.dataclass(frozen=True, eq=False)
class Column:
    """Numbers with their name and unit; sampling interval and first time [s] where the format has them."""

    name: str
    values: "Array"
    unit: str = ""
    step: float | None = None
    start: float = 0


def plain_unit(text: str) -> str:
    """A unit in one spelling: "CM/SEC/SEC", "cm/s2" and "cm s^-2" are cm/s^2."""
    text = text.strip().lower().replace("seconds", "s").replace("sec", "s").replace("²", "^2").replace("**", "^")
    text = re.sub(r"(m|ft|in)[\s·*]?s\^?-2", r"\1/s^2", text)
    return re.sub(r"(m|ft|in)/s(?:/s|\^?2)", r"\1/s^2", text)


def columns_of(path: pathlib.Path, delimiter: str | None = None, decimal: str | None = None) -> tuple[str, list[Column]]:
    """Format and columns of a file.

    Raises
    ------
    ValueError
        If it is in none of the formats, or does not hold what its header says.
    """
    data = path.read_bytes()
    if data.startswith(b"\x93NUMPY"):
        return "NumPy array", _of_array("column", numpy.load(path, allow_pickle=False))
    if data.startswith(b"MATLAB 5.0"):
        return "MATLAB file", _of_matlab(needed("scipy.io").loadmat(path))
    if data.startswith(b"\x89HDF") or data.startswith(b"MATLAB 7.3"):
        raise ValueError("is HDF5, as MATLAB 7.3 writes it; write it in MATLAB by save(..., '-v7')")
    wide = data.startswith((b"\xff\xfe", b"\xfe\xff"))
    if not wide and b"\0" in data:
        raise ValueError("is binary, in no known format; take text (SAC: the alphanumeric form), or make a "
                         "stickslip.Record(time, value) of what another reader gives")
    text = data.decode("utf-16" if wide else "utf-8-sig", errors="replace").replace("\r\n", "\n").replace("\r", "\n")
    head = text.split("\n", 5)
    if any("NPTS" in line.upper() for line in head[:5]):
        return "AT2 of PEER", [_of_at2(head, text)]
    for form, blocks in (("V2 of COSMOS", COSMOS), ("V2 of CSMIP", CSMIP)):
        if found := [block for block in blocks.finditer(text) if block[2].strip().lower().startswith(("acc", "uncor"))]:
            return form, [_of_block(text, block, n) for n, block in enumerate(found)]
    if is_sac(head):
        return "SAC", [_of_sac(text.split("\n"))]
    return "text", _of_text(text.split("\n"), delimiter, decimal)


def _fixed(text: str, width: int, count: int) -> "Array":
    """The first `count` numbers of a width that may stand without a space between them."""
    pieces = [line[n:n + width] for line in text.split("\n") for n in range(0, len(line.rstrip()), width)]
    values = [float(piece.lower().replace("d", "e")) for piece in pieces[:count]]
    if len(values) < count:
        raise ValueError(f"holds {len(values)} of the {count} samples that its header announces; fetch it anew")
    return numpy.array(values)


def _of_at2(head: Sequence[str], text: str) -> Column:
    line = next(n for n, part in enumerate(head[:5]) if "NPTS" in part.upper())
    stated = {name.upper(): re.search(pattern, head[line], re.IGNORECASE) for name, pattern in (
        ("NPTS", r"NPTS\s*=\s*(\d+)"), ("DT", rf"DT\s*=\s*({NUMBER})"))}
    plain = re.match(rf"\s*(\d+)\s+({NUMBER})", head[line])  # older files: 5366 0.0100 NPTS, DT
    if not (stated["NPTS"] or plain):
        raise ValueError(f"line {line + 1}: {head[line].strip()}: needs NPTS= and DT=, such as NPTS= 5366, DT= .01 SEC")
    count = int(stated["NPTS"][1] if stated["NPTS"] else plain[1])
    step = float(stated["DT"][1]) if stated["DT"] else float(plain[2]) if plain else None
    values = numpy.array(re.findall(NUMBER, "\n".join(text.split("\n")[line + 1:])), float)
    if len(values) != count:
        raise ValueError(f"holds {len(values)} samples, NPTS = {count}; fetch it anew")
    unit = re.search(r"UNITS OF\s+(\S+)", "\n".join(head[:line]), re.IGNORECASE)
    return Column("acceleration", values, unit[1].rstrip(".,") if unit else "", step)


def _of_block(text: str, block: re.Match, number: int) -> Column:
    """A channel of a V2 file: the samples behind the line that announces them."""
    count, unit = int(block[1]), block[4]
    step = float(block[3]) if block.re is CSMIP else _cosmos_step(text[:block.start()], count, float(block[3]))
    return Column(f"acceleration {number}", _fixed(text[block.end():], int(block[5]), count), unit, step)


def _cosmos_step(before: str, count: int, seconds: float) -> float:
    """The sampling interval of the last real header, checked by the duration, which is rounded to seconds."""
    header = list(REAL_HEADER.finditer(before))
    lines = before[header[-1].end():].split("\n")[:int(header[-1][1])] if header else []
    values = re.findall(NUMBER, "\n".join(lines))
    step = float(values[COSMOS_STEP]) / 1000 if len(values) > COSMOS_STEP else 0
    if not abs(step * count - seconds) <= 1.5 + 0.01 * seconds:
        raise ValueError(f"real header, value {COSMOS_STEP + 1}: a sampling interval of {step:g} s does not make {count} "
                         f"samples last {seconds:g} s; correct it, it is in milliseconds")
    return step


def is_sac(head: Sequence[str]) -> bool:
    """Whether lines are the first ones of a SAC file: five numbers each, 15 characters wide."""
    return len(head) > 4 and all(len(line.rstrip()) == 75 and re.fullmatch(rf"(?:\s*{NUMBER}){{5}}\s*", line)
                                 for line in head[:4])


def _of_sac(lines: Sequence[str]) -> Column:
    numbers = _fixed("\n".join(lines[:SAC_NUMBERS]), 15, 70)
    integers = _fixed("\n".join(lines[SAC_NUMBERS:SAC_NUMBERS + SAC_INTEGERS]), 10, 40).astype(int)
    step, start, count, kind, even = numbers[0], numbers[5], integers[9], integers[16], integers[35]
    if not even or step <= 0:
        raise ValueError(f"LEVEN = {even}, DELTA = {step:g}: is not evenly sampled; interpolate it in SAC")
    name = {6: "displacement", 7: "velocity", 8: "acceleration"}.get(int(kind), "value")
    return Column(name, _fixed("\n".join(lines[SAC_LINES:]), 15, int(count)), "", float(step),
                  float(start) if start != -12345 else 0)


def _of_array(name: str, array: "Array") -> list[Column]:
    array = numpy.squeeze(array)
    if array.ndim not in (1, 2) or array.dtype.kind not in "fiub":
        raise ValueError(f"{name}: shape {array.shape} of {array.dtype}; needs numbers, a vector or columns")
    if array.ndim == 1:
        return [Column(name, array.astype(float))]
    rows = array.T if array.shape[0] >= array.shape[1] else array
    return [Column(f"{name} {n}", row.astype(float)) for n, row in enumerate(rows)]


def _of_matlab(variables: dict) -> list[Column]:
    columns, step = [], None
    for name, array in variables.items():
        if not hasattr(array, "dtype") or array.dtype.kind not in "fiu":
            continue
        if array.size > 1:
            columns += _of_array(name, array)
        elif name.lower() in ("dt", "delta", "step"):
            step = float(array.item())
        elif name.lower() in ("fs", "rate", "samplingrate", "sampling_rate"):
            step = 1 / float(array.item())
    return [dataclasses.replace(column, step=step) for column in columns]


def _number(field: str, decimal: str) -> float:
    """Raises ValueError where the field is none."""
    field = field.strip().strip('"')
    if field.lower() in MISSING:
        return numpy.nan
    if DATE.fullmatch(field):
        return numpy.datetime64(field.replace(" ", "T").removesuffix("Z"), "us").astype(int) / 1e6
    if decimal == ",":
        if "." in field:
            raise ValueError
        field = field.replace(",", ".")
    if not re.fullmatch(NUMBER, field):
        raise ValueError
    return float(field.lower().replace("d", "e"))


def _fields(line: str, delimiter: str | None) -> list[str]:
    fields = line.strip(" ").split(delimiter)
    return fields[:-1] if len(fields) > 1 and not fields[-1].strip() else fields


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
        rows: list[list[float]] = []
        for line in reversed(lines[-SAMPLE:] if decimal in (None, reading[1]) else ()):
            row = _numbers(line, reading)
            if row is None or rows and len(row) != len(rows[0]):
                break
            rows.append(row)
        if rows and (len(rows[0]) > 1 or reading[0] is None) and not numpy.isnan(rows).all():
            found[reading] = rows
    if not found:
        raise ValueError(f"line {lines[-1]!r}: no numbers in columns; a CSV file, AT2, V2, SAC, .npy or .mat is read")
    best = max(found, key=lambda reading: len(found[reading]))
    if best == (",", ".") and (None, ",") in found and decimal is None:  # 0,5 is one number or two
        times = [row[0] for row in found[best]]
        head = "" if _numbers(lines[0], best) else lines[0]
        if "," not in head if head else len(set(times)) < len(times):
            return None, ","
    return best


def _of_text(lines: Sequence[str], delimiter: str | None, decimal: str | None) -> list[Column]:
    comments = {n for n, line in enumerate(lines) if line.lstrip().startswith(COMMENT)}
    numbered = [(n, line.strip().lstrip("#%/ ") if n in comments else line) for n, line in enumerate(lines) if line.strip()]
    plain = [line for n, line in numbered if n not in comments]
    if not plain:
        raise ValueError("is empty; give a file with samples")
    reading = _reading_of(plain, delimiter, decimal)
    count, heads, rows = len(_fields(plain[-1], reading[0])), [], []
    for n, line in numbered:
        values = None if n in comments else _numbers(line, reading)
        if values is not None and len(values) == count:
            rows.append(values)
        elif rows and n not in comments:
            raise ValueError(f"line {n + 1}: {line.strip()!r}: needs {count} numbers; correct or remove the line")
        elif not rows:
            fields = _fields(re.sub(r"\s+(?=[\[(])", "", line) if reading[0] is None else line, reading[0])
            heads += [[field.strip().strip('"') for field in fields]] if len(fields) == count else []
    names, units = heads[-1] if heads else [f"column {n}" for n in range(count)], [""] * count
    if len(heads) > 1 and all(re.fullmatch(r"[\[(].*[\])]", unit) for unit in heads[-1]):
        names, units = heads[-2], [unit[1:-1] for unit in heads[-1]]
    return [_column(*parts) for parts in zip(names, units, numpy.array(rows).T)]


def _column(name: str, unit: str, values: "Array") -> Column:
    """With the unit that stands in brackets, or behind the name: "a [g]", "a_g"."""
    found = IN_BRACKETS.fullmatch(name) or BEHIND.fullmatch(name)
    return Column(found[1].strip(), values, found[2].strip()) if found and not unit else Column(name, values, unit)
