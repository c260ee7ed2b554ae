"""Markov chains with a force in each state: what they are, what can be said of them, and their files."""

import dataclasses
import functools
import math
import numbers
import os
import pathlib
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from .needed import needed
from .views import viewed

if TYPE_CHECKING:
    import numpy
    from matplotlib.figure import Figure
    Array = numpy.ndarray
numpy, sparse = needed("numpy"), needed("scipy.sparse")
linalg, csgraph = needed("scipy.sparse.linalg"), needed("scipy.sparse.csgraph")


@dataclasses.dataclass(frozen=True, eq=False)
class Meant:
    """What a chain stands for: covariance [force^2] of times, and spectrum [force^2 time] of angular frequencies."""

    covariance: "Callable[[Array], Array]"
    spectrum: "Callable[[Array], Array]"
    label: str = "meant"


class Noise:
    """What chains and Gaussian noise share."""

    @property
    def correlation_time(self) -> float:
        """Integral of the autocorrelation over t > 0 [time]: S(0)/(2 Var X)."""
        return float(self.spectrum(0) / (2 * self.deviation**2))

    def plot(self, ax: Any = None) -> "Figure":
        """Draw autocovariance and spectrum, beside those that the noise stands for; returns the figure.

        `ax` are two axes of matplotlib to draw in."""
        return viewed("picture", self, ax)

    def _write(self, path: str | os.PathLike[str], head: str, rows: Any) -> None:
        """Write rows of numbers below what the noise says of itself and the names of the columns, in full digits."""
        said = [f"# {line}" for line in repr(self).splitlines()]
        lines = [",".join(repr(value.item()) for value in row) for row in rows]
        pathlib.Path(path).write_text("\n".join([*said, head, *lines, ""]))


