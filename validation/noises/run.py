"""Other noises: closed forms of telegraph noise, filtered noise in small steps, units of force, levels from a file.

Telegraph noise has two values, X = +-a, and jumps at the rate kappa. Its equations can be solved by hand: closed
forms of probabilities, durations, moments and densities are compared with computed values, and both with simulation.

Filtered noise is compared with a simulation in Python that takes small steps of it. Two identities need no other
value: in another unit of force all results are multiplied by known powers of the unit, and levels that are all moved
by a constant under the opposite bias are the same model.

usage: python3 validation/noises/run.py [--quick] [--program build/stickslip] [--report FOLDER]

--quick simulates a third of the excursions and a quarter of the small steps, and draws fewer points.
"""

import itertools
import pathlib
import sys

import numpy
import scipy.linalg

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from entry import Entry, deviation, subplots
from harness import difference, worse
from stickslip.plots.style import COLOURS, STYLES
from telegraph import densities, integrals

TELEGRAPH = {"noise": "telegraph", "telegraph_amplitude": 1, "mu_d": 0.5, "bias": 0.3}
DRAGS = {  # options, b on v > 0
    "b = -v": ({}, lambda v: -v),
    "b = 0.3 (1 - exp(-10 v)) - v": (
        {"drag": "expression", "drag_expression": "0.3*(v>0 ? 1-exp(0-10*v) : exp(10*v)-1) - v"},
        lambda v: 0.3 * (1 - numpy.exp(-10 * v)) - v)}
OU = {"mu_s": 1, "mu_d": 0.45, "delta": 0.5, "tau": 1, "quantities": "sticking,moments,spectrum"}
WITHOUT_X = ("P_stick", "P_slide", "mean_stick", "mean_slide", "E_V2", "E_absV", "S_0", "fwhm")
GROUND = {"ground_frequency": 15.6, "ground_damping": 0.6, "noise_deviation": 2, "mu_s": 1.5, "mu_d": 1.5}
POWERS = {"P_stick": 0, "mean_stick": 0, "mean_slide": 0, "E_absV": 1, "E_V2": 2, "E_XV": 2, "E_X2": 2}


def exact():
    """Drag, its options, kappa, known values."""
    for kappa in (0.05, 1, 20):
        yield "b = 0", {"drag": "none"}, kappa, {
            "P_stick": 1 / 6, "mean_slide": 5 / kappa, "mean_excursion": 6 / kappa, "E_absV": 2 / kappa}
    yield "b = -v", {}, 1, {"P_stick": 3 / 8, "E_V": 1 / 4, "E_V2": 2 / 15}
    for (name, (drag, b)), kappa in itertools.product(DRAGS.items(), (1, 2.5)):
        if drag or kappa != 1:
            yield name, drag, kappa, integrals(kappa, b)


def telegraph_values(entry):
    rows, far, beside = [], [], []
    for name, drag, kappa, known in exact():
        scene = {**TELEGRAPH, **drag, "telegraph_rate": kappa, "quantities": "sticking,moments"}
        found = entry.run(**scene, accuracy=1e-11)["results"]
        count = 10**5 if entry.quick else 3 * 10**5
        simulated = entry.run(**scene, route="monte_carlo", excursions=count)["results"]
        for key, value in known.items():
            far.append(difference(found[key]["value"], value))
            beside.append((value, 0, simulated[key]))
            rows.append((name, f"{kappa:g}", key, f"{value:.10g}", f"{found[key]['value']:.12g}",
                         far[-1], simulated[key]["value"], deviation(*beside[-1])))
    entry.table("Telegraph noise by closed form, program and simulation: a = 1, mu_s = 1, mu_d = 1/2, bias 0.3", (
        "drag", "kappa", "quantity", "closed form", "found", "relative difference", "simulated", "z"), rows)
    entry.claim("telegraph noise against closed forms, relative", worse(*far), 1e-10)
    entry.simulated("simulated telegraph noise", beside)


