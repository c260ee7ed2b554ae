"""Dry friction under random forcing: runs the program stickslip, and holds and draws its results.

>>> import stickslip
>>> r = stickslip.run(mu_d=0.25, quantities="sticking")
>>> r["P_stick"].value, r["P_stick"].error
"""

import importlib
import sys
from typing import Any

try:
    from .calls import load, run, sweep
    from .cases import map
    from .program import AccuracyWarning, BadInput, Cancelled, OutOfMemory, ProgramError, TimedOut, Unsolved, find_program
    from .records import Record, read_record
    from .results import Density, Result, Results
    from .sliding_block import newmark
    from .sweeps import Sweep
    from .version import __version__
except ImportError as problem:
    if sys.argv[:1] == ["-m"]:  # python3 -m stickslip, which ends with the sentence alone
        sys.exit(str(problem))
    raise

__all__ = ["AccuracyWarning", "BadInput", "Cancelled", "Density", "OutOfMemory", "ProgramError", "Record", "Result",
           "Results", "Sweep", "TimedOut", "Unsolved", "__version__", "find_program", "fit", "load", "map", "newmark", "noise",
           "plots", "read_record", "run", "sweep"]


def __getattr__(name: str) -> Any:
    if name in ("noise", "plots"):  # which need SciPy and Matplotlib; other parts do without
        return importlib.import_module(f".{name}", __name__)
    if name == "fit":
        return importlib.import_module(".fitting", __name__).fit
    raise AttributeError(f"module {__name__} has no attribute {name}")


def __dir__() -> list[str]:
    return __all__
