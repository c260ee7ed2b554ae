"""python3 -m stickslip plot FILE... [PICTURE.png]: draws what files of the program hold.
python3 -m stickslip explore [SCENE.opts]: sliders over the model parameters, pictures that follow.
python3 -m stickslip levels FILE: the levels of a measured force, for -noise file.
python3 -m stickslip force FILE: a measured force or acceleration, for -force_file.
python3 -m stickslip newmark FILE --yield 0.1g: a block that slides on shaking ground."""

import argparse
import dataclasses
import pathlib
import re
import shlex
import sys
import warnings
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .records import Record

TEXT = """Draws what the program wrote to FILE: HDF5, the JSON of -summary, or CSV. Without PICTURE the picture goes
next to the file, under its name. A file that holds several kinds of results makes a picture of each, with the kind in
its name. A sweep makes a picture of each result, in the folder PICTURE/. Several files share a picture. Prints where
the pictures are. PICTURE ends in .png, .svg or .pdf. Exit status 2 if there is nothing to draw."""

EXPLORE = """Sliders over the model parameters, choices of friction law, noise and drag. The stationary distribution with its
marginals, probabilities and mean durations with their errors, the power spectral density of the velocity and the
densities of durations follow. What the program refuses greys them, and is said beside the slider. Buttons save the
parameters as an options file, and the picture. In a window (python3-tk), or in a browser on this machine
(python3-tornado). Options of the program may follow, such as -mu_d 0.3 -drag none."""

LEVELS = """Makes the levels and jump rates, or the chain, of a measured force or acceleration, in any of the formats of
stickslip.read_record. Prints how the chain compares with the record, and the options
of the program that use it. Exit status 2 where such a chain cannot stand for the record."""


FORCE = """Writes a measured force or acceleration, in any of the formats of stickslip.read_record, as the CSV file that
-force_file takes. Accelerations in g, gal and the like become m/s^2. Prints what was
read, and the options of the program that use it. Without --output the file is FILE_force.csv in this folder."""

NEWMARK = """The sliding block of Newmark (1965) on ground that accelerates as FILE says, in any of the formats of
stickslip.read_record. Prints its displacement and its slips, and writes its path to FILE_newmark.csv and a picture to
FILE_newmark.png in this folder. Positive is the direction of positive accelerations."""


def main(words: Sequence[str] | None = None) -> int:
    """The command line; returns the exit status."""
    parser = argparse.ArgumentParser(prog="python3 -m stickslip", description=__doc__)
    commands = parser.add_subparsers(required=True, metavar="plot | explore | levels | force | newmark")
    plot = commands.add_parser(
        "plot", usage="%(prog)s [--kind KIND] FILE... [PICTURE | -o PICTURE]", description=TEXT)
    plot.add_argument("files", nargs="+", type=pathlib.Path, metavar="FILE")
    plot.add_argument("-o", "--output", type=pathlib.Path, metavar="PICTURE", help="PICTURE, in any place")
    plot.add_argument("--kind", help="one picture, such as correlation_time; of a sweep a key, such as P_stick, or drift")
    plot.set_defaults(act=plot_files)
    explore = commands.add_parser("explore", description=EXPLORE)
    explore.add_argument("scene", nargs="?", type=pathlib.Path, metavar="SCENE.opts", help="options file to start from")
    explore.add_argument("--accuracy", type=float, default=1e-4,
                         help="of the program (default 1e-4); curves are computed to 1e-3 at best")
    explore.add_argument("--browser", action="store_true", help="a page in the browser instead of a window")
    explore.add_argument("--port", type=int, default=8988, help="of that page (default 8988)")
    explore.set_defaults(act=explore_scene)
    levels = commands.add_parser("levels", description=LEVELS)
    _add_record(levels)
    levels.add_argument("--levels", type=int, help="how many (default: the most of 15 to 5 that can be counted)")
    levels.add_argument("--mu-s", type=float, help="static friction, which then lies halfway between two levels")
    levels.add_argument("--jumps", choices=("neighbours", "any"), default="neighbours", help="where jumps lead")
    levels.add_argument("--match-time", action=argparse.BooleanOptionalAction, help="multiply all rates by one number, with "
                        "which the chain has the correlation time of the record (default: unless levels are all its values)")
    levels.add_argument("--narrow-band", action="store_true", help="Gaussian noise of a narrow band in the place of levels")
    levels.add_argument("--filtered", action="store_true", help="filtered noise (Kanai and Tajimi) in the place of levels")
    levels.add_argument("--gaussian", action="store_true", help="Gaussian noise of several terms in the place of levels")
    levels.add_argument("--picture", type=pathlib.Path, help="autocovariance and spectrum of chain and record")
    levels.set_defaults(act=write_levels)
    force = commands.add_parser("force", description=FORCE)
    _add_record(force)
    force.add_argument("-o", "--output", type=pathlib.Path, metavar="CSV", help="the file to write")
    force.set_defaults(act=write_force)
    newmark = commands.add_parser("newmark", description=NEWMARK)
    _add_record(newmark)
    newmark.add_argument("--yield", required=True, dest="yield_acceleration", metavar="ACCELERATION",
                         help="at which the block starts to slide, such as 0.1g, or a number in the unit of the record")
    newmark.add_argument("--one-way", action="store_true", help="the block slides in the positive direction alone, as "
                         "downhill; the displacement of the record with its sign reversed is printed too")
    newmark.set_defaults(act=slide_block)
    words = list(sys.argv[1:] if words is None else words)
    given = taken_options(words) if words[:1] == ["explore"] else {}
    arguments = parser.parse_args(words, argparse.Namespace(given=given))
    return arguments.act(arguments)


