"""Turn a knob and watch the stationary distribution move: sliders over the model parameters, pictures that follow."""

import dataclasses
import os
import pathlib
import queue
import threading
import time
import warnings
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from .calls import run
from .needed import needed
from .plots.fields import SLIDE, STICK, cells_around
from .plots.style import symbol
from .program import BadInput, Cancelled, OutOfMemory, ProgramError
from .reference import declared
from .results import Results
from .sweeps import Sweep

numpy = needed("numpy")

ADDRESS = "127.0.0.1"  # of the page: this machine alone
POLL = 20  # milliseconds between looks for new results
LEAST = 1e-3  # probability outside of what is shown
REFUSED = "#b00000"
ROWS = 200  # of the picture of the density
KNOBS_BELOW = 6  # one another
SHOWN = 1e-6  # of the largest value of a curve
TIMES, FREQUENCIES = "0.02:20:60:log", "0.02:50:60:log"


@dataclasses.dataclass(frozen=True)
class Knob:
    """A slider: an option, its range, and by choice the words that it belongs to, none if it is in any scene."""

    option: str
    label: str
    low: float
    high: float
    start: float
    log: bool = False
    choices: Mapping[str, Sequence[str]] = dataclasses.field(default_factory=dict)
    whole: bool = False

    def at(self, place: float) -> float:
        """The value at a place of the slider, with three digits."""
        if self.whole:
            return round(place)
        return float(f"{10**place if self.log else place:.3g}")

    def place(self, value: float) -> float:
        """The place of a value on the slider."""
        return float(numpy.log10(value)) if self.log else value


FIRST = {"quantities": "sticking,moments,density"}
SECOND = {"quantities": "spectrum,duration_density", "omega": FREQUENCIES, "time": TIMES}


def knobs() -> list[Knob]:
    """Sliders over the options for which the program has one."""
    return [Knob(name, symbol(name), slider["low"], slider["high"], slider["start"], slider["logarithmic"],
                 option["belongs_to"], option["form"] == "integer")
            for name, option in declared().items() if (slider := option["slider"])]


def choices() -> dict[str, list[str]]:
    """By choice the words that sliders can complete: those without needed options that are texts or files."""
    def complete(choice: str, word: str) -> bool:
        return all(option["slider"] for option in declared().values()
                   if option["needed"] and word in option["belongs_to"].get(choice, ()))

    return {choice: [word for word in option["meanings"] if complete(choice, word)]
            for choice, option in declared().items() if option["meanings"]}


class Solver(threading.Thread):
    """Computes the newest parameters asked for; what it was computing before is ended.

    Results come in two parts, the stationary distribution first, as (number of the request, part, results or
    exception).
    """

    def __init__(self, compute: Callable[..., Results]) -> None:
        super().__init__(daemon=True)
        self.results: "queue.Queue[tuple[int, int, Results | Exception]]" = queue.Queue()
        self._compute = compute
        self._condition = threading.Condition()
        self._wanted: tuple[int, Mapping[str, Any]] | None = None
        self._cancel = threading.Event()
        self._closed = False
        self.number = 0

    def ask(self, options: Mapping[str, Any]) -> None:
        """Compute these options next; returns at once."""
        with self._condition:
            self.number += 1
            self._wanted = self.number, dict(options)
            self._cancel.set()
            self._condition.notify()

    def close(self) -> None:
        """End what is being computed, and the thread."""
        with self._condition:
            self._closed = True
            self._cancel.set()
            self._condition.notify()
        self.join()

    def run(self) -> None:
        while True:
            with self._condition:
                while not (self._wanted or self._closed):
                    self._condition.wait()
                if self._closed:
                    return
                (number, options), self._wanted = self._wanted, None
                self._cancel = cancel = threading.Event()
            for part, asked in enumerate((FIRST, SECOND)):
                try:
                    with warnings.catch_warnings():
                        warnings.simplefilter("ignore")  # errors are drawn
                        found: Results | Exception = self._compute(cancel=cancel, **{**options, **asked})
                except Cancelled:
                    break
                except (BadInput, OutOfMemory, ProgramError, ImportError) as problem:
                    found = problem
                self.results.put((number, part, found))
                if isinstance(found, Exception):
                    break


