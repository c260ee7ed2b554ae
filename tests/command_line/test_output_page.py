"""docs/output.md names every key of the files."""

import re
import unittest

import h5py

from running import SOURCES, Case

PAGE = (SOURCES / "docs" / "output.md").read_text()
SMALL = ("-mu_d", "0.25", "-delta", "0.5")
# Named by what they are: options, results, parameters of the model.
SCALES = {"CLASS", "NAME", "REFERENCE_LIST", "DIMENSION_LIST"}  # attributes by which HDF5 names axes
OWN_NAMES = {"options", "results", "scene", "axes", "tables", "provenance"}


def keys(tree):
    """Of all objects in a summary, but of those whose keys are names of something else."""
    if isinstance(tree, list):
        for item in tree:
            yield from keys(item)
    if isinstance(tree, dict):
        for key, value in tree.items():
            yield key
            if key not in OWN_NAMES:
                yield from keys(value)


class Keys(Case):
    def assert_named(self, names):
        for name in set(names):
            self.assertRegex(PAGE, rf"(?<!\w){re.escape(name)}(?!\w)", name)

    def test_summaries(self):
        grids = ("-omega", "1,2", "-time", "1", "-distance", "1", "-accuracy", "1e-2")
        self.run_ok(*SMALL, "-route", "monte_carlo", "-excursions", "1000", "-output", "reference.h5")
        for options in (("-quantities", "sticking,spectrum,duration_density,slip", *grids),
                        ("-compare", "reference.h5"), ("-scheme", "upwind", "-accuracy", "0.1"),
                        ("-route", "monte_carlo", "-excursions", "1000"), ("-route", "lambda"),
                        ("-route", "null_vector"), ("-route", "hitting", "-quantities", "sticking"),
                        ("-route", "fluid_queue", "-drag", "none", "-quantities", "sticking"),
                        ("-plan", "-quantities", "sticking,sensitivity,spectrum", "-omega", "1"),
                        ("-study", "p", "-study_steps", "4"), ("-sweep_tau", "1,2")):
            with self.subTest(options=options):
                self.assert_named(keys(self.summary(*SMALL, *options)))
        for options in (("-accuracy", "1e-15"), ("-sweep_tau", "1,2", "-accuracy", "1e-15")):
            self.assert_named(keys(self.summary(*SMALL, *options, status=3)))

    def test_hdf5(self):
        def names(file):
            found = []

            def visit(path, item):
                parts = path.split("/")
                if parts[0] == "results":
                    parts[1:2] = []
                if parts[0] not in ("record", "study"):
                    found.extend(part for part in parts if not re.fullmatch(r"mode_\d", part))
                    found.extend(set(item.attrs) - SCALES)
            with h5py.File(self.folder / file) as f:
                f.visititems(visit)
            return found

        self.run_ok(*SMALL, "-quantities", "sticking,density,relaxation,entry_law,trajectory", "-accuracy", "1e-2",
                    "-output", "f.h5")
        self.assert_named(set(names("f.h5")) - {"meaning"})
        self.run_ok(*SMALL, "-bias", "0.1", "-quantities", "relaxation", "-accuracy", "1e-2", "-output", "f.h5")
        self.assert_named(names("f.h5"))


if __name__ == "__main__":
    unittest.main()
