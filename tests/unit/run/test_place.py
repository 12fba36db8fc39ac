#!/usr/bin/python3
"""A motion beside the body: what validate, run and place say of it, and where place brings it. Distances are those of a
ball from a block, by hand.

Usage: test_place.py ARGIL        the program
"""
import json
import shlex
import math
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import h5py
import numpy as np

ARGIL = str(Path(sys.argv.pop(1)).resolve())
RADIUS = 0.006  # [m] of the ball
TOP = 0.04      # [m] of the block, which is 80 mm wide
LOWEST = 0.9    # [m] of the ball's middle, at 30 ms
MISS = f"the tool never comes nearer than {LOWEST - RADIUS - TOP:.3g} m to the body at rest, at 0.03 s; argil place "


def write_swing(file, shift=(0.0, 0.0, 0.0), length=0.02):
    """60 ms of a motion along x, lowest in its middle, at 1 kHz."""
    lines = ["t,x,y,z"]
    for k in range(61):
        angle = math.pi * (k / 60 - 0.5)
        x, y, z = 0.004 + length * math.sin(angle), -0.003, LOWEST + length * (1 - math.cos(angle))
        lines.append(f"{k / 1000},{x + shift[0]},{y + shift[1]},{z + shift[2]}")
    file.write_text("\n".join(lines) + "\n")


