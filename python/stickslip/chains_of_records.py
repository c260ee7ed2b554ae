"""Chains of measured records: rates by counts with their confidence intervals, and what says whether they fit."""

import dataclasses
import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from .chains import Chain
from .needed import needed
from .program import warn
from .record_statistics import MATCH, SWING, Memory, measured, memory_of, spectrum_of, unsteady
from .records import Record
from .ways_of_records import Unfit, advised

if TYPE_CHECKING:
    import numpy
    Array = numpy.ndarray
numpy, stats = needed("numpy"), needed("scipy.stats")

TRIED = (15, 13, 11, 9, 7, 5)  # numbers of levels
FEWEST = 10       # counts of each jump
FAR = 0.05        # share of jumps over several levels, above which levels that jump to neighbours do not fit
FLAT = 0.1        # share of the integral of the autocorrelation in that of its size, below which it is about zero
WRONG = 2.0       # factor to the record beyond which a chain is refused, if that is significant
MOST = 5.0        # factor by which rates are multiplied at most
POWER = 0.8       # share of the variance at low frequencies, within which spectra are compared
BANDS = 4


@dataclasses.dataclass(frozen=True, eq=False)
class Fit:
    """A chain of a record beside the record. Pairs are (chain, record).

    Attributes
    ----------
    spent
        Time on each level [time].
    jumps, low, high
        Numbers of jumps from level to level, and the ends of the confidence intervals of their rates [1/time], of the
        shape (levels, levels). The intervals are those of Poisson counts (Garwood 1936).
    far
        Share of the jumps of the record that lead over more than one level.
    deviation, correlation_time
        Standard deviations [force] and integrals of the autocorrelations [time].
    error
        Standard error of the correlation time of the record (Madras and Sokal 1988) [time].
    bands
        Rows (from, to, ratio of the spectra chain/record, its standard error) in angular frequency.
    factor
        By which all rates were multiplied; 1 for rates as they were counted.
    """

    spent: "Array"
    jumps: "Array"
    low: "Array"
    high: "Array"
    far: float
    deviation: tuple[float, float]
    correlation_time: tuple[float, float]
    error: float
    bands: "Array"
    factor: float = 1

    def __str__(self) -> str:
        lines = [f"deviation: chain {self.deviation[0]:.4g}, record {self.deviation[1]:.4g}",
                 f"correlation time: chain {self.correlation_time[0]:.4g}, record {self.correlation_time[1]:.4g} +- "
                 f"{self.error:.2g}",
                 f"{100 * self.far:.2g} % of the jumps lead over more than one level; fewest counts of a rate "
                 f"{self.jumps[self.jumps > 0].min():g}",
                 *(f"spectrum chain/record, {low:.3g} < omega < {high:.3g}: {ratio:.2f} +- {error:.2f}"
                   for low, high, ratio, error in self.bands)]
        matched = f"all rates were multiplied by {self.factor:.4g}, which gives the chain the correlation time of the record"
        return "\n".join([*lines, "rates are those counted" if self.factor == 1 else matched])


