"""Hard cases.

usage: python3 validation/hard/run.py [--quick] [--program build/stickslip] [--report FOLDER]

Scenes that break naive code, each with an identity that must hold.
"""

import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from entry import Entry
from harness import difference, worse

# name, options; what is hard about it
SCENES = [
    ("grid point on both thresholds", {"mu_d": 1, "delta": 0.125}),
    ("mu_d just below a grid point", {"mu_d": 0.5 - 1e-12, "delta": 0.125}),
    ("mu_s just above a grid point", {"mu_s": 1 + 1e-12, "mu_d": 0.5, "delta": 0.125}),
    ("nearly no dynamic friction", {"mu_d": 1e-8, "delta": 0.25}),
    ("mean sticking time of 6e8", {"mu_s": 6, "mu_d": 0.25, "delta": 0.25}),
    ("three noise levels", {"mu_s": 0.5, "mu_d": 0.25, "tau": 2, "delta": 1}),
    ("short correlation, tau = 2^-6", {"tau": 2.0**-6, "mu_d": 0.5, "delta": 1}),
    ("long correlation, tau = 2^6", {"tau": 64, "mu_s": 0.1, "mu_d": 0.05, "delta": 0.02}),
    ("no drag", {"drag": "none", "mu_d": 0.5, "delta": 0.25}),
    ("steep cubic drag", {"drag": "cubic", "drag_cubic": 1000, "mu_d": 0.5, "delta": 0.25})]


def checked(entry, options):
    """Relative defects of E[XV] = mu_d E|V| - E[b(V) V] (linear drag) and of P_stick + P_slide = 1."""
    found = entry.run(quantities="sticking,moments", accuracy=1e-8, **options)
    r = {key: value["value"] for key, value in found["results"].items()}
    scene = found["scene"]
    friction, drag = scene["mu_d"] * r["E_absV"], scene["drag_coefficient"] * r["E_V2"]
    power = abs(friction + drag - r["E_XV"]) / r["E_XV"] if scene["drag"] != "cubic" else 0.0
    return found, r, worse(power, abs(r["P_stick"] + r["P_slide"] - 1))


def main():
    entry = Entry(__doc__, "beyond the paper")
    rows, defects, missed = [], [], 0
    for name, options in SCENES[:6] if entry.quick else SCENES:
        found, r, defect = checked(entry, options)
        defects.append(defect)
        missed += not found["accuracy"]["reached"]
        rows.append((name, f"{r['P_stick']:.12g}", f"{r['P_slide']:.12g}", f"{r['mean_stick']:.12g}",
                     f"{defect:.1e}", f"{found['cost']['seconds']:.2f}"))
    entry.table("Scenes", ("scene", "P_stick", "P_slide", "mean_stick", "defect", "seconds"), rows)
    entry.claim("balance of power and of probability, relative", worse(*defects), 1e-8)
    entry.claim("scenes that missed -accuracy 1e-8", missed, 0.5)
    stuck = entry.run(quantities="sticking", mu_s=6, mu_d=0.25, delta=0.25, accuracy=1e-11)["results"]
    entry.claim("P_slide at mu_s = 6 against 8.131297917733e-9, relative",
                difference(stuck["P_slide"]["value"], 8.131297917733e-9), 1e-10)
    entry.end()


main()
