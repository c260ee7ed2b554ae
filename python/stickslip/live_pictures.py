"""Pictures that follow the parameters: what is drawn stays, and new results move it, several times faster than drawing
anew."""

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from .needed import needed
from .plots.curves import DURATIONS
from .plots.fields import SLIDE, STICK, cells_around, resolved
from .plots.style import ABSCISSAE
from .results import Results

if TYPE_CHECKING:
    from matplotlib.figure import Figure

numpy = needed("numpy")

LEAST = 1e-3  # probability outside of what is shown
COLUMNS = 200  # of the picture of the density
DEPTH = 1e-4  # smallest density with a colour of its own, by the largest
SHOWN = 1e-6  # smallest value of a curve, by its largest
AREA = 900  # of the disc of a state at rest with probability 1, in points^2
NUMBERS = ("P_stick", "mean_stick", "mean_slide", "E_V2", "E_absV", "E_V")
SHARES = (0.5, 0.9)  # quantiles of durations
BOTTOM = 0.45  # of the pictures in the figure
LOWEST, MIDDLE = BOTTOM - 0.075, (BOTTOM + 1) / 2 - 0.04  # with their labels; between spectrum and durations
PLACES = {"distribution": (0, LOWEST, 0.557, 1), "spectrum": (0.557, MIDDLE, 1, 1),
          "durations": (0.557, LOWEST, 1, MIDDLE), "numbers": (0, 0.05, 0.22, LOWEST)}
PICTURES = tuple(PLACES)[:3]
NUMBERED = (0, 2)  # pictures that numbers belong to


