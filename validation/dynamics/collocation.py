"""F_slide, F_stick and S_v of small systems by Chebyshev collocation: one polynomial on [0, v_max].

Shares nothing with the program: no elements, no weak form, no grading, no stationary distribution, no
projection, and dense elimination. b(v) = -v, mu_s = tau = 1. Bounded backward functions are analytic in v on [0, v_max] (docs/numerics.md): the error falls geometrically.
"""

import math


def solve(matrix, columns):
    """X with matrix X = columns, by elimination with partial pivoting; lists of rows."""
    size = len(matrix)
    rows = [list(a) + list(b) for a, b in zip(matrix, columns)]
    for n in range(size):
        pivot = max(range(n, size), key=lambda r: abs(rows[r][n]))
        rows[n], rows[pivot] = rows[pivot], rows[n]
        head = rows[n][n:]
        for row in rows[n + 1:]:
            if row[n]:
                factor = row[n] / head[0]
                row[n:] = [a - factor * b for a, b in zip(row[n:], head)]
    for n in reversed(range(size)):
        for c in range(size, len(rows[n])):
            known = sum(a * row[c] for a, row in zip(rows[n][n + 1:size], rows[n + 1:]))
            rows[n][c] = (rows[n][c] - known) / rows[n][n]
    return [row[size:] for row in rows]


def chebyshev(degree, length):
    """Points of [0, length], from 0 upwards, and the matrix that differentiates there."""
    points = [length * (1 - math.cos(math.pi * n / degree)) / 2 for n in range(degree + 1)]
    weight = [(0.5 if n in (0, degree) else 1.0) * (-1) ** n for n in range(degree + 1)]
    derive = [[0.0 if m == n else weight[m] / (weight[n] * (points[n] - points[m]))
               for m in range(degree + 1)] for n in range(degree + 1)]
    for n, row in enumerate(derive):
        row[n] = -sum(row)
    return points, derive


class Scene:
    """Backward functions u(x_i, +1, v) and u(x_i, 0, 0) of one parity, as a vector."""

    def __init__(self, delta, mu_d, degree):
        self.delta, self.mu_d, self.rate = delta, mu_d, 2 / delta**2
        self.top, self.rest = round(self.rate), math.floor(1 / delta + 1e-9)
        self.points, self.derive = chebyshev(degree, self.top * delta - mu_d)
        self.sliding = {}
        for i in range(-self.top, self.top + 1):
            for n in range(degree + 1):
                self.sliding[i, n] = len(self.sliding)
        self.static = {i: len(self.sliding) + i + self.rest
                       for i in range(-self.rest, self.rest + 1)}
        self.size = len(self.sliding) + len(self.static)
        self.exit = self.sliding[self.rest + 1, 0]

    def jumps(self, i):
        up = (1 - self.delta**2 * i / 2) / 2
        both = ((i + 1, self.rate * up), (i - 1, self.rate * (1 - up)))
        return [(j, rate) for j, rate in both if abs(j) <= self.top]

    def arrives(self, i, n):
        """The flow ends at v = 0 there: a condition instead of the equation."""
        return n == 0 and i * self.delta < self.mu_d - 1e-9

    def matrix(self, decay, parity, rest):
        """decay - L; static states `given`, `kept`, or kept and `killed` at the exit."""
        rows = [[0.0] * self.size for _ in range(self.size)]
        for (i, n), here in self.sliding.items():
            row = rows[here]
            if self.arrives(i, n):
                row[here] = 1
                row[self.static[i] if i >= -self.rest else self.sliding[-i, 0]] = \
                    -1 if i >= -self.rest else -parity
                continue
            force = i * self.delta - self.mu_d - self.points[n]
            start = self.sliding[i, 0]
            row[start:start + len(self.points)] = [-force * d for d in self.derive[n]]
            row[here] += decay + self.rate
            for j, rate in self.jumps(i):
                row[self.sliding[j, n]] -= rate
        for i, here in self.static.items():
            row = rows[here]
            row[here] = 1 if rest == "given" else decay + self.rate
            for j, rate in self.jumps(i) if rest != "given" else ():
                if j in self.static:
                    row[self.static[j]] -= rate
                elif rest == "kept":
                    row[self.exit] -= rate if j > 0 else parity * rate
        return rows

    def right_side(self, sliding, static):
        """Of functions of (i, n) and of i."""
        side = [0.0 if self.arrives(i, n) else sliding(i, n) for i, n in self.sliding]
        return side + [static(i) for i in self.static]

    def at_exit(self, matrix, *sides):
        """u(s+) for each right side."""
        return solve(matrix, list(zip(*sides)))[self.exit]


def nothing(*_):
    return 0.0


def transforms(delta, mu_d, decay, degree):
    """F_slide and F_stick at lambda = decay."""
    scene = Scene(delta, mu_d, degree)
    slide, = scene.at_exit(scene.matrix(decay, 1, "given"),
                           scene.right_side(nothing, lambda i: 1.0))
    entry = scene.at_exit(scene.matrix(0.0, 1, "given"), *(
        scene.right_side(nothing, lambda i, k=k: float(i == k)) for k in scene.static))
    chain = scene.matrix(decay, 1, "killed")[len(scene.sliding):]
    leaving = [[sum(rate for j, rate in scene.jumps(i) if j not in scene.static)]
               for i in scene.static]
    sticking = solve([row[len(scene.sliding):] for row in chain], leaving)
    return slide, sum(p * f for p, (f,) in zip(entry, sticking))


def spectrum(delta, mu_d, frequencies, degree):
    """S_v = 2 Re pi(v phi), (i omega - L) phi = v; pi by the averages over an excursion."""
    scene = Scene(delta, mu_d, degree)
    velocity = scene.right_side(lambda i, n: scene.points[n], nothing)
    sides = [scene.right_side(lambda i, n: 1.0, lambda i: 1.0)]
    for omega in frequencies:
        phi = solve(scene.matrix(1j * omega, -1, "kept"), [[x] for x in velocity])
        sides.append(scene.right_side(
            lambda i, n: scene.points[n] * phi[scene.sliding[i, n]][0].real, nothing))
    time, *integrals = scene.at_exit(scene.matrix(0.0, 1, "killed"), *sides)
    return [2 * integral / time for integral in integrals]
