"""Held results: forty scenes, all quantities, all solution methods, one and two ranks.

values.csv holds what the program gave when it was last written, with 17 digits. A later build has to give the same
within the sum of both errors, and the same exit statuses. Two builds on one machine can be compared to the bit, which
is how changes are held that move code and no number.

usage: golden.py compare PROGRAM [--quick] [--only WORDS]      with values.csv, within errors
       golden.py bits PROGRAM OTHER [--quick] [--only WORDS]   two builds, to the bit
       golden.py write PROGRAM [--only WORDS]                  renews values.csv (all of it, or what WORDS choose)

--quick takes each tenth scene. --only takes the scenes and methods whose names hold one of the words.
"""

import argparse
import csv
import json
import math
import os
import pathlib
import shlex
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "validation"))
import harness

VALUES = HERE / "values.csv"
DATA = HERE.parent / "data"

# Options of a scene. What is not given has its default: mu_s = tau = drag_coefficient = 1.
SCENES = {
    "paper": "-mu_d 0.25",
    "paper_coarse": "-mu_d 0.25 -delta 0.5",
    "equal_friction": "-delta 0.25",
    "half_friction": "-mu_d 0.5 -delta 0.25",
    "full_levels": "-mu_d 0.5 -delta 0.5 -noise_levels full",
    "few_levels": "-mu_d 0.5 -delta 0.25 -noise_levels 6",
    "noise_nodes": "-mu_d 0.25 -delta 0.015625",
    "static_between_levels": "-mu_s 1.1 -mu_d 0.6 -delta 0.25",
    "weak_friction": "-mu_s 0.3 -mu_d 0.02 -delta 0.25",
    "strong_static": "-mu_s 4 -mu_d 0.5 -delta 0.25",
    "short_correlation": "-tau 0.1 -delta 0.5 -mu_d 0.5",
    "long_correlation": "-tau 8 -delta 0.125 -mu_s 0.7 -mu_d 0.35",
    "small_deviation": "-mu_d 0.5 -noise_deviation 0.6 -delta 0.2",
    "bias": "-mu_d 0.5 -delta 0.25 -bias 0.3",
    "negative_bias": "-mu_d 0.7 -delta 0.25 -bias -0.45",
    "near_depinning": "-mu_d 0.6 -bias 0.9 -noise_deviation 0.3 -delta 0.1",
    "static_by_direction": "-mu_d 0.5 -mu_s_minus 1.5 -delta 0.25",
    "both_by_direction": "-mu_s 0.8 -mu_d 0.5 -mu_s_minus 1.2 -mu_d_minus 0.9 -delta 0.25",
    "stribeck": "-mu_d 0.4 -delta 0.25 -friction stribeck -stribeck_velocity 0.3",
    "stribeck_gauss": "-mu_d 0.4 -delta 0.25 -friction stribeck -stribeck_velocity 0.5 -stribeck_exponent 2 -bias 0.2",
    "cubic_drag": "-mu_d 0.5 -delta 0.25 -drag cubic -drag_coefficient 0.5 -drag_cubic 1",
    "quadratic_drag": "-mu_d 0.25 -delta 0.25 -drag expression -drag_expression ' -v-0.1*v*abs(v)'",
    "kinked_drag": "-mu_d 0.5 -delta 0.25 -drag expression -drag_expression ' -0.5*v-2*max(v-0.5,0)'",
    "saturating_drag": "-mu_d 0.5 -delta 0.25 -drag expression -drag_expression ' -0.4*tanh(3*v)-0.2*v'",
    "ratchet": "-mu_s 0.5 -mu_d 0.25 -delta 0.25 -drag expression -drag_expression 'v>0?(0-3)*v:(0-0.5)*v'",
    "no_drag": "-mu_d 0.5 -delta 0.25 -drag none",
    "no_drag_equal_friction": "-delta 0.25 -drag none",
    "no_drag_bias": "-mu_d 0.8 -delta 0.25 -drag none -bias 0.2",
    "speed_limit": "-mu_d 0.5 -delta 0.25 -drag none -speed_limit 1",
    "telegraph": "-mu_d 0.5 -noise telegraph -telegraph_amplitude 1.3 -telegraph_rate 0.8",
    "telegraph_bias": "-mu_d 0.5 -noise telegraph -telegraph_amplitude 1.3 -telegraph_rate 0.8 -bias 0.2",
    "six_levels": "-mu_s 1.3 -mu_d 0.5 -noise file -noise_file DATA/six_levels.csv",
    "five_levels": "-mu_s 1.3 -mu_d 0.13 -drag_coefficient 0.3 -noise file -noise_file DATA/five_levels.csv",
    "on_off": "-mu_s 1.7 -mu_d 1.7 -noise file -noise_file DATA/onoff3.csv",
    "pulses": "-mu_d 0.5 -noise pulses -pulse_height 1.5 -pulse_rate 0.5 -pulse_duration 1",
    "decaying_pulses": "-mu_d 0.5 -noise pulses -pulse_height 2 -pulse_rate 0.3 -pulse_decay 0.8 -pulse_steps 3 -pulse_sign up",
    "periodic": "-mu_d 0.5 -noise periodic -periodic_amplitude 1.5 -period 6 -period_phases 8",
    "chain": "-mu_d 0.5 -noise chain -noise_states HERE/states.csv -noise_rates HERE/rates.csv",
    "chain_of_cycles": "-mu_s 1.2 -mu_d 0.6 -bias 0.1 -noise chain -noise_states HERE/states.csv -noise_rates HERE/rates.csv",
    "telegraph_and_ou": "-mu_d 0.5 -noise telegraph+ou -telegraph_amplitude 0.7 -telegraph_rate 0.5 -delta 0.5 -noise_levels 3",
}

