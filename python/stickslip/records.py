"""Measured forces and accelerations: samples with their unit, gaps and drift, read from many kinds of files."""

import dataclasses
import os
import pathlib
import re
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from . import formats
from .formats import choice
from .formats.reading import Column
from .needed import needed
from .program import warn
from .units import KINDS, in_si, is_unit, kind_of, plain_unit

if TYPE_CHECKING:
    import numpy
    Array = numpy.ndarray
numpy = needed("numpy")

RAW = ("counts", "count", "v", "mv", "uv")  # units of what a recorder writes
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
            warn_of_gravity(self, factor, "scaled")
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
        """With samples of no force at the end for some seconds, in which a body comes to rest; they take the place of a single
        one that stands behind a gap."""
        if not 0 <= rest < numpy.inf:
            raise ValueError(f"rest = {rest}: must be in [0, inf); give the seconds of no force to append")
        held = slice(-1 if rest and self._appended else None)
        time = self.time[held][-1] + self.step * numpy.arange(1, numpy.ceil(rest / self.step - 1e-9) + 1)
        return self._changed(f"{rest:g} s of no force were appended" if rest else "", **{
            name: numpy.append(getattr(self, name)[held], time if name == "time" else 0 * time) for name in self._samples})

    @property
    def _appended(self) -> bool:
        """Whether the last sample is a single one of no force behind a gap."""
        return bool(len(self.gaps) and self.gaps[-1, 1] == self.time[-1] and self.value[-1] == 0)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the file of `-force_file`: a line `time,force` for each sample, and `vertical` where there is such an
        acceleration; the comment below the header states the unit m/s^2. The force on a body is minus the acceleration
        of the ground, `record.scaled(-1)`."""
        head = "time,force" + ",vertical" * (self.vertical is not None) + f"\n# unit: {self.unit}" * (self.unit == "m/s^2")
        numpy.savetxt(path, numpy.column_stack([getattr(self, name) for name in self._samples]), "%.17g", ",", header=head,
                      comments="")


def warn_of_gravity(record: Record, factor: float, name: str) -> None:
    """Warn of a factor that takes accelerations in m/s^2 for ones in g."""
    low, high = ABOUT_GRAVITY
    if record.unit == "m/s^2" and low < abs(factor) < high:
        warn(f"{name}: the values are in m/s^2 already, and {factor:g} times them would be right for g; -1 makes the force on "
             "a body of the acceleration of the ground")


def read_record(path: str | os.PathLike[str], *, column: int | str | None = None, channel: str | None = None,
                time: int | str | None = None, step: float | None = None, unit: str | None = None,
                time_unit: str | None = None, layout: str | None = None, rest: float = 0, differentiate: bool = False,
                delimiter: str | None = None, decimal: str | None = None) -> Record:
    """Read a measured force or acceleration.

    Text with columns (any separator, decimal comma, header, byte-order mark, times as dates) or with samples in rows; AT2 of
    PEER, COSMOS V0 to V2, CSMIP, GeoNet, SMC, K-NET and KiK-net, CWA, ESM, AFAD, CSMNC, GeoCSV, TSPAIR, SLIST, SAC, .npy,
    .mat of MATLAB 5 to 7 (needs SciPy), MiniSEED (needs ObsPy). Accelerations become m/s^2, with g = 9.80665 m/s^2, and
    times s; `notes` say so.

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
        times = None if step is not None else choice.time_column(columns, time)
        chosen = choice.value_column(columns, times, column, channel)
        moments, said = choice.times_of(chosen, times, step, time_unit)
        record = _record(chosen, moments, unit, differentiate, f"{path.name}: {form}, column {chosen.name}", said)
    except ValueError as problem:
        raise ValueError(f"{path}: {problem}") from None
    return record.rested(rest)


def _record(chosen: Column, time: "Array", unit: str | None, differentiate: bool, source: str, said: Sequence[str]) -> Record:
    """The record of a column."""
    kind, given = choice.kind_of_values(chosen, unit, differentiate), chosen.unit if unit is None else unit
    notes = [*chosen.notes, *said, *_marks(chosen.values)]
    if not given:
        notes.append('no unit is named: values are as in the file; unit="g" makes m/s^2 of g')
    elif plain_unit(given) in RAW or not is_unit(given):
        notes.append(f"{given} is none of {', '.join(KINDS['acceleration'][1])}: values are as in the file; "
                     'scaled(factor, "m/s^2") converts them')
    if unit is not None and chosen.unit and plain_unit(unit) != plain_unit(chosen.unit):
        notes.append(f"the file says {chosen.unit}, and was taken to be in {unit}")
    known = numpy.isfinite(chosen.values) & numpy.isfinite(time)
    if not known.all():
        notes.append(f"{(~known).sum()} samples are no numbers and were left out")
    record = Record(time[known], chosen.values[known], given, source, tuple(notes))
    for _ in range(("velocity", "displacement").index(kind) + 1 if differentiate else 0):
        record = record._changed(value=numpy.gradient(record.value, record.time), unit="m/s^2")
    return record._changed(f"the {kind} was differentiated by central differences") if differentiate else record


def _marks(values: "Array") -> list[str]:
    """A sentence on values that probably mark missing ones: such as 9999 or -999.25, far beyond all others."""
    sizes = abs(values[numpy.isfinite(values)])
    largest = sizes.max(initial=0)
    if not re.fullmatch(r"9{3,}(\.9+|\.25)?", f"{largest:.10g}") or (sizes[sizes < largest] > largest / 10).any():
        return []
    return [f"{(sizes == largest).sum()} samples are {largest:g} in size, as marks of missing ones are: nan in their place "
            "leaves them out"]


def _findings(record: Record) -> list[str]:
    """What looks wrong with a record, in sentences."""
    found = []
    if len(record.gaps):
        lengths, (begin, end) = numpy.diff(record.gaps), record.longest_gap
        found.append(f"{len(lengths)} gaps of {lengths.sum():g} s in all, the longest from {begin:g} to {end:g} s"
                     + f": rest={lengths[-1, 0]:g} appends no force in the place of the last sample" * record._appended)
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
