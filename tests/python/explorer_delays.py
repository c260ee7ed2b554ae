"""Seconds from a slider to its pictures, and processor seconds: 20 moves of mu_d at delta = 1/8, accuracy 1e-4.

usage: python3 tests/python/explorer_delays.py [docs/explorer.png]

Drawn by Agg, as windows and browsers have it: parts at once, the whole figure where that was asked for. Processor time
is that of Python until the first picture, and until the last one, and that of the program for all of them. With a file,
the explorer is then saved there as the manual shows it.
"""

import pathlib
import resource
import statistics
import sys
import time

import matplotlib

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "python"))
matplotlib.use("Agg")
import matplotlib.pyplot as plt
from stickslip.explore import FIGURE, Explorer

MOVES = 20


def spent():
    """Seconds, own processor seconds, and those of programs that have ended."""
    ended = resource.getrusage(resource.RUSAGE_CHILDREN)
    return time.monotonic(), time.process_time(), ended.ru_utime + ended.ru_stime


def moved(explorer, act):
    """What was spent from an act to the first picture, and to the last one."""
    begin, first = spent(), None
    act()
    while not explorer.status.get_text().endswith(" s"):
        news = explorer.poll()
        if explorer.figure.stale_whole:
            explorer.figure.stale_whole = False
            explorer.figure.canvas.draw()
        first = first or news and spent()
        time.sleep(0.002)
    return [[now - before for now, before in zip(part, begin)] for part in (first, spent())]


def main():
    figure = plt.figure(figsize=FIGURE)
    figure.stale_whole = True
    figure.canvas.draw_idle = lambda: setattr(figure, "stale_whole", True)
    figure.canvas.blit = lambda box: None  # which windows and browsers have
    explorer = Explorer(figure, {"accuracy": 1e-4}, {"delta": 0.125})
    moves = [moved(explorer, lambda: explorer.sliders["mu_d"].set_val(0.2 + 0.03 * move)) for move in range(MOVES + 1)]
    (first, last), slowest = ([[statistics.median(column) for column in zip(*part)] for part in zip(*moves[1:])],
                              max(move[0][0] for move in moves[1:]))  # the first one makes fonts
    print(f"first picture: median {first[0]:.3f} s, largest {slowest:.3f} s of {MOVES} moves, {first[1]:.3f} s of processor "
          f"time in Python\nall: {last[0]:.3f} s, {last[1]:.3f} s of processor time in Python, {last[2]:.3f} s of the program")
    for picture in sys.argv[1:]:
        explorer.radios["friction"].set_active(1)
        explorer.sliders["mu_d"].set_val(0.3)
        moved(explorer, lambda: explorer.sliders["bias"].set_val(0.2))
        explorer.status.set_text("")  # how long it took here
        figure.savefig(picture, dpi=100)
    explorer.solver.close()


main()
