"""Draws the correlation time of the velocity, 1/(full width of S_v at half maximum), against tau.

usage: python3 correlation_time.py FILE.h5... PICTURE.png
       python3 correlation_time.py --run build/stickslip [--keep FOLDER] PICTURE.png

Files come from `stickslip -quantities spectrum -output FILE.h5`; those that differ by tau alone
make a curve. --run computes the five curves of the paper (delta = 1/4; some minutes).
"""

from results import COLOURS, STYLES, arguments_of, files, plt, power_of_two

CURVES = [("linear", mu_d) for mu_d in (1, 0.75, 0.5, 0.25)] + [("none", 1)]
SCENES = [{"quantities": "spectrum", "delta": 0.25, "drag": drag, "mu_d": mu_d, "tau": 2.0**-n}
          for drag, mu_d in CURVES for n in range(7)]
WHITE_NOISE = {("0", 1): 1.35446038, ("-v", 1): 0.247854704305}  # tau -> 0 at mu_d = mu_s = 1


def name(file):
    return (file.drag(), file.number("mu_d"), file.number("mu_s"), file.number("delta"))


def draw(spectra, picture):
    curves = {}
    for file in spectra:
        curves.setdefault(name(file), []).append((file.number("tau"), float(file.value("t_corr"))))
    curves = dict(sorted(curves.items(), key=lambda curve: (curve[0][0] == "0", -curve[0][1])))
    same_noise = len({key[2:] for key in curves}) == 1
    figure, axes = plt.subplots(figsize=(6.4, 4.0), layout="constrained")
    for n, (key, points) in enumerate(curves.items()):
        drag, mu_d, mu_s, delta = key
        label = rf"$\mu_d$ = {mu_d:g}, $b(v) = {drag}$"
        if not same_noise:
            label += rf", $\mu_s$ = {mu_s:g}, $\delta$ = {power_of_two(delta)}"
        colour = COLOURS[n % len(COLOURS)]
        axes.plot(*zip(*sorted(points)), color=colour, linestyle=STYLES[n % len(STYLES)],
                  marker="os^Dv"[n % 5], markersize=4, label=label)
        if mu_d == mu_s and (drag, mu_d) in WHITE_NOISE:
            axes.plot(0, WHITE_NOISE[drag, mu_d], marker=(3, 0, -90), markersize=8, color=colour,
                      transform=axes.get_yaxis_transform(), clip_on=False, zorder=3)
    axes.axvline(1 / 8, color="#777777", linewidth=1, linestyle=":")
    axes.text(1 / 8, 0.02, r" $\tau$ = 1/8", transform=axes.get_xaxis_transform(), color="#555555")
    axes.set_xscale("log", base=2)
    axes.xaxis.set_major_formatter(lambda x, _: power_of_two(x))
    axes.set(xlabel=r"correlation time of the noise $\tau$  [time]",
             ylabel=r"correlation time of the velocity $t_\mathrm{corr}$  [time]", ylim=(0, None))
    if same_noise:
        _, _, mu_s, delta = next(iter(curves))
        axes.set_title(rf"$\mu_s$ = {mu_s:g}, $\delta$ = {power_of_two(delta)}; triangles on the "
                       r"left: white noise, $\tau \to 0$", fontsize=9)
    axes.legend(loc="best")
    figure.savefig(picture, dpi=160)


def main():
    arguments = arguments_of(__doc__, scenes=True)
    draw(files(arguments, SCENES), arguments.picture)


if __name__ == "__main__":
    main()
