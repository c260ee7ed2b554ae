"""Measured forces and accelerations: samples with their unit, gaps and drift, read from many kinds of files."""

import dataclasses
import os
import pathlib
import re
import warnings
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from . import formats
from .formats.reading import Column
from .formats.tables import NAMES_OF_TIME
from .needed import needed
from .units import KINDS, in_si, is_unit, kind_of, plain_unit

if TYPE_CHECKING:
    import numpy
    Array = numpy.ndarray
numpy = needed("numpy")

COUNTS = re.compile(r"(?:#|unnamed|index|samples?|frames?|points?|number|no|n|i|nr|id|row|count|step|timestep)(?![a-z]).*|",
                    re.IGNORECASE)  # are no times
RAW = ("counts", "count", "v", "mv", "uv")  # units of what a recorder writes
EPOCH = 1e8    # times beyond it [s] count from a date
ABOUT_GRAVITY = (9.7, 9.9)  # factors that make m/s^2 of g
OFFSET = 3     # of the largest integral of an acceleration without its mean, beyond which its mean is in doubt
GAP = 1.5      # steps between two samples, from which on samples are missing
EVEN = 0.01    # of the step, to which all steps of an even record agree
PARTS = 16     # of a record, whose means show its drift
SMALLEST = 64  # samples of which a drift can be found


