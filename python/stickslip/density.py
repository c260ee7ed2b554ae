"""The stationary distribution of force and velocity, at nodes and between them."""

import dataclasses
from typing import TYPE_CHECKING

from .needed import needed

if TYPE_CHECKING:
    import numpy
    Array = numpy.ndarray
numpy = needed("numpy")


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class Density:
    """The stationary distribution of (X, V).

    Attributes
    ----------
    x, v
        Levels of the noise, and velocities of the nodes.
    values
        P(X = x_i, V in dv)/dv while the body slides, by [x, v].
    at_rest
        P(X = x_i, the body sticks), by [x].
    marginal_x, marginal_v
        P(X = x_i), and the density of V without its atom at 0.
    weights
        Of the nodes: `(weights * f(v)).sum()` is the integral of f.
    cells
        Ends of the elements in v: between two of them densities are the polynomials through the values there.
    error
        Error estimate of the distribution function of the speed.
    states
        Number of the state of each row, as the noise numbers them: of `-noise chain`, or the phase of `-noise
        periodic`. Several states may have the same x.
    position
        With a spring the arrays p, pdf, atom and marginal_p of `by_position()`, by evenly spaced positions; else empty.
    """

    x: "Array"
    v: "Array"
    values: "Array"
    at_rest: "Array"
    marginal_x: "Array"
    marginal_v: "Array"
    weights: "Array"
    cells: "Array"
    error: float
    states: "Array"
    position: "dict[str, Array]" = dataclasses.field(default_factory=dict)

    def by_force(self) -> "Density":
        """The same with one row for each force, the sum of those of all states that have it."""
        x, place = numpy.unique(self.x, return_inverse=True)
        if len(x) == len(self.x):
            return self
        rows = {name: numpy.zeros((len(x), *numpy.shape(getattr(self, name))[1:]))
                for name in ("values", "at_rest", "marginal_x")}
        for name, sums in rows.items():
            numpy.add.at(sums, place, getattr(self, name))
        return dataclasses.replace(self, x=x, states=numpy.arange(len(x)), **rows)

    def by_position(self) -> "Density":
        """The distribution of (P, V) of a body on a spring, as one of (X, V): rows are the positions `x` [length], evenly
        spaced, with the probabilities of the steps around them."""
        if not self.position:
            raise ValueError("by_position: the density has no positions; they come with -spring_stiffness")
        p, pdf, atom, marginal = (self.position[name] for name in ("p", "pdf", "atom", "marginal_p"))
        return dataclasses.replace(self, x=p, values=pdf, at_rest=atom, marginal_x=marginal, states=numpy.arange(len(p)),
                                   position={})

    @property
    def mass_at_rest(self) -> float:
        """Probability that the body sticks."""
        return float(self.at_rest.sum())

    def __repr__(self) -> str:
        return (f"density of {len(self.x)} states by {len(self.v)} velocities, {self.x[0]:g} <= x <= {self.x[-1]:g}, "
                f"{self.v[0]:.4g} <= v <= {self.v[-1]:.4g}, at rest with probability {self.mass_at_rest:.6g}; "
                + ", ".join(field.name for field in dataclasses.fields(self)))

    def at(self, v: "float | Array") -> "Array":
        """`values` at any velocities, by [x, v], or by [x] at one; 0 beyond the cells."""
        found = self.values @ self._interpolation(numpy.atleast_1d(v)).T
        return found if numpy.ndim(v) else found[:, 0]

    def marginal(self, v: "float | Array") -> "float | Array":
        """`marginal_v` at any velocities, or at one."""
        found = self._interpolation(numpy.atleast_1d(v)) @ self.marginal_v
        return found if numpy.ndim(v) else float(found[0])

    def window(self, outside: float = 1e-3, count: int = 400) -> "Array":
        """Evenly spaced velocities that leave out so much of the probability of sliding, on both sides together."""
        mass = numpy.maximum(self.weights * self.marginal_v, 0)
        below = (numpy.cumsum(mass) - mass / 2) / mass.sum()
        ends = numpy.interp([outside / 2, 1 - outside / 2], below, self.v)
        return numpy.linspace(*ends, count)

    def _interpolation(self, v: "Array") -> "Array":
        """Matrix from the nodes to values at v, of the polynomial through the nodes of each cell."""
        v = numpy.asarray(v, float)
        matrix = numpy.zeros((len(v), len(self.v)))
        of_nodes = numpy.searchsorted(self.cells, self.v) - 1
        of_points = numpy.clip(numpy.searchsorted(self.cells, v) - 1, 0, len(self.cells) - 2)
        inside = (v >= self.cells[0]) & (v <= self.cells[-1])
        for cell in numpy.unique(of_points[inside]):
            points, nodes = numpy.flatnonzero(inside & (of_points == cell)), numpy.flatnonzero(of_nodes == cell)
            low, high = self.cells[cell:cell + 2]
            t, s = ((2 * part - low - high) / (high - low) for part in (v[points], self.v[nodes]))
            for n, node in enumerate(nodes):
                others = numpy.delete(s, n)
                matrix[points, node] = numpy.prod((t[:, None] - others) / (s[n] - others), axis=1)
        return matrix
