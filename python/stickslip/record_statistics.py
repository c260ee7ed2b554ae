"""Autocorrelation and spectrum of a record, and whether it is steady."""

import dataclasses
import math
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from .chains import Meant
from .needed import needed
from .records import Record

if TYPE_CHECKING:
    import numpy
    Array = numpy.ndarray
numpy, signal, integrate = needed("numpy"), needed("scipy.signal"), needed("scipy.integrate")

MEMORIES = 12     # integrals of the squared autocorrelation after which a record is taken for uncorrelated
SWING = 0.1       # of the autocorrelation below zero, beside three standard errors
MATCH = 1.1       # factor to the record beyond which there is a note, if that is significant
UNSTEADY = 2.0    # factor between deviations of quarters of a record
BLOCKS = 8        # of a record, of which errors are estimated by leaving out one


@dataclasses.dataclass(frozen=True, eq=False)
class Memory:
    """Autocorrelation of a record at multiples of its step until `longest`, with its standard error where none is left."""

    step: float
    rho: "Array"
    error: float
    variance: float
    duration: float

    @property
    def time(self) -> "Array":
        return self.step * numpy.arange(len(self.rho))

    @property
    def half_swing(self) -> float:
        """The time of the least autocorrelation, which is half a period where it swings."""
        return float(self.time[max(int(self.rho.argmin()), 1)])

    def integral(self, f: "Array") -> float:
        """Of values at `time`, by the trapezoidal rule."""
        return float(integrate.trapezoid(f, dx=self.step))


def memory_of(record: Record, longest: float | None = None, without: int | None = None) -> Memory:
    """The autocorrelation within stretches without gaps, perhaps without one of the blocks of the record.

    Raises ValueError where steps are uneven, the value does not change, or the record is short beside its memory.
    """
    if not isinstance(record, Record):
        raise TypeError(f"record: is a {type(record).__name__}; stickslip.read_record(path) reads a file, and "
                        "stickslip.Record(time, value) takes arrays")
    if not record.even:
        steps = numpy.diff(record.time)
        raise ValueError(f"record: steps from {steps.min():g} to {steps.max():g} are uneven; take "
                         f"record.resampled({record.step:g})")
    pieces = [piece - record.value.mean() for piece in record.stretches()]
    if without is not None:
        blocks = [block for piece in pieces for block in numpy.array_split(
            piece, max(round(BLOCKS * len(piece) / len(record.value)), 1))]
        pieces = [block for n, block in enumerate(blocks) if n % BLOCKS != without]
    lags = max(map(len, pieces)) // 2
    products, pairs = numpy.zeros(lags), numpy.zeros(lags)
    for piece in pieces:
        count = min(lags, len(piece))
        products[:count] += signal.correlate(piece, piece, method="fft")[len(piece) - 1:len(piece) - 1 + count]
        pairs[:count] += numpy.maximum(len(piece) - numpy.arange(count), 0)
    if not products[0] > 0 or lags < 2:
        raise ValueError(f"record: {len(record.value)} samples that do not change; give one that does")
    rho = products / numpy.maximum(pairs, 1) * pairs[0] / products[0]
    squares = record.step * (numpy.cumsum(rho**2) - 0.5)
    last = int(numpy.argmax(record.step * numpy.arange(lags) >= MEMORIES * squares))
    last = min(round(longest / record.step), lags - 1) if longest else last
    if last < 1:
        raise ValueError(f"record: lasts {record.step * pairs[0]:g}, which is less than twice its memory; take a longer "
                         "one, or a number for `longest`, the time beyond which it is uncorrelated")
    duration = record.step * pairs[0]
    return Memory(record.step, rho[:last + 1], math.sqrt(2 * squares[last] / duration), products[0] / pairs[0], duration)


def jackknife(parts: "Sequence[Memory]", best: "Callable[[Memory], Array]") -> "Array":
    """Standard errors of numbers found of a record, from those found without each of its blocks."""
    found = numpy.array([best(part) for part in parts])
    return numpy.sqrt((BLOCKS - 1) / BLOCKS * ((found - found.mean(axis=0)) ** 2).sum(axis=0))


def spectrum_of(record: Record, memory: Memory) -> "tuple[Array, Array]":
    """Angular frequencies and spectrum of the record, two-sided (Welch 1967), in windows of four times its memory."""
    window = min(max(4 * len(memory.rho), 16), max(map(len, record.stretches())))
    total, weight = 0.0, 0
    for piece in record.stretches():
        if len(piece) >= window:
            frequencies, power = signal.welch(piece - record.value.mean(), 1 / record.step, nperseg=window)
            total, weight = total + len(piece) * power, weight + len(piece)
    return 2 * math.pi * frequencies[1:], total[1:] / weight / 2


def measured(memory: Memory, frequencies: "Array", power: "Array") -> Meant:
    """What a record shows of the covariance, until `longest`, and of the spectrum."""
    return Meant(lambda t: memory.variance * numpy.interp(t, memory.time, memory.rho, right=numpy.nan),
                 lambda w: numpy.interp(w, frequencies, power, left=numpy.nan, right=numpy.nan), "record")


def unsteady(record: Record) -> list[str]:
    """A sentence on a record whose deviation changes along it."""
    quarters = [part.std() for part in numpy.array_split(record.value, 4)]
    if max(quarters) < UNSTEADY * min(quarters):
        return []
    return [f"the deviation goes from {max(quarters):.3g} to {min(quarters):.3g} along the record, that of a chain stays: "
            "the begin and end of a shaking are not represented; take a part by record.between()"]
