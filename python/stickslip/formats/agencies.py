"""Formats with a header "key value" above plain samples.

K-NET and KiK-net of NIED (Japan); the free-field text of CWA (Taiwan); ESM and the newer files of AFAD (DYNA 1.2); the older
files of AFAD (Turkey), three components a file.
"""

import re

from .reading import Column, Format, counted, data_of, keys, kind_in, lasting, numbers, table

PLACES = {f"{n + 1}": f"{way} {place}" for n, (place, way) in enumerate(
    (place, way) for place in ("borehole", "surface") for way in ("N-S", "E-W", "U-D"))}  # of KiK-net


def _nied(lines: list[str]) -> list[Column]:
    said = {name: re.search(pattern, "\n".join(lines[:40]), re.MULTILINE | re.IGNORECASE) for name, pattern in (
        ("rate", r"^Sampling Freq\(Hz\)\s+([\d.]+)"), ("seconds", r"^Duration Time\(s\)\s+([\d.]+)"),
        ("direction", r"^Dir\.\s+(\S+)"), ("scale", r"^Scale Factor\s+([\d.]+)\s*\((\S+?)\)\s*/\s*([\d.]+)"))}
    wrong = [name for name, found in said.items() if not found]
    if wrong:
        raise ValueError(f"header: {', '.join(wrong)} cannot be read")
    at = next(n for n, line in enumerate(lines) if line.lower().startswith("memo"))
    values = numbers([line for line in lines[at + 1:] if line.strip()]) * float(said["scale"][1]) / float(said["scale"][3])
    step = 1 / float(said["rate"][1])
    doubt = lasting(step, len(values), float(said["seconds"][1]), 1)
    if doubt:
        raise ValueError(f"{doubt}")
    mean, unit = values.mean(), said["scale"][2]
    return [Column(PLACES.get(said["direction"][1], said["direction"][1]), values - mean, unit, step, kind="acceleration",
                   notes=(f"the mean, {mean:.4g} {unit}, was taken off, as samples of this format have an arbitrary offset",))]


def _cwa(lines: list[str]) -> list[Column]:
    said, data = keys(lines), data_of(lines)
    names = [name for name in re.split(r"[;,\s]+", said["DATASEQUENCE"]) if name]
    unit, rate = re.split(r"[\s;,]", said["AMPLITUDEUNIT"])[0], float(said["SAMPLERATE(HZ)"])
    columns = dict(zip(names, table(data, len(names), said.get("DATA", ""))))
    times = next((columns.pop(name) for name in names if name.lower() == "time"), None)
    stated = float(said.get("RECORDLENGTH(SEC)", len(data) / rate))
    doubt = lasting(1 / rate, len(data), stated, 1) or (
        times is not None and lasting(1 / rate, len(data) - 1, times[-1] - times[0], 0.01)) or ""
    return [Column(name, values, unit, None if doubt else 1 / rate, kind="acceleration", doubt=doubt)
            for name, values in columns.items()]


def _dyna(lines: list[str]) -> list[Column]:
    said = keys(lines)
    kind = said.get("DATA_TYPE", "ACCELERATION").lower()
    values, = table(data_of(lines), 1)
    return [Column(said.get("STREAM") or kind, counted(values, int(said["NDATA"])), said["UNITS"],
                   float(said["SAMPLING_INTERVAL_S"]), kind=kind_in(kind) if "spectr" not in kind else "spectrum")]


def _afad(lines: list[str]) -> list[Column]:
    said, data = keys(lines), data_of(lines)
    names = [line for line in lines[:lines.index(data[0])] if line.strip()][-1].split()
    unit = next((found[1].lower() for key in said if (found := re.search(r"PGA.*\((\S+)\)", key))), "")
    step = float(next(value for key, value in said.items() if key.startswith("SAMPLING INTERVAL")))
    columns = table(data, len(names))
    counted(columns[0], int(said["NUMBER OF DATA"]))
    return [Column(name, values, unit, step, kind="acceleration") for name, values in zip(names, columns)]


FORMATS = (
    Format("K-NET or KiK-net", {f'a line "{key}"': "^" + re.escape(key) for key in (
        "Sampling Freq(Hz)", "Duration Time(s)", "Dir.", "Scale Factor", "Memo.")}, _nied),
    Format("CWA", {f'a line "#{key}:"': r"^#\s*" + re.escape(key) + ":" for key in (
        "SampleRate(Hz)", "AmplitudeUnit", "DataSequence")}, _cwa),
    Format("ESM", {f'a line "{key}:"': f"^{key}:" for key in ("SAMPLING_INTERVAL_S", "NDATA", "UNITS")}, _dyna),
    Format("AFAD", {f'a line "{key}"': "^" + key for key in ("NUMBER OF DATA", "SAMPLING INTERVAL")}, _afad))
