"""The script ./bootstrap, with programs in the place of those that configure, compile and run."""

import os
import shutil
import subprocess
import unittest

from running import SOURCES, Case

# Writes down its words.
CMAKE = """#!/bin/sh
echo "$@" >> "$CMAKE_CALLS"
"""
# Every package is installed.
QUERY = """#!/bin/sh
for package; do echo "installed $package"; done
"""
PROGRAM = """#!/bin/sh
pwd; echo "$@"; [ $# -lt 2 ] || cat "$2"
"""
CACHE = """CMAKE_CACHEFILE_DIR:INTERNAL={build}
CMAKE_GENERATOR:INTERNAL=Ninja
CMAKE_HOME_DIRECTORY:INTERNAL={sources}
CMAKE_PROJECT_NAME:STATIC={project}
STICKSLIP_TESTS:BOOL=OFF
"""


class Bootstrap(Case):
    def setUp(self):
        super().setUp()
        self.sources, self.elsewhere = self.folder / "the sources", self.folder / "else where"
        self.build, self.calls, commands = self.sources / "build", self.folder / "calls", self.folder / "commands"
        for folder in (self.build, self.elsewhere, commands):
            folder.mkdir(parents=True)
        shutil.copy(SOURCES / "bootstrap", self.sources)
        shutil.copy(SOURCES / "packages.txt", self.sources)
        (self.sources / "python").symlink_to(SOURCES / "python")
        for file, text in ((commands / "cmake", CMAKE), (commands / "dpkg-query", QUERY), (self.build / "stickslip", PROGRAM)):
            file.write_text(text)
            file.chmod(0o755)
        (self.build / "build.ninja").touch()
        self.environment = {**os.environ, "CMAKE_CALLS": str(self.calls), "PATH": f"{commands}:{os.environ['PATH']}"}
        self.environment.pop("STICKSLIP_BUILD_DIR", None)
        self.configured()

    def configured(self, **other):
        """The build folder was configured for these sources, or others."""
        (self.build / "CMakeCache.txt").write_text(CACHE.format(**{
            "sources": self.sources, "build": self.build, "project": "stickslip", **other}))

    def bootstrap(self, *words, folder=None, status=0, script=None, **environment):
        self.calls.write_text("")
        done = subprocess.run([script or self.sources / "bootstrap", *words], cwd=folder or self.elsewhere,
                              capture_output=True, text=True, env={**self.environment, **environment})
        if status is not None:
            self.assertEqual(done.returncode, status, done.stderr)
        return done

    def configurations(self):
        """Words with which cmake was called to configure."""
        return [line for line in self.calls.read_text().splitlines() if "-S" in line.split()]

    def test_runs_where_it_is_called(self):
        for folder in (self.elsewhere, self.sources):
            (folder / "mine.opts").write_text(f"-mu_d 0.25 # {folder.name}\n")
            done = self.bootstrap("run", "-options_file", "mine.opts", folder=folder)
            self.assertEqual(done.stdout, f"{folder}\n-options_file mine.opts\n-mu_d 0.25 # {folder.name}\n")
        self.assertEqual(self.configurations(), [])

    def test_runs_by_a_link(self):
        link = self.folder / "link"
        link.symlink_to(self.sources / "bootstrap")
        self.assertTrue(self.bootstrap("run", script=link).stdout.startswith(str(self.elsewhere)))

    def test_draws_where_it_is_called(self):
        self.run_ok("-mu_d", "0.25", "-quantities", "trajectory", "-horizon", "5", "-trajectory", "path.csv",
                    folder=self.elsewhere)
        (self.elsewhere / "numpy.py").write_text("raise SystemExit('a file of the user')\n")
        self.assertEqual(self.bootstrap("plot", "path.csv").stdout, "path.png\n")
        self.assertTrue((self.elsewhere / "path.png").read_bytes().startswith(b"\x89PNG"))

    def test_a_new_build_folder(self):
        (self.build / "CMakeCache.txt").unlink()
        (self.build / "build.ninja").unlink()
        done = self.bootstrap("build", STICKSLIP_CMAKE_OPTIONS="-DONE=1 -DTWO=2")
        self.assertRegex(done.stderr, "(?s)configuring .*minutes")
        line, = self.configurations()
        self.assertIn("-G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_UNITY_BUILD=ON -DONE=1 -DTWO=2", line)
        self.assertNotIn("--fresh", line)

    def test_a_moved_or_copied_checkout_is_configured_anew(self):
        kept = self.build / "kept"
        kept.touch()
        for other in ({"sources": "/gone"}, {"build": "/gone/build"}, {"sources": self.elsewhere}):
            self.configured(**other)
            done = self.bootstrap("run", "/dev/null")
            self.assertIn(str(*other.values()), done.stderr)
            self.assertIn("configured anew", done.stderr)
            line, = self.configurations()
            self.assertIn("-G Ninja -DCMAKE_BUILD_TYPE=Release", line)
            self.assertIn("--fresh", line)
            self.assertTrue(kept.exists())

    def test_the_report_announces_how_long_it_takes(self):
        self.assertIn("about an hour", self.bootstrap("report", "--help", status=None).stderr)
        self.assertIn("four minutes", self.bootstrap("report", "--help", "--quick", status=None).stderr)

    def test_a_moved_folder_of_the_sanitizers(self):
        check = self.sources / "build-check"
        check.mkdir()
        for sources, fresh in ((self.sources, False), ("/gone", True)):
            (check / "CMakeCache.txt").write_text(CACHE.format(sources=sources, build=check, project="stickslip"))
            self.bootstrap("fuzz", status=127)  # nothing was compiled
            self.assertEqual("--fresh" in self.calls.read_text().splitlines()[0], fresh)

    def test_the_same_folder_by_another_name(self):
        link = self.folder / "link"
        link.symlink_to(self.sources)
        self.configured(sources=link, build=link / "build")
        self.bootstrap("build")
        self.assertEqual(self.configurations(), [])

    def test_the_build_folder_of_another_project_is_left_alone(self):
        before = {"project": "precious", "sources": "/other"}
        self.configured(**before)
        kept = (self.build / "CMakeCache.txt").read_text()
        done = self.bootstrap("build", status=2)
        self.assertRegex(done.stderr, "build folder of precious.*STICKSLIP_BUILD_DIR")
        self.assertEqual(((self.build / "CMakeCache.txt").read_text(), self.configurations()), (kept, []))

    def test_another_build_folder(self):
        other = self.folder / "other build"
        shutil.copytree(self.build, other)
        (other / "CMakeCache.txt").write_text(CACHE.format(sources=self.sources, build=other, project="stickslip"))
        self.bootstrap("run", "/dev/null", STICKSLIP_BUILD_DIR=str(other))
        self.assertEqual(self.calls.read_text().split(" --target")[0], f"--build {other}")

    def test_tests_and_the_report_compile_both_programs(self):
        for words in (("test", "--help"), ("report", "--help")):
            done = self.bootstrap(*words, status=None)
            self.assertIn("-DSTICKSLIP_TESTS=ON", self.configurations()[0])
            self.assertIn("--target programs", self.calls.read_text())
            self.assertRegex(done.stderr, "minutes")


if __name__ == "__main__":
    unittest.main()