OBSERVABLE = "-observable 'v^2;stick;abs(v)>0.3'"
# Quantities by what they cost, each with an accuracy that takes seconds.
QUESTIONS = {
    "stationary": f"sticking,moments,averages,noise_law,noise_spectrum,entry_law {OBSERVABLE} -omega 0,1 -accuracy 1e-8",
    "transforms": f"laplace,F_stick,resolvent {OBSERVABLE} -lambda 0.3,2 -accuracy 1e-7",
    "spectrum": "spectrum -omega 0.5,3 -accuracy 1e-6",
    "durations": "duration_density -time 0.3,2 -accuracy 1e-4",
    "slips": "slip,peak -distance 0.1,0.6 -inverse_distance 1 -velocity 0.2,0.5 -accuracy 1e-4",
    "times": "autocorrelation,displacement -time 0.3,2 -accuracy 1e-4",
    "expectation": f"expectation {OBSERVABLE} -time 0.3,2 -start rest -accuracy 1e-4",
    "passages": "first_passage,passage_transform,passage_distribution -velocity 0.3 -lambda 0.5 -time 0.5,2 -start rest -accuracy 1e-4",
    "relaxation": "relaxation -accuracy 1e-6",
    "sensitivity": "sticking,moments,sensitivity -accuracy 1e-6",
    "deviations": "large_deviation -tilt -0.3,0.4 -accuracy 1e-6",
    "transform_of_displacement": "displacement_transform -wavenumber 0.5,2 -time 1 -start rest -accuracy 1e-5",
    "displacements": "displacement_distribution -time 2 -distance 0.1,0.5 -probability 0.5,0.9 -start rest -accuracy 3e-2",
}
ENVIRONMENT = {**harness.MPI_PERMISSIONS, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
UPWIND = "-scheme upwind -p 4"
METHODS = {
    "lambda": f"-route lambda {UPWIND} -quantities sticking,moments,averages -observable v^2",
    "hitting": f"-route hitting {UPWIND} -quantities sticking",
    "null_vector": f"-route null_vector {UPWIND} -quantities sticking,moments,averages -observable v^2",
    "upwind": f"{UPWIND} -quantities sticking,moments,averages -observable v^2",
    "fluid_queue": "-route fluid_queue -quantities sticking,moments,entry_law",
    "monte_carlo": "-route monte_carlo -excursions 2000 -seed 1 -quantities sticking,moments,averages,slip,laplace,expectation "
                   "-observable v^2 -distance 0.1,0.6 -lambda 0.3 -time 0.3,2 -start rest",
}
# On two ranks: what exchanges vectors, and what hands out work.
RANKS = {"two_ranks": ("stationary", 2), "two_ranks_simulated": ("monte_carlo", 2)}
NOT_BY_POINTS = ("noise_nodes",)  # levels by the hundred
# What takes minutes where the noise has many states.
OF_MANY_STATES = ("pulses", "decaying_pulses")
SLOW_BY_STATES = ("durations", "slips", "times", "expectation", "passages", "relaxation", "transform_of_displacement",
                  "displacements", *METHODS, *RANKS)


def asked(program, only, quick):
    """Name and command of each run that is chosen."""
    scenes = list(SCENES.items())[::10 if quick else 1]
    every = {name: f"-quantities {words}" for name, words in QUESTIONS.items()} | METHODS
    for scene, options in scenes:
        for name, words in [*every.items(), *((n, every[of]) for n, (of, _) in RANKS.items())]:
            if name == "fluid_queue" and "-drag none" not in options:
                continue
            if UPWIND in words and scene in NOT_BY_POINTS or name in SLOW_BY_STATES and scene in OF_MANY_STATES:
                continue
            if only and not any(word in f"{scene}/{name}" for word in only):
                continue
            text = f"{options} {words}".replace("DATA/", f"{DATA}/").replace("HERE/", f"{HERE}/")
            ranks = ["mpiexec", "-n", str(RANKS[name][1])] if name in RANKS else []
            yield f"{scene}/{name}", [*ranks, program, *shlex.split(text)]


def flat(x):
    return [y for z in x for y in flat(z)] if isinstance(x, list) else [x]


def results_of(command):
    """Exit status, and {key: (values, errors)} of a run."""
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder) / "summary.json"
        environment = {**os.environ, **ENVIRONMENT}
        run = subprocess.run([*command, "-summary", file], capture_output=True, env=environment, check=False)
        found = json.loads(file.read_text())["results"] if file.exists() else {}
    return run.returncode, {key: (flat([r["value"]]), flat([r["error"]])) for key, r in found.items()}


