"""Draws the stationary law that `-quantities density -output FILE.h5` wrote.

usage: python3 density.py FILE.h5 PICTURE.png
"""

import sys

import matplotlib
import numpy

from results import COLOURS, File, plt

SLIDE, STICK = COLOURS[:2]


def edges(points):
    middle = (points[1:] + points[:-1]) / 2
    return numpy.concatenate([[points[0]], middle, [points[-1]]])


def cells(levels):
    """Ends of the cells around noise levels, the outer ones as wide to both sides."""
    ends = edges(levels)
    ends[[0, -1]] = 2 * levels[[0, -1]] - ends[[1, -2]]
    return ends


def window(points, weight, share):
    """The range of points outside which less than `share` of the weight lies."""
    inside = points[weight > share * weight.max()]
    return inside[0], inside[-1]


def draw(law, picture):
    field = law.group("density")
    x, v = field["x"], field["v"]
    ends = cells(x)
    width = numpy.diff(ends)
    figure, axes = plt.subplots(
        2, 2, figsize=(7.2, 5.2), sharex="col", sharey="row", layout="constrained",
        gridspec_kw={"width_ratios": (3, 1), "height_ratios": (3, 1.2)})
    plane, by_v, by_x, corner = axes[0, 0], axes[0, 1], axes[1, 0], axes[1, 1]
    corner.axis("off")

    pdf = numpy.maximum(field["pdf"].T / width, 1e-12)
    seen = numpy.flatnonzero(field["marginal_x"] > 1e-4 * field["marginal_x"].max())
    v_low, v_high = window(v, field["marginal_v"], 1e-4)
    image = plane.pcolormesh(ends, edges(v), pdf, norm=matplotlib.colors.LogNorm(1e-5, pdf.max()), cmap="Blues",
                             rasterized=True)
    stuck = field["atom"] > 0
    plane.scatter(x[stuck], 0 * x[stuck], s=900 * field["atom"][stuck], color=STICK, zorder=3,
                  label="sticking (area: probability)")
    plane.set(xlim=(ends[seen[0]], ends[seen[-1] + 1]), ylim=(v_low, v_high), ylabel="$v$  [velocity]")
    plane.legend(loc="upper left", frameon=False)
    figure.colorbar(image, ax=by_v, label="density while sliding  [1/(force velocity)]")

    by_v.plot(field["marginal_v"], v, color=SLIDE)
    by_v.set(xlabel="density of $v$\n[1/velocity]", xlim=(0, None))
    by_v.tick_params(labelbottom=True)
    by_x.bar(x, field["marginal_x"] - field["atom"], width * 0.9, field["atom"], color=SLIDE,
             label="sliding")
    by_x.bar(x, field["atom"], width * 0.9, color=STICK, label="sticking")
    by_x.set(xlabel="forcing $x$  [force]", ylabel="$P(X = x)$")
    by_x.legend(loc="upper left", frameon=False)
    mu_s, mu_d = (law.number(name) for name in ("mu_s", "mu_d"))
    bias = law.number("bias")
    pushed = f", bias {bias:g}" if bias else ""
    figure.suptitle(rf"$\mu_s$ = {mu_s:g}, $\mu_d$ = {mu_d:g}, {law.noise()}, "
                    rf"$b(v) = {law.drag()}${pushed}: "
                    rf"$P_{{stick}}$ = {field['atom'].sum():.4f}")
    figure.savefig(picture, dpi=160)


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    draw(File(sys.argv[1]), sys.argv[2])


if __name__ == "__main__":
    main()
