"""Effects one by one: bias, unequal drag, sweeps, and predictions of their cost.

Each effect that breaks the symmetry of the paper's model is compared with what it was not computed from. A bias and
unequal drag: with simulation, for all results that both methods have. The drift E[V] under a bias g without drag:
with its limit in white noise, 2 g/(mu^2 - g^2), which is known in closed form.

In the long form, predicted memory is compared with measured memory, and a sweep with separate runs.

usage: python3 validation/effects/run.py [--quick] [--program build/stickslip] [--report FOLDER]

--quick simulates 3*10^4 excursions instead of 10^6, and times nothing.
"""

import itertools
import pathlib
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from entry import Entry, deviation
from harness import difference, worse

SCENE = {"mu_s": 1, "mu_d": 0.7, "delta": 0.25}
BIASES = (0.1, 0.5, 1.5)  # the last beyond mu_s
ASKED = "sticking,moments,noise_law,spectrum"
RATCHET = {"mu_s": 0.5, "mu_d": 0.25, "delta": 0.25, "drag": "expression",
           "drag_expression": "v > 0 ? (0-3)*v : (0-0.5)*v"}
PREDICTED = (  # cases whose cost does not depend on an adaptive solver
    {"delta": 0.125}, {"delta": 0.0625, "mu_d": 0.25}, {"delta": 0.03125, "accuracy": 1e-8},
    {"delta": 0.0625, "quantities": "sticking,moments,entry_law,laplace", "lambda": "0.1,1,10"},
    {"delta": 0.125, "quantities": "sticking,moments,sensitivity"},
    {"delta": 0.125, "bias": 0.3, "quantities": "moments,laplace", "lambda": "0.1,1"})


def scalars(summary):
    return {key: r for key, r in summary["results"].items() if not isinstance(r["value"], list)}


def simulations(entry):
    """Deterministic values without symmetry beside simulated ones."""
    excursions = 3 * 10**4 if entry.quick else 10**6
    scenes = [(f"bias {g}", {**SCENE, "bias": g}) for g in BIASES] + [("ratchet", RATCHET)]
    rows, beside = [], []
    for name, scene in scenes:
        exact = scalars(entry.run(quantities=ASKED, accuracy=1e-9, **scene))
        count = excursions // 4 if name == "ratchet" else excursions
        simulated = scalars(entry.run(quantities=ASKED, route="monte_carlo", excursions=count,
                                      **scene))
        for key, s in simulated.items():
            beside.append((exact[key]["value"], exact[key]["error"], s))
            z = deviation(*beside[-1])
            rows.append((name, key, f"{exact[key]['value']:.10g}", s["value"], *s["ci95"], z))
    entry.table(f"Deterministic and simulated values without symmetry ({excursions} excursions from each side; a "
                "quarter for the ratchet)",
                ("scene", "quantity", "value", "simulated", "low", "high", "z"), rows)
    inside = sum(abs(deviation(*one)) < 1.96 for one in beside) / len(beside)
    entry.at_least("share of 95 % confidence intervals that hold the deterministic value", inside, 0.85)
    entry.simulated("simulations", beside)


def drift_in_white_noise(entry):
    """b = 0: E[V] -> 2 g/(mu^2 - g^2) as tau -> 0."""
    rows, found = [], []
    for g in (0.1, 0.5, 0.9):
        values = [entry.run(drag="none", mu_s=1, mu_d=1, bias=g, tau=tau, delta=1,
                            quantities="moments", accuracy=1e-9)["results"]["E_V"]["value"]
                  for tau in (1 / 16, 1 / 32, 1 / 64)]
        first = [2 * b - a for a, b in itertools.pairwise(values)]
        limit, expected = (4 * first[1] - first[0]) / 3, 2 * g / (1 - g * g)
        found.append(difference(limit, expected))
        rows.append((f"{g}", *values, limit, expected))
    entry.table("E[V] without drag under a bias g, and its limit in white noise; mu_d = mu_s = 1",
                ("bias", "tau = 1/16", "1/32", "1/64", "extrapolated", "2 g/(mu^2 - g^2)"), rows)
    entry.claim("the drift tends to that in white noise, relative", worse(*found), 1e-3)


def pictures(entry):
    """The drift and the diffusivity as the bias grows."""
    count = 5 if entry.quick else 41
    swept = entry.results(mu_s=1, mu_d=1, delta=0.125, quantities="sticking,moments,spectrum", accuracy=1e-5,
                          sweep_bias=f"0.025:2.025:{count}")
    entry.drawn("drift", "drift.png", "Drift, diffusivity and sticking under a bias: from creep "
                "to motion that friction only slows down.", swept)


def costs(entry):
    """What -plan predicts beside what was spent on the same steps."""
    rows, off = [], []
    for scene in PREDICTED:
        plan = entry.run(**scene, plan="yes")["plan"]["steps"]
        spent = entry.run(**scene)["cost"]["steps"][:len(plan)]
        predicted, real = (sum(s["seconds"] for s in steps) for steps in (plan, spent))
        # Two-level p-corrections have no factors of their own.
        entries, memory = (max(s[key] for s in plan) / max(s[key] for s in spent)
                           for key in ("factor_entries", "factor_megabytes"))
        off += [max(memory, 1 / memory)]
        rows.append((" ".join(f"{k} {v}" for k, v in scene.items()), predicted, real, predicted / real,
                     entries, memory))
    entry.table("Predicted cost over real cost, two steps", ("scene", "predicted s", "real s",
                                                            "seconds", "entries", "memory"), rows)
    entry.claim("memory of the factors, ratio of predicted to measured or its inverse", worse(*off), 1.5)


def sweep_cost(entry):
    """100 points in one run and in 100."""
    mu_d = [f"{n / 10:g}" for n in range(1, 11)]
    tau = [f"{2 ** (n / 3 - 1):.6g}" for n in range(10)]
    program = str(entry.program.path)
    with tempfile.TemporaryDirectory() as folder:
        start = time.monotonic()
        subprocess.run([program, "-delta", "0.25", "-sweep_mu_d", ",".join(mu_d), "-sweep_tau",
                        ",".join(tau), "-sweep_csv", f"{folder}/points.csv"], check=True,
                       capture_output=True)
        together = time.monotonic() - start
        start = time.monotonic()
        for d, t in itertools.product(mu_d, tau):
            subprocess.run([program, "-delta", "0.25", "-mu_d", d, "-tau", t], check=True,
                           capture_output=True)
        apart = time.monotonic() - start
    entry.table("100 points (10 of mu_d, 10 of tau) at delta = 1/4", ("one sweep s", "100 runs s", "ratio"),
                [(together, apart, together / apart)])
    entry.claim("cost of the sweep relative to separate runs", together / apart, 0.6)


def main():
    entry = Entry(__doc__, "beyond the paper")
    simulations(entry)
    drift_in_white_noise(entry)
    pictures(entry)
    if not entry.quick:
        costs(entry)
        sweep_cost(entry)
    entry.end()


main()
