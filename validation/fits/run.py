"""How often intervals of fitted parameters hold the values that the data were simulated with.

Data sets are simulated with known parameters, the parameters are fitted to each of them, and it is counted how often
the 95 % confidence intervals of the fits hold the known values: 95 of 100 should. Distances of the estimates from the
truth, in units of the standard errors, should be normal with mean 0 and deviation 1. The data are durations, path
lengths of slips, and averages with their errors.

usage: python3 validation/fits/run.py [--quick] [--program build/stickslip] [--report FOLDER]
"""

import pathlib
import sys
import warnings

import numpy
import scipy.stats

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from entry import Entry, subplots
import stickslip
from stickslip.plots.style import COLOURS

MODEL = {"mu_s": 1, "delta": 0.25}
TRUE = {"mu_d": 0.3, "tau": 1.5}
ON_A_LEVEL = {"delta_per_mu_s": 4}  # the same step
HORIZON = 6     # times that the wanted observations take on average
CHANCE = 1e-3   # that a claim about the counts fails although intervals are right


def path_samples(path, mu_d):
    """Durations of sticking and sliding phases and path lengths of the latter, of a path whose drag is -v: between two
    events dV = (x - mu_d y - V) dt, and V keeps its sign."""
    time, x, y, v = (path[name] for name in ("time", "x", "y", "v"))
    steps = numpy.diff(time)
    lengths = y[:-1] * ((x - mu_d * y)[:-1] * steps - numpy.diff(v))
    at_rest = y == 0
    ends = numpy.flatnonzero(at_rest[1:] != at_rest[:-1]) + 1  # rows at which a phase begins
    begin, end = ends[:-1], ends[1:]
    whole = numpy.append(0, numpy.cumsum(lengths))
    resting = at_rest[begin]
    return {"sticks": (time[end] - time[begin])[resting], "slides": (time[end] - time[begin])[~resting],
            "slips": (whole[end] - whole[begin])[~resting]}


def samples(entry, trials, counts, smallest):
    """A data set for each trial: so many observations of each kind, those that are too small left out."""
    found = []
    for path in stickslip.map([{**MODEL, **TRUE, "quantities": "trajectory", "seed": trial + 1,
                                "horizon": HORIZON * 4 * max(counts.values())} for trial in range(trials)],
                              program=entry.program.path):
        drawn = path_samples(path.trajectory, TRUE["mu_d"])
        seen = {name: part[part > smallest.get(name, 0)][:counts[name]] for name, part in drawn.items() if name in counts}
        if any(part.size < counts[name] for name, part in seen.items()):
            sys.exit("a path is too short")
        found.append({**seen, "smallest": smallest} if smallest else seen)
    return found


def values(entry, trials, quantities, excursions):
    """A data set for each trial: each key from a simulation of its own, with its standard error."""
    cases = [{**MODEL, **TRUE, "quantities": word, "route": "monte_carlo", "excursions": excursions,
              "seed": trial * len(quantities) + n + 1} for trial in range(trials) for n, word in enumerate(quantities.values())]
    runs = iter(stickslip.map(cases, program=entry.program.path))
    found = []
    for _ in range(trials):
        found.append({})
        for key in quantities:
            result = next(runs)[key]
            found[-1][key] = (result.value, numpy.subtract(*result.ci95[::-1]) / 2 / scipy.stats.norm.ppf(0.975))
    return found


def outcomes(entry, data, free, **fixed):
    """Of each trial and parameter: distance of the estimate from the truth in standard errors, and whether the interval
    holds it; how many fits did not converge."""
    true = {**MODEL, **TRUE}
    pulls, held, lost = [], [], 0
    for one in data:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", UserWarning)
            fit = stickslip.fit(one, free, {name: 0.8 * true[name] for name in free}, program=entry.program.path, **fixed)
        lost += not fit.converged
        pulls.append([(fit.estimates[name] - true[name]) / fit.errors[name] for name in free])
        held.append([low <= true[name] <= high for name in free for low, high in [fit.interval(name)]])
    return numpy.array(pulls), numpy.array(held), lost


def main():
    entry = Entry(__doc__, "beyond the paper")
    trials = 8 if entry.quick else 100
    free = ("mu_d", "tau")
    averages = {"P_stick": "sticking", "mean_stick": "sticking", "E_V2": "moments"}
    cases = {
        "200 sticks": (samples(entry, trials, {"sticks": 200}, {}), free, MODEL),
        "100 sticks > 0.2, 100 slides > 0.1": (samples(entry, trials, {"sticks": 100, "slides": 100},
                                                       {"sticks": 0.2, "slides": 0.1}), free, MODEL),
        "100 slips > 0.05": (samples(entry, trials, {"slips": 100}, {"slips": 0.05}), ("mu_d",), {**MODEL, "tau": 1.5}),
        "P_stick, mean_stick, E_V2": (values(entry, trials, averages, 1000), free, MODEL),
        "the same, mu_s free": (values(entry, trials, averages, 4000), ("mu_s", *free), ON_A_LEVEL)}
    rows, shares, all_pulls = [], [], []
    for name, (data, parameters, fixed) in cases.items():
        pulls, held, lost = outcomes(entry, data, parameters, **fixed)
        for n, parameter in enumerate(parameters):
            count = int(held[:, n].sum())
            rows.append((name if n == 0 else "", parameter, f"{count} of {trials}", f"{pulls[:, n].mean():.2f}",
                         f"{pulls[:, n].std(ddof=1):.2f}", str(lost) if n == 0 else ""))
            shares.append(scipy.stats.binomtest(count, trials, 0.95).pvalue)
            all_pulls.append(pulls[:, n])
    entry.table("95 % confidence intervals that hold the truth; mean and standard deviation of (estimate - truth)/standard "
                "error, 0 and 1 for many data", ("data", "parameter", "held", "mean", "deviation", "not converged"), rows)
    figure, axes = subplots(figsize=(5, 3))
    together = numpy.concatenate(all_pulls)
    x = numpy.linspace(-4, 4, 200)
    axes.hist(together, numpy.linspace(-4, 4, 25), density=True, color=COLOURS[0], alpha=0.5)
    axes.plot(x, scipy.stats.norm.pdf(x), color=COLOURS[1])
    axes.set(xlabel="(estimate - truth)/standard error", ylabel="density")
    entry.figure(figure, "fits.png", "Distances of estimates from the truth, all parameters together. Line: the normal "
                 "density")
    entry.at_least("held of so many trials, chance of a count that is further from 95 % by chance", min(shares),
                   CHANCE / len(shares))
    entry.claim("mean of all distances, in its standard errors for independent ones",
                abs(together.mean()) * trials ** 0.5, scipy.stats.norm.isf(CHANCE / 2))
    entry.end()


main()
