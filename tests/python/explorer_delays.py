"""Seconds from a slider to its pictures, and processor seconds: 20 moves of mu_d at delta = 1/8, accuracy 1e-4.

usage: python3 tests/python/explorer_delays.py [docs/explorer.png]

Drawn by Agg, as windows and browsers have it: parts at once, the whole figure where that was asked for. Processor time
is that of Python and of the program (in Linux) until the first picture, and until the last one. With a file, the
explorer is then saved there as the manual shows it.
"""

import os
import pathlib
import statistics
import sys
import time

import matplotlib

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "python"))
matplotlib.use("Agg")
import matplotlib.pyplot as plt
from stickslip.cases import Worker
from stickslip.explore import FIGURE, Explorer

MOVES = 20


def spent(worker):
    """Seconds, own processor seconds, and those of the program."""
    process = worker._process
    ticks = pathlib.Path(f"/proc/{process.pid}/stat").read_text().rpartition(")")[2].split()[11:13] if process else ()
    return time.monotonic(), time.process_time(), sum(map(int, ticks)) / os.sysconf("SC_CLK_TCK")


def moved(explorer, worker, act):
    """What was spent from an act to the first picture, and to the last one."""
    begin, first = spent(worker), None
    act()
    while not explorer.status.get_text().endswith(" s"):
        news = explorer.poll()
        if explorer.figure.stale_whole:
            explorer.figure.stale_whole = False
            explorer.figure.canvas.draw()
        first = first or news and spent(worker)
        time.sleep(0.002)
    return [[now - before for now, before in zip(part, begin)] for part in (first, spent(worker))]


def main():
    figure = plt.figure(figsize=FIGURE)
    figure.stale_whole = True
    figure.canvas.draw_idle = lambda: setattr(figure, "stale_whole", True)
    figure.canvas.blit = lambda box: None  # which windows and browsers have
    worker = Worker()
    explorer = Explorer(figure, {"accuracy": 1e-4}, {"delta": 0.125}, compute=worker.run)
    moves = [moved(explorer, worker, lambda: explorer.sliders["mu_d"].set_val(0.2 + 0.03 * move))
             for move in range(MOVES + 1)]
    for name, part in zip(("first picture", "all pictures"), zip(*moves[1:])):  # the first move makes fonts
        seconds, python, program = zip(*part)
        print(f"{name}: median {statistics.median(seconds):.3f} s, largest {max(seconds):.3f} s of {MOVES} moves; processor "
              f"time {statistics.median(python):.3f} s in Python, {statistics.median(program):.2f} s in the program")
    for picture in sys.argv[1:]:
        explorer.radios["friction"].set_active(1)
        explorer.sliders["mu_d"].set_val(0.3)
        moved(explorer, worker, lambda: explorer.sliders["bias"].set_val(0.2))
        explorer.status.set_text("")  # how long it took here
        figure.savefig(picture, dpi=100)
    explorer.solver.close()
    worker.end()


main()
