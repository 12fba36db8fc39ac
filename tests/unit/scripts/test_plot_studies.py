#!/usr/bin/python3
"""plot_chart.py and plot_map.py draw every run of the tables that the program writes: those that failed, were refused or have
nothing to be compared with, too. Expected: a mark a row, where the row's numbers are. Skipped (77) without matplotlib.

Usage: test_plot_studies.py ARGIL        the program
"""
import importlib.util
import json
import math
import subprocess
import sys
import tempfile
import unittest
from collections import Counter
from pathlib import Path

SCRIPTS = Path(__file__).resolve().parents[3] / "scripts"
ARGIL = str(Path(sys.argv.pop(1)).resolve())
if any(importlib.util.find_spec(name) is None for name in ("numpy", "h5py", "matplotlib")):
    print("skipped: needs numpy, h5py and matplotlib")
    sys.exit(77)
sys.path.insert(0, str(SCRIPTS))
sys.dont_write_bytecode = True
import argil_plot as ap
from argil.plot import style
from argil.plot import chart_figure, map_figure

SCENE = {
    "about": "a box poked from above",
    "body": {"shape": {"kind": "box", "size_m": 0.04, "target_tets": 150, "skin_triangles": 0},
             "fixed": [{"kind": "plane", "normal": [0, 0, 1], "offset_m": 0}]},
    "material": {"youngs_modulus_Pa": 2e4, "poissons_ratio": 0.3, "plasticity": {"enabled": False}, "clay_kernel": {"form": "off"}},
    "tool": {"shape": {"kind": "sphere", "radius_m": 0.006, "subdivisions": 2}, "mode": "push"},
    "contact": {"law": "pairs", "vertex_face_stiffness_N_per_m": 20, "edge_edge_stiffness_N_per_m": 20},
    "dynamics": {"rayleigh_stiffness_s": 0.002}, "haptics": {"frame_period_ticks": 50}, "trace": {"file": "press.csv"}}
CHART = {
    "about": "all ways to end", "scenario": "scene.json", "repeats": 1, "refined": {"/dynamics/iteration": "newton"},
    "curves": [
        {"name": "as the reference", "settings": {}},
        {"name": "soft", "along": {"/material/youngs_modulus_Pa": [1e4, 1.5e4]}},
        {"name": "refused", "settings": {"/material/poissons_ratio": 0.7}},
        {"name": "inverted", "settings": {"/dynamics/min_volume_ratio": 0.999}},
        {"name": "other ticks", "settings": {"/haptics/period_s": 0.0015}},
        {"name": "held", "settings": {
            "/dynamics/implicit_contact": False, "/haptics/physics_period_ticks": 10, "/haptics/water_period_ticks": 10,
            "/contact/vertex_face_stiffness_N_per_m": 2000, "/contact/edge_edge_stiffness_N_per_m": 2000}}]}
# Where the tets' volume may lose nothing, little, and what no scenario may ask for: at ticks that the reference has and has not.
LINE = {
    "about": "all ways to end", "scenario": "scene.json", "reference": {"/dynamics/min_volume_ratio": 0, "/haptics/period_s": 0.001},
    "x": {"name": "least volume [–]", "pointers": ["/dynamics/min_volume_ratio"], "values": [0, 0.999, 2]},
    "bisect_to": 0.2, "limits": [{"name": "a limit", "x": [0.5]}]}
PLANE = {**LINE, "y": {"name": "tick [s]", "pointers": ["/haptics/period_s"], "values": [0.001, 0.0015]},
         "limits": [{"name": "a limit", "x": [0.1, 0.9], "y": [0.001, 0.0015]}]}


def marks(axes):
    """Every point that has a mark, and how often."""
    found = Counter()
    for line in axes.lines:
        if line.get_marker() not in ("None", "|"):  # the latter: boundaries
            found.update((float(x), float(y)) for x, y in zip(line.get_xdata(), line.get_ydata()))
    return found


