"""Every scene in options/ runs to the accuracy it asks for."""

import unittest

from running import Case, SOURCES


def runs(file):
    """Of the scenes of the paper, which differ in three words, some; test_plan plans all, and the report runs all."""
    return file.parent.name != "paper" or file.stem in (
        "linear_mud_0.25_delta_0.015625", "linear_mud_1_delta_0.125", "none_mud_0.5_delta_0.0625")


class Scenes(Case):
    def test_all(self):
        files = sorted((SOURCES / "options").rglob("*.opts"))
        self.assertGreater(len(files), 60)
        for file in filter(runs, files):
            with self.subTest(scene=str(file.relative_to(SOURCES))):
                path = ("-trajectory", self.folder / "path.csv")
                more = path if file.stem == "trajectory" else ()
                # Names of files within scenes count from the folder of the sources.
                s = self.summary("-options_file", file, *more, folder=SOURCES)
                self.assertEqual(s["warnings"], [])
                for line in self.printed.splitlines():  # a terminal of 100 columns
                    self.assertLessEqual(len(line), 100, line)
                    self.assertEqual(line, line.rstrip())
                for run in s.get("runs", [s]):
                    self.assertEqual(run["warnings"], [])
                    self.assertTrue(run["accuracy"]["reached"])
                    self.check_power(run["scene"], run["results"])

    def check_power(self, scene, results):
        """Power put in by the noise and the bias is dissipated by friction and drag."""
        exact = scene["drag"] in ("linear", "none") and "E_XV" in results
        if not exact or "ci95" in results["E_XV"]:
            return
        put_in = results["E_XV"]["value"] + scene["bias"] * results["E_V"]["value"]
        if "friction" in scene:
            if "friction_power" in results:
                dissipated = (results["friction_power"]["value"]
                              + scene["drag_coefficient"] * results["E_V2"]["value"])
                self.assert_close(put_in, dissipated, 1e-5)
            return
        up, down = scene["mu_d"], scene.get("mu_d_minus", scene["mu_d"])
        by_friction = ((up + down) * results["E_absV"]["value"]
                       + (up - down) * results["E_V"]["value"]) / 2
        dissipated = by_friction + scene["drag_coefficient"] * results["E_V2"]["value"]
        self.assert_close(put_in, dissipated, 1e-5)

    def test_power_under_quadratic_drag(self):
        s = self.summary("-options_file", SOURCES / "options" / "quadratic_drag.opts",
                         "-quantities", "moments,resolvent", "-lambda", "0",
                         "-observable", "v^2 + 0.1*abs(v)^3")
        results = s["results"]
        by_drag = results["pi(v^2 + 0.1*abs(v)^3)"]["value"][0]
        dissipated = s["scene"]["mu_d"] * results["E_absV"]["value"] + by_drag
        self.assert_close(results["E_XV"]["value"], dissipated, 1e-7)


if __name__ == "__main__":
    unittest.main()
