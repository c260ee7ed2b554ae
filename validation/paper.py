"""Figures and tables of the paper, and what continues them: one function for each entry of the report.

usage: python3 validation/paper.py NAME [--quick] [--program build/stickslip] [--report FOLDER]

CASES at the end names them. The text of a function says what it compares with what.
"""

import importlib.util
import itertools
import math
import pathlib
import sys
import time

sys.path[:0] = [str(pathlib.Path(__file__).resolve().parent / folder) for folder in ("", "benchmark")]
from entry import Entry, deviation, subplots
from harness import difference, entries, last_place, worse
from known import F_1, F_STICK_0, P_X, S_V, SIMULATED, T_CORR, TABLE_1
from stickslip.plots.style import COLOURS, STYLES, curve, fraction

LABELS = {"P_stick": r"$P_\mathrm{stick}$", "E_V2": r"$E[V^2]$  [velocity$^2$]",
          "P_X_le_mu_s": r"$P(|X| \leq \mu_s)$", "F_slide": r"$F_\mathrm{slide}(\lambda)$",
          "F_stick": r"$F_\mathrm{stick}(\lambda)$"}
MU_D = (0.25, 0.5, 0.75, 1)


def computed(entry, **options):
    return entry.run(**options)["results"]


def simulated(entry, excursions, **scene):
    return computed(entry, **scene, route="monte_carlo", excursions=excursions)


def beside(known, drawn):
    """Values with their errors and simulated results, for Entry.simulated."""
    return [(value, error, {"value": mean, "ci95": ends})
            for (value, error, _), (mean, _, ends) in zip(entries(known), entries(drawn))]


def against_digits(entry, text, caption, columns, rows, tolerance, relative=False):
    """A table and a claim: each row ends with a value and the digits known of it; the distance is relative or in
    units of the last digit."""
    entry.table(caption, columns, [(*labels, f"{value:.14g}", digits) for *labels, value, digits in rows])
    entry.claim(f"{text}, {'relative' if relative else 'in units of the last one'}", worse(*(
        abs(value - float(digits)) / (abs(float(digits)) if relative else last_place(digits))
        for *_, value, digits in rows)), tolerance)


def paths(entry):
    """Paths of the process, and how long they rest.

    The pictures show what the process does: the force jumps from level to level, the velocity follows it, and the
    body sticks while the force is small.

    A path is drawn at random and knows nothing of the equations that give the probability of sticking. So the share of
    time that a long path spends at rest is compared with P_stick. Excursions from rest are independent, which gives
    the standard deviation of that share; four of them are allowed.
    """
    for mu_d in (1, 0.25):
        entry.drawn("trajectory", f"path_{mu_d:g}.png",
                    f"One path, mu_s = 1, mu_d = {mu_d:g}, delta = 1/4, tau = 1, b(v) = -v",
                    entry.results(quantities="trajectory", mu_d=mu_d, delta=0.25, horizon=20))
    horizon = 2000 if entry.quick else 20000
    path = entry.results(quantities="trajectory", mu_d=0.25, delta=0.5, horizon=horizon).trajectory
    known = computed(entry, quantities="sticking", mu_d=0.25, delta=0.5, accuracy=1e-8)["P_stick"]["value"]
    times, y = path["time"], path["y"]
    share = float(sum((times[1:] - times[:-1])[y[:-1] == 0]) / times[-1])
    entry.table("Share of time at rest on a long path", ("horizon", "share", "P_stick"), [(horizon, share, known)])
    # Excursions are independent; the shares of one have a standard deviation of about 0.3.
    entry.claim("share of time at rest, distance from P_stick", abs(share - known), 4 * 0.3 * (4.8 / horizon) ** 0.5)