class Explorer:
    """The window: pictures, sliders, choices and buttons on one figure.

    Parameters
    ----------
    figure
        An empty figure of Matplotlib.
    options
        Options of the program for every run, such as accuracy or options_file.
    scene
        Values from which sliders and choices start, by option.
    folder
        Where the buttons save.
    compute
        What stands for `stickslip.run`.
    """

    def __init__(self, figure: Any, options: Mapping[str, Any], scene: Mapping[str, Any],
                 folder: pathlib.Path = pathlib.Path(), compute: Callable[..., Results] = run) -> None:
        self.figure, self.options, self.folder = figure, dict(options), folder
        self.solver = Solver(compute)
        self.knobs, self.offered = knobs(), choices()
        self.sliders: dict[str, Any] = {}
        self.choices: dict[str, str] = {}
        self.moved: set[str] = set()  # knobs and choices that the user turned
        self.by_steps = bool(scene.get("delta_per_mu_s"))  # in the file, which then has no delta
        self.asked_at = 0.0
        self._lay_out(scene)
        self._show_knobs()
        self.solver.start()
        self.ask()

    # Layout

    def _lay_out(self, scene: Mapping[str, Any]) -> None:
        widgets = needed("matplotlib.widgets")
        grid = self.figure.add_gridspec(2, 4, width_ratios=(4, 1, 0.6, 4), height_ratios=(1, 3), left=0.06, right=0.98,
                                        top=0.95, bottom=0.42, hspace=0.06, wspace=0.06)
        self.density = self.figure.add_subplot(grid[1, 0])
        self.by_v = self.figure.add_subplot(grid[0, 0], sharex=self.density)
        self.by_x = self.figure.add_subplot(grid[1, 1], sharey=self.density)
        right = grid[:, 3].subgridspec(2, 1, hspace=0.5)
        self.spectrum, self.durations = (self.figure.add_subplot(right[n]) for n in range(2))
        # What is drawn stays; new results move it, which is several times faster than drawing anew.
        colors = needed("matplotlib.colors")
        self.image = self.density.imshow(numpy.zeros((2, 2)), aspect="auto", origin="lower", cmap="Blues",
                                         norm=colors.PowerNorm(0.35, 0, 1), interpolation="nearest")
        self.held, = self.density.plot([], [], "_", color=STICK, markersize=5)
        self.density.set(xlabel="V", ylabel="X")
        self.curve_v, = self.by_v.plot([], [], color=SLIDE)
        self.by_v.set_title("", fontsize=9, color=STICK)
        self.by_v.tick_params(labelbottom=False)
        self.stairs_x, self.stairs_rest = (self.by_x.stairs([0], [0, 1], orientation="horizontal", fill=True, color=color,
                                                            alpha=0.6) for color in (SLIDE, STICK))
        self.by_x.tick_params(labelleft=False)
        self.curves: dict[str, Any] = {}
        self.bands: dict[str, Any] = {}
        for axes, abscissa, ordinate, keys in ((self.spectrum, "$\\omega$", "$S_v$", {"S_v": SLIDE}),
                                               (self.durations, "t", "density of durations",
                                                {"f_stick": STICK, "f_slide": SLIDE})):
            for key, color in keys.items():
                self.curves[key], = axes.loglog([], [], color=color, label=key)
            axes.set(xlabel=abscissa, ylabel=ordinate)
            axes.grid(alpha=0.3)
            axes.legend(fontsize=8, loc="lower left")
        self.words = self.figure.text(0.06, 0.335, "", va="top", family="monospace", fontsize=8.5)
        self.status = self.figure.text(0.06, 0.012, "", fontsize=9)
        for knob in self.knobs:
            start = self._start(knob, scene)
            start = knob.start if not isinstance(start, (int, float)) else min(max(start, knob.low), knob.high)
            slider = widgets.Slider(self.figure.add_axes((0, 0, 1, 1), label=knob.option), knob.label,
                                    knob.place(knob.low), knob.place(knob.high), valinit=knob.place(start))
            slider.on_changed(lambda _, option=knob.option: self.turn(option))
            self.sliders[knob.option] = slider
        for n, (option, values) in enumerate(self.offered.items()):
            value = str(scene.get(option, values[0]))
            values = values if value in values else [*values, value]
            self.choices[option] = value
            place = self.figure.add_axes((0.28, 0.25 - 0.1 * n, 0.11, 0.095))
            place.text(0.97, 0.9, option, ha="right", va="top", fontsize=9, color="gray", transform=place.transAxes)
            radio = widgets.RadioButtons(place, values, active=values.index(value))
            radio.on_clicked(lambda chosen, option=option: self.choose(option, chosen))
            setattr(self, f"_{option}", radio)  # widgets without a reference are dead
        for n, (label, act) in enumerate((("save options", self.save_scene),
                                          ("save PNG", lambda: self.save_picture("png")),
                                          ("save PDF", lambda: self.save_picture("pdf")))):
            button = widgets.Button(self.figure.add_axes((0.66 + 0.11 * n, 0.005, 0.1, 0.035)), label)
            button.on_clicked(lambda _, act=act: self.show(act()))
            setattr(self, f"_button_{n}", button)

    def _start(self, knob: Knob, scene: Mapping[str, Any]) -> Any:
        if knob.option == "delta_per_mu_s" and "delta" in scene:
            return max(1, round(scene.get("mu_s", 1) / scene["delta"]))
        return scene.get(knob.option)

    def _in_use(self, knob: Knob) -> bool:
        return not knob.choices or any(self.choices[choice] in words for choice, words in knob.choices.items())

    def _turned(self, knob: Knob) -> bool:
        """Whether the slider counts rather than the options file: it was moved, or chosen by a word that has it."""
        chosen = {choice for choice, words in knob.choices.items() if self.choices[choice] in words}
        return "options_file" not in self.options or bool(self.moved & {knob.option, *chosen})

    def _show_knobs(self) -> None:
        """Sliders that the choices leave no use for are hidden; the others follow one another and show their value."""
        shown = 0
        for knob in self.knobs:
            slider, used = self.sliders[knob.option], self._in_use(knob)
            slider.ax.set_visible(used)
            slider.set_active(used)
            slider.valtext.set_text(f"{knob.at(slider.val):g}")
            column, row = divmod(shown, KNOBS_BELOW)
            slider.ax.set_position((0.46 + 0.28 * column, 0.31 - 0.045 * row, 0.19, 0.03))
            shown += used

    # From knobs to the program

    def scene(self) -> dict[str, Any]:
        """Options of the program that the knobs stand for."""
        scene: dict[str, Any] = {}
        for option, value in self.choices.items():
            if option in self.moved or value != self.offered[option][0] and value in self.offered[option]:
                scene[option] = value
        for knob in self.knobs:
            if self._in_use(knob) and self._turned(knob):
                scene[knob.option] = knob.at(self.sliders[knob.option].val)
        # mu_s stays on a noise level, so that pictures follow it without steps.
        steps = scene.pop("delta_per_mu_s", None)
        mu_s, by_steps = (knob for knob in self.knobs if knob.option in ("mu_s", "delta_per_mu_s"))
        if self._in_use(by_steps) and (steps or "mu_s" in scene):
            mu_s, steps = (knob.at(self.sliders[knob.option].val) for knob in (mu_s, by_steps))
            scene |= {"delta_per_mu_s": steps} if self.by_steps else {"delta": mu_s / steps}
        return scene

    def turn(self, option: str) -> None:
        """A slider was moved."""
        self.moved.add(option)
        self._show_knobs()
        self.ask()

    def choose(self, option: str, value: str) -> None:
        """A choice was made."""
        self.moved.add(option)
        self.choices[option] = value
        self._show_knobs()
        self.ask()

    def ask(self) -> None:
        """Have the model computed; what was being computed is ended."""
        self.asked_at = time.monotonic()
        scene = self.scene()
        self.show("computing " + "  ".join(f"{name} = {value}" for name, value in scene.items()))
        self.solver.ask({**self.options, **scene})

    def show(self, text: str, color: str = "black") -> None:
        """The line at the bottom."""
        self.status.set_color(color)
        self.status.set_text(text if len(text) < 150 else text[:147] + "...")
        self.figure.canvas.draw_idle()

    # From results to pictures

    def poll(self) -> bool:
        """Draw what has arrived for the newest parameters; whether there was any."""
        news = False
        while not self.solver.results.empty():
            number, part, found = self.solver.results.get()
            if number != self.solver.number:
                continue
            news = True
            if isinstance(found, Exception):
                self.show(str(found).splitlines()[0], REFUSED)
                continue
            if part == 0:
                self._draw_distribution(found)
                self.show("computing the spectrum and durations")
            else:
                self._draw_dynamics(found)
                self.show(f"{time.monotonic() - self.asked_at:.2f} s")
        return news

    def _draw_distribution(self, found: Results) -> None:
        density = found.density.by_force()
        v, x = density.window(LEAST), density.x
        edges = cells_around(x)
        steps = numpy.diff(edges)
        likely = numpy.flatnonzero(density.marginal_x > LEAST * density.marginal_x.max())
        low, high = edges[likely[0]], edges[likely[-1] + 1]
        rows = numpy.searchsorted(edges, numpy.linspace(low, high, ROWS)) - 1  # of the level at each height
        picture = numpy.maximum(density.at(v) / steps[:, None], 0)
        self.image.set_data(picture[numpy.clip(rows, 0, len(x) - 1)])
        self.image.set_extent((v[0], v[-1], low, high))
        self.image.set_clim(0, picture.max())
        held = density.at_rest > 0
        self.held.set_data(numpy.zeros(held.sum()), x[held])
        self.density.set(xlim=(v[0], v[-1]), ylim=(low, high))
        marginal = density.marginal(v)
        self.curve_v.set_data(v, marginal)
        self.by_v.set_ylim(0, 1.05 * marginal.max())
        self.by_v.title.set_text(f"at rest with probability {density.mass_at_rest:.4g}")
        self.stairs_x.set_data(density.marginal_x / steps, edges)
        self.stairs_rest.set_data(density.at_rest / steps, edges)
        self.by_x.set_xlim(0, 1.05 * (density.marginal_x / steps).max())
        self.words.set_text("\n".join(f"{key:<11} {found[key].value:>10.6g} +- {found[key].error:.0e}" for key in (
            "P_stick", "mean_stick", "mean_slide", "E_V2", "E_absV", "E_V")))

    def _draw_dynamics(self, found: Results) -> None:
        for axes, keys in ((self.spectrum, ("S_v",)), (self.durations, ("f_stick", "f_slide"))):
            for key in keys:
                result = found[key]
                self.curves[key].set_data(result.abscissa, result.value)
                old = self.bands.pop(key, None)
                if old:
                    old.remove()
                self.bands[key] = axes.fill_between(result.abscissa, result.value - result.error,
                                                    result.value + result.error, alpha=0.3, linewidth=0,
                                                    color=self.curves[key].get_color())
            shown = numpy.concatenate([found[key].value for key in keys])
            if (shown > 0).any():
                high = shown.max()
                axes.set_ylim(max(high * SHOWN, shown[shown > 0].min() / 2), 2 * high)
            axes.set_xlim(result.abscissa[0], result.abscissa[-1])

    # Files

    def save_scene(self) -> str:
        """Write the parameters as an options file of the program; returns where."""
        path = free_name(self.folder / "explored.opts")
        given = self.options.get("options_file")
        text = pathlib.Path(given).read_text() + "\n# changed since\n" if given else ""
        for name, value in self.scene().items():
            text += f"-{name} {value}\n"
        path.write_text(text)
        return f"saved {path}"

    def save_picture(self, ending: str) -> str:
        """Save the figure without its knobs; returns where."""
        path = free_name(self.folder / f"explored.{ending}")
        knobs = [axes for axes in self.figure.axes if axes not in (
            self.density, self.by_v, self.by_x, self.spectrum, self.durations) and axes.get_visible()]
        for part in (*knobs, self.status):
            part.set_visible(False)
        self.figure.savefig(path, dpi=150)
        for part in (*knobs, self.status):
            part.set_visible(True)
        return f"saved {path}"


