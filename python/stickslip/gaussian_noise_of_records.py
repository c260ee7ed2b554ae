"""Gaussian noise of measured records: sums of decays and swings whose autocorrelation is closest."""

import dataclasses
import functools
import math
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from .chains import Chain
from .gaussian_noise import NAMES, Gaussian, filtered, ground_swing
from .gaussian_noise import narrow_band as narrow_band_noise
from .needed import needed
from .program import warn
from .record_statistics import BLOCKS, SWING, Memory, jackknife, measured, memory_of, spectrum_of, unsteady
from .records import Record
from .ways_of_records import Unfit, advised

if TYPE_CHECKING:
    import numpy
    Array = numpy.ndarray
numpy, optimize = needed("numpy"), needed("scipy.optimize")

MOST = 3          # terms that are tried
CHANCE = 1.2      # standard errors by which an autocorrelation is off by chance (mean square)
BETTER = 0.9      # of the mean square difference, which a sum of more numbers has to fall below
SURE = 3          # standard errors of a number that is known at all
MEAN = 0.01       # of the deviation, below which a mean is none
RATIOS = (0.05, 0.15, 0.4, 0.8)  # damping ratios from which a fit begins
DAMPED = (0.003, 0.999)          # damping ratios of swings; beyond them there is no swing
ENDS = (-1, 0.9)  # of `swing` in `damped`; at 1 paths are smooth, which the program refuses


@dataclasses.dataclass(frozen=True)
class Fitted:
    """Numbers of a Gaussian noise that was fitted to a record; each is an attribute too: `fit.gamma`, `fit.decay_2`.

    Attributes
    ----------
    names, values
        Of the numbers.
    errors
        Their standard errors, found by leaving out each of 8 blocks of the record (jackknife).
    misfit
        The largest difference of its autocorrelation from that of the record.
    """

    names: tuple[str, ...]
    values: tuple[float, ...]
    errors: tuple[float, ...]
    misfit: float

    def __getattr__(self, name: str) -> float:
        if name.startswith("_") or name not in self.names:
            raise AttributeError(f"the fit has no {name}")
        return self.values[self.names.index(name)]

    def __str__(self) -> str:
        return ", ".join(f"{name} {value:.4g} +- {error:.1g}" for name, value, error in zip(
            self.names, self.values, self.errors)) + f"; its autocorrelation is off by {self.misfit:.2f} at most"


