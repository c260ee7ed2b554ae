"""Runs the program, and reads its files."""

import csv
import json
import os
import pathlib
import sys
import tempfile
import threading
from collections.abc import Callable, Iterator, Mapping, Set, Sized
from typing import Any

from . import results, sweeps
from .needed import needed
from .program import (DONE, NO_MEMORY, SHORT, AccuracyWarning, BadInput, OutOfMemory, ProgramError, Unsolved, execute,
                      find_program, warn, words_of)
from .records import Record, warn_of_gravity
from .reference import declared, with_options
from .results import Results
from .sweeps import Sweep

# A sequence for another option is swept, unless the program declares it as a list of numbers.
LISTS = ("quantities", "lambda", "omega", "time", "distance", "inverse_distance", "velocity", "observable", "start")
RECORDS = "record"  # folder of forces, apart from other files, whose names they may have
FIELDS = ("density", "trajectory", "relaxation")  # what only HDF5 holds
numpy = needed("numpy")
Path = str | os.PathLike[str]
FROM_ARRAYS = {
    "noise": "noise: must be a word or a chain, of which stickslip.noise.record(stickslip.Record(time, force)) makes one",
    "force_file": "force_file: must be a file or a record; stickslip.Record(time, force) makes one of arrays"}


@with_options
def run(*, ranks: int = 0, timeout: float | None = None, keep: Path | None = None, program: Path | None = None,
        cancel: threading.Event | None = None, progress: bool | str | Callable[[str], Any] = False,
        **options: Any) -> Results:
    """Run the program once.

    Parameters
    ----------
    ranks
        With a number, the program runs under mpiexec on so many ranks.
    timeout
        Seconds after which the program is ended.
    keep
        Where to leave the HDF5 file; without it no file stays.
    program
        Path of the program; by default that of `find_program`.
    cancel
        Ends the run when another thread sets it.
    progress
        True: what the program says while it works, such as the refinement level and the seconds left, goes on to standard
        error. Or what to call with each of these lines.
    **options
        Parameters of the model and options of the program by name: numbers, text, sequences of them, or True for
        an option without a value. Write `lambda_` for lambda. The program checks them. `noise` may be a chain of
        `stickslip.noise`, and `force_file` a `Record`. help() lists all of them at the end.

    Returns
    -------
    results
        A `Sweep` if an option `sweep_...` is among the options.

    Raises
    ------
    BadInput, OutOfMemory, Unsolved, TimedOut, Cancelled, ProgramError
        With the text of the program.

    Warns
    -----
    AccuracyWarning
        If the accuracy was not reached; the results are there, with their errors.
    UserWarning
        Of what the program warns of, which `results.warnings` has too.

    Examples
    --------
    >>> r = stickslip.run(mu_d=0.25, quantities="sticking,spectrum", omega=[0.1, 1, 10])
    >>> r["P_stick"].value, r["P_stick"].error
    >>> r["S_v"].abscissa, r["S_v"].value
    """
    return _run(ranks, timeout, keep, program, options, progress, cancel)


def _run(ranks: int, timeout: float | None, keep: Path | None, program: Path | None, options: Mapping[str, Any],
         progress: bool | str | Callable[[str], Any], cancel: threading.Event | None = None) -> Results:
    if ranks and (isinstance(ranks, bool) or int(ranks) != float(ranks) or int(ranks) < 1):
        raise ValueError(f"ranks = {ranks}: must be a whole number of at least 1")
    if timeout is not None and not timeout > 0:
        raise ValueError(f"timeout = {timeout}: must be above 0 seconds")
    with tempfile.TemporaryDirectory(prefix="stickslip-") as folder:
        options = prepared(options, pathlib.Path(folder), keep)
        tell = _teller(progress)
        options |= {"progress": "on"} if tell else {}
        summary = pathlib.Path(options.pop("summary", None) or pathlib.Path(folder) / "summary.json")
        launcher = ["mpiexec", "-n", str(ranks)] if ranks else []
        before = _stamp(summary)
        finished = execute([*launcher, os.fspath(program or find_program()), *words_of(options), "-summary",
                            str(summary)], timeout, cancel, tell)
        if _stamp(summary) == before:
            kind = {NO_MEMORY: OutOfMemory, SHORT: Unsolved}.get(finished.status, ProgramError)
            prefix = "the program wrote no results: " if kind is ProgramError else ""
            raise kind(prefix + finished.message())
        found = found_in(json.loads(summary.read_text()), options.get("output"))
    for text in found.warnings:
        warn(text.replace(os.path.join(folder, RECORDS, ""), ""))  # which the user has not seen
    if finished.status != DONE:
        warn(shortfall(found) or finished.message(), AccuracyWarning)
    return found


