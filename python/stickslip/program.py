"""Finds the program, runs it, and turns its exit statuses into exceptions."""

import dataclasses
import json
import math
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
import urllib.parse
import warnings
from collections.abc import Callable, Mapping, Sequence
from typing import Any, BinaryIO

DONE, BAD_INPUT, SHORT, NO_MEMORY = 0, 2, 3, 4  # exit statuses
NAME = "stickslip(-complex)?: "  # in front of what it reports
TAIL = 20  # lines of what the program printed, in messages
LOOK = 0.01  # seconds between looks at whether a run is still wanted
GRACE = 5  # seconds from the request to end until the program is killed
# Words that Open MPI prints when it refuses to start the ranks, what it refuses, and the variables that allow it.
REFUSALS = (
    ("attempt to run as root", "to run as root, as in a container",
     {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}),
    ("not enough slots available", "to start more ranks than there are cores",
     {"OMPI_MCA_rmaps_base_oversubscribe": "1", "PRTE_MCA_rmaps_default_mapping_policy": ":oversubscribe"}))  # 4 and 5
FORMULAS = ("observable", "drag_expression")  # options whose values may begin with a minus sign, and have powers
PACKAGE = pathlib.Path(__file__).resolve().parent


class BadInput(ValueError):
    """The program refused an option; the message is the program's."""


class OutOfMemory(MemoryError):
    """What was asked for would not fit in memory; the message is the program's."""


class ProgramError(RuntimeError):
    """The program was not found, failed or was killed; the message ends with what the program printed last."""


class Unsolved(ProgramError):
    """No number could be computed; the message is the program's."""


class TimedOut(ProgramError, TimeoutError):
    """The program took longer than `timeout` and was ended."""


class Cancelled(ProgramError):
    """The run was ended because its event `cancel` was set."""


class AccuracyWarning(UserWarning):
    """The accuracy asked for was not reached, or a comparison disagrees; the text is the program's."""


def warn(text: str, category: type[Warning] = UserWarning) -> None:
    """Warn at the line of the user's that called this package, however deep within it the warning arises."""
    level, frame = 1, sys._getframe()
    while frame.f_back and frame.f_globals.get("__name__", "").partition(".")[0] == __package__:
        level, frame = level + 1, frame.f_back
    warnings.warn(text, category, stacklevel=level)


@dataclasses.dataclass(frozen=True)
class Finished:
    """How the program ended.

    Attributes
    ----------
    status
        Exit status 0, 2, 3 or 4.
    out, err
        What the program printed on standard output and on standard error.
    """

    status: int
    out: str
    err: str

    def message(self) -> str:
        """What the program reports about its end, without its name in front and what MPI prints before it or in frames."""
        own = re.search(rf"(?<!\S){NAME}", self.err)  # even within a line, as the ranks print at the same time
        printed = (self.err[own.start():] if own else self.err).partition("-" * 60)[0].strip()
        return re.sub(rf"^{NAME}", "", printed, flags=re.MULTILINE) or last_lines(self.out, 1)


def find_program() -> pathlib.Path:
    """Find the program.

    Returns
    -------
    path
        The environment variable STICKSLIP, the build or install tree that the package belongs to, the build of the
        sources that pip installed the package from, or PATH, in this order.

    Raises
    ------
    ProgramError
        If no place has it.
    """
    given = os.environ.get("STICKSLIP")
    own = _places_of_the_package()
    for place in [given] if given else [*own, shutil.which("stickslip")]:
        if place and pathlib.Path(place).is_file() and os.access(place, os.X_OK):
            return pathlib.Path(place).resolve()
    if given:
        raise ProgramError(f"the environment variable STICKSLIP names {given}, which is no program")
    raise ProgramError(f"the program stickslip is not found: the environment variable STICKSLIP is not set, there is "
                       f"none beside the package ({', '.join(map(str, own))}), and none in PATH; ./bootstrap build in "
                       "the folder of the sources makes it")


def _places_of_the_package() -> list[pathlib.Path]:
    """Where the program is if it was built or installed with the package."""
    if not PACKAGE.parent.name.endswith("-packages"):  # PREFIX/lib/python3/dist-packages
        return [PACKAGE.parents[1] / "build" / "stickslip"]
    places = [PACKAGE.parents[3] / "bin" / "stickslip"]
    for record in PACKAGE.parent.glob("stickslip-*.dist-info/direct_url.json"):  # by pip: where from
        url = urllib.parse.urlparse(json.loads(record.read_text()).get("url", ""))
        if url.scheme == "file":
            places.append(pathlib.Path(urllib.parse.unquote(url.path)).parent / "build" / "stickslip")
    return places


