"""The cases: what is hard about each, and what must hold.

Options not given: mu_s = tau = 1, mu_d = 1/4, delta = 1/4, linear drag with c = 1, -accuracy 1e-9. The
properties are the functions of properties.py; "reference" compares with reference/values.json. Cases marked
`long` are left out by --quick.
"""

import dataclasses

STATIONARY = "sticking,moments,noise_law,entry_law"
EPS = 1e-12


@dataclasses.dataclass
class Scene:
    name: str
    why: str
    properties: tuple
    options: dict
    long: bool = False
    quantities: str = STATIONARY
    misses: bool = False  # a value so small or so near 0 that its relative error cannot be -accuracy


def scene(name, why, properties, long=False, quantities=STATIONARY, misses=False, **options):
    return Scene(name, why, tuple(properties.split()), options, long, quantities, misses)


BASE = {"mu_s": 1, "mu_d": 0.25, "tau": 1, "delta": 0.25, "accuracy": 1e-9}
NO_ENTRY = "sticking,moments,noise_law"  # without symmetry there is no single hitting distribution
BALANCE = "power probability noise entry sticking "
STRIBECK = {"friction": "stribeck", "mu_d": 0.5, "quantities": STATIONARY + ",averages"}
ONE_SIDED = "v>0 ? (0-3)*v : (0-0.5)*v"

