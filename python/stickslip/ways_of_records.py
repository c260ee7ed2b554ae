"""What else fits a record where one fit refuses: each way is tried before it is named."""

import functools
import importlib
import warnings
from collections.abc import Callable
from typing import Any

from .needed import needed
from .record_statistics import unsteady
from .records import Record

numpy = needed("numpy")

# Modules and functions, options, and what they are on the command line `python3 -m stickslip levels FILE`.
WAYS = (("chains_of_records", "record", {}, ""), ("chains_of_records", "record", {"match_time": False}, "--no-match-time"),
        ("chains_of_records", "record", {"jumps": "any"}, "--jumps any"),
        ("gaussian_noise_of_records", "narrow_band_of", {}, "--narrow-band"),
        ("gaussian_noise_of_records", "gaussian_of", {}, "--gaussian"))
STRONGEST = (0.05, 0.95)  # shares of the integral of the squared value, between which a shaking is strong


class Unfit(ValueError):
    """A kind of noise cannot stand for a record; the message says why."""


def advised(fit: Callable[..., Any]) -> Callable[..., Any]:
    """A fit of a record whose refusal names what serves instead."""
    @functools.wraps(fit)
    def fitting(record: Record, *values: Any, **options: Any) -> Any:
        try:
            return fit(record, *values, **options)
        except Unfit as problem:
            raise ValueError(f"{problem}; {_advice(record)}") from None
    return fitting


def _advice(record: Record) -> str:
    """The ways that serve for a record; if none does, for the part of it in which it is strong."""
    if found := _serving(record, "record", ""):
        return f"{found} was tried and serves"
    tried = "record, narrow_band_of and gaussian_of of stickslip.noise were tried, and none fits the record"
    if unsteady(record):
        energy = numpy.cumsum(record.value**2)
        begin, end = (float(f"{record.time[numpy.searchsorted(energy, share * energy[-1])]:.3g}") for share in STRONGEST)
        part = f"record.between({begin:g}, {end:g})"
        if found := _serving(record.between(begin, end), part, f" --between {begin:g} {end:g}"):
            return f"{found} was tried and serves, for the part in which it is strong"
        tried += f", nor {part}, where it is strong"
    return f"{tried}; -quantities given_force moves a body by the record itself"


def _serving(record: Record, name: str, words: str) -> str:
    """The first way that fits."""
    for module, function, options, word in WAYS:
        fit = getattr(importlib.import_module(f".{module}", __package__), function).__wrapped__
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                fit(record, **options)
        except ValueError:
            continue
        call = ", ".join([name, *(f"{option}={value!r}".replace("'", '"') for option, value in options.items())])
        return f"noise.{function}({call}) (levels {f'{word}{words}'.strip()})".replace(" (levels )", " (levels)")
    return ""
