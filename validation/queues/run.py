"""Fluid queues: documented examples of other programs, and on-off sources.

A queue that fills at the rates r of the states of a chain, and is empty for a while where they are negative, is a
body without drag that cannot slide backwards: the states have the forces r + mu, mu_d = mu_s = mu, and no force
reaches the other threshold. So results of queueing theory must come out.

Means and weights follow besides from eigenvalues, and printed digits from the manuals of BuTools (GeneralFluidSolve)
and DiscretisedFluidQueues.jl, whose example is given another rate so that it is stable. The exponents of on-off
sources are those of Anick, Mitra and Sondhi, roots of quadratic equations.

usage: python3 validation/queues/run.py [--quick] [--program build/stickslip] [--report FOLDER]
"""

import pathlib
import sys

import numpy
import scipy.linalg

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from entry import Entry
from harness import difference, worse
from stickslip.noise import Chain

MU, FAR = 1.0, 1e3  # what holds a body at rest, and what lets none slide backwards
BUTOOLS = (numpy.array([[-6, 1, 3, 2, 0, 0], [6, -10, 2, 0, 2, 0], [3, 7, -12, 0, 0, 2],
                        [5, 0, 0, -9, 1, 3], [0, 5, 0, 6, -13, 2], [0, 0, 5, 3, 7, -15]], float),
           numpy.array([2, -4, -12, 6, 0, -8], float))
PRINTED_WEIGHTS = (0, 0.082246, 0.069492, 0, 0.023812, 0.020724)
THREE_PHASES = numpy.array([[-2.5, 2, 0.5], [1, -2, 1], [1, 2, -3]]), numpy.array([0, 2, -7.0])


def sources(count, on, capacity):
    """On-off sources of unit rate that fall silent at the rate 1, and begin at the rate `on`."""
    rates = numpy.zeros((count + 1, count + 1))
    for n in range(count):
        rates[n, n + 1], rates[n + 1, n] = on * (count - n), n + 1
    return rates - numpy.diag(rates.sum(1)), numpy.arange(count + 1) - capacity


def spectral(generator, rates):
    """Weights of an empty queue by state, E V and E V^2, and the exponents z: F(v) = p + sum_k a_k f_k exp(z_k v) with
    z f R = f Q, and F = 0 at v = 0 in states that fill it."""
    values, vectors = scipy.linalg.eig(generator.T, numpy.diag(rates))
    kept = numpy.isfinite(values) & (values.real < -1e-9)
    z, f = values[kept], vectors[:, kept]
    p = numpy.linalg.lstsq(numpy.vstack([generator.T, numpy.ones(len(rates))]),
                           [*numpy.zeros(len(rates)), 1], rcond=None)[0]
    a = numpy.linalg.solve(f[rates > 0], -p[rates > 0])
    shares = a * f.sum(0)
    return (p + f @ a).real, (shares / z).sum().real, (-2 * shares / z**2).sum().real, z


def by_formula(count, on, capacity):
    """The exponents of on-off sources: roots of quadratic equations (Anick, Mitra and Sondhi)."""
    found, full = [], count / 2 - capacity
    for k in range(count // 2 + 1):
        far = (count / 2 - k) ** 2
        roots = numpy.roots([far - full**2, 2 * (1 - on) * far - count * (1 + on) * full,
                             -(1 + on) ** 2 * ((count / 2) ** 2 - far)]).real
        found += list(roots if far else roots[:1])  # without `far` both are one
    return [root for root in found if root < -1e-9]


def queue(entry, name, generator, rates):
    """Runs it both ways; the weights at rest by state, and rows of the table."""
    scene = {"noise": Chain(rates + MU, generator), "drag": "none", "mu_s": MU, "mu_d": MU, "mu_s_minus": FAR,
             "mu_d_minus": FAR}
    found = entry.results(**scene, quantities="sticking,moments,density", accuracy=1e-11)
    density = found.density
    weights = numpy.zeros(len(rates))
    weights[list(density.states)] = density.at_rest
    other = entry.run(**scene, route="fluid_queue", quantities="sticking")["results"]
    known = spectral(generator, rates)
    pairs = [("P_stick", found["P_stick"].value, known[0].sum()), ("E_V", found["E_V"].value, known[1]),
             ("E_V2", found["E_V2"].value, known[2]),
             ("P_stick, route fluid_queue", other["P_stick"]["value"], known[0].sum())]
    return weights, [(name, key, f"{value:.12g}", f"{exact:.12g}", difference(value, exact)) for key, value, exact in pairs]


def main():
    entry = Entry(__doc__, "beyond the paper")
    weights, rows = queue(entry, "butools", *BUTOOLS)
    entry.claim("weights of an empty queue that BuTools prints, absolute",
                worse(*(abs(weights - PRINTED_WEIGHTS))), 1e-6)
    rows += queue(entry, "three_phases", *THREE_PHASES)[1]
    for count, on, capacity in ((1, 0.4, 0.5), (8, 0.3, 2.6), (20, 0.2, 4.4)):
        rows += queue(entry, f"{count}_sources", *sources(count, on, capacity))[1]
        exponents = sorted(spectral(*sources(count, on, capacity))[3].real)
        entry.claim(f"exponents of {count} on-off sources by eigenvalues and by formula, relative", worse(*(
            difference(one, other) for one, other in zip(exponents, sorted(by_formula(count, on, capacity)), strict=True))),
            1e-9)
    # One source of capacity c: empty with the probability 1 - p/c, and exponential otherwise.
    p, c = 0.4 / 1.4, 0.5
    exact = {"P_stick": 1 - p / c, "E_V": p / c / (1 / (1 - c) - 0.4 / c)}
    entry.claim("one on-off source by its closed form, relative", worse(*(
        difference(float(value), exact[key]) for name, key, value, *_ in rows if name == "1_sources" and key in exact)), 1e-10)
    entry.table("Fluid queues by the program and by eigenvalues",
                ("queue", "quantity", "found", "by eigenvalues", "relative difference"), rows)
    entry.claim("fluid queues by eigenvalues, relative", worse(*(row[-1] for row in rows)), 1e-9)
    entry.end()


main()
