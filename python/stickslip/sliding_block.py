"""Newmark's sliding block: the motion of a block on ground that shakes."""

import os
import re
from typing import Any

from . import units
from .calls import run
from .program import BadInput, warn
from .records import Record, read_record
from .reference import with_options
from .results import Results

HELD = 1e9  # yield acceleration of the direction in which a block on a slope never slides


@with_options
def newmark(record: Record | str | os.PathLike[str], yield_acceleration: float | str, one_way: bool = False,
            **options: Any) -> Results:
    """The sliding block of Newmark (1965) under a recorded acceleration of the ground.

    The block moves with the ground until that accelerates it by more than the yield acceleration; then it slides against
    friction that is as large. Displacements are those of the block beside the ground, positive in the direction in which the
    record counts accelerations as positive: `quantities="given_force"` without drag, under minus the record.

    Parameters
    ----------
    record
        Acceleration of the ground, with `vertical` if wanted, or the file of one, as `read_record` reads it.
    yield_acceleration
        Text with a unit, such as "0.1g", or a number in the unit of `record`: m/s^2 where a file has any.
    one_way
        Whether the block slides in the positive direction alone, as downhill on a slope. `record.scaled(-1)` has the other
        direction.
    **options
        As for `run`, such as start="0,0.5" for a velocity at the beginning, or mu_d for less friction while it slides.

    Returns
    -------
    results
        `final_displacement`, `largest_displacement`, `largest_speed`, `slip_count`, the slips (`slip_begin`, `slip_end`,
        `slip_displacement`, `slip_peak`) and the path (`path_velocity`, `path_displacement`), in m and s where the record is
        in m/s^2. `plot()` draws them.

    Raises
    ------
    BadInput
        If the yield acceleration has a unit and the record has none, or another one; else as `run`.

    Examples
    --------
    >>> r = stickslip.newmark("record.AT2", "0.1g", one_way=True)
    >>> r["final_displacement"]
    """
    record = record if isinstance(record, Record) else read_record(record)
    friction = _in_unit_of(record, yield_acceleration)
    held = {"mu_s_minus": HELD, "mu_d_minus": HELD} if one_way else {}
    return run(**{"quantities": "given_force", "force_file": record.scaled(-1), "drag": "none", "mu_s": friction,
                  "mu_d": friction, **held, **options})


def _in_unit_of(record: Record, acceleration: float | str) -> float:
    """An acceleration, with a unit perhaps, in the unit of a record."""
    parts = re.fullmatch(r"\s*([-+]?[\d.]+(?:[eE][-+]?\d+)?)\s*(.*?)\s*", str(acceleration))
    if parts is None:
        raise BadInput(f"yield_acceleration = {acceleration}: must be a number, perhaps with a unit; write for example 0.1g")
    factor, unit = units.in_si(parts[2])
    if unit not in ("", record.unit):
        of_record = f"is in {record.unit}" if record.unit else "has no unit"
        raise BadInput(f"yield_acceleration = {acceleration}: is in {parts[2]}, and the record {of_record}; give the unit of "
                       'the record, as in read_record(path, unit="g"), or the number alone')
    if not unit and any("became m/s^2: times 9.8" in note for note in record.notes):
        warn(f'yield_acceleration = {acceleration}: is taken in m/s^2, which the record became; write "{acceleration}g" if '
             "it is in g as the record was")
    return float(parts[1]) * factor


def table(results: Results) -> str:
    """What a block did, a line for each slip."""
    slips = results.slips
    lines = [repr(results[key]) for key in ("final_displacement", "largest_displacement", "largest_speed")]
    if not len(slips):
        return "\n".join([*lines, "no slips"])
    heads = [f"{name} [{results[f'slip_{name}'].unit}]" for name in slips.dtype.names]
    return "\n".join([*lines, "slip" + "".join(f"{head:>20}" for head in heads), *(
        f"{n:4}" + "".join(f"{value:20.6g}" for value in row) for n, row in enumerate(slips, 1))])
