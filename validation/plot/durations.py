"""Draws the densities of the durations of slides, stays and excursions.

usage: python3 durations.py FILE.h5... PICTURE.png

Files come from `stickslip -quantities duration_density -time 0:0.1:201 -output FILE.h5`. Files that
differ by delta alone share a panel, the finest drawn solid and the next ones dotted.
"""

import sys

from results import COLOURS, File, arguments_of, plt, power_of_two

QUANTITIES = {"f_stick": ("sticking", COLOURS[1]), "f_slide": ("sliding", COLOURS[0]),
              "f_excursion": ("excursion", COLOURS[4])}
LINES = ("-", (0, (1, 1)), (0, (4, 1.5)))


def panels_of(laws):
    panels = {}
    for file in laws:
        key = (file.number("mu_s"), file.number("mu_d"), file.memory(), file.drag())
        panels.setdefault(key, []).append(file)
    return panels


def line_styles(laws):
    """By noise step, the finest solid; solid also where there is none."""
    deltas = sorted({file.step() or 0 for file in laws})
    if len(deltas) > len(LINES):
        sys.exit(f"{len(deltas)} values of delta; at most {len(LINES)} can be told apart")
    return dict(zip(deltas, LINES))


def draw_panel(axes, key, same, lines):
    for file in same:
        for quantity, (_, colour) in QUANTITIES.items():
            axes.plot(*file.curve(quantity, "time"), color=colour, linewidth=1.6,
                      linestyle=lines[file.step() or 0])
    mu_s, mu_d, noise, drag = key
    axes.set_title(rf"$\mu_s$ = {mu_s:g}, $\mu_d$ = {mu_d:g}, {noise}, $b(v) = {drag}$",
                   fontsize=9)
    axes.set(xlabel="duration  [time]", ylabel="density  [1/time]", ylim=(0, None))
    axes.margins(x=0)


def draw_legend(axes, lines):
    """In a row of its own: curves reach every corner of a panel."""
    handles = [plt.Line2D([], [], color=colour, label=label)
               for label, colour in QUANTITIES.values()]
    handles += [plt.Line2D([], [], color="#888888", linestyle=line,
                           label=rf"$\delta$ = {power_of_two(delta)}")
                for delta, line in lines.items() if delta]
    axes.legend(handles=handles, loc="center", ncol=len(handles), columnspacing=1.2)
    axes.axis("off")


def draw(laws, picture):
    panels, lines = panels_of(laws), line_styles(laws)
    columns = min(len(panels), 2)
    rows = -(-len(panels) // columns)
    figure = plt.figure(figsize=(max(5.4, 0.6 + 3.9 * columns), 0.3 + 2.9 * rows),
                        layout="constrained")
    grid = figure.add_gridspec(rows + 1, columns, height_ratios=[0.3] + [2.9] * rows)
    draw_legend(figure.add_subplot(grid[0, :]), lines)
    for n, (key, same) in enumerate(panels.items()):
        draw_panel(figure.add_subplot(grid[1 + n // columns, n % columns]), key, same, lines)
    figure.savefig(picture, dpi=160)


def main():
    arguments = arguments_of(__doc__)
    draw([File(name) for name in arguments.files], arguments.picture)


if __name__ == "__main__":
    main()
