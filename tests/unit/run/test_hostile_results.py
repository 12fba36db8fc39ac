#!/usr/bin/python3
"""Results and traces that are damaged or declare what they do not hold, folders without permission and too little memory: each
command ends with its exit code and one line that names the place.

Usage: test_hostile_results.py ARGIL        the program
"""
import json
import os
import resource
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import h5py
import numpy as np

ARGIL = str(Path(sys.argv.pop(1)).resolve())
BASE = Path(__file__).resolve().parents[2] / "golden" / "ball.json"
HUGE = 10**12


class HostileResults(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.made = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.made.cleanup)
        cls.result = Path(cls.made.name) / "good.h5"
        subprocess.run([ARGIL, "run", BASE, "-q", "--set", "/trace/duration_s=0.02", "-o", cls.result], check=True, timeout=300)

    def setUp(self):
        temp = tempfile.TemporaryDirectory()
        self.addCleanup(temp.cleanup)
        self.folder = Path(temp.name)

    def call(self, *arguments, **options):
        done = subprocess.run([ARGIL, *map(str, arguments)], cwd=self.folder, capture_output=True, text=True, timeout=120, **options)
        return done.returncode, done.stdout, done.stderr

    def refuse(self, words, *arguments, code=4, **options):
        found, _, error = self.call(*arguments, **options)
        self.assertEqual((found, error.count("\n")), (code, 1), f"{arguments}: {error}")
        for word in words:
            self.assertIn(word, error)

    def change(self, name, change):
        shutil.copy(self.result, self.folder / name)
        with h5py.File(self.folder / name, "r+") as file:
            change(file)

    def test_a_dataset_of_more_rows_than_the_file_holds(self):
        with h5py.File(self.folder / "trace.h5", "w") as file:
            file.create_dataset("time", (HUGE,), dtype="f8", chunks=(1024,))
            file.create_dataset("position", (HUGE, 3), dtype="f8", chunks=(1024, 3))

        def declare(file):
            del file["haptic/force"]
            file.create_dataset("haptic/force", (HUGE, 3), dtype="f8", chunks=(1024, 3))

        self.change("big.h5", declare)
        self.refuse(["trace.h5: /time declares 1000000000000 values", "divide it"], "run", BASE, "--trace", "trace.h5", "-o", "o.h5")
        self.refuse(["big.h5: /haptic/force declares 3000000000000 values"], "info", "big.h5")
        self.refuse(["big.h5: /haptic/force declares"], "compare", "big.h5", self.result)
        self.assertFalse((self.folder / "o.h5").exists())

    def test_a_group_that_contains_itself_is_compared_once(self):
        def link(file):
            file["haptic/again"] = file["haptic"]

        self.change("loop.h5", link)
        self.assertEqual(self.call("compare", "loop.h5", "loop.h5")[0], 0)

    def test_the_same_numbers_in_another_type_are_a_difference(self):
        def store(kind):
            def change(file):
                file["haptic/whole"] = np.arange(5, dtype=kind)
                file["haptic"].attrs.create("half", 0.5, dtype=kind)
            return change

        self.change("f8.h5", store("<f8"))
        for kind in ["<f4", ">f8", "<i4"]:
            self.change("other.h5", store(kind))
            code, said, _ = self.call("compare", "f8.h5", "other.h5")
            self.assertEqual(code, 5, kind)
            self.assertIn("/haptic/whole: has another type", said)
            self.assertIn("/haptic attribute half: has another type", said)
        self.assertEqual(self.call("compare", "f8.h5", "f8.h5")[0], 0)

    def test_a_forged_state_hash_is_found_whatever_tolerances_fit(self):
        def forge(file):
            file["frames/000001"].attrs["state_hash"] = "0" * 64

        self.change("forged.h5", forge)
        (self.folder / "none.json").write_text("{}")
        (self.folder / "haptic.json").write_text('{"tolerances": [{"dataset": "/haptic/*", "relative": 0.5}]}')
        (self.folder / "frames.json").write_text('{"tolerances": [{"dataset": "/frames/*", "relative": 0.5}]}')
        for rules, code in [("none", 5), ("haptic", 5), ("frames", 0)]:
            found, said, error = self.call("compare", self.result, "forged.h5", "--tolerances", f"{rules}.json")
            self.assertEqual(found, code, rules + said + error)

    def test_a_tolerance_that_fits_nothing_is_refused(self):
        for rules, place in [({"tolerances": [{"dataset": "*" * 60 + "x"}]}, "/tolerances/0/dataset"),
                             ({"ignore": ["/provenence"]}, "/ignore/0")]:
            (self.folder / "rules.json").write_text(json.dumps(rules))
            self.refuse(["rules.json", place, "fits no"], "compare", self.result, self.result, "--tolerances", "rules.json",
                        code=2)

    def test_vertices_that_are_not_there(self):
        def name_vertex(file):
            file["mesh/tets"][5, 2] = 255 << 16

        self.change("vertex.h5", name_vertex)
        self.refuse(["/mesh/tets names vertex 16711680 in row 5"], "info", "vertex.h5")

    def test_compare_tells_infinities_integers_and_lists_apart(self):
        def put(path, place, value):
            def change(file):
                file[path][place] = value
            return change

        def name_two_units(file):
            file["haptic/force"].attrs["units"] = np.array(["N", "m"], dtype="S1")

        (self.folder / "near.json").write_text(json.dumps({"tolerances": [{"dataset": "*", "relative": 1e-3, "absolute": 1e-3}]}))
        for name, change_a, change_b in (
                ("infinity", put("haptic/force", (5, 0), np.inf), put("haptic/force", (5, 0), 1.0)),
                ("sign", put("haptic/force", (5, 0), np.inf), put("haptic/force", (5, 0), -np.inf)),
                ("integer", put("haptic/tick", 5, 2**53), put("haptic/tick", 5, 2**53 + 1)),
                ("list", lambda file: None, name_two_units)):
            self.change("a.h5", change_a)
            self.change("b.h5", change_b)
            tolerances = [] if name == "integer" else ["--tolerances", "near.json"]
            for pair in (("a.h5", "b.h5"), ("b.h5", "a.h5")):
                code, out, error = self.call("compare", *pair, *tolerances)
                self.assertEqual(code, 5, f"{name}: {out}{error}")
        self.assertEqual(self.call("compare", "a.h5", "a.h5")[0], 0)
        self.change("a.h5", put("haptic/force", (5, 0), np.inf))
        self.assertEqual(self.call("compare", "a.h5", "a.h5", "--tolerances", "near.json")[0], 0)

    def test_a_folder_without_permission(self):
        self.folder.chmod(0o755)
        for name in ("closed", "points"):
            (self.folder / name).mkdir()
        program = shutil.copy(ARGIL, self.folder)  # where anyone may read
        scene = json.loads(BASE.read_text())
        scene["trace"]["file"] = str(shutil.copy(BASE.parent / scene["trace"]["file"], self.folder))
        (self.folder / "scene.json").write_text(json.dumps(scene))
        (self.folder / "sweep.json").write_text(json.dumps({"scenario": "scene.json", "list": [{}]}))
        self.assertEqual(self.call("sweep", "expand", "sweep.json", "-o", "points.jsonl")[0], 0)
        nobody = 65534 if os.getuid() == 0 else None  # root may read anything
        for name in ("closed", "points"):
            (self.folder / name).chmod(0)
        for place, arguments in (("points/000000", ["sweep", "missing", "points.jsonl"]),
                                 ("points/000000", ["sweep", "run", "points.jsonl", "--index", "0"]),
                                 ("points/000000", ["sweep", "collect", "points.jsonl", "-o", "table"]),
                                 ("closed/o.h5", ["run", "scene.json", "--resume", "-q", "-o", "closed/o.h5"])):
            done = subprocess.run([program, *arguments], cwd=self.folder, capture_output=True, text=True, timeout=120, user=nobody)
            self.assertEqual((done.returncode, done.stderr.count("\n")), (4, 1), f"{arguments}: {done.stderr}")
            self.assertRegex(done.stderr, f"argil: {place}.*: Permission denied")

    def test_too_little_memory(self):
        rows = 200_000_000  # 1.6 GB that the file system need not store, for the file is sparse
        creation = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
        creation.set_alloc_time(h5py.h5d.ALLOC_TIME_EARLY)
        creation.set_fill_time(h5py.h5d.FILL_TIME_NEVER)
        with h5py.File(self.folder / "trace.h5", "w") as file:
            h5py.h5d.create(file.id, b"time", h5py.h5t.IEEE_F64LE, h5py.h5s.create_simple((rows,)), creation)
            file["position"] = np.zeros((1, 3))

        def limit():
            resource.setrlimit(resource.RLIMIT_AS, (1 << 30, 1 << 30))

        self.refuse(["not enough memory"], "run", BASE, "--trace", "trace.h5", "-o", "o.h5", preexec_fn=limit)


if __name__ == "__main__":
    unittest.main(verbosity=2)
