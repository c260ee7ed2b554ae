"""Every scene in options/ runs to the accuracy it asks for."""

import unittest

from stickslip import Case, SOURCES


class Scenes(Case):
    def test_all(self):
        files = sorted((SOURCES / "options").rglob("*.opts"))
        self.assertGreater(len(files), 40)
        for file in files:
            with self.subTest(scene=str(file.relative_to(SOURCES))):
                s = self.summary("-options_file", file)
                self.assertTrue(s["accuracy"]["reached"])
                results = s["results"]
                # Power put in by the noise is dissipated by friction and drag.
                scene = s["scene"]
                if scene["drag"] == "expression":  # below
                    continue
                dissipated = (scene["mu_d"] * results["E_absV"]["value"]
                              + scene["drag_coefficient"] * results["E_V2"]["value"])
                self.assert_close(results["E_XV"]["value"], dissipated, 1e-7)

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
