"""Draws error against time of every method.

usage: python3 cost.py FILE.h5 PICTURE.png

The file comes from `stickslip -study cost -output FILE.h5`.
"""

from results import COLOURS, STYLES, File, arguments_of, plt

NAMES = {"hp": "hp elements", "upwind": "upwind", "richardson": "upwind, Richardson",
         "monte_carlo": "Monte Carlo"}
PARAMETERS = {"hp": "degree", "upwind": "p", "richardson": "p", "monte_carlo": "excursions"}


def draw(file, picture):
    figure, axes = plt.subplots(figsize=(6.4, 4.2), layout="constrained")
    tables = file.groups("study")
    for n, (method, name) in enumerate(NAMES.items()):
        table = tables[method]
        seconds, error, parameter = (table[key] for key in ("seconds", "error", PARAMETERS[method]))
        axes.plot(seconds, error, color=COLOURS[n], linestyle=STYLES[n], marker="os^D"[n],
                  markersize=4, label=name)
        for end in (0, -1):
            axes.annotate(f"{PARAMETERS[method]} {parameter[end]:g}", (seconds[end], error[end]),
                          textcoords="offset points", xytext=(5, 5), fontsize=7, color=COLOURS[n])
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
