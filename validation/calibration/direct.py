"""Dynamics of noises of a few levels by dense complex solves: what stands for the truth in calibration.

Shares nothing with the program: Chebyshev collocation of backward functions u(x_i, sign v, |v|) on panels of |v|,
which shrink towards rest and end where drag balances the largest force, and Laplace transforms inverted by Euler summation (Abate and
Whitt, ORSA J. Comput. 7, 1995, 36). Bounded backward functions are analytic on each panel; what two degrees of the
polynomials and two lengths of the sums differ by is the error stated. Drag has to bound the velocity, and no force
may vanish at rest. Short times need waves in v that these degrees do not follow: times from 1/rate on are for them.
"""

import functools
import math
import re
import warnings

import numpy
from scipy import linalg, optimize

LARGEST = 18.4  # exp(-LARGEST) is the relative error of discretising the inversion


def chebyshev(degree, low, high):
    """Points from low up to high, and the matrix that differentiates there."""
    n = numpy.arange(degree + 1)
    x = (1 - numpy.cos(math.pi * n / degree)) / 2
    weight = numpy.where((n == 0) | (n == degree), 0.5, 1.0) * (-1.0) ** n
    gap = x[:, None] - x[None, :] + numpy.eye(degree + 1)
    d = weight[None, :] / weight[:, None] / gap
    d -= numpy.diag(d.sum(axis=1))
    return low + (high - low) * x, d / (high - low)


