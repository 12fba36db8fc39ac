#!/usr/bin/python3
"""A run that chooses its cells for a wanted accuracy: a much finer one says how exact the force is. What is left in the folder, what
the result says of it, and that a stop in between and threads change no bit.

Usage: test_accuracy.py ARGIL. Exit code 77 (skipped) without h5py.
"""
import json
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

try:
    import h5py
    import numpy as np
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)

ARGIL = None
EDGE, RADIUS, DEEPEST = 0.04, 0.006, 0.0006  # [m] of the block, the ball and the press


def write_scene(folder, **material):
    t = np.arange(0, 0.07, 0.001)
    height = EDGE + RADIUS - np.interp(t, [0, 0.06, 0.07], [-0.0002, DEEPEST, DEEPEST])
    np.savetxt(folder / "press.csv", np.c_[t, np.full_like(t, 7e-4), np.full_like(t, 3e-4), height], delimiter=",",
               header="t,x,y,z", comments="")
    (folder / "press.json").write_text(json.dumps({
        "about": "a ball on an elastic block",
        "body": {"shape": {"kind": "box", "size_m": EDGE, "skin_triangles": 0},
                 "fixed": [{"kind": "plane", "normal": [0, 0, 1], "offset_m": 0}]},
        "material": {"youngs_modulus_Pa": 1e5, "poissons_ratio": 0.3, "plasticity": {"enabled": False},
                     "clay_kernel": {"form": "off"}, **material},
        "tool": {"shape": {"kind": "sphere", "radius_m": RADIUS}},
        "output": {"checkpoint_period_ticks": 10}, "trace": {"file": "press.csv"}}))
    return folder / "press.json"


def run(scene, result, *words, code=0):
    done = subprocess.run([ARGIL, "run", scene, "-o", result, *words], capture_output=True, text=True, check=False)
    assert done.returncode == code, done.stderr
    return done.stderr


def read_force(result):
    with h5py.File(result) as file:
        return file["haptic/force"][:]


def compare(a, b):
    return np.sqrt(((a - b)**2).sum() / (b**2).sum())


class Accuracy(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temp = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.temp.cleanup)
        cls.folder = Path(cls.temp.name)
        cls.scene = write_scene(cls.folder)
        cls.result = cls.folder / "press.h5"
        cls.notes = run(cls.scene, cls.result, "--accuracy", "0.05")

    def test_is_kept_against_a_much_finer_run(self):
        run(self.scene, self.folder / "fine.h5", "-q", "--set", "/dynamics/element=p2", "--set", "/body/cells/kind=graded",
            "--set", "/body/cells/near_tool_m=0.0006", "--set", "/body/shape/target_tets=600", "--threads", "2")
        fine = read_force(self.folder / "fine.h5")
        self.assertLess(compare(read_force(self.result), fine), 0.05)
        run(self.scene, self.folder / "even.h5", "-q", "--set", "/body/cells/kind=even")  # the default's cells, of one size
        self.assertGreater(compare(read_force(self.folder / "even.h5"), fine), 0.05)

    def test_leaves_one_result_that_says_what_was_done(self):
        self.assertEqual(sorted(path.name for path in self.folder.glob("press.h5*")), ["press.h5"])
        with h5py.File(self.result) as file:
            self.assertEqual(file["accuracy"].attrs["wanted"], 0.05)
            self.assertGreater(file["accuracy"].attrs["estimated"], 0)
            self.assertLess(file["accuracy"].attrs["estimated"], 0.05)
            self.assertIn("a pass had", file["provenance/notes"][()].decode())
            resolved = json.loads(file["provenance/scenario"][()])
        self.assertEqual(resolved["dynamics"]["element"], "p2")
        self.assertEqual(self.notes.count("ten-node tets"), 2)
        info = subprocess.run([ARGIL, "info", self.result], capture_output=True, text=True, check=True).stdout
        self.assertIn("wanted 5 %", info)

    def test_does_not_depend_on_threads_or_on_a_stop(self):
        stopped = self.folder / "stopped.h5"
        with subprocess.Popen([ARGIL, "run", self.scene, "-o", stopped, "-q", "--accuracy", "0.05", "--threads", "2"],
                              stderr=subprocess.PIPE) as process:
            while not stopped.exists() and process.poll() is None:
                time.sleep(0.002)
            process.send_signal(signal.SIGINT)
            process.communicate()
        run(self.scene, stopped, "-q", "--accuracy", "0.05", "--resume")
        same = subprocess.run([ARGIL, "compare", self.result, stopped], capture_output=True, text=True, check=False)
        self.assertEqual(same.returncode, 0, same.stdout)
        self.assertIn("complete already", subprocess.run(
            [ARGIL, "run", self.scene, "-o", stopped, "--accuracy", "0.05", "--resume"], capture_output=True, text=True, check=True).stdout)

    def test_can_be_planned_for_a_session(self):
        patch = self.folder / "plan.json"
        plan = [ARGIL, "plan", self.scene, "--accuracy", "0.05", "-o", patch]
        subprocess.run(plan, capture_output=True, cwd=self.folder, check=True)
        self.assertEqual(list(self.folder.glob("*.plan.h5*")), [])
        planned, session = self.folder / "planned.h5", self.folder / "session.h5"
        run(self.scene, planned, "-q", "--patch", patch)
        self.assertTrue(np.array_equal(read_force(planned), read_force(self.result)))
        subprocess.run([ARGIL, "live", self.scene, "--patch", patch, "--device", "simulated", "-q", "-o", session], check=True)
        run(self.scene, self.folder / "again.h5", "-q", "--patch", patch, "--trace", session)
        self.assertTrue(np.array_equal(read_force(self.folder / "again.h5"), read_force(session)))
        missing = [*plan, "--set", "/trace/device_to_world/translation_m=[0,0,1]"]
        for command, said in ((missing, "does not touch"), ([ARGIL, "plan", self.scene], "is not given")):
            refused = subprocess.run(command, capture_output=True, text=True, cwd=self.folder, check=False)
            self.assertEqual(refused.returncode, 2, refused.stderr)
            self.assertIn(said, refused.stderr)

    def test_takes_clay_that_hardly_changes_its_volume(self):
        with tempfile.TemporaryDirectory() as folder:
            scene = write_scene(Path(folder), poissons_ratio=0.49)
            run(scene, Path(folder) / "press.h5", "-q", "--accuracy", "0.2")

    def test_is_refused_where_no_motion_or_no_force_is_there_to_converge(self):
        pairs = {"law": "pairs", "vertex_face_stiffness_N_per_m": 100, "edge_edge_stiffness_N_per_m": 100}
        for setting, word in ((f"/contact={json.dumps(pairs)}", "triangles"), ("/dynamics/mode=static", "force")):
            message = run(self.scene, self.folder / "no.h5", "--accuracy", "0.05", "--set", setting, code=2)
            self.assertIn("/fidelity/accuracy", message)
            self.assertIn(word, message)
        self.assertIn("accuracy", run(self.scene, self.folder / "no.h5", "--accuracy", "0.7", code=2))


if __name__ == "__main__":
    ARGIL = Path(sys.argv.pop(1)).resolve()
    unittest.main()
