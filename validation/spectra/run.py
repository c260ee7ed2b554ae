"""Power spectral density of the velocity.

S_v, the power spectral density of the velocity, is computed at many frequencies. The picture has the panels of the
paper's figure.

Digits that another code has printed are compared in units of their last place. Simulation sums Fourier integrals over
the excursions of random paths instead, and has 95 % confidence intervals.

usage: python3 validation/spectra/run.py [--quick] [--program build/stickslip] [--report FOLDER]
"""

import itertools
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from entry import Entry
from harness import last_place, worse
from known import S_V


def main():
    entry = Entry(__doc__, "the figure of nine panels of spectra")
    values = (1, 0.5, 0.25)
    scenes = list(itertools.product((0.25, 0.5, 1), values, values))
    if entry.quick:
        scenes = [(mu_d, 1, tau) for mu_d in (0.25, 1) for tau in values]
    items = [entry.results(quantities="spectrum", mu_d=mu_d, delta=delta, tau=tau, omega="1e-3:50:120:log",
                           accuracy=1e-5) for mu_d, delta, tau in scenes]
    entry.drawn("spectra", "spectra.png", "S_v against omega by mu_d, delta and tau; mu_s = 1, b(v) = -v", *items)

    worst, rows = 0.0, []
    for delta, digits in S_V.items():
        found = entry.run(quantities="spectrum", mu_d=0.25, delta=delta, omega="0,0.1,1,10",
                          accuracy=1e-8)["results"]["S_v"]["value"]
        worst = worse(worst, *(abs(v - float(d)) / last_place(d) for v, d in zip(found, digits)))
        rows += [(f"1/{1 / delta:.0f}", omega, f"{v:.12g}", d)
                 for omega, v, d in zip(("0", "0.1", "1", "10"), found, digits)]
    entry.table("S_v by the program and by another code: mu_d = 1/4, tau = 1",
                ("delta", "omega", "S_v", "other code"), rows)
    entry.claim("S_v against known digits, in units of the last one", worst, 0.6)

    beside = []
    for mu_d, tau in ((0.25, 1), (1, 0.5)):
        scene = {"quantities": "spectrum", "mu_d": mu_d, "delta": 0.5, "tau": tau,
                 "omega": "0,0.3,1,3,10"}
        known = entry.results(**scene, accuracy=1e-7)["S_v"]
        simulated = entry.results(**scene, route="monte_carlo", excursions=20000 if entry.quick else 300000)["S_v"]
        beside += [(value, error, {"value": found, "ci95": ends}) for value, error, found, ends in
                   zip(known.value, known.error, simulated.value, simulated.ci95)]
    entry.simulated("simulated spectra", beside)
    entry.end()


main()
