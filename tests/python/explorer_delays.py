"""Seconds from a slider to its picture: median and largest of 20 moves of mu_d at delta = 1/8, accuracy 1e-4.

usage: python3 tests/python/explorer_delays.py [docs/explorer.png]

Drawn by Agg, as windows and browsers have it. Each move waits until the one before was drawn. With a file, the explorer
is then saved there as the manual shows it.
"""

import pathlib
import statistics
import sys
import time

import matplotlib

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "python"))
matplotlib.use("Agg")
import matplotlib.pyplot as plt
from stickslip.explore import FIGURE, Explorer

MOVES = 20


def drawn(explorer, done):
    """Seconds and own processor seconds until it is done, and a picture is drawn."""
    start, used = time.monotonic(), time.process_time()
    while not (explorer.poll() and done()):
        time.sleep(0.002)
    explorer.figure.canvas.draw()
    return time.monotonic() - start, time.process_time() - used


def main():
    figure = plt.figure(figsize=FIGURE)
    figure.canvas.draw_idle = lambda: None  # once a picture, as windows do it
    explorer = Explorer(figure, {"accuracy": 1e-4}, {"delta": 0.125})
    delays = []
    for move in range(MOVES + 1):
        explorer.sliders["mu_d"].set_val(0.2 + 0.03 * move)
        delays.append(drawn(explorer, lambda: True))
    seconds, used = zip(*delays[1:])  # the first one makes fonts
    print(f"median {statistics.median(seconds):.3f} s, largest {max(seconds):.3f} s of {MOVES} moves, "
          f"{statistics.median(used):.3f} s of processor time in Python")
    for picture in sys.argv[1:]:
        explorer.radios["friction"].set_active(1)
        explorer.sliders["mu_d"].set_val(0.3)
        explorer.sliders["bias"].set_val(0.2)
        drawn(explorer, lambda: explorer.status.get_text().endswith(" s"))
        explorer.status.set_text("")  # how long it took here
        figure.savefig(picture, dpi=100)
    explorer.solver.close()


main()
