"""Many cases by few processes of the program, each of which answers one case after the other."""

import concurrent.futures
import json
import math
import os
import pathlib
import queue
import shlex
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from types import TracebackType
from typing import Any, BinaryIO

from . import program as programs
from .calls import Path, found_in, prepared, shortfall
from .program import DONE, AccuracyWarning, BadInput, Cancelled, Finished, OutOfMemory, ProgramError, TimedOut, Unsolved, warn
from .reference import with_options
from .results import Results

ANSWER = b'{"status":'  # how the program begins a line that answers a case
KINDS = {programs.BAD_INPUT: BadInput, programs.SHORT: Unsolved, programs.NO_MEMORY: OutOfMemory}
FAILURES = (BadInput, OutOfMemory, ProgramError)
SHOWN = 3  # cases named in a warning
OWN = {"cancel", "failures", "keep", "program", "progress", "ranks", "timeout", "workers"}  # keywords of functions


class Worker:
    """A process of the program that answers cases; started at the first one, and anew after it has ended."""

    def __init__(self, program: Path | None = None) -> None:
        self._program = program
        self._process: subprocess.Popen | None = None
        self._errors: BinaryIO | None = None

    def run(self, *, cancel: threading.Event | None = None, timeout: float | None = None, **options: Any) -> Results:
        """As `stickslip.run` by this process; what is missed is in the results, and no warning."""
        with tempfile.TemporaryDirectory(prefix="stickslip-") as folder:
            options = prepared(options, pathlib.Path(folder))
            tree = self.answer(programs.words_of(options), timeout, cancel)
            return found_in(tree, options.get("output"))

    def answer(self, words: Sequence[str], timeout: float | None = None, cancel: threading.Event | None = None
               ) -> dict[str, Any]:
        """The summary of a case.

        Parameters
        ----------
        words
            Of its command line.
        timeout
            Seconds after which the process is killed.
        cancel
            Has the process killed when another thread sets it.

        Raises
        ------
        BadInput, OutOfMemory, Unsolved
            With the message of the program, which stays for the next case.
        TimedOut, Cancelled, ProgramError
            Where the process ended instead.
        """
        line = shlex.join(words)
        if "\n" in line:
            raise BadInput(f"{line}: options are on one line; leave line ends out")
        process, late, done = self._started(), threading.Event(), threading.Event()

        def watch() -> None:
            end = time.monotonic() + (math.inf if timeout is None else timeout)
            while not done.wait(programs.LOOK):
                if cancel is not None and cancel.is_set() or time.monotonic() > end:
                    late.set()
                    process.kill()
                    return

        watcher = threading.Thread(target=watch, daemon=True)
        if timeout is not None or cancel is not None:
            watcher.start()
        try:
            process.stdin.write(os.fsencode(line) + b"\n")
            process.stdin.flush()
            answered = next((printed for printed in process.stdout if printed.startswith(ANSWER)), b"")
        except BrokenPipeError:
            answered = b""
        finally:
            done.set()
            if watcher.is_alive():
                watcher.join()  # what it kills later would be the next case
        if late.is_set() or not answered.endswith(b"\n"):
            status = process.wait()
            said = self._said()
            self.end()
            if late.is_set():
                raise Cancelled("the case was cancelled") if cancel is not None and cancel.is_set() else TimedOut(
                    f"the case took longer than {timeout:g} s")
            raise ProgramError(programs.end_of(Finished(status, "", said)))
        tree = json.loads(answered)
        if "message" in tree:
            if tree["status"] not in KINDS:
                self.end()  # as it does by itself
            raise KINDS.get(tree["status"], ProgramError)(tree["message"])
        return tree

    def _started(self) -> subprocess.Popen:
        if self._process is None or self._process.poll() is not None:
            self.end()
            path = os.fspath(self._program or programs.find_program())
            self._errors = tempfile.TemporaryFile()
            try:
                self._process = subprocess.Popen([path, "-cases", "-", "-progress", "off"], stdin=subprocess.PIPE,
                                                 stdout=subprocess.PIPE, stderr=self._errors, start_new_session=True)
            except OSError as problem:
                raise ProgramError(f"{path} does not run: {problem.strerror}") from None
        return self._process

    def _said(self) -> str:
        self._errors.seek(0)
        return self._errors.read().decode(errors="replace")

    def end(self) -> None:
        """Ends the process, whatever it does."""
        if self._process is not None:
            self._process.kill()
            self._process.wait()
            self._process.stdout.close()
            try:
                self._process.stdin.close()
            except BrokenPipeError:
                pass  # of a case that it did not read
        if self._errors is not None:
            self._errors.close()
        self._process = self._errors = None