@advised
def record(record: Record, levels: int | Sequence[float] | None = None, *, mu_s: float | None = None,
           jumps: str = "neighbours", match_time: bool | None = None, longest: float | None = None,
           confidence: float = 0.95) -> Chain:
    """The chain of levels of a record: rate = jumps counted/time spent on the level, times one factor for all rates.

    A jump is counted when the record reaches another level, not when it leaves a bin around its own: a rough record
    crosses the edge of a bin many times in a row. Between samples it reaches levels unseen, and a smooth record keeps its
    way where a chain turns round: rates as counted make a chain that remembers too long. By default the factor gives the
    chain the correlation time of the record; a record of few values, all of whose jumps are seen, has the factor 1.

    Parameters
    ----------
    record
        With even steps; gaps are skipped.
    levels
        Their forces [unit of the record], or about their number: quantiles at the shares of evenly spaced points of a normal
        distribution. A record of few values keeps these. By default the most of 15 to 5 of which each rate has 10 counts.
    mu_s
        Static friction [unit of the record]. Levels are then placed so that -mu_s and mu_s lie halfway between two of them;
        elsewhere they act as if they did, and results jump from one number of levels to the next.
    jumps
        "neighbours": a jump over several levels is one over each of them, and at most 5 % of jumps may be such.
        "any": jumps lead where the record is at its next sample, as in one of pulses or switches.
    match_time
        True: the factor gives the chain the correlation time of the record, the integral of its autocorrelation. False:
        the factor is 1, and the chain has the correlation time that follows from the rates. By default True unless the
        levels are all the values of the record. `fit` has the factor and both times.
    longest
        Time beyond which the record is uncorrelated; by default 12 times the integral of the squared autocorrelation.
    confidence
        Of the intervals of the rates.

    Returns
    -------
    chain
        `fit` says how it compares with the record, `notes` what does not fit, `plot` shows it.

    Raises
    ------
    ValueError
        If such a chain cannot stand for the record: its autocorrelation swings or has an integral of about zero, jumps
        over several levels, too few counts of a jump, correlation times or spectra that differ by more than 2.

    Warns
    -----
    UserWarning
        With each note.
    """
    if jumps not in ("neighbours", "any") or not 0 < confidence < 1:
        raise ValueError(f"jumps = {jumps!r}, confidence = {confidence}: take neighbours or any, and a number in (0, 1)")
    memory = memory_of(record, longest)
    time, error = _correlation_time(memory)
    problem = None
    for asked in TRIED if levels is None else (levels,):
        x = _levels(record, asked, mu_s)
        try:
            spent, counts, far = _counted(record, x, jumps)
            break
        except _TooFew as few:
            problem = few
    else:
        swings = -memory.rho.min() > SWING
        raise Unfit(f"{problem}" + f"; its autocorrelation swings to {memory.rho.min():.2f}" * bool(swings))
    rates = counts / spent[:, None]
    rough = Chain(x, rates, f"levels of {record.source or 'a record'}")
    if match_time is None:
        match_time = not numpy.isin(record.value, x).all()
    factor = rough.correlation_time / time if match_time else 1.0
    if not 1 / MOST <= factor <= MOST:
        raise Unfit(f"match_time: would multiply all rates by {factor:.3g}, beyond [1/{MOST:g}, {MOST:g}], as a record does "
                    "that is sampled too coarsely for its levels")
    frequencies, power = spectrum_of(record, memory)
    chain = dataclasses.replace(rough, rates=rates * factor, meant=measured(memory, frequencies, power))
    neighbours = numpy.eye(len(x), k=1) + numpy.eye(len(x), k=-1)
    possible = (counts if jumps == "any" else neighbours) > 0
    low, high = (numpy.where(possible, stats.chi2.ppf(share, 2 * counts + more) / 2 / spent[:, None], 0) * factor
                 for share, more in (((1 - confidence) / 2, 0), ((1 + confidence) / 2, 2)))
    fit = Fit(spent, counts, low, high, far, (chain.deviation, math.sqrt(memory.variance)), (chain.correlation_time, time),
              error, _bands(chain, frequencies, power, memory), factor)
    notes = (*_misfits(fit), *unsteady(record))
    for note in notes:
        warn(note)
    return dataclasses.replace(chain, fit=fit, notes=(*str(fit).splitlines(), *notes))


class _TooFew(Unfit):
    """A jump with too few counts."""


def _correlation_time(memory: Memory) -> tuple[float, float]:
    """Integral of the autocorrelation and its standard error; refuses what levels in a row cannot follow, as the
    autocorrelation of such a chain is a sum of decaying exponentials with positive weights."""
    integral, size = memory.integral(memory.rho), memory.integral(abs(memory.rho))
    lowest = int(memory.rho.argmin())
    if -memory.rho[lowest] > SWING + 3 * memory.error:
        raise Unfit(f"record: its autocorrelation swings to {memory.rho[lowest]:.2f} at {memory.time[lowest]:.3g} and "
                    f"has the integral {integral:.2g}, that of a chain of levels stays positive")
    if integral < FLAT * size:
        raise Unfit(f"record: the integral of its autocorrelation is {integral:.2g}, of its size {size:.2g}: about zero or "
                    "negative, that of a chain of levels is positive")
    return integral, integral * math.sqrt(4 * memory.time[-1] / memory.duration)


