"""Which columns of a file are its values and times, in what units, and what they are."""

import dataclasses
import re
from collections.abc import Sequence
from typing import TYPE_CHECKING

from ..needed import needed
from ..units import KINDS, in_si, is_unit, kind_of
from .reading import Column
from .tables import NAMES_OF_TIME

if TYPE_CHECKING:
    import numpy
    Array = numpy.ndarray
numpy = needed("numpy")

COUNTS = re.compile(r"(?:#|unnamed|index|samples?|frames?|points?|number|no|n|i|nr|id|row|count|ticks?|step|timestep)(?![a-z]).*|",
                    re.IGNORECASE)  # are no times
EPOCH = 1e8  # times beyond it [s] count from a date


def _named(columns: Sequence[Column], wanted: int | str, option: str, words: bool = False) -> Column:
    """The column of a name or a number, or of words of its name."""
    text = str(wanted).lower()
    for n, column in enumerate(columns):
        names = (column.name.lower(), f"{column.name} ({column.unit})".lower(), f"{column.name} [{column.unit}]".lower())
        if text in names or text == str(n) and not words:
            return column
    found = [column for column in columns if re.search(rf"(?<!\w){re.escape(text)}(?!\w)", column.name.lower())]
    if len(found) == 1 and (words or not text.isdigit()):
        return found[0]
    raise ValueError(f"{option} = {wanted}: there is {'more than one' if len(found) > 1 else 'no'} such column; take one of "
                     f"{_listed(columns)}{_doubt(columns)}")


def _listed(columns: Sequence[Column], without: Column | None = None) -> str:
    return ", ".join(f"{n} ({column.name})" for n, column in enumerate(columns) if column is not without)


def _doubt(columns: Sequence[Column]) -> str:
    return f" ({columns[0].doubt})" if columns[0].doubt else ""


def time_column(columns: Sequence[Column], wanted: int | str | None) -> Column | None:
    """The column of times: the one that is wanted, is called so or has such a unit, or the first one if it rises."""
    if wanted is not None:
        return _named(columns, wanted, "time")
    if any(column.step or column.times is not None for column in columns):
        return None
    if any(re.match("period|freq", column.name, re.IGNORECASE) for column in columns[:1]):
        raise ValueError(f"{columns[0].name}: a spectrum is no force or acceleration over time; take another file, or give "
                         "time= or step=")
    rising = [column for column in columns if (numpy.diff(column.values) > 0).all()]
    for column in (*rising, *columns):
        if column.name.lower() in NAMES_OF_TIME or column in rising and kind_of(column.unit) == "time":
            return column
    if len(columns) < 2 or columns[0] not in rising:
        return None
    if COUNTS.fullmatch(columns[0].name):
        raise ValueError(f"{columns[0].name or 'column 0'}: counts samples; give the sampling interval in seconds, as "
                         "step=0.01, or time=0 if these are times")
    return columns[0]


def value_column(columns: Sequence[Column], times: Column | None, column: int | str | None, channel: str | None) -> Column:
    """The column of values: the one that is wanted, or the only one beside the times."""
    if column is not None and channel is not None:
        raise ValueError(f"column = {column}, channel = {channel}: name the same; give one of them")
    if channel is not None:
        return _named(columns, channel, "channel", words=True)
    if column is not None:
        return _named(columns, column, "column")
    others = [column for column in columns if column is not times]
    if len(others) == 1:
        return others[0]
    raise ValueError(f"column: there are {len(others)} columns of values; take one of {_listed(columns, times)}"
                     + _doubt(columns))


def times_of(chosen: Column, times: Column | None, step: float | None, unit: str | None) -> "tuple[Array, list[str]]":
    """Times [s] of the samples of a column, and what was done to them."""
    if step is not None or times is None and chosen.times is None:
        if not (step or chosen.step):
            raise ValueError(f"step: {chosen.doubt or 'the file has no times'}; give the sampling interval in seconds, as "
                             "step=0.01")
        other = step and chosen.step not in (None, step)
        notes = [f"the file says steps of {chosen.step:g} s, and {step:g} s were taken"] if other else []
        start = chosen.start if chosen.times is None else chosen.times[0]
        return start + (step or chosen.step) * numpy.arange(len(chosen.values)), notes
    times = times or dataclasses.replace(chosen, values=chosen.times, unit=chosen.time_unit, notes=())
    given, first = unit or times.unit, times.values[0]
    if len(times.values) != len(chosen.values):
        raise ValueError(f"time = {times.name}: has {len(times.values)} entries, {chosen.name} has {len(chosen.values)}; name "
                         "columns of one length")
    if times.doubt and not unit:
        raise ValueError(f'time_unit: {times.doubt}; give it, as time_unit="s" or time_unit="ms", or the sampling interval, as '
                         "step=0.01")
    if given and kind_of(given) != "time":
        raise ValueError(f'time_unit: {times.name} is in {given}, which is none of {", ".join(KINDS["time"][1])}; give '
                         'time_unit="ms" or the like, or the sampling interval in seconds, as step=0.01')
    if not given and abs(first) > 1e3 * EPOCH:
        raise ValueError(f'time_unit: {times.name} begins at {first:.15g} without a unit; give time_unit="ms", "us" or "ns"')
    factor = in_si(given or "s")[0]
    dated, distant = times.kind == "date", abs(first * factor) > EPOCH
    if dated and unit is None or distant:
        begin = numpy.datetime64(int(first), "us") if dated and unit is None else f"{first:.15g} {given or 's'}"
        note = f"times are from the first sample, {begin}"
    elif not given:
        note = 'times are read as seconds, which the file does not say; time_unit="ms" reads others'
    else:
        note = f"{given} became s: times {factor:g}" if factor != 1 else ""
    return (times.values - (first if dated or distant else 0)) * factor, [note] * bool(note)


def kind_of_values(chosen: Column, unit: str | None, differentiate: bool) -> str:
    """What the values of a column are, "" for what is not known. Refuses what is no force or acceleration."""
    given, declared = chosen.unit if unit is None else unit, kind_of(chosen.unit) or chosen.kind
    kind = kind_of(given) or (declared if unit is None else "")
    moved = kind in ("velocity", "displacement")
    if unit is not None and kind and declared not in ("", kind):
        raise ValueError(f"unit = {unit}: is one of {kind}, and the file says that {chosen.name} is a {declared}; leave it out")
    if moved and not differentiate:
        way = "differentiate=True" if kind_of(given) else "differentiate=True with unit="
        raise ValueError(f"{chosen.name}: is a {kind}, no force or acceleration; {way} takes its "
                         f"{'' if kind == 'velocity' else 'second '}derivative, or take the file of the acceleration")
    if chosen.kind not in ("", *KINDS):
        raise ValueError(f"{chosen.name}: is a {chosen.kind}, no force or acceleration over time; take another file")
    if differentiate and not moved:
        raise ValueError(f'differentiate: {chosen.name} is no velocity or displacement; leave it out, or say unit="cm/s"')
    if differentiate and not kind_of(given):
        raise ValueError(f'unit: the file does not say the unit of the {kind}; give it, as unit="m/s" or unit="cm"')
    if given and kind == "acceleration" and not is_unit(given):
        raise ValueError(f'unit: {given} is no unit of an acceleration that is known; give it, as unit="cm/s^2"')
    return kind
