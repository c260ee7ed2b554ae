"""python3 -m stickslip plot FILE... [PICTURE.png]: draws what files of the program hold."""

import argparse
import pathlib
import sys
from collections.abc import Sequence

TEXT = """Draws what the program wrote to FILE: HDF5, the JSON of -summary, or CSV. Without PICTURE the picture goes
next to the file, under its name. A file that holds several kinds of results makes a picture of each, with the kind in
its name. A sweep makes a picture of each result, in the folder PICTURE/. Several files share a picture. Prints where
the pictures are. Exit status 2 if there is nothing to draw."""


def main(words: Sequence[str] | None = None) -> int:
    """The command line; returns the exit status."""
    parser = argparse.ArgumentParser(prog="python3 -m stickslip", description=__doc__)
    plot = parser.add_subparsers(required=True, metavar="plot").add_parser(
        "plot", usage="%(prog)s [--kind KIND] FILE... [PICTURE.png]", description=TEXT)
    plot.add_argument("files", nargs="+", type=pathlib.Path, metavar="FILE")
    plot.add_argument("--kind", help="one picture, such as correlation_time, or drift of a sweep of the bias")
    return plot_files(parser.parse_args(words))


def plot_files(arguments: argparse.Namespace) -> int:
    """Draws; returns the exit status."""
    try:
        from . import load, plots
        *files, last = arguments.files
        picture = last if files and last.suffix not in (".h5", ".hdf5", ".csv", ".json") else None
        files = files if picture else [*files, last]
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
