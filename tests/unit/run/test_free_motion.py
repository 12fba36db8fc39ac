#!/usr/bin/python3
"""A body that its supports leave free to turn or to shift in a motion: validate, run and info say so, and how. Axes and their numbers
are those of a rigid body with a few points held, by hand.

Usage: test_free_motion.py ARGIL        the program
"""
import json
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ARGIL = str(Path(sys.argv.pop(1)).resolve())
SIDE, TOP = 0.08, 0.04  # [m] of the block, which stands on z = 0 about the axis
NOTE = "argil: note: supports: "


def box(lower, upper, **more):
    """What is within half a millimetre of a box."""
    return {"kind": "box", "lower_m": [x - 5e-4 for x in lower], "upper_m": [x + 5e-4 for x in upper], **more}


EDGE = box((-SIDE / 2, -SIDE / 2, 0), (-SIDE / 2, SIDE / 2, 0))  # of the foot, along y
CORNER = box((-SIDE / 2, -SIDE / 2, 0), (-SIDE / 2, -SIDE / 2, 0))
OTHER_CORNER = box((SIDE / 2, -SIDE / 2, 0), (SIDE / 2, -SIDE / 2, 0))
FOOT = {"kind": "plane", "normal": [0, 0, 1], "offset_m": 0}


class FreeMotion(unittest.TestCase):
    def setUp(self):
        self.temp = tempfile.TemporaryDirectory()
        self.addCleanup(self.temp.cleanup)
        self.folder = Path(self.temp.name)
        (self.folder / "still.csv").write_text("t,x,y,z\n0,0,0,0.2\n0.003,0,0,0.2\n")

    def call(self, *arguments):
        done = subprocess.run([ARGIL, *arguments], cwd=self.folder, capture_output=True, text=True, timeout=300)
        self.assertEqual(done.returncode, 0, f"{arguments}: {done.stdout}{done.stderr}")
        return done.stdout, done.stderr

    def validate(self, *fixed, cells="even"):
        """The words of the note after who is free."""
        (self.folder / "scene.json").write_text(json.dumps({
            "about": "a block with little that holds it",
            "body": {"shape": {"kind": "box", "size_m": TOP, "slenderness": 0.5, "target_tets": 400, "skin_triangles": 0},
                     "cells": {"kind": cells}, "fixed": list(fixed)},
            "material": {"youngs_modulus_Pa": 1e5, "poissons_ratio": 0.3, "clay_kernel": {"form": "off"}},
            "tool": {"shape": {"kind": "sphere", "radius_m": 0.006}, "mode": "push"},
            "trace": {"file": "still.csv"}}))
        lines = [line for line in self.call("validate", "scene.json")[1].splitlines() if line.startswith(NOTE)]
        self.assertLessEqual(len(lines), 1)
        return lines[0].removeprefix(NOTE).replace("-", "") if lines else ""

    def test_held_along_an_edge_it_turns_about_that(self):
        note = self.validate(EDGE)
        self.assertIn("the body can turn about an axis along (0, 1, 0) near (0.04, 0, 0) m, held by its mass alone; ", note)
        self.assertIn("hold at least three vertices of it that are not on a line", note)

    def test_held_at_two_corners_it_turns_about_the_line_between_them(self):
        self.assertIn("turn about an axis along (1, 0, 0) near (0, 0.04, 0) m", self.validate(CORNER, OTHER_CORNER))

    def test_held_at_one_corner_it_turns_about_any_axis(self):
        note = self.validate(CORNER)
        self.assertIn("can turn about an axis along ", note)
        self.assertIn(", one of 3 free motions", note)

    def test_on_a_smooth_rail_it_shifts_along_that(self):
        self.assertIn("the body can shift along (1, 0, 0), held", self.validate({**FOOT, "fixes_x": False}))

    def test_a_foot_or_three_corners_hold_it(self):
        self.assertEqual(self.validate(FOOT), "")
        self.assertEqual(self.validate(CORNER, OTHER_CORNER, box((0.04, 0.04, 0), (0.04, 0.04, 0))), "")

    def test_where_all_is_held_that_is_said(self):
        self.assertIn("/body/fixed holds every vertex: the body cannot give way",
                      self.validate({"kind": "half_space", "normal": [0, 0, 1], "offset_m": 25}))

    def test_where_nothing_is_held_that_is_all_that_is_said(self):
        self.assertEqual(self.validate(), "")
        self.assertIn("nothing holds the body", self.call("validate", "scene.json")[1])

    def test_run_and_info_say_so_too(self):
        self.validate(EDGE)
        error = self.call("run", "scene.json", "-o", "free.h5")[1]
        self.assertEqual(error.count(NOTE), 1, error)
        self.assertIn("supports: the body can turn about an axis", self.call("info", "free.h5")[0])
        self.validate(FOOT)
        self.assertNotIn(NOTE, self.call("run", "scene.json", "-o", "held.h5")[1])
        self.assertNotIn("supports: ", self.call("info", "held.h5")[0])


if __name__ == "__main__":
    unittest.main()
