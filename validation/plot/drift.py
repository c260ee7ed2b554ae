"""Draws drift, diffusivity and sticking probability against the bias.

usage: python3 drift.py FILE.h5|FILE.csv PICTURE.png

Files come from `stickslip -quantities sticking,moments,spectrum -sweep_bias 0.1:2:20 -output FILE.h5`
(or -sweep_csv FILE.csv), with no other sweep.
"""

import sys

from results import COLOURS, STYLES, plt
from sweep import from_csv, from_hdf5

DRAWN = (("E_V", "drift $E[V]$"), ("diffusivity", "diffusivity $S_0/2$"),
         ("P_stick", "probability of sticking"))


def draw(sweep, picture):
    if list(sweep.axes) != ["bias"] or any(key not in sweep.scalars for key, _ in DRAWN):
        sys.exit("needs a sweep of the bias alone, with sticking, moments and spectrum")
    bias = sweep.axes["bias"]
    figure, axes = plt.subplots(figsize=(6.4, 3.8), layout="constrained")
    for n, (key, label) in enumerate(DRAWN):
        axes.plot(bias, sweep.scalars[key][0], color=COLOURS[n], linestyle=STYLES[n],
                  marker="os^"[n], markersize=3, label=label)
    axes.set(xlabel="bias $g$  [force]", ylim=(0, None), xlim=(0, None))
    axes.legend(loc="best")
    figure.savefig(picture, dpi=160)


def main():
    words = sys.argv[1:]
    if len(words) != 2 or words[0].startswith("-"):
        sys.exit(__doc__)
    draw(from_csv(words[0]) if words[0].endswith(".csv") else from_hdf5(words[0]), words[1])


if __name__ == "__main__":
    main()
