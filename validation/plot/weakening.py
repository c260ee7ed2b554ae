"""Draws P_stick and E[V^2] against the speed within which friction falls, between their limits.

usage: python3 weakening.py FILE.h5 LIMITS PICTURE.png

The file comes from `stickslip -friction stribeck -sweep_stribeck_velocity 1e-4:1e3:41:log -output FILE.h5`.
LIMITS are a,b,c,d: P_stick for v_s -> 0 and infinity, and E[V^2].
"""

import sys

from results import COLOURS, STYLES, plt
from sweep import from_hdf5

DRAWN = (("P_stick", "probability of sticking"), ("E_V2", "$E[V^2]$"))


def draw(sweep, limits, picture):
    velocity = sweep.axes["stribeck_velocity"]
    figure, axes = plt.subplots(figsize=(6.4, 3.8), layout="constrained")
    for n, (key, label) in enumerate(DRAWN):
        axes.plot(velocity, sweep.scalars[key][0], color=COLOURS[n], linestyle=STYLES[n],
                  marker="os"[n], markersize=3, label=label)
        for limit, place in zip(limits[2 * n:2 * n + 2], ((0, 0.2), (0.8, 1))):
            axes.axhline(limit, *place, color=COLOURS[n], linewidth=0.8)
    axes.set(xlabel="$v_s$  [velocity]", xscale="log", ylim=(0, None))
    axes.legend(loc="best")
    figure.savefig(picture, dpi=160)


def main():
    words = sys.argv[1:]
    if len(words) != 3 or words[0].startswith("-"):
        sys.exit(__doc__)
    draw(from_hdf5(words[0]), [float(x) for x in words[1].split(",")], words[2])


if __name__ == "__main__":
    main()