class PlotStudies(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temp = tempfile.TemporaryDirectory()
        cls.folder = Path(cls.temp.name)
        (cls.folder / "press.csv").write_text("t,x,y,z\n" + "\n".join(
            f"{k / 1000},0.001,0.0007,{0.048 - 0.002 * (1 - math.cos(2 * math.pi * k / 400))}" for k in range(401)))
        (cls.folder / "scene.json").write_text(json.dumps(SCENE))
        cls.tables = {}
        for name, command, study in (("chart", "chart", CHART), ("line", "stability", LINE), ("plane", "stability", PLANE)):
            (cls.folder / f"{name}.json").write_text(json.dumps(study))
            done = subprocess.run([ARGIL, command, f"{name}.json", "-q", "--jobs", "2", "--runs", "runs"], cwd=cls.folder,
                                  capture_output=True, text=True, timeout=300)
            assert done.returncode in (0, 3), done.stderr  # 3: some have nothing to be compared with
            cls.tables[name] = cls.folder / f"{name}.csv"

    @classmethod
    def tearDownClass(cls):
        cls.temp.cleanup()

    def call(self, script, table, *arguments, expected=0):
        run = subprocess.run([SCRIPTS / script, table, *arguments], capture_output=True, text=True)
        self.assertEqual(run.returncode, expected, run.stderr)
        self.assertNotIn("Traceback", run.stderr)
        return run.stderr

    def assert_pictures(self, stem):
        self.assertEqual(stem.with_suffix(".png").read_bytes()[:8], b"\x89PNG\r\n\x1a\n")
        self.assertEqual(stem.with_suffix(".pdf").read_bytes()[:5], b"%PDF-")

    def test_a_chart_has_a_mark_for_every_run(self):
        rows = chart_figure.read_table(self.tables["chart"])
        outcomes = [row["outcome"] for row in rows]
        self.assertEqual(outcomes, ["accurate", "accurate", "accurate", "wrong", "wrong", "refused", "inverted", "unknown", "chatter"])
        figure = chart_figure.draw(rows, "force_error", "")
        self.addCleanup(ap.plt.close, figure)
        axes = figure.axes[0]
        found = marks(axes)
        self.assertEqual(found.total(), len(rows) - 2)  # of the reference there are lines
        number = chart_figure.number
        for row in rows[3:5] + rows[8:]:
            self.assertEqual(found[number(row, "cpu_s_per_s"), number(row, "force_error")], 1, row["outcome"])
        costs = [number(row, "cpu_s_per_s") for row in rows[2:] if row["cpu_s_per_s"]]
        errors = [number(row, "force_error") for row in rows[2:] if number(row, "force_error") > 0]
        self.assertEqual(number(rows[2], "force_error"), 0.0)  # the same run as the reference
        own = number(rows[0], "force_error")
        self.assertLess(own, 0.5 * min(errors))
        self.assertEqual(found[number(rows[2], "cpu_s_per_s"), own], 1)
        self.assertEqual(rows[5]["cpu_s_per_s"], "")
        self.assertEqual(found[0.5 * min(costs), 2 * max(errors)], 1)
        for row in rows[6:8]:
            self.assertEqual(found[number(row, "cpu_s_per_s"), 2 * max(errors)], 1, row["outcome"])
        words = [text.get_text() for text in figure.legends[0].get_texts()]
        for row in rows[2:]:
            self.assertIn(row["curve"], words)
        self.assertIn("has nothing to be compared with", words)
        self.call("plot_chart.py", self.tables["chart"])
        self.assert_pictures(self.tables["chart"])

    def test_names_that_refer_to_another_curve_are_said_in_full(self):
        names = ["tets, even", "tets, graded", "these, 2 ms", "1200 of these: 1, 2 ms", "asked for 5 %"]
        self.assertEqual(list(chart_figure.full_names(names).values()),
                         ["tets, even", "tets, graded", "tets, graded, 2 ms", "1200 tets, graded: 1, 2 ms", "asked for 5 %"])

    def test_axes_of_maps_have_units_that_people_use(self):
        for words, label, value in (("speed [0.1 mm/s]", "speed [m/s]", 2e-4), ("step [ticks of 1 ms]", "step [ms]", 2.0),
                                    ("push, less 0.025 m [m]", "push [mm]", 2025.0), ("ratio", "ratio", 2.0)):
            quantity = map_figure.read_quantity(words)
            self.assertEqual(quantity.label(), label)
            self.assertAlmostEqual(quantity.of({"x": "2"}, "x"), value)
        self.assertEqual(style.math_words("h = 2/ω_max"), "h = 2/$\\mathrm{ω_{max}}$")
        self.assertEqual([style.tick_text(v) for v in (0.002, 500, 1e5, 2.5e-4)], ["0.002", "500", "$10^{5}$", "2.5·$10^{-4}$"])

    def test_a_map_has_a_mark_for_every_run(self):
        for name, outcomes in (("line", {"accurate", "inverted", "refused"}),
                               ("plane", {"accurate", "inverted", "refused", "unknown"})):
            with self.subTest(name):
                rows, provenance = map_figure.read_table(self.tables[name])
                runs = [row for row in rows if row["kind"] == "run"]
                self.assertEqual({row["outcome"] for row in runs}, outcomes)
                self.assertIn("boundary", {row["kind"] for row in rows})
                figure = map_figure.draw(rows, provenance, "")
                self.addCleanup(ap.plt.close, figure)
                found = marks(figure.axes[0])
                self.assertEqual(found.total(), len(runs))
                self.assertTrue(all(math.isfinite(x) and math.isfinite(y) for x, y in found))
                at_top = Counter(float(row["x"]) for row in runs if not row["force_error"])
                for row in runs:
                    x = float(row["x"])
                    if name == "plane":
                        self.assertEqual(found[x, float(row["y"])], 1, row)
                    elif row["force_error"]:  # the same run as its reference: no error at all
                        self.assertEqual(found[x, map_figure.ERROR_BOTTOM], 1, row)
                    else:
                        self.assertEqual(found[x, map_figure.ERROR_TOP], at_top[x], row)
                words = {text.get_text() for text in figure.legends[0].get_texts()}
                self.assertTrue({map_figure.OUTCOMES[outcome][0] for outcome in outcomes} | {"a limit"} <= words, words)
                self.call("plot_map.py", self.tables[name], "--forces", "method", "reference")
                self.assert_pictures(self.tables[name])

    def test_outcomes_that_are_not_known_are_refused(self):
        table = self.folder / "strange.csv"
        table.write_text(self.tables["line"].read_text().replace("inverted", "melted"))
        self.assertIn("has outcomes that are not known here: melted", self.call("plot_map.py", table, expected=2))
        self.assertFalse(table.with_suffix(".png").exists())

    def test_a_table_of_something_else_is_refused(self):
        table = self.folder / "other.csv"
        table.write_text("a,b\n1,2\n3,4\n5,6\n")
        self.assertIn("is not a table of argil chart", self.call("plot_chart.py", table, expected=2))
        self.assertIn("is not a table of argil stability", self.call("plot_map.py", table, expected=2))


if __name__ == "__main__":
    unittest.main()