def free_name(path: pathlib.Path) -> pathlib.Path:
    """The path, or with a number where it is taken: nothing is overwritten."""
    number, found = 1, path
    while found.exists():
        number += 1
        found = path.with_name(f"{path.stem}-{number}{path.suffix}")
    return found


def use_backend(browser: bool, port: int) -> None:
    """Choose a window, or a page in the browser, whose address Matplotlib prints."""
    matplotlib = needed("matplotlib")
    if not browser and (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        needed("tkinter")
        matplotlib.use("TkAgg")
        return
    needed("tornado")
    matplotlib.rcParams |= {"webagg.address": ADDRESS, "webagg.port": port, "webagg.open_in_browser": browser}
    matplotlib.use("WebAgg")


def explore(file: pathlib.Path | None, accuracy: float = 1e-4, browser: bool = False, port: int = 8988) -> None:
    """Show the explorer until it is closed.

    Parameters
    ----------
    file
        Options file to start from.
    accuracy
        Of all runs.
    browser
        A page of `port` in the browser instead of a window.

    Raises
    ------
    BadInput, ProgramError
        If the program does not take the options.
    """
    options: dict[str, Any] = {"options_file": file} if file else {}
    options["accuracy"] = accuracy  # behind the file, whose own accuracy does not count
    scene: Mapping[str, Any] = {}
    if file:
        found = run(**options, **FIRST)
        if isinstance(found, Sweep):
            raise BadInput(f"{file} is a sweep; leave the options -sweep_... out")
        scene = {**found.options, **found.scene}
    use_backend(browser, port)
    pyplot = needed("matplotlib.pyplot")
    figure = pyplot.figure("stickslip", figsize=(13, 8))
    explorer = Explorer(figure, options, scene)
    timer = figure.canvas.new_timer(POLL)
    timer.add_callback(lambda: explorer.poll() or True)  # Matplotlib drops what returns False
    timer.start()
    try:
        pyplot.show()
    finally:
        explorer.solver.close()