def taken_options(words: list[str]) -> dict[str, str | bool]:
    """Takes the options of the program, such as -mu_d 0.3, out of a command line; returns their values by name."""
    given: dict[str, str | bool] = {}
    for at in [n for n, word in enumerate(words) if is_option(word)][::-1]:
        alone = at + 1 == len(words) or is_option(words[at + 1]) or words[at + 1].startswith("--")
        given[words[at][1:]] = True if alone else words.pop(at + 1)
        del words[at]
    return dict(reversed(given.items()))


def is_option(word: str) -> bool:
    """Whether a word is an option of the program: one of this command is a letter, or begins with two signs."""
    return re.fullmatch(r"-[A-Za-z]\w+", word) is not None


def _add_record(parser: argparse.ArgumentParser) -> None:
    """The arguments that say how a file of a record is read, and what is done to it."""
    parser.add_argument("file", type=pathlib.Path, metavar="FILE")
    parser.add_argument("--column", help="name of the values, or its number from 0")
    parser.add_argument("--channel", help='words of the name of a channel, such as "90 Deg", in the place of --column')
    parser.add_argument("--time", help="name of the times, or its number from 0")
    parser.add_argument("--vertical", help="name of vertical accelerations, or their number from 0, which change friction")
    parser.add_argument("--step", type=float, help="sampling interval in seconds, where the file has no times")
    parser.add_argument("--unit", help="of the values, such as g, gal or m/s^2, where the file does not say")
    parser.add_argument("--time-unit", help="of the times, such as ms, where the file does not say")
    parser.add_argument("--layout", choices=("columns", "rows", "pairs"),
                        help="of numbers without names: rows of samples, pairs of time and sample, or columns")
    parser.add_argument("--differentiate", action="store_true", help="take the acceleration of a velocity or displacement")
    parser.add_argument("--between", type=float, nargs=2, metavar=("BEGIN", "END"), help="take these times [s] alone")
    parser.add_argument("--centre", action="store_true", help="take the mean off")
    parser.add_argument("--fill", type=float, metavar="LONGEST",
                        help="join gaps of at most LONGEST seconds by straight lines")
    parser.add_argument("--rest", type=float, default=0, help="append so many seconds of no force")
    parser.add_argument("--scale", type=float, default=1, help="what values are multiplied by (default 1): -1 makes the "
                        "force on a body of the acceleration of the ground")


def _record_of(arguments: argparse.Namespace) -> "Record":
    """The record that `_add_record` describes."""
    from . import read_record

    def read(column: str | None, channel: str | None) -> "Record":
        return read_record(arguments.file, column=column, channel=channel, **{name: getattr(arguments, name) for name in (
            "time", "step", "unit", "time_unit", "layout", "differentiate")})

    record = read(arguments.column, arguments.channel)
    if arguments.vertical is not None:
        record = dataclasses.replace(record, vertical=read(arguments.vertical, None).value)
    record = record.between(*arguments.between) if arguments.between else record
    record = record.resampled(record.step, across=arguments.fill) if arguments.fill else record
    record = record.centred() if arguments.centre else record
    return (record if arguments.scale == 1 else record.scaled(arguments.scale)).rested(arguments.rest)


def _script(command: str) -> Callable[[], int]:
    """What the console script stickslip-COMMAND calls."""
    return lambda: main([command, *sys.argv[1:]])


explore_command, levels_command, force_command, newmark_command, plot_command = map(
    _script, ("explore", "levels", "force", "newmark", "plot"))


