"""Seconds from a slider to its picture: median and largest of 20 moves of mu_d at delta = 1/8, accuracy 1e-4.

usage: python3 tests/python/explorer_delays.py

Drawn by Agg, as windows and browsers have it. Each move waits until the one before was drawn.
"""

import pathlib
import statistics
import sys
import time

import matplotlib

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "python"))
matplotlib.use("Agg")
import matplotlib.pyplot as plt
from stickslip.explore import Explorer

MOVES = 20


def main():
    figure = plt.figure(figsize=(13, 8))
    figure.canvas.draw_idle = lambda: None  # once a picture, as windows do it
    explorer = Explorer(figure, {"accuracy": 1e-4}, {"delta": 0.125})
    seconds = []
    for move in range(MOVES + 1):
        start = time.monotonic()
        explorer.sliders["mu_d"].set_val(0.2 + 0.03 * move)
        while not explorer.poll():
            time.sleep(0.002)
        figure.canvas.draw()
        seconds.append(time.monotonic() - start)
    explorer.solver.close()
    seconds = seconds[1:]  # the first one makes fonts
    print(f"median {statistics.median(seconds):.3f} s, largest {max(seconds):.3f} s of {MOVES} moves")


main()
