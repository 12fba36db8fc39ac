#!/usr/bin/python3
"""The synthetic motions are what scripts/make_traces.py says: committed as made, on the device's grid, with a hand's
tremor, the wet one pressing exactly as the dry one. Expected values: the definitions of the grid and of the
minimum-jerk path (peak speed 15/8 of the mean [Flash & Hogan 1985]), and Parseval's theorem.
"""
import contextlib
import hashlib
import io
import math
import subprocess
import sys
import tempfile
import unittest
import unittest.mock
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "scripts"))
sys.dont_write_bytecode = True
import make_traces  # noqa: E402


def read(name):
    """Header lines, and rows as lists of text."""
    lines = (ROOT / "traces" / name).read_text().splitlines()
    header = [line for line in lines if line.startswith("#")]
    return header, [line.split(",") for line in lines[len(header) + 1:]]


class Traces(unittest.TestCase):
    def test_committed_traces_are_what_the_script_makes(self):
        run = subprocess.run([ROOT / "scripts/make_traces.py", "--check"], capture_output=True, text=True)
        self.assertEqual((run.returncode, run.stderr), (0, ""))

    def test_a_changed_or_missing_trace_is_seen(self):
        few = {name: make_traces.TRACES[name] for name in ("poke.csv", "block_light.csv")}  # the others take seconds

        def call(*arguments):
            said = io.StringIO()
            with unittest.mock.patch.object(make_traces, "TRACES", few), contextlib.redirect_stderr(said), \
                    contextlib.redirect_stdout(io.StringIO()), unittest.mock.patch.object(sys, "argv", ["make_traces.py", *arguments]):
                return make_traces.main(), said.getvalue()

        with tempfile.TemporaryDirectory() as folder:
            self.assertEqual(call("--out", folder), (0, ""))
            self.assertEqual(call("--out", folder, "--check"), (0, ""))
            for file in Path(folder).iterdir():
                self.assertEqual(file.read_bytes(), (ROOT / "traces" / file.name).read_bytes())
            file = Path(folder, "poke.csv")
            lines = file.read_text().splitlines(keepends=True)
            lines[100] = lines[100].replace("push", "pull")
            file.write_text("".join(lines))
            Path(folder, "block_light.csv").unlink()
            code, words = call("--out", folder, "--check")
            self.assertEqual(code, 1)
            self.assertIn("poke.csv: differs from what this script makes, first at line 101", words)
            self.assertIn("block_light.csv: is missing", words)

    def test_the_header_states_the_hash_of_the_body(self):
        for name in make_traces.TRACES:
            text = (ROOT / "traces" / name).read_bytes()
            body = text[text.index(b"time_s"):]
            self.assertIn(f"# sha256: {hashlib.sha256(body).hexdigest()}".encode(), text)

    def test_samples_come_at_1_khz_on_the_grid_with_unit_quaternions(self):
        for name, (place, _, _) in make_traces.TRACES.items():
            if place.is_smooth:
                continue
            _, rows = read(name)
            for number, row in enumerate(rows):
                self.assertEqual(row[0], f"{number / 1000:.3f}")
                for cell in row[1:4]:
                    micrometres = round(1e6 * float(cell))
                    self.assertEqual(micrometres % 60, 0, f"{name} row {number}: {cell}")
                self.assertAlmostEqual(math.hypot(*map(float, row[4:8])), 1.0, delta=2e-6)  # 6 printed digits

    def test_a_smooth_press_is_half_way_at_half_time_and_fastest_there(self):
        _, rows = read("block_light.csv")
        z = [float(row[3]) for row in rows[100:221]]  # the press, 0.12 s, from 1 mm above to 2 mm within
        self.assertAlmostEqual(z[0] - z[120], 0.003, delta=1e-9)
        self.assertAlmostEqual(z[60], 0.5 * (z[0] + z[120]), delta=1e-9)
        self.assertAlmostEqual((z[59] - z[61]) / 0.002, 15 / 8 * 0.003 / 0.12, delta=1e-4)

    def test_the_wet_motion_presses_with_the_samples_of_the_dry_one(self):
        for name in ("press_flank.csv", "press_tip.csv"):
            self.check_the_wet_motion(name)

    def check_the_wet_motion(self, name):
        _, dry = read(name)
        _, wet = read(f"wet_{name}")
        self.assertEqual([row[1:] for row in wet[-len(dry):]], [row[1:] for row in dry])
        self.assertEqual({row[8] for row in wet[:-len(dry)]}, {"wet"})
        self.assertEqual({row[8] for row in dry}, {"push"})

    def test_presses_are_as_deep_as_the_table_says_and_end_lifted(self):
        place = make_traces.HAUNCH
        _, rows = read("press_flank.csv")
        # The normal is −y: height of the tool's surface over the contact point [mm].
        heights = [place.contact[1] - place.tool_radius - 1e3 * float(row[2]) for row in rows]
        slack = 0.03 + 2 * make_traces.TREMOR_AMPLITUDE_MM  # half a grid step, tremor's largest excursion
        self.assertAlmostEqual(min(heights), -4.0, delta=slack)
        self.assertAlmostEqual(heights[-1], 25.0, delta=slack)

    def test_no_step_is_longer_than_the_fastest_stroke_allows(self):
        for name in make_traces.TRACES:
            _, rows = read(name)
            x = [[1e3 * float(cell) for cell in row[1:4]] for row in rows]
            longest = max(math.dist(a, b) for a, b in zip(x, x[1:]))
            # 20 mm in 37.5 ms peaks at 15/8·20/37.5 mm per ms; grid and tremor add at most a step each way. The short
            # motions of studies come down 24 mm, block_slide.csv 7 mm aside with it, in 100 ms.
            way, time = (24.0, 100.0) if name.startswith("block_") else (23.0, 500.0)
            way, time = {"poke.csv": (20.0, 37.5), "post_bend.csv": (math.hypot(24.0, 30.0), 100.0),
                         "post_fold.csv": (math.hypot(24.0, 30.0), 100.0), "block_slide.csv": (25.0, 100.0),
                         "post_let_go.csv": (math.hypot(24.5, 30.0), 100.0), "post_sway.csv": (12.0, 20.0),
                         "block_reversal.csv": (24.5, 100.0)}.get(name, (way, time))
            fastest = 15.0 / 8.0 * way / time
            self.assertLess(longest, fastest + 2 * math.sqrt(3) * 0.06)
            if name == "poke.csv":
                self.assertGreater(longest, 0.9)

    def test_tremor_has_its_amplitude_and_its_band(self):
        tremor = make_traces.make_tremor("some seed")
        seconds, rate = 20, 100
        values = [tremor(tick / rate)[0] for tick in range(seconds * rate)]
        mean_square = sum(v * v for v in values) / len(values)
        self.assertAlmostEqual(math.sqrt(2 * mean_square), make_traces.TREMOR_AMPLITUDE_MM, delta=0.1 * 0.07)

        def power(frequency):
            angle = 2 * math.pi * frequency / rate
            parts = [(v * math.cos(angle * i), v * math.sin(angle * i)) for i, v in enumerate(values)]
            return 2 * (sum(c for c, _ in parts) ** 2 + sum(s for _, s in parts) ** 2) / len(values) ** 2

        step = 1 / seconds
        inside = sum(power(7.5 + step * i) for i in range(int(5.0 / step)))  # the band and the spill beside it
        self.assertGreater(inside, 0.97 * mean_square)

    def test_tool_tip_points_into_the_body(self):
        for direction in [(0.0, -1.0, 0.0), (0.6, 0.0, 0.8), (0.0, 0.0, 1.0), (0.0, 0.0, -1.0)]:
            x, y, z, w = make_traces.rotation_from_z(direction)
            turned = (2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y))  # third column of R(q)
            for a, b in zip(turned, direction):
                self.assertAlmostEqual(a, b, places=12)


if __name__ == "__main__":
    unittest.main()