@dataclasses.dataclass(frozen=True, eq=False)
class Chain(Noise):
    """A Markov chain with a force in each state.

    `a + b` is the sum of independent chains (states are pairs, that of b runs first), `c * a` scales the force, `a + 0.3`
    shifts it.

    Attributes
    ----------
    x
        Force in each state, of the shape (states,) [force].
    rates
        Sparse matrix of the rates of jumps from state (row) to state (column) [1/time]; without a diagonal.
    name
        In words.
    meant
        What the chain stands for, or None.
    fit
        Of chains that were made of a record: the comparison with it (`Fit`), or the `Band` that was fitted.
    notes
        What is approximate, in sentences.

    Raises
    ------
    ValueError
        If a force is not finite, a rate is negative or not finite, or a state is not reached from each other one.
    """

    x: "Array"
    rates: Any
    name: str = "chain"
    meant: Meant | None = None
    fit: Any = None
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        x, rates = numpy.asarray(self.x, float), sparse.coo_matrix(self.rates, dtype=float)
        object.__setattr__(self, "x", x)
        if x.ndim != 1 or len(x) < 2 or rates.shape != (len(x), len(x)):
            raise ValueError(f"x, rates: shapes {x.shape} and {rates.shape}; give at least 2 states and a square matrix")
        if not numpy.isfinite(x).all():
            raise ValueError(f"x = {x[~numpy.isfinite(x)][0]}: must be finite")
        for n in numpy.flatnonzero(~(numpy.isfinite(rates.data) & (rates.data >= 0)) & (rates.row != rates.col))[:1]:
            raise ValueError(f"rates[{rates.row[n]}, {rates.col[n]}] = {rates.data[n]:g}: must be in [0, inf)")
        jumps = (rates.data > 0) & (rates.row != rates.col)
        rates = sparse.csr_matrix((rates.data[jumps], (rates.row[jumps], rates.col[jumps])), rates.shape)
        parts, part = csgraph.connected_components(rates, connection="strong")
        if parts > 1:
            raise ValueError(f"rates: state {numpy.flatnonzero(part != part[0])[0]} and state 0 do not reach each other; "
                             "leave it out, or give rates that lead there and back")
        object.__setattr__(self, "rates", rates)

    def __repr__(self) -> str:
        head = (f"{self.name}: {len(self.x)} states, {self.rates.nnz} rates, mean {self.mean:.4g}, standard deviation "
                f"{self.deviation:.4g}, correlation time {self.correlation_time:.4g}")
        return "\n".join([head, *self.notes])

    def __add__(self, other: "Chain | float") -> "Chain":
        if not isinstance(other, Chain | numbers.Real):
            return NotImplemented
        if not isinstance(other, Chain):
            return dataclasses.replace(self, x=self.x + float(other), name=f"{self.name} + {float(other):g}", fit=None,
                                       notes=self._of_this())
        here, there = (sparse.identity(len(chain.x)) for chain in (self, other))
        meant = None
        if self.meant and other.meant:
            a, b = self.meant, other.meant
            meant = Meant(lambda t: a.covariance(t) + b.covariance(t), lambda w: a.spectrum(w) + b.spectrum(w))
        return Chain(numpy.add.outer(self.x, other.x).ravel(),
                     sparse.kron(self.rates, there) + sparse.kron(here, other.rates), f"{self.name} + {other.name}",
                     meant, None, tuple(dict.fromkeys(self._of_this() + other._of_this())))

    def __mul__(self, factor: float) -> "Chain":
        factor, m = float(factor), self.meant
        if not (math.isfinite(factor) and factor):
            raise ValueError(f"factor = {factor:g}: must be finite and not 0, which leaves no noise")
        meant = m and Meant(lambda t: factor**2 * m.covariance(t), lambda w: factor**2 * m.spectrum(w), m.label)
        return dataclasses.replace(self, x=factor * self.x, name=f"{factor:g} ({self.name})", meant=meant, fit=None,
                                   notes=self._of_this())

    def _of_this(self) -> tuple[str, ...]:
        """The notes as those of a chain of which another one is made."""
        return tuple(note if note.startswith("of ") else f"of {self.name}: {note}" for note in self.notes)

    __radd__, __rmul__ = __add__, __mul__

    @functools.cached_property
    def stationary(self) -> "Array":
        """Stationary distribution p, by state: p Q = 0, sum 1. One sparse LU of -Q without the state of the
        median force, an M-matrix that needs no pivots."""
        first = int(abs(self.x - numpy.median(self.x)).argmin())
        others = numpy.delete(numpy.arange(len(self.x)), first)
        block = linalg.splu(-self.generator[others][:, others].T.tocsc(), diag_pivot_thresh=0)
        p = numpy.insert(block.solve(self.rates[first].toarray().ravel()[others]), first, 1)
        return p / p.sum()

    @property
    def generator(self) -> Any:
        """Q, sparse: the rates, and the diagonal with which rows sum to zero [1/time]."""
        return (self.rates - sparse.diags(numpy.asarray(self.rates.sum(axis=1)).ravel())).tocsr()

    @property
    def mean(self) -> float:
        """E[X] [force]; it acts on the body like a bias."""
        mean = float(self.stationary @ self.x)
        return mean if abs(mean) > 1e-14 * abs(self.x).max() else 0.0  # of symmetric chains but for rounding

    @property
    def deviation(self) -> float:
        """Standard deviation of X [force]."""
        return math.sqrt(self.stationary @ (self.x - self.mean) ** 2)

    def covariance(self, t: "Array | float") -> "Array":
        """Cov(X_0, X_t) = sum_n p_n f_n (exp(Q t) f)_n with f = x - E[X], at times t >= 0 [force^2], of the shape of t."""
        t = numpy.asarray(t, float)
        f, q, now, found = self.x - self.mean, self.generator, 0.0, numpy.zeros(t.size)
        weights = self.stationary * f
        for n in numpy.argsort(t, axis=None):
            f = linalg.expm_multiply(q * (t.flat[n] - now), f) if t.flat[n] > now else f
            now, found[n] = t.flat[n], weights @ f
        return found.reshape(t.shape)

    def spectrum(self, omega: "Array | float") -> "Array":
        """S(w) = int Cov(X_0, X_t) exp(-i w t) dt = 2 Re sum_n p_n f_n ((i w - Q)^-1 f)_n [force^2 time], two-sided, at
        angular frequencies of any shape; Var X = (1/2 pi) int S dw. This is `S_x` of the quantity noise_spectrum."""
        omega = numpy.asarray(omega, float)
        f, q, unit = self.x - self.mean, self.generator, sparse.identity(len(self.x))
        found = numpy.zeros(omega.size)
        for n, w in enumerate(omega.flat):
            if w:
                phi = linalg.splu((1j * w * unit - q).tocsc(), diag_pivot_thresh=0).solve(f.astype(complex)).real
            else:  # -Q phi = f is solved up to a constant, which p f does not see
                phi = numpy.append(linalg.splu(-q[:-1, :-1].tocsc(), diag_pivot_thresh=0).solve(f[:-1]), 0)
            found[n] = 2 * (self.stationary * f) @ phi
        return found.reshape(omega.shape)

    @property
    def fastest(self) -> float:
        """The largest rate at which a state is left [1/time]."""
        return float(abs(self.generator.diagonal()).max())

    @property
    def neighbours_only(self) -> bool:
        """Whether x rises, and each jump leads to the next level: what `-noise file` takes."""
        entries = self.rates.tocoo()
        return bool((numpy.diff(self.x) > 0).all() and (abs(entries.row - entries.col) == 1).all())

    def save(self, states: str | os.PathLike[str], rates: str | os.PathLike[str] | None = None) -> None:
        """Write the files of the program.

        Parameters
        ----------
        states, rates
            Of `-noise_states` and `-noise_rates`. Without `rates`, the levels of `-noise_file`, for jumps to neighbours.

        Raises
        ------
        ValueError
            If the chain has other jumps, and there is one file.
        """
        if rates is None and not self.neighbours_only:
            raise ValueError(f"rates: {self.name} has jumps beyond its neighbours; name two files, states and rates")
        if rates is None:
            up, down = (numpy.append(0, self.rates.diagonal(1)), numpy.append(self.rates.diagonal(-1), 0))
            rows = zip(self.x, numpy.append(up[1:], 0), numpy.append(0, down[:-1]))
            return self._write(states, "x,rate_up,rate_down", rows)
        entries = self.rates.tocoo()
        self._write(states, "x", zip(self.x))
        self._write(rates, "from,to,rate", zip(entries.row, entries.col, entries.data))