@dataclasses.dataclass(frozen=True, eq=False)
class Record:
    """Samples of a force, or of an acceleration, over time. Values in g, gal, cm/s^2 and the like become m/s^2.

    Attributes
    ----------
    time, value
        Rising times [s, where the source has a unit of time] and samples [unit], both of the shape (samples,).
    unit
        Such as "m/s^2"; empty where the source has none.
    source
        File, format and column.
    notes
        What was converted or left out, and what looks wrong, in sentences.
    vertical
        Vertical acceleration of the ground at the samples [unit], upwards positive; None where it is 0. It changes the
        normal force, and with it the friction on a block.

    Raises
    ------
    ValueError
        If there are fewer than two samples, a value is no number, or a time does not rise.
    """

    time: "Array"
    value: "Array"
    unit: str = ""
    source: str = ""
    notes: tuple[str, ...] = ()
    vertical: "Array | None" = None

    def __post_init__(self) -> None:
        factor, unit = in_si(self.unit) if kind_of(self.unit) != "time" else (1, self.unit)
        converted = [f"{self.unit} became {unit}: times {factor:g}"] * (factor != 1)
        for name in self._samples:
            values = numpy.asarray(getattr(self, name), float)
            object.__setattr__(self, name, values if factor == 1 or name == "time" else values * factor)
        object.__setattr__(self, "unit", unit)
        if self.time.ndim != 1 or self.time.shape != self.value.shape or len(self.time) < 2:
            raise ValueError(f"time, value: shapes {self.time.shape} and {self.value.shape}; give two arrays of one "
                             "length of at least 2")
        if self.vertical is not None and self.vertical.shape != self.time.shape:
            raise ValueError(f"vertical: shape {self.vertical.shape}; give it at the {len(self.time)} times of the record")
        for name in self._samples:
            if not numpy.isfinite(getattr(self, name)).all():
                n = int(numpy.flatnonzero(~numpy.isfinite(getattr(self, name)))[0])
                raise ValueError(f"{name}[{n}] = {getattr(self, name)[n]}: must be finite; leave the sample out")
        if (numpy.diff(self.time) <= 0).any():
            n = int(numpy.flatnonzero(numpy.diff(self.time) <= 0)[0]) + 1
            raise ValueError(f"time[{n}] = {self.time[n]:g}: must be above time[{n - 1}] = {self.time[n - 1]:g}; sort "
                             "the samples, leave repeated ones out, or name another column of times")
        object.__setattr__(self, "_history", (*self.notes, *converted))
        object.__setattr__(self, "notes", tuple(dict.fromkeys((*self._history, *_findings(self)))))

    @property
    def _samples(self) -> tuple[str, ...]:
        return ("time", "value") if self.vertical is None else ("time", "value", "vertical")

    def _changed(self, note: str = "", **parts: Any) -> "Record":
        """Another record that comes of this one; what looks wrong is looked for anew."""
        return dataclasses.replace(self, notes=(*self._history, *[note] * bool(note)), **parts)

    def __repr__(self) -> str:
        lines = [f"{len(self.time)} samples in {self.duration:g} s, step {self.step:g} s"
                 + ("" if self.even else " (uneven)"),
                 f"mean {self.value.mean():.4g}, standard deviation {self.value.std():.4g} {self.unit}".rstrip(),
                 f"peak {abs(self.value[self.peak]):.5g} {self.unit}".rstrip() + f" at {self.time[self.peak]:g} s"]
        return "\n".join(filter(None, [self.source, *lines, *self.notes]))

    def __len__(self) -> int:
        return len(self.value)

    def __array__(self, dtype: "numpy.dtype | None" = None, copy: bool | None = None) -> "Array":
        """The values, for `numpy.asarray`."""
        found = numpy.asarray(self.value, dtype)
        return found.copy() if copy else found

    @property
    def peak(self) -> int:
        """Number of the first sample of the largest size, from 0."""
        return int(abs(self.value).argmax())

    @property
    def duration(self) -> float:
        """From the first to the last sample [s]."""
        return float(self.time[-1] - self.time[0])

    @property
    def step(self) -> float:
        """Median of the steps between samples [s]."""
        return float(numpy.median(numpy.diff(self.time)))

    @property
    def gaps(self) -> "Array":
        """Ends of the intervals where samples are missing, by [gap, 2] [s]: steps above 1.5 of the median one."""
        at = numpy.flatnonzero(numpy.diff(self.time) > GAP * self.step)
        return numpy.column_stack([self.time[at], self.time[at + 1]])

    @property
    def longest_gap(self) -> tuple[float, float]:
        """Ends of the longest of `gaps`, of which there is at least one [s]."""
        begin, end = max(self.gaps.tolist(), key=lambda gap: gap[1] - gap[0])
        return begin, end

    @property
    def even(self) -> bool:
        """Whether all steps but the gaps agree with `step` to 1 %, or to the digits of the times."""
        steps = numpy.diff(self.time)
        steps = steps[steps <= GAP * self.step]
        return bool((abs(steps - self.step) <= EVEN * self.step + 8 * numpy.spacing(abs(self.time).max())).all())

    @property
    def drift(self) -> tuple[float, float]:
        """Change of the value over the record along a straight line through the means of its 16 parts, and the standard
        error of that change, from how far these means lie off the line [unit]; NaN below 64 samples."""
        if len(self.value) < SMALLEST:
            return numpy.nan, numpy.nan
        middle, means = (numpy.array([part.mean() for part in numpy.array_split(values, PARTS)])
                         for values in (self.time - self.time[0], self.value))
        line, covariance = numpy.polyfit(middle, means, 1, cov=True)
        return float(line[0] * self.duration), float(numpy.sqrt(covariance[0, 0]) * self.duration)

    def stretches(self) -> "list[Array]":
        """The samples between gaps, an array each."""
        at = numpy.flatnonzero(numpy.diff(self.time) > GAP * self.step) + 1
        return numpy.split(self.value, at)

    def between(self, begin: float, end: float) -> "Record":
        """The samples of these times [s], both ends included."""
        inside = (self.time >= begin) & (self.time <= end)
        if inside.sum() < 2:
            raise ValueError(f"between({begin:g}, {end:g}): holds {inside.sum()} samples; take two times in rising order "
                             f"from {self.time[0]:g} to {self.time[-1]:g}")
        return self._changed(**{name: getattr(self, name)[inside] for name in self._samples})

    def scaled(self, factor: float, unit: str = "") -> "Record":
        """All values times a factor, in another unit: `record.scaled(1/9.81, "weight")`; vertical ones times its size. Warns
        where m/s^2 would be taken for g."""
        if not unit:
            warn_of_gravity(self, factor, "scaled", 3)
        return self._changed(f"values were multiplied by {factor:g}", value=self.value * factor, unit=unit or self.unit,
                             vertical=None if self.vertical is None else self.vertical * abs(factor))

    def centred(self) -> "Record":
        """The values less their mean, which is 0 for the acceleration of a ground that rests before and after."""
        mean = self.value.mean()
        return self._changed(f"the mean, {mean:.4g}, was taken off", value=self.value - mean)

    def resampled(self, step: float, across: float = 0) -> "Record":
        """Values at even steps [s], linear between samples; in gaps there are none, but in those of at most `across` s."""
        if not step > 0:
            raise ValueError(f"step = {step}: must be in (0, inf); take for example {self.step:g}")
        time = numpy.arange(self.time[0], self.time[-1] + step * 1e-9, step)
        for low, high in self.gaps:
            if high - low > across * (1 + 1e-9):
                time = time[(time <= low) | (time >= high)]
        return self._changed(f"interpolated to steps of {step:g} s",
                             **{name: numpy.interp(time, self.time, getattr(self, name)) for name in self._samples})

    def rested(self, rest: float) -> "Record":
        """With samples of no force at the end for some seconds, in which a body comes to rest."""
        if not 0 <= rest < numpy.inf:
            raise ValueError(f"rest = {rest}: must be in [0, inf); give the seconds of no force to append")
        time = self.time[-1] + self.step * numpy.arange(1, numpy.ceil(rest / self.step - 1e-9) + 1)
        return self._changed(f"{rest:g} s of no force were appended" if rest else "", **{
            name: numpy.append(getattr(self, name), time if name == "time" else 0 * time) for name in self._samples})

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the file of `-force_file`: a line `time,force` for each sample, and `vertical` where there is such an
        acceleration; the comment below the header states the unit m/s^2. The force on a body is minus the acceleration
        of the ground, `record.scaled(-1)`."""
        head = "time,force" + ",vertical" * (self.vertical is not None) + f"\n# unit: {self.unit}" * (self.unit == "m/s^2")
        numpy.savetxt(path, numpy.column_stack([getattr(self, name) for name in self._samples]), "%.17g", ",", header=head,
                      comments="")


def warn_of_gravity(record: Record, factor: float, name: str, stacklevel: int) -> None:
    """Warn of a factor that takes accelerations in m/s^2 for ones in g."""
    low, high = ABOUT_GRAVITY
    if record.unit == "m/s^2" and low < abs(factor) < high:
        warnings.warn(f"{name}: the values are in m/s^2 already, and {factor:g} times them would be right for g; -1 makes "
                      "the force on a body of the acceleration of the ground", UserWarning, stacklevel=stacklevel)


def read_record(path: str | os.PathLike[str], *, column: int | str | None = None, channel: str | None = None,
                time: int | str | None = None, step: float | None = None, unit: str | None = None,
                time_unit: str | None = None, layout: str | None = None, rest: float = 0, differentiate: bool = False,
                delimiter: str | None = None, decimal: str | None = None) -> Record:
    """Read a measured force or acceleration.

    Text with columns (any separator, decimal comma, header, byte-order mark, times as dates) or with samples in rows; AT2 of
    PEER, COSMOS V0 to V2, CSMIP, GeoNet, SMC, K-NET and KiK-net, CWA, ESM, AFAD, GeoCSV, TSPAIR, SLIST, SAC, .npy, .mat of
    MATLAB 5 to 7 (needs SciPy), MiniSEED (needs ObsPy). Accelerations become m/s^2, with g = 9.80665 m/s^2, and times s;
    `notes` say so.

    Parameters
    ----------
    path
        The file.
    column, time
        Names, or numbers from 0, of the columns (variables, channels) of the values and of the times. Without them times
        are the column that is called so, else the first one if it rises; values are the only other one.
    channel
        Words of the name of a channel, such as "90 Deg" or "N-S", in the place of `column`.
    step
        Sampling interval [s] where the file has no times, or wrong ones.
    unit, time_unit
        Of the values and of the times, in the place of what the file says.
    layout
        Of numbers without names: "rows" of samples, "pairs" of time and sample, or "columns". With the first two a text may
        have several blocks of numbers, a channel each.
    rest
        Seconds of no force that are appended, in which a body comes to rest.
    differentiate
        Take the derivative of a velocity, or the second one of a displacement, by central differences.
    delimiter, decimal
        Separator of columns, and decimal sign, of a text that can be read in two ways.

    Returns
    -------
    record
        Samples that are no numbers are left out and counted in `notes`, as gaps and a significant drift are, values
        without a unit, and accelerations whose mean would leave the ground in motion.

    Raises
    ------
    ValueError
        With the file, the line or the column, and a fix: a file that is not whole, a unit of time that is not known, a
        velocity or displacement without `differentiate`.
    FileNotFoundError, ImportError
        If there is no such file; if a .mat file meets no SciPy, or MiniSEED no ObsPy.

    Source
    ------
    The descriptions of the formats that the files of `stickslip.formats` name.
    """
    if not isinstance(path, (str, os.PathLike)):
        raise TypeError(f"path: must be the name of a file, not {type(path).__name__}; Record(time, value) takes arrays")
    path = pathlib.Path(path)
    if not path.is_file():
        raise FileNotFoundError(f"{path}: no such file")
    if step is not None and not step > 0:
        raise ValueError(f"step = {step}: must be in (0, inf); give the sampling interval in seconds")
    if time_unit is not None and kind_of(time_unit) != "time":
        raise ValueError(f"time_unit = {time_unit}: must be one of {', '.join(KINDS['time'][1])}")
    try:
        form, columns = formats.columns_of(path, layout, delimiter, decimal)
        times = None if step is not None else _time_column(columns, time)
        chosen = _value_column(columns, times, column, channel)
        moments, said = _times(chosen, times, step, time_unit)
        record = _record(chosen, moments, unit, differentiate, f"{path.name}: {form}, column {chosen.name}", said)
    except ValueError as problem:
        raise ValueError(f"{path}: {problem}") from None
    return record.rested(rest)


def _named(columns: Sequence[Column], wanted: int | str, option: str, words: bool = False) -> Column:
    """The column of a name or a number, or of words of its name."""
    text = str(wanted).lower()
    for n, column in enumerate(columns):
        names = (column.name.lower(), f"{column.name} ({column.unit})".lower(), f"{column.name} [{column.unit}]".lower())
        if text in names or text == str(n) and not words:
            return column
    found = [column for column in columns if re.search(rf"(?<!\w){re.escape(text)}(?!\w)", column.name.lower())]
    if len(found) == 1 and not text.isdigit() or len(found) == 1 and words:
        return found[0]
    raise ValueError(f"{option} = {wanted}: there is {'more than one' if len(found) > 1 else 'no'} such column; take one of "
                     f"{_listed(columns)}{_doubt(columns)}")


def _listed(columns: Sequence[Column], without: Column | None = None) -> str:
    return ", ".join(f"{n} ({column.name})" for n, column in enumerate(columns) if column is not without)


def _doubt(columns: Sequence[Column]) -> str:
    return f" ({columns[0].doubt})" if columns[0].doubt else ""


def _time_column(columns: Sequence[Column], wanted: int | str | None) -> Column | None:
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
        raise ValueError(f"{columns[0].name or 'column 0'}: counts samples; give the sampling interval in seconds, as step=0.01, or time=0 "
                         "if these are times")
    return columns[0]


def _value_column(columns: Sequence[Column], times: Column | None, column: int | str | None, channel: str | None) -> Column:
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


def _times(chosen: Column, times: Column | None, step: float | None, unit: str | None) -> "tuple[Array, list[str]]":
    """Times [s] of the samples of a column, and what was done to them."""
    if step is None and times is None and chosen.times is not None:
        times = dataclasses.replace(chosen, values=chosen.times, unit=chosen.time_unit, notes=())
    elif times is None:
        if step is None and not chosen.step:
            raise ValueError(f"step: {chosen.doubt or 'the file has no times'}; give the sampling interval in seconds, as "
                             "step=0.01")
        start, usual = (chosen.start, chosen.step) if chosen.times is None else (chosen.times[0], None)
        other = usual and step not in (None, usual)
        notes = [f"the file says steps of {usual:g} s, and {step:g} s were taken"] if other else []
        return start + (step or usual) * numpy.arange(len(chosen.values)), notes
    if len(times.values) != len(chosen.values):
        raise ValueError(f"time = {times.name}: has {len(times.values)} entries, {chosen.name} has {len(chosen.values)}; name "
                         "columns of one length")
    given = unit or times.unit
    if times.doubt and not unit:
        raise ValueError(f'time_unit: {times.doubt}; give it, as time_unit="s" or time_unit="ms", or the sampling interval, as '
                         "step=0.01")
    if given and kind_of(given) != "time":
        raise ValueError(f'time_unit: {times.name} is in {given}, which is none of {", ".join(KINDS["time"][1])}; give '
                         'time_unit="ms" or the like, or the sampling interval in seconds, as step=0.01')
    factor, first, notes = in_si(given or "s")[0], times.values[0], []
    if not given and abs(first) > 1e3 * EPOCH:
        raise ValueError(f'time_unit: {times.name} begins at {first:.15g} without a unit; give time_unit="ms", "us" or "ns"')
    if times.kind == "date" and unit is None:
        notes.append(f"times are from the first sample, {numpy.datetime64(int(first), 'us')}")
    elif abs(first * factor) > EPOCH:
        notes.append(f"times are from the first sample, {first:.15g} {given or 's'}")
    elif not given:
        notes.append('times are read as seconds, which the file does not say; time_unit="ms" reads others')
    elif factor != 1:
        notes.append(f"{given} became s: times {factor:g}")
    origin = first if times.kind == "date" or abs(first * factor) > EPOCH else 0
    return (times.values - origin) * factor, notes


def _kind(chosen: Column, unit: str | None, differentiate: bool) -> str:
    """What the values of a column are, "" for what is not known. Refuses what is no force or acceleration."""
    given, declared = chosen.unit if unit is None else unit, kind_of(chosen.unit) or chosen.kind
    kind = kind_of(given) or (declared if unit is None else "")
    if unit is not None and kind and declared not in ("", kind):
        raise ValueError(f"unit = {unit}: is one of {kind}, and the file says that {chosen.name} is a {declared}; leave it out")
    moved = kind in ("velocity", "displacement")
    if moved and not differentiate:
        raise ValueError(f"{chosen.name}: is a {kind}, no force or acceleration; differentiate=True takes its "
                         f"{'' if kind == 'velocity' else 'second '}derivative, or take the file of the acceleration")
    if chosen.kind not in ("", *KINDS):
        raise ValueError(f"{chosen.name}: is a {chosen.kind}, no force or acceleration over time; take another file")
    if differentiate and not moved:
        raise ValueError(f'differentiate: {chosen.name} is no velocity or displacement; leave it out, or say unit="cm/s"')
    if differentiate and not kind_of(given):
        raise ValueError(f'unit: the file does not say the unit of the {kind}; give it, as unit="m/s" or unit="cm"')
    if given and kind == "acceleration" and not kind_of(given) and not is_unit(given):
        raise ValueError(f'unit: {given} is no unit of an acceleration that is known; give it, as unit="cm/s^2"')
    return kind


def _record(chosen: Column, time: "Array", unit: str | None, differentiate: bool, source: str,
            said: Sequence[str]) -> Record:
    """The record of a column, in SI units where it has units."""
    kind, given, notes = _kind(chosen, unit, differentiate), chosen.unit if unit is None else unit, [*chosen.notes, *said]
    factor, standard = in_si(given) if kind_of(given) not in ("", "time") else (1, given)
    if not given:
        notes.append('no unit is named: values are as in the file; unit="g" makes m/s^2 of g')
    elif plain_unit(given) in RAW or not is_unit(given):
        notes.append(f"{given} is none of {', '.join(KINDS['acceleration'][1])}: values are as in the file; "
                     'scaled(factor, "m/s^2") converts them')
    if unit is not None and chosen.unit and plain_unit(unit) != plain_unit(chosen.unit):
        notes.append(f"the file says {chosen.unit}, and was taken to be in {unit}")
    if factor != 1:
        notes.append(f"{given} became {standard}: times {factor:g}")
    values = factor * chosen.values
    notes += _marks(chosen.values)
    known = numpy.isfinite(values) & numpy.isfinite(time)
    if not known.all():
        notes.append(f"{(~known).sum()} samples are no numbers and were left out")
    record = Record(time[known], values[known], standard, source)
    for _ in range(("velocity", "displacement").index(kind) + 1 if differentiate else 0):
        record = dataclasses.replace(record, value=numpy.gradient(record.value, record.time), unit="m/s^2")
    notes += [f"the {kind} was differentiated by central differences"] if differentiate else []
    return dataclasses.replace(record, notes=tuple(notes))


def _marks(values: "Array") -> list[str]:
    """A sentence on values that probably mark missing ones: such as 9999 or -999.25, far beyond all others."""
    sizes = abs(values[numpy.isfinite(values)])
    largest = sizes.max(initial=0)
    if not re.fullmatch(r"9{3,}(\.9+|\.25)?", f"{largest:.10g}") or (sizes[sizes < largest] > largest / 10).any():
        return []
    return [f"{(sizes == largest).sum()} samples are {largest:g} in size, as marks of missing ones are: nan in their place leaves "
            "them out"]


def _findings(record: Record) -> list[str]:
    """What looks wrong with a record, in sentences."""
    found = []
    if len(record.gaps):
        lengths, (begin, end) = numpy.diff(record.gaps), record.longest_gap
        appended = end == record.time[-1] and record.value[-1] == 0
        found.append(f"{len(lengths)} gaps of {lengths.sum():g} s in all, the longest from {begin:g} to {end:g} s"
                     + (f": rest={end - begin:g} in the place of the last sample appends no force" if appended else ""))
    if not record.even:
        steps = numpy.diff(record.time)
        found.append(f"steps are uneven, from {steps.min():g} to {steps.max():g} s: resampled() makes them even")
    drift, error = record.drift
    if abs(drift) > 4 * error:
        found.append(f"the value drifts by {drift:.3g} +- {error:.1g} {record.unit}".rstrip() + " from begin to end")
    if record.unit == "m/s^2":
        steps, time = numpy.diff(record.time), record.time - record.time[0]
        speed = numpy.append(0, numpy.cumsum(steps * (record.value[1:] + record.value[:-1]) / 2))
        largest = abs(speed - speed[-1] * time / time[-1]).max()
        if abs(speed[-1]) > OFFSET * largest:
            found.append(f"its integral ends at {speed[-1]:.3g} m/s, and would reach {largest:.3g} m/s without its mean: a "
                         "ground that comes to rest has none; centred() takes it off")
    return found
