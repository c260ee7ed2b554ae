"""Units of force, acceleration, velocity, displacement and time, in the spellings in which people write them."""

import re

STANDARD_GRAVITY = 9.80665  # m/s^2, by the General Conference on Weights and Measures of 1901
_TIMES = {"s": 1, "ms": 1e-3, "us": 1e-6, "ns": 1e-9, "min": 60, "h": 3600, "d": 86400}
_LENGTHS = {"m": 1, "cm": 0.01, "mm": 1e-3, "um": 1e-6, "nm": 1e-9, "km": 1e3, "ft": 0.3048, "in": 0.0254}
# By kind: the SI unit, and the factors that make it of other ones.
KINDS: dict[str, tuple[str, dict[str, float]]] = {
    "acceleration": ("m/s^2", {"g": STANDARD_GRAVITY, "mg": STANDARD_GRAVITY / 1e3, "ug": STANDARD_GRAVITY / 1e6,
                               "%g": STANDARD_GRAVITY / 100, "g/10": STANDARD_GRAVITY / 10, "gal": 0.01, "mgal": 1e-5,
                               **{f"{name}/s^2": factor for name, factor in _LENGTHS.items()}}),
    "velocity": ("m/s", {f"{name}/s": factor for name, factor in _LENGTHS.items()}),
    "displacement": ("m", _LENGTHS),
    "time": ("s", _TIMES)}
# Of other kinds, which are kept as they are; a row of units may hold them.
OTHERS = ("n", "kn", "mn", "un", "nn", "pn", "lbf", "kgf", "pa", "kpa", "mpa", "n/kg", "n/m", "v", "mv", "uv", "a", "ma",
          "counts", "count", "hz", "deg", "rad", "rad/s", "rad/s^2", "1", "-", "")
_WORDS = (("milliseconds?|millisec|millis|msecs?", "ms"), ("microseconds?|microsec|micros|usecs?", "us"),
          ("nanoseconds?|nanosec|nsecs?", "ns"), ("seconds?|secs?|sekunden?|secondes?|seg|segundos?|secondi", "s"),
          ("minutes?|mins?|minuten", "min"), ("hours?|hrs?|stunden?|heures?", "h"), ("days?|tage?|jours?", "d"),
          ("centimet(?:er|re)s?|cms", "cm"), ("millimet(?:er|re)s?", "mm"), ("micromet(?:er|re)s?|microns?", "um"),
          ("nanomet(?:er|re)s?", "nm"), ("kilomet(?:er|re)s?", "km"), ("met(?:er|re)s?", "m"), ("feet|foot", "ft"),
          ("inch(?:es)?", "in"), ("milli[- ]?g", "mg"), ("micro[- ]?g", "ug"), ("milli-?gals?", "mgal"), ("gals", "gal"),
          ("kilonewtons?", "kn"), ("millinewtons?", "mn"), ("newtons?", "n"), ("m(?:illi)?volts?", "mv"), ("volts?", "v"),
          ("g's", "g"), ("squared?|sq", "^2"), ("per", "/"))
# Ends of units by time, as in "cm s-2", "m/s/s", "cm/s 2" and "acc_mps2".
_RATES = ((r"[\s.]?s\^?-2|/s(?:/s|\s?\^?2)|_?(?:p?s2|_s2|pss|ss)", "/s^2"), (r"[\s.]?s\^?-1|_?ps", "/s"))


def plain_unit(text: str) -> str:
    """A unit in one spelling: "CM/SEC/SEC", "cm/s2", "cm s^-2" and "centimetres per second squared" are cm/s^2."""
    text = re.sub(r"[µμ]", "u", text.strip().lower()).replace("²", "^2").replace("⁻", "^-").replace("^-^2", "^-2")
    text = re.sub(r"(?<=[a-z])\.(?=\W|\d|$)|[{}()]|^in (?!s)", "", text.replace("**", "^")).replace("·", " ").replace("*", " ")
    for words, unit in _WORDS:
        text = re.sub(rf"(?<![a-z])(?:{words})(?![a-z])", unit, text)
    text = re.sub(r"\s*([/^])\s*", r"\1", text).strip()
    for form, end in _RATES:
        text = re.sub(rf"^([a-z]+?)(?:{form})$", rf"\1{end}", text)
    return text


def kind_of(unit: str) -> str:
    """Which of `KINDS` a unit is of; "" for others, and for none."""
    return next((kind for kind, (_, factors) in KINDS.items() if plain_unit(unit) in factors), "")


def in_si(unit: str) -> tuple[float, str]:
    """Factor and SI unit that a unit becomes: ("gal") gives (0.01, "m/s^2"). A unit of no kind stays, times 1."""
    kind = kind_of(unit)
    return (KINDS[kind][1][plain_unit(unit)], KINDS[kind][0]) if kind else (1, unit)


def is_unit(text: str) -> bool:
    """Whether a text is a unit that is known, be it of one of `KINDS` or another."""
    return bool(kind_of(text)) or plain_unit(text) in OTHERS