@dataclasses.dataclass(frozen=True)
class _Shape:
    """A sum of decays exp(-p t) and of swings exp(-zeta w t) (cos(nu t) + k (zeta w/nu) sin(nu t)), nu = w (1 - zeta^2)^(1/2).

    Numbers p are logarithms of decays, then log w and zeta of each swing. Its values of k are `ends(zeta)`, each with a
    share of the variance that is not negative, so that the spectrum is not either."""

    decays: int
    swings: int
    ends: "Callable[[float], Sequence[float]]" = lambda damping: ENDS

    def terms(self, p: "Array", memory: Memory) -> "Array":
        """Rows (share of the variance, decay, frequency, sine)."""
        shares, swings = list(self._shares(self._columns(p, memory.time), memory.rho)), p[self.decays:].reshape(-1, 2)
        rows = [(shares.pop(0), math.exp(decay), 0, 0) for decay in p[:self.decays]]
        for place, damping in swings:
            ends, w, root = self.ends(damping), math.exp(place), math.sqrt(1 - damping**2)
            own = [shares.pop(0) for _ in ends]
            swing = numpy.dot(own, ends) / max(sum(own), 1e-300)
            rows.append((sum(own), damping * w, root * w, swing * damping / root))
        return numpy.array(rows)

    def off(self, p: "Array", memory: Memory) -> "Array":
        """Its autocorrelation less that of the record."""
        columns = self._columns(p, memory.time)
        return columns @ self._shares(columns, memory.rho) - memory.rho

    def _columns(self, p: "Array", t: "Array") -> "Array":
        found = [numpy.exp(-math.exp(decay) * t) for decay in p[:self.decays]]
        for place, damping in p[self.decays:].reshape(-1, 2):
            w, root = math.exp(place), math.sqrt(1 - damping**2)
            wave = numpy.exp((1j * root - damping) * w * t)
            found += [wave.real + swing * damping / root * wave.imag for swing in self.ends(damping)]
        return numpy.array(found).T

    def _shares(self, columns: "Array", rho: "Array") -> "Array":
        """The shares that come closest (Lawson and Hanson 1974), of the sum 1."""
        if columns.shape[1] == 1:
            return numpy.ones(1)
        sum_counts = 1e3 * math.sqrt(len(columns))
        shares, _ = optimize.nnls(numpy.vstack([columns, numpy.full(columns.shape[1], sum_counts)]),
                                  numpy.append(rho, sum_counts))
        return shares / shares.sum()

    def nearest(self, starts: "Sequence[Array]", memory: Memory) -> "Array":
        """The numbers of least squares, from the best two of some starts."""
        low, high = math.log(0.2 / memory.time[-1]), math.log(30 / memory.step)
        bounds = numpy.array([(low, high)] * self.decays + [(low, high), DAMPED] * self.swings).T
        starts = sorted(starts, key=lambda p: numpy.square(self.off(p, memory)).sum())[:2]
        found = [optimize.least_squares(self.off, numpy.clip(start, bounds[0] + 1e-9, bounds[1] - 1e-9), bounds=bounds,
                                        args=(memory,), xtol=1e-5, max_nfev=50) for start in starts]
        return min(found, key=lambda fit: fit.cost).x

    def grown(self, p: "Array", swing: bool, memory: Memory) -> "list[Array]":
        """Starts of the shape with one more swing or decay than the one with the numbers p."""
        rates = numpy.log(numpy.geomspace(1 / memory.time[-1], 1 / memory.step, 24))
        if not swing:
            return [numpy.insert(p, self.decays - 1, rate) for rate in rates]
        return [numpy.append(p, (rate, damping)) for rate in rates for damping in RATIOS]


def _first(shape: _Shape, memory: Memory) -> "Array":
    """The numbers of a shape, found from those of shapes with one part less."""
    @functools.cache
    def of(decays: int, swings: int) -> "Array":
        if decays + swings == 0:
            return numpy.zeros(0)
        here = dataclasses.replace(shape, decays=decays, swings=swings)
        before = [(decays - 1, swings, False)] * (decays > 0) + [(decays, swings - 1, True)] * (swings > 0)
        return here.nearest([start for d, s, swing in before for start in here.grown(of(d, s), swing, memory)], memory)
    return of(shape.decays, shape.swings)


