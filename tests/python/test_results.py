#!/usr/bin/python3
"""Results are read when they are asked for, with unit and meaning; figures show them; the example runs.

Usage: test_results.py ARGIL PACKAGE        the program, and the folder that the package lies in
Expected values: what h5py reads of the file of `argil run`; the numbers that a table was written with.
"""
import os
import subprocess
import sys
import tempfile
import unittest
import warnings
from pathlib import Path

import h5py
import matplotlib
import numpy as np

matplotlib.use("Agg")
ARGIL, PACKAGE = (str(Path(word).resolve()) for word in sys.argv[1:3])
del sys.argv[1:3]
sys.path.insert(0, PACKAGE)
sys.dont_write_bytecode = True
import argil  # noqa: E402
import argil.plot  # noqa: E402

ROOT = Path(__file__).resolve().parents[2]
BALL = ROOT / "tests/golden/ball.json"


class Results(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="argil_results_")
        cls.addClassCleanup(folder.cleanup)
        cls.folder = Path(folder.name)
        cls.file = str(cls.folder / "ball.h5")
        subprocess.run([ARGIL, "run", BALL, "--set", "/haptics/frame_period_ticks=28", "--set",
                        "/haptics/physics_period_ticks=2", "--set", "/haptics/water_period_ticks=2", "-o", cls.file, "--quiet"], check=True)

    def setUp(self):
        self.result = argil.open(self.file)
        self.addCleanup(self.result.close)
        self.h5 = h5py.File(self.file)
        self.addCleanup(self.h5.close)

    def test_every_dataset_is_an_attribute_with_its_unit_and_meaning(self):
        def compare(ours, theirs):
            for name, node in theirs.items():
                found = getattr(ours, name)
                if isinstance(node, h5py.Group):
                    compare(found, node)
                elif node.shape == ():
                    self.assertEqual(found, node.asstr()[()], name)
                else:
                    np.testing.assert_array_equal(found, node[()], err_msg=name)
                    self.assertEqual(found.units, node.attrs["units"].decode(), name)
                    self.assertEqual(found.about, node.attrs["about"].decode(), name)

        for group in ("haptic", "physics", "mesh", "provenance"):
            compare(getattr(self.result, group), self.h5[group])

    def test_names_without_a_group_are_those_of_the_ticks_first(self):
        self.assertEqual((self.result.force.shape, self.result.force.units), ((84, 3), "N"))
        self.assertEqual(len(self.result.time), 84)
        self.assertEqual(len(self.result.physics.time), 42)
        np.testing.assert_array_equal(self.result.kinetic_energy, self.h5["physics/kinetic_energy"][:])
        np.testing.assert_array_equal(self.result.tets, self.h5["mesh/tets"][:])
        self.assertIn("kinetic_energy", dir(self.result))

    def test_nothing_is_read_before_it_is_asked_for(self):
        read = []
        original = h5py.Dataset.__getitem__

        def watch(dataset, key, *rest, **options):
            read.append(dataset.name)
            return original(dataset, key, *rest, **options)

        h5py.Dataset.__getitem__ = watch
        try:
            with argil.open(self.file) as result:
                frames = result.frames
                self.assertEqual((len(frames), read), (4, []))
                frame = frames[-1]
                self.assertEqual((frame.tick, frame.time, read), (84, 0.084, []))
                self.assertEqual(frame.position.units, "m")
                self.assertEqual(read, ["/frames/000003/position"])
                result.torque  # pylint: disable=pointless-statement
                self.assertEqual(read[1:], ["/haptic/torque"])
                np.testing.assert_array_equal(result["haptic/force"][3:5],
                                              original(self.h5["haptic/force"], slice(3, 5)))
        finally:
            h5py.Dataset.__getitem__ = original

    def test_arrays_are_numpys_and_units_go_with_parts_only(self):
        force = self.result.force
        self.assertIsInstance(force, np.ndarray)
        self.assertEqual(force[10:20, 2].units, "N")
        for other in (force * force, force @ np.ones(3), np.linalg.norm(force, axis=1), force.sum(axis=0)):
            self.assertIs(type(other), np.ndarray)
        self.assertIsInstance(force.max(), float)
        self.result.close()
        self.assertGreater(force.max(), 1.0)  # stays

    def test_how_a_run_ended_and_what_is_not_there(self):
        self.assertEqual((self.result.outcome, self.result.is_complete), ("done", True))
        self.assertEqual(self.result.attrs["haptic_period_s"], 1e-3)
        with self.assertRaisesRegex(AttributeError, "no forces; there is .*force"):
            self.result.forces  # pylint: disable=pointless-statement
        with self.assertRaisesRegex(AttributeError, "no velocity in /frames/000000; there is plastic_strain"):
            self.result.frames[0].velocity  # pylint: disable=pointless-statement
        self.assertEqual([frame.tick for frame in self.result.frames[1:]], [28, 56, 84])
        self.assertEqual([frame.tick for frame in self.result.frames], [0, 28, 56, 84])

    def test_what_is_no_result(self):
        text = self.folder / "text.h5"
        text.write_text("no HDF5")
        with h5py.File(self.folder / "other.h5", "w"):
            pass
        for name, kind, words in (("none.h5", argil.IoError, "none.h5: cannot be read"),
                                  ("text.h5", argil.IoError, "text.h5: is no HDF5 file"),
                                  ("other.h5", argil.InputError, "other.h5: is not a result file of argil run")):
            with self.assertRaisesRegex(kind, words):
                argil.open(self.folder / name)

    def lines(self, figure, panel=0):
        return {line.get_label(): line.get_xydata() for line in figure.axes[panel].lines
                if not line.get_label().startswith("_")}

    def test_figures_show_what_the_file_holds(self):
        style = dict(matplotlib.rcParams)
        force = self.lines(argil.plot.force(self.file, self.result, labels=["one", "two"]))
        for line in (force["one"], force["two"]):
            np.testing.assert_array_equal(line[:, 0], self.h5["haptic/time"][:])
            np.testing.assert_array_equal(line[:, 1], np.linalg.norm(self.h5["haptic/force"][:], axis=1))
        energy = argil.plot.energy(self.result)
        elastic = self.lines(energy)["elastic"]
        unit = {"[J]": 1, "[mJ]": 1e-3, "[µJ]": 1e-6}[energy.axes[0].get_ylabel().split()[-1]]
        np.testing.assert_allclose(elastic[:, 1] * unit, self.h5["physics/elastic_energy"][:], rtol=1e-14)
        np.testing.assert_allclose(self.lines(argil.plot.water(self.file))["mean of the body"][:, 1], 0.2, rtol=1e-12)
        self.assertEqual(dict(matplotlib.rcParams), style)
        with self.assertRaisesRegex(argil.InputError, "1 files but 2 labels"):
            argil.plot.force(self.file, labels=["one", "two"])

    def test_figures_of_tables(self):
        table = self.folder / "sweep.csv"
        rows = "".join(f"{k},{k},{k},{3 * k},done\n" for k in range(4))
        table.write_text("# argil sweep\nindex,id,a,peak_force_N,outcome\n" + rows)
        drawn = argil.plot.sweep(table).axes[0].lines[0].get_xydata()
        np.testing.assert_array_equal(drawn, [(k, 3 * k) for k in range(4)])
        for draw, name in ((argil.plot.chart, "chart/light_press.csv"), (argil.plot.stability, "stability/sliver.csv")):
            self.assertGreater(len(draw(ROOT / "results" / name).axes[0].lines), 2)
            with self.assertRaisesRegex(argil.InputError, "is not a table of argil"):
                draw(table)

    def test_saved_figures_and_a_word_where_a_run_did_not_end(self):
        files = argil.plot.save(argil.plot.force(self.file), self.folder / "new" / "force.png")
        self.assertEqual([file.name for file in files], ["force.png", "force.pdf"])
        self.assertTrue(all(file.stat().st_size > 5000 for file in files))
        short = self.folder / "short.h5"
        short.write_bytes(Path(self.file).read_bytes())
        with h5py.File(short, "r+") as file:
            file.attrs["complete"] = 0
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always")
            argil.plot.force(short)
        self.assertIn(f"{short}: the run did not reach its end; drawing what there is",
                      [str(word.message) for word in said])

    def test_results_are_read_where_nothing_was_built(self):
        script = f"import sys; sys.path.insert(0, {str(ROOT / 'src/python')!r}); import argil, argil.plot; " \
                 f"print(len(argil.open({self.file!r}).force))"
        done = subprocess.run([sys.executable, "-B", "-c", script], capture_output=True, text=True)
        self.assertEqual((done.stdout, done.stderr), ("84\n", ""))

    def test_the_example_runs(self):
        done = subprocess.run([sys.executable, "-B", ROOT / "examples/first_press.py"], cwd=self.folder,
                              capture_output=True, text=True, env={**os.environ, "PYTHONPATH": PACKAGE, "MPLBACKEND": "Agg"})
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertIn('did you mean "youngs_modulus_Pa"?', done.stdout)
        out = self.folder / "first_press"
        peaks = {name: np.linalg.norm(argil.open(out / f"{name}.h5").force, axis=1).max()
                 for name in ("dry", "wet", "own")}
        self.assertLess(peaks["wet"], 0.8 * peaks["dry"])
        self.assertLess(peaks["own"], 0.99 * peaks["dry"])
        for name in ("force", "energy", "own"):
            self.assertTrue((out / f"{name}.png").is_file(), name)


if __name__ == "__main__":
    unittest.main()
