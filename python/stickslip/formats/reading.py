"""What descriptions of record formats share: columns, signs of a format, and numbers of a Fortran format."""

import dataclasses
import datetime
import itertools
import re
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from ..needed import needed

if TYPE_CHECKING:
    import numpy
    Array = numpy.ndarray
numpy = needed("numpy")

NUMBER = r"[-+]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eEdD][-+]?\d+)?"  # in one way only, for the sake of time
NUMBERS = re.compile(rf"\s*{NUMBER}(?:(?:\s+|(?=[-+])){NUMBER})*\s*")  # "1.5-2.5" are two, as Fortran writes them
ONE = re.compile(NUMBER)
TOUCHING = re.compile(r"(?<=[\d.])(?=[-+])")
DATE = re.compile(r"\d{4}[-/]\d\d[-/]\d\d(?:[T -]\d\d:\d\d.*)?")
FLAGS = re.IGNORECASE | re.MULTILINE
KINDS = {"acc": "acceleration", "vel": "velocity", "dis": "displacement"}


@dataclasses.dataclass(frozen=True, eq=False)
class Column:
    """Numbers with what the file says of them.

    Attributes
    ----------
    name, values, unit
        As in the file; the name of a channel has its direction.
    step, start, times, time_unit
        Sampling interval and first time [s], or all times [time_unit], where the format has them.
    kind
        One of `stickslip.units.KINDS`, where the format says it.
    doubt
        Why neither step nor unit of time is known, in words that name what to give.
    notes
        What was done to the values.
    """

    name: str
    values: "Array"
    unit: str = ""
    step: float | None = None
    start: float = 0
    times: "Array | None" = None
    time_unit: str = "s"
    kind: str = ""
    doubt: str = ""
    notes: tuple[str, ...] = ()


@dataclasses.dataclass(frozen=True, eq=False)
class Format:
    """A format of text: what a file of it has, as patterns by their descriptions, and how its lines are read.

    `read` takes the lines and returns columns; it raises ValueError where they do not hold what their header says.
    """

    name: str
    signs: dict[str, str]
    read: Callable[[list[str]], list[Column]]

    def missing(self, words: str) -> list[str]:
        """Descriptions of the signs that are not in the lines with words."""
        return [what for what, pattern in self.signs.items() if not re.search(pattern, words, FLAGS)]


def numeric(line: str) -> bool:
    """Whether a line has digits, and nothing but what numbers are written with."""
    return re.fullmatch(r"[\s\d.+*eEdD-]*\d[\s\d.+*eEdD-]*", line) is not None


def block(lines: Sequence[str], at: int) -> list[str]:
    """The lines of numbers from a place on, up to the next line with words."""
    return list(itertools.takewhile(numeric, lines[at:]))


def rows(lines: Sequence[str], form: str = "") -> list[list[str]]:
    """The numbers of each line, as text: split at blanks and signs, or where they touch by the decimals or the width of a
    Fortran format such as 8F10.5. The decimals also part numbers that overflow their width."""
    fixed = re.search(r"[IFEDG](\d+)", form, re.IGNORECASE)
    decimals = re.search(r"F\d+\.([1-9]\d*)", form, re.IGNORECASE)
    part = rf"\s*([-+]?\d*\.\d{{{decimals[1]}}})" if decimals else ""
    found = []
    for line in lines:
        pieces = TOUCHING.sub(" ", line).split()
        if part and re.fullmatch(rf"(?:{part})+\s*", line):
            pieces = re.findall(part, line)
        elif fixed:
            width = int(fixed[1])
            cut = [line[n:n + width].strip() for n in range(0, len(line.rstrip()), width)]
            whole = all(map(ONE.fullmatch, cut))
            pieces = cut if whole and len(cut) >= len(pieces) else pieces
        if not all(map(ONE.fullmatch, pieces)):
            raise ValueError(f"line {line.strip()[:60]!r}: has more than numbers" + (f" of the format {form}" if form else ""))
        found.append(pieces)
    return found


def numbers(lines: Sequence[str], form: str = "") -> "Array":
    """The numbers of `rows`, one after the other."""
    return numpy.array([piece.lower().replace("d", "e") for row in rows(lines, form) for piece in row], float)


def table(lines: Sequence[str], wide: int, form: str = "") -> "list[Array]":
    """Columns of lines of as many numbers each."""
    for line, row in zip(lines, rows(lines, form)):
        if len(row) != wide:
            raise ValueError(f"line {line.strip()[:60]!r}: needs {wide} numbers")
    return list(numbers(lines, form).reshape(-1, wide).T)


def counted(values: "Array", count: int, what: str = "its header") -> "Array":
    """The values, if there are as many as announced."""
    if len(values) != count:
        raise ValueError(f"holds {len(values)} of the {count} samples that {what} announces")
    return values


def pairs(name: str, values: "Array", unit: str, kind: str) -> Column:
    """Of pairs of time [s] and value. Times are rounded in the file: of samples at one time the first one is kept."""
    times, values = values[::2], values[1::2]
    kept = numpy.append(True, numpy.diff(times) != 0)
    notes = (f"{(~kept).sum()} samples at the times of others, which are rounded, were left out",) if not kept.all() else ()
    return Column(name, values[kept], unit, times=times[kept], kind=kind, notes=notes)


def lasting(step: float, count: int, seconds: float, within: float) -> str:
    """Why a sampling interval is in doubt: with it the samples do not last as long as stated. "" if they do."""
    if step > 0 and abs(step * count - seconds) <= within:
        return ""
    return f"a sampling interval of {step:g} s does not make {count} samples last {seconds:g} s, as the header says"


def data_of(lines: Sequence[str]) -> list[str]:
    """The lines from the first one of numbers on, without empty ones."""
    return [line for line in itertools.dropwhile(lambda line: not numeric(line), lines) if line.strip()]


def kind_in(words: str) -> str:
    """The kind that words such as "Corrected accelerogram" name; "" if none."""
    found = re.search(r"\b(?:acc(?=\b|el)|vel(?=\b|oc)|dis(?=\b|p))", words, re.IGNORECASE)
    return KINDS[found[0].lower()] if found else ""


def microseconds(text: str) -> int:
    """A date and time, such as 2001-01-31T23:59:58.5Z, in microseconds since 1970; without a zone it is UTC."""
    plain = re.sub(r"^(\d+)[-/](\d+)[-/](\d+)[T -]?", r"\1-\2-\3T", text.strip()).rstrip("T").replace(" UTC", "Z")
    moment = datetime.datetime.fromisoformat(plain)
    moment = moment if moment.tzinfo else moment.replace(tzinfo=datetime.timezone.utc)
    return (moment - datetime.datetime(1970, 1, 1, tzinfo=datetime.timezone.utc)) // datetime.timedelta(microseconds=1)
