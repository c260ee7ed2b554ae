"""What `cmake --install` puts under a prefix works from there."""

import os
import pathlib
import subprocess
import sys
import unittest

from running import BINARIES, Case, PROGRAMS


class Install(Case):
    def setUp(self):
        super().setUp()
        self.prefix = self.folder / "prefix"
        self.keep(BINARIES / "install_manifest.txt")
        done = subprocess.run(["cmake", "--install", BINARIES, "--prefix", self.prefix],
                              capture_output=True, text=True, env={**os.environ, "DESTDIR": ""})
        self.assertEqual(done.returncode, 0, done.stderr)

    def keep(self, manifest):
        """Whoever installed from this folder removes by the manifest, which each install rewrites."""
        before = manifest.read_bytes() if manifest.exists() else None
        self.addCleanup(lambda: manifest.unlink(missing_ok=True) if before is None
                        else manifest.write_bytes(before))

    def installed(self, folder):
        return {file.name for file in (self.prefix / folder).iterdir()}

    def test_programs_with_page_and_completion(self):
        self.assertEqual(self.installed("bin"), set(PROGRAMS))
        self.assertEqual(self.installed("share/man/man1"), {f"{name}.1" for name in PROGRAMS})
        self.assertEqual(self.installed("share/bash-completion/completions"), set(PROGRAMS))
        for name in PROGRAMS:
            for option, file in (("-man_page", f"man/man1/{name}.1"),
                                 ("-completion", f"bash-completion/completions/{name}")):
                printed = subprocess.run([self.prefix / "bin" / name, option],
                                         capture_output=True, text=True, check=True).stdout
                self.assertEqual((self.prefix / "share" / file).read_text(), printed)

    def test_installed_program_runs_an_installed_file(self):
        scene = self.prefix / "share/stickslip/options/quickstart.opts"
        for name in PROGRAMS:
            done = subprocess.run([self.prefix / "bin" / name, "-options_file", scene],
                                  cwd=self.folder, capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertRegex(done.stdout, r"P_stick +0\.156486168")

    def test_pages_and_scripts_are_there(self):
        self.assertIn("tutorial.md", self.installed("share/doc/stickslip"))
        self.assertIn("copyright", self.installed("share/doc/stickslip"))
        self.assertIn("python.md", self.installed("share/doc/stickslip"))
        self.assertIn("paper", self.installed("share/stickslip/options"))

    def test_pages_name_the_installed_program(self):
        pages = self.prefix / "share/doc/stickslip"
        for page in set(pages.glob("*.md")) - {pages / "install.md", pages / "development.md"}:
            self.assertNotRegex(page.read_text(), r"build/stickslip|\./bootstrap (run|plot)", page.name)
        source = pathlib.Path(__file__).parents[2] / "docs/performance.md"
        self.assertEqual((pages / "performance.md").read_text(), source.read_text().replace("build/stickslip", "stickslip"))

    def test_python_package_finds_the_installed_program(self):
        script = "import stickslip; print(stickslip.run(delta=0.5, quantities='sticking')['P_stick'].value)"
        environment = {**os.environ, "PYTHONPATH": str(self.prefix / "lib/python3/dist-packages")}
        environment.pop("STICKSLIP", None)
        done = subprocess.run([sys.executable, "-c", f"{script}; print(stickslip.find_program())"], text=True,
                              cwd=self.folder, capture_output=True, env=environment)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertRegex(done.stdout, r"^0\.58\d+\n" + str(self.prefix / "bin/stickslip"))

    def test_the_manifest_names_every_file(self):
        """So that removing what it names removes all."""
        listed = (BINARIES / "install_manifest.txt").read_text().split("\n")
        files = {str(file) for file in self.prefix.rglob("*") if not file.is_dir()}
        self.assertEqual(set(filter(None, listed)), files)


if __name__ == "__main__":
    unittest.main()
