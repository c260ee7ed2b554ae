"""Draws error against time of every method.

usage: python3 cost.py FILE.h5 PICTURE.png

The file comes from `stickslip -study cost -output FILE.h5`.
"""

import math

from results import COLOURS, STYLES, File, arguments_of, plt

NAMES = {"hp": "hp elements", "upwind": "upwind", "richardson": "upwind, Richardson",
         "monte_carlo": "Monte Carlo"}
PARAMETERS = {"hp": "degree", "upwind": "p", "richardson": "p", "monte_carlo": "excursions"}


def told(parameter, value):
    if parameter == "excursions":
        return rf"$10^{{{math.log10(value):.0f}}}$ excursions"
    return f"{parameter} {value:g}" if parameter == "degree" else f"{parameter} = {value:g}"


def draw(file, picture):
    figure, axes = plt.subplots(figsize=(6.4, 4.2), layout="constrained")
    tables = file.groups("study")
    for n, (method, name) in enumerate(NAMES.items()):
        table = tables[method]
        seconds, error, parameter = (table[key] for key in ("seconds", "error", PARAMETERS[method]))
        axes.plot(seconds, error, color=COLOURS[n], linestyle=STYLES[n], marker="os^D"[n],
                  markersize=4, label=name)
        for end, side in ((0, "left"), (-1, "right")):
            shift = (5, 5) if side == "left" else (-2, -11)
            axes.annotate(told(PARAMETERS[method], parameter[end]), (seconds[end], error[end]),
                          textcoords="offset points", xytext=shift, fontsize=7, ha=side,
                          color=COLOURS[n])
    axes.set(xscale="log", yscale="log", xlabel="time  [s]", ylabel="largest relative error")
    axes.margins(x=0.15)
    axes.legend(loc="lower right")
    scene = file.options
    axes.set_title(rf"$\mu_s$ = {scene['mu_s']}, $\mu_d$ = {scene['mu_d']}, $\tau$ = {scene['tau']}, "
                   rf"$\delta$ = {scene['delta']}, $b(v) = {file.drag()}$", fontsize=9)
    figure.savefig(picture, dpi=160)


def main():
    arguments = arguments_of(__doc__)
    draw(File(arguments.files[0]), arguments.picture)


if __name__ == "__main__":
    main()