def words_of(options: Mapping[str, Any]) -> list[str]:
    """Words of the command line.

    Parameters
    ----------
    options
        Values by the names of options. True makes an option without a value, None leaves the option out, and a
        sequence becomes a list with commas (functions of `observable` with semicolons). An underscore behind a
        name is dropped, so that `lambda_` can be written. Powers of formulas may be written v**2.

    Returns
    -------
    words

    Raises
    ------
    BadInput
        If a value looks like an option.
    """
    words: list[str] = []
    for name, value in options.items():
        name = name.rstrip("_")
        if value is None:
            continue
        words.append("-" + name)
        if value is not True:
            words.append(text_of(value, name))
            if name not in FORMULAS and re.match("-[A-Za-z]", words[-1]) and words[-1].lower() not in ("-inf", "-nan"):
                raise BadInput(f"-{name} = {words[-1]}: cannot begin with a minus sign and a letter, as options do; "
                               "a formula of the velocity goes into drag_expression, with drag=\"expression\"")
    return words


def text_of(value: Any, name: str = "") -> str:
    """A value as the program reads it; floating-point numbers keep all their bits."""
    value = value.tolist() if hasattr(value, "tolist") else value  # NumPy's arrays and numbers
    if name in FORMULAS and isinstance(value, str):
        return value.replace("**", "^")
    if isinstance(value, (list, tuple, range)):
        return ("; " if name == "observable" else ",").join(map(text_of, value))
    return "no" if value is False else repr(value) if isinstance(value, float) else str(value)


def last_lines(text: str, count: int = TAIL) -> str:
    """The last lines of a text that are not empty."""
    return "\n".join([line for line in text.splitlines() if line.strip()][-count:])


def execute(words: Sequence[str], timeout: float | None = None, cancel: threading.Event | None = None,
            tell: Callable[[str], Any] | None = None) -> Finished:
    """Run a command line of the program to its end.

    Parameters
    ----------
    words
        The command line.
    timeout
        Seconds after which the program is ended, and with it what mpiexec started.
    cancel
        Ends the program when it is set by another thread.
    tell
        Called with each line that the program prints on standard error, soon after.

    Returns
    -------
    finished

    Raises
    ------
    BadInput, TimedOut, Cancelled, ProgramError
        By exit status. Statuses 3 and 4 may have left results and are returned.
    """
    with tempfile.TemporaryFile() as errors:
        try:
            process = subprocess.Popen(words, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=errors,
                                       start_new_session=True)
        except OSError as problem:
            advice = "; apt-get install openmpi-bin" if words[0] == "mpiexec" else ""
            raise ProgramError(f"{words[0]} does not run: {problem.strerror}{advice}") from None
        try:
            out = _printed(process, timeout, cancel, _Told(errors, tell) if tell else None)
        except BaseException as problem:
            _end(process)
            if isinstance(problem, subprocess.TimeoutExpired):
                raise TimedOut(f"the program was ended after {timeout:g} s") from None
            raise
        errors.seek(0)
        finished = Finished(process.returncode, *(text.decode(errors="replace") for text in (out, errors.read())))
    if finished.status == BAD_INPUT:
        raise BadInput(finished.message())
    if finished.status not in (DONE, SHORT, NO_MEMORY):
        raise ProgramError(end_of(finished))
    return finished


class _Told:
    """Passes the lines of a file on that the program has written since the last call."""

    def __init__(self, file: BinaryIO, tell: Callable[[str], Any]) -> None:
        self._file, self._tell, self._at = file, tell, 0

    def __call__(self) -> None:
        new = os.pread(self._file.fileno(), 2**20, self._at)  # as reading would move the place where the program writes
        whole = new[:new.rfind(b"\n") + 1]
        self._at += len(whole)
        for line in whole.decode(errors="replace").splitlines():
            self._tell(line)


def _printed(process: subprocess.Popen, timeout: float | None, cancel: threading.Event | None, told: _Told | None) -> bytes:
    """What the program prints until its end, or until it is no longer wanted."""
    if cancel is None and told is None:
        return process.communicate(timeout=timeout)[0]
    end = time.monotonic() + (math.inf if timeout is None else timeout)
    while time.monotonic() < end:
        if cancel is not None and cancel.is_set():
            raise Cancelled("the run was cancelled")
        try:
            return process.communicate(timeout=LOOK)[0]
        except subprocess.TimeoutExpired:
            continue
        finally:
            if told is not None:
                told()
    raise subprocess.TimeoutExpired(process.args, timeout or 0)


def _end(process: subprocess.Popen) -> None:
    """Asks the program and its children to end, and kills what does not."""
    for number in (signal.SIGTERM, signal.SIGKILL):
        try:
            os.killpg(process.pid, number)
            process.communicate(timeout=GRACE)
        except (ProcessLookupError, subprocess.TimeoutExpired):
            continue


def end_of(finished: Finished) -> str:
    """Of a program that failed: the signal or the exit status, and the last lines."""
    for words, what, environment in REFUSALS:
        if words in finished.err:
            return (f"mpiexec refuses {what}; set {' and '.join(f'{n}={v}' for n, v in environment.items())} in the "
                    f"environment, in Python by os.environ.update({environment})")
    status = finished.status
    number = -status if status < 0 else status - 128  # shells and mpiexec add 128
    try:
        ending = f"was killed by {signal.Signals(number).name}"
    except ValueError:
        ending = f"failed with exit status {status}"
    printed = last_lines(finished.err) or last_lines(finished.out)
    return f"the program {ending}" + (f":\n{printed}" if printed else "")
