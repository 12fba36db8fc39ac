#!/usr/bin/python3
"""`argil new`: the scenario that it writes of a mesh and a motion is short, valid and runs as it is, in whatever unit they
are, and wherever the motion is. Sizes and places are those of bodies made here.

Usage: test_new.py ARGIL        the program
"""
import csv
import json
import math
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import h5py
import numpy as np

ROOT = Path(__file__).resolve().parents[3]
ARGIL = str(Path(sys.argv.pop(1)).resolve())
CORNERS = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0), (0, 0, 1), (1, 0, 1), (0, 1, 1), (1, 1, 1)]
FACES = [(1, 3, 4), (1, 4, 2), (5, 6, 8), (5, 8, 7), (1, 2, 6), (1, 6, 5), (3, 7, 8), (3, 8, 4), (1, 5, 7), (1, 7, 3),
         (2, 4, 8), (2, 8, 6)]
TETS = [(0, 1, 3, 7), (0, 3, 2, 7), (0, 2, 6, 7), (0, 6, 4, 7), (0, 4, 5, 7), (0, 5, 1, 7)]  # of a cube, all of one hand


def cube_vertices(size):
    return [tuple(size * x for x in corner) for corner in CORNERS]


def write_obj(file, size, shift=(0, 0, 0)):
    lines = ["v %g %g %g" % tuple(a + b for a, b in zip(v, shift)) for v in cube_vertices(size)]
    file.write_text("\n".join(lines + ["f %d %d %d" % face for face in FACES]) + "\n")


def write_msh(file, size):
    nodes = "\n".join(f"{i + 1} {x} {y} {z}" for i, (x, y, z) in enumerate(cube_vertices(size)))
    tets = "\n".join("%d 4 2 0 1 %s" % (i + 1, " ".join(str(v + 1) for v in tet)) for i, tet in enumerate(TETS))
    file.write_text(f"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n8\n{nodes}\n$EndNodes\n$Elements\n6\n{tets}\n$EndElements\n")


def write_vtu(file, size):
    points = " ".join("%g %g %g" % v for v in cube_vertices(size))
    cells = " ".join(str(v) for tet in TETS for v in tet)
    array = '<DataArray type="%s" Name="%s" NumberOfComponents="%d" format="ascii">%s</DataArray>'
    file.write_text('<VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian"><UnstructuredGrid>'
                    '<Piece NumberOfPoints="8" NumberOfCells="6"><Points>' + array % ("Float64", "p", 3, points) +
                    "</Points><Cells>" + array % ("Int32", "connectivity", 1, cells) +
                    array % ("Int32", "offsets", 1, "4 8 12 16 20 24") + array % ("UInt8", "types", 1, "10 " * 6) +
                    "</Cells></Piece></UnstructuredGrid></VTKFile>")


def write_tap(file, above, deep, unit=1.0, middle=0.02, ticks=100):
    """A point that goes down by `deep` over the middle of the cube's top, and up again, in 0.1 s."""
    rows = ["t,x,y,z"]
    for k in range(ticks + 1):
        z = above - deep * math.sin(math.pi * k / ticks)
        rows.append(f"{k / 1000},{middle / unit:.9g},{middle / unit:.9g},{z / unit:.9g}")
    file.write_text("\n".join(rows) + "\n")