def averages(entry):
    """P_stick, E[V^2] and P(|X| <= mu_s) against the noise step.

    The averages that the paper simulates are computed, and simulated anew, at the same parameters, for smaller and
    smaller steps of the noise.

    Three things stand beside the computed values. Simulation draws paths and solves no equation; the table shows its
    95 % confidence intervals. The digits that the paper prints come from its own simulations. P(|X| <= mu_s) depends
    on the noise alone, and the paper has it from the kernel of the noise's generator, to fifteen digits.
    """
    keys = tuple(SIMULATED)
    deltas = list(P_X)[:3] if entry.quick else list(P_X)
    found, rows, pairs = {}, [], []
    for mu_d, delta in itertools.product(MU_D, deltas):
        scene = {"quantities": "sticking,moments,noise_law", "mu_d": mu_d, "delta": delta}
        known = computed(entry, **scene, accuracy=1e-8)
        drawn = simulated(entry, 20000 if entry.quick else 100000, **scene)
        found[mu_d, delta] = known, drawn
        for key in keys:
            pairs += beside(known[key], drawn[key])
            printed = P_X[delta] if key == "P_X_le_mu_s" else SIMULATED[key].get(delta, "") if mu_d == 0.25 else ""
            low, high = drawn[key]["ci95"]
            rows.append((f"{mu_d:g}", f"1/{1 / delta:.0f}", key, f"{known[key]['value']:.12g}",
                         f"[{low:.5f}, {high:.5f}]", f"{deviation(*pairs[-1]):.2f}", printed))
    draw_averages(entry, found, deltas, keys)
    entry.table("Deterministic and simulated values, and what the paper prints",
                ("mu_d", "delta", "quantity", "deterministic", "simulated, 95 %", "z", "paper"), rows)
    entry.simulated("simulations", pairs)
    entry.claim("P(|X| <= mu_s) against the digits of the paper, relative", worse(*(
        difference(found[1, delta][0]["P_X_le_mu_s"]["value"], float(P_X[delta])) for delta in deltas)), 3e-14)
    entry.claim("P_stick, E_V2 printed in the paper (simulations), mu_d = 1/4, delta > 1/32, relative", worse(*(
        difference(float(SIMULATED[key][d]), found[0.25, d][0][key]["value"])
        for key in ("P_stick", "E_V2") for d in deltas if d > 1 / 32)), 4e-3)
    if 1 / 32 in deltas:
        known = found[0.25, 1 / 32][0]["P_stick"]["value"]
        entry.text(f"The paper's P_stick = 0.1302 at delta = 1/32 is {difference(0.1302, known):.1e} "
                   f"above the converged {known:.8f}: outside of any interval of 10^6 excursions.")


def draw_averages(entry, found, deltas, keys):
    figure, panels = subplots(1, 3, figsize=(10, 3.4))
    for axes, key in zip(panels, keys):
        for n, mu_d in enumerate(MU_D):
            known, drawn = ([found[mu_d, delta][part][key] for delta in deltas] for part in (0, 1))
            axes.plot(deltas, [k["value"] for k in known], color=COLOURS[n], linestyle=STYLES[n],
                      label=rf"$\mu_d$ = {mu_d:g}")
            half = [[s["value"] - s["ci95"][0] for s in drawn], [s["ci95"][1] - s["value"] for s in drawn]]
            axes.errorbar(deltas, [s["value"] for s in drawn], half, fmt="o", markersize=3, capsize=3,
                          color=COLOURS[n])
        axes.set_xscale("log", base=2)
        axes.xaxis.set_major_formatter(lambda x, _: fraction(x))
        axes.set(xlabel=r"noise step $\delta$  [force]", ylabel=LABELS[key])
    figure.legend(*panels[0].get_legend_handles_labels(), loc="upper center", ncol=4)
    figure.suptitle(" ")  # room for the legend
    entry.figure(figure, "averages.png", "Curves: deterministic values. Bars: simulations with 95 % confidence "
                 "intervals. mu_s = tau = 1, b(v) = -v. The last panel does not depend on mu_d")


