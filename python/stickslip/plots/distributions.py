"""Distributions of the displacement: densities with their atoms, and distribution functions with quantiles."""

import dataclasses
import re
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from ..results import Result, Results
from .style import COLOURS, DISPLACEMENT, MARKERS, Figure, curve, numpy, styled, title

if TYPE_CHECKING:
    from matplotlib.axes import Axes

DISTRIBUTIONS = ("displacement_density", "displacement_cdf", "displacement_quantile")


def times(item: Results, key: str) -> list[str]:
    """The times, as keys spell them, at which the file has that part of a distribution."""
    return [found[1] for name in item if (found := re.fullmatch(rf"{key}\((.*)\)", name))]


def has_distribution(item: Results) -> bool:
    """Whether there is a curve or a quantile to draw."""
    return any(times(item, key) for key in DISTRIBUTIONS)


def is_part(key: str) -> bool:
    """Whether the key is shown in these pictures."""
    return key.startswith(tuple(f"{name}(" for name in DISTRIBUTIONS)) or key in (
        "displacement_atom", "displacement_atom_at")


@styled
def displacements(items: Sequence[Results]) -> "Figure":
    """Density and distribution function by displacement, a colour for each time and file. Atoms are stems with
    a mark at their probability, to the scale on the right; quantiles are marks with their errors on the distribution function."""
    curves = [(item, time) for item in items
              for time in dict.fromkeys(time for key in DISTRIBUTIONS for time in times(item, key))]
    dense = any(times(item, DISTRIBUTIONS[0]) for item in items)
    figure = Figure(figsize=(4.0 + 3.4 * dense, 3.4))
    axes = figure.subplots(1, 1 + dense, squeeze=False)[0]
    for n, (item, time) in enumerate(curves):
        label = f"t = {time}" + (f", {item.name}" if len(items) > 1 else "")
        if f"{DISTRIBUTIONS[1]}({time})" in item:
            curve(axes[-1], item[f"{DISTRIBUTIONS[1]}({time})"], n, label=label)
        if f"{DISTRIBUTIONS[0]}({time})" in item:
            for side in _sides(item[f"{DISTRIBUTIONS[0]}({time})"]):
                curve(axes[0], side, n)
        _quantiles(axes[-1], item, time, n, label)
    if dense:
        axes[0].set(xlabel=DISPLACEMENT, ylabel="density  [1/length]", ylim=(0, None))
        _atoms(axes[0], curves)
    axes[-1].set(xlabel=DISPLACEMENT, ylabel=r"$P(x(t) \leq d)$", ylim=(-0.03, 1.03))
    axes[-1].legend(fontsize=8)
    if len(items) == 1:
        figure.suptitle(title(items[0]), fontsize=10)
    return figure


def _sides(density: Result) -> Iterator[Result]:
    """Below 0 and above, where it is infinite."""
    for side in (density.abscissa < 0, density.abscissa > 0):
        if side.any():
            ci95 = None if density.ci95 is None else density.ci95[side]
            yield dataclasses.replace(density, value=density.value[side], error=density.error[side],
                                      abscissa=density.abscissa[side], ci95=ci95)


def _quantiles(axes: "Axes", item: Results, time: str, n: int, label: str) -> None:
    found = item.get(f"{DISTRIBUTIONS[2]}({time})")
    if found is not None:
        axes.errorbar(found.value, found.abscissa, xerr=found.error, fmt="D", color=COLOURS[n % len(COLOURS)], markersize=4,
                      capsize=2, zorder=3, label=None if f"{DISTRIBUTIONS[1]}({time})" in item else label)


def _atoms(axes: "Axes", curves: Sequence[tuple[Results, str]]) -> None:
    """Where there is one; a body simulated has none."""
    scale = None
    for n, (item, time) in enumerate(curves):
        if "displacement_atom" not in item:
            continue
        at = numpy.argmin(numpy.abs(item["displacement_atom"].abscissa - float(time)))
        probability = item["displacement_atom"].value[at]
        if probability > 0:
            scale = scale or axes.twinx()
            place, colour = item["displacement_atom_at"].value[at], COLOURS[n % len(COLOURS)]
            scale.vlines(place, 0, probability, color=colour, linewidth=1)  # narrow: the density peaks there
            scale.plot(place, probability, marker=MARKERS[n % 5], color=colour, markerfacecolor="white", markersize=6)
    if scale is not None:
        scale.set(ylabel="probability of the atom (mark)", ylim=(0, 1.15 * scale.dataLim.y1))
        scale.grid(False)
