"""Filtered noise, the ground motion of Kanai and Tajimi, of measured records."""

import dataclasses
import warnings
from typing import TYPE_CHECKING, Any

from .needed import needed
from .record_statistics import SWING, Memory, jackknife, memory_of, unsteady
from .records import Record
from .ways_of_records import Unfit, advised

if TYPE_CHECKING:
    import numpy
    Array = numpy.ndarray
numpy, optimize = needed("numpy"), needed("scipy.optimize")

STARTS = (0.2, 0.5, 0.8)  # damping ratios from which the fit begins
MOST = 0.99               # damping ratio, beyond which there is no ground that swings
SURE = 3                  # standard errors of a frequency that is known at all
MEAN = 0.01               # of the deviation, from which on a mean is worth a note


@dataclasses.dataclass(frozen=True)
class Filtered:
    """White noise through a damped oscillator, as `-noise filtered` takes it.

    Attributes
    ----------
    deviation, frequency, damping
        Standard deviation [force], angular frequency w [1/time] and damping ratio zeta of the ground.
    errors
        Their standard errors, in this order, found by leaving out each of 8 blocks of the record (jackknife).
    misfit
        The largest difference of its autocorrelation from that of the record.
    notes
        What it does not represent of the record, in sentences.
    """

    deviation: float
    frequency: float
    damping: float
    errors: tuple[float, float, float]
    misfit: float
    notes: tuple[str, ...] = ()

    def __str__(self) -> str:
        numbers = ", ".join(f"{name} {getattr(self, name):.4g} +- {error:.1g}" for name, error in zip(
            ("deviation", "frequency", "damping"), self.errors))
        return "\n".join([f"{numbers}; its autocorrelation is off by {self.misfit:.2f} at most", *self.notes])

    @property
    def options(self) -> dict[str, Any]:
        """For `stickslip.run(**fit.options, ...)`."""
        return {"noise": "filtered", "noise_deviation": self.deviation, "ground_frequency": self.frequency,
                "ground_damping": self.damping}


def autocorrelation(t: "Array", frequency: float, damping: float) -> "Array":
    """exp(-zeta w t) (cos(nu t) + k sin(nu t)), nu = w (1 - zeta^2)^(1/2), k = zeta (1 - 4 zeta^2)/((1 - zeta^2)^(1/2) (1 +
    4 zeta^2)) (Kanai 1957, Tajimi 1960)."""
    root, ratio = numpy.sqrt(1 - damping**2), 4 * damping**2
    k = damping * (1 - ratio) / (root * (1 + ratio))
    return numpy.exp(-damping * frequency * t) * (numpy.cos(root * frequency * t) + k * numpy.sin(root * frequency * t))


@advised
def filtered_of(record: Record, *, longest: float | None = None) -> Filtered:
    """The filtered noise whose autocorrelation is closest to that of a record, by least squares.

    Parameters
    ----------
    record
        With even steps; gaps are skipped.
    longest
        Time up to which the autocorrelation is fitted; by default 12 times the integral of its square.

    Raises
    ------
    ValueError
        If the autocorrelation leaves that of filtered noise by more than 0.1 and three of its standard errors, or decays
        like that of a ground whose damping ratio is about 1; if the record is so short that the frequency is less than
        three of its standard errors.

    Warns
    -----
    UserWarning
        Where the deviation changes by more than 2 from quarter to quarter of the record.
    """
    whole = memory_of(record, longest)
    (deviation, frequency, damping), errors = jackknife(record, whole, _closest)
    misfit = float(abs(whole.rho - autocorrelation(whole.time, frequency, damping)).max())
    if misfit > SWING + 3 * whole.error:
        raise Unfit(f"record: its autocorrelation leaves that of filtered noise by {misfit:.2f}")
    if damping > MOST:
        raise Unfit("record: its autocorrelation decays without a swing, as that of no ground does")
    if frequency < SURE * errors[1]:
        raise Unfit(f"record: is too short to show a frequency of the ground: {frequency:.3g} +- {errors[1]:.1g}")
    doubts, mean = unsteady(record), float(record.value.mean())
    for note in doubts:
        warnings.warn(note, UserWarning, stacklevel=3)
    left = [f"the mean of the record, {mean:.3g}, is left out: -bias takes it, centred() takes it off"]
    return Filtered(deviation, frequency, damping, errors, misfit, (*doubts, *left * (abs(mean) > MEAN * deviation)))


def _closest(memory: Memory) -> list[float]:
    """Deviation, frequency and damping ratio, the best of several starts."""
    first = memory.half_swing
    found = [optimize.least_squares(lambda p: autocorrelation(memory.time, *p) - memory.rho, (2 / first, damping),
                                    bounds=((1e-3 / first, 1e-3), (1e3 / first, 0.999)), x_scale=(1 / first, 1))
             for damping in STARTS]
    return [float(memory.variance) ** 0.5, *min(found, key=lambda fit: fit.cost).x.tolist()]
