"""What the explorer computes, part by part: of the newest parameters, and of no others any longer."""

import queue
import threading
import time
import warnings
from collections.abc import Callable, Mapping
from typing import Any

from .program import BadInput, Cancelled, OutOfMemory, ProgramError
from .results import Results

TIMES, FREQUENCIES = "0.02:20:40:log", "0.02:50:60:log"
PARTS = (("the stationary distribution", {"quantities": "sticking,moments,density"}),
         ("the spectrum", {"quantities": "spectrum", "omega": FREQUENCIES}),
         ("densities of durations", {"quantities": "phase_durations", "time": TIMES}))
# Accuracy of curves where a better one is asked for. Over the six decades that are shown curves were then within 1 % of
# their true values, a tenth of a pixel, and distribution functions within 1e-6; quantiles are shown with two digits.
OF_CURVES = 1e-3
SLOW = 1.5  # seconds of the first part, from which on the program is asked how long the others will take


def asked(options: Mapping[str, Any], part: int) -> dict[str, Any]:
    """Options of the program for a part of `PARTS`."""
    curves = {"accuracy": max(options["accuracy"], OF_CURVES)} if part > 0 and "accuracy" in options else {}
    return {**options, **PARTS[part][1], **curves}


class Solver(threading.Thread):
    """Computes the newest parameters asked for; what it was computing before is ended.

    Results come in the order of `PARTS`. Without the first part there are no others. After a slow first part each of the
    others is preceded by its plan, which has no results.
    """

    def __init__(self, compute: Callable[..., Results]) -> None:
        super().__init__(daemon=True)
        self._results: "queue.Queue[tuple[int, int, Results | Exception]]" = queue.Queue()  # of the request of a number
        self._compute = compute
        self._condition = threading.Condition()
        self._wanted: tuple[int, Mapping[str, Any]] | None = None
        self._cancel = threading.Event()
        self._closed = self._busy = False
        self._number = 0

    def ask(self, options: Mapping[str, Any]) -> None:
        """Compute these options next; returns at once."""
        with self._condition:
            self._number += 1
            self._wanted = self._number, dict(options)
            self._cancel.set()
            self._condition.notify()

    def next_result(self) -> "tuple[int, Results | Exception] | None":
        """The next part and its results, or what refused it; None while there is nothing new of the newest request."""
        while not self._results.empty():
            number, part, found = self._results.get()
            if number == self._number:
                return part, found
        return None

    @property
    def working(self) -> bool:
        """Whether there will be more results than those that next_result gives now."""
        with self._condition:
            return self.is_alive() and (self._wanted is not None or self._busy)

    def close(self) -> None:
        """End what is being computed, and the thread."""
        with self._condition:
            self._closed = True
            self._cancel.set()
            self._condition.notify()
        self.join()

    def run(self) -> None:
        while True:
            with self._condition:
                self._busy = False
                while not (self._wanted or self._closed):
                    self._condition.wait()
                if self._closed:
                    return
                (number, options), self._wanted, self._busy = self._wanted, None, True
                self._cancel = cancel = threading.Event()
            begun, slow = time.monotonic(), False
            for part in range(len(PARTS)):
                slow = slow or part > 0 and time.monotonic() - begun > SLOW
                try:
                    with warnings.catch_warnings():
                        warnings.simplefilter("ignore")  # errors are drawn
                        if slow and part > 0:
                            self._results.put((number, part, self._compute(cancel=cancel, plan=True, **asked(options, part))))
                        found: Results | Exception = self._compute(cancel=cancel, **asked(options, part))
                except Cancelled:
                    break
                except (BadInput, OutOfMemory, ProgramError, ImportError) as problem:
                    found = problem
                self._results.put((number, part, found))
                if part == 0 and isinstance(found, Exception):
                    break