def _teller(progress: bool | str | Callable[[str], Any]) -> Callable[[str], Any] | None:
    """What is called with each line of progress; a word is one of the option -progress. None where none is shown."""
    def write(line: str) -> None:
        print(line, file=sys.stderr, flush=True)
    if callable(progress):
        return progress
    wanted = sys.stderr.isatty() if progress == "auto" else progress not in (False, "off")
    return write if wanted else None


def prepared(options: Mapping[str, Any], folder: pathlib.Path, keep: Path | None = None) -> dict[str, Any]:
    """Options as the program takes them; files that they need are written to a folder, and fields go there."""
    options = {name.rstrip("_"): value for name, value in options.items()}
    _refuse_arrays(options)
    output = keep or options.pop("output", None)
    asked = str(options.get("quantities", ""))
    if output is None and ("options_file" in options or any(word in asked for word in FIELDS)):
        output = folder / "results.h5"
    if output is not None:
        options["output"] = os.fspath(output)
    if hasattr(options.get("noise"), "save"):
        options |= _files_of(options, folder)
    if hasattr(options.get("force_file"), "save"):
        options["force_file"] = _force_of(options, folder)
    return options


def _refuse_arrays(options: Mapping[str, Any]) -> None:
    """Refuses sequences where the program would not say what to do with them."""
    for name, text in FROM_ARRAYS.items():
        value = options.get(name)
        if not (value is None or isinstance(value, (str, os.PathLike)) or hasattr(value, "save")):
            raise BadInput(text)
    for name, value in options.items():
        if is_swept(name, value) and len(value) > 1 and f"sweep_{name}" in _known():
            raise BadInput(f"{name}: has {len(value)} values where a run takes one; stickslip.sweep runs each")


def _known() -> Mapping[str, Mapping[str, Any]]:
    """Options of the program; none where there is none to ask, which a run reports."""
    try:
        return declared()
    except ProgramError:
        return {}


def is_swept(name: str, value: Any) -> bool:
    """Whether a value is a sequence, and that of an option that takes one value in a run."""
    return (isinstance(value, Sized) and not isinstance(value, (str, bytes, Mapping, Record)) and numpy.ndim(value) > 0
            and not (name.startswith("sweep_") or name in LISTS or _known().get(name, {}).get("form") == "numbers"))


def found_in(tree: Mapping[str, Any], output: Path | None) -> Results:
    """Results of a summary, with the fields of the HDF5 file if there is one."""
    found = _from_tree(tree)
    if output is not None and "results" in found.summary and any(
            word in found.options.get("quantities", "") for word in FIELDS):
        with needed("h5py").File(output) as file:
            for name, value in results.fields(file).items():
                setattr(found, name, value)
    return found


@with_options
def sweep(*, ranks: int = 0, timeout: float | None = None, keep: Path | None = None, program: Path | None = None,
          progress: bool | str | Callable[[str], Any] = False, **options: Any) -> Sweep:
    """Run the program for every combination of values of some options.

    Parameters
    ----------
    ranks, timeout, keep, program, progress
        As for `run`; on several ranks the points are distributed, and progress is the number of those done.
    **options
        As for `run`. An option whose value is a sequence is swept, but for those that are lists in any run
        (`LISTS`). Text such as "0.1:1:10" is swept under the name `sweep_mu_d`.

    Returns
    -------
    sweep
        Its dimensions are in the order of the options here.

    Raises
    ------
    BadInput, OutOfMemory, TimedOut, ProgramError
        With the text of the program; not for single points that fail.

    Warns
    -----
    AccuracyWarning
        If points failed or did not reach the accuracy.
    UserWarning
        Of what the program warns of; `point_warnings` has it by point.

    Examples
    --------
    >>> s = stickslip.sweep(mu_d=[0.25, 0.5], tau=[0.5, 1, 2], quantities="sticking")
    >>> s["P_stick"].value.shape, s["P_stick"].dims
    ((2, 3), ('mu_d', 'tau'))
    """
    options = {name.rstrip("_"): list(value) if isinstance(value, (Set, Iterator)) else value
               for name, value in options.items()}
    named = {f"sweep_{name}" if is_swept(name, value) else name: value for name, value in options.items()}
    for name in options:
        if name not in named and name in _known() and f"sweep_{name}" not in _known():
            raise BadInput(f"{name}: cannot be swept; stickslip.map([{{\"{name}\": value}} for value in ...]) runs cases that "
                           "differ in anything")
    found = _run(ranks, timeout, keep, program, named, progress)
    if not isinstance(found, Sweep):
        raise ValueError("no option is swept: give one of them a sequence of values, as in mu_d=[0.25, 0.5]")
    order = [name.removeprefix("sweep_") for name in named]
    return found.transposed(sorted(found.dims, key=lambda name: order.index(name) if name in order else len(order)))


