"""What the pictures share: reading the program's HDF5 files, running it, and the look."""

import argparse
import pathlib
import subprocess
import sys
import tempfile

import h5py
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy

# Told apart by the colour-blind (Okabe and Ito), and in grey together with the line styles.
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#222222")
STYLES = ("-", "--", "-.", (0, (1, 1.2)), (0, (5, 1.5, 1, 1.5, 1, 1.5)))

plt.rcParams.update({"figure.facecolor": "white", "axes.grid": True, "grid.color": "#e4e4e4",
                     "axes.axisbelow": True, "legend.frameon": False, "font.size": 9})

ASKED_BY = {  # what computes a dataset
    "S_v": "-quantities spectrum -omega 1e-3:50:200:log",
    "t_corr": "-quantities spectrum",
    "f_slide": "-quantities duration_density -time 0:0.1:201",
    "density": "-quantities density",
    "trajectory": "-quantities trajectory -horizon 100",
    "comparison": "-compare FILE",
    "study": "-study cost",
    "sweep": "-sweep_mu_d 0.1:1:10",
}
ASKED_BY["f_stick"] = ASKED_BY["f_excursion"] = ASKED_BY["f_slide"]


class File:
    """One HDF5 file of the program; what is missing ends the script with the way to get it."""

    def __init__(self, name):
        try:
            self.file = h5py.File(name)
        except FileNotFoundError:
            sys.exit(f"{name}: no such file; the program writes it with -output {name}")
        except OSError:
            sys.exit(f"{name}: not an HDF5 file")
        self.name = name
        self.options = dict(self._get("record/options", "a run of the program").attrs)

    def _get(self, path, asked_by):
        if path not in self.file:
            sys.exit(f"{self.name} has no {path}; it comes from {asked_by}")
        return self.file[path]

    def group(self, name):
        """Every dataset of a group by name."""
        found = self._get(name, ASKED_BY[name])
        return {key: numpy.array(value) for key, value in found.items()}

    def groups(self, name):
        """Every group of a group, with its datasets by name."""
        found = self._get(name, ASKED_BY[name])
        return {key: {part: values[part][:] for part in values} for key, values in found.items()}

    def unit(self, key):
        return str(self.file[f"results/{key}"].attrs.get("unit", ""))

    def is_scalar(self, key):
        return self.file[f"results/{key}/value"].ndim == 0

    def value(self, key):
        return self._get(f"results/{key}", ASKED_BY[key])["value"][()]

    def curve(self, key, abscissa):
        result = self._get(f"results/{key}", ASKED_BY[key])
        return result[abscissa][:], result["value"][:]

    def number(self, option):
        return float(self.options[option])

    def step(self):
        """Distance of the noise levels; none where these are given one by one."""
        return self.number("delta") if self.options.get("noise", "ou") == "ou" else None

    def memory(self):
        """The noise in words, without its step; TeX."""
        noise = self.options.get("noise", "ou")
        if noise == "telegraph":
            a, rate = self.number("telegraph_amplitude"), self.number("telegraph_rate")
            return rf"$a$ = {a:g}, $\kappa$ = {rate:g}"
        if noise == "file":
            return f"levels of {pathlib.Path(str(self.options['noise_file'])).name}"
        deviation = self.options.get("noise_deviation")
        given = rf", $\sigma$ = {float(deviation):g}" if deviation else ""
        return rf"$\tau$ = {power_of_two(self.number('tau'))}{given}"

    def noise(self):
        """The noise in words; TeX."""
        step = self.step()
        return self.memory() + (rf", $\delta$ = {power_of_two(step)}" if step else "")

    def drag(self):
        """b(v) in words."""
        law = str(self.options["drag"])
        if law == "expression":
            return str(self.options["drag_expression"])
        linear = "v" if self.number("drag_coefficient") == 1 else "c v"
        return {"none": "0", "linear": f"-{linear}"}.get(law, f"-{linear} - c_3 v^3")


def power_of_two(x):
    """1, 1/2, 1/4, ... as fractions, the rest as decimals; TeX."""
    denominator = round(1 / x) if 0 < x <= 1 else 0
    exact = denominator & (denominator - 1) == 0 and denominator * x == 1
    return f"1/{denominator}" if exact and denominator > 1 else f"{x:g}"


def written_by(program, scenes, folder):
    """Runs the program for each scene; the files it wrote, in `folder` under speaking names."""
    names = []
    for scene in scenes:
        told = {key: value for key, value in scene.items() if key not in ("quantities", "omega")}
        name = folder / ("_".join(f"{key}-{value:g}" if isinstance(value, (int, float)) else
                                  f"{key}-{value}" for key, value in told.items()) + ".h5")
        words = [str(program), "-output", str(name)]
        for key, value in scene.items():
            words += ["-" + key, str(value)]
        print(" ".join(words[3:]), file=sys.stderr)
        try:
            done = subprocess.run(words, capture_output=True, text=True)
        except OSError as problem:
            sys.exit(f"{program} does not run: {problem.strerror}")
        if done.returncode not in (0, 3):
            sys.exit(f"{' '.join(words)}\n{done.stderr}")
        if done.returncode == 3:
            print("  accuracy not reached", file=sys.stderr)
        names.append(name)
    return names


def files(arguments, scenes):
    """Those named, or those of the scenes that --run computes (kept where --keep says)."""
    if bool(arguments.files) == bool(arguments.run):
        sys.exit("name the files to draw, or --run PROGRAM to compute them")
    if arguments.files:
        return [File(name) for name in arguments.files]
    if arguments.keep:
        arguments.keep.mkdir(parents=True, exist_ok=True)
        return [File(name) for name in written_by(arguments.run, scenes, arguments.keep)]
    with tempfile.TemporaryDirectory() as folder:
        names = written_by(arguments.run, scenes, pathlib.Path(folder))
        return [File(name) for name in names]


def one_file(arguments, reason):
    """The name of the only file; a picture of several makes no sense for that reason."""
    if len(arguments.files) != 1:
        sys.exit(f"one file, please: {reason}")
    return arguments.files[0]


def arguments_of(doc, scenes=False):
    """FILE.h5... PICTURE.png, and where the script has scenes of its own --run and --keep."""
    parser = argparse.ArgumentParser(description=doc, usage=argparse.SUPPRESS,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="*" if scenes else "+", metavar="FILE.h5")
    parser.add_argument("picture", metavar="PICTURE.png")
    if scenes:
        parser.add_argument("--run", metavar="PROGRAM", type=pathlib.Path,
                            help="compute the scenes of the paper with this program")
        parser.add_argument("--keep", metavar="FOLDER", type=pathlib.Path,
                            help="with --run: leave the files here")
    return parser.parse_args()
