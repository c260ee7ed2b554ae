"""The manual page and the completion, as the programs that read them take them."""

import shutil
import subprocess
import unittest

from running import Case


class ManualPage(Case):
    @unittest.skipUnless(shutil.which("groff"), "no groff")
    def test_groff_has_nothing_to_warn_of(self):
        page = self.run_ok("-man_page").stdout
        read = subprocess.run(["groff", "-man", "-Tascii", "-P-cbou", "-ww"], input=page,
                              capture_output=True, text=True)
        self.assertEqual((read.returncode, read.stderr), (0, ""))
        shown = " ".join(read.stdout.split())  # groff fills lines with spaces
        for part in ("NAME", "EXIT STATUS", "-mu_d number", "0.01:50:200:log", "`full` is"):
            self.assertIn(part, shown)


class Completion(Case):
    def setUp(self):
        super().setUp()
        self.script = self.folder / "completion"
        self.script.write_text(self.run_ok("-completion").stdout)

    def offered(self, *words, program="stickslip"):
        """What bash offers for the last of the words, and what it says to standard error."""
        line = ('source "$1"; shift; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _stickslip; '
                'printf "%s\\n" "${COMPREPLY[@]}"')
        done = subprocess.run(["bash", "-c", line, "bash", self.script, program, *words],
                              cwd=self.folder, capture_output=True, text=True, check=True)
        self.assertEqual(done.stderr, "")
        return done.stdout.split()

    def test_names(self):
        self.assertEqual(self.offered("-mu"), ["-mu_s", "-mu_d", "-mu_s_minus", "-mu_d_minus"])
        self.assertEqual(self.offered("-mu_d", "0.5", "-options_"), ["-options_file"])
        self.assertIn("-version", self.offered(""))

    def test_words(self):
        self.assertEqual(self.offered("-drag", "c"), ["cubic"])
        self.assertEqual(self.offered("-noise_levels", ""), ["full"])
        self.assertEqual(self.offered("-plan", "y"), ["yes"])
        self.assertIn("-plan", self.offered("-plan", "-p"))
        self.assertEqual(self.offered("-mu_d", "-"), [])

    def test_lists_offer_what_is_not_in_them(self):
        self.assertEqual(self.offered("-quantities", "sti"), ["sticking"])
        self.assertEqual(self.offered("-quantities", "moments,sti"), ["moments,sticking"])
        rest = self.offered("-quantities", "sticking,moments,")
        self.assertIn("sticking,moments,noise_law", rest)
        self.assertNotIn("sticking,moments,moments", rest)

    def test_files(self):
        for name in ("scene.opts", "scene two.opts"):
            (self.folder / name).touch()
        for option in ("-options_file", "-cases", "-summary", "-compare", "-checkpoint"):
            found = self.offered(option, "scene")
            self.assertEqual(sorted(found), sorted(["scene.opts", "scene", "two.opts"]))

    def test_bash_calls_it_for_every_program(self):
        for program in ("stickslip", "stickslip-complex"):
            done = subprocess.run(["bash", "-c", 'source "$1"; complete -p "$2"', "bash",
                                   self.script, program], capture_output=True, text=True)
            self.assertEqual(done.stdout, f"complete -F _stickslip {program}\n")


if __name__ == "__main__":
    unittest.main()
