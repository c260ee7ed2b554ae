"""Files of arrays: .npy, .mat of MATLAB 5 to 7, SAC in both forms, and what ObsPy reads, where it is installed."""

import dataclasses
import pathlib
import re
from collections.abc import Sequence
from typing import TYPE_CHECKING

from ..needed import needed
from .reading import NUMBER, Column, counted, numbers

if TYPE_CHECKING:
    import numpy
    Array = numpy.ndarray
numpy = needed("numpy")

SAC_LINES = 14, 22, 30  # where lines of numbers, of integers and of the whole header end; SAC manual, "SAC data file format"
SAC_BYTES = 70 * 4, 110 * 4, 158 * 4
SAC_VERSION, NONE = 76, -12345  # place of the version among the integers, which is 6 or 7; a value that is not known
ZEROS = 1e-3  # share of zero bytes, up to which a file is text with remains of a buffer
MINISEED = re.compile(rb"\d{6}[DRQM][ \0]|MS\x03")


def columns_of(path: pathlib.Path, data: bytes) -> tuple[str, list[Column]] | None:
    """Format and columns of a binary file; None for text."""
    if data.startswith(b"\x93NUMPY"):
        return "NumPy array", of_array("column", numpy.load(path, allow_pickle=False))
    if data.startswith(b"MATLAB 5.0"):
        return "MATLAB file", _of_matlab(needed("scipy.io").loadmat(path))
    if data.startswith((b"\x89HDF", b"MATLAB 7.3")):
        raise ValueError("is HDF5, as MATLAB 7.3 writes it; write it in MATLAB by save(..., '-v7')")
    if len(data) > SAC_BYTES[-1]:
        for order in "<>":
            integers = numpy.frombuffer(data, f"{order}i4", 40, SAC_BYTES[0])
            if integers[SAC_VERSION - 70] in (6, 7) and 0 < integers[9] <= (len(data) - SAC_BYTES[2]) // 4:
                samples = numpy.frombuffer(data, f"{order}f4", offset=SAC_BYTES[2])[:integers[9]]
                return "SAC", [_of_sac(numpy.frombuffer(data, f"{order}f4", 70), integers, samples)]
    if MINISEED.match(data):
        return "MiniSEED", [Column(trace.id, numpy.asarray(trace.data, float), "", float(trace.stats.delta))
                            for trace in needed("obspy").read(str(path))]
    if data.startswith((b"PK\3\4", b"\x1f\x8b")):
        raise ValueError("is packed, or a spreadsheet: unpack it, or save it as CSV")
    if data.count(b"\0") > len(data) * ZEROS and not data.startswith((b"\xff\xfe", b"\xfe\xff")):
        raise ValueError("is binary, in no known format; take text, or make a stickslip.Record(time, value, unit) of what "
                         "another reader gives, such as ObsPy")
    return None


def is_sac(lines: Sequence[str]) -> bool:
    """Whether lines are those of a SAC file in alphanumeric form: five numbers each, then five integers each."""
    floats, integers = (re.compile(rf"\s*{number}(?:\s+{number}){{4}}\s*") for number in (NUMBER, r"[-+]?\d+"))
    begins = (0, floats), (SAC_LINES[0], integers)
    return len(lines) > SAC_LINES[2] and all(
        form.fullmatch(line) for (begin, form), end in zip(begins, SAC_LINES) for line in lines[begin:end])


def of_sac(lines: Sequence[str]) -> Column:
    """The samples of a SAC file in alphanumeric form."""
    floats, words, header = SAC_LINES
    integers = numbers(lines[floats:words], "5I10").astype(int)
    return _of_sac(numbers(lines[:floats], "5G15.7"), integers, numbers(lines[header:], "5G15.7"))


def _of_sac(floats: "Array", integers: "Array", samples: "Array") -> Column:
    step, start, count, kind, even = floats[0], floats[5], integers[9], integers[16], integers[35]
    if not even or step <= 0:
        raise ValueError(f"LEVEN = {even}, DELTA = {step:g}: is not evenly sampled; interpolate it in SAC")
    name = {6: "displacement", 7: "velocity", 8: "acceleration"}.get(int(kind), "")
    return Column(name or "value", counted(samples.astype(float), int(count)), "", float(f"{step:.7g}"),
                  float(f"{start:.7g}") if start != NONE else 0, kind=name)


def of_array(name: str, array: "Array") -> list[Column]:
    """The columns of an array: along its shorter side."""
    array = numpy.squeeze(array)
    if array.ndim not in (1, 2) or array.dtype.kind not in "fiub":
        raise ValueError(f"{name}: shape {array.shape} of {array.dtype}; needs numbers, a vector or columns")
    if array.ndim == 1:
        return [Column(name, array.astype(float))]
    rows = array.T if array.shape[0] >= array.shape[1] else array
    return [Column(f"{name} {n}", row.astype(float)) for n, row in enumerate(rows)]


def _of_matlab(variables: dict) -> list[Column]:
    columns, step = [], None
    for name, array in variables.items():
        if not hasattr(array, "dtype") or array.dtype.kind not in "fiu":
            continue
        if array.size > 1:
            columns += of_array(name, array)
        elif name.lower() in ("dt", "delta", "step"):
            step = float(array.item())
        elif name.lower() in ("fs", "rate", "samplingrate", "sampling_rate"):
            step = 1 / float(array.item())
    return [dataclasses.replace(column, step=step) for column in columns]
