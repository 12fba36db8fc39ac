#!/usr/bin/python3
"""`argil schema` read by a validator that is not ours: the schema is one of the draft that it names, every scenario of
the project and what `show` makes of it satisfy it, and wrong ones do not.

Usage: test_schema.py ARGIL        the program
"""
import json
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import jsonschema

ROOT = Path(__file__).resolve().parents[3]
ARGIL = str(Path(sys.argv.pop(1)).resolve())
GOLDEN = str(ROOT / "tests/golden/push.h5")
SCENARIOS = sorted((ROOT / "scenarios").glob("*.json"))


def call_argil(*arguments):
    return subprocess.run([ARGIL, *arguments], capture_output=True, text=True, check=True).stdout


class Schema(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.schema = json.loads(call_argil("schema"))
        cls.validator = jsonschema.Draft202012Validator(cls.schema)
        cls.scenario = json.loads(SCENARIOS[0].read_text())

    def find_errors(self, pointer, value):
        """What the validator says of the first scenario with `value` put at `pointer`."""
        scenario = json.loads(json.dumps(self.scenario))
        *path, key = pointer.strip("/").split("/")
        at = scenario
        for step in path:
            at = at[step]
        at[key] = value
        return [error.message for error in self.validator.iter_errors(scenario)]

    def test_is_valid_by_the_draft_that_it_names(self):
        self.assertEqual(self.schema["$schema"], jsonschema.Draft202012Validator.META_SCHEMA["$id"])
        jsonschema.Draft202012Validator.check_schema(self.schema)

    def test_every_default_satisfies_its_own_key(self):
        def check(schema, place):
            if "default" in schema:
                errors = list(self.validator.evolve(schema=schema).iter_errors(schema["default"]))
                self.assertEqual(errors, [], place)
            for key, below in schema.get("properties", {}).items():
                check(below, f"{place}/{key}")
        check(self.schema, "")

    def test_holds_for_every_scenario_of_the_project_and_for_its_resolved_form(self):
        self.assertGreater(len(SCENARIOS), 0)
        for file in SCENARIOS:
            self.validator.validate(json.loads(file.read_text()))
            self.validator.validate(json.loads(call_argil("show", str(file))))

    def test_refuses_unknown_keys_wrong_types_and_values_outside_their_range(self):
        for pointer, value, word in [
            ("/water/porosty", 0.3, "porosty"),
            ("/materials", {}, "materials"),
            ("/material/youngs_modulus_Pa", -1, "-1"),
            ("/material/youngs_modulus_Pa", "soft", "soft"),
            ("/material/poissons_ratio", 0.5, "0.5"),
            ("/haptics/physics_period_ticks", 1.5, "1.5"),
            ("/tool/mode", "squeeze", "squeeze"),
            ("/body/loads", {"gravity_m_per_s2": [0, 0]}, "[0, 0]"),
            ("/body/fixed", [{"kind": "box", "lower": [0, 0, 0]}], "lower"),
        ]:
            errors = self.find_errors(pointer, value)
            self.assertTrue(any(word in error for error in errors), f"{pointer}: {errors}")

    def test_demands_what_a_run_needs(self):
        for key in ("about", "material", "trace", "body"):
            without = {name: value for name, value in self.scenario.items() if name != key}
            self.assertFalse(self.validator.is_valid(without), key)
        stiffness = {"vertex_face_stiffness_N_per_m": 1, "edge_edge_stiffness_N_per_m": 1}
        for contact, is_valid in [({}, True), ({"law": "pressure"}, True), ({"law": "pairs"}, False),
                                  ({"law": "pairs", **stiffness}, True)]:
            self.assertEqual(self.validator.is_valid({**self.scenario, "contact": contact}), is_valid, contact)
        static = {name: value for name, value in self.scenario.items() if name not in ("contact", "trace", "tool")}
        static["dynamics"] = {"mode": "static"}
        self.assertTrue(self.validator.is_valid(static))


class ToleranceSchema(unittest.TestCase):
    def test_it_takes_what_compare_takes(self):
        schema = json.loads(subprocess.run([ARGIL, "schema", "--tolerances"], capture_output=True, text=True, check=True).stdout)
        jsonschema.Draft202012Validator.check_schema(schema)
        validator = jsonschema.Draft202012Validator(schema)
        for name in ("near.json", "exact.json"):
            validator.validate(json.loads((ROOT / "tests/golden" / name).read_text()))
        page = (ROOT / "src/output/tolerances.md").read_text(encoding="utf-8")
        validator.validate(json.loads(page.split("```json")[1].split("```")[0]))
        with tempfile.TemporaryDirectory() as folder:
            for wrong in ({"ignored": []}, {"tolerances": [{"relative": 1}]}, {"tolerances": [{"dataset": "/a", "relativ": 1}]},
                          {"tolerances": [{"dataset": "/a", "relative": -1}]}, {"ignore": [3]}, {"tolerances": {}}):
                with self.subTest(str(wrong)):
                    self.assertFalse(validator.is_valid(wrong))
                    Path(folder, "t.json").write_text(json.dumps(wrong))
                    done = subprocess.run([ARGIL, "compare", GOLDEN, GOLDEN, "--tolerances", "t.json"], cwd=folder,
                                          capture_output=True, text=True)
                    self.assertEqual(done.returncode, 2, done.stdout)
                    if "relativ" in str(wrong) and "relative" not in str(wrong):
                        self.assertIn("known here are: dataset, relative, absolute, of_largest", done.stderr)


if __name__ == "__main__":
    unittest.main()