class Few:
    """Levels (x, rate up, rate down) with Coulomb friction, an odd drag b, and a bias."""

    def __init__(self, levels, mu_s, mu_d, drag, bias=0.0, breaks=(), degree=15):
        self.x, self.up, self.down = (numpy.array(column, float) for column in zip(*levels))
        self.force, self.count = self.x + bias, len(levels)
        self.static = [i for i in range(self.count) if abs(self.force[i]) <= mu_s]
        self.mu_d, self.drag = mu_d, drag
        self.panels = {}  # by sign: points and derivatives
        self.at, size = {}, 0
        for sign in (1, -1):
            strongest = (sign * self.force).max() - mu_d
            if strongest <= 0:
                continue  # bodies thrown to this side are slowed down by all levels; others have modes there
            high = 1.0
            while strongest + drag(high) > 0:
                high *= 2
            end = optimize.brentq(lambda v: strongest + drag(v), 0, high, xtol=1e-15, rtol=1e-15)
            edges = [0.0, *sorted(b for b in (*breaks, 0.01 * end, 0.06 * end, 0.3 * end) if 0 < b < end), end]
            self.panels[sign] = [chebyshev(degree, *edge) for edge in zip(edges, edges[1:])]
            for i in range(self.count):
                for p in range(len(self.panels[sign])):
                    self.at[sign, i, p] = size
                    size += degree + 1
        self.rest = {i: size + n for n, i in enumerate(self.static)}
        self.size = size + len(self.static)
        self.degree = degree
        self.speed, self.level, self.sign = (numpy.zeros(self.size) for _ in range(3))
        for (sign, i, p), start in self.at.items():
            here = slice(start, start + degree + 1)
            self.speed[here], self.level[here], self.sign[here] = self.panels[sign][p][0], self.x[i], sign
        for i, here in self.rest.items():
            self.level[here] = self.x[i]
        self.velocity, self.at_rest = self.sign * self.speed, self.sign == 0
        self.exits = {s: self.at[s, i, 0] for s, i in ((1, self.static[-1] + 1), (-1, self.static[0] - 1))
                      if s in self.panels and i in range(self.count)}
        self.fixed = numpy.zeros(self.size, bool)  # rows with a condition instead of the equation
        self.kept, self.killed = (self._generator(kept) for kept in (True, False))

    def _outside(self, sign, i, p, last):
        """Where bodies go that leave panel p of a level downwards or upwards."""
        if last:
            return self.at[sign, i, p + 1]
        if p > 0:
            return self.at[sign, i, p - 1] + self.degree
        return self.rest[i] if i in self.rest else self.at[-sign, i, 0]

    def _generator(self, kept):
        """L, with rows of conditions u - u' = 0 where the flow leaves a panel; `kept`: bodies that leave rest slide."""
        m = numpy.zeros((self.size, self.size))
        for (sign, i, p), start in self.at.items():
            points, derive = self.panels[sign][p]
            flow = sign * self.force[i] - self.mu_d + self.drag(points)
            here = numpy.arange(start, start + len(points))
            m[numpy.ix_(here, here)] += flow[:, None] * derive
            self._jump(m, here, i, lambda j: here - start + self.at[sign, j, p])
            last = p + 1 < len(self.panels[sign]) and flow[-1] > 0
            for leaves, row in ((flow[0] < 0, start), (last, start + len(points) - 1)):
                if leaves:
                    m[row] = 0
                    m[row, row], self.fixed[row] = 1, True
                    m[row, self._outside(sign, i, p, row > start)] = -1
        for i, here in self.rest.items():
            def target(j):
                return self.rest.get(j, self.exits.get(1 if j > i else -1) if kept else None)
            self._jump(m, here, i, target)
        return m

    def _jump(self, m, here, i, target):
        for j, rate in ((i + 1, self.up[i]), (i - 1, self.down[i])):
            if rate > 0:
                m[here, here] -= rate
                if target(j) is not None:
                    m[here, target(j)] += rate

    def solve(self, generator, decay, side, given=None):
        """u with (decay - L) u = side; decay a number or one for each state; `given` fixes u at rest."""
        a = self.system(generator, decay)
        b = numpy.array(side, a.dtype)
        b[self.fixed] = 0
        if given is not None:
            a[self.at_rest] = numpy.eye(self.size)[self.at_rest]
            b[self.at_rest] = given
        return linalg.solve(a, b)

    def system(self, generator, decay):
        a = numpy.diag(numpy.broadcast_to(decay, self.size) + 0.0) - generator
        a[self.fixed] = generator[self.fixed]
        return a

    def leaving(self, sign):
        """Rates of leaving rest to that side."""
        side = numpy.zeros(self.size)
        edge = self.static[-1] if sign > 0 else self.static[0]
        if sign in self.exits:
            side[self.rest[edge]] = self.up[edge] if sign > 0 else self.down[edge]
        return side

    @functools.cached_property
    def shares(self):
        """Of excursions, by the side on which they start."""
        if len(self.exits) == 1:
            return dict.fromkeys(self.exits, 1.0)
        turn = {s: self.solve(self.killed, 0, self.leaving(-s))[e] for s, e in self.exits.items()}
        return {s: turn[-s] / (turn[1] + turn[-1]) for s in self.exits}

    def at_exits(self, u):
        """Where excursions start."""
        return sum(share * u[self.exits[s]] for s, share in self.shares.items())

    @functools.cached_property
    def occupation(self):
        """Mean times of an excursion in the states: the integral of f over it is their product with f."""
        starts = numpy.zeros(self.size)
        for sign, share in self.shares.items():
            starts[self.exits[sign]] = share
        found = linalg.solve(self.system(self.killed, 0).T, starts)
        found[self.fixed] = 0
        return found

    def mean(self, f):
        """Stationary average of a vector of values."""
        return self.occupation @ f / self.occupation.sum()

    @functools.cached_property
    def centred(self):
        return self.velocity - self.mean(self.velocity).real

    def spectrum(self, omega):
        """S_v = 2 Re pi(v phi), (i omega - L) phi = v - E[v]."""
        v = self.centred
        return numpy.array([2 * self.mean(v * self.solve(self.kept, 1j * w, v)).real for w in omega])

    def autocovariance(self, s):
        v = self.centred
        return self.mean(v * self.solve(self.kept, s, v))

    def expectation(self, f, s):
        """Laplace transform of E[f] from s+."""
        return self.solve(self.kept, s, f)[self.exits[1]]

    def from_state(self, f, level, speed, s):
        """Laplace transform of E[f] from a state on a break between panels, moving upwards."""
        i = int(numpy.abs(self.x - level).argmin())
        panel = next(p for p, (points, _) in enumerate(self.panels[1]) if points[0] == speed)
        return self.solve(self.kept, s, f)[self.at[1, i, panel]]

    def slide(self, s):
        return self.at_exits(self.solve(self.killed, s, numpy.zeros(self.size), 1.0))

    def excursion(self, s):
        return self.at_exits(self.solve(self.killed, s, self.leaving(1) + self.leaving(-1)))

    def slip(self, s):
        return self.at_exits(self.solve(self.killed, s * self.speed, numpy.zeros(self.size), 1.0))

    def rates(self):
        """Eigenvalues of -L but 0, by rising real part."""
        mass = numpy.diag((~self.fixed).astype(float))
        found = linalg.eigvals(-numpy.where(self.fixed[:, None], 0, self.kept) + numpy.where(
            self.fixed[:, None], self.kept, 0), mass)
        found = found[numpy.isfinite(found) & (numpy.abs(found) > 1e-8) & (numpy.abs(found) < 1e6)]
        return found[numpy.argsort(found.real, kind="stable")]


class Inversion:
    """The function of t > 0 with this Laplace transform, and what two methods or lengths of a sum differ by.

    Euler summation for what has kinks in time; Talbot's contour (Int. J. Numer. Meth. Engng 60, 2004, 979), which
    avoids waves that no polynomial follows, for what is smooth. Short contours of nearly one length lose the same
    waves: 10 and 12 points agreed to 6e-5 where both were wrong by 3e-3.
    """

    def __init__(self, transform):
        self.transform = transform

    def at(self, t):
        pairs = [[method(self.transform, t, n) for n in lengths]
                 for method, lengths in ((talbot, (16, 24)), (euler, (20, 30)))]
        doubts = [2 * abs(a - b) + 1e-8 * abs(b) for a, b in pairs]
        best, apart = int(numpy.argmin(doubts)), abs(pairs[0][1] - pairs[1][1])
        return pairs[best][1], apart if apart > sum(doubts) else doubts[best]


