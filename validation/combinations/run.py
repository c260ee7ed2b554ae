"""Combinations of effects and quantities, drawn at random so that every pair of choices occurs.

Effects that work alone may fail together. Combinations are drawn so that any two choices (of friction, drag, bias,
noise, discretisation, question) meet in one of them.

Three comparisons need no known value. Reversing all forces and velocities gives the mirror image of a case, solved by
other equations, with the same numbers. A bias of 10^-300 changes nothing, but makes the program take the path without
symmetry. Simulation draws paths under the same effects.

usage: python3 validation/combinations/run.py [--quick] [--program build/stickslip] [--report FOLDER]

--quick draws as many as pairs need, else twenty more, computes less accurately, simulates less, and looks into the
mirror of every fourth combination.
"""

import collections
import itertools
import math
import pathlib
import random
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from entry import Entry, deviation
from harness import by_place, difference, entries, worse
from stickslip import BadInput

NOTHING = 1e-300
LAMBDA, OMEGA, TIME = (0.3, 2), (0, 0.7, 3), (0.4, 1.5)

# A drag law and its mirror image -b(-v).
DRAGS = {
    "none": ({"drag": "none"},) * 2,
    "linear": ({"drag_coefficient": 0.7},) * 2,
    "cubic": ({"drag": "cubic", "drag_coefficient": 0.5, "drag_cubic": 0.3},) * 2,
    "quadratic": ({"drag": "expression", "drag_expression": "0-v-0.3*v*abs(v)"},) * 2,
    "kinked": ({"drag": "expression", "drag_expression": "0-v-2*(v>0.3?v-0.3:v<0-0.3?v+0.3:0)"},) * 2,
    "lopsided": ({"drag": "expression", "drag_expression": "v>0?0-2*v:0-0.5*v"},
                 {"drag": "expression", "drag_expression": "v>0?0-0.5*v:0-2*v"})}
# Functions of the state and their mirror images f(-x, -y, -v).
OBSERVABLES = {
    "smooth": ("x*v+v+v^2", "x*v-v+v^2"),
    "phase": ("y==0?x+1:v", "y==0?1-x:0-v"),
    "kinked": ("min(abs(v),0.5)+x", "min(abs(v),0.5)-x"),
    "jump": ("v>0.25", "0-v>0.25")}
QUESTIONS = {
    "stationary": "sticking,moments,averages,noise_law",
    "entries": "entry_law,F_stick",
    "transforms": "laplace",
    "resolvent": "resolvent",
    "durations": "duration_density",
    "spectrum": "spectrum",
    "correlation": "autocorrelation",
    "expectation": "expectation",
    "modes": "relaxation",
    "derivatives": "sticking,moments,sensitivity"}
CHOICES = {
    "question": list(QUESTIONS),
    "drag": list(DRAGS),
    "bias": [0, 0.15, -0.2],
    "directions": ["alike", "static", "dynamic", "both"],
    "mu": [(1, 1), (1, 0.5), (0.8, 0.45), (0.4, 0.3)],
    "noise": [(1, 0.5), (0.5, 0.5), (2, 0.25)],
    "observable": list(OBSERVABLES),
    "start": ["s+", "s-", "0,0", "x,v", "rest", "stationary"],
    "scheme": ["hp", "levels", "upwind"]}
# Rounding moves eigenvalues of matrices far from normal, and reduced models of what is rough, whose errors
# cover it.
ROUNDING = {"modes": 1e-6}
ROUGH = {"durations", "expectation"}
# What a sample cannot have, and histograms, which are averages over cells.
NOT_SIMULATED = {"modes", "derivatives"}
CELLS = {"f_slide", "f_stick", "f_excursion"}


def pairs_of(case):
    return set(itertools.combinations(sorted((k, str(v)) for k, v in case.items()), 2))


def drawn(rng, more):
    """Cases that hold every pair of choices, and `more` at random."""
    missing = {pair for a, b in itertools.combinations(sorted(CHOICES), 2)
               for pair in itertools.product(((a, str(v)) for v in CHOICES[a]),
                                             ((b, str(v)) for v in CHOICES[b]))}
    cases = []
    while missing:
        tries = [{k: rng.choice(v) for k, v in CHOICES.items()} for _ in range(60)]
        best = max(tries, key=lambda case: len(pairs_of(case) & missing))
        missing -= pairs_of(best)
        cases.append(best)
    cases += [{k: rng.choice(v) for k, v in CHOICES.items()} for _ in range(more)]
    symmetric = {"bias": [0], "directions": ["alike"], "drag": [d for d in DRAGS if d != "lopsided"]}
    return cases + [{k: rng.choice(v) for k, v in (CHOICES | symmetric | {"question": [q]}).items()}
                    for q in QUESTIONS]


def is_symmetric(case):
    return not case["bias"] and case["directions"] == "alike" and case["drag"] != "lopsided"


