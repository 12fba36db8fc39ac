#!/usr/bin/python3
"""plot_sweep.py draws each point of a table once, refuses what it cannot draw, and counts what it leaves out. Tables are
written here; expected values: the numbers put in. Skipped (77) without matplotlib."""
import importlib.util
import itertools
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SCRIPTS = Path(__file__).resolve().parents[3] / "scripts"
if any(importlib.util.find_spec(name) is None for name in ("numpy", "h5py", "matplotlib")):
    print("skipped: needs numpy, h5py and matplotlib")
    sys.exit(77)
sys.path.insert(0, str(SCRIPTS))
sys.dont_write_bytecode = True
import argil_plot as ap
from argil.plot import sweep_figure


def write_table(file, outcome=lambda index: "done", **settings):
    """All combinations; the force of a point is its index."""
    lines = ["# argil sweep", "index,id," + ",".join(name.replace("__", ".") for name in settings)
             + ",peak_force_N,steps,outcome,reason"]
    for index, values in enumerate(itertools.product(*settings.values())):
        end = outcome(index)
        lines.append(f"{index},{index:x},{','.join(map(str, values))},{index if end == 'done' else ''},7,{end},"
                     + ("" if end == "done" else '"tick 3, solid: inverted"'))
    file.write_text("\n".join(lines) + "\n")
    return file


class PlotSweep(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.table = Path(folder.name) / "table.csv"

    def call(self, *arguments, expected=0):
        run = subprocess.run([SCRIPTS / "plot_sweep.py", self.table, *arguments], capture_output=True, text=True)
        self.assertEqual(run.returncode, expected, run.stderr)
        self.assertNotIn("Traceback", run.stderr)
        self.assertEqual(self.table.with_suffix(".png").exists(), expected == 0)
        return run.stderr

    def draw(self, x):
        """The drawing's axes."""
        rows, settings, _ = sweep_figure.read_table(self.table)
        others = sweep_figure.find_others(self.table, rows, settings, x)
        good, left_out = sweep_figure.count_left_out(rows, "peak_force_N")
        figure = sweep_figure.draw(good, x, "peak_force_N", others, left_out)
        self.addCleanup(ap.plt.close, figure)
        return figure.axes[0]

    def lines_of(self, axes):
        return sorted([tuple(map(float, pair)) for pair in line.get_xydata()] for line in axes.lines if len(line.get_xydata()))

    def test_a_line_for_each_combination_and_each_point_once(self):
        write_table(self.table, body__size_m=(1, 2), a__b_Pa=(5, 6), c=(8, 9))
        axes = self.draw("body.size_m")
        self.assertEqual(self.lines_of(axes), [[(1, i), (2, 4 + i)] for i in range(4)])
        self.assertEqual((axes.get_xlabel(), axes.get_ylabel()), ("size [m]", "peak force [N]"))
        self.assertEqual([text.get_text().strip() for text in axes.get_legend().get_texts()],
                         ["b [Pa]", "5", "6", "c [–]", "8", "9"])

    def test_text_is_an_axis_of_names_and_a_legend(self):
        write_table(self.table, dynamics__element=("p2", "p1"), body__size_m=(1, 2))
        axes = self.draw("dynamics.element")
        self.assertEqual([label.get_text() for label in axes.get_xticklabels()], ["p2", "p1"])
        self.assertEqual(self.lines_of(axes), [[(0, 0), (1, 2)], [(0, 1), (1, 3)]])
        self.assertEqual(axes.get_xlabel(), "element")
        self.assertEqual(self.lines_of(self.draw("body.size_m")), [[(1, 0), (2, 1)], [(1, 2), (2, 3)]])
        self.call("--x", "dynamics.element")

    def test_more_than_two_other_settings_are_refused_with_the_remedy(self):
        write_table(self.table, a=(1, 2), b=(1, 2), c=(1, 2), d=(1, 2), same=(3,))
        self.assertIn("3 settings vary besides a, a figure tells two apart: b, c, d; choose one value with --only",
                      self.call(expected=2))
        self.call("--only", "d=2.0")

    def test_more_values_than_dashes_are_refused(self):
        write_table(self.table, a=(1, 2), b=range(6), c=range(7))
        self.assertIn("b has 6 values, dashes tell 5 apart", self.call(expected=2))

    def test_points_without_the_figure_are_counted(self):
        write_table(self.table, lambda index: {1: "failed", 3: "missing"}.get(index, "done"), a=(1, 2, 3, 4))
        words = "2 of 4 points left out: 1 failed, 1 missing"
        self.assertEqual(self.draw("a").get_title(loc="left"), words)
        self.assertIn(words, self.call())

    def test_a_sweep_that_failed_whole_says_why(self):
        write_table(self.table, lambda index: "failed", a=(1, 2))
        self.assertIn("no point has peak_force_N (2 of 2 points left out: 2 failed); the first: tick 3, solid: inverted",
                      self.call(expected=2))

    def test_what_is_not_there_is_refused_with_what_is(self):
        self.assertIn("cannot be read", self.call(expected=2))
        self.table.write_text("a,b\n1,2\n")
        self.assertIn("is not a table of argil sweep collect", self.call(expected=2))
        write_table(self.table, a=(1, 2), b=(3, 4))
        self.assertIn("no setting 'c'; there are: a, b", self.call("--x", "c", expected=2))
        self.assertIn("no figure 'reason'; there are: peak_force_N, steps", self.call("--y", "reason", expected=2))
        self.assertIn("no point has b = 5; there are: 3, 4", self.call("--only", "b=5", expected=2))

    def test_keys_become_words_and_units(self):
        for key, words in {"material.youngs_modulus_Pa": "Young's modulus [Pa]", "a.poissons_ratio": "Poisson's ratio [–]",
                           "hand.damping_N_s_per_m": "damping [N s/m]", "kernel.k1_per_m": "k1 [1/m]",
                           "uptake_kg_per_m2_s": "uptake [kg/(m² s)]", "period_ticks": "period [ticks]"}.items():
            self.assertEqual(ap.quantity_label(key), words)


if __name__ == "__main__":
    unittest.main()