@advised
def gaussian_of(record: Record, terms: int | None = None, *, longest: float | None = None) -> Gaussian:
    """Gaussian noise whose covariance, a sum of terms, is closest to that of a record, by least squares: several peaks.

    Each term has a spectrum that is nowhere negative, and so has the sum.

    Parameters
    ----------
    record
        With even steps; gaps are skipped. Its mean becomes that of the noise if it is three of its standard errors.
    terms
        How many; by default the fewest numbers, in at most 3 terms, with which the autocorrelation is off by at most 1.2 of
        its standard errors (mean square).
    longest
        Time up to which the autocorrelation is fitted; by default 12 times the integral of its square.

    Returns
    -------
    noise
        `fit` has amplitude_1, decay_1, and so on, with their errors; `plot` shows covariance and spectrum beside those of
        the record.

    Raises
    ------
    ValueError
        If the autocorrelation leaves that of the sum by more than 0.1 and three of its standard errors.

    Warns
    -----
    UserWarning
        Where the deviation changes by more than 2 from quarter to quarter of the record; where the autocorrelation is off by
        more than 1.2 of its standard errors (mean square), or its paths are smooth.
    """
    if terms is not None and not (isinstance(terms, int) and terms > 0):
        raise ValueError(f"terms = {terms}: must be a whole number of at least 1")
    whole, parts = _memories(record, longest)
    counts = range(1, MOST + 1) if terms is None else [terms]
    shapes = sorted((_Shape(count - swings, swings) for count in counts for swings in range(count + 1)),
                    key=lambda shape: (shape.decays + 2 * shape.swings, shape.decays + shape.swings))
    best, least = None, math.inf
    for shape in shapes:
        p = _first(shape, whole)
        off = shape.off(p, whole)
        size = numpy.sqrt(numpy.square(off).mean())
        if size > BETTER * least:
            continue

        def numbers(memory: Memory, shape: _Shape = shape, p: "Array" = p) -> "Array":
            return shape.terms(shape.nearest([p], memory), memory) * (memory.variance, 1, 1, 1)

        errors, rows = jackknife(parts, numbers), shape.terms(p, whole) * (whole.variance, 1, 1, 1)
        best, least = (rows, errors, abs(off).max()), size
        if size <= CHANCE * whole.error:
            break
    rows, errors, misfit = best
    order = numpy.lexsort(rows[:, 1:3].T)  # by frequency
    rows, errors = rows[order], errors[order]
    if misfit > SWING + SURE * whole.error:
        raise Unfit(f"record: its autocorrelation leaves that of {len(rows)} terms by {misfit:.2f}")
    named = [(f"{name}_{n + 1}", rows[n, k], errors[n, k]) for n in range(len(rows)) for k, name in enumerate(NAMES)
             if k < 2 or rows[n, 2]]
    doubts = [f"its autocorrelation is off by {least:.2g} in the mean square, and by {whole.error:.2g} by chance: these terms "
              "do not make all of it"] * bool(least > CHANCE * whole.error)
    doubts += [f"sine_{n + 1} is at the end of what is taken: paths may be smoother than those of the noise"
               for n, row in enumerate(rows) if row[3] * row[2] > 0.999 * ENDS[1] * row[1]]
    fit = Fitted(*zip(*((name, float(value), float(error)) for name, value, error in named)), float(misfit))
    return _noise(record, whole, Gaussian(rows), fit, doubts)


@advised
def narrow_band_of(record: Record, delta: float | None = None, *, longest: float | None = None) -> Gaussian | Chain:
    """The narrow band whose covariance s^2 exp(-gamma t) cos(omega t) is closest to that of a record, by least squares.

    Parameters
    ----------
    record, longest
        As for `gaussian_of`.
    delta
        With a step [unit of the record], the lattice of the noise in the place of the noise itself.

    Returns
    -------
    noise
        `fit` has deviation, gamma and omega, with their errors.

    Raises
    ------
    ValueError
        If the autocorrelation leaves that of a narrow band by more than 0.1 and three of its standard errors. If it does
        not swing: the omega of the band is less than three standard errors, or so small that its spectrum is largest at 0;
        or neither does the autocorrelation fall below 0 by three standard errors, nor that of the band by 0.1.

    Warns
    -----
    UserWarning
        Where the deviation changes by more than 2 from quarter to quarter of the record; where a record is so short that
        the swing of its autocorrelation is less than three standard errors.
    """
    whole, fit, least = _single(record, longest, lambda damping: (0,), ("deviation", "gamma", "omega"),
                                lambda deviation, decay, frequency, sine: (deviation, decay, frequency))
    if fit.misfit > SWING + SURE * whole.error:
        raise Unfit(f"record: its autocorrelation leaves that of a narrow band by {fit.misfit:.2f}; several bands, or a "
                    "shaking that begins and ends, are no single narrow band")
    unsure = -whole.rho.min() < SURE * whole.error
    if fit.omega < max(SURE * fit.errors[2], fit.gamma / math.sqrt(3)) or unsure and -least < SWING:
        raise Unfit(f"record: its autocorrelation does not swing, or the record is too short to show it: omega is "
                    f"{fit.omega:.3g} +- {fit.errors[2]:.1g}")
    doubts = [f"its autocorrelation swings to {whole.rho.min():.2f}, which is less than three standard errors; a longer "
              "record would tell"] * bool(unsure)
    noise = _noise(record, whole, narrow_band_noise(fit.deviation, fit.gamma, fit.omega), fit, doubts)
    if delta is None:
        return noise
    chain = noise.lattice(delta)
    return dataclasses.replace(chain, meant=noise.meant, fit=fit, notes=noise.notes + chain.notes)