def drag_of(case):
    """Modes need a drag that bounds the velocity."""
    return "linear" if (case["question"], case["drag"]) == ("modes", "none") else case["drag"]


def options_of(case, mirrored):
    """Options of a case or of its mirror image."""
    (mu_s, mu_d), (tau, delta) = case["mu"], case["noise"]
    here = (mu_s, mu_d)
    there = {"alike": here, "static": (mu_s + 0.3, mu_d), "dynamic": (mu_s, 0.7 * mu_d),
             "both": (mu_s + 0.2, mu_d + 0.1)}[case["directions"]]
    if mirrored:
        here, there = there, here
    sign = -1 if mirrored else 1
    options = {"mu_s": here[0], "mu_d": here[1], "tau": tau, "delta": delta,
               "quantities": QUESTIONS[case["question"]], **DRAGS[drag_of(case)][mirrored]}
    if case["directions"] != "alike":
        options |= {"mu_s_minus": there[0], "mu_d_minus": there[1]}
    if case["bias"]:
        options["bias"] = sign * case["bias"]
    if case["question"] in ("stationary", "resolvent", "expectation"):
        options["observable"] = OBSERVABLES[case["observable"]][mirrored]
    if case["question"] in ("entries", "transforms", "resolvent"):
        options["lambda"] = ",".join(map(str, LAMBDA))
    if case["question"] == "spectrum":
        options["omega"] = ",".join(map(str, OMEGA))
    if case["question"] in ("durations", "correlation", "expectation"):
        options["time"] = ",".join(map(str, TIME))
    if case["question"] == "expectation":
        start = {"x,v": f"{sign * delta},{sign * 0.3}"}.get(case["start"], case["start"])
        if mirrored:
            start = {"s+": "s-", "s-": "s+"}.get(start, start)
        options["start"] = start
    return options


def computed(entry, case, mirrored=False, **more):
    options = options_of(case, mirrored) | {"accuracy": 1e-3 if entry.quick else 1e-5} | more
    if case["scheme"] == "levels":
        options["noise_degree"] = 0
    if case["scheme"] == "upwind":
        options |= {"scheme": "upwind", "p": 2 if case["drag"] == "none" else 8}
    return entry.run(**options)["results"]


EXCHANGED = {"h_plus": "h_minus_from_minus", "h_minus": "h_plus_from_minus",
             "w_one": "w_one_from_minus", "entry_law": "entry_law_minus"}
EXCHANGED |= {b: a for a, b in EXCHANGED.items()}


def seen_in_mirror(results, f, image):
    """The results of a mirror image under the names, and with the signs, of the original."""
    seen = {}
    for key, r in results.items():
        r = dict(r)
        if key in EXCHANGED:
            key = EXCHANGED[key] if EXCHANGED[key] in results else key
        for a, b in (("w_plus(", "w_minus("), ("u(", "u_minus("), ("mu(", "mu_minus(")):
            if key.startswith(a) and b + key[len(a):] in results:
                key = b + key[len(a):]
            elif key.startswith(b):
                key = a + key[len(b):]
        if key == "P_X_le_mu_s":  # that of the direction
            continue
        key = key.replace(image, f)
        if key.startswith("entry_law"):
            r["value"] = r["value"][::-1]
        if key == "E_V" or key.startswith("dE_V_"):
            r["value"] = -r["value"]
        if key.endswith("_dmu_d") and key + "_minus" in results:
            key += "_minus"
        elif key.endswith("_dmu_d_minus"):
            key = key[:-len("_minus")]
        seen[key] = r
    return seen


def beyond_errors(one, other):
    """By how many times their errors the values of two runs differ, at most, and where."""
    most, where = 0.0, ""
    for key in one.keys() & other.keys():
        pairs = list(zip(entries(one[key]), entries(other[key])))
        size = max(abs(a) for (a, *_), _ in pairs)
        for (a, error_a, _), (b, error_b, _) in pairs:
            times = abs(a - b) / (error_a + error_b + 1e-9 * size + 1e-14)
            if not times <= most:
                most, where = times, key
    return most, where


def far_apart(one, other):
    """The largest difference relative to the largest value of a result, and where."""
    most, where = 0.0, ""
    for key in one.keys() & other.keys():
        pairs = [(a, b) for (a, *_), (b, *_) in zip(entries(one[key]), entries(other[key]))]
        size = max(max(abs(a) for a, _ in pairs), 1e-3)
        for a, b in pairs:
            if not abs(a - b) / size <= most:
                most, where = abs(a - b) / size, key
    return most, where


def flat(results):
    """Entries by place, but for cells and modes."""
    return by_place({key: r for key, r in results.items() if key not in CELLS and not key.startswith("relaxation")})


def name_of(case):
    return " ".join(str(v) for v in case.values())


