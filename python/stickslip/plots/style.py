"""What the pictures share: colours, curves with their errors, and the words for results and parameters."""

import copy
import functools
import pathlib
import re
from collections.abc import Callable, Collection, Mapping
from typing import TYPE_CHECKING, Any

from ..needed import needed
from ..program import ProgramError
from ..reference import declared
from ..results import Result, Results

if TYPE_CHECKING:
    import numpy
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure
numpy, matplotlib = needed("numpy"), needed("matplotlib")
needed("matplotlib.figure")
Figure, Line2D, Patch = matplotlib.figure.Figure, matplotlib.lines.Line2D, matplotlib.patches.Patch

# Distinguished by the colour-blind (Okabe and Ito), and in grey together with the line styles.
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#222222")
STYLES = ("-", "--", "-.", (0, (1, 1.2)), (0, (5, 1.5, 1, 1.5, 1, 1.5)))
MARKERS = "os^Dv"
LOOK = {"axes.prop_cycle": matplotlib.cycler(color=COLOURS), "figure.facecolor": "white", "axes.grid": True,
        "grid.color": "#e4e4e4", "axes.axisbelow": True,
        "legend.frameon": False, "font.size": 9, "savefig.dpi": 200, "pdf.fonttype": 42, "figure.constrained_layout.use": True}
ABSCISSAE = {"omega": r"angular frequency $\omega$  [1/time]", "time": "time $t$  [time]",
             "lambda": r"$\lambda$  [1/time]", "k": "level $i$", "distance": "path length $d$  [length]",
             "inverse_distance": "$s$  [1/length]", "velocity": "speed $w$  [velocity]", "mode": "mode", "slip": "number of the slip",
             "tilt": "tilt $s$  [1/length]", "wavenumber": "wavenumber $k$  [1/length]",
             "tilted_velocity": "mean velocity $u$  [velocity]",
             "probability": "probability $p$"}
DISPLACEMENT = "displacement $d$  [length]"
WORDS = {"P_stick": r"probability of sticking $P_\mathrm{stick}$", "P_slide": r"probability of sliding $P_\mathrm{slide}$",
         "mean_stick": "mean duration of sticking", "mean_slide": "mean duration of sliding",
         "mean_excursion": "mean duration of an excursion",
         "E_V": "mean velocity $E[V]$", "E_V2": "$E[V^2]$", "E_absV": "mean speed $E[|V|]$", "E_XV": "$E[XV]$",
         "S_v": "power spectral density $S_v$", "diffusivity": "diffusivity $S_0/2$", "S_0": "$S_v(0)$",
         "fwhm": "full width of $S_v$ at half its maximum", "t_corr": r"correlation time $t_\mathrm{corr}$",
         "variance_from_spectrum": "Var $V$", "E_X2": "$E[X^2]$", "P_X_le_mu_s": r"$P(|X| \leq \mu_s)$",
         "C_vv": "autocovariance $C_{vv}(t)$", "S_x": "$S_X$ of the chain", "S_x_target": "$S_X$ of what it stands for",
         "F_stick": r"$E[e^{-\lambda T_\mathrm{stick}}]$", "F_slide": r"$E[e^{-\lambda T_\mathrm{slide}}]$",
         "F_excursion": r"$E[e^{-\lambda (T_\mathrm{slide} + T_\mathrm{stick})}]$",
         "theta": r"growth rate $\theta(s)$", "tilted_velocity": r"mean velocity $\theta'(s)$",
         "rate_function": "rate function $I(u)$", "entry_law": "probability that sticking begins on level $i$",
         "var_stick": "variance of the duration of sticking", "var_slide": "variance of the duration of sliding",
         "f_stick": "density of the duration of sticking", "f_slide": "density of the duration of sliding",
         "f_excursion": "density of the duration of an excursion", "f_stick_0": r"$f_\mathrm{stick}(0+)$",
         "cdf_stick": r"$P(T_\mathrm{stick} \leq t)$", "cdf_slide": r"$P(T_\mathrm{slide} \leq t)$",
         "cdf_excursion": r"$P(T_\mathrm{stick} + T_\mathrm{slide} \leq t)$",
         "mean_slip": "mean path of a slip", "var_slip": "variance of the path of a slip",
         "mean_slip_net": "mean displacement of a slip", "var_slip_net": "variance of the displacement of a slip",
         "f_slip": "density of the path of a slip", "cdf_slip": r"$P(S \leq d)$", "F_slip": r"$E[e^{-s S}]$",
         "P_peak": "P(largest speed $> w$)", "mean_first_passage": "mean time to the speed $w$",
         "first_passage_mean": "mean time to the speed $w$", "slip_rate": "slips in a unit of time",
         "F_passage(w)": r"$E[e^{-\lambda T(w)}]$ of the time $T$ to a speed",
         "f_passage(w)": "density of the time $T(w)$ to a speed", "cdf_passage(w)": r"$P(T(w) \leq t)$ of the time to a speed",
         "displacement_mean": "$E[x(t)]$", "displacement_variance": "Var $x(t)$",
         "displacement_cosine(t)": r"$E[\cos k x(t)]$", "displacement_sine(t)": r"$E[\sin k x(t)]$",
         "displacement_density(t)": "density of $x(t)$", "displacement_cdf(t)": r"$P(x(t) \leq d)$",
         "displacement_quantile(t)": "quantile of $x(t)$", "displacement_atom": "probability of the atom of $x(t)$",
         "final_displacement": "displacement in the end", "largest_displacement": "largest displacement",
         "largest_speed": "largest speed", "sliding_share": "share of the time in motion", "slip_count": "number of slips",
         "slip_begin": "begin of a slip", "slip_end": "end of a slip", "slip_displacement": "displacement of a slip",
         "slip_peak": "largest speed of a slip", "path_force": "force", "path_velocity": "velocity",
         "path_displacement": "displacement"}