def _levels(record: Record, levels: int | Sequence[float], mu_s: float | None) -> "Array":
    """Levels at normal scores that are evenly spaced, with the thresholds -mu_s and mu_s halfway between two of them."""
    if numpy.ndim(levels):
        x = numpy.asarray(levels, float)
        if len(x) < 2 or not (numpy.diff(x) > 0).all():
            raise ValueError(f"levels = {x}: must be at least two, rising")
        return x
    if levels < 2:
        raise ValueError(f"levels = {levels}: must be at least 2")
    distinct = numpy.unique(record.value)
    if len(distinct) <= levels:
        return distinct
    widest = math.sqrt((levels + 1) / 2)
    step, first = 2 * widest / (levels - 1), -widest
    below = [(record.value <= sign * mu_s).mean() for sign in (-1, 1)] if mu_s else []
    thresholds = [score for score in stats.norm.ppf(below) if abs(score) < widest]
    if thresholds:
        length = thresholds[-1] - thresholds[0]
        step = length / max(round(length / step), 1) if length else step
        first = thresholds[0] + step * (0.5 - math.floor((thresholds[0] + widest) / step + 0.5))
    scores = first + step * numpy.arange(math.floor((widest - first) / step + 1e-9) + 1)
    return numpy.unique(numpy.quantile(record.value, stats.norm.cdf(scores)))


def _counted(record: Record, x: "Array", jumps: str) -> "tuple[Array, Array, float]":
    """Time on each level, jumps between them, and the share of jumps over more than one."""
    spent, direct = numpy.zeros(len(x)), numpy.zeros((len(x), len(x)))
    for piece in record.stretches():
        path = [int(abs(x - piece[0]).argmin())]
        below, above = numpy.searchsorted(x, piece, "right") - 1, numpy.searchsorted(x, piece, "left")
        for up, down in zip(below[1:].tolist(), above[1:].tolist()):
            path.append(up if up > path[-1] else min(down, path[-1]))
        spent += record.step * numpy.bincount(path[:-1], minlength=len(x))
        numpy.add.at(direct, (path[:-1], path[1:]), 1)
    numpy.fill_diagonal(direct, 0)
    far = 1 - (direct.diagonal(1).sum() + direct.diagonal(-1).sum()) / max(direct.sum(), 1)
    counts = direct if jumps == "any" else numpy.zeros_like(direct)
    for k, to in zip(*direct.nonzero()) if jumps == "neighbours" else ():
        passed = numpy.arange(k, to, 1 if to > k else -1)
        counts[passed, passed + (1 if to > k else -1)] += direct[k, to]
    for n, level in enumerate(x):
        ways = {"away": counts[n].sum()} if jumps == "any" else {
            name: counts[n, n + way] for name, way in (("up", 1), ("down", -1)) if 0 <= n + way < len(x)}
        for way, number in ways.items():
            if number < FEWEST:
                raise _TooFew(f"levels: {number:g} jumps from level {level:.4g} {way} of {len(x)} levels are too few to "
                              f"count, {FEWEST} are needed")
    if jumps == "neighbours" and far > FAR:
        raise Unfit(f"levels: {100 * far:.2g} % of the jumps lead over more than one level, of {len(x)}: it jumps, or is "
                    "sampled too coarsely for these levels")
    return spent, counts, far


def _bands(chain: Chain, frequencies: "Array", power: "Array", memory: Memory) -> "Array":
    """Spectra of chain over record in bands that hold as much of the variance each."""
    share = numpy.cumsum(power) / power.sum()
    rows = []
    for n in range(BANDS):
        inside = (share > POWER * n / BANDS) & (share <= POWER * (n + 1) / BANDS)
        if inside.any():
            window = 2 * math.pi / (frequencies[1] - frequencies[0])
            error = 1 / math.sqrt(max(inside.sum() * memory.duration / window, 1))
            ratio = float(chain.spectrum(frequencies[inside]).sum() / power[inside].sum())
            rows.append((frequencies[inside][0], frequencies[inside][-1], ratio, ratio * error))
    return numpy.array(rows).reshape(-1, 4)


def _misfits(fit: Fit) -> list[str]:
    """Sentences on what differs by more than 1.1 and two standard errors; refuses a factor above 2 and three of them."""
    compared = [("correlation time", fit.correlation_time[0] / fit.correlation_time[1], fit.error / fit.correlation_time[1]),
                ("standard deviation", fit.deviation[0] / fit.deviation[1], 0)]
    compared += [(f"spectrum from {low:.3g} to {high:.3g}", ratio, error / ratio) for low, high, ratio, error in fit.bands]
    found = []
    for what, ratio, error in compared:
        off = abs(math.log(ratio))
        said = f"the {what} of the chain is {ratio:.3g} times that of the record"
        fix = ("compare other levels" if fit.factor != 1 else
               f"match_time=True multiplies all rates by {fit.correlation_time[0] / fit.correlation_time[1]:.3g}")
        if off > max(math.log(WRONG), 3 * error):
            raise Unfit(f"record: {said}")
        if off > max(math.log(MATCH), 2 * error):
            found.append(f"{said}; {fix}")
    return found
