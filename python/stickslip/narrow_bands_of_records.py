"""Narrow bands of measured records."""

import dataclasses
import math
import warnings

from .chains import Chain
from .chains_by_name import narrow_band, positive
from .needed import needed
from .record_statistics import MATCH, SWING, Memory, jackknife, measured, memory_of, spectrum_of, unsteady
from .records import Record
from .ways_of_records import Unfit, advised

numpy, optimize = needed("numpy"), needed("scipy.optimize")


@dataclasses.dataclass(frozen=True)
class Band:
    """The covariance s^2 exp(-gamma t) cos(omega t) of a record, as `-noise narrow_band` takes it.

    Attributes
    ----------
    deviation, gamma, omega
        Standard deviation s [force], half width and angular frequency of the band [1/time].
    errors
        Their standard errors, in this order, found by leaving out each of 8 blocks of the record (jackknife).
    """

    deviation: float
    gamma: float
    omega: float
    errors: tuple[float, float, float]

    def __str__(self) -> str:
        return ", ".join(f"{name} {getattr(self, name):.4g} +- {error:.1g}" for name, error in zip(
            ("deviation", "gamma", "omega"), self.errors))

    @property
    def swing(self) -> float:
        """How far the autocorrelation falls below 0: -exp(-gamma t) cos(omega t) where that is largest."""
        late = math.atan2(self.gamma, self.omega)
        return math.exp(-self.gamma * (math.pi - late) / self.omega) * math.cos(late) if self.omega else 0.0


@advised
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
        `noise.narrow_band`; `fit` is the `Band`, which the first note says, and another one names a deviation that
        changes along the record.

    Raises
    ------
    ValueError
        If the autocorrelation leaves that of a narrow band by more than 0.1 and three of its standard errors. If it does
        not swing: the omega of the band is less than three standard errors, or so small that its spectrum is largest at 0;
        or neither does the autocorrelation fall below 0 by three standard errors, nor that of the band by 0.1.

    Warns
    -----
    UserWarning
        Where the deviation changes by more than 2 from quarter to quarter of the record, or the lattice adds 10 % to it;
        where a record is so short that the swing of its autocorrelation is less than three standard errors.
    """
    whole = memory_of(record, longest)
    band = _fitted(record, whole)
    off = abs(whole.rho - numpy.exp(-band.gamma * whole.time) * numpy.cos(band.omega * whole.time)).max()
    if off > SWING + 3 * whole.error:
        raise Unfit(f"record: its autocorrelation leaves that of a narrow band by {off:.2f}; several bands, or a shaking "
                    "that begins and ends, are no single narrow band")
    unsure = -whole.rho.min() < 3 * whole.error
    least = max(3 * band.errors[2], band.gamma / math.sqrt(3))
    if band.omega < least or unsure and band.swing < SWING:
        raise Unfit(f"record: its autocorrelation does not swing, or the record is too short to show it: omega is "
                    f"{band.omega:.3g} +- {band.errors[2]:.1g}")
    step = band.deviation / 2 if delta is None else delta
    positive(delta=step)
    chain = narrow_band(band.deviation, band.gamma, band.omega, step) + float(record.value.mean())
    doubts = (*unsteady(record), *[f"its autocorrelation swings to {whole.rho.min():.2f}, which is less than three standard "
                                   "errors; a longer record would tell"] * bool(unsure))
    for note in (*doubts, *(chain.notes if chain.deviation > MATCH * band.deviation else ())):
        warnings.warn(note, UserWarning, stacklevel=3)
    return dataclasses.replace(chain, name=f"narrow band of {record.source or 'a record'}", fit=band, notes=(
        str(band), *doubts, *chain.notes), meant=measured(whole, *spectrum_of(record, whole)))


def _fitted(record: Record, whole: Memory) -> Band:
    """The band whose autocorrelation is closest to that of the record, and what it is without each of the blocks."""
    def best(memory: Memory) -> list[float]:
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", optimize.OptimizeWarning)  # of a covariance that nothing uses
                found, _ = optimize.curve_fit(lambda t, gamma, omega: numpy.exp(-gamma * t) * numpy.cos(omega * t),
                                              memory.time, memory.rho, (3 / memory.time[-1], math.pi / memory.half_swing))
        except RuntimeError:
            raise Unfit("record: no narrow band comes close to its autocorrelation") from None
        return [math.sqrt(memory.variance), *abs(found).tolist()]

    numbers, errors = jackknife(record, whole, best)
    return Band(*numbers, errors)
