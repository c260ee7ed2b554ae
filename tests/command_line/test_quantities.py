"""The keys that the program writes, beside the tables of -help and -reference_quantities."""

import collections
import json
import re
import unittest

from running import SOURCES, Case, run

SMALL = ("-delta", "1", "-mu_d", "0.5", "-accuracy", "1e-1", "-excursions", "2000")  # of monte_carlo
# With symmetry, without it, and with every parameter of sensitivity.
MODELS = {"symmetric": (), "biased": ("-bias", "0.2", "-mu_d_minus", "0.4"),
          "stribeck": ("-bias", "0.2", "-friction", "stribeck", "-stribeck_velocity", "0.1")}
# What a spring adds, by the default method and by simulation.
SPRING = ("-spring_stiffness", "1", "-noise", "telegraph", "-telegraph_amplitude", "1.5", "-telegraph_rate", "1")
ARGUMENTS = {"-lambda": "0.5,1", "-omega": "0.5,1", "-time": "3,4", "-distance": "0.5,1",
             "-inverse_distance": "0.5,1", "-tilt": "-0.2,0.4", "-wavenumber": "0.5,2", "-probability": "0.5,0.9",
             "-velocity": "0.2,0.4", "-observable": "v^2",
             "-force_file": str(SOURCES / "options" / "given_force.csv")}
FIELDS = ("density", "trajectory")
DERIVATIVE = re.compile(r"d\w+_d(mu_d|mu_d_minus|mu_s|stribeck_velocity|tau|drag_coefficient)$")


def table(page, heading):
    """Rows of the first table below a heading, as dictionaries without the marks of Markdown."""
    lines = iter(page[page.index(f"## {heading}\n"):].splitlines())
    rows = [line for line in lines if line.startswith("|")]
    cells = [[re.sub(r"[`\\]", "", cell).strip() for cell in re.split(r"(?<!\\)\|", row)[1:-1]]
             for row in rows]
    return [dict(zip(cells[0], row)) for row in cells[2:] if len(row) == len(cells[0])]


def pattern(key):
    """pi(f) for pi(v^2), dA_dp for derivatives, (t) for times, (w) for speeds."""
    number = "(w)" if "_passage(" in key else "(t)"
    return "dA_dp" if DERIVATIVE.match(key) else re.sub(r"\([\d.]+\)$", number, key.replace("(v^2", "(f"))


class Keys(Case):
    def setUp(self):
        super().setUp()
        page = self.run_ok("-reference_quantities").stdout
        self.quantities = {row["quantity"]: row for row in table(page.split("## Keys")[0], "Quantities")}
        self.keys = {row["key"]: row for row in table(page, "Keys")}
        legend = re.sub(r"\s+", " ", page)
        self.routes = {letter: route for letter, route in re.findall(r"\b([A-Z]) `(\w+)`", legend)}
        self.assertEqual(len(self.routes), 6)

    def written(self, quantities, *options):
        """What a run wrote: for each pattern its unit and the name of its abscissa."""
        used = {name for quantity in quantities for name in self.quantities[quantity]["its options"].split(", ")}
        arguments = [word for name, value in ARGUMENTS.items() if name in used
                     for word in (name, value)]
        file = self.folder / "summary.json"
        done = run(*SMALL, *options, *arguments, "-quantities", ",".join(quantities), "-summary", file)
        self.assertIn(done.returncode, (0, 3), done.stderr)  # 3: a small sample is not accurate
        results = json.loads(file.read_text())["results"]
        return {pattern(key): (result.get("unit", ""),
                               "".join(set(result) - {"value", "error", "ci95", "unit"}))
                for key, result in results.items()}

    def test_every_key_is_in_the_table_with_its_unit_and_abscissa_and_by_the_routes_named(self):
        given = collections.defaultdict(set)
        for letter, route in self.routes.items():
            asked = [name for name, row in self.quantities.items()
                     if letter in row["-route"].split() and name not in FIELDS]
            for model, options in MODELS.items():
                if route == "fluid_queue":
                    if model == "stribeck":
                        continue
                    options = (*options, "-drag", "none")
                found = self.written(asked, "-route", route, *options)
                for key, (unit, abscissa) in found.items():
                    with self.subTest(route=route, model=model, key=key):
                        row = self.keys[key]
                        self.assertEqual(abscissa, row["over"])
                        if key != "dA_dp":
                            self.assertEqual(unit, "" if "[" in row["unit"] else row["unit"])
                    given[key].add(letter)
        for letter, options in (("E", ()), ("M", ("-route", "monte_carlo", "-excursions", "100"))):
            for key in self.written(["moments"], *SPRING, *options):
                given[key].add(letter)
        for key, row in self.keys.items():
            with self.subTest(key=key):
                self.assertEqual(given[key], set(row["-route"].split()))

    def test_help_names_the_keys_of_every_quantity(self):
        text = self.run_ok("-help").stdout
        entries = re.findall(r"^    (\w+)(?: +|\n {21})((?:.*)(?:\n {21}.*)*)", text, re.MULTILINE)
        named = {name: set(re.sub(r"\s+", " ", entry).partition(": ")[2].rstrip(".").split(", "))
                 for name, entry in entries}
        for quantity in self.quantities:
            if quantity in FIELDS:
                continue
            with self.subTest(quantity=quantity):
                asked = [quantity, "sticking"] if quantity == "sensitivity" else [quantity]
                found = set(self.written(asked))
                if quantity == "sensitivity":
                    found &= {"dA_dp"}
                if quantity == "resolvent":  # by itself it has the name of the average
                    found = {key.replace("pi(", "pi_lambda(") for key in found}
                of_models = {key for key, row in self.keys.items() if row["quantity"] == quantity}  # by any model, as seen above
                self.assertEqual(found | of_models, named[quantity])

    def test_a_quantity_that_fails_leaves_the_others_alone(self):
        model = ("-mu_d", "0.5", "-delta", "0.5", "-accuracy", "1e-3", "-quantities")
        alone = self.summary(*model, "sticking")["results"]
        found = self.summary(*model, "sticking,relaxation", "-relax_eps_max_it", "1", status=3)
        self.assertIn("relaxation: the ", found["accuracy"]["shortfall"])
        for name, result in alone.items():
            self.assert_close(found["results"][name]["value"], result["value"], 2e-3, name)
        message = run(*model, "relaxation", "-relax_eps_max_it", "1").stderr
        self.assertIn("relaxation: the ", message)  # with nothing beside it, an error as before

    def test_a_study_keeps_what_does_not_fail(self):
        model = ("-study", "tau", "-study_steps", "4", "-mu_d", "1")
        alone = self.summary(*model, "-quantities", "moments")["study"]["tables"]["E_V2"]
        found = self.summary(*model, "-quantities", "moments,relaxation", "-relax_eps_max_it", "1", status=3)
        self.assertIn("relaxation: the eigensolver", found["runs"][0]["message"])
        self.assert_close(found["study"]["tables"]["E_V2"]["value"][1], alone["value"][1], 1e-6)


if __name__ == "__main__":
    unittest.main()
