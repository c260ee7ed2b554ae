"""Autocovariance and spectrum of a noise, beside those that it stands for."""

from typing import Any

from ..chains import Chain, Noise
from ..views import view
from .style import ABSCISSAE, COLOURS, Figure, numpy, styled, units

SMALL = 0.02  # of the variance, which the covariance has fallen to where the picture ends


@view("picture", Noise)
@styled
def draw(chain: Noise, axes: Any = None) -> Figure:
    """Draws in two axes, by default of a new figure; returns the figure."""
    of_time, of_frequency = Figure(figsize=(8, 3.2)).subplots(1, 2) if axes is None else axes
    longest = 1 / chain.fastest
    while longest < 1e9 and abs(chain.covariance(numpy.linspace(longest, 2 * longest, 9))).max() > SMALL * chain.deviation**2:
        longest *= 2
    for ax, points, part in ((of_time, numpy.linspace(0, 2 * longest, 201), "covariance"),
                             (of_frequency, numpy.geomspace(0.3 / longest, 1000 / longest, 201), "spectrum")):
        if chain.meant:
            ax.plot(points, getattr(chain.meant, part)(points), color="0.6", lw=3, label=chain.meant.label)
        ax.plot(points, getattr(chain, part)(points), color=COLOURS[0], label="chain" if isinstance(chain, Chain) else "noise")
    of_time.set(xlabel=ABSCISSAE["time"], ylabel="autocovariance" + units("force^2"))
    of_frequency.set(xlabel=ABSCISSAE["omega"], ylabel="spectrum" + units("force^2*time"), xscale="log", yscale="log")
    of_time.legend()
    return of_time.figure