def telegraph_densities(entry):
    shown, far = {}, []
    for (name, (drag, b)), kappa in itertools.product(DRAGS.items(), (2, 3)):
        scene = {**TELEGRAPH, **drag, "telegraph_rate": kappa}
        found = entry.results(**scene, quantities="density", accuracy=1e-10).density
        v, pdf, atom = found.v, found.values, found.at_rest
        falling, rising = pdf[:, v > 0]
        known = [atom.sum() * f for f in densities(kappa, b, v[v > 0])]
        far += [abs(f - g).max() / g.max() for f, g in zip((rising, falling), known)]
        far.append(abs(pdf[:, v < 0]).max())
        shown[rf"${name}$, $\kappa$ = {kappa}".replace("exp", r"\exp")] = (v[v > 0], rising, falling, atom.sum(), kappa, b)
    entry.claim("densities of X = +-a from the closed form, relative to the largest", worse(*far), 1e-6)
    return shown


def against_bias(entry):
    """P_stick by a and by the bias, without drag; any kappa."""
    found = {}
    for n, a in enumerate((0.8, 1, 1.2)):
        biases = numpy.linspace(max(1 - a, a - 1), 0.5, 5 if entry.quick else 13)[1:-1]
        scene = {**TELEGRAPH, "telegraph_amplitude": a, "telegraph_rate": 3.0**(n - 1), "drag": "none"}
        runs = entry.run(**scene, quantities="sticking", accuracy=1e-11,
                         sweep_bias=",".join(map(repr, map(float, biases))))["runs"]
        found[a] = (biases, numpy.array([run["results"]["P_stick"]["value"] for run in runs]))
    entry.claim("P_stick = (mu_d - g)/(mu_d + a - g) without drag, relative", worse(*(
        difference(value, (0.5 - g) / (0.5 + a - g))
        for a, points in found.items() for g, value in zip(*points))), 1e-10)
    return found


def draw(entry, shown, biased):
    figure, panels = subplots(1, 3, figsize=(10, 3.4))
    for axes, (name, (v, rising, falling, stick, kappa, b)) in zip(panels, list(shown.items())[1::2]):
        line = numpy.linspace(0, v.max(), 300)
        for n, (sign, nodes, known) in enumerate(zip("+-", (rising, falling), densities(kappa, b, line))):
            axes.plot(line, stick * known, color=COLOURS[n], linestyle=STYLES[n],
                      label=f"$X = {sign}a$, closed form")
            axes.plot(v, nodes, "o^"[n], color=COLOURS[n], markersize=3, label=f"$X = {sign}a$, nodes")
        axes.set(xlabel="$v$  [velocity]", ylabel="density  [1/velocity]")
        axes.set_title(name, fontsize=9)
    for n, (a, (biases, values)) in enumerate(biased.items()):
        line = numpy.linspace(abs(1 - a), 0.5, 100)
        panels[2].plot(line, (0.5 - line) / (0.5 + a - line), color=COLOURS[n], linestyle=STYLES[n],
                       label=rf"$a$ = {a:g}, $\kappa$ = {3.0**(n - 1):.2g}")
        panels[2].plot(biases, values, "o^s"[n], color=COLOURS[n], markersize=3)
    panels[2].set(xlabel="bias $g$  [force]", ylabel=r"$P_\mathrm{stick}$")
    panels[2].set_title("$b = 0$", fontsize=9)
    for axes in panels:
        axes.set_ylim(0)
        axes.legend()
    entry.figure(figure, "noises.png", "Telegraph noise, mu_s = 1, mu_d = 1/2: densities of sliding bodies for a = 1 "
                 "and the bias 0.3, and the probability of sticking without drag. Lines are closed forms, marks computed.")