FEW_POINTS = 20  # of a curve, each of which is marked, as the line between them is straight
NEVER = 1e6  # times the friction of the other direction is no friction but a direction in which nothing moves
LEVELS = ("delta", "delta_per_mu_s", "noise_levels")  # of the noise: distance, stated apart, and range, which is not


def words(key: str) -> str:
    """What a result is, in words or symbols; TeX. Its key where it has neither."""
    stem, _, argument = key.rstrip(")").partition("(")
    general = next((name for name in WORDS if name.partition("(")[0] == stem), key)
    letter = general.partition("(")[2]
    return WORDS.get(key) or WORDS.get(general, key).replace(f"({letter}", f"({argument})" if argument else f"({letter}")


def styled(draw: Callable[..., Any]) -> Callable[..., Any]:
    """A function that draws with the look of this package, whatever is set elsewhere."""
    @functools.wraps(draw)
    def drawing(*arguments: Any, **keywords: Any) -> Any:
        with matplotlib.rc_context(LOOK):
            return draw(*arguments, **keywords)
    return drawing


def saved(figure: "Figure", place: pathlib.Path | None) -> pathlib.Path | None:
    """The place, after saving there if there is one."""
    if place is not None:
        place.parent.mkdir(exist_ok=True)
        with matplotlib.rc_context(LOOK):
            figure.savefig(place)
    return place


