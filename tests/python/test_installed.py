"""The Python package as pip installs it into a virtual environment."""

import importlib.util
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

SOURCES = pathlib.Path(__file__).resolve().parents[2]
BINARIES = pathlib.Path(os.environ.get("STICKSLIP_BINARIES", SOURCES / "build"))
MISSING = [name for name in ("ensurepip", "setuptools", "wheel") if importlib.util.find_spec(name) is None]


@unittest.skipIf(MISSING, f"apt-get install python3-venv python3-setuptools python3-wheel: no {', '.join(MISSING)}")
class Installed(unittest.TestCase):
    """A copy of the sources, whose package is installed without a network, and the program built in it."""

    @classmethod
    def setUpClass(cls):
        holder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(holder.cleanup)
        cls.folder = pathlib.Path(holder.name)
        sources = cls.folder / "sources"
        (sources / "build").mkdir(parents=True)
        cls.program = sources / "build" / "stickslip"
        cls.program.symlink_to(BINARIES / "stickslip")
        shutil.copytree(SOURCES / "python", sources / "python",
                        ignore=shutil.ignore_patterns("build", "*.egg-info", "__pycache__"))
        cls.commands = cls.folder / "venv" / "bin"
        cls.done(sys.executable, "-m", "venv", "--system-site-packages", cls.folder / "venv")
        cls.done(cls.commands / "pip", "install", "--quiet", "--no-index", "--no-deps", "--no-build-isolation",
                 sources / "python")

    @classmethod
    def done(cls, *words):
        """What a command prints, which runs in another folder and without what this test was given."""
        kept = {name: value for name, value in os.environ.items() if name not in ("STICKSLIP", "PYTHONPATH")}
        done = subprocess.run(list(map(str, words)), cwd=cls.folder, capture_output=True, text=True, env=kept)
        if done.returncode:
            raise AssertionError(f"{words} ends with {done.returncode}:\n{done.stdout}{done.stderr}")
        return done.stdout.strip()

    def python(self, script):
        return self.done(self.commands / "python", "-c", f"import stickslip\n{script}")

    def test_it_is_the_installed_package_with_its_version(self):
        place, version = self.python("import importlib.metadata\nprint(stickslip.__file__)\n"
                                     "print(importlib.metadata.version('stickslip'))").splitlines()
        self.assertTrue(pathlib.Path(place).is_relative_to(self.folder / "venv"), place)
        self.assertIn(f"project(stickslip VERSION {version} ", (SOURCES / "CMakeLists.txt").read_text())

    def test_it_finds_the_program_of_the_sources(self):
        self.assertEqual(self.python("print(stickslip.find_program())"), str(self.program.resolve()))

    def test_runs_and_pictures(self):
        self.python("r = stickslip.run(mu_d=0.25, delta=0.5, quantities='density', keep='density.h5')\n"
                    "assert r.reached and 0 < r.density.mass_at_rest < 1")
        for picture, command in (("a.png", [self.commands / "stickslip-plot"]),
                                 ("b.png", [self.commands / "python", "-m", "stickslip", "plot"])):
            self.assertEqual(self.done(*command, "density.h5", picture), picture)
            self.assertTrue((self.folder / picture).read_bytes().startswith(b"\x89PNG"))

    def test_the_explorer_is_a_command(self):
        self.assertIn("SCENE.opts", self.done(self.commands / "stickslip-explore", "--help"))


if __name__ == "__main__":
    unittest.main()
