#!/usr/bin/python3
"""A chart or a map that is told to end takes its runs along, keeps what has ended, and goes on from there when it is
started again: to the same table as one that was left alone.

Usage: test_interrupt.py ARGIL        the program
"""
import csv
import json
import math
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

ARGIL = str(Path(sys.argv.pop(1)).resolve())
COSTS = ("cpu_s_per_s", "simulated_s", "steps", "linearisations", "iterations", "factorisations", "instructions",
         "peak_memory_MiB", "peak_force_N", "energy_gain", "chatter")


def write_press(file, seconds):
    """A press from 48 mm down to 44 mm and up again, in steps of 10 ms."""
    lines = ["t,x,y,z"]
    for k in range(int(seconds * 100) + 1):
        lines.append(f"{k / 100},0.001,0.0007,{0.048 - 0.002 * (1 - math.cos(2 * math.pi * k / (seconds * 100)))}")
    file.write_text("\n".join(lines) + "\n")


class Interrupt(unittest.TestCase):
    def setUp(self):
        temp = tempfile.TemporaryDirectory()
        self.addCleanup(temp.cleanup)
        self.folder = Path(temp.name)
        write_press(self.folder / "press.csv", 0.8)
        (self.folder / "scene.json").write_text(json.dumps({
            "about": "a box poked from above",
            "body": {"shape": {"kind": "box", "size_m": 0.04, "target_tets": 150, "skin_triangles": 0},
                     "fixed": [{"kind": "plane", "normal": [0, 0, 1], "offset_m": 0}]},
            "material": {"youngs_modulus_Pa": 2e4, "poissons_ratio": 0.3, "clay_kernel": {"form": "off"}},
            "tool": {"shape": {"kind": "sphere", "radius_m": 0.006, "subdivisions": 2}, "mode": "push"},
            "contact": {"law": "pairs", "vertex_face_stiffness_N_per_m": 20, "edge_edge_stiffness_N_per_m": 20},
            "dynamics": {"rayleigh_stiffness_s": 0.002}, "haptics": {"frame_period_ticks": 100},
            "trace": {"file": "press.csv"}}))

    def write_map(self):
        (self.folder / "map.json").write_text(json.dumps({
            "about": "moduli", "scenario": "scene.json", "reference": {"/dynamics/iteration": "newton"},
            "x": {"name": "E [Pa]", "pointers": ["/material/youngs_modulus_Pa"], "values": [1e4 * k for k in range(1, 17)]}}))
        return "stability", "map.json"

    def write_chart(self):
        (self.folder / "chart.json").write_text(json.dumps({
            "about": "moduli", "scenario": "scene.json", "refined": {"/dynamics/iteration": "newton"}, "repeats": 2,
            "curves": [{"name": "E", "along": {"/material/youngs_modulus_Pa": [1e4 * k for k in range(1, 13)]}},
                       {"name": "none", "settings": {"/material/poissons_ratio": 0.7}}]}))
        return "chart", "chart.json"

    def command(self, words, output):
        return [ARGIL, *words, "-o", output, "--runs", f"{output}.runs", "--jobs", "2", "-q"]

    def call(self, words, output):
        done = subprocess.run(self.command(words, output), cwd=self.folder, capture_output=True, text=True, timeout=300)
        self.assertEqual(done.returncode, 0, done.stderr)

    def kept(self, output):
        return {file: file.stat().st_mtime_ns for file in (self.folder / f"{output}.runs").glob("*.case")}

    def interrupt(self, words, output, number, least):
        """Told to end when `least` runs have ended."""
        with subprocess.Popen(self.command(words, output), cwd=self.folder, stderr=subprocess.PIPE, text=True) as study:
            end = time.monotonic() + 120
            while len(self.kept(output)) < least and time.monotonic() < end:
                time.sleep(0.01)
            self.assertIsNone(study.poll(), "it ended before it was told to")
            children = Path(f"/proc/{study.pid}/task/{study.pid}/children").read_text().split()
            study.send_signal(number)
            error = study.communicate(timeout=60)[1]
        self.assertEqual(study.returncode, 130, error)
        self.assertEqual(error, f"argil: interrupted; what has ended is kept in {output}.runs, and the same command goes on "
                                "from there\n")
        self.assertTrue(children)
        for child in children:
            self.assertFalse(Path("/proc", child).exists())
        self.assertFalse((self.folder / f"{output}.csv").exists())
        names = [file.name for file in (self.folder / f"{output}.runs").iterdir()]
        self.assertEqual([name for name in names if ".part" in name or ".again" in name or name.endswith(".log")], [])

    def read(self, output):
        with open(self.folder / f"{output}.csv", encoding="utf-8") as lines:
            return list(csv.DictReader(line for line in lines if not line.startswith("#")))

    def test_a_map_goes_on_where_it_was(self):
        words = self.write_map()
        self.interrupt(words, "cut", signal.SIGTERM, 3)
        first = self.kept("cut")
        self.assertTrue(3 <= len(first) < 32, len(first))
        self.interrupt(words, "cut", signal.SIGINT, len(first) + 2)
        self.call(words, "cut")
        after = self.kept("cut")
        self.assertEqual({file: after[file] for file in first}, first)  # they did not run again
        self.call(words, "whole")
        self.assertEqual((self.folder / "cut.csv").read_bytes(), (self.folder / "whole.csv").read_bytes())

    def test_a_chart_goes_on_where_it_was(self):
        words = self.write_chart()
        self.interrupt(words, "cut", signal.SIGTERM, 4)
        first = self.kept("cut")
        self.call(words, "cut")
        after = self.kept("cut")
        self.assertEqual({file: after[file] for file in first}, first)
        self.call(words, "whole")
        clock = ("cpu_s_per_s", "instructions", "peak_memory_MiB")
        for cut, whole in zip(self.read("cut"), self.read("whole"), strict=True):
            self.assertEqual({name: value for name, value in cut.items() if name not in clock},
                             {name: value for name, value in whole.items() if name not in clock})
        refused = self.read("cut")[-1]
        self.assertEqual(refused["outcome"], "refused")
        self.assertEqual({refused[name] for name in COSTS}, {""})  # unknown, not free

    def test_a_run_told_to_end_while_it_makes_its_file_leaves_a_whole_one(self):
        result = self.folder / "cut.h5"
        part = self.folder / "cut.h5.part"
        for _ in range(20):  # the file is made in a few ms, and may be missed
            result.unlink(missing_ok=True)
            with subprocess.Popen([ARGIL, "run", "scene.json", "-o", "cut.h5", "-q"], cwd=self.folder,
                                  stderr=subprocess.PIPE, text=True) as run:
                while not part.exists() and not result.exists() and run.poll() is None:
                    pass
                is_met = part.exists()
                run.terminate()
                error = run.communicate(timeout=60)[1]
            if is_met:
                break
        self.assertTrue(is_met)
        self.assertEqual(run.returncode, 130, error)
        self.assertFalse(part.exists())
        again = subprocess.run([ARGIL, "run", "scene.json", "-o", "cut.h5", "--resume"], cwd=self.folder, capture_output=True,
                               text=True, timeout=300)
        self.assertEqual(again.returncode, 0, again.stderr)
        self.assertIn("resumed after tick", again.stdout)

    def test_runs_of_minutes_end_at_once(self):
        write_press(self.folder / "press.csv", 600.0)
        words = self.write_map()
        with subprocess.Popen(self.command(words, "cut"), cwd=self.folder, stderr=subprocess.PIPE, text=True) as study:
            end = time.monotonic() + 60
            while len(list((self.folder / "cut.runs").glob("*.part.*.h5"))) < 2 and time.monotonic() < end:
                time.sleep(0.01)
            study.terminate()
            try:
                error = study.communicate(timeout=60)[1]
            except subprocess.TimeoutExpired:
                study.kill()
                raise
        self.assertEqual(study.returncode, 130, error)
        self.assertEqual(list((self.folder / "cut.runs").iterdir()), [])

    def test_runs_die_with_a_study_that_is_killed(self):
        words = self.write_map()
        with subprocess.Popen(self.command(words, "cut"), cwd=self.folder) as study:
            end = time.monotonic() + 120
            children = []
            while not children and time.monotonic() < end:
                children = Path(f"/proc/{study.pid}/task/{study.pid}/children").read_text().split()
            study.kill()
            study.wait(timeout=60)
        self.assertTrue(children)
        end = time.monotonic() + 60
        while any(is_running(child) for child in children) and time.monotonic() < end:
            time.sleep(0.01)
        self.assertFalse([child for child in children if is_running(child)])


def is_running(process):
    """Neither gone nor dead and not taken note of."""
    try:
        return Path("/proc", process, "stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except OSError:
        return False


if __name__ == "__main__":
    unittest.main()
