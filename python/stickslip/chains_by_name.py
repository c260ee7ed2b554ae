"""Chains of noises with a name."""

import dataclasses
import math

from .chains import Chain, Meant
from .needed import needed

numpy, sparse, csgraph = needed("numpy"), needed("scipy.sparse"), needed("scipy.sparse.csgraph")

FULL = 6      # deviations, beyond which levels of ou are left out
RADIUS = 3.5  # deviations, within which the lattices in the plane lie


def positive(**values: float) -> None:
    """Refuse what is not in (0, inf), by its name."""
    for name, value in values.items():
        if not 0 < value < math.inf:
            raise ValueError(f"{name} = {value}: must be in (0, inf)")


def ou(deviation: float, tau: float, delta: float, levels: int | None = None) -> Chain:
    """The Ornstein-Uhlenbeck chain of the program: forces i delta, |i| <= levels, rates (s^2/(tau delta^2)) (1 -+ i
    delta^2/(2 s^2)) up and down, covariance s^2 exp(-t/tau) with all levels. Fewer are those of `-noise_levels`: the
    outermost are left at the rate at which all others are, 2 s^2/(tau delta^2).

    Parameters
    ----------
    deviation, tau, delta
        Standard deviation s [force], correlation time [time] and step [force].
    levels
        On each side of 0; by default as many as within 6 deviations, or as have positive rates.

    Raises
    ------
    ValueError
        If a parameter is not positive, or the rates would be negative.
    """
    positive(deviation=deviation, tau=tau, delta=delta)
    full = 2 * (deviation / delta) ** 2  # the level from which the chain can only return
    if levels is None:
        levels = max(min(math.floor(full * (1 + 1e-12)), math.ceil(FULL * deviation / delta)), 1)
    if not 1 <= levels <= math.ceil(full * (1 - 1e-12)) or full < 1:
        raise ValueError(f"levels = {levels}: rates are positive in [1, {math.ceil(full * (1 - 1e-12))}] with delta = {delta}; "
                         f"take fewer levels, or a delta of at most {math.sqrt(2) * deviation:g}")
    tilt = delta**2 / (2 * deviation**2) * numpy.arange(-levels, levels + 1)
    scale = deviation**2 / (tau * delta**2)
    down = scale * numpy.append(1 + tilt[1:-1], max(1 + tilt[-1], 2))  # above 2 where the last level is beyond `full`
    rates = sparse.diags([down[::-1], down], [1, -1])
    return Chain(delta * numpy.arange(-levels, levels + 1), rates, "ou", Meant(
        lambda t: deviation**2 * numpy.exp(-t / tau), lambda w: 2 * deviation**2 * tau / (1 + (w * tau) ** 2)))


def telegraph(amplitude: float, rate: float) -> Chain:
    """Forces -amplitude and amplitude [force], switched at a rate [1/time]: covariance amplitude^2 exp(-2 rate t)."""
    positive(amplitude=amplitude, rate=rate)
    return Chain([-amplitude, amplitude], [[0, rate], [rate, 0]], "telegraph")


def periodic(amplitude: float, period: float, phases: int = 16) -> Chain:
    """Forces amplitude sin(2 pi k/phases) [force] in phases k that follow one another at the rate phases/period [1/time]:
    the period has the relative deviation phases^(-1/2)."""
    positive(amplitude=amplitude, period=period)
    if phases < 2:
        raise ValueError(f"phases = {phases}: must be at least 2; take for example 16")
    k = numpy.arange(phases)
    rates = sparse.csr_matrix((numpy.full(phases, phases / period), (k, (k + 1) % phases)), (phases, phases))
    return Chain(amplitude * numpy.sin(2 * numpy.pi * k / phases), rates, "periodic")


def plane_lattice(deviation: float, decay: float, frequency: float, sine: float, delta: float, radius: float) -> Chain:
    """The first coordinate of a Gaussian process dz = -A z dt + noise in the plane, on a square lattice: covariance
    s^2 exp(-decay t) (cos(frequency t) + sine sin(frequency t)), with A = ((a, -c), (c, b)), a, b = decay -+ sine
    frequency, c = frequency (1 + sine^2)^(1/2).

    Rates are central differences where both directions keep them positive, of second order in delta; elsewhere jumps go
    along the drift alone, which adds diffusion: a note says how much.

    Parameters
    ----------
    deviation, decay, frequency, sine
        Standard deviation s [force], rates [1/time] and factor of the covariance.
    delta
        Step of the lattice [force].
    radius
        In deviations, within which states are kept.

    Raises
    ------
    ValueError
        If a parameter is not positive, the spectrum is negative somewhere, or the lattice has a state alone.
    """
    positive(deviation=deviation, decay=decay, frequency=frequency, delta=delta, radius=radius)
    a, b, c = decay - sine * frequency, decay + sine * frequency, frequency * math.hypot(1, sine)
    if min(a, b) < -1e-12 * decay or a <= 0:
        raise ValueError(f"sine = {sine:g}: must be in [-{decay / frequency:g}, {decay / frequency:g}) for a lattice")
    most = math.floor(radius * deviation / delta * (1 + 1e-9))
    i, j = (part.ravel() for part in numpy.mgrid[-most:most + 1, -most:most + 1])
    kept = (i**2 + j**2) * delta**2 <= (radius * deviation) ** 2 * (1 + 1e-9)
    i, j = i[kept], j[kept]
    number = numpy.full(2 * (2 * most + 3,), -1)  # of the state at a place, and -1 around the lattice
    number[i, j] = numpy.arange(len(i))  # negative places count from the end
    rates, added = sparse.csr_matrix(2 * (len(i),)), numpy.zeros(len(i))
    for drift, damping, right, up in ((c * j - a * i, a, 1, 0), (-c * i - b * j, max(b, 0), 0, 1)):  # in steps
        spread = damping * (deviation / delta) ** 2
        added += numpy.maximum(abs(drift) / 2 - spread, 0) / (2 * decay * (deviation / delta) ** 2)
        for way in (-1, 1):
            to = number[i + way * right, j + way * up]
            rate = numpy.where(abs(drift) / 2 > spread, numpy.maximum(way * drift, 0), spread + way * drift / 2)
            jumps = numpy.flatnonzero((to >= 0) & (rate > 0))
            rates += sparse.csr_matrix((rate[jumps], (jumps, to[jumps])), rates.shape)
    reached = csgraph.connected_components(rates, connection="strong")[1]
    inside = reached == reached[number[0, 0]]
    chain = Chain(delta * i[inside], rates[inside][:, inside], "lattice")
    more = chain.stationary @ added[inside]
    return dataclasses.replace(chain, notes=(
        f"one-sided differences add {100 * more:.2g} % to the diffusion and the deviation is {chain.deviation:.4g} in the "
        f"place of {deviation:.4g}; a delta below {delta:.3g} adds less",))
