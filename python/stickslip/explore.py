"""Turn a knob and watch the stationary distribution move: sliders over the model parameters, pictures that follow."""

import os
import pathlib
import re
import textwrap
import time
from collections.abc import Callable, Mapping
from typing import Any

from .calls import run
from .cases import Worker
from .knobs import Knob, carried, choices, knobs, starts
from .live_pictures import NUMBERED, PICTURES, PLACES, LivePictures
from .needed import needed
from .partial_drawing import Regions
from .plots.fields import SLIDE
from .newest import SLOW, PARTS, Solver, asked
from .program import BadInput, ProgramError
from .results import Results
from .sweeps import Sweep

TITLE = "stickslip explorer"
ADDRESS = "127.0.0.1"  # of the page: this machine alone
OWN_PAGE = f"""
addEventListener("DOMContentLoaded", () => {{
  document.title = "{TITLE}";
  document.head.insertAdjacentHTML("beforeend", "<style>.mpl-toolbar, .ui-dialog-titlebar {{display: none !important}}</style>");
}});
"""
POLL = 20  # milliseconds between looks for new results
PATIENCE = 0.5  # seconds for which pictures of other parameters than those of the sliders are not greyed
LONGEST = 100  # characters of the line at the bottom, which are clear of the buttons
REFUSED = "#b00000"
OUT_OF_USE = "#aaaaaa"
KNOBS_BELOW = 6  # one another
FIGURE = (13, 8)  # inches
PAGE, WINDOW = 80, 100  # points an inch: a page of 640 pixels, as a screen of 800 has bars; at most, of a window
BARS = 140  # pixels of a screen beside the figure of a window
REGIONS = {**PLACES, "knobs": (0.33, 0.05, 1, PLACES["distribution"][1]), "status": (0, 0, 0.59, 0.05)}


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
        self.pictures = LivePictures(figure)
        self.regions = Regions(figure, REGIONS)
        self.knobs, self.offered = {knob.option: knob for knob in knobs()}, choices()
        self.sliders: dict[str, Any] = {}
        self.radios: dict[str, Any] = {}
        self.choices: dict[str, str] = {}
        self._begun: dict[str, str] = {}  # choices at first
        self.moved: set[str] = set()  # knobs and choices that the user turned
        self._beside: dict[str, dict[str, tuple[float, float]]] = {}  # by choice what its word moved: from, to
        self.note = ""  # what the last choice moved
        self.by_steps = bool(scene.get("delta_per_mu_s"))  # in the file, which then has no delta
        self.stated = {option for option in self.knobs if isinstance(scene.get(option), (int, float))}
        self.asked_at, self.problem = 0.0, ""
        self._late: set[int] = set()  # parts that show other parameters than the sliders do, and are not grey
        self._lay_out(scene)
        self._show_knobs()
        self.solver.start()
        self.ask()

    # Layout

    def _lay_out(self, scene: Mapping[str, Any]) -> None:
        widgets = needed("matplotlib.widgets")
        for option, knob in self.knobs.items():
            axes = self.figure.add_axes((0, 0, 1, 1), label=option)
            label = textwrap.fill(knob.label.replace(" $", "\N{NO-BREAK SPACE}$"), 38)  # the symbol not alone
            slider = widgets.Slider(axes, label, knob.place(knob.low), knob.place(knob.high), color=SLIDE,
                                    valinit=knob.place(self._start(knob, scene)), initcolor="none")
            slider.drawon = False  # all of them are drawn at once
            for text in (slider.label, slider.valtext):
                text.set_fontsize(8.5)
            slider.label.set_x(-0.06)  # clear of the handle
            slider.on_changed(lambda _, option=option: self.turn(option))
            self.sliders[option] = slider
        top, bottom, rest = 0.374, 0.052, 0.018  # above the status
        words = {option: [*values, *{str(scene.get(option, values[0]))}.difference(values)]
                 for option, values in self.offered.items()}
        room = (top - bottom - (rest + 0.006) * len(words)) / max(1, sum(map(len, words.values())))
        for option, values in words.items():
            value = str(scene.get(option, values[0]))
            self.choices[option] = self._begun[option] = value
            height = rest + min(0.0225, room) * len(values)
            place = self.figure.add_axes((0.225, top - height, 0.1, height))
            top -= height + 0.006
            place.annotate(option, (1, 1), (-4, -4), "axes fraction", "offset points", ha="right", va="top", fontsize=8,
                           color="gray")
            self.radios[option] = radio = widgets.RadioButtons(place, values, values.index(value), activecolor=SLIDE)
            for text in radio.labels:
                text.set_fontsize(8.5)
            for circle in place.patches:  # of older versions of Matplotlib, stretched with the axes
                circle.set(width=0.08, height=0.08 * 0.1 * FIGURE[0] / (height * FIGURE[1]))
            radio.on_clicked(lambda chosen, option=option: self.choose(option, chosen))
        self.buttons = []  # widgets without a reference are dead
        for n, (label, act) in enumerate((("start again", self.restart), ("save options", self.save_scene),
                                          ("save PNG", lambda: self.save_picture("png")),
                                          ("save PDF", lambda: self.save_picture("pdf")))):
            button = widgets.Button(self.figure.add_axes((0.595 + 0.1 * n, 0.008, 0.093, 0.035)), label)
            button.label.set_fontsize(9)
            button.on_clicked(lambda _, act=act: act())
            self.buttons.append(button)
        self.status = self.figure.text(0.012, 0.018, "", fontsize=9)
        self.complaint = self.figure.text(0, 0, "", fontsize=8.5, color=REFUSED, zorder=10, bbox={
            "facecolor": "white", "edgecolor": REFUSED, "boxstyle": "round"}, visible=False)

    def _start(self, knob: Knob, scene: Mapping[str, Any]) -> float:
        if knob.option == "delta_per_mu_s" and "delta" in scene:
            return max(1, round(scene.get("mu_s", 1) / scene["delta"]))
        given = scene.get(knob.option)
        if isinstance(given, (int, float)):
            return given
        return knob.low if knob.start is None else knob.start

    def _counts(self, knob: Knob) -> bool:
        """Whether the model has the value of the slider; without, the option is left out."""
        return knob.in_use(self.choices) and (knob.start is not None or knob.option in self.stated | self.moved)

    def _turned(self, knob: Knob) -> bool:
        """Whether the slider counts rather than the options file: it was moved, or chosen by a word that has it."""
        return "options_file" not in self.options or bool(self.moved & {knob.option, *knob.owners(self.choices)})

    def _show_knobs(self) -> None:
        """Sliders that the choices leave no use for are hidden; the others follow one another and show their value."""
        shown = 0
        for option, knob in self.knobs.items():
            slider, used, counts = self.sliders[option], knob.in_use(self.choices), self._counts(knob)
            slider.ax.set_visible(used)
            slider.set_active(used)
            slider.valtext.set_text(f"{self.value(option):g}" if counts else "not given")
            slider.valtext.set_color("black" if counts else OUT_OF_USE)
            slider.label.set_color("black" if counts else OUT_OF_USE)
            column, row = divmod(shown, KNOBS_BELOW)
            slider.ax.set_position((0.5 + 0.335 * column, 0.339 - 0.052 * row, 0.11, 0.03))
            shown += used
        self.regions.draw("knobs")

    # From knobs to the program

    def value(self, option: str) -> float:
        """The value of a slider."""
        return self.knobs[option].at(self.sliders[option].val)

    def scene(self) -> dict[str, Any]:
        """Options of the program that the knobs stand for."""
        scene: dict[str, Any] = {}
        for option, value in self.choices.items():
            if option in self.moved or value != self.offered[option][0] and value in self.offered[option]:
                scene[option] = value
        for option, knob in self.knobs.items():
            if self._counts(knob) and self._turned(knob):
                scene[option] = self.value(option)
        # mu_s stays on a noise level, so that pictures follow it without steps.
        steps = scene.pop("delta_per_mu_s", None)
        if self._counts(self.knobs["delta_per_mu_s"]) and (steps or "mu_s" in scene):
            mu_s, steps = (self.value(option) for option in ("mu_s", "delta_per_mu_s"))
            scene |= {"delta_per_mu_s": steps} if self.by_steps else {"delta": mu_s / steps}
        return scene

    def _place(self, option: str, value: float) -> None:
        """Move a slider as if the user did not."""
        slider = self.sliders[option]
        slider.eventson = False
        slider.set_val(self.knobs[option].place(value))
        slider.eventson = True

    def turn(self, option: str) -> None:
        """A slider was moved; what cannot stay beside it moves along."""
        self.note = ""
        self.moved.add(option)
        friction = {name: self.value(name) for name in ("mu_s", "mu_d", "mu_s_minus", "mu_d_minus")
                    if self._counts(self.knobs[name])}
        for other, value in carried(option, friction).items():
            self._place(other, value)
            self.moved.add(other)
        self._follow()

    def choose(self, choice: str, word: str) -> None:
        """A choice was made; what the user has not moved starts with values that work."""
        before, self.choices[choice], self.note = self.choices[choice], word, ""
        self.moved.add(choice)
        for option, (was, became) in self._beside.pop(choice, {}).items():
            if self.value(option) == became:  # the user left it there
                self._place(option, was)
                self.moved.discard(option)
                self.note = f"{option} = {was:g} again, as before {before};  "
        friction = self.value("mu_s"), self.value("mu_d")
        for option, value in starts(choice, word, list(self.knobs.values()), *friction).items():
            if option not in self.moved:
                was = self.value(option)
                self._place(option, value)
                if not self.knobs[option].choices:  # a word does not have it, so that a file could
                    self.moved.add(option)
                    self._beside.setdefault(choice, {})[option] = was, self.value(option)
                    self.note = f"{option} = {self.value(option):g}, with which {word} lets bodies stick and slide;  "
        self._follow()

    def restart(self) -> None:
        """Set all sliders and choices to where they began."""
        for option, radio in self.radios.items():
            words = [label.get_text() for label in radio.labels]
            radio.set_active(words.index(self._begun[option]))
        for option, slider in self.sliders.items():
            self._place(option, self.knobs[option].at(slider.valinit))
        self.moved.clear()
        self._beside.clear()
        self.note = ""
        self._follow()

    def _follow(self) -> None:
        """Show the knobs as they are now, and have the model computed."""
        with self.regions.together():
            self._show_knobs()
            self.ask()

    def ask(self) -> None:
        """Have the model computed; what was being computed is ended."""
        self.asked_at, self._late = time.monotonic(), set(range(len(PARTS)))
        scene = self.scene()
        self.show("computing " + "  ".join(f"{name} = {value}" for name, value in scene.items()))
        self.solver.ask({**self.options, **scene})

    def show(self, text: str, color: str = "black") -> None:
        """The line at the bottom."""
        self.status.set_color(color)
        self.status.set_text(textwrap.shorten(text, LONGEST, placeholder=" ..."))
        self.regions.draw("status")

    def refuse(self, text: str) -> None:
        """Say why there is no result: beside the slider of the option that the program names, and in the bottom line."""
        for line in text.splitlines():
            word = re.match(r"-(\w+) = ", line)
            option = {"delta": "delta_per_mu_s"}.get(word[1], word[1]) if word else ""
            if option in self.knobs and self.knobs[option].in_use(self.choices):
                box = self.sliders[option].ax.get_position()
                above = box.y0 < 0.2
                self.complaint.set(position=(min(box.x0 - 0.1, 0.62), box.y1 + 0.01 if above else box.y0 - 0.01),
                                   text=textwrap.fill(line, 70), visible=True,
                                   verticalalignment="bottom" if above else "top")
                for part in (self.sliders[option].valtext, self.sliders[option].label):
                    part.set_color(REFUSED)
                self.regions.draw("knobs")
                break
        self.problem = text.splitlines()[0]
        self.show(self.problem, REFUSED)

    # From results to pictures

    def poll(self) -> bool:
        """Draw the next part that has arrived for the newest parameters; whether there was one."""
        with self.regions.together():
            news = self.solver.next_result()
            if news:
                self._take(*news)
            if self._late and time.monotonic() - self.asked_at > PATIENCE:
                self._grey(self._late)
        return news is not None

    def _take(self, part: int, found: Results | Exception) -> None:
        """Show results of a part, or how long they will take, or why there are none."""
        if not isinstance(found, Exception) and not found:  # a plan
            if not self.problem and found.plan["seconds"] > SLOW:
                self.show(f"computing {PARTS[part][0]}, about {found.plan['seconds']:.0f} s; a slider that is moved ends it")
            return
        if isinstance(found, Exception):
            self._grey(set(range(len(PARTS))) if part == 0 else {part})
            self.refuse(str(found))
            return
        if part == 0:
            self.problem = ""
            if self.complaint.get_visible():
                self.complaint.set_visible(False)
                self.regions.draw("knobs")
        self.pictures.draw(part, found)
        self._late.discard(part)
        self.regions.draw(PICTURES[part], *(["numbers"] if part in NUMBERED else []))
        if part + 1 < len(PARTS):
            self.show(f"computing {PARTS[part + 1][0]}")
        elif not self.problem:
            self.show(f"{self.note}{time.monotonic() - self.asked_at:.2f} s")

    def _grey(self, parts: set[int]) -> None:
        """Show that parts are not of the parameters that the sliders have."""
        self.pictures.veil(parts, True)
        self.regions.draw("numbers", *[PICTURES[n] for n in parts])
        self._late = self._late - parts

    # Files

    def save_scene(self) -> str:
        """Write the parameters as an options file of the program; returns where."""
        path = free_name(self.folder / "explored.opts")
        given = self.options.get("options_file")
        text = pathlib.Path(given).read_text() + "\n# changed since\n" if given else ""
        stated = {name: value for name, value in self.options.items() if name not in ("options_file", "accuracy")}
        for name, value in {**stated, **self.scene()}.items():
            text += f"-{name} {value}\n"
        path.write_text(text)
        return self._saved(path)

    def save_picture(self, ending: str) -> str:
        """Save the figure without its knobs; returns where."""
        path = free_name(self.folder / f"explored.{ending}")
        knobs = [slider.ax for slider in self.sliders.values()] + [
            widget.ax for widget in (*self.radios.values(), *self.buttons)]
        hidden = [part for part in (*knobs, self.status, self.complaint) if part.get_visible()]
        for part in hidden:
            part.set_visible(False)
        self.figure.savefig(path, dpi=200)
        for part in hidden:
            part.set_visible(True)
        return self._saved(path)

    def _saved(self, path: pathlib.Path) -> str:
        self.show(f"saved {path}")
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
    if not 0 < port < 2**16:
        raise BadInput(f"--port {port}: must be between 1 and {2**16 - 1}")
    if not browser and (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        needed("tkinter")
        try:
            needed("matplotlib.pyplot").switch_backend("TkAgg")
        except ImportError:  # by which Matplotlib says that it cannot open the display
            raise ProgramError(f"the display {os.environ.get('DISPLAY', '')} cannot be opened; --browser makes a page "
                               "in the place of the window") from None
        return
    needed("tornado")
    matplotlib.rcParams |= {"webagg.address": ADDRESS, "webagg.port": port, "webagg.open_in_browser": browser}
    matplotlib.use("WebAgg")
    manager = needed("matplotlib.backends.backend_webagg_core").FigureManagerWebAgg
    script = manager.get_javascript()  # the pages of Matplotlib have its own title, and bars with no use here
    manager.get_javascript = classmethod(lambda cls, stream=None: script + OWN_PAGE)


def fit_screen(figure: Any) -> None:
    """Make the figure of a window as large as the screen allows; a page stays as it is."""
    screen = getattr(getattr(figure.canvas.manager, "window", None), "winfo_screenheight", None)
    if screen:
        figure.set_dpi(max(PAGE, min(WINDOW, (screen() - BARS) // FIGURE[1])))
        figure.set_size_inches(FIGURE, forward=True)


def explore(file: pathlib.Path | None, accuracy: float = 1e-4, browser: bool = False, port: int = 8988,
            given: Mapping[str, Any] = {}) -> None:
    """Show the explorer until it is closed.

    Parameters
    ----------
    file
        Options file to start from.
    accuracy
        Of all runs; of curves at best `newest.OF_CURVES`.
    browser
        A page of `port` in the browser instead of a window.
    given
        Options of the program besides, which count more than those of the file.

    Raises
    ------
    BadInput, ProgramError
        If the program does not take the options.
    """
    options: dict[str, Any] = {"options_file": file} if file else {}
    options |= {**given, "accuracy": accuracy}  # behind the file, whose own accuracy does not count
    scene: Mapping[str, Any] = {}
    if not file and not given:
        run(**options, plan=True)  # which refuses an accuracy before there is a window
    else:
        found = run(**asked(options, 0))
        if isinstance(found, Sweep):
            raise BadInput(f"{file or 'this'} is a sweep; leave the options -sweep_... out")
        scene = {**found.options, **found.scene}
    use_backend(browser, port)
    pyplot = needed("matplotlib.pyplot")
    figure = pyplot.figure(TITLE, figsize=FIGURE, dpi=PAGE)
    fit_screen(figure)
    worker = Worker()  # which starts the program once
    explorer = Explorer(figure, options, scene, compute=worker.run)
    timer = figure.canvas.new_timer(POLL)
    timer.add_callback(lambda: explorer.poll() or True)  # Matplotlib drops what returns False
    timer.start()
    try:
        pyplot.show()
    finally:
        explorer.solver.close()
        worker.end()
