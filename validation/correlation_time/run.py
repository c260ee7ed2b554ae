"""Correlation time of the velocity against that of the noise.

The correlation time t_corr is the inverse of the full width of the spectrum at half its maximum. The figure of the
paper shows how it depends on the correlation time tau of the noise, for several values of mu_d and without drag.

As tau -> 0 the noise becomes white. For mu_d = mu_s the velocity is then a diffusion, whose correlation time is known
without any noise levels: the curves must tend to it.

usage: python3 validation/correlation_time/run.py [--quick] [--program build/stickslip]
                                                  [--report FOLDER]
"""

import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from entry import Entry
from harness import difference, worse
from known import T_CORR

CURVES = [("linear", mu_d) for mu_d in (1, 0.75, 0.5, 0.25)] + [("none", 1)]


def main():
    entry = Entry(__doc__, "the figure of correlation times")
    last = 3 if entry.quick else 6
    delta = 0.5 if entry.quick else 0.25
    times, items = {}, []
    for drag, mu_d in CURVES:
        for n in range(last + 1):
            items.append(entry.results(quantities="spectrum", mu_d=mu_d, drag=drag, delta=delta, tau=2.0**-n,
                                       accuracy=1e-4))
            times[drag, mu_d, n] = items[-1]["t_corr"].value
    entry.drawn("correlation_time", "correlation_time.png",
                "t_corr, one over the full width of S_v at half maximum, against tau; "
                f"mu_s = 1, delta = {delta:g}", *items)
    entry.table("t_corr by drag law, mu_d and tau", ("drag", "mu_d", *(f"tau = 2^-{n}" for n in range(last + 1))),
                [(drag, f"{mu_d:g}", *(times[drag, mu_d, n] for n in range(last + 1)))
                 for drag, mu_d in CURVES])
    if not entry.quick:
        entry.claim("change of t_corr from tau = 1/8 to 1/64, relative", worse(*(
            difference(times[drag, mu_d, 3], times[drag, mu_d, 6]) for drag, mu_d in CURVES)), 0.06)
    entry.claim(f"t_corr at tau = 2^-{last} from white noise, mu_d = mu_s, relative", worse(*(
        difference(times[drag, 1, last], limit) for drag, limit in T_CORR.items())),
        0.1 if entry.quick else 0.01)
    entry.end()


main()
