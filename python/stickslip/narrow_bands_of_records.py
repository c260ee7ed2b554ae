"""Narrow bands of measured records."""

import dataclasses
import math
import warnings
from typing import TYPE_CHECKING

from .chains import Chain
from .chains_by_name import narrow_band, positive
from .needed import needed
from .record_statistics import BLOCKS, MATCH, SWING, Memory, measured, memory_of, spectrum_of, unsteady
from .records import Record

if TYPE_CHECKING:
    import numpy
    Array = numpy.ndarray
numpy, optimize = needed("numpy"), needed("scipy.optimize")


def narrow_band_of(record: Record, delta: float | None = None, *, longest: float | None = None) -> Chain:
    """The narrow band whose covariance s^2 exp(-gamma t) cos(omega t) is closest to that of a record, by least squares.

    Parameters
    ----------
    record
        With even steps; gaps are skipped. Its mean becomes a shift of the force.
    delta
        Step of the lattice [unit of the record]; by default half the deviation.
    longest
        Time up to which the autocorrelation is fitted; by default 12 times the integral of its square.

    Returns
    -------
    chain
        `noise.narrow_band` with a note on s, gamma and omega and their standard errors, found by leaving out each of 8
        blocks of the record (jackknife), and on a deviation that changes along the record.

    Raises
    ------
    ValueError
        If the autocorrelation does not swing, or leaves that of a narrow band by more than 0.1 and three of its standard
        errors.

    Warns
    -----
    UserWarning
        Where the deviation changes by more than 2 from quarter to quarter of the record, or the lattice adds 10 % to it.
    """
    whole = memory_of(record, longest)

    def fitted(memory: Memory) -> "Array":
        first = memory.time[max(int(memory.rho.argmin()), 1)]
        try:
            found, _ = optimize.curve_fit(lambda t, gamma, omega: numpy.exp(-gamma * t) * numpy.cos(omega * t), memory.time,
                                          memory.rho, (3 / memory.time[-1], math.pi / first))
        except RuntimeError:
            raise ValueError("record: no narrow band comes close to its autocorrelation; take a longer record") from None
        return numpy.array([math.sqrt(memory.variance), *abs(found)])

    if -whole.rho.min() < 3 * whole.error:
        raise ValueError("record: its autocorrelation does not swing; noise.record(record) makes a chain of levels")
    deviation, gamma, omega = best = fitted(whole)
    off = abs(whole.rho - numpy.exp(-gamma * whole.time) * numpy.cos(omega * whole.time)).max()
    if off > SWING + 3 * whole.error:
        raise ValueError(f"record: its autocorrelation leaves that of a narrow band by {off:.2f}; several bands, or a "
                         "shaking that begins and ends, are no single narrow band: filter it, or take record.between()")
    parts = numpy.array([fitted(memory_of(record, whole.time[-1], n)) for n in range(BLOCKS)])
    errors = numpy.sqrt((BLOCKS - 1) / BLOCKS * ((parts - parts.mean(axis=0)) ** 2).sum(axis=0))
    step = deviation / 2 if delta is None else delta
    positive(delta=step)
    chain = narrow_band(*best, step) + float(record.value.mean())
    notes = (*unsteady(record), *(chain.notes if chain.deviation > MATCH * deviation else ()))
    for note in notes:
        warnings.warn(note, UserWarning, stacklevel=2)
    said = ", ".join(f"{name} {value:.4g} +- {error:.1g}" for name, value, error in zip(
        ("deviation", "gamma", "omega"), best, errors))
    return dataclasses.replace(chain, name=f"narrow band of {record.source or 'a record'}", notes=(
        said, *unsteady(record), *chain.notes), meant=measured(whole, *spectrum_of(record, whole)))