class LivePictures:
    """The stationary distribution, numbers, the power spectral density and densities of durations, on one figure.

    Parameters
    ----------
    figure
        Where to draw: above `BOTTOM`, and the numbers below it on the left.
    """

    def __init__(self, figure: "Figure") -> None:
        colors, patches = needed("matplotlib.colors"), needed("matplotlib.patches")
        grid = figure.add_gridspec(2, 5, width_ratios=(3, 1, 0.12, 0.9, 3.6), height_ratios=(3, 1), left=0.06,
                                   right=0.985, top=0.96, bottom=BOTTOM, hspace=0.07, wspace=0.06)
        self.density = figure.add_subplot(grid[0, 0])
        self.by_v = figure.add_subplot(grid[0, 1], sharey=self.density)
        self.by_x = figure.add_subplot(grid[1, 0], sharex=self.density)
        self.image = self.density.imshow(numpy.ones((2, 2)), aspect="auto", origin="lower", cmap="Blues",
                                         norm=colors.LogNorm(DEPTH, 1), interpolation="nearest")
        self.scale = figure.colorbar(self.image, cax=figure.add_subplot(grid[0, 2]), label="density of sliding")
        self.scale.minorticks_off()  # each takes its time to draw
        self.scale.ax.yaxis.label.set_size(9)  # all of it fits beside the scale
        self.at_rest = self.density.scatter([], [], color=STICK, zorder=3)
        self.density.set_title("", y=1, fontsize=9, color=STICK)
        self.density.set_ylabel("velocity $v$  [velocity]")
        self.density.tick_params(labelbottom=False)
        self.curve_v, = self.by_v.plot([], [], color=SLIDE)
        self.by_v.set_xlabel("density of $V$  [1/velocity]", fontsize=8)
        self.by_v.tick_params(labelleft=False, labelsize=8)
        self.stairs_x, self.stairs_rest = (self.by_x.stairs([0], [0, 1], fill=True, color=color, label=label)
                                           for color, label in ((SLIDE, "sliding"), (STICK, "sticking")))
        self.by_x.set(xlabel="force $x$  [force]", ylabel="$P(X = x)$")
        corner = figure.add_subplot(grid[1, 1])
        corner.axis("off")
        corner.legend(handles=[self.stairs_x, self.stairs_rest], fontsize=8, loc="lower left", frameon=False)
        right = grid[:, 4].subgridspec(2, 1, hspace=0.42)
        self.spectrum, self.durations = (figure.add_subplot(right[n]) for n in range(2))
        self.curves: dict[str, Any] = {}
        self.bands: dict[str, Any] = {}
        self._curves(self.spectrum, ABSCISSAE["omega"], "$S_v$  [velocity$^2$ time]",
                     {"S_v": ("power spectral density of the velocity", SLIDE)})
        self._curves(self.durations, "duration  [time]", "probability density  [1/time]",
                     {key: DURATIONS[key] for key in ("f_stick", "f_slide")})
        self.axes = (self.density, self.by_v, self.by_x, self.spectrum, self.durations)
        for axes in (*self.axes[1:], self.scale.ax, corner):
            axes.set_title("", y=1)  # or each drawing looks for a free place of the title, at a third of its time
        self.words = figure.text(0.012, 0.365, "", va="top", family="monospace", fontsize=8)
        self.quantiles = figure.text(0.012, 0.235, "", va="top", family="monospace", fontsize=8)
        # What is not of the parameters shown is veiled: distribution, spectrum, durations.
        self.veils = [figure.add_artist(patches.Rectangle(
            (left, low), right - left, high - low, transform=figure.transFigure, color="#eeeeee", alpha=0.75, linewidth=0,
            antialiased=False, zorder=5, visible=False)) for left, low, right, high in map(PLACES.get, PICTURES)]

    def _curves(self, axes: Any, abscissa: str, ordinate: str, curves: "dict[str, tuple[str, str]]") -> None:
        for key, (label, color) in curves.items():
            self.curves[key], = axes.loglog([], [], color=color, label=label)
        axes.set(xlabel=abscissa, ylabel=ordinate)
        axes.yaxis.set_label_coords(-0.115, 0.5)  # within the region, however long its numbers are
        for axis in (axes.xaxis, axes.yaxis):
            axis.set_minor_locator(needed("matplotlib.ticker").NullLocator())
        axes.grid(alpha=0.3)
        axes.legend(fontsize=8, loc="lower left", frameon=False)

    def veil(self, parts: "Iterable[int]", veiled: bool) -> None:
        """Grey what is not of the parameters shown, or no longer: 0 distribution, 1 spectrum, 2 durations."""
        for part in parts:
            self.veils[part].set_visible(veiled)
            for text in ((self.words,), (), (self.quantiles,))[part]:
                text.set_color("#bbbbbb" if veiled else "black")

    def draw(self, part: int, found: Results) -> None:
        """Show results of a part: 0 distribution, 1 spectrum, 2 durations."""
        (self._draw_distribution, self._draw_spectrum, self._draw_durations)[part](found)
        self.veil((part,), False)

    def _draw_distribution(self, found: Results) -> None:
        density = found.density.by_force()
        v, x = density.window(LEAST), density.x
        edges = cells_around(x)
        steps = numpy.diff(edges)
        likely = numpy.flatnonzero(density.marginal_x > LEAST * density.marginal_x.max())
        low, high = edges[likely[0]], edges[likely[-1] + 1]
        columns = numpy.searchsorted(edges, numpy.linspace(low, high, COLUMNS)) - 1  # of the level at each force
        picture = (resolved(density.at(v)) / steps[:, None])[numpy.clip(columns, 0, len(x) - 1)].T
        largest = picture.max()
        self.image.set_data(numpy.maximum(picture / largest, DEPTH))  # a scale that changes takes its time to draw
        self.scale.ax.yaxis.label.set_text(f"density of sliding; 1 is {largest:.3g}/(force velocity)")
        self.image.set_extent((low, high, v[0], v[-1]))
        held = density.at_rest > 0
        self.at_rest.set_offsets(numpy.column_stack([x[held], numpy.zeros(held.sum())]))
        self.at_rest.set_sizes(AREA * density.at_rest[held])
        margin = 0.03 * numpy.ptp(v)  # rest is seen whole where no body moves to one of the sides
        self.density.set(xlim=(low, high), ylim=(min(v[0], -margin), max(v[-1], margin)))
        self.density.title.set_text(f"at rest with probability {density.mass_at_rest:.4g} (discs, by area)")
        marginal = density.marginal(v)
        self.curve_v.set_data(marginal, v)
        self.by_v.set_xlim(0, 1.05 * marginal.max())
        self.stairs_x.set_data(density.marginal_x, edges)
        self.stairs_rest.set_data(density.at_rest, edges)
        self.by_x.set_ylim(0, 1.05 * density.marginal_x.max())
        self.words.set_text("\n".join(f"{key:<11} {found[key].value:>10.6g} " + (
            f"± {found[key].error:.0e}" if found[key].error else "exactly") for key in NUMBERS))

    def _draw_spectrum(self, found: Results) -> None:
        self._move(self.spectrum, found, ("S_v",))

    def _draw_durations(self, found: Results) -> None:
        self._move(self.durations, found, ("f_stick", "f_slide"))
        rows = [f"{'quantiles':<11}" + "".join(f"{share:>10.0%}" for share in SHARES)]
        for key, name in (("cdf_stick", "T_stick"), ("cdf_slide", "T_slide")):
            rows.append(f"{name:<11}" + "".join(f"{quantile(found[key], share):>10}" for share in SHARES))
        self.quantiles.set_text("\n".join(rows))

    def _move(self, axes: Any, found: Results, keys: "tuple[str, ...]") -> None:
        for key in keys:
            result = found[key]
            self.curves[key].set_data(result.abscissa, result.value)
            old = self.bands.pop(key, None)
            if old:
                old.remove()
            self.bands[key] = axes.fill_between(result.abscissa, result.value - result.error,
                                                result.value + result.error, alpha=0.3, linewidth=0,
                                                color=self.curves[key].get_color())
        shown = numpy.concatenate([found[key].value for key in keys])
        if (shown > 0).any():
            high = shown.max()
            axes.set_ylim(max(high * SHOWN, shown[shown > 0].min() / 2), 2 * high)
        axes.set_xlim(result.abscissa[0], result.abscissa[-1])


def quantile(cdf: Any, share: float) -> str:
    """Where a distribution function reaches a share, to the two digits that its values between the points allow."""
    if share < cdf.value[0]:
        return f"< {cdf.abscissa[0]:.2g}"
    if share > cdf.value[-1]:
        return f"> {cdf.abscissa[-1]:.2g}"
    rising = numpy.maximum.accumulate(cdf.value)
    return f"{numpy.exp(numpy.interp(share, rising, numpy.log(cdf.abscissa))):.2g}"
