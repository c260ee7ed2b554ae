"""Pictures of what the program computed. matplotlib is imported with this module, not before."""

import base64
import io
import pathlib
import re
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

from ..needed import needed
from ..results import Result, Results
from ..sweeps import Sweep
from ..views import view
from . import curves, distributions, fields, studies, sweeping
from .style import curve, over, saved, units, words

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

FORMATS = (".png", ".pdf", ".svg")
# By kind: whether a file has what it takes, and the function that draws files of one kind together.
KINDS: "dict[str, tuple[Callable[[Results], bool], Callable[[Sequence[Results]], Figure]]]" = {
    "density": (lambda r: r.density is not None, fields.density),
    "trajectory": (lambda r: r.trajectory is not None, fields.trajectory),
    "given_force": (lambda r: "path_velocity" in r, fields.given_force),
    "comparison": (lambda r: r.comparison is not None, studies.comparison),
    "spectra": (lambda r: "S_v" in r, curves.spectra),
    "durations": (lambda r: "f_slide" in r, curves.durations),
    "slips": (lambda r: any(key in r for panel in curves.SLIPS for key in panel[0]), curves.slips),
    "displacements": (distributions.has_distribution, distributions.displacements),
    "arrays": (lambda r: bool(curves.other_arrays([r])), curves.arrays),
    "convergence": (lambda r: r.study_kind in studies.CONVERGENCE, studies.convergence),
    "cost": (lambda r: r.study_kind == "cost", studies.cost),
    "correlation_time": (lambda r: "t_corr" in r, curves.correlation_time),  # on request, as the next one
    "drift": (lambda r: isinstance(r, Sweep) and r.dims == ("bias",), sweeping.drift),
    "fragility": (lambda r: isinstance(r, Sweep) and len(r.dims) == 1 and any("_cdf(" in key for key in r), sweeping.fragility)}
ON_REQUEST = ("correlation_time", "drift", "fragility")
# Kinds that show several files at once.
TOGETHER = ("spectra", "durations", "slips", "displacements", "arrays", "correlation_time")
ASK = ("ask the program for density, trajectory, given_force, spectrum with -omega, duration_density, slip with "
       "-distance, peak, displacement or displacement_distribution with -quantities; or for -compare, "
       "-study or a sweep")


class Figures(dict):
    """Figures by name; a notebook shows them as pictures."""

    def _repr_html_(self) -> str:
        def picture(figure: "Figure") -> str:
            stream = io.BytesIO()
            figure.savefig(stream, format="png", dpi=100)
            return f'<img src="data:image/png;base64,{base64.b64encode(stream.getvalue()).decode()}">'
        return "".join(map(picture, self.values()))


def kinds_of(items: Sequence[Results]) -> list[str]:
    """Kinds of pictures that each of the files has something for."""
    if any(isinstance(item, Sweep) for item in items):
        return ["sweep"]
    found = [kind for kind, (fits, _) in KINDS.items() if kind not in ON_REQUEST and all(map(fits, items))
             and (len(items) == 1 or kind in TOGETHER)]
    several = len(items) > 1 and all(map(KINDS["correlation_time"][0], items))
    return found or (["correlation_time"] if several else [])


def draw(items: Sequence[Results], picture: str | pathlib.Path | None = None,
         kind: str | None = None) -> "dict[str, Figure]":
    """Draw what files hold.

    Parameters
    ----------
    items
        Results; several of them share a picture.
    picture
        Where to save; of several pictures each has its kind appended. The pictures of a sweep, one for each result,
        go into a folder: sweep.png and sweep both name the folder sweep.
    kind
        One of `KINDS`, or a key of a sweep; without it, all that fit.

    Returns
    -------
    figures
        By kind, or by the key of a sweep's result.

    Raises
    ------
    ValueError
        If there is nothing to draw, or a picture cannot be of that name.
    """
    return Figures((name, figure) for name, figure, _ in drawn(items, picture, kind))


@view("picture", Result)
def labelled(result: Result, axes: "Axes | None" = None, label: str | None = None, **look: Any) -> "Axes":
    """An array, or a result of a sweep, in axes, by default the current ones of pyplot, which get its labels."""
    axes = axes or needed("matplotlib.pyplot").gca()
    if result.sweep is not None:
        shared = axes.has_data()
        sweeping.into(axes, result.sweep, result.key, label, **look)
        axes.set_title("" if shared else axes.get_title())  # which has the parameters of one sweep
    else:
        curve(axes, result, len(axes.lines), label=label, **look)
        axes.set(xlabel=over(result), ylabel=words(result.key) + units(result.unit))
    return axes


@view("picture", Results)
def _drawn_alone(results: Results, picture: str | pathlib.Path | None = None,
                 kind: str | None = None) -> "dict[str, Figure]":
    return draw([results], picture, kind)


def drawn(items: Sequence[Results], picture: str | pathlib.Path | None = None,
          kind: str | None = None) -> "list[tuple[str, Figure, pathlib.Path | None]]":
    """As `draw`: kind, figure, and where it was saved."""
    place = pathlib.Path(picture) if picture is not None else None
    if place and not place.suffix and any(isinstance(item, Sweep) for item in items) and kind is None:
        place = place.with_name(f"{place.name}{FORMATS[0]}")  # a folder is named
    if place and place.suffix not in FORMATS:
        raise ValueError(f"{place}: a picture ends in {', '.join(FORMATS)}")
    if place and not place.parent.is_dir():
        raise ValueError(f"{place}: its folder does not exist; make the folder first")
    if len(items) == 1 and isinstance(items[0], Sweep) and kind in items[0]:
        return [(kind, figure := sweeping.one(items[0], kind), saved(figure, place))]
    kinds = [kind] if kind else kinds_of(items)
    if kinds == ["sweep"]:
        if len(items) > 1:
            raise ValueError("one sweep, please: a picture holds one")
        if not items[0]:
            raise ValueError("nothing to draw: no point of the sweep has results")
        return [(key, figure, saved(figure, place and place.with_suffix("") / f"{plain(key)}{place.suffix}"))
                for key, figure in sweeping.each(items[0]).items()]
    if not kinds or not all(name in KINDS and all(map(KINDS[name][0], items)) for name in kinds):
        raise ValueError(f"nothing to draw{f' as {kind}' if kind else ''}; {ASK}")
    several = len(kinds) > 1
    return [(name, figure, saved(figure, place.with_stem(f"{place.stem}_{name}") if place and several else place))
            for name, figure in ((name, KINDS[name][1](items)) for name in kinds)]


def plain(key: str) -> str:
    """A key as a file's name; keys of observables hold anything."""
    return re.sub(r"[^\w.+-]", "_", key)