class New(unittest.TestCase):
    def setUp(self):
        self.temp = tempfile.TemporaryDirectory()
        self.addCleanup(self.temp.cleanup)
        self.folder = Path(self.temp.name)
        write_obj(self.folder / "cube.obj", 40)                             # mm
        write_tap(self.folder / "tap.csv", 0.0455, 0.0015, unit=1e-3)       # mm; ball of 5 mm: 1 mm deep at last

    def call(self, *arguments, code=0):
        done = subprocess.run([ARGIL, *arguments], cwd=self.folder, capture_output=True, text=True, timeout=300)
        self.assertEqual(done.returncode, code, f"{arguments}: {done.stdout}{done.stderr}")
        return done.stdout if code == 0 else done.stderr

    def read(self, name):
        return json.loads((self.folder / name).read_text())

    def peak(self, scenario):
        """Valid, and the force [N] that a run of it has at its largest, with the time [s] of that."""
        self.assertIn(": valid\n", self.call("validate", scenario))
        self.call("run", scenario, "-o", "out.h5", "--quiet")
        with h5py.File(self.folder / "out.h5") as file:
            force = np.linalg.norm(file["haptic/force"][:], axis=1)
            return force.max(), file["haptic/time"][force.argmax()]

    def test_surface_and_motion_in_millimetres(self):
        out = self.call("new", "cube.obj", "tap.csv", "--set", "/trace/length_unit=mm")
        self.assertIn("cube.obj: taken in mm: in metres the body would be 69.28 m wide", out)
        self.assertIn("cube.obj: 40 × 40 × 40 mm\n", out)
        self.assertTrue(out.endswith("next: argil run cube.json\n"), out)
        made = self.read("cube.json")
        self.assertEqual(made["body"]["surface"], {"file": "cube.obj", "scale": 0.001})
        self.assertEqual(made["tool"]["shape"], {"kind": "sphere", "radius_m": 0.005})  # an eighth of 40 mm
        self.assertEqual(made["trace"], {"file": "tap.csv", "length_unit": "mm"})       # and is not moved
        self.assertEqual(made["body"]["fixed"][0]["kind"], "box")
        self.assertAlmostEqual(made["body"]["fixed"][0]["upper_m"][2], 0.0008, delta=2e-6)  # 2 % of 40 mm
        self.assertEqual(self.read(made["$schema"])["title"], "argil scenario")
        force, time = self.peak("cube.json")
        # Hertz gives 4/3 E/(1 − ν²) √R d^{3/2} = 0.33 N of elastic clay; this clay flows, at 6.2 π a² c_u = 0.15 N at a² = R d.
        self.assertGreater(force, 0.1)
        self.assertLess(force, 0.35)
        self.assertAlmostEqual(time, 0.05, delta=0.005)

    def test_a_motion_out_of_all_reason_beside_the_body_is_taken_in_millimetres(self):
        write_tap(self.folder / "fast.csv", 0.055, 0.011, unit=1e-3)  # 11 m in 0.05 s if it were metres
        for name, words in (("fast.csv", "fast.csv: taken in mm: the motion is 11 m wide"),
                            ("tap.csv", "tap.csv: taken in mm: place ")):
            with self.subTest(name):
                if name == "tap.csv":  # slower than a hand and narrower than 5 m, but 50 m from the origin if it were metres
                    write_tap(self.folder / name, 0.0455, 0.0026, unit=1e-3, ticks=2000)
                out = self.call("new", "cube.obj", name, "--force")
                self.assertIn(words, out)
                self.assertEqual(self.read("cube.json")["trace"]["length_unit"], "mm")
                self.assertIn(": valid\n", self.call("validate", "cube.json"))

    def test_units_that_are_given_are_kept(self):
        self.call("new", "cube.obj", "tap.csv", "--mesh-unit", "cm", "--trace-unit", "cm")
        made = self.read("cube.json")
        self.assertEqual((made["body"]["surface"]["scale"], made["trace"]["length_unit"]), (0.01, "cm"))
        self.assertIn("is no unit of length", self.call("new", "cube.obj", "tap.csv", "-o", "b.json", "--mesh-unit", "ell", code=2))

    def test_tetrahedral_meshes_in_metres(self):
        write_tap(self.folder / "tap.csv", 0.0465, 0.0015)
        for name, write in (("cube.msh", write_msh), ("cube.vtu", write_vtu)):
            with self.subTest(name):
                write(self.folder / name, 0.04)
                out = self.call("new", name, "tap.csv", "-o", "tets.json", "--force", "--youngs-modulus", "2e4",
                                "--strength", "500", "--tool-radius", "0.006")
                self.assertNotIn("taken in", out)
                made = self.read("tets.json")
                self.assertEqual(made["body"]["mesh"], {"file": name})
                self.assertEqual(made["material"]["youngs_modulus_Pa"], 2e4)
                self.assertEqual(made["material"]["plasticity"]["strength_Pa"], 500)
                self.assertEqual(made["tool"]["shape"]["radius_m"], 0.006)
                self.assertEqual(made["trace"], {"file": "tap.csv"})
                self.assertGreater(self.peak("tets.json")[0], 0.01)

    def test_a_table_that_numpy_saved_is_the_motion_that_its_text_is(self):
        rows = np.loadtxt(self.folder / "tap.csv", delimiter=",", skiprows=1)
        with_more = np.insert(rows, 2, 20.0, axis=1)  # a column that is left out
        columns = '/trace/columns=["t","x","-","y","z"]'
        for name, array in (("c.npy", with_more), ("f.npy", np.asfortranarray(with_more)), ("big.npy", with_more.astype(">f8"))):
            np.save(self.folder / name, array)
            with self.subTest(name):
                self.call("new", "cube.obj", name, "-o", "npy.json", "--force", "--set", columns, "--trace-unit", "mm")
                self.call("new", "cube.obj", "tap.csv", "-o", "csv.json", "--force", "--trace-unit", "mm")
                paths = []
                for scenario in ("npy", "csv"):
                    self.call("run", f"{scenario}.json", "-o", f"{scenario}.h5", "--quiet")
                    with h5py.File(self.folder / f"{scenario}.h5") as file:
                        paths.append((file["haptic/tool_position"][:], file["haptic/force"][:]))
                np.testing.assert_array_equal(paths[0], paths[1])
        error = self.call("new", "cube.obj", "c.npy", "-o", "n.json", code=2)
        self.assertIn('101 × 5 numbers without names of the columns; name them from the left by /trace/columns', error)

    def test_a_body_far_below_the_path_is_touched_as_place_proposes(self):
        write_obj(self.folder / "cube.obj", 0.04, shift=(0, 0, -0.5))
        write_tap(self.folder / "tap.csv", 0.0455, 0.0015)
        out = self.call("new", "cube.obj", "tap.csv", "-o", "far.json")
        self.assertIn("the tool never comes nearer than 499 mm", out)  # 44 mm less the ball's 5 mm, above −460 mm
        made = self.read("far.json")
        moved = np.array(made["trace"]["device_to_world"]["translation_m"])
        np.testing.assert_allclose(moved, [0, 0, -0.499 - 0.00125], atol=1e-6)
        del made["trace"]["device_to_world"]
        (self.folder / "unmoved.json").write_text(json.dumps(made))
        self.call("place", "unmoved.json", "-o", "patch.json")
        np.testing.assert_allclose(moved, self.read("patch.json")["trace"]["device_to_world"]["translation_m"], atol=1e-6)
        self.assertGreater(self.peak("far.json")[0], 0.05)

    def test_a_body_far_beside_the_path_is_touched_where_the_motion_can_begin(self):
        # Along the line where they are nearest the ball would slide down a corner that it begins in.
        write_obj(self.folder / "cube.obj", 0.04, shift=(0.7, -0.3, 0))
        write_tap(self.folder / "tap.csv", 0.0455, 0.0015)
        out = self.call("new", "cube.obj", "tap.csv", "-o", "far.json")
        self.assertIn(f"the tool never comes nearer than {1e3 * (math.hypot(0.68, 0.28, 0.004) - 0.005):.4g} mm", out)
        self.assertGreater(self.peak("far.json")[0], 0.01)

    def test_a_motion_that_begins_in_the_body_is_moved_out(self):
        write_obj(self.folder / "cube.obj", 0.04)
        write_tap(self.folder / "tap.csv", 0.035, 0.015)  # the ball's middle begins 5 mm below the top
        out = self.call("new", "cube.obj", "tap.csv")
        self.assertIn("the tool starts in the body; moved by /trace/device_to_world/translation_m [", out)
        self.assertGreater(self.peak("cube.json")[0], 0.05)
        # A motion that only rises begins where it is deepest, and from below it would meet the foot; turned it is a press.
        rows = ["t,x,y,z"] + [f"{k / 1000},0.02,0.02,{0.03 + 0.0001 * k}" for k in range(101)]
        (self.folder / "up.csv").write_text("\n".join(rows) + "\n")
        remedy = self.call("new", "cube.obj", "up.csv", code=2, *("-o", "up.json")).split("for instance by ")[1].split()
        self.call("new", "cube.obj", "up.csv", "-o", "up.json", *remedy)
        self.assertGreater(self.peak("up.json")[0], 0.001)

    def test_the_lowest_part_along_another_axis(self):
        out = self.call("new", "cube.obj", "tap.csv", "--up", "y", "--set", "/trace/length_unit=mm")
        self.assertIn("along y", out)
        fixed = self.read("cube.json")["body"]["fixed"][0]
        self.assertAlmostEqual(fixed["upper_m"][1], 0.0008, delta=2e-6)
        self.assertGreater(fixed["upper_m"][2], 0.04)

    def test_nothing_is_written_over_and_nothing_where_it_is_refused(self):
        (self.folder / "cube.json").write_text("mine")
        self.assertIn("cube.json: is there already; give another name by -o, or --force",
                      self.call("new", "cube.obj", "tap.csv", code=2))
        self.assertEqual((self.folder / "cube.json").read_text(), "mine")
        self.call("new", "cube.obj", "tap.csv", "--force")
        self.assertIn("/trace/max_gap", self.call("new", "cube.obj", "tap.csv", "-o", "b.json", "--set",
                                                  "/trace/max_gap=1", code=2))
        self.assertIn("-o", self.call("new", "cube.obj", "tap.csv", "-o", "tap.csv", "--force", code=2))
        self.assertFalse((self.folder / "b.json").exists())
        (self.folder / "argil.schema.json").write_text("{}")
        self.assertIn("no schema of argil's", self.call("new", "cube.obj", "tap.csv", "-o", "c.json", code=2))
        self.assertEqual((self.folder / "argil.schema.json").read_text(), "{}")

    def test_a_surface_with_a_hole_is_met_as_the_solid_that_is_made_of_it(self):
        write_tap(self.folder / "tap.csv", 0.0455, 0.0015)
        write_obj(self.folder / "open.obj", 0.04)
        (self.folder / "open.obj").write_text("\n".join((self.folder / "open.obj").read_text().splitlines()[:-1]) + "\n")
        self.assertIn("the tool meets the solid that is made of it, by /contact/surface", self.call("new", "open.obj", "tap.csv"))
        self.assertEqual(self.read("open.json")["contact"], {"surface": "cage"})
        self.assertGreater(self.peak("open.json")[0], 0.05)
        self.call("new", "cube.obj", "tap.csv")
        self.assertNotIn("contact", self.read("cube.json"))

    def test_further_keys_are_written(self):
        self.call("new", "cube.obj", "tap.csv", "--set", "/contact/friction=0.2", "--set", "/about=mine",
                  "--set", "/trace/length_unit=mm")
        made = self.read("cube.json")
        self.assertEqual((made["about"], made["contact"]["friction"]), ("mine", 0.2))


