"""Measurements beside the model that was fitted to them, and profiles of parameters."""

import pathlib
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from ..fitting import Fit, Profile
from ..measurements import PHASES, Sample, Values, at
from ..results import Results
from ..views import view
from .style import ABSCISSAE, COLOURS, Figure, numpy, on_axis, saved, styled, symbol, units, words

if TYPE_CHECKING:
    from matplotlib.axes import Axes
COLUMNS = 3  # of panels
WIDE = 20    # factor between values
LIMITS = (0.99, 3.84)  # rise of a profile at the ends of 68 and 95 % confidence intervals


@view("picture", Fit)
@styled
def draw(fit: Fit, picture: str | pathlib.Path | None) -> "Figure":
    """A panel for each array and each sample, and one for all scalars; the estimates above."""
    panels: list[Callable[[Axes], None]] = []
    scalars = []
    for n, (one, found) in enumerate(zip(fit.sets, fit.results)):
        name = f"  (set {n})" if len(fit.sets) > 1 else ""
        scalars += [(values.key + name, (values.value - values.of(found))[0] / values.error[0]) for values in one.values
                    if values.over is None]
        panels += [lambda axes, values=values, found=found, name=name: _array(axes, values, found, name)
                   for values in one.values if values.over is not None]
        panels += [lambda axes, sample=sample, found=found, name=name: _sample(axes, sample, found, name)
                   for sample in one.samples]
    if scalars:
        panels.insert(0, lambda axes: _scalars(axes, scalars))
    columns = min(len(panels), COLUMNS)
    rows = -(-len(panels) // columns)
    figure = Figure(figsize=(1 + 3.1 * columns, 0.6 + 2.7 * rows))
    places = figure.subplots(rows, columns, squeeze=False).ravel()
    for place, panel in zip(places, panels):
        panel(place)
    for place in places[len(panels):]:
        place.set_visible(False)
    figure.suptitle(",   ".join(rf"{symbol(name)} = {value:.4g} $\pm$ {fit.errors[name]:.2g}"
                                for name, value in fit.estimates.items()))
    saved(figure, pathlib.Path(picture) if picture else None)
    return figure


def _scalars(axes: "Axes", pulls: Sequence[tuple[str, float]]) -> None:
    place = numpy.arange(len(pulls))
    axes.errorbar([pull for _, pull in pulls], place, xerr=1, fmt="o", color=COLOURS[0], markersize=4, capsize=2)
    axes.axvline(0, color=COLOURS[4], linewidth=1)
    axes.set_yticks(place, [words(key) for key, _ in pulls])
    axes.set(xlabel="measured less model  [standard errors]", ylim=(len(pulls) - 0.5, -0.5))


def _array(axes: "Axes", values: Values, found: Results, name: str) -> None:
    result = found[values.key]
    axes.errorbar(values.over, values.value, values.error, fmt="o", color=COLOURS[0], markersize=3, capsize=2, label="measured")
    axes.plot(result.abscissa, result.value, color=COLOURS[1], label="model")
    axes.set(xscale=_scale(values.over), yscale=_scale(values.value - values.error), title=name,
             xlabel=ABSCISSAE.get(result.abscissa_name, result.abscissa_name), ylabel=words(values.key) + units(result.unit))
    axes.legend()


def _scale(values: "numpy.ndarray") -> str:
    """Logarithmic where positive values differ by a large factor."""
    return "log" if values.min() > 0 and values.max() > WIDE * values.min() else "linear"


def _sample(axes: "Axes", sample: Sample, found: Results, name: str) -> None:
    phase, over = PHASES[sample.name]
    longer = 1 - numpy.arange(1, sample.values.size + 1) / sample.values.size
    axes.step(sample.values, longer, where="post", color=COLOURS[0], label=f"{sample.values.size} {sample.name}")
    result = found[f"cdf_{phase}"]
    grid = result.abscissa[(result.abscissa >= sample.values[0]) & (result.abscissa <= 2 * sample.values[-1])]
    axes.plot(grid, (1 - at(found, f"cdf_{phase}", grid)) / (1 - sample.missed(found)), color=COLOURS[1], label="model")
    axes.set(xscale="log", xlabel=ABSCISSAE[over], ylabel="share that is longer", title=name)
    axes.legend()


@view("picture", Profile)
@styled
def draw_profile(profile: Profile, picture: str | pathlib.Path | None) -> "Figure":
    """The rise of twice the misfit, and the limits of confidence intervals."""
    figure = Figure(figsize=(4.4, 3.2))
    axes = figure.subplots()
    root = numpy.sqrt(numpy.maximum(profile.rise, 0)) * numpy.sign(profile.values - profile.values[profile.rise.argmin()])
    fine = numpy.linspace(profile.values[0], profile.values[-1], 201)  # roots are nearly straight, as `interval` has it
    axes.plot(fine, numpy.interp(fine, profile.values, root) ** 2, color=COLOURS[0])
    axes.plot(profile.values, profile.rise, "o", color=COLOURS[0], markersize=3, clip_on=False)  # the least is whole
    for limit, share in zip(LIMITS, ("68 %", "95 %")):
        axes.axhline(limit, color=COLOURS[4], linewidth=0.8, linestyle="--")
        axes.text(profile.values[0], limit, share, fontsize=8, va="bottom")
    axes.set(xlabel=on_axis(profile.name) + units(profile.unit), ylabel=r"rise of $\chi^2 - 2 \log L$", ylim=(0, None))
    saved(figure, pathlib.Path(picture) if picture else None)
    return figure
