"""Draws a file of the program by the script that fits what is in it.

usage: python3 draw.py FILE.h5|FILE.csv [PICTURE.png]

Without PICTURE.png the picture goes next to the file, under its name. A file that holds several kinds of
results makes a picture of each, with the kind in its name. A sweep makes a picture of each scalar, in the
folder PICTURE/. Prints where the pictures are. Exit status 2 if there is nothing to draw.
"""

import csv
import pathlib
import subprocess
import sys

import h5py

HERE = pathlib.Path(__file__).resolve().parent
# Script and where its data are; of a study also the kind.
HDF5 = (("density", "density"), ("trajectory", "trajectory"), ("sweep", "sweep"),
        ("comparison", "comparison"), ("spectra", "results/S_v"), ("durations", "results/f_slide"),
        ("slips", "results/cdf_slip"), ("slips", "results/P_peak"), ("slips", "results/displacement_variance"),
        ("cost", "study"))
FORMATS = (".png", ".pdf", ".svg")
ASK = ("ask the program for density, trajectory, spectrum with -omega, duration_density, slip with "
       "-distance, peak or displacement with -quantities; or for -compare, -study cost or a sweep")


def refuse(words):
    print(f"draw.py: {words}", file=sys.stderr)
    sys.exit(2)


def kinds_of_hdf5(name):
    with h5py.File(name) as file:
        if "record/options" not in file:
            refuse(f"{name}: no file of this program: it has no record/options")
        found = list(dict.fromkeys(script for script, path in HDF5 if path in file))
        if "cost" in found and file["study"].attrs["kind"] != "cost":
            found.remove("cost")
    return found


def kinds_of_csv(name):
    with open(name, newline="", errors="replace") as file:
        head = next(csv.reader(file), [])
    return (["trajectory"] if head == ["time", "x", "y", "v"] else
            ["sweep"] if head[-1:] == ["status"] else [])


def kinds(name):
    """Scripts for what is in the file."""
    try:
        found = kinds_of_csv(name) if name.suffix == ".csv" else kinds_of_hdf5(name)
    except FileNotFoundError:
        refuse(f"{name}: no such file; the program writes it with -output {name}")
    except (OSError, csv.Error) as problem:
        refuse(f"{name}: cannot be read as {'CSV' if name.suffix == '.csv' else 'HDF5'}: "
               f"{str(problem).splitlines()[0]}")
    if not found:
        refuse(f"{name}: nothing to draw; {ASK}")
    return found


def run(script, *words):
    done = subprocess.run([sys.executable, str(HERE / f"{script}.py"), *map(str, words)])
    if done.returncode != 0:
        sys.exit(done.returncode)


def draw(name, found, picture):
    for kind in found:
        if kind == "sweep":  # prints its pictures itself
            run(kind, name, "-o", picture.with_suffix(""))
            continue
        place = picture if len(found) == 1 else picture.with_stem(f"{picture.stem}_{kind}")
        run(kind, name, place)
        print(place)


def main():
    words = sys.argv[1:]
    if words in (["-h"], ["--help"]):
        print(__doc__)
        return
    if len(words) not in (1, 2):
        refuse("wants a file and perhaps a picture: draw.py FILE.h5|FILE.csv [PICTURE.png]")
    name = pathlib.Path(words[0])
    found = kinds(name)
    picture = pathlib.Path(words[1]) if len(words) == 2 else name.with_suffix(".png")
    if picture.suffix not in FORMATS:
        refuse(f"{picture}: a picture ends in {', '.join(FORMATS)}")
    if not picture.parent.is_dir():
        refuse(f"{picture}: its folder does not exist; make the folder first")
    draw(name, found, picture)


if __name__ == "__main__":
    main()