class Pool:
    """Workers that share cases among them, each a process that stays for all of them. To be used as a context."""

    def __init__(self, workers: int = 2, program: Path | None = None, timeout: float | None = None) -> None:
        if workers < 1:
            raise ValueError(f"workers = {workers}: must be at least 1")
        self._timeout = timeout
        self._workers = [Worker(program) for _ in range(workers)]
        self._idle: queue.SimpleQueue[Worker] = queue.SimpleQueue()
        for worker in self._workers:
            self._idle.put(worker)

    def __enter__(self) -> "Pool":
        return self

    def __exit__(self, kind: type[BaseException] | None, problem: BaseException | None, where: TracebackType | None) -> None:
        for worker in self._workers:
            worker.end()

    def results(self, cases: Iterable[Mapping[str, Any]], stop: bool = False,
                tell: Callable[[int, int], Any] = lambda done, all: None) -> list[Results | Exception]:
        """Results of cases or their failures, in their order; the first failure ends what follows if `stop`. `tell` is
        called with the number of those found and of all."""
        found: list[Results | Exception] = []
        threads = concurrent.futures.ThreadPoolExecutor(len(self._workers))
        try:
            futures = [threads.submit(self._one, case) for case in cases]
            for future in futures:
                found.append(future.result())
                tell(len(found), len(futures))
                if stop and isinstance(found[-1], Exception):
                    break
        except BaseException:
            threads.shutdown(wait=False, cancel_futures=True)
            self.__exit__(None, None, None)  # what runs would make us wait
            raise
        finally:
            threads.shutdown(cancel_futures=True)
        return found

    def _one(self, case: Mapping[str, Any]) -> Results | Exception:
        worker = self._idle.get()
        try:
            return worker.run(timeout=self._timeout, **case)
        except FAILURES as problem:
            return problem
        finally:
            self._idle.put(worker)


def _teller(progress: "bool | Callable[[int, int], Any]") -> Callable[[int, int], Any]:
    """What is called with the number of cases that are done and of all."""
    if callable(progress):
        return progress
    begin = time.monotonic()

    def write(done: int, count: int) -> None:
        seconds = time.monotonic() - begin
        left = f"about {seconds * (count - done) / done:.0f} s left" if done < count else f"{seconds:.0f} s\n"
        print(f"\r{done} of {count} cases, {left:<20}", end="", file=sys.stderr, flush=True)

    return write if progress else lambda done, count: None


@with_options
def map(cases: Iterable[Mapping[str, Any]], workers: int = 2, *, failures: str = "raise", timeout: float | None = None,
        program: Path | None = None, progress: "bool | Callable[[int, int], Any]" = False,
        **common: Any) -> list[Results | Exception]:
    """Run many cases with few processes, which saves the start of the program: some 40 ms of each run.

    Parameters
    ----------
    cases
        Options of each case by name, as keywords of `run`. Any options may differ.
    workers
        Number of processes that work at the same time.
    failures
        "raise": the first case that fails ends all. "return": its exception stands in the place of its results. In
        neither case does it harm the others; a process that was killed is started anew.
    timeout
        Seconds that a case may take.
    program
        Path of the program; by default that of `find_program`.
    progress
        True: a line on standard error counts the cases that are done. Or what to call with their number and that of all.
    **common
        Options of all cases; those of a case count more.

    Returns
    -------
    results
        In the order of the cases, the same to the last bit as those of `run`.

    Raises
    ------
    BadInput, OutOfMemory, Unsolved, TimedOut, ProgramError
        With the number of the case, and the text of the program.

    Warns
    -----
    AccuracyWarning
        If cases did not reach the accuracy.
    UserWarning
        Of what the program warns of, once for all cases of which it says the same.

    Examples
    --------
    >>> rows = stickslip.map([{"mu_d": 0.25}, {"mu_d": 0.5, "tau": 2}], quantities="sticking")
    >>> [r["P_stick"].value for r in rows]
    """
    if failures not in ("raise", "return"):
        raise ValueError(f"failures = {failures!r}: must be raise or return")
    cases = list(cases)
    if not all(isinstance(case, Mapping) for case in cases):  # one alone is a sequence of names
        raise ValueError('cases: must be a sequence of options by name, such as [{"mu_d": 0.25}, {"mu_d": 0.5}]')
    for n, case in enumerate([*cases, common]):
        if own := sorted(OWN & case.keys()):
            where = f"cases[{n}]" if n < len(cases) else "map"
            raise ValueError(f"{where}: {own[0]} is no option of a case; " + (
                "run() keeps files and takes ranks" if own[0] in ("keep", "ranks") else f"give map({own[0]}=...)"))
    with Pool(workers, program, timeout) as pool:
        found = pool.results([{**common, **case} for case in cases], failures == "raise", _teller(progress))
    if failures == "raise" and found and isinstance(found[-1], Exception):
        raise type(found[-1])(f"case {len(found) - 1}: {found[-1]}") from None
    warned: dict[str, list[int]] = {}
    for n, one in enumerate(found):
        for text in one.warnings if isinstance(one, Results) else ():
            warned.setdefault(text, []).append(n)
    for text, (first, *more) in warned.items():
        warn(f"case {first}{f' and {len(more)} more' * bool(more)}: {text}")
    short = [f"case {n}: {shortfall(one)}" for n, one in enumerate(found)
             if isinstance(one, Results) and one.summary["status"] != DONE]
    if short:
        warn(f"{len(short)} of {len(found)} cases fell short: " + "; ".join(short[:SHOWN])
             + ("; ..." if len(short) > SHOWN else ""), AccuracyWarning)
    return found
