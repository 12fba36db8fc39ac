#!/usr/bin/python3
"""A sweep from its file to its table: order and values of the points, what counts as done, and the same table from a
serial run, GNU parallel and blocks.

Usage: test_sweep.py ARGIL        the program
"""
import csv
import fcntl
import json
import os
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

import h5py

ARGIL = str(Path(sys.argv.pop(1)).resolve())
BASE = Path(__file__).resolve().parents[2] / "golden" / "ball.json"
SCRIPTS = Path(__file__).resolve().parents[3] / "scripts"
SHORT = {"/trace/duration_s": [0.028]}


class Sweep(unittest.TestCase):
    def setUp(self):
        self.temp = tempfile.TemporaryDirectory()
        self.addCleanup(self.temp.cleanup)
        self.folder = Path(self.temp.name)
        self.points = self.folder / "points.jsonl"

    def call(self, *arguments, expected=0, **environment):
        done = subprocess.run([ARGIL, "sweep", *map(str, arguments)], cwd=self.folder, capture_output=True, text=True,
                              timeout=300, env={**os.environ, **environment})
        self.assertEqual(done.returncode, expected, done.stderr)
        return done.stdout.strip() if expected == 0 else done.stderr

    def expand(self, **axes):
        (self.folder / "sweep.json").write_text(json.dumps({"scenario": os.path.relpath(BASE, self.folder), **axes}))
        self.call("expand", "sweep.json", "-o", self.points)
        return [json.loads(line) for line in self.points.read_text().splitlines()]

    def expand_and_run(self):
        points = self.expand(grid={**SHORT, "/body/initial_saturation": [0.1, 0.9],
                                   "/material/youngs_modulus_Pa": [5e4, 1e5, 2e5]})
        for index in range(len(points)):
            self.call("run", self.points, "--index", index)

    def collect(self, name="table"):
        self.call("collect", self.points, "-o", name)
        with open(self.folder / f"{name}.csv", newline="") as file:
            return list(csv.DictReader(file))

    def test_points_are_all_combinations_the_last_axis_fastest(self):
        points = self.expand(grid={"/body/initial_saturation": [0, 0.5], "/material/youngs_modulus_Pa": [1e5, 2e5]},
                             zip={"/tool/mode": ["push", "wet"], "/trace/duration_s": [0.01, 0.02]},
                             list=[{}, {"/contact/friction": 0.5}])
        self.assertEqual(len(points), 16)
        self.assertEqual([point["index"] for point in points], list(range(16)))
        self.assertEqual(len({point["id"] for point in points}), 16)
        settings = [list(point["settings"].values()) for point in points]
        self.assertEqual(settings[0], [0, 1e5, "push", 0.01])
        self.assertEqual(settings[1], [0, 1e5, "push", 0.01, 0.5])
        self.assertEqual(settings[2], [0, 1e5, "wet", 0.02])
        self.assertEqual(settings[4], [0, 2e5, "push", 0.01])
        self.assertEqual(settings[15], [0.5, 2e5, "wet", 0.02, 0.5])

    def test_samples_fill_the_box_by_seed(self):
        def sample(method, seed):
            points = self.expand(sample={"method": method, "count": 32, "seed": seed, "axes": {
                "/body/initial_saturation": [0.25, 0.75], "/material/youngs_modulus_Pa": [1e5, 3e5]}})
            return [list(point["settings"].values()) for point in points]

        for method in ("random", "halton"):
            values = sample(method, 1)
            self.assertEqual(values, sample(method, 1))
            self.assertNotEqual(values, sample(method, 2))
            self.assertTrue(all(0.25 <= s < 0.75 and 1e5 <= e < 3e5 for s, e in values))
        # In base 2, 32 points of the van der Corput sequence, shifted or not, have one in each 16th or two.
        sixteenths = [int((s - 0.25) / 0.5 * 16) for s, _ in values]
        self.assertEqual(set(sixteenths), set(range(16)))

    def test_bad_sweeps_are_refused_by_name(self):
        for axes, words in (({"grid": {"material": [1]}}, "is no JSON pointer"),
                            ({"zip": {"/trace/start_s": [1], "/trace/duration_s": [1, 2]}}, "2 values, the first axis 1"),
                            ({"grid": {"/water/porosty": [0.3]}}, "porosty"),
                            ({"grids": {}}, "did you mean grid?"),
                            ({"grid": {f"/body/fixed/{k}/radius_m": list(range(100)) for k in range(4)}}, "more than a million"),
                            ({"grid": {f"/body/fixed/{k}/radius_m": [0, 1] for k in range(19)}}, "/grid: makes settings of"),
                            ({"grid": {"/about": ["a" * 200000], "/body/initial_saturation": list(range(1000)),
                                       "/material/youngs_modulus_Pa": list(range(1000))}}, "/grid: makes settings of 19"),  # 191 GiB
                            ({"zip": {"/about/" + "a" * 1000000: [0] * 1000}}, "/zip: makes settings of 953 MiB in memory, more than 512"),
                            ({"sample": {"method": "halton", "count": 1e6, "axes": {f"/body/fixed/{k}/radius_m": [0, 1] for k in range(5)}}},
                             "/sample/axes: makes settings of")):
            self.assertIn(words, self.refuse_to_expand(axes))
        for index in ("1", "0.5"):
            self.points.write_text(f'{{"index": {index}, "id": "", "scenario": "x", "settings": {{}}}}\n')
            self.assertIn(f"points.jsonl, line 1: /index: {index} is not", self.call("run", self.points, "--index", 0, expected=2))

    def refuse_to_expand(self, axes, points="points.jsonl"):
        (self.folder / "sweep.json").write_text(json.dumps({"scenario": os.path.relpath(BASE, self.folder), **axes}))
        message = self.call("expand", "sweep.json", "-o", points, expected=2)
        self.assertEqual(os.listdir(self.folder), ["sweep.json"])
        return message

    def test_each_key_is_set_once_and_each_point_is_another(self):
        mode, soft = {"/tool/mode": ["push", "wet"]}, {"/material/youngs_modulus_Pa": 5e4}
        box = {"/material/youngs_modulus_Pa": [1e5, 2e5]}
        for axes, words in (({"grid": mode, "list": [{}, {"/tool/mode": "dry"}]}, "/list: /tool/mode is set twice in one point"),
                            ({"grid": box, "sample": {"method": "random", "count": 2, "axes": box}}, "/sample: /material/youngs_modulus_Pa is set twice"),
                            ({"grid": mode, "zip": {"/tool": [{}]}}, "/zip: /tool/mode is set in one point with /tool, which it is part of"),
                            ({"list": [{"/tool/mode": "wet", "/about": "", "/tool": {}}]}, "/list: /tool/mode is set in one point with /tool"),
                            ({"grid": {"/material/youngs_modulus_Pa": [1e5, 100000]}}, "/grid: /material/youngs_modulus_Pa has 100000 twice"),
                            ({"grid": {"/tool/mode": ["wet", "push", "wet"]}}, '/grid: /tool/mode has "wet" twice; give each value once'),
                            ({"list": [soft, {}, soft]}, "points 0 and 2 are one and the same run"),
                            ({"list": [{}, {"/tool/mode": "push"}]}, "points 0 and 1 are one and the same run")):
            self.assertIn(words, self.refuse_to_expand(axes))

    def test_counts_of_a_sample_are_whole_and_there(self):
        for numbers, words in (({"count": 2.7}, "/sample/count: 2.7 is not whole"), ({"count": 2, "seed": 1.5}, "/sample/seed: 1.5 is not whole"),
                               ({}, "/sample/count: is missing"), ({"count": 0}, "/sample/count: 0 is outside [1")):
            self.assertIn(words, self.refuse_to_expand({"sample": {"method": "random", "axes": {"/body/initial_saturation": [0, 1]}, **numbers}}))

    def test_points_have_a_name_beside_which_results_fit(self):
        for name in ("pts", ".", "..", "sub/"):
            self.assertIn("has no ending", self.refuse_to_expand({"list": [{}]}, name))
        self.expand(list=[{"/trace/duration_s": 0.002}])
        self.points.rename(self.folder / "pts")
        for command in (("run", "pts", "--index", 0), ("missing", "pts"), ("collect", "pts", "-o", "table")):
            self.assertIn("pts: has no ending", self.call(*command, expected=2))

    def test_nothing_that_is_read_is_overwritten(self):
        for name in ("ball.json", "rub.csv"):
            shutil.copy(BASE.parent / name, self.folder)
        self.points.write_text("")
        (self.folder / "s.json").write_text(json.dumps({"scenario": "ball.json", "list": [{"/trace/duration_s": 0.002}]}))

        def refuse(words, *command):
            before = {path: path.read_bytes() for path in self.folder.rglob("*.*") if path.is_file()}
            self.assertIn(words, self.call(*command, expected=2))
            self.assertEqual({path: path.read_bytes() for path in self.folder.rglob("*.*") if path.is_file()}, before)

        refuse("s.json: is the sweep and would be overwritten", "expand", "s.json", "-o", "s.json")
        refuse("ball.json: is the scenario and would be", "expand", "s.json", "-o", "ball.json")
        refuse("rub.csv: is a file that the run reads (/trace/file)", "expand", "s.json", "-o", "rub.csv")
        (self.folder / "rub.csv").rename(self.folder / "new.jsonl.part")
        (self.folder / "moved.json").write_text(json.dumps({"scenario": "ball.json", "list": [{"/trace/file": "new.jsonl.part"}]}))
        refuse("new.jsonl.part: is a file that the run reads (/trace/file)", "expand", "moved.json", "-o", "new.jsonl")
        (self.folder / "new.jsonl.part").rename(self.folder / "rub.csv")
        self.call("expand", "s.json", "-o", self.points)
        self.call("run", self.points, "--index", 0)
        refuse("rub.csv: is a file that the run reads (/trace/file)", "collect", self.points, "-o", "rub")
        refuse("000000.h5: is a result of the sweep", "collect", self.points, "-o", "points/000000")
        (self.folder / "t.csv").symlink_to(self.points)
        refuse("t.csv: is the list of points", "collect", self.points, "-o", "t")
        # a result of an earlier sweep as the motion of this one
        shutil.copy(self.folder / "points" / "000000.h5", self.folder / "motion.h5")
        (self.folder / "s.json").write_text(json.dumps({"scenario": "ball.json", "list": [{"/trace/file": "next/000000.h5"}]}))
        (self.folder / "next").mkdir()
        (self.folder / "motion.h5").rename(self.folder / "next" / "000000.h5")
        self.call("expand", "s.json", "-o", "next.jsonl")
        refuse("000000.h5: is a file that the run reads (/trace/file)", "run", "next.jsonl", "--index", 0)

    def test_a_point_is_done_only_when_its_file_says_so(self):
        self.expand_and_run()
        files = [self.folder / "points" / f"{i:06d}.h5" for i in range(6)]
        self.assertEqual(self.call("missing", self.points), "")
        before = [file.stat().st_mtime_ns for file in files]
        self.call("run", self.points, "--block", "6", SLURM_ARRAY_TASK_ID="0")
        self.assertEqual([file.stat().st_mtime_ns for file in files], before)
        table = self.collect()
        self.assertEqual([row["outcome"] for row in table], ["done"] * 6)
        self.assertEqual([float(row["material.youngs_modulus_Pa"]) for row in table], [5e4, 1e5, 2e5] * 2)
        forces = [float(row["peak_force_N"]) for row in table]
        self.assertTrue(forces[0] < forces[1] < forces[2], forces)
        self.assertTrue(all(abs(float(row["water_error_kg"])) < 1e-15 for row in table))
        self.assertAlmostEqual(float(table[5]["final_saturation"]), 0.9, delta=1e-9)
        files[1].unlink()
        files[2].write_bytes(files[2].read_bytes()[:5000])
        shutil.copy(files[0], files[3])
        self.assertEqual(self.call("missing", self.points), "1-3")
        self.assertEqual(self.call("missing", self.points, "--block", 2), "0-1")
        reasons = [row["reason"] for row in self.collect()]
        self.assertEqual(reasons[1], "not run")
        self.assertIn("does not read", reasons[2])
        self.assertEqual(reasons[3], "its file is of another run")
        for block in (0, 1):
            self.call("run", self.points, "--block", 2, "--index", block)
        self.assertEqual(self.collect(), table)

    def test_a_point_whose_cells_are_chosen_is_done_until_it_is_another(self):
        asked = {"/fidelity/accuracy": [0.3], "/contact/law": ["pressure"], "/dynamics/solver/kind": ["pcg"],
                 "/material/plasticity/enabled": [False], "/body/shape/kind": ["box"], "/body/shape/skin_triangles": [0],
                 "/trace/device_to_world/translation_m": [[0, 0, -0.0035]], "/trace/duration_s": [0.042]}
        self.expand(grid=asked)
        self.call("run", self.points, "--index", 0)
        whole, part = self.folder / "points" / "000000.h5", self.folder / "points" / "000000.part.h5"
        with h5py.File(whole) as file:
            self.assertIn("accuracy", file)
        table = self.collect()
        self.assertEqual([row["outcome"] for row in table], ["done"])
        self.assertEqual(self.call("missing", self.points), "")
        before = self.files()
        self.assertIn("block 0, points 0 to 0: 0 made, 1 there before, 0 failed, 0 refused",
                      self.call("run", self.points, "--index", 0))
        self.assertEqual(self.files(), before)
        whole.rename(part)  # as if it had been killed between its end and its name
        self.call("run", self.points, "--index", 0)
        self.assertEqual(self.files(), before)
        self.expand(grid={**asked, "/material/youngs_modulus_Pa": [2e5]})
        self.assertEqual(self.call("missing", self.points), "0")
        self.assertEqual(self.collect()[0]["reason"], "its file is of another run")
        self.call("run", self.points, "--index", 0)
        self.assertGreater(float(self.collect()[0]["peak_force_N"]), 1.2 * float(table[0]["peak_force_N"]))

    def test_a_damaged_result_is_a_row_and_is_run_again(self):
        self.expand_and_run()
        table = self.collect()
        files = [self.folder / "points" / f"{i:06d}.h5" for i in range(6)]
        with h5py.File(files[1], "r+") as file:
            file["mesh/tets"][3, 1] = -7
        with h5py.File(files[2], "r+") as file:
            frame = file["frames/000001"]
            saturation = frame["saturation"][:-1]
            del frame["saturation"]
            frame["saturation"] = saturation
        self.damage(files[4])
        self.assertEqual(self.call("missing", self.points), "1-2,4")
        damaged = self.collect()
        for i, words in ((1, "/mesh/tets names vertex -7 in row 3"),
                         (2, "/frames/000001/saturation has not as many rows as /mesh/tets"), (4, "cannot read /haptic/force")):
            self.assertEqual(damaged[i]["outcome"], "missing")
            self.assertIn("its file does not read: ", damaged[i]["reason"])
            self.assertIn(words, damaged[i]["reason"])
            self.assertEqual(damaged[i]["peak_force_N"], "")
        self.assertEqual([damaged[i] for i in (0, 3, 5)], [table[i] for i in (0, 3, 5)])
        for index in (1, 2, 4):
            self.call("run", self.points, "--index", index)
        self.assertEqual(self.collect(), table)

    def damage(self, result):
        """Part of the force is what a disk turned to zeros."""
        with h5py.File(result, "r") as file:
            place = file["haptic/force"].id.get_chunk_info(0).byte_offset
        with open(result, "r+b") as file:
            file.seek(place)
            file.write(bytes(512))

    def kill_after_a_checkpoint(self, part):
        for _ in range(10):  # as often as the run comes to its end before it is looked at
            process = subprocess.Popen([ARGIL, "sweep", "run", self.points, "--index", "0"], cwd=self.folder)
            while process.poll() is None and not self.has_checkpoint(part):
                time.sleep(0.001)
            process.kill()
            process.wait()
            if part.exists():
                break
            (self.folder / "points" / "000000.h5").unlink()
        self.assertTrue(part.exists())
        subprocess.run([ARGIL, "info", part], check=True, capture_output=True)  # finishes a flush that the kill broke off

    def has_checkpoint(self, part):
        try:
            with h5py.File(part, "r", locking=False) as file:
                return "checkpoint" in file
        except (OSError, RuntimeError):
            return False  # not there, or between two flushes

    def stop(self, process):
        """Returns when it stands still: the signal alone does not wait for that."""
        process.send_signal(signal.SIGSTOP)
        self.wait_until(lambda: Path(f"/proc/{process.pid}/stat").read_text().rpartition(")")[2].split()[0] == "T")

    def test_what_is_there_of_a_point_is_gone_on_with_unless_it_is_damaged(self):
        self.expand(list=[{"/output/checkpoint_period_ticks": 20}])
        self.call("run", self.points, "--index", 0)
        whole, part = self.folder / "points" / "000000.h5", self.folder / "points" / "000000.part.h5"
        expected = self.collect()
        for is_damaged in (False, True):
            whole.unlink()
            self.kill_after_a_checkpoint(part)
            if is_damaged:
                self.damage(part)
            done = subprocess.run([ARGIL, "sweep", "run", self.points, "--index", "0"], cwd=self.folder,
                                  capture_output=True, text=True, timeout=300)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual("it is begun anew" in done.stderr, is_damaged, done.stderr)
            self.assertEqual(self.collect(), expected)

    def test_a_run_that_ended_before_it_was_named_is_taken_unless_it_is_damaged(self):
        self.expand(list=[{}])
        self.call("run", self.points, "--index", 0)
        whole, part = self.folder / "points" / "000000.h5", self.folder / "points" / "000000.part.h5"
        expected = self.collect()
        for is_damaged in (False, True):
            whole.rename(part)
            if is_damaged:
                self.damage(part)
            written = part.stat().st_mtime_ns
            done = subprocess.run([ARGIL, "sweep", "run", self.points, "--index", "0"], cwd=self.folder,
                                  capture_output=True, text=True, timeout=300)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual("it is begun anew" in done.stderr, is_damaged, done.stderr)
            self.assertEqual(whole.stat().st_mtime_ns != written, is_damaged)
            self.assertEqual(self.collect(), expected)

    def test_points_are_the_same_by_any_name(self):
        self.expand_and_run()
        lines = self.points.read_text()
        (self.folder / "sub").mkdir()
        (self.folder / "link").symlink_to(self.folder / "sub")
        for name in ("points.jsonl", "./points.jsonl", f"../{self.folder.name}/points.jsonl", "sub/../points.jsonl", "link/../points.jsonl"):
            self.call("expand", "sweep.json", "-o", name)
            self.assertEqual(self.points.read_text(), lines)
            self.assertEqual(self.call("missing", name), "")
            self.call("run", name, "--index", 0)

    def test_the_base_is_found_from_wherever_the_points_lie(self):
        for folder, modulus in (("mine", 1e5), ("out", 2e5)):  # another scenario of the same name beside the points
            (self.folder / folder).mkdir()
            shutil.copy(BASE.parent / "rub.csv", self.folder / folder)
            base = json.loads(BASE.read_text())
            base["material"]["youngs_modulus_Pa"] = modulus
            (self.folder / folder / "ball.json").write_text(json.dumps(base))
        (self.folder / "deep").mkdir()
        (self.folder / "deep" / "link").symlink_to(self.folder / "out")
        (self.folder / "mine" / "s.json").write_text(json.dumps({"scenario": "ball.json", "grid": SHORT}))
        for place, sweep, points in (("mine", "s.json", "../out/q.jsonl"), ("mine", "../mine/s.json", "../mine/../out/q.jsonl"),
                                     ("deep", "../mine/s.json", "link/q.jsonl"), ("out", "../mine/s.json", "q.jsonl")):
            subprocess.run([ARGIL, "sweep", "expand", sweep, "-o", points], cwd=self.folder / place, check=True, capture_output=True)
            self.assertEqual(json.loads((self.folder / "out" / "q.jsonl").read_text())["scenario"], "../mine/ball.json")
            self.call("run", "out/q.jsonl", "--index", 0)
            with h5py.File(self.folder / "out" / "q" / "000000.h5") as file:
                self.assertEqual(json.loads(file["provenance/scenario"][()])["material"]["youngs_modulus_Pa"], 1e5)
            subprocess.run([ARGIL, "sweep", "run", points, "--index", "0"], cwd=self.folder / place, check=True)

    def files(self):
        return {path.name: (path.stat().st_ino, path.stat().st_mtime_ns) for path in (self.folder / "points").iterdir()}

    def start(self):
        process = subprocess.Popen([ARGIL, "sweep", "run", self.points, "--index", "0", "--block", "26"], cwd=self.folder,
                                   stderr=subprocess.PIPE, text=True)
        self.addCleanup(process.stderr.close)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        return process

    def wait_until(self, condition):
        for _ in range(60000):
            if condition():
                return
            time.sleep(0.001)
        self.fail("did not come")

    def test_a_signal_between_two_points_ends_the_block(self):
        self.expand(grid={"/trace/duration_s": [0.001], "/body/initial_saturation": [k / 26 for k in range(26)]})  # no tick to end early at
        process = self.start()
        self.wait_until((self.folder / "points" / "000003.h5").exists)
        process.terminate()
        error = process.communicate()[1]
        self.assertEqual(process.returncode, 130, error)
        num_done = len(list((self.folder / "points").glob("0*.h5")))
        self.assertTrue(4 <= num_done < 26, num_done)
        self.assertEqual(error, f"argil: interrupted before point {num_done} of {self.points}; the same command goes on from there\n")
        self.assertEqual(list((self.folder / "points").glob("*.part*")), [])
        self.call("run", self.points, "--index", 0, "--block", 26)
        self.assertEqual(self.call("missing", self.points), "")

    def test_a_signal_before_the_first_tick_leaves_nothing_that_misleads(self):
        self.expand(list=[{"/body/shape/target_tets": 2000}])
        process = self.start()
        self.wait_until((self.folder / "points").exists)  # the body is made after this
        process.terminate()
        error = process.communicate()[1]
        self.assertEqual(process.returncode, 130, error)
        self.assertIn("run the point again, which goes on from its last checkpoint", error)
        self.assertNotIn("--resume", error)
        self.assertEqual(self.call("missing", self.points), "0")
        self.assertEqual(self.collect()[0]["reason"], "not finished")

    def test_a_point_that_another_process_computes_is_let_alone(self):
        self.expand(list=[{"/output/checkpoint_period_ticks": 20}])
        self.call("run", self.points, "--index", 0)
        expected = self.collect()
        shutil.rmtree(self.folder / "points")
        process = self.start()
        part = self.folder / "points" / "000000.part.h5"
        self.wait_until(part.exists)
        self.stop(process)
        before = self.files()
        error = self.call("run", self.points, "--index", 0, expected=4)
        self.assertIn("point 0 is being computed by another process", error)
        self.assertNotIn("begun anew", error)
        self.assertEqual(self.files(), before)
        process.send_signal(signal.SIGCONT)
        self.assertEqual(process.communicate()[1], "")
        self.assertEqual(process.returncode, 0)
        self.assertEqual(self.collect(), expected)

    def test_a_file_that_is_busy_is_not_taken_for_damaged(self):
        self.expand(list=[{"/output/checkpoint_period_ticks": 20}])
        part = self.folder / "points" / "000000.part.h5"
        self.kill_after_a_checkpoint(part)
        before = self.files()
        with open(part, "rb") as reader:
            fcntl.flock(reader, fcntl.LOCK_EX)
            self.assertIn("another process has this file open", self.call("run", self.points, "--index", 0, expected=4))
        self.assertEqual(self.files(), before)
        self.call("run", self.points, "--index", 0)
        before = self.files()
        with open(self.folder / "points" / "000000.h5", "rb") as reader:
            fcntl.flock(reader, fcntl.LOCK_EX)
            for command in (("run", self.points, "--index", 0), ("missing", self.points), ("collect", self.points, "-o", "table")):
                self.assertIn("000000.h5: another process has this file open", self.call(*command, expected=4))
        self.assertEqual(self.files(), before)

    def test_where_there_is_no_room_the_advice_is_that_of_a_sweep(self):
        self.expand(list=[{}])
        limit = 70_000  # bytes of a file, as where a disk is full: after the beginning of a result
        done = subprocess.run([ARGIL, "sweep", "run", self.points, "--index", "0"], cwd=self.folder, capture_output=True, text=True, timeout=300,
                              preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit)))
        self.assertEqual(done.returncode, 4, done.stderr)
        self.assertIn("make room and run the point again", done.stderr)
        self.assertNotIn("--resume", done.stderr)

    def test_equilibria_are_swept(self):
        points = self.expand(grid={"/dynamics/mode": ["static"], "/body/loads/gravity_m_per_s2": [[0, 0, -9.81], [0, 0, -4.905]]})
        self.call("run", self.points, "--block", len(points), "--index", 0)
        self.assertEqual(self.call("missing", self.points), "")
        self.assertEqual(sorted(self.files()), ["000000.h5", "000001.h5", "lock"])
        table = self.collect()
        self.assertEqual([row["outcome"] for row in table], ["done", "done"])
        full, half = (float(row["indentation_m"]) for row in table)
        self.assertGreater(full, 0.0)
        self.assertAlmostEqual(full / half, 2.0, delta=0.02)  # linear but for rotations
        self.assertEqual(table[0]["peak_force_N"], "")  # there is no hand

    def test_tables_keep_every_setting_as_it_is(self):
        about = 'a "quoted", comma\nnew line\r\t\u00e9'
        translation = [0, 0.001, 0]
        self.expand(grid=SHORT, list=[{"/tool/mode": "wet", "/about": about}, {"/tool/mode": "push", "/material/youngs_modulus_Pa": 12345678.12345679},
                                      {"/trace/device_to_world/translation_m": translation, "/material/youngs_modulus_Pa": 0.1 + 0.2 + 1e5}])
        self.call("run", self.points, "--index", 0, "--block", 3)
        self.call("collect", self.points, "-o", "table")
        with open(self.folder / "table.csv", newline="", encoding="utf-8") as file:
            table = list(csv.DictReader(file))
        self.assertEqual([row["about"] for row in table], [about, "", ""])
        self.assertEqual([float(row["material.youngs_modulus_Pa"] or 0) for row in table], [0, 12345678.12345679, 0.1 + 0.2 + 1e5])
        self.assertEqual([row["trace.duration_s"] for row in table], ["0.028"] * 3)
        with h5py.File(self.folder / "table.h5") as file:
            for name in ("about", "tool.mode", "trace.device_to_world.translation_m", "id", "outcome", "reason"):
                self.assertEqual(h5py.check_string_dtype(file[name].dtype), ("utf-8", None), name)  # of any length
                self.assertEqual(list(file[name].asstr()[()]), [row[name] for row in table], name)
            self.assertEqual(list(file["tool.mode"].asstr()[()]), ["wet", "push", ""])
            self.assertEqual(json.loads(file["trace.device_to_world.translation_m"].asstr()[2]), translation)
            self.assertEqual(list(file["material.youngs_modulus_Pa"][1:]), [12345678.12345679, 0.1 + 0.2 + 1e5])

    def test_failed_and_refused_points_are_named_with_their_reason(self):
        self.expand(list=[{"/trace/duration_s": 0.01}, {"/dynamics/min_volume_ratio": 0.9999},
                          {"/trace/device_to_world/translation_m": [0, 0, -0.03]}])
        self.call("run", self.points, "--block", 3, "--index", 0)
        self.assertEqual(self.call("missing", self.points), "")
        table = self.collect()
        self.assertEqual([row["outcome"] for row in table], ["done", "failed", "failed"])
        self.assertIn("volume ratio", table[1]["reason"])
        self.assertIn("the tool starts in or across the body", table[2]["reason"])
        self.assertEqual(table[1]["peak_force_N"], "")

    def test_gnu_parallel_gives_the_table_of_a_serial_run(self):
        if not shutil.which("parallel"):
            self.skipTest("needs GNU parallel (package parallel)")
        self.expand_and_run()
        self.collect("serial")
        shutil.rmtree(self.folder / "points")
        subprocess.run(["parallel", "--will-cite", "-j2", ARGIL, "sweep", "run", self.points, "--index", "{}", ":::",
                        *map(str, range(6))], cwd=self.folder, check=True)
        self.collect("parallel")
        for suffix in (".csv", ".h5"):
            self.assertEqual((self.folder / f"serial{suffix}").read_bytes(),
                             (self.folder / f"parallel{suffix}").read_bytes())

    def test_snakemake_gives_the_table_of_a_serial_run_and_asks_again_when_the_points_change(self):
        if not shutil.which("snakemake"):
            self.skipTest("needs Snakemake (package snakemake)")

        def make():
            subprocess.run(["snakemake", "-s", SCRIPTS / "sweep.snakefile", "--cores", "2", "--config", f"points={self.points.name}"],
                           cwd=self.folder, check=True, capture_output=True,
                           env={**os.environ, "PATH": f"{Path(ARGIL).parent}:{os.environ['PATH']}", "HOME": str(self.folder)})
            return (self.folder / "points.csv").read_bytes()

        for saturations in ([0.1, 0.9], [0.1, 0.5]):
            self.expand(grid={**SHORT, "/body/initial_saturation": saturations})
            table = make()
            self.collect("serial")  # of the points that are there, all of which have ended
            self.assertEqual(table, (self.folder / "serial.csv").read_bytes())
            self.assertEqual(table.count(b"done"), 2)
            self.assertIn(str(saturations[1]).encode(), table)


if __name__ == "__main__":
    unittest.main()