# Tables of kappa(64) ... kappa(512) in the paper.
KAPPA = {1 / 2: {"P_stick": (0.881, 0.939, 0.976, 0.997), "E_V2": (0.997, 0.999, 0.996, 0.986)},
         1 / 4: {"P_stick": (0.865, 0.941, 0.995, 0.988), "E_V2": (0.995, 0.996, 0.992, 0.998)}}


def points(entry):
    """Convergence of the upwind scheme in p, and its observed order.

    The upwind scheme of the paper is of first order: its error halves where the number p of points for each noise step
    doubles. The observed order kappa(p), the binary logarithm of the change from p/2 to p over that from p to 2 p,
    must tend to 1, and the values must tend to those of the hp elements, which share no grid with them.

    The orders that the paper prints differ from ours. To find out why, a script of its own solves the printed scheme
    with SciPy, without any code of the program, and measures the order in three norms.
    """
    steps = {1 / 2: 7, 1 / 4: 7} if entry.quick else {1 / 2: 10, 1 / 4: 10, 1 / 8: 8, 1 / 16: 7}
    studies = {delta: entry.run(study="p", mu_d=0.25, delta=delta, study_steps=count,
                                quantities="sticking,moments") for delta, count in steps.items()}
    draw_points(entry, studies)
    tables = {delta: study["study"]["tables"] for delta, study in studies.items()}
    rows, away, falls = [], [], []
    for delta, printed in KAPPA.items():
        for key, orders in printed.items():
            table = tables[delta][key]
            ours = dict(zip(table["p"], table["kappa"]))
            rows += [(f"1/{1 / delta:.0f}", key, str(p), f"{ours[p]:.4f}", f"{order:.3f}")
                     for p, order in zip((64, 128, 256, 512), orders) if ours.get(p) is not None]
            far = [abs(k - 1) for k in table["kappa"][-4:-1]]
            away.append(far[-1])
            falls += [after / before for before, after in itertools.pairwise(far)]
    entry.table("Observed order kappa(p), ours and the paper's", ("delta", "quantity", "p", "ours", "paper"), rows)
    entry.claim("kappa at the largest p, distance from 1", worse(*away), 0.25 if entry.quick else 0.06)
    entry.claim("that distance over the one at half as many points", worse(*falls), 1)
    norms(entry, tables[0.5])
    falling = worse(*(b - a for one in tables.values() for a, b in itertools.pairwise(one["P_stick"]["value"])))
    entry.verdict(falling < 0, "P_stick of the printed scheme falls with p", f"change nearest to a rise {falling:.2g}")
    entry.text("The kappas of the paper are not those of the scheme that it prints. An independent script that "
               "solves the printed lambda-problem gives our kappa in every norm: lambda u differs from a "
               "constant by terms of order lambda only, so the norm does not matter. P_stick of the printed "
               "scheme falls with p, while P_stick of the paper rises with p (table of the data-learning "
               "heuristics). The numbers of the paper therefore come from another scheme; both are of first "
               "order. Its kappa of P(|X| <= mu_s) is left out: the printed scheme gives the binomial sum at "
               "every p. The quotient in kappa is printed upside down.")
    entry.claim("error of Richardson's extrapolation over that of the last value, P_stick", worse(*(
        one["P_stick"]["richardson_error"][-1] / one["P_stick"]["error"][-1] for one in tables.values())), 0.2)


def draw_points(entry, studies):
    figure, panels = subplots(1, 2, figsize=(8.4, 3.6))
    for axes, key in zip(panels, ("P_stick", "E_V2")):
        for n, (delta, study) in enumerate(studies.items()):
            table, colour = study["study"]["tables"][key], COLOURS[n % len(COLOURS)]
            axes.plot(table["p"], table["value"], color=colour, marker="os^Dv"[n % 5], markersize=4,
                      linestyle=STYLES[n % 5], label=rf"$\delta$ = {fraction(delta)}")
            axes.axhline(study["runs"][-1]["results"][key]["value"], color=colour, linewidth=0.8, linestyle=":")
        axes.set_xscale("log", base=2)
        axes.set(xlabel="points per noise step $p$", ylabel=LABELS[key])
    panels[0].legend()
    entry.figure(figure, "points.png", "Upwind values against p; dotted: converged (hp). mu_d = 1/4, "
                 "mu_s = tau = 1, b(v) = -v")


