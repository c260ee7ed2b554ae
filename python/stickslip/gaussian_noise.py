"""Gaussian noise of continuous paths, given by its covariance: what `-noise gaussian` takes."""

import dataclasses
import math
import numbers
import os
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from . import chains_by_name
from .chains import Chain, Meant, Noise
from .chains_by_name import RADIUS, plane_lattice, positive
from .needed import needed

if TYPE_CHECKING:
    import numpy
    Array = numpy.ndarray
numpy = needed("numpy")

NAMES = ("amplitude", "decay", "frequency", "sine")


@dataclasses.dataclass(frozen=True, eq=False)
class Gaussian(Noise):
    """Stationary Gaussian noise with the covariance sum of amplitude exp(-decay t) (cos(frequency t) + sine sin(frequency t)).

    `a + b` is the sum of independent noises, `c * a` scales the force, `a + 0.3` shifts it.

    Attributes
    ----------
    terms
        Rows (amplitude, decay, frequency, sine) [force^2, 1/time, 1/time, 1]; the last two may be left out, as 0.
    mean
        E[X] [force], which acts on the body like a bias.
    name, meant, fit, notes
        As of a `Chain`. Numbers of a fit are attributes of the noise as well.

    Raises
    ------
    ValueError
        If the terms are no covariance: a decay or the variance is not positive, or the spectrum is negative somewhere.
    """

    terms: "Array"
    mean: float = 0
    name: str = "gaussian"
    meant: Meant | None = None
    fit: Any = None
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        rows = [tuple(row) if numpy.ndim(row) == 1 else () for row in self.terms]
        for n, row in enumerate(rows):
            if not (2 <= len(row) <= 4 and numpy.isfinite(row).all() and row[1] > 0 and min(row[2:3], default=0) >= 0):
                raise ValueError(f"terms[{n}] = {self.terms[n]}: must be (amplitude, decay), (amplitude, decay, frequency) or "
                                 "(amplitude, decay, frequency, sine), with a decay in (0, inf) and a frequency in [0, inf)")
        terms = numpy.array([row + (0,) * (4 - len(row)) for row in rows], float).reshape(-1, 4)
        object.__setattr__(self, "terms", terms)
        if not terms[:, 0].sum() > 0:
            raise ValueError(f"terms: the amplitudes add up to the variance {terms[:, 0].sum():g}, which must be positive")
        sizes = numpy.hypot(terms[:, 1], terms[:, 2])
        omega = numpy.concatenate([[0], numpy.geomspace(1e-3 * sizes.min(), 1e3 * sizes.max(), 2000), *(
            abs(row[2] + row[1] * numpy.linspace(-10, 10, 401)) for row in terms)])
        density, rounding = self.spectrum(omega), 1e-12 * abs(terms[:, 0]).sum() * sizes.max() / (sizes.max()**2 + omega**2)
        if (density < -rounding).any():
            n = int((density + rounding).argmin())
            raise ValueError(f"terms: the spectrum is {density[n]:.3g} at the frequency {omega[n]:.3g}, and must not be negative")

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_") or self.fit is None:
            raise AttributeError(f"{type(self).__name__} has no {name}")
        return getattr(self.fit, name)

    def __repr__(self) -> str:
        head = f"{self.name}: mean {self.mean:.4g}, standard deviation {self.deviation:.4g}, covariance {self._text('.4g')}"
        return "\n".join([head, *self.notes])

    def __add__(self, other: "Gaussian | float") -> "Gaussian":
        if isinstance(other, Gaussian):
            return Gaussian(numpy.vstack([self.terms, other.terms]), self.mean + other.mean, f"{self.name} + {other.name}")
        if not isinstance(other, numbers.Real):
            raise TypeError(f"{self.name} + {getattr(other, 'name', other)}: is no sum of Gaussian noises; lattice(delta) makes "
                            "a chain, which is added to chains")
        return dataclasses.replace(self, mean=self.mean + float(other), meant=None, fit=None)

    def __mul__(self, factor: float) -> "Gaussian":
        factor = float(factor)
        return Gaussian(self.terms * (factor**2, 1, 1, 1), factor * self.mean, f"{factor:g} ({self.name})")

    __radd__, __rmul__ = __add__, __mul__

    def _text(self, form: str = "r") -> str:
        rows = [row[:4 if row[3] else 3 if row[2] else 2] for row in self.terms.tolist()]
        return ";".join(",".join(repr(value) if form == "r" else format(value, form) for value in row) for row in rows)

    @property
    def options(self) -> dict[str, Any]:
        """Of the program: `run(**noise.options)` is `run(noise=noise)`."""
        return {"noise": "gaussian", "covariance": self._text(), **({"bias": self.mean} if self.mean else {})}

    @property
    def deviation(self) -> float:
        """Standard deviation of X [force]."""
        return math.sqrt(self.terms[:, 0].sum())

    @property
    def fastest(self) -> float:
        """The largest rate at which the covariance changes [1/time]."""
        return float(numpy.hypot(self.terms[:, 1], self.terms[:, 2]).max())

    @property
    def _exponentials(self) -> "tuple[Array, Array]":
        """Factors a and rates s of the covariance Re sum of a exp(-s t)."""
        amplitude, decay, frequency, sine = self.terms.T
        return amplitude * (1 - 1j * sine), decay - 1j * frequency

    def covariance(self, t: "Array | float") -> "Array":
        """Cov(X_0, X_t) at times t >= 0 [force^2], of the shape of t."""
        factors, rates = self._exponentials
        return (numpy.exp(-numpy.multiply.outer(t, rates)) @ factors).real

    def spectrum(self, omega: "Array | float") -> "Array":
        """int Cov(X_0, X_t) exp(-i omega t) dt [force^2 time], two-sided, of the shape of omega: Re sum of 2 a s/(s^2 +
        omega^2)."""
        factors, rates = self._exponentials
        return (1 / numpy.add.outer(numpy.square(omega), rates**2) @ (2 * factors * rates)).real

    def lattice(self, delta: float, radius: float = RADIUS) -> Chain:
        """The noise as a chain of levels: the sum of `ou` and of lattices in the plane, a term each; each must be a covariance.

        Parameters
        ----------
        delta
            Step of the force [force].
        radius
            In deviations, within which states of the plane are kept.
        """
        parts = []
        for amplitude, decay, frequency, sine in self.terms.tolist():
            positive(amplitude=amplitude)
            deviation = math.sqrt(amplitude)
            parts.append(plane_lattice(deviation, decay, frequency, sine, delta, radius) if frequency else
                         chains_by_name.ou(deviation, 1 / decay, delta))
        chain = sum(parts[1:], parts[0])
        return dataclasses.replace(chain + self.mean if self.mean else chain, name=self.name, notes=chain.notes, meant=Meant(
            self.covariance, self.spectrum))

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the file of `-covariance_file`."""
        self._write(path, ",".join(NAMES), self.terms)


def gaussian(terms: Sequence[Sequence[float]], mean: float = 0) -> Gaussian:
    """Gaussian noise with the covariance sum of amplitude exp(-decay t) (cos(frequency t) + sine sin(frequency t)).

    Parameters
    ----------
    terms
        Of (amplitude, decay[, frequency[, sine]]), as in the file of `-covariance_file` [force^2, 1/time, 1/time, 1].
    mean
        [force]

    Examples
    --------
    >>> noise.gaussian([(1, 0.5, 3), (0.49, 1)])  # a band, and Ornstein-Uhlenbeck noise of deviation 0.7
    """
    return Gaussian(terms, float(mean))


def damped(frequency: float, damping: float, swing: float) -> "list[tuple[float, ...]]":
    """Terms of exp(-zeta w t) (cos(nu t) + swing (zeta w/nu) sin(nu t)) with nu = w (1 - zeta^2)^(1/2), of an oscillator of
    frequency w and damping ratio zeta: its velocity under white noise for swing = -1, its position for 1. Two decays where
    zeta > 1. Within 5e-7 of zeta = 1, where the two are one, nu is w/1000."""
    positive(frequency=frequency, damping=damping)
    root = max(math.sqrt(abs(1 - damping**2)), 1e-3)
    ratio = swing * damping / root
    if damping < 1 + 5e-7:
        return [(1, damping * frequency, frequency * root, ratio)]
    return [((1 + ratio) / 2, frequency / (damping + root)), ((1 - ratio) / 2, frequency * (damping + root))]


def ground_swing(damping: float) -> float:
    """`swing` of `damped` for the ground of Kanai and Tajimi."""
    return (1 - 4 * damping**2) / (1 + 4 * damping**2)


def filtered(deviation: float, frequency: float, damping: float) -> Gaussian:
    """White noise through a damped oscillator, the ground motion of Kanai (1957) and Tajimi (1960): spectrum
    (1 + (2 zeta r)^2)/((1 - r^2)^2 + (2 zeta r)^2) with r = omega/w.

    Parameters
    ----------
    deviation
        Standard deviation [force].
    frequency, damping
        Angular frequency w [1/time] and damping ratio zeta of the ground.
    """
    positive(deviation=deviation)
    rows = damped(frequency, damping, ground_swing(damping))
    return Gaussian([(deviation**2 * amplitude, *rates) for amplitude, *rates in rows], name="filtered")


def narrow_band(deviation: float, gamma: float, omega: float, delta: float | None = None,
                radius: float = RADIUS) -> "Gaussian | Chain":
    """Gaussian noise of covariance s^2 exp(-gamma t) cos(omega t).

    Parameters
    ----------
    deviation, gamma, omega
        Standard deviation s [force], half width and angular frequency of the band [1/time].
    delta, radius
        With a step [force], the `lattice` in the place of the noise itself.
    """
    positive(deviation=deviation, gamma=gamma, omega=omega)
    noise = Gaussian([(deviation**2, gamma, omega)], name="narrow band")
    return noise if delta is None else noise.lattice(delta, radius)


def ou(deviation: float, tau: float, delta: float | None = None, levels: int | None = None) -> "Gaussian | Chain":
    """Ornstein-Uhlenbeck noise of covariance s^2 exp(-t/tau); with a step `delta` the chain of the program for it.

    Parameters
    ----------
    deviation, tau, delta
        Standard deviation s [force], correlation time [time] and step [force].
    levels
        Of the chain, on each side of 0; by default as many as within 6 deviations, or as have positive rates.
    """
    if delta is not None:
        return chains_by_name.ou(deviation, tau, delta, levels)
    positive(deviation=deviation, tau=tau)
    return Gaussian([(deviation**2, 1 / tau)], name="ou")