def load(path: Path) -> Results:
    """Read a file of the program.

    Parameters
    ----------
    path
        A summary (JSON), results or a sweep (HDF5), the table of a sweep or a path (CSV).

    Returns
    -------
    results
        A `Sweep` where the file holds one.

    Raises
    ------
    FileNotFoundError, ValueError
        If there is no such file, or none of this program.
    """
    path = pathlib.Path(path)
    if path.suffix == ".json":
        return results.reading(path, "JSON", "-summary", lambda: _from_tree(json.loads(path.read_text()), path.stem))
    if path.suffix == ".csv":
        return results.reading(path, "CSV", "-sweep_csv", lambda: _from_csv(path))
    h5py = needed("h5py")

    def from_hdf5() -> Results:
        path.stat()  # h5py's error does not say that there is none
        with h5py.File(path) as file:
            return (sweeps if "sweep" in file else results).from_hdf5(file, path.stem)

    return results.reading(path, "HDF5", "-output", from_hdf5)


def _files_of(options: Mapping[str, Any], folder: pathlib.Path) -> dict[str, Any]:
    """Options for a noise of `stickslip.noise`; the files of a chain go to a folder."""
    if hasattr(options["noise"], "terms"):
        own = options["noise"].options
        for name in options:
            if name != "noise" and name.removeprefix("sweep_") in {"covariance_file", *own}:
                raise BadInput(f"{name} = {options[name]}: the noise, {options['noise'].name}, has its own; leave it out"
                               + f", and add it to the noise, whose mean {options['noise'].mean:g} acts as a bias" * (
                                   "bias" in name))
        return own
    if not hasattr(options["noise"], "rates"):
        raise BadInput("noise: is a record; stickslip.noise.record() or noise.narrow_band_of() makes a noise of it, and "
                       "force_file takes it as it is")
    files = {name: folder / f"{name}.csv" for name in ("noise_states", "noise_rates")}
    for name in files:
        if name in options:
            raise ValueError(f"{name} = {options[name]}: the chain {options['noise'].name} has its own; leave one out")
    options["noise"].save(*files.values())
    return {"noise": "chain", **files}


def _force_of(options: Mapping[str, Any], folder: pathlib.Path) -> pathlib.Path:
    """Writes a `Record` for -force_file, under the name of its source, which pictures show; refuses gaps as the program
    does, which knows neither `resampled` nor `between`."""
    record, scale = options["force_file"], options.get("force_scale", 1)
    count = len(record.gaps)
    if record.even and 0 < count <= len(record.time) / 10:
        begin, end = record.longest_gap
        raise BadInput(f"force_file: samples are missing in {count} gaps, the longest of {end - begin:g} s from {begin:g} s "
                       f"on; record.resampled({record.step:g}, across={end - begin:g}) joins them by straight lines, "
                       "record.between() takes a part without them")
    if isinstance(scale, int | float):
        warn_of_gravity(record, scale, "force_scale")
    place = folder / RECORDS
    place.mkdir()
    path = place / f"{pathlib.PurePath(record.source.partition(':')[0]).stem[:80] or 'force'}.csv"
    record.save(path)
    return path


def _stamp(path: pathlib.Path) -> tuple[int, int] | None:
    """Changes when the file is written anew."""
    return (path.stat().st_mtime_ns, path.stat().st_ino) if path.exists() else None


def _from_tree(tree: Mapping[str, Any], name: str = "") -> Results:
    if "provenance" not in tree:
        raise ValueError("it has no provenance")
    return (sweeps if "sweep" in tree else results).from_summary(tree, name)


def _from_csv(path: pathlib.Path) -> Results:
    with open(path, newline="") as file:
        head = next(csv.reader(file), [])
    if head[-1:] == ["status"]:
        return sweeps.from_csv(path)
    if head not in (["time", "x", "y", "v"], ["time", "force", "velocity", "displacement"]):
        raise ValueError("neither a sweep nor a path")
    columns = needed("numpy").loadtxt(path, delimiter=",", skiprows=1, ndmin=2).T
    if head[1] == "force":
        parts = {f"path_{name}": {"value": values, "time": columns[0]} for name, values in zip(head[1:], columns[1:])}
        return Results({key: results.result_of(key, part) for key, part in parts.items()}, name=path.stem)
    return Results({}, trajectory=dict(zip(head, columns)), name=path.stem)


def shortfall(found: Results) -> str:
    """What fell short; empty where nothing says so."""
    if isinstance(found, Sweep):
        messages = {**found.failures, **found.shortfalls}
        return f"{len(messages)} of {found.status.size} points fell short: " + "; ".join(
            ", ".join(f"{name} = {found.coords[name][n]:g}" for name, n in zip(found.dims, index)) + f": {text}"
            for index, text in list(messages.items())[:3]) + ("; ..." if len(messages) > 3 else "")
    return found.accuracy.get("shortfall", "")