def paneled(count: int) -> "tuple[Figure, list[Axes]]":
    """A figure of so many panels, at most three beside each other."""
    columns = min(count, 2 if count in (2, 4) else 3)
    rows = -(-count // columns)
    figure = Figure(figsize=(0.6 + 3.4 * max(columns, 1.4), 0.4 + 2.8 * rows))
    return figure, [figure.add_subplot(rows, columns, n + 1) for n in range(count)]


def curve(axes: "Axes", result: Result, n: int = 0, *, colour: str | None = None, style: Any = None,
          label: str | None = None) -> None:
    """An array against its abscissa: computed values as a line in the band of their errors, simulated ones as marks
    with their 95 % confidence intervals.

    Parameters
    ----------
    axes
    result
    n
        Number of the curve, which gives it colour and line style where these are not given.
    """
    colour, style = colour or COLOURS[n % len(COLOURS)], style or STYLES[n % len(STYLES)]
    x, value, error = (numpy.asarray(part, float) for part in (result.abscissa, result.value, result.error))
    if result.ci95 is not None:
        bars(axes, x, value, result.ci95, colour, label, "o" if style == STYLES[0] else MARKERS[n % 5])
        return
    if result.abscissa_name in ("k", "mode", "slip") or x.size == 1:  # nothing lies between
        axes.errorbar(x, value, error, fmt=MARKERS[n % 5], color=colour, markersize=3, capsize=2, label=label)
        return
    axes.plot(x, value, color=colour, linestyle=style, linewidth=1.6, label=label,
              marker="." if x.size <= FEW_POINTS else None, markersize=5)
    axes.fill_between(x, value - error, value + error, color=colour, alpha=0.25, linewidth=0)


def bars(axes: "Axes", x: "numpy.ndarray", value: "numpy.ndarray", ci95: "numpy.ndarray", colour: str,
         label: str | None = None, marker: str = "o") -> None:
    """Simulated values with their 95 % confidence intervals, which may be infinite."""
    sides = numpy.abs(numpy.nan_to_num(numpy.asarray(ci95).T - value, posinf=0, neginf=0))
    axes.errorbar(x, value, yerr=sides, fmt=marker, color=colour, markersize=3, capsize=2, linewidth=1, label=label)


def over(result: Result) -> str:
    """The label of what an array depends on; displacements have a sign, paths have none."""
    name = result.abscissa_name
    if name == "distance" and result.key.startswith("displacement"):
        return DISPLACEMENT
    label = ABSCISSAE.get(name, name)
    return label.replace("[time]", "[s]") if re.match(r"m\b", result.unit) else label  # of a record with units


def scale(values: "numpy.ndarray") -> str:
    """Logarithmic where neighbours differ by a factor rather than by a distance."""
    values = numpy.sort(values)
    even = len(values) > 2 and values[0] > 0 and numpy.ptp(numpy.diff(numpy.log(values))) < 1e-6
    return "log" if even else "linear"


def units(text: str) -> str:
    """A unit of the program, such as "velocity^2*time", in brackets; TeX. Empty where there is none."""
    text = "length" if text == "velocity*time" else text
    return "  [" + re.sub(r"\^(\d+)", r"$^\1$", text).replace("*", " ") + "]" if text else ""


def decades(axis: "Axis") -> None:
    """Ticks at 1, 2 and 5 times the powers of ten, as numbers; for a logarithmic axis of a few decades."""
    axis.set_major_locator(matplotlib.ticker.LogLocator(10, (1, 2, 5)))
    axis.set_major_formatter(lambda x, _: f"{x:g}")
    axis.set_minor_locator(matplotlib.ticker.NullLocator())


def known() -> Mapping[str, Mapping[str, Any]]:
    """What the program declares of its options; nothing where there is none to ask."""
    try:
        return declared()
    except ProgramError:
        return {}


def given(results: Results, option: str) -> str:
    """An option as the program had it. Empty where it had no effect; where the file does not say, the default of a choice
    between words, and empty of anything else."""
    declared_as = known().get(option)
    return results.options.get(option, declared_as["default"] if declared_as and declared_as["meanings"] else "")


def number(results: Results, option: str) -> float:
    """An option that is one; 0 where it had no effect."""
    return float(given(results, option) or 0)


def symbol(option: str) -> str:
    """Of an option; TeX. Its words, or its name, where it has none."""
    shown = known().get(option, {"label": "", "symbol": ""})
    return f"${shown['symbol']}$" if shown["symbol"] else shown["label"] or option


def on_axis(option: str) -> str:
    """Words and symbol of an option; TeX. Its name where it has neither."""
    words = known().get(option, {}).get("label", "")
    return f"{words} {symbol(option)}" if words and words != symbol(option) else symbol(option)


def parameters(results: Results) -> dict[str, str]:
    """What the options of the model were, by name, but for those without effect. Of options that the program does not
    know, or where there is none to ask, those that can be swept."""
    options, declarations, found = results.options, known(), {}
    for name in dict.fromkeys((*declarations, *options)):
        option = declarations.get(name)
        text = given(results, name)
        if not text or option is None and f"sweep_{name}" not in options:
            continue
        in_use = option is None or option["group"] == "Model" and (not option["belongs_to"] or users(results, name))
        absent = option and option["default"] == "0" and float(text) == 0
        if in_use and not absent:
            found[name] = text
    return found


def users(results: Results, option: str) -> set[str]:
    """Choices of effects, such as noise, whose word has this option."""
    declarations = known()
    owners = declarations[option]["belongs_to"] if option in declarations else {}
    return {choice for choice, words in owners.items()
            if given(results, choice) in words}


def stated(option: str, text: str, form: Callable[[float], str] = "{:g}".format) -> str:
    """An option and its value; TeX."""
    if known().get(option, {}).get("form") == "file":
        return f"{on_axis(option)} {pathlib.Path(text).name}"
    try:
        text = form(float(text))
    except ValueError:
        pass  # a word
    return f"{symbol(option)} = {text}"


def step(results: Results) -> float | None:
    """Distance of the noise levels; none where these are given one by one."""
    used = parameters(results)
    if "delta_per_mu_s" in used:
        return number(results, "mu_s") / number(results, "delta_per_mu_s")
    return number(results, "delta") if "delta" in used else None


def memory(results: Results) -> str:
    """The noise in words, without its step; TeX. All parameters where there is no program that knows those of the noise."""
    return ", ".join(stated(name, text, fraction) for name, text in parameters(results).items()
                     if name not in LEVELS and ("noise" in users(results, name) or name not in known()))


def noise(results: Results) -> str:
    """The noise in words; TeX."""
    delta = step(results)
    return ", ".join(filter(None, [memory(results), f"{symbol('delta')} = {fraction(delta)}" if delta else ""]))


def drag(results: Results) -> str:
    """b(v): what the program says of the drag law, with numbers for their symbols; TeX."""
    law = given(results, "drag")
    text = known().get("drag", {}).get("meanings", {}).get(law, law)
    for name, option in known().items():
        value = results.options.get(name)
        if not value or law not in option["belongs_to"].get("drag", ()):
            continue
        if option["form"] == "formula":
            return value.strip()
        if plain := re.sub(r"[\\_{}]", "", option["symbol"]):
            text = re.sub(rf"\s*[-+]?\s*\b{plain}\b \S+", "", text) if float(value) == 0 else re.sub(
                rf"\b{plain}\b ?", "" if float(value) == 1 else f"{float(value):g} ", text)
    return re.sub(r"^\s*- ", "-", text) or "0"


def without(results: Results, names: Collection[str]) -> Results:
    """The same results, as if the options of these names had no effect, for a title that leaves them out."""
    other = copy.copy(results)
    other.options = {**results.options, **dict.fromkeys(names, "")} if results.options else {}
    return other


def title(results: Results) -> str:
    """The model parameters in one line; TeX. Empty where the file does not have them."""
    if not results.options:
        return ""
    parts, one_way = [], number(results, "mu_s_minus") > NEVER * number(results, "mu_s")
    for name, text in parameters(results).items():
        if one_way and name in ("mu_s_minus", "mu_d_minus"):
            continue
        if name == "noise":
            parts.append(noise(results))
        elif name == "drag":
            parts.append(f"$b(v) = {drag(results)}$")
        elif not users(results, name) & {"noise", "drag"} and not known().get(name, {}).get("meanings"):
            parts.append(stated(name, text))
    return ", ".join(filter(None, [*parts, "one way" * one_way]))


def fraction(x: float) -> str:
    """1, 1/2, 1/4, ... as fractions, the rest as decimals; TeX."""
    denominator = round(1 / x) if 0 < x <= 1 else 0
    exact = denominator & (denominator - 1) == 0 and denominator * x == 1
    return f"1/{denominator}" if exact and denominator > 1 else f"{x:g}"
