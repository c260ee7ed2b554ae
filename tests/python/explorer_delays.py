"""Processor seconds of each picture of the explorer after a slider was moved, and how long one waits for it.

usage: python3 tests/python/explorer_delays.py [docs/explorer.png]

20 moves of mu_d at delta = 1/8, accuracy 1e-4, drawn by Agg, as windows and browsers have it: parts at once, the whole
figure where that was asked for. Processor time is that of Python and of the program (in Linux). With a file, the explorer
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
from stickslip.cases import Worker
from stickslip.explore import FIGURE, Explorer
from stickslip.live_pictures import PICTURES

MOVES = 20


class Timed(Worker):
    """A worker that notes what each of its runs took."""

    runs = []  # processor seconds in this thread, and of the program

    def run(self, **options):
        begin = self.spent()
        try:
            return super().run(**options)
        finally:
            self.runs.append([now - before for now, before in zip(self.spent(), begin)])

    def spent(self):
        process = self._process
        return time.thread_time(), int(pathlib.Path(f"/proc/{process.pid}/schedstat").read_text().split()[0]) / 1e9 if process else 0


def moved(explorer, worker, act):
    """Of each picture: seconds until it is there, processor seconds in Python and of the program."""
    worker.runs.clear()
    start, before, shown = time.monotonic(), time.thread_time(), []
    act()
    while not explorer.status.get_text().endswith(" s"):
        news = explorer.poll()
        if explorer.figure.stale_whole:
            explorer.figure.stale_whole = False
            explorer.figure.canvas.draw()
        if news:
            shown.append((time.monotonic() - start, time.thread_time() - before))
            before = time.thread_time()
        time.sleep(0.002)
    return [(seconds, drawing + asking, program) for (seconds, drawing), (asking, program) in zip(shown, worker.runs)]


def main():
    figure = plt.figure(figsize=FIGURE)
    figure.stale_whole = True
    figure.canvas.draw_idle = lambda: setattr(figure, "stale_whole", True)
    figure.canvas.blit = lambda box: None  # which windows and browsers have
    worker = Timed()
    explorer = Explorer(figure, {"accuracy": 1e-4}, {"delta": 0.125}, compute=worker.run)
    moves = [moved(explorer, worker, lambda: explorer.sliders["mu_d"].set_val(0.2 + 0.03 * move))
             for move in range(MOVES + 1)]
    for name, part in zip(PICTURES, zip(*moves[1:])):  # the first move makes fonts
        waited, python, program = zip(*part)
        spent = [a + b for a, b in zip(python, program)]
        print(f"{name}: processor time {statistics.median(spent):.3f} s, largest {max(spent):.3f} s of {MOVES} moves, of which "
              f"{statistics.median(python):.3f} s in Python; there after {statistics.median(waited):.3f} s")
    for picture in sys.argv[1:]:
        explorer.radios["friction"].set_active(1)
        explorer.sliders["mu_d"].set_val(0.3)
        moved(explorer, worker, lambda: explorer.sliders["bias"].set_val(0.2))
        explorer.status.set_text("")  # how long it took here
        figure.savefig(picture, dpi=100)
    explorer.solver.close()
    worker.end()


main()
