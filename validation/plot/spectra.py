"""Draws spectral densities of the velocity: a panel for each mu_d and delta, a curve for each tau.

usage: python3 spectra.py FILE.h5... PICTURE.png
       python3 spectra.py --run build/stickslip [--keep FOLDER] PICTURE.png

Files come from `stickslip -quantities spectrum -omega 1e-3:50:200:log -output FILE.h5`. --run
computes the 27 scenes of the paper (mu_d = 1/4, 1/2, 1; delta = 1, 1/2, 1/4; tau = 1, 1/2, 1/4).
"""

import itertools

from results import COLOURS, STYLES, arguments_of, files, plt, power_of_two

SCENES = [{"quantities": "spectrum", "omega": "1e-3:50:200:log", "mu_d": mu_d, "delta": delta,
           "tau": tau}
          for mu_d, delta, tau in itertools.product((0.25, 0.5, 1), (1, 0.5, 0.25), (1, 0.5, 0.25))]


def draw(spectra, picture):
    def all_of(option):
        return sorted({file.number(option) for file in spectra})

    columns, rows = all_of("mu_d"), sorted({file.step() or 0 for file in spectra}, reverse=True)
    curves = list(dict.fromkeys(file.memory() for file in sorted(spectra, key=lambda file: -file.number("tau"))))
    figure, axes = plt.subplots(
        len(rows), len(columns), figsize=(1.2 + 2.3 * len(columns), 0.9 + 1.9 * len(rows)),
        sharex=True, sharey=True, squeeze=False, layout="constrained")
    lowest = highest = None
    for file in spectra:
        place = axes[rows.index(file.step() or 0)][columns.index(file.number("mu_d"))]
        n = curves.index(file.memory())
        omega, value = file.curve("S_v", "omega")
        seen = (omega > 0) & (value > 0)  # logarithmic axes
        place.loglog(omega[seen], value[seen], color=COLOURS[n % len(COLOURS)],
                     linestyle=STYLES[n % len(STYLES)], linewidth=1.6,
                     label=curves[n])
        lowest = min(filter(None, (lowest, value[seen].min())))
        highest = max(filter(None, (highest, value.max())))
    axes[0][0].set_ylim(lowest / 2, highest * 2)
    for row, delta in zip(axes, rows):
        row[0].set_ylabel(r"$S_v$  [velocity$^2$ time]")
        for place, mu_d in zip(row, columns):
            step = rf", $\delta$ = {power_of_two(delta)}" if delta else ""
            place.set_title(rf"$\mu_d$ = {power_of_two(mu_d)}{step}", fontsize=9)
            if not place.lines:
                place.text(0.5, 0.5, "no file", transform=place.transAxes, ha="center")
    for place in axes[-1]:
        place.set_xlabel(r"$\omega$  [1/time]")
    handles = {line.get_label(): line for place in axes.flat for line in place.lines}
    axes[0][0].legend([handles[label] for label in curves], curves, loc="lower left")
    mu_s = ", ".join(f"{x:g}" for x in all_of("mu_s"))
    drags = ", ".join(sorted({file.drag() for file in spectra}))
    figure.suptitle(rf"Spectral density of the velocity; $\mu_s$ = {mu_s}, $b(v) = {drags}$",
                    fontsize=10)
    figure.savefig(picture, dpi=160)


def main():
    arguments = arguments_of(__doc__, scenes=True)
    draw(files(arguments, SCENES), arguments.picture)


if __name__ == "__main__":
    main()
