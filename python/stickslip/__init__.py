"""Dry friction under random forcing: runs the program stickslip, and holds and draws its results.

>>> import stickslip
>>> r = stickslip.run(mu_d=0.25, quantities="sticking")
>>> r["P_stick"].value, r["P_stick"].error
"""

from .calls import load, run, sweep
from .program import AccuracyWarning, BadInput, Cancelled, OutOfMemory, ProgramError, TimedOut, find_program
from .results import Density, Result, Results
from .sweeps import Sweep

__all__ = ["AccuracyWarning", "BadInput", "Cancelled", "Density", "OutOfMemory", "ProgramError", "Result", "Results",
           "Sweep", "TimedOut", "find_program", "load", "run", "sweep"]