def in_small_steps(step, time, paths, rng):
    """E[|V|] and E[V^2] without drag under the continuous force of -noise filtered, X = w^2 q + 2 zeta w q' with
    q'' + 2 zeta w q' + w^2 q white noise, and their standard errors from independent paths. Steps of (q, q') are exact
    in law; V takes an implicit step of friction."""
    w, zeta = GROUND["ground_frequency"], GROUND["ground_damping"]
    row = numpy.array([w**2, 2 * zeta * w])
    stationary = numpy.diag([1, w**2]) * GROUND["noise_deviation"]**2 / (w**4 * (1 + 4 * zeta**2))
    move = scipy.linalg.expm(numpy.array([[0, 1], [-w**2, -2 * zeta * w]]) * step)
    kick = numpy.linalg.cholesky(stationary - move @ stationary @ move.T)
    state = numpy.sqrt(stationary) @ rng.standard_normal((2, paths))
    v, sums, before, begin = numpy.zeros(paths), numpy.zeros((2, paths)), row @ state, round(2 / step)
    for n in range(begin + round(time / step)):
        state = move @ state + kick @ rng.standard_normal((2, paths))
        after = row @ state
        v += step * (before + after) / 2
        v = numpy.sign(v) * numpy.maximum(abs(v) - step * GROUND["mu_d"], 0)
        before = after
        if n >= begin:
            sums += (abs(v), v * v)
    means = sums * step / time
    return means.mean(axis=1), means.std(axis=1, ddof=1) / paths**0.5


def filtered_noise(entry):
    keys = ("E_absV", "E_V2")
    found = entry.run(**GROUND, noise="filtered", drag="none", quantities="moments", accuracy=1e-3)["results"]
    values = numpy.array([found[key]["value"] for key in keys])
    simulated, errors = in_small_steps(1e-3, 10, 1000 if entry.quick else 4000, numpy.random.default_rng(1))
    entry.table("Filtered noise, and in small steps: w = 15.6, zeta = 0.6, deviation 2, mu_s = mu_d = 1.5, no drag",
                ("quantity", "computed", "small steps", "standard error"),
                [(key, f"{a:.5g}", f"{b:.5g}", f"{c:.1g}") for key, a, b, c in zip(keys, values, simulated, errors)])
    entry.claim("filtered noise against small steps, beyond four standard errors, relative",
                worse(*((abs(values - simulated) - 4 * errors) / simulated)), 5e-3)


def units_of_force(entry):
    """Thresholds, step and deviation times c multiply velocities by c where b = -v."""
    far = []
    one = entry.run(mu_d=0.6, delta=0.2, tau=0.8, noise_deviation=1.1, accuracy=1e-10)["results"]
    for c in (0.37, 9.81):
        forces = {"mu_s": c, "mu_d": 0.6 * c, "delta": 0.2 * c, "noise_deviation": 1.1 * c}
        other = entry.run(**forces, tau=0.8, accuracy=1e-10)["results"]
        far += [difference(other[key]["value"], c**p * one[key]["value"]) for key, p in POWERS.items()]
    entry.claim("-noise_deviation in other units of force, relative", worse(*far), 1e-12)


def shifted_levels(entry):
    """A chain that is moved by a constant under the opposite bias."""
    full = round(2 / (OU["tau"] * OU["delta"]**2))
    known, far = entry.run(**OU, noise_levels="full", accuracy=1e-11)["results"], []
    for shift in (0.13, -0.4):
        lines = ["x,rate_up,rate_down"]
        for i in range(-full, full + 1):
            up, down = ((1 - j / full) / (OU["tau"] * OU["delta"])**2 for j in (i, -i))
            lines.append(f"{i * OU['delta'] + shift!r},{up!r},{down!r}")
        entry.file("moved.csv").write_text("\n".join(lines) + "\n")
        scene = {key: value for key, value in OU.items() if key not in ("tau", "delta")}
        levels = {"noise": "file", "noise_file": entry.file("moved.csv"), "bias": -shift}
        found = entry.run(**scene, **levels, accuracy=1e-11)["results"]
        far += [difference(found[key]["value"], known[key]["value"]) for key in WITHOUT_X]
        far.append(abs(found["E_V"]["value"]))
    entry.claim("-noise file with the moved levels of -noise ou, relative", worse(*far), 1e-9)


def main():
    entry = Entry(__doc__, "beyond the paper")
    telegraph_values(entry)
    draw(entry, telegraph_densities(entry), against_bias(entry))
    filtered_noise(entry)
    units_of_force(entry)
    shifted_levels(entry)
    entry.end()


main()
