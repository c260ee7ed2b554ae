"""What can be turned in the explorer: sliders and choices as the program declares them, and what turns along."""

import dataclasses
import math
from collections.abc import Mapping, Sequence

from .plots.style import on_axis
from .reference import declared

# Two levels of force let a body both stick and slide only beside a constant force; in units of mu_d, as a body that has
# no drag slides for ever under more.
BESIDE = {"telegraph": {"bias": 0.6}}


@dataclasses.dataclass(frozen=True)
class Knob:
    """A slider over an option.

    Attributes
    ----------
    option, label
        Its name, and its words and symbol; TeX.
    low, high
        Its range.
    start
        Where it stands at first; without a start the option is left out until the slider is moved.
    log, whole
        Whether places are logarithms of values, and whether values are integers.
    choices
        By choice the words that the option belongs to; empty if it belongs to any model.
    unit
        Of the option.
    """

    option: str
    label: str
    low: float
    high: float
    start: float | None
    log: bool = False
    whole: bool = False
    choices: Mapping[str, Sequence[str]] = dataclasses.field(default_factory=dict)
    unit: str = ""

    def at(self, place: float) -> float:
        """The value at a place of the slider, with three digits."""
        if self.whole:
            return round(place)
        return float(f"{10**place if self.log else place:.3g}")

    def place(self, value: float) -> float:
        """The place of a value on the slider, at most its ends."""
        value = min(max(value, self.low), self.high)
        return math.log10(value) if self.log else value

    def owners(self, chosen: Mapping[str, str]) -> set[str]:
        """The choices whose word has this option."""
        return {choice for choice, words in self.choices.items()
                if not set(words).isdisjoint(chosen[choice].split("+"))}

    def in_use(self, chosen: Mapping[str, str]) -> bool:
        """Whether the option means something with the words chosen."""
        return not self.choices or bool(self.owners(chosen))


def knobs() -> list[Knob]:
    """Sliders over the options for which the program has one."""
    return [Knob(name, on_axis(name), slider["low"], slider["high"], slider["start"], slider["logarithmic"],
                 option["form"] == "integer", option["belongs_to"], option["unit"])
            for name, option in declared().items() if (slider := option["slider"])]


def choices() -> dict[str, list[str]]:
    """By choice the words that sliders can complete: those without needed options that are texts or files."""
    def complete(choice: str, word: str) -> bool:
        return all(option["slider"] for option in declared().values()
                   if option["needed"] and word in option["belongs_to"].get(choice, ()))

    return {choice: [word for word in option["meanings"] if complete(choice, word)]
            for choice, option in declared().items() if option["meanings"]}


def starts(choice: str, word: str, all_knobs: Sequence[Knob], mu_s: float, mu_d: float) -> dict[str, float]:
    """Values by option with which a word is a model whose bodies stick and slide: forces are in units of mu_s."""
    own = {knob.option: knob.start * (mu_s if knob.unit == "force" else 1) for knob in all_knobs
           if word in knob.choices.get(choice, ()) and knob.start is not None}
    return own | {option: mu_d * value for option, value in BESIDE.get(word, {}).items()}


def carried(moved: str, values: Mapping[str, float]) -> dict[str, float]:
    """Friction coefficients that a moved one takes along, as dynamic friction cannot exceed static friction.

    Parameters
    ----------
    moved
        The option that was moved.
    values
        Friction coefficients by option. One of the direction `_minus` that is missing is that of the other direction.

    Returns
    -------
    values
        Those that change.
    """
    now = dict(values)
    for side in ("", "_minus"):
        static, dynamic = (now.get(name + side, now[name]) for name in ("mu_s", "mu_d"))
        if dynamic > static:
            now[("mu_d" if moved.startswith("mu_s") else "mu_s") + side] = now[moved]
    return {option: value for option, value in now.items() if value != values.get(option)}
