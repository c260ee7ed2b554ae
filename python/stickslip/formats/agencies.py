"""Formats with a header of facts above plain samples, each a table of its facts.

K-NET and KiK-net of NIED (Japan), and their CSV; the free-field text of CWA (Taiwan); ESM and the newer files of AFAD (DYNA
1.2); the older files of AFAD (Turkey), three components a file; CSMNC (China).
"""

import functools
import re
from collections.abc import Sequence
from typing import TYPE_CHECKING

from ..units import in_si, kind_of
from . import tables
from .reading import FLAGS, Column, Format, counted, data_of, kind_in, lasting, numbers, table

if TYPE_CHECKING:
    import numpy
    Array = numpy.ndarray

HEADER = 200  # lines that may belong to the header
NUMBER, WORD, REST = r"[ \t:]*([\d.]+)", r"[ \t:]*([^\s;,]+)", r"[ \t:]*(.*?)[ \t]*$"
PLACES = {f"{n + 1}": f"{way} {place}" for n, (place, way) in enumerate(
    (place, way) for place in ("borehole", "surface") for way in ("N-S", "E-W", "U-D"))}  # of KiK-net
OFFSET = "the mean, {:.4g} {}, was taken off, as samples of this format have an arbitrary offset"


def _less_mean(name: str, values: "Array", unit: str, step: float, doubt: str) -> Column:
    mean = values.mean()
    return Column(PLACES.get(name, name), values - mean, unit, None if doubt else step, kind="acceleration", doubt=doubt,
                  notes=(OFFSET.format(mean, unit),))


def _read(facts: Sequence[tuple[str, str]], lines: list[str]) -> list[Column]:
    found = [(fact, n, match[1]) for fact, pattern in facts for n, line in enumerate(lines[:HEADER])
             if (match := re.search(pattern, line, FLAGS))]
    said, data = {fact: value for fact, _, value in reversed(found)}, data_of(lines[max(n for _, n, _ in found) + 1:])
    kind = said.get("kind", "acceleration").lower()
    kind = "spectrum" if "spectr" in kind else kind_in(kind)
    step = float(said["step"]) if "step" in said else 1 / float(said["rate"])
    names = re.split(r"[;,\s]+", said["names"]) if "names" in said else [said.get("name") or kind]
    columns = dict(zip(names, table(data, len(names), said.get("form", "")) if "names" in said else [numbers(data)]))
    times = next((columns.pop(name) for name in names if name.lower() == "time"), None)
    count = len(next(iter(columns.values())))
    if "count" in said:
        counted(next(iter(columns.values())), int(said["count"]))
    doubt = ("seconds" in said and lasting(step, count, float(said["seconds"]), 0.5 + step)
             or times is not None and lasting(step, count - 1, times[-1] - times[0], 0.01) or "")
    if "scale" in said:
        counts, unit, most = re.split(r"[()]\s*/?\s*", said["scale"])
        return [_less_mean(name, values * float(counts) / float(most), unit, step, doubt) for name, values in columns.items()]
    return [Column(name, values, said.get("unit", "").lower(), None if doubt else step, kind=kind, doubt=doubt)
            for name, values in columns.items()]


def _csv_of_nied(lines: list[str]) -> list[Column]:
    """Of the lines "#SamplingFrequency(Hz)" and "#DurationTime(s)" the value stands in the line below, or behind a comma."""
    words = "\n".join(lines[:HEADER])
    rate, seconds = (re.search(rf"^#\s*{key}\s?\(\w+\)[,\s#]*([\d.]+)", words, FLAGS)
                     for key in (r"Sampling\s?Freq(?:uency)?", r"Duration\s?Time"))
    columns, step = tables.columns_of(lines, None, ",", None), 1 / float(rate[1])
    times = columns[0].values * in_si(columns[0].unit)[0]
    doubt = lasting(step, len(times) - 1, times[-1] - times[0], 0.009) or (
        lasting(step, len(times), float(seconds[1]), 0.5 + step) if seconds else "")
    return [_less_mean(column.name, column.values, column.unit, step, doubt) for column in columns
            if kind_of(column.unit) == "acceleration"]


def _keyed(name: str, lead: str, keys: Sequence[tuple[str, str, str]], also: Sequence[tuple[str, str]] = ()) -> Format:
    """A format whose header has a line for each of some keys: facts, keys, and patterns behind them; others may be absent."""
    patterns = [(fact, rf"^{lead}\s*{re.escape(key)}{rest}") for fact, key, rest in keys]
    return Format(name, {f'a line "{lead}{key}"': pattern for (_, key, _), (_, pattern) in zip(keys, patterns)},
                  functools.partial(_read, [*patterns, *also]))


FORMATS = (
    _keyed("K-NET or KiK-net", "", (
        ("rate", "Sampling Freq(Hz)", NUMBER), ("seconds", "Duration Time(s)", NUMBER), ("name", "Dir.", WORD),
        ("scale", "Scale Factor", r"\s*([\d.]+\s*\([^\s()]+\)\s*/\s*[\d.]+)"), ("", "Memo.", "()"))),
    Format("CSV of K-NET or KiK-net", {'a line "#Sampling Freq(Hz)"': r"^#\s*Sampling\s?Freq(?:uency)?\s?\(Hz\)[,\s#]*[\d.]+",
                                       'a line "#Time,...(gal)"': r"^#\s*Time,.*\(gal\)"}, _csv_of_nied),
    _keyed("CWA", "#", (
        ("rate", "SampleRate(Hz):", NUMBER), ("unit", "AmplitudeUnit:", WORD), ("names", "DataSequence:", REST)), (
        ("seconds", rf"^#\s*RecordLength\(sec\){NUMBER}"), ("form", rf"^#\s*Data:{REST}"))),
    _keyed("ESM", "", (
        ("step", "SAMPLING_INTERVAL_S:", NUMBER), ("count", "NDATA:", NUMBER), ("unit", "UNITS:", WORD)), (
        ("name", rf"^STREAM:{WORD}"), ("kind", rf"^DATA_TYPE:{REST}"), ("", "^USER5:()"))),
    _keyed("AFAD", "", (
        ("count", "NUMBER OF DATA", NUMBER), ("step", "SAMPLING INTERVAL", rf"[ \t]*(?:\(\w+\.?\))?{NUMBER}")), (
        ("unit", r"^.*PGA.*?\((\w\S*?)\)\s*:"), ("names", r"^\s*([A-Z][\w-]{0,2}(?:\s+[A-Z][\w-]{0,2}){2})\s*$"))),
    _keyed("CSMNC", "", (
        ("name", "COMP.", WORD), ("count", "NO. OF POINTS:", NUMBER)), (
        ("step", r"^NO\. OF POINTS:.*INTERVALS OF:\s*([\d.]+)"), ("unit", r"UNIT:\s*(\S+)"),
        ("kind", r"^(?:un)?corrected\s+(\w+)"))))