def mirror_images(entry, cases):
    """Mirror images, and symmetric cases with next to no bias."""
    mirrored, vanishing = [], []
    for case, here in cases:
        # Of these only what starts at s+ is printed with symmetry.
        one_side = case["question"] in ("entries", "resolvent") and is_symmetric(case)
        f, image = OBSERVABLES[case["observable"]]
        there = {} if one_side else seen_in_mirror(
            computed(entry, case, mirrored=True), f, image)
        if case["question"] in ROUGH:
            off, where = beyond_errors(here, there)
        else:
            off, where = far_apart(here, there)
            off /= ROUNDING.get(case["question"], 1e-9)
        mirrored.append((off, name_of(case), where))
        if not is_symmetric(case):
            continue
        off, where = beyond_errors(here, computed(entry, case, bias=NOTHING))
        vanishing.append((off, name_of(case), where))
    for found, what in ((mirrored, "its mirror image, in units of what rounding allows"),
                        (vanishing, "itself with a bias of 1e-300, in units of both errors")):
        found.sort(key=lambda one: -one[0])
        entry.table(f"Each of {len(found)} combinations compared with {what}; the farthest",
                    ("combination", "quantity", "distance"),
                    [(name, where, off) for off, name, where in found[:4]])
        entry.claim(f"distance of a combination from {what}", found[0][0], 1)


def simulations(entry, cases):
    """z of everything that can be simulated, by question."""
    excursions = 5000 if entry.quick else 400000
    beside, by_question = [], collections.defaultdict(list)
    for case, here in cases:
        if case["question"] in NOT_SIMULATED or case["scheme"] == "upwind":
            continue
        simulated = flat(entry.run(route="monte_carlo", excursions=excursions,
                                   **options_of(case, False))["results"])
        exact = flat(here)
        for place, (value, error, ends) in simulated.items():
            if place not in exact or ends is None or ends[0] == ends[1]:
                continue
            known = (*exact[place][:2], {"value": value, "ci95": ends})
            beside.append(known)
            by_question[case["question"]].append(deviation(*known))
    rows = [(question, len(z), sum(abs(one) < 1.96 for one in z) / len(z), max(map(abs, z)))
            for question, z in sorted(by_question.items())]
    entry.table("Computed values compared with simulation, by question",
                ("question", "values", "within 1.96", "largest |z|"), rows)
    z = [deviation(*known) for known in beside]
    inside = sum(abs(one) < 1.96 for one in z) / len(z)
    entry.at_least(f"share of {len(z)} confidence intervals at 95 % that hold the value", inside, 0.9)
    allowed = 4.5 + math.log10(len(z)) / 4
    entry.claim("largest |z|", max(map(abs, z)), allowed)


def directions(entry):
    """Thresholds by direction, against a bias and in white noise."""
    by_direction = entry.run(mu_s=1, mu_d=0.5, mu_s_minus=1.2, mu_d_minus=0.7, delta=0.25,
                             accuracy=1e-11, quantities="sticking,moments")["results"]
    by_bias = entry.run(mu_s=1.1, mu_d=0.6, bias=0.1, delta=0.25, accuracy=1e-11,
                        quantities="sticking,moments")["results"]
    entry.claim("thresholds that differ alike are a bias, relative", worse(*(
        difference(r["value"], by_bias[key]["value"]) for key, r in by_direction.items())), 1e-10)
    rows, found = [], []
    for plus, minus in ((0.5, 1), (0.8, 0.6)):
        values = [entry.run(drag="none", mu_s=1, mu_d=plus, mu_d_minus=minus, tau=tau, delta=1,
                            quantities="moments", accuracy=1e-9)["results"]["E_V"]["value"]
                  for tau in (1 / 32, 1 / 64, 1 / 128, 1 / 256)]
        while len(values) > 1:  # orders 1/2, 1, 3/2 in tau
            power = 2 ** ((5 - len(values)) / 2)
            values = [(power * b - a) / (power - 1) for a, b in itertools.pairwise(values)]
        found.append(difference(values[0], 1 / plus - 1 / minus))
        rows.append((plus, minus, values[0], 1 / plus - 1 / minus))
    entry.table("E[V] without drag as tau -> 0, thresholds by direction", ("mu_d+", "mu_d-", "extrapolated",
                                                  "1/mu_d+ - 1/mu_d-"), rows)
    entry.claim("the drift of thresholds by direction tends to that in white noise, relative",
                worse(*found), 1e-3)


def main():
    entry = Entry(__doc__, "beyond the paper")
    rng = random.Random(20)
    cases, refused = [], []
    for case in drawn(rng, 0 if entry.quick else 20):
        try:
            cases.append((case, computed(entry, case)))
        except BadInput as reason:
            refused.append((name_of(case), str(reason)))
    entry.text(f"{len(cases)} combinations run, {len(refused)} refused")
    for name, reason in refused:
        print(f"  {name}: {reason}")
    entry.claim("combinations that are refused", len(refused), 0)
    directions(entry)
    mirror_images(entry, cases[::4] if entry.quick else cases)
    simulations(entry, cases)
    entry.end()


main()