class FirstTry(unittest.TestCase):
    """scripts/first_try.py on a folder of which each file's end is known."""

    def test_each_remedy_is_followed_and_told_of(self):
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name, "files")
            folder.mkdir()
            write_tap(folder / "plain.csv", 0.0655, 0.0015, middle=0.03)
            rows = np.loadtxt(folder / "plain.csv", delimiter=",", skiprows=1)
            turned = "".join("%g,%g,%g,%g,1,0,0,0\n" % tuple(row) for row in rows)
            (folder / "numbered.csv").write_text("t,x,y,z,q0,q1,q2,q3\n" + turned)
            np.save(folder / "told.npy", rows[:, 1:])
            (folder / "not_a_motion.csv").write_text("a,b\n1,2\n3,4\n")
            write_msh(folder / "cube.msh", 0.04)
            write_obj(folder / "open.obj", 0.04)
            (folder / "open.obj").write_text("\n".join((folder / "open.obj").read_text().splitlines()[:-1]) + "\n")
            known = Path(name, "known.json")
            known.write_text(json.dumps({"told.npy": {"/trace/columns": ["x", "y", "z"], "/trace/default_rate_hz": 1000}}))
            table = Path(name, "table.csv")
            done = subprocess.run([ROOT / "scripts/first_try.py", ARGIL, folder, "-o", table, "--known", known],
                                  capture_output=True, text=True, timeout=300)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            with open(table, newline="", encoding="utf-8") as text:
                found = {row["file"]: (row["kind"], row["how"], row["set"]) for row in csv.DictReader(text)}
        self.assertEqual(found, {
            "plain.csv": ("motion", "at first try", ""),
            "numbered.csv": ("motion", "by the remedy", "--set /trace/quaternion_order=wxyz"),
            "told.npy": ("motion", "as its source tells",
                         '--set /trace/columns=["x", "y", "z"]; --set /trace/default_rate_hz=1000'),
            "not_a_motion.csv": ("motion", "refused", ""),
            "cube.msh": ("mesh", "at first try", ""),
            "open.obj": ("mesh", "at first try", "")})


if __name__ == "__main__":
    unittest.main()
