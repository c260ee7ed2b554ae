"""The method of the paper in SciPy: upwind differences on the full grid, one LU factorisation.

usage: python3 scipy_paper.py DELTA MU_D P LAMBDA

mu_s = tau = 1, b(v) = -v, all levels of the noise. Solves (lambda - M) u = f for the indicators of
sticking and of |x| <= mu_s and for v^2; prints lambda u at the exit state (x_{k+1}, +1, 0), and the
seconds of assembly, factorisation and solves.
"""

import sys
import time

import numpy
import scipy.sparse
import scipy.sparse.linalg

MU_S = TAU = 1.0


class Grid:
    """The points (x_i, v_j) of the paper; sign is Theta(x_i, v_j), 0 in the static phase."""

    def __init__(self, delta, p):
        self.delta, self.step = delta, delta / p
        self.levels = round(2 / (TAU * delta**2))
        self.k = int(MU_S / delta + 1e-9)
        self.half = self.levels * p
        self.shape = (2 * self.levels + 1, 2 * self.half + 1)
        i = numpy.arange(-self.levels, self.levels + 1)
        j = numpy.arange(-self.half, self.half + 1)
        self.i, self.j = numpy.meshgrid(i, j, indexing="ij")
        self.x, self.v = self.i * delta, self.j * self.step
        self.static = (self.j == 0) & (abs(self.i) <= self.k)
        self.sign = numpy.where(self.j == 0, numpy.sign(self.i), numpy.sign(self.j))
        self.sign[self.static] = 0
        self.number = numpy.arange(self.x.size).reshape(self.shape)

    def exit_state(self):
        return self.number[self.levels + self.k + 1, self.half]


def generator(grid, mu_d):
    """M: jumps of the noise, and differences in v against the flow."""
    rate = 2 / (TAU * grid.delta) ** 2
    up = rate * (1 - TAU * grid.delta * grid.x / 2) / 2
    up[0], up[-1] = rate, 0
    force = numpy.where(grid.static, 0, grid.x - grid.v - mu_d * grid.sign)
    moves = ((up, 1, 0), (rate - up, -1, 0), (numpy.maximum(force, 0) / grid.step, 0, 1),
             (numpy.maximum(-force, 0) / grid.step, 0, -1))
    rows, columns, values = [], [], []
    leaving = numpy.zeros(grid.shape)
    for value, di, dj in moves:
        here = value > 0
        rows.append(grid.number[here])
        columns.append(grid.number[here] + di * grid.shape[1] + dj)
        values.append(value[here])
        leaving[here] += value[here]
    rows.append(grid.number.ravel())
    columns.append(grid.number.ravel())
    values.append(-leaving.ravel())
    entries = (numpy.concatenate(values), (numpy.concatenate(rows), numpy.concatenate(columns)))
    return scipy.sparse.csc_matrix(entries, shape=(grid.x.size, grid.x.size))


def grid_functions(delta, mu_d, p, decay):
    """The grid, and lambda u on all of it by quantity."""
    grid = Grid(delta, p)
    system = decay * scipy.sparse.identity(grid.x.size, format="csc") - generator(grid, mu_d)
    factors = scipy.sparse.linalg.splu(system)
    functions = {"P_stick": grid.static, "E_V2": grid.v**2,
                 "P_X_le_mu_s": abs(grid.i) <= grid.k}
    return grid, {name: decay * factors.solve(f.astype(float).ravel())
                  for name, f in functions.items()}


def averages(delta, mu_d, p, decay):
    grid, found = grid_functions(delta, mu_d, p, decay)
    return {name: u[grid.exit_state()] for name, u in found.items()}


def main():
    if len(sys.argv) != 5:
        sys.exit(__doc__)
    delta, mu_d, decay = (float(sys.argv[n]) for n in (1, 2, 4))
    start = time.perf_counter()
    found = averages(delta, mu_d, int(sys.argv[3]), decay)
    found["seconds"] = time.perf_counter() - start
    for name, value in found.items():
        print(f"{name} {value:.16g}")


if __name__ == "__main__":
    main()