def euler(transform, t, terms):
    values = [(-1) ** k * transform((LARGEST + 2j * math.pi * k) / (2 * t)).real for k in range(terms + 12)]
    sums = numpy.cumsum([values[0] / 2, *values[1:]])
    weights = numpy.array([math.comb(11, k) for k in range(12)]) / 2.0**11
    return math.exp(LARGEST / 2) / t * (weights @ sums[terms:terms + 12])


def talbot(transform, t, terms):
    r = 2 * terms / (5 * t)
    total = 0.5 * math.exp(r * t) * transform(complex(r)).real
    for k in range(1, terms):
        angle = k * math.pi / terms
        cot = 1 / math.tan(angle)
        s = r * angle * (cot + 1j)
        total += (numpy.exp(t * s) * transform(s) * (1 + 1j * (angle + (angle * cot - 1) * cot))).real
    return r / terms * total


def drag_of(options):
    if options["drag"] == "expression":
        first, second = map(float, re.findall(r"[0-9.e+-]*[0-9]", options["drag_expression"])[:2])
        return lambda v: -abs(first) * v - abs(second) * v * v
    first, third = options["drag_coefficient"], options.get("drag_cubic", 0.0)
    return lambda v: -first * v - third * v**3


def numbers(options, name):
    return [float(word) for word in str(options[name]).split(",")]


def stationary(few):
    """Scalars of sticking and moments."""
    v, cycle = few.velocity, few.occupation.sum()
    slide = few.at_exits(few.solve(few.killed, 0, numpy.ones(few.size), 0.0))
    averages = {"P_stick": few.at_rest, "P_slide": ~few.at_rest, "E_V2": v**2, "E_absV": abs(v), "E_XV": few.level * v}
    return {"mean_slide": slide, "mean_stick": cycle - slide, "mean_excursion": cycle,
            **{key: few.mean(f) for key, f in averages.items()}}


def observable(few, text):
    """Of those that the groups ask for; a point at a jump belongs to the panel that it ends."""
    if text == "v":
        return few.velocity
    if text == "stick":
        return few.at_rest.astype(float)
    limit = float(text.removeprefix("abs(v)>"))
    inside = numpy.zeros(few.size, bool)
    for (sign, _, p), start in few.at.items():
        points = few.panels[sign][p][0]
        inside[start:start + len(points)] = points.mean() > limit
    return inside.astype(float)


def made(options, degree):
    breaks = [float(text.removeprefix("abs(v)>")) for text in options.get("observable", "").split(";")
              if text.startswith("abs")]
    if "," in options.get("start", ""):
        breaks.append(numbers(options, "start")[1])
    return Few(options["levels"], options["mu_s"], options["mu_d"], drag_of(options), options.get("bias", 0.0), breaks,
               degree)


def truth(options):
    """Values and doubts by key, as far as asked for and known; every eigenvalue under `rates`."""
    warnings.simplefilter("ignore", linalg.LinAlgWarning)  # Talbot's contour comes near to eigenvalues
    coarse, fine = (made(options, degree) for degree in (11, 15))
    asked = options["quantities"].split(",")
    found = {}

    def both(values):
        a, b = values(coarse), values(fine)
        found.update({key: numpy.atleast_1d(b[key], 2 * abs(a[key] - b[key]) + 1e-12 * abs(b[key])) for key in b})

    def over(name, transform, **keys):
        """Functions by key, each a factor of the transform."""
        a, b = (functools.lru_cache(None)(lambda s, few=few: complex(transform(few, s))) for few in (coarse, fine))
        for key, factor in keys.items():
            pairs = [[Inversion(lambda s: once(s) * factor(s)).at(t) for once in (a, b)] for t in numbers(options, name)]
            found[key] = tuple(numpy.array(column) for column in zip(*(
                (value, doubt + 10 * abs(other - value)) for (other, _), (value, doubt) in pairs)))

    def itself(s):
        return 1

    def integral(s):
        return 1 / s

    if "sticking" in asked:
        both(stationary)
    if "spectrum" in asked:
        both(lambda few: {"S_v": few.spectrum(numbers(options, "omega"))})
    if "relaxation" in asked:
        a, b = coarse.rates(), fine.rates()
        found["rates"] = b, numpy.array([2 * abs(a - one).min() + 1e-12 * abs(one) for one in b])
    if "autocorrelation" in asked:
        over("time", Few.autocovariance, C_vv=itself)
    if "duration_density" in asked:
        over("time", Few.slide, f_slide=itself, cdf_slide=integral)
        over("time", Few.excursion, f_excursion=itself, cdf_excursion=integral)
    if "slip" in asked:
        over("distance", Few.slip, f_slip=itself, cdf_slip=integral)
    for text in options.get("observable", "").split(";"):
        if "averages" in asked:
            both(lambda few: {f"pi({text})": few.mean(observable(few, text))})
        if "," in options.get("start", ""):
            start = numbers(options, "start")
            over("time", lambda few, s: few.from_state(observable(few, text), *start, s),
                 **{f"E({text})": itself, "displacement_mean": integral})
        elif "expectation" in asked:
            over("time", lambda few, s: few.expectation(observable(few, text), s), **{f"E({text})": itself})
    return found