def kappas_of_grid_functions(delta, mu_d, p):
    """kappa(p) of lambda u by quantity: at the exit state, in the maximum norm and in the Euclidean one.

    By SciPy on the full grid; differences are taken on the points of the coarsest of three grids.
    """
    import numpy
    import scipy_paper
    solved = [scipy_paper.grid_functions(delta, mu_d, n, 1e-6) for n in (p // 2, p, 2 * p)]
    grid, found = solved[0][0], {}
    for key in ("P_stick", "E_V2"):
        coarse, middle, fine = (u[key].reshape(g.shape)[:, ::step] for (g, u), step in zip(solved, (1, 2, 4)))
        changes = [(coarse - middle).ravel(), (middle - fine).ravel()]
        kinds = (lambda u: abs(u[grid.exit_state()]), lambda u: abs(u).max(), numpy.linalg.norm)
        found[key] = [math.log2(norm(changes[0]) / norm(changes[1])) for norm in kinds]
    return found


def norms(entry, tables):
    """Whether the norm explains what the paper prints."""
    if not importlib.util.find_spec("scipy"):
        entry.text(f"SciPy is not installed for {sys.executable}: kappa of the grid function is left out.")
        return
    rows, away = [], []
    for key, kappas in kappas_of_grid_functions(delta=0.5, mu_d=0.25, p=64).items():
        ours = dict(zip(tables[key]["p"], tables[key]["kappa"]))[64]
        rows.append((key, *(f"{k:.4f}" for k in (ours, *kappas)), f"{KAPPA[0.5][key][0]:.3f}"))
        away += [difference(kappa, ours) for kappa in kappas]
    entry.table("kappa(64) at delta = 1/2, by a SciPy script of the printed lambda-problem (lambda = 1e-6)",
                ("quantity", "ours", "SciPy, at s+", "maximum norm", "Euclidean norm", "paper"), rows)
    entry.claim("kappa(64) of the grid function in either norm against ours, relative", worse(*away), 1e-3)


def spectra(entry):
    """Power spectral density of the velocity.

    S_v, the power spectral density of the velocity, is computed at many frequencies. The picture has the panels of the
    paper's figure.

    Digits that another code has printed are compared in units of their last place. Simulation sums Fourier integrals
    over the excursions of random paths instead, and has 95 % confidence intervals.
    """
    values = (1, 0.5, 0.25)
    scenes = [(mu_d, 1, tau) for mu_d in (0.25, 1) for tau in values] if entry.quick else itertools.product(
        (0.25, 0.5, 1), values, values)
    entry.drawn("spectra", "spectra.png", "S_v against omega by mu_d, delta and tau; mu_s = 1, b(v) = -v", *(
        entry.results(quantities="spectrum", mu_d=mu_d, delta=delta, tau=tau, omega="1e-3:50:120:log", accuracy=1e-5)
        for mu_d, delta, tau in scenes))
    omega = ("0", "0.1", "1", "10")
    rows = [(f"1/{1 / delta:.0f}", *row) for delta, digits in S_V.items() for row in zip(omega, computed(
        entry, quantities="spectrum", mu_d=0.25, delta=delta, omega=",".join(omega),
        accuracy=1e-8)["S_v"]["value"], digits)]
    against_digits(entry, "S_v against known digits", "S_v by the program and by another code: mu_d = 1/4, tau = 1",
                   ("delta", "omega", "S_v", "other code"), rows, 0.6)
    pairs = []
    for mu_d, tau in ((0.25, 1), (1, 0.5)):
        scene = {"quantities": "spectrum", "mu_d": mu_d, "delta": 0.5, "tau": tau, "omega": "0,0.3,1,3,10"}
        pairs += beside(computed(entry, **scene, accuracy=1e-7)["S_v"],
                        simulated(entry, 20000 if entry.quick else 300000, **scene)["S_v"])
    entry.simulated("simulated spectra", pairs)


def correlation_time(entry):
    """Correlation time of the velocity against that of the noise.

    The correlation time t_corr is the inverse of the full width of the spectrum at half its maximum. The figure of the
    paper shows how it depends on the correlation time tau of the noise, for several values of mu_d and without drag.

    As tau -> 0 the noise becomes white. For mu_d = mu_s the velocity is then a diffusion, whose correlation time is
    known without any noise levels: the curves must tend to it.
    """
    curves = [("linear", mu_d) for mu_d in (1, 0.75, 0.5, 0.25)] + [("none", 1)]
    last, delta = (3, 0.5) if entry.quick else (6, 0.25)
    items = {(drag, mu_d, n): entry.results(quantities="spectrum", mu_d=mu_d, drag=drag, delta=delta, tau=2.0**-n,
                                            accuracy=1e-4) for drag, mu_d in curves for n in range(last + 1)}
    times = {key: one["t_corr"].value for key, one in items.items()}
    entry.drawn("correlation_time", "correlation_time.png", "t_corr, one over the full width of S_v at half maximum, "
                f"against tau; mu_s = 1, delta = {delta:g}", *items.values())
    entry.table("t_corr by drag law, mu_d and tau", ("drag", "mu_d", *(f"tau = 2^-{n}" for n in range(last + 1))),
                [(drag, f"{mu_d:g}", *(times[drag, mu_d, n] for n in range(last + 1))) for drag, mu_d in curves])
    if not entry.quick:
        entry.claim("change of t_corr from tau = 1/8 to 1/64, relative", worse(*(
            difference(times[drag, mu_d, 3], times[drag, mu_d, 6]) for drag, mu_d in curves)), 0.06)
    entry.claim(f"t_corr at tau = 2^-{last} from white noise, mu_d = mu_s, relative", worse(*(
        difference(times[drag, 1, last], limit) for drag, limit in T_CORR.items())), 0.1 if entry.quick else 0.01)


def laplace(entry):
    """Laplace transform of the duration of sliding phases.

    F_slide(lambda) and F_stick(lambda) are the Laplace transforms of the durations of sliding and sticking phases.

    At lambda = 1 they are compared with a Chebyshev collocation in Python, another discretisation of the same
    equations that converges to twelve digits. Over four decades of lambda they are compared with the mean of
    exp(-lambda T) over durations T that were drawn at random.
    """
    figure, panels = subplots(1, 2, figsize=(8.4, 3.5))
    pairs = []
    for n, mu_d in enumerate((0.25, 0.5, 1)):
        scene = {"quantities": "laplace", "mu_d": mu_d, "delta": 1, "lambda": "0.01:100:25:log"}
        known = entry.results(**scene, accuracy=1e-9)
        drawn = entry.results(**scene, route="monte_carlo", excursions=100000 if entry.quick else 1000000)
        for axes, key in zip(panels, ("F_slide", "F_stick")):
            curve(axes, known[key], n, label=rf"$\mu_d$ = {mu_d:g}")
            curve(axes, drawn[key], colour=COLOURS[n])
            axes.set(xscale="log", yscale="log", xlabel=r"$\lambda$  [1/time]", ylabel=LABELS[key])
            # Where a million excursions see a handful, no interval is normal.
            pairs += [one for one in beside(known.summary["results"][key], drawn.summary["results"][key])
                      if one[0] > 1e-3]
    panels[0].legend()
    entry.figure(figure, "laplace.png", "Curves: deterministic; dots: simulated, with 95 % confidence intervals. "
                 "delta = tau = mu_s = 1, b(v) = -v")
    rows = []
    for mu_d, digits in F_1.items():
        values = computed(entry, quantities="laplace", mu_d=mu_d, delta=1, accuracy=1e-11, **{"lambda": 1})
        rows += [(f"{mu_d:g}", key, values[key]["value"][0], d) for key, d in zip(("F_slide", "F_stick"), digits)]
    against_digits(entry, "F_slide(1), F_stick(1) against collocation", "Transforms at lambda = 1, by the program and "
                   "by collocation", ("mu_d", "quantity", "value", "collocation"), rows, 1e-11, relative=True)
    entry.simulated("simulated transforms above 1e-3", pairs)


def durations(entry):
    """Durations of sliding phases, sticking phases and excursions.

    The densities of the durations of sliding phases, sticking phases and excursions are computed at the parameters of
    the paper's figure. Its Table 1 prints f_stick(0+), the density of sticking times at zero.

    The values are compared with the digits of another code, with both columns of the table (Kolmogorov equations and
    Monte Carlo), and with simulations of our own. Where the paper disagrees with all of them, the reason is given.
    """
    entry.drawn("durations", "durations.png", "Densities of durations; mu_s = tau = 1, b(v) = -v", *(
        entry.results(quantities="duration_density", mu_d=mu_d, delta=delta, accuracy=1e-3,
                      time="0:0.1:201" if mu_d < 1 else "0:0.1:401")
        for mu_d in ((0.25, 1) if entry.quick else MU_D) for delta in ((0.125,) if entry.quick else (1 / 16, 1 / 32))))
    deltas = (1 / 8, 1 / 16) if entry.quick else (1 / 8, 1 / 16, 1 / 32)
    rows, column, pairs = [], [], []
    for mu_d in MU_D:
        for delta, known, printed in zip(deltas, F_STICK_0[mu_d], TABLE_1[mu_d]):
            scene = {"quantities": "entry_law", "mu_d": mu_d, "delta": delta}
            ours = computed(entry, **scene, accuracy=1e-7)["f_stick_0"]
            # At mu_d = mu_s hardly any sticking phase begins next to an exit, where it may end at once.
            excursions = (20000 if entry.quick else 100000) * (10 if mu_d == 1 else 1)
            pairs += beside(ours, drawn := simulated(entry, excursions, **scene)["f_stick_0"])
            low, high = drawn["ci95"]
            rows.append((f"{mu_d:g}", f"1/{1 / delta:.0f}", f"[{low:.4g}, {high:.4g}]", printed, ours["value"], known))
            if mu_d < 1:
                column.append(difference(float(printed.partition("/")[0]), ours["value"]))
    against_digits(entry, "f_stick(0+) against known digits", "f_stick(0+), the density of sticking times at zero",
                   ("mu_d", "delta", "simulated, 95 %", "paper, Kolmogorov/Monte Carlo", "deterministic", "other code"),
                   rows, 0.6)
    entry.text("The row mu_d = mu_s of the paper is off in both of its columns: a grid point of the noise equals mu_d "
               "there, creeps towards v = 0 without ever arriving, and shares the static node in the paper's grid.")
    entry.claim("the paper's Kolmogorov column, mu_d < mu_s, relative", worse(*column), 5e-3)
    entry.simulated("simulations", pairs)


# The table of the data-learning heuristics by (k, l).
HEURISTIC = {(7, 5): 0.1291, (8, 5): 0.1294, (9, 5): 0.1295, (5, 6): 0.1239, (6, 6): 0.1244, (7, 6): 0.1249,
             (8, 6): 0.1254, (9, 6): 0.1258}


def extrapolation(entry):
    """Extrapolation in p and delta beyond the memory limit of the paper.

    The paper extrapolates P_stick from coarse grids to grids that do not fit into memory. The same extrapolation of
    the same upwind values is repeated here (in the long form of the report, by 46 runs), and both stand beside the
    value that it aims at, which hp elements give to nine digits.
    """
    converged = {l: computed(entry, quantities="sticking", mu_d=0.25, delta=2.0**-l, accuracy=1e-8)["P_stick"]["value"]
                 for l in (5, 6)}
    ours = {}
    if not entry.quick:
        table = entry.run(study="heuristic", mu_d=0.25, quantities="sticking")["study"]["tables"]["P_stick"]
        ours = {(k, l): value for k, l, value in zip(table["k"], table["l"], table["extrapolated"])}
    entry.table("P_stick by extrapolation at p = 2^k, delta = 2^-l, mu_d = 1/4",
                ("(k, l)", "ours", "paper", "converged in p"),
                [(f"({k}, {l})", f"{ours[k, l]:.6f}" if ours else "", f"{printed:.4f}", f"{converged[l]:.9f}")
                 for (k, l), printed in HEURISTIC.items()])
    for whose, values in (("the paper's", HEURISTIC), ("our extrapolated", ours)):
        if values:
            entry.claim(f"{whose} values at k = 9 from the converged ones, relative", worse(*(
                difference(values[9, l], converged[l]) for l in (5, 6))), 1.5e-2)
    entry.text("The paper's values rise with k; those of the scheme that it prints fall, before and after "
               "extrapolation.")
    entry.text("The paper's first row at (9, 5) compares with 0.1302, a Monte Carlo value that is too "
               "high; the converged one is in the last column. Its second row is P(|X| <= mu_s), "
               "which does not depend on p and needs no extrapolation.")


# mu_s = tau = 1, b(v) = -v, by mu_d and key: the limit, by removing powers of delta one by one from values between
# 1/4 and 1/64, and the order of the distance from it.
LIMITS = {0.25: {"P_stick": (0.1205970417, 1), "E_V2": (0.3097150920, 1)},
          1: {"P_stick": (0.516134807, 1.5), "E_V2": (0.0496223037, 2)}}
FAMILIES = ("on a level", "between levels")


def limit(entry):
    """The limit delta -> 0: orders over three decades, and limits with their errors.

    As the step delta of the noise vanishes the process tends to one with Ornstein-Uhlenbeck noise. The order of this
    convergence should be 1 in general, 3/2 for P_stick and 2 for E[V^2] where mu_d = mu_s and sliding phases graze the
    static one. Values over three decades of delta (two in the quick form) must show these orders, whether mu_s is on a
    level of the noise or between two.

    The limits are compared with values of the same limits that were obtained from larger steps, by removing powers of
    delta one by one.
    """
    studies = {mu_d: entry.run(study="delta", study_steps=8 if entry.quick else 12, mu_d=mu_d, delta=0.25,
                               accuracy=1e-10, quantities="sticking,moments")["study"] for mu_d in LIMITS}
    draw_limit(entry, studies)
    rows, apart, beyond, orders = [], [], [], []
    for mu_d, known in LIMITS.items():
        for (key, (value, power)), family in itertools.product(known.items(), FAMILIES):
            found, error, order = (studies[mu_d]["tables"][f"{key} {family}"][part][-1]
                                   for part in ("limit", "limit_error", "order"))
            rows.append((f"{mu_d:g}", key, family, f"{order:.3f}", f"{found:.12g}", f"{error:.1e}"))
            apart.append(difference(found, value))
            beyond.append(error / abs(found))
            orders.append(abs(order - power))
    entry.table("Observed orders of the last three steps, and limits",
                ("mu_d", "value", "mu_s", "order", "limit", "error"), rows)
    entry.claim("limits from values known to ten digits, relative", worse(*apart), 3e-9)
    entry.claim("stated errors of the limits, relative", worse(*beyond), 1e-8 if entry.quick else 1e-9)
    entry.claim("orders from 1, and from 3/2 and 2 at mu_d = mu_s", worse(*orders), 0.1)


def draw_limit(entry, studies):
    """Distance from the limit against delta, with the slopes of the orders."""
    figure, axes = subplots(1, 2, figsize=(10, 4.2), sharey=True)
    for axis, (mu_d, study) in zip(axes, studies.items()):
        for colour, (key, (_, order)) in zip(COLOURS, LIMITS[mu_d].items()):
            for marker, family in zip("o^", FAMILIES):
                table = study["tables"][f"{key} {family}"]
                apart = [abs(value / table["limit"][-1] - 1) for value in table["value"]]
                axis.loglog(table["delta"], apart, marker, color=colour, markersize=4, fillstyle="none",
                            label=rf"{LABELS[key].partition('  ')[0]}, $\mu_s$ {family}")
            ends = [table["delta"][n] for n in (0, -1)]
            axis.loglog(ends, [apart[-1] * (d / ends[1]) ** order for d in ends], color=colour, linewidth=0.8,
                        label=f"order {order:g}")
        axis.set_title(rf"$\mu_d$ = {mu_d:g}")
        axis.set_xlabel(r"noise step $\delta$  [force]")
        axis.legend(fontsize=8)
    axes[0].set_ylabel("relative distance from the limit")
    entry.figure(figure, "limit.png", "Distance of stationary values from their limits against the noise step; "
                 "mu_s = tau = 1, b(v) = -v")


def cost(entry):
    """What accuracy costs in time.

    Four methods repeat a case with increasing resolution, simulation among them and the upwind scheme of the paper.
    The picture shows the largest relative error of each against the seconds that it took.

    Times depend on the machine. The claims therefore leave wide margins: they say that the scheme of the paper takes
    many times as long, and that it is still wrong in the third digit.
    """
    scene = {"mu_d": 0.25, "delta": 0.25}
    found = entry.results(study="cost", **scene, study_steps=5 if entry.quick else 8,
                          study_repeats=1 if entry.quick else 3, quantities="sticking,moments")
    entry.drawn("cost", "cost.png", "Largest relative error of sticking and moments against time; mu_d = 1/4, "
                "delta = 1/4, mu_s = tau = 1, b(v) = -v", found)
    for line in found.summary["study"]["conclusions"]:
        entry.text(line)
    hp = found.study["hp"]
    fast = hp["seconds"][hp["error"] < 1e-9].min()
    p = 64 if entry.quick else 512
    start = time.monotonic()
    paper = entry.run(route="lambda", scheme="upwind", p=p, **scene, quantities="sticking", **{"lambda": 1e-6})
    slow = min(paper["cost"]["steps"][-1]["seconds"], time.monotonic() - start)
    known = computed(entry, quantities="sticking", **scene, accuracy=1e-9)
    error = difference(paper["results"]["P_stick"]["value"], known["P_stick"]["value"])
    entry.table("One system each", ("method", "seconds", "relative error of P_stick"),
                [("hp at 1e-9", fast, "below 1e-9"), (f"the paper's lambda problem, p = {p}, full grid", slow, error)])
    entry.at_least(f"seconds of the paper's method at p = {p} over those of hp at 1e-9", slow / fast,
                   3 if entry.quick else 100)
    entry.at_least(f"error of the paper's method at p = {p}", error, 1e-3)


CASES = {paths: "the figures of paths in the introduction", averages: "the Monte Carlo figure of section 5",
         points: "the figure and the two tables of convergence in p", spectra: "the figure of nine panels of spectra",
         correlation_time: "the figure of correlation times",
         laplace: "the figure of the Laplace transform of the dynamic duration",
         durations: "the figure of durations and Table 1", extrapolation: "the table of the data-learning heuristics",
         limit: "beyond the paper, which ends at delta = 1/32",
         cost: "beyond the paper: its method, this program and simulation"}


def main():
    cases = {case.__name__: case for case in CASES}
    if sys.argv[1:2] and sys.argv[1] in cases:
        case = cases[sys.argv.pop(1)]
        entry = Entry(case.__doc__, CASES[case])
        case(entry)
        entry.end()
    print(__doc__.rstrip())
    sys.exit(f"NAME is one of {', '.join(cases)}" if sys.argv[1:] != ["--help"] else 0)


if __name__ == "__main__":
    main()