@advised
def filtered_of(record: Record, *, longest: float | None = None) -> Gaussian:
    """The filtered noise, ground of Kanai and Tajimi, whose autocorrelation is closest to that of a record, by least squares.

    Parameters
    ----------
    record, longest
        As for `gaussian_of`.

    Returns
    -------
    noise
        `fit` has deviation, frequency and damping, with their errors.

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
    def numbers(deviation: float, decay: float, frequency: float, sine: float) -> tuple[float, ...]:
        w = math.hypot(decay, frequency)
        return deviation, w, decay / w

    whole, fit, _ = _single(record, longest, lambda damping: (ground_swing(damping),), ("deviation", "frequency", "damping"),
                            numbers)
    if fit.misfit > SWING + SURE * whole.error:
        raise Unfit(f"record: its autocorrelation leaves that of filtered noise by {fit.misfit:.2f}")
    if fit.damping > 0.99:
        raise Unfit("record: its autocorrelation decays without a swing, as that of no ground does")
    if fit.frequency < SURE * fit.errors[1]:
        raise Unfit(f"record: is too short to show a frequency of the ground: {fit.frequency:.3g} +- {fit.errors[1]:.1g}")
    return _noise(record, whole, filtered(*fit.values), fit)


def _memories(record: Record, longest: float | None) -> tuple[Memory, list[Memory]]:
    """That of a record, and those without each of its blocks."""
    whole = memory_of(record, longest)
    return whole, [memory_of(record, whole.time[-1], n) for n in range(BLOCKS)]


def _single(record: Record, longest: float | None, ends: "Callable[[float], Sequence[float]]", names: tuple[str, ...],
            numbers: Callable[..., tuple[float, ...]]) -> tuple[Memory, Fitted, float]:
    """The closest swing of one shape; `numbers` makes those named of deviation, decay, frequency and sine. And the least
    value of its autocorrelation."""
    whole, parts = _memories(record, longest)
    shape = _Shape(0, 1, ends)
    p = _first(shape, whole)

    def of(memory: Memory, p: "Array") -> "Array":
        return numpy.array(numbers(math.sqrt(memory.variance), *shape.terms(p, memory)[0, 1:].tolist()))

    errors, off = jackknife(parts, lambda memory: of(memory, shape.nearest([p], memory))), shape.off(p, whole)
    return whole, Fitted(names, tuple(of(whole, p).tolist()), tuple(errors.tolist()), float(abs(off).max())), float(
        (off + whole.rho).min())


def _noise(record: Record, whole: Memory, noise: Gaussian, fit: Fitted, doubts: Sequence[str] = ()) -> Gaussian:
    """A noise with the mean of the record, what was fitted, and doubts, of which it warns."""
    doubts, mean = (*unsteady(record), *doubts), float(record.value.mean())
    for note in doubts:
        warn(note)
    error = math.sqrt(max(noise.spectrum(0) / whole.duration, 0))
    known = abs(mean) > max(SURE * error, MEAN * noise.deviation)
    left = [f"the mean of the record, {mean:.3g} +- {error:.1g}, is left out; noise + record.value.mean() has it"]
    return dataclasses.replace(noise, mean=mean if known else 0.0, fit=fit, name=f"{noise.name} of "
                               f"{record.source or 'a record'}", meant=measured(whole, *spectrum_of(record, whole)),
                               notes=(str(fit), *doubts, *left * (not known and abs(mean) > MEAN * noise.deviation)))