def explore_scene(arguments: argparse.Namespace) -> int:
    """Shows the window until it is closed; returns the exit status."""
    try:
        from . import BadInput, ProgramError
        from .explore import explore
        try:
            explore(arguments.scene, arguments.accuracy, arguments.browser, arguments.port, arguments.given)
        except (BadInput, ProgramError, OSError) as problem:
            print(f"stickslip: {problem}", file=sys.stderr)
            return 2 if isinstance(problem, BadInput) else 1
    except ImportError as problem:
        print(problem, file=sys.stderr)
        return 1
    return 0


def write_of_record(write: "Callable[[argparse.Namespace, Record], None]") -> Callable[[argparse.Namespace], int]:
    """A command that writes something of a record, with its messages and exit status."""
    def act(arguments: argparse.Namespace) -> int:
        try:
            write(arguments, _record_of(arguments))
        except (ValueError, OSError) as problem:
            print("stickslip:", re.sub(r'\b(column|channel|step|unit|time_unit|layout|rest)=("?)([\w./^]*)\2', as_option,
                                       str(problem)).replace("differentiate=True", "--differentiate"), file=sys.stderr)
            return 2
        except ImportError as problem:
            print(problem, file=sys.stderr)
            return 1
        return 0

    def as_option(found: re.Match) -> str:
        return f"--{found[1].replace('_', '-')} {found[3]}".rstrip()
    return act


@write_of_record
def write_levels(arguments: argparse.Namespace, record: "Record") -> None:
    """Writes the levels of a record, or its chain."""
    from . import noise
    print(record)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # the chain prints them
        kinds = {name: getattr(noise, f"{name}_of") for name in ("narrow_band", "filtered", "gaussian")}
        fit = next((kinds[name] for name in kinds if getattr(arguments, name)), None)
        chain = fit(record) if fit else noise.record(
            record, arguments.levels, mu_s=arguments.mu_s, jumps=arguments.jumps, match_time=arguments.match_time)
    print(chain)
    states, rates, levels = (f"{arguments.file.stem}_{what}.csv" for what in ("states", "rates", "levels"))
    if fit:
        print(" ".join(f"-{name} {shlex.quote(str(value))}" for name, value in chain.options.items()))
    elif chain.neighbours_only:
        chain.save(levels)
        print(f"-noise file -noise_file {levels}")
    else:
        chain.save(states, rates)
        print(f"-noise chain -noise_states {states} -noise_rates {rates}")
    if arguments.picture:
        chain.plot().savefig(arguments.picture)
        print(arguments.picture)


@write_of_record
def write_force(arguments: argparse.Namespace, record: "Record") -> None:
    """Writes the file of -force_file."""
    place = arguments.output or pathlib.Path(f"{arguments.file.stem}_force.csv")
    if len(record.gaps):
        begin, end = record.longest_gap
        raise ValueError(f"{arguments.file}: samples are missing in {len(record.gaps)} gaps; --fill "
                         f"{end - begin:g} joins them by straight lines, --between takes a part without them")
    record.save(place)
    print(record, f"-quantities given_force -force_file {place}", sep="\n")


@write_of_record
def slide_block(arguments: argparse.Namespace, record: "Record") -> None:
    """Slides a block under a record, or its reverse too where it slides one way."""
    from .sliding_block import newmark, table
    path, picture = (f"{arguments.file.stem}_newmark.{ending}" for ending in ("csv", "png"))
    found = newmark(record, arguments.yield_acceleration, arguments.one_way, trajectory=path)
    print(record, table(found), sep="\n")
    if arguments.one_way:
        reverse = newmark(record.scaled(-1), arguments.yield_acceleration, True)
        print("with the sign of the record reversed:", reverse["final_displacement"])
    found.plot(picture)
    print(path, picture, sep="\n")


def plot_files(arguments: argparse.Namespace) -> int:
    """Draws; returns the exit status."""
    try:
        from . import load, plots
        *files, last = arguments.files
        picture = arguments.output
        if picture or not files or last.suffix in (".h5", ".hdf5", ".csv", ".json"):
            files = [*files, last]
        else:
            picture = last
        try:
            drawn = plots.drawn([load(file) for file in files], picture or files[0].with_suffix(".png"), arguments.kind)
        except (ValueError, OSError) as problem:
            text = str(problem)
            named = text if any(str(file) in text for file in arguments.files) else f"{files[0]}: {text}"
            print(f"stickslip: {named}", file=sys.stderr)
            return 2
    except ImportError as problem:
        print(problem, file=sys.stderr)
        return 1
    for _, _, place in drawn:
        print(place)
    return 0


if __name__ == "__main__":
    sys.exit(main())