SCENES = (
    # Thresholds on the grid and next to it.
    scene("mu_d = mu_s on the grid", "level k creeps towards rest and never arrives; a layer at v = 0",
          BALANCE + "reference null_vector", mu_d=1, delta=0.5),
    scene("mu_d = mu_s off the grid", "the slowest level below mu_d is a small distance from rest",
          BALANCE + "reference", mu_s=0.7, mu_d=0.7, delta=0.5),
    scene("mu_d on a grid point below mu_s", "B = 0 at v = 0: neither inflow nor outflow",
          BALANCE + "null_vector", mu_d=0.5),
    scene("mu_d 1e-12 below a grid point", "the level leaves v = 0 at speed 1e-12",
          BALANCE + "reference neighbour", mu_d=0.5 - EPS, delta=0.5),
    scene("mu_d 1e-12 above a grid point", "the level comes to rest at speed 1e-12: a layer that thin",
          BALANCE + "reference neighbour", mu_d=0.5 + EPS, delta=0.5),
    scene("mu_s 1e-12 below a grid point", "k must be the level below",
          BALANCE + "reference", mu_s=1 - EPS, delta=0.5),
    scene("mu_s 1e-12 above a grid point", "k must be that grid point",
          BALANCE + "same", mu_s=1 + EPS, delta=0.5),
    scene("mu_s = 0.3, delta = 0.1", "0.3/0.1 is below 3 in doubles",
          BALANCE, mu_s=0.3, mu_d=0.1, delta=0.1),
    scene("mu_d = 1e-8", "level 0 comes to rest at speed 1e-8; hardly any friction",
          BALANCE + "reference", mu_d=1e-8, delta=0.5),
    scene("mu_d = 1e-300", "products of two such numbers underflow",
          BALANCE, mu_d=1e-300, delta=0.5),

    # Rare sliding.
    scene("mu_s = 3 deviations", "P_slide 1e-3", BALANCE + "reference", mu_s=3),
    scene("mu_s = 6 deviations", "mean sticking time 6e8: a joint LU loses nine digits",
          BALANCE + "reference transforms", mu_s=6, quantities=STATIONARY + ",laplace",
          **{"lambda": "0,1e-14,1"}),
    scene("mu_s = 7.75, k = N - 1", "exit only from the last state; mean sticking time 1e18",
          BALANCE + "reference", mu_s=7.75),
    scene("mu_s = 9, delta = 1/5", "mean sticking time above 1e18, and 1/5 is no double",
          BALANCE, long=True, mu_s=9, delta=0.2),
    scene("mu_s = 10 deviations", "mean sticking time 1e23; f_stick(0+) = 1e-37", BALANCE, long=True, misses=True, mu_s=10,
          delta=0.125),
    scene("mu_d = mu_s = 7", "rare sliding that ends at once; f_stick(0+) = 1e-73", BALANCE, misses=True, mu_s=7, mu_d=7),
    scene("mu_s = 27 deviations", "P_slide below 1e-150: squares underflow", BALANCE, long=True,
          mu_s=27, mu_d=26, delta=1 / 16, degree=6),
    scene("mu_s = 31.9 deviations, k = N - 1", "1 - P_stick below 1e-300, mean sticking time near 1e308",
          BALANCE, long=True, mu_s=31.9375, mu_d=31, delta=1 / 16, degree=6),

    # Time scales.
    scene("tau = 2^-12", "jumps 1e6 times faster than drag", BALANCE + "scaled", tau=2.0**-12,
          mu_s=64, mu_d=16, delta=16),
    scene("tau = 2^-12 without drag", "the same, and no terminal velocity",
          BALANCE + "reference fluid_queue", tau=2.0**-12, mu_s=64, mu_d=20, delta=32, drag="none"),
    scene("tau = 2^-6", "short correlation", BALANCE + "scaled", tau=2.0**-6, mu_d=0.5, delta=1),
    scene("tau = 2^-6, mu_s far below a deviation", "hardly ever at rest; k = 0",
          BALANCE + "scaled", tau=2.0**-6, mu_s=0.5, mu_d=0.5, delta=1),
    scene("tau = 2^6", "drag outruns the noise: layers of thickness g/c", BALANCE + "reference scaled",
          tau=64, mu_s=0.125, mu_d=0.05, delta=1 / 16),
    scene("tau = 2^6, fine", "the same at delta = 1/128 of a deviation's 16th", BALANCE, long=True,
          tau=64, mu_s=0.125, mu_d=0.05, delta=1 / 64),
    scene("delta = 1", "five levels", BALANCE + "reference", delta=1, mu_d=0.3),
    scene("delta = 2^-6", "8192 levels meant, 1e5 unknowns", BALANCE, long=True, delta=2.0**-6,
          accuracy=1e-7),
    scene("delta = 2^-9", "2^19 levels meant, the smallest element 1e-9", BALANCE, long=True,
          delta=2.0**-9, degree=2),
    scene("N = 1", "three levels: by hand", BALANCE + "reference by_hand", mu_s=0.5, mu_d=0.25, tau=2,
          delta=1),
    scene("k = 0", "one static level; the odd static chain is empty", BALANCE + "reference null_vector",
          mu_s=0.4, mu_d=0.3, delta=0.5),
    scene("range truncated at k + 1", "exit only into the last level", BALANCE + "reference",
          mu_s=1, delta=0.5, noise_levels=3),
    scene("full range at delta = 1/8", "257 levels whose distribution spans 77 decades", BALANCE, long=True,
          delta=0.125, noise_levels="full"),

    # Drag.
    scene("no drag", "no terminal velocity", BALANCE + "reference fluid_queue", mu_d=0.3, delta=0.5,
          drag="none"),
    scene("no drag, mu_d = 0.05", "E[V^2] = 700 from velocities up to 1e3",
          BALANCE + "reference fluid_queue", mu_d=0.05, delta=0.5, drag="none"),
    scene("no drag, mu_d on a level", "zero speed at every v on one level", BALANCE + "fluid_queue",
          mu_d=0.5, drag="none"),
    scene("drag 1e-6", "terminal velocity 4e6", BALANCE + "near_no_drag", mu_d=0.3, delta=0.5,
          drag_coefficient=1e-6),
    scene("drag 1e4", "stiff: everything within v = 4e-4", BALANCE + "reference", mu_d=0.3, delta=0.5,
          drag_coefficient=1e4),
    scene("cubic drag 1e3", "roots of B crowd as x^(1/3)", "probability noise entry sticking reference",
          mu_d=0.3, delta=0.5, drag="cubic", drag_cubic=1000),
    scene("cubic drag 1e9, c = 0", "drag that vanishes to third order at rest",
          "probability noise entry sticking reference", misses=True, mu_d=0.3, delta=0.5,
          drag="cubic", drag_coefficient=0, drag_cubic=1e9),

    # Friction that weakens with the speed, and drag that rises: levels leave a velocity v* for both sides.
    scene("weakening", "the level at mu_s parts at rest", BALANCE + "finer null_vector",
          **STRIBECK, stribeck_velocity=0.1),
    scene("weakening within 1e-3", "one level parts at v* = 7e-4, one at rest: solutions like |v - v*|^0.06",
          BALANCE + "finer", **STRIBECK, stribeck_velocity=1e-3),
    scene("weakening within 1e-3, delta = 1/16", "eight levels that part, like |v - v*|^1 and more",
          BALANCE + "finer", **{**STRIBECK, "delta": 0.0625}, stribeck_velocity=1e-3, long=True),
    scene("weakening, gamma = 1/2", "friction falls from rest with an infinite slope",
          BALANCE + "finer", **STRIBECK, stribeck_velocity=0.1, stribeck_exponent=0.5),
    scene("weakening, gamma = 2, off the grid", "flat at rest, and no level has mu_s",
          BALANCE + "finer", **{**STRIBECK, "mu_s": 0.9}, stribeck_velocity=0.2, stribeck_exponent=2),
    scene("weakening without drag", "friction falls tenfold, and nothing else holds fast bodies",
          BALANCE + "finer", **{**STRIBECK, "mu_d": 0.1}, stribeck_velocity=0.1, drag="none"),
    scene("weakening in slow noise", "bodies cross v* by drift alone",
          BALANCE + "finer", **{**STRIBECK, "mu_s": 0.5, "mu_d": 0.1}, tau=10, stribeck_velocity=0.02),
    scene("weakening and bias", "two velocity branches with their own v*", "power probability noise finer",
          **{**STRIBECK, "quantities": NO_ENTRY + ",averages"}, stribeck_velocity=0.1, bias=0.3),
    scene("drag that rises to friction", "F - b falls from 1/2 to 0.02 before drag takes over",
          "probability noise entry finer", mu_d=0.5, drag="expression",
          drag_expression="0.5*tanh(3*v) - 0.1*v"),

    # Without symmetry.
    scene("one-sided drag", "two velocity branches that differ", "probability noise reference",
          delta=0.5, drag="expression", drag_expression=ONE_SIDED, quantities=NO_ENTRY),
    scene("one-sided drag and bias", "the same, static levels -3 ... 1",
          "probability noise reference", delta=0.5, drag="expression",
          drag_expression=ONE_SIDED, bias=0.5, quantities=NO_ENTRY),
    scene("bias on thresholds", "X + g meets mu_d and mu_s on levels", "power probability noise reference null_vector",
          mu_d=0.5, bias=0.5, delta=0.5, quantities=NO_ENTRY),
    scene("strong bias", "rest only against the slope: P_stick small", "power probability noise reference", mu_d=0.5,
          bias=2.5, delta=0.5, quantities=NO_ENTRY),
    scene("bias 1e-300", "no symmetry, and no difference; E[V] is rounding", "power probability noise same", misses=True, bias=1e-300, delta=0.5, quantities=NO_ENTRY),

    # Discretisations fixed by hand.
    scene("degree 1", "the coarsest elements keep probability", "probability noise entry sticking lambda_route hitting",
          degree=1, noise_degree=0),
    scene("degree 16", "powers of v to v^16", BALANCE + "lambda_route hitting", degree=16,
          noise_degree=0),
    scene("degree 24", "powers of v to v^24; the last one there is",
          BALANCE + "reference", degree=24, delta=0.5),
    scene("upwind p = 1", "one point per noise step", "probability noise entry sticking null_vector lambda_route",
          scheme="upwind", p=1, noise_levels="full"),
    scene("upwind p = 1, N = 1", "the smallest system there is", "probability noise entry sticking null_vector",
          scheme="upwind", p=1, mu_s=0.5, tau=2, delta=1),
    scene("simulation", "no discretisation in common", BALANCE + "monte_carlo", delta=0.5,
          mu_d=0.5 + EPS),

    # Transforms and spectra far out.
    scene("lambda from 1e-14 to 1e12", "1 - F cancels at one end, F underflows at the other",
          "transforms reference", delta=0.5, quantities="sticking,entry_law,laplace",
          **{"lambda": "0,1e-14,1e-9,1e-3,1,20,1e4,1e8,1e12"}),
    scene("lambda to 1e12, mu_d = mu_s", "sliding that ends at once: F_slide falls slowly",
          "transforms", mu_d=1, delta=0.5, quantities="sticking,entry_law,laplace",
          **{"lambda": "0,1e-14,1e-9,1e-3,1,1e4,1e8,1e12"}),
    scene("resolvent from 1e-14 to 1e12", "u is a constant of 1e14 plus numbers of order one",
          "resolvent", delta=0.5, quantities="sticking,resolvent", observable="stick;v^2;x*v",
          **{"lambda": "1e-14,1e-8,1e-3,1,1e4,1e8,1e12"}),
    scene("omega from 0 to 1e8", "far out 24 digits cancel in the direct formula",
          "spectrum reference", delta=0.5, accuracy=3e-9, quantities="sticking,moments,spectrum",
          omega="0,1e-12,1e-3,1,20,1e4,1e7,1e8"),
    scene("waves, mu_d 1e-12 above a level", "as short as 1e-12 on the level that nearly stands",
          "spectrum reference", mu_s=1.5, mu_d=1 + EPS, delta=1, accuracy=1e-6,
          quantities="sticking,moments,spectrum", omega="0,1e-12,1,20"),
    scene("lambda to 1e12, mu_d 1e-12 above a level", "a layer of 1e-24",
          "transforms reference", mu_d=0.5 + EPS, delta=0.5, quantities="sticking,entry_law,laplace",
          **{"lambda": "0,1e-14,1e-9,1e-3,1,20,1e4,1e8,1e12"}),
    scene("spectrum by two solvers, tau = 2^-4", "reduced model against a complex factorisation",
          "spectrum direct", tau=2.0**-4, mu_d=1, delta=1, quantities="sticking,moments,spectrum",
          omega="0,1e-12,0.01,1,20,100"),
    scene("spectrum at mu_s = 6", "S_v of 1e-8 with sliding that is rare", "spectrum", long=True, mu_s=6,
          quantities="sticking,moments,spectrum", omega="0,1e-12,0.01,1,20,100"),
)

# What must be refused: options, exit status, a word of the message.
REFUSED = (
    ("mu_d above mu_s", {"mu_d": 2}, 2, "mu_d"),
    ("mu_s beyond the noise", {"mu_s": 8.5}, 2, "mu_s"),
    ("noise range truncated at k", {"mu_s": 1, "noise_levels": 4}, 2, "noise_levels"),
    ("tau = 0", {"tau": 0}, 2, "tau"),
    ("delta too large for a chain", {"delta": 2}, 2, "delta"),
    ("drag that grows", {"drag": "expression", "drag_expression": "v"}, 2, "drag_expression"),
    ("drag that outgrows friction", {"drag": "expression", "drag_expression": "0.3*tanh(v)"}, 2, "for ever"),
    ("delta = 2^-12, upwind", {"delta": 2.0**-12, "scheme": "upwind", "p": 64}, 4, "memory"),
    ("bias beyond static levels", {"bias": 20}, 2, "bias"),
)