def rows_of(name, command):
    """Lines of values.csv for a run. A run without results has one, with its exit status."""
    status, results = results_of(command)
    rows = {(name, "exit_status", 0): (float(status), 0.0)}
    for key, (values, errors) in results.items():
        for index, (value, error) in enumerate(zip(values, errors)):
            number = [math.nan if x is None else float(x) for x in (value, error)]
            rows[name, key, index] = tuple(number)
    return rows


def equal_bits(a, b):
    return a == b or (math.isnan(a) and math.isnan(b))


def within(held, found):
    """Whether two values with errors agree. Rounding may differ between processors."""
    (a, e), (b, f) = held, found
    if math.isnan(a) or math.isnan(b):
        return math.isnan(a) and math.isnan(b)
    return abs(a - b) <= e + f + 1e-11 * abs(a)


def differences(held, found, agree):
    for row in sorted(held.keys() | found.keys()):
        name = " ".join(map(str, row))
        if row not in found or row not in held:
            yield f"{name}: {'lost' if row in held else 'new'}"
        elif not agree(held[row], found[row]):
            (a, e), (b, f) = held[row], found[row]
            yield f"{name}: {a:.17g} +- {e:.1e} -> {b:.17g} +- {f:.1e}"


def read():
    with VALUES.open() as file:
        return {(r["run"], r["key"], int(r["index"])): (float(r["value"]), float(r["error"])) for r in csv.DictReader(file)}


def write(rows):
    with VALUES.open("w", newline="") as file:
        out = csv.writer(file, lineterminator="\n")
        out.writerow(["run", "key", "index", "value", "error"])
        out.writerows([*row, f"{value:.17g}", f"{error:.2g}"] for row, (value, error) in sorted(rows.items()))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=["compare", "bits", "write"])
    parser.add_argument("program")
    parser.add_argument("other", nargs="?")
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--only", nargs="+", default=[])
    given = parser.parse_args()
    if (given.what == "bits") != (given.other is not None):
        parser.error("two programs are for `bits` alone, which needs both")
    held = read() if VALUES.exists() else {}
    if given.what == "write" and not given.only:
        held = {}
    count = differing = 0
    for name, command in asked(given.program, given.only, given.quick):
        found = rows_of(name, command)
        if given.what == "write":
            held = {row: v for row, v in held.items() if row[0] != name} | found
            print(f"{name}: {len(found)} values", flush=True)
            continue
        if given.what == "bits":
            of_other = rows_of(name, [given.other if word == given.program else word for word in command])
            lines = list(differences(found, of_other, lambda a, b: all(map(equal_bits, a, b))))
        else:
            lines = list(differences({row: v for row, v in held.items() if row[0] == name}, found, within))
        count += len(found)
        differing += len(lines)
        print("\n".join(lines) or f"{name}: {len(found)} values", flush=True)
    if given.what == "write":
        write(held)
        return 0
    print(f"{count - differing} passed, {differing} failed")
    return 1 if differing else 0


if __name__ == "__main__":
    sys.exit(main())