class Place(unittest.TestCase):
    def setUp(self):
        self.temp = tempfile.TemporaryDirectory()
        self.addCleanup(self.temp.cleanup)
        self.folder = Path(self.temp.name)
        write_swing(self.folder / "swing.csv")
        self.write_scene({"kind": "box", "size_m": TOP, "slenderness": 0.5, "target_tets": 400, "skin_triangles": 0})

    def write_scene(self, shape, cells="even"):
        (self.folder / "scene.json").write_text(json.dumps({
            "about": "a ball that swings far above a block",
            "body": {"shape": shape, "cells": {"kind": cells},
                     "fixed": [{"kind": "half_space", "normal": [0, 0, 1], "offset_m": 0.006}]},
            "material": {"youngs_modulus_Pa": 1e5, "poissons_ratio": 0.3, "clay_kernel": {"form": "off"}},
            "tool": {"shape": {"kind": "sphere", "radius_m": RADIUS}, "mode": "push"},
            "trace": {"file": "swing.csv"}}))

    def call(self, *arguments, code=0):
        done = subprocess.run([ARGIL, *arguments], cwd=self.folder, capture_output=True, text=True, timeout=300)
        self.assertEqual(done.returncode, code, f"{arguments}: {done.stdout}{done.stderr}")
        return done.stdout, done.stderr

    def read_translation(self, name):
        return np.array(json.loads((self.folder / name).read_text())["trace"]["device_to_world"]["translation_m"])

    def test_a_miss_is_said_before_and_after(self):
        self.assertIn(f"argil: note: {MISS}scene.json brings the motion onto it\n", self.call("validate", "scene.json")[1])
        error = self.call("run", "scene.json", "-o", "miss.h5")[1]
        self.assertIn(f"argil: note: {MISS}", error)
        self.assertIn(f"argil: note: no tick had contact: {MISS}", error)
        self.assertIn(MISS, self.call("info", "miss.h5")[0])
        self.assertEqual(self.call("run", "scene.json", "-o", "miss.h5", "--quiet")[1], "")

    def test_the_nearest_place_is_touched_as_deep_as_asked(self):
        out = self.call("place", "scene.json", "-o", "patch.json")[0]
        self.assertIn("body      (-0.04, -0.04, 0) to (0.04, 0.04, 0.04) m", out)
        self.assertIn(f"path      (-0.016, -0.003, 0.9) to (0.024, -0.003, 0.92) m", out)
        self.assertIn("nearest   0.854 m apart at 0.03 s, beside (0.004, -0.003, 0.04) m of the body", out)
        self.assertIn("touches   0.0015 m deep at 0.03 s, beside (0.004, -0.003, 0.04) m of the body", out)
        down = TOP + RADIUS - RADIUS / 4 - LOWEST
        np.testing.assert_allclose(self.read_translation("patch.json"), [0, 0, down], atol=2e-8)
        error = self.call("run", "scene.json", "--patch", "patch.json", "-o", "touch.h5")[1]
        self.assertNotIn("never comes nearer", error)
        self.assertNotIn("no tick", error)
        with h5py.File(self.folder / "touch.h5") as file:
            self.assertAlmostEqual(file["haptic/tool_position"][:, 2].min(), LOWEST + down, delta=2e-8)
            force = file["haptic/force"][:]
        self.assertGreater(force[:, 2].max(), 0.01)
        self.assertIn("nearest   0.0015 m deep", self.call("place", "scene.json", "--patch", "patch.json", "-o", "p.json")[0])
        # A motion that goes too deep comes out again.
        self.call("place", "scene.json", "--depth", "0.0005", "--set", "/trace/device_to_world/translation_m=[0,0,-0.858]",
                  "-o", "again.json")
        np.testing.assert_allclose(self.read_translation("again.json"), [0, 0, down + 0.001], atol=2e-8)

    def test_the_command_that_is_printed_is_the_next_one(self):
        other = (self.folder / "swing.csv").rename(self.folder / "another swing.csv").name
        words = ("--trace", other, "--set", "/material/youngs_modulus_Pa=5e4")
        note = self.call("validate", "scene.json", *words)[1]
        self.assertIn(f"argil place scene.json --trace '{other}' brings the motion onto it", note)
        out = self.call("place", "scene.json", *words, "-o", "patch.json")[0]
        command = out.splitlines()[-1].split(": argil ", 1)[1]
        self.assertEqual(shlex.split(command), ["run", "scene.json", "--patch", "patch.json", *words[2:], *words[:2]])
        self.assertNotIn("no tick", self.call(*shlex.split(command), "-o", "next.h5")[1])

    def test_a_result_is_a_motion_that_lies_in_the_world(self):
        self.call("place", "scene.json", "-o", "patch.json")
        self.call("run", "scene.json", "--patch", "patch.json", "-o", "touch.h5")
        error = self.call("run", "scene.json", "--patch", "patch.json", "--trace", "touch.h5", "-o", "again.h5")[1]
        self.assertIn("/trace/device_to_world are not applied to them again", error)
        with h5py.File(self.folder / "touch.h5") as first, h5py.File(self.folder / "again.h5") as again:
            path = first["haptic/tool_position"][:]
            # A result begins at its first tick: its motion is a tick behind.
            np.testing.assert_array_equal(again["haptic/tool_position"][:], path[1:])
        error = self.call("place", "scene.json", "--trace", "touch.h5", code=2)[1]
        self.assertIn("touch.h5: is a result, whose places are the tool's in the world; place the recording", error)

    def test_a_given_place_is_touched_from_a_given_side(self):
        self.call("place", "scene.json", "--at", "0.01,0.02,0.04", "--from", "0,0,2", "--depth", "0.001", "-o", "top.json")
        np.testing.assert_allclose(self.read_translation("top.json"), [0.006, 0.023, TOP + RADIUS - 0.001 - LOWEST], atol=2e-8)
        # From the side: the pose that goes farthest towards +x is the last one, 24 mm beside the origin and 0.92 m above.
        out = self.call("place", "scene.json", "--at", "-0.04,0.01,0.02", "--from", "-1,0,0", "--depth", "0.001")[0]
        patch = json.loads(out[out.index("{"):])["trace"]["device_to_world"]["translation_m"]
        np.testing.assert_allclose(patch, [-0.04 - RADIUS + 0.001 - 0.024, 0.013, -0.9], atol=2e-8)

    def test_a_place_that_is_met_aslant_is_the_deepest(self):
        # From 45°: the pose that goes farthest is that at 15 ms, and the ball's middle ends above the place.
        s = math.sqrt(0.5)
        out = self.call("place", "scene.json", "--at", "0.01,0.02,0.04", "--from", "1,0,1", "--depth", "0.001", "-o", "p.json")[0]
        down = TOP + RADIUS - 0.001 - (LOWEST + 0.02 * (1 - s))
        np.testing.assert_allclose(self.read_translation("p.json"), [0.01 - (0.004 - 0.02 * s), 0.023, down], atol=1e-5)
        self.assertIn("touches   0.001 m deep at 0.015 s", out)
        self.assertRegex(out, r"deepest   0.00685\d m deep at 0.03 s")

    def test_a_ball_whose_cells_follow_the_motion_is_touched_as_deep(self):
        self.write_scene({"kind": "sphere", "size_m": 0.04, "target_tets": 2000, "skin_triangles": 0}, "graded")
        for extra in ((), ("--at", "0,0.012,0.036", "--from", "0,0.6,0.8")):
            self.call("place", "scene.json", *extra, "--depth", "0.001", "-o", "patch.json")
            out = self.call("place", "scene.json", "--patch", "patch.json", "-o", "p.json")[0]
            depth = float(re.search(r"nearest +([0-9.e-]+) m deep", out)[1])
            self.assertAlmostEqual(depth, 0.001, delta=2e-5)
            with_patch = ("run", "scene.json", "--patch", "patch.json", "-o", "touch.h5")
            self.assertNotIn("no tick", self.call(*with_patch)[1])

    def test_what_is_added_to_the_motion_is_taken_from_the_translation(self):
        shift = np.array([0.3, -0.2, 0.1])
        self.call("place", "scene.json", "--at", "0,0,0.04", "--from", "0,1,3", "-o", "one.json")
        write_swing(self.folder / "swing.csv", shift)
        self.call("place", "scene.json", "--at", "0,0,0.04", "--from", "0,1,3", "-o", "other.json")
        np.testing.assert_allclose(self.read_translation("other.json") + shift, self.read_translation("one.json"), atol=3e-8)

    def test_a_motion_in_millimetres_is_said(self):
        write_swing(self.folder / "swing.csv", length=20.0)
        in_metres = ("--set", '/trace/length_unit="m"')  # nobody's hand, unless one says so
        self.assertIn("times larger than the body", self.call("place", "scene.json", *in_metres, "-o", "p.json")[0])

    def test_what_cannot_be_placed_is_refused(self):
        for arguments, words in ((["--at", "0,0"], "is not X,Y,Z"),
                                 (["--at", "0,0,nan", "--from", "0,0,1"], "is not X,Y,Z"),
                                 (["--at", "0,0,0.04"], "go together"),
                                 (["--from", "0,0,1"], "go together"),
                                 (["--at", "0,0,0.04", "--from", "0,0,0"], "is no direction"),
                                 (["--at", "0,0.2,0.04", "--from", "0,0,1"], "is no place where the tool meets the body"),
                                 (["--depth", "0.007"], "is more than the tool's radius, 0.006 m"),
                                 (["-o", "scene.json"], "would be overwritten"),
                                 # It begins as low as it ever is.
                                 (["--set", "/trace/start_s=0.03"], "then starts in or across the body, 0.0015 m deep")):
            error = self.call("place", "scene.json", *arguments, code=2)[1]
            self.assertIn(words, error)
        self.call("run", "scene.json", "--patch", "nowhere.json", code=2)
        (self.folder / "list.json").write_text("[1]")
        self.assertIn("is not an object", self.call("run", "scene.json", "--patch", "list.json", code=2)[1])
        (self.folder / "null.json").write_text('{"trace": {"start_s": null}}')
        self.assertIn("null.json: /trace/start_s: is null", self.call("run", "scene.json", "--patch", "null.json", code=2)[1])


if __name__ == "__main__":
    unittest.main()
