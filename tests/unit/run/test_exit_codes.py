#!/usr/bin/python3
"""Exit codes of the program itself, and what lies on the disk after each: 0 done, 2 refused, 3 failed, 4 no place to
write, 5 different, 130 interrupted.

Usage: test_exit_codes.py ARGIL        the program
"""
import json
import math
import os
import re
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
import numpy as np

ARGIL = str(Path(sys.argv.pop(1)).resolve())


def write_press(file, seconds, bottom):
    """A press from 48 mm down to `bottom` and up again, at 1 kHz."""
    lines = ["t,x,y,z"]
    for k in range(int(seconds * 1000) + 1):
        share = 0.5 - 0.5 * math.cos(2 * math.pi * k / (seconds * 1000))
        lines.append(f"{k / 1000},0.001,0.0007,{0.048 + share * (bottom - 0.048)}")
    file.write_text("\n".join(lines) + "\n")


def make_scene(trace):
    return {
        "about": "a ball pressed from above",
        "body": {"shape": {"kind": "sphere", "size_m": 0.04, "target_tets": 600, "skin_triangles": 0},
                 "fixed": [{"kind": "half_space", "normal": [0, 0, 1], "offset_m": 0.006}]},
        "material": {"youngs_modulus_Pa": 1e5, "poissons_ratio": 0.3,
                     "clay_kernel": {"k1_per_m": 2, "k2_per_m": 60, "radius_m": 0.03}},
        "tool": {"shape": {"kind": "sphere", "radius_m": 0.006, "subdivisions": 2}, "mode": "push"},
        "contact": {"law": "pairs", "vertex_face_stiffness_N_per_m": 400, "edge_edge_stiffness_N_per_m": 400},
        "haptics": {"frame_period_ticks": 20},
        "trace": {"file": trace},
    }


class ExitCodes(unittest.TestCase):
    def setUp(self):
        self.temp = tempfile.TemporaryDirectory()
        self.addCleanup(self.temp.cleanup)
        self.folder = Path(self.temp.name)
        write_press(self.folder / "press.csv", 0.1, 0.0435)
        self.write_scene("scene.json", "press.csv")

    def write_scene(self, name, trace):
        (self.folder / name).write_text(json.dumps(make_scene(trace)))

    def call(self, *arguments):
        done = subprocess.run([ARGIL, *arguments], cwd=self.folder, capture_output=True, text=True, timeout=120)
        return done.returncode, done.stdout, done.stderr

    def read_ends(self, name):
        """complete, last time of the haptic table, number of frames."""
        with h5py.File(self.folder / name) as file:
            for frame in file["frames"].values():
                self.assertTrue((frame["position"][()] == frame["position"][()]).all())
            return bool(file.attrs["complete"]), file["haptic/time"][-1], len(file["frames"])

    def test_0_a_good_run_leaves_a_complete_result(self):
        code, out, _ = self.call("run", "scene.json", "-o", "out.h5")
        self.assertEqual(code, 0)
        self.assertIn("out.h5", out)
        complete, last, frames = self.read_ends("out.h5")
        self.assertTrue(complete)
        self.assertAlmostEqual(last, 0.1, delta=1e-12)
        self.assertEqual(frames, 6)  # one at the start and one every 20 of 100 ticks
        self.assertTrue((self.folder / "out.xdmf").exists())
        with h5py.File(self.folder / "out.h5") as file:
            total, rate = file["timing/total"], file["timing/tick_rate_Hz"]
            for name, timing in file["timing"].items():
                self.assertEqual(timing.attrs["units"], b"Hz" if name == "tick_rate_Hz" else b"s", name)
            self.assertAlmostEqual(rate[0] * total[0], 100.0, delta=1e-9)  # ticks
        page = self.call("info", "out.h5")[1]
        self.assertRegex(page, r"rate +[0-9.e+]+ ticks in a second")
        self.assertIn("\nmotion      100 ms: 100 ticks of 1 ms", page)
        self.assertIn("\nsimplified  friction: none\n", page)

    def test_0_version_and_help(self):
        self.assertEqual(self.call("--version")[0], 0)
        self.assertEqual(self.call("run", "--help")[0], 0)

    def test_2_refused_input_writes_nothing_and_says_one_line(self):
        before = sorted(self.folder.iterdir())
        for arguments in (["run", "scene.json", "--set", "/water/porosty=0.3"],
                          ["run", "nowhere.json"],
                          ["validate", "press.csv"],
                          ["show", "press.csv"]):
            code, out, error = self.call(*arguments)
            self.assertEqual((code, out), (2, ""), f"{arguments}: {error}")
            self.assertEqual(error.count("\n"), 1, error)
            self.assertTrue(error.startswith("argil: "), error)
        self.assertEqual(sorted(self.folder.iterdir()), before)

    def test_2_a_study_without_its_scene(self):
        (self.folder / "study.json").write_text(json.dumps({
            "about": "none", "scenario": "nowhere.json", "refined": {"/haptics/period_s": 5e-4}, "curves": [{"name": "a"}]}))
        code, out, error = self.call("chart", "study.json")
        self.assertEqual((code, out, error.count("\n")), (2, "", 1), error)
        self.assertIn("study.json: /scenario: \"nowhere.json\" does not exist; ", error)
        self.assertFalse((self.folder / "study.runs").exists())

    def test_2_an_input_is_never_written_over(self):
        corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"
        (self.folder / "body.obj").write_text(corners)
        before = {file: file.read_bytes() for file in sorted(self.folder.iterdir())}
        for arguments in (["run", "scene.json", "-o", "scene.json"],
                          ["run", "scene.json", "--trace", "press.csv", "-o", "press.csv"],
                          ["run", "scene.json", "-o", "out.xdmf"],
                          ["cage", "body.obj", "-o", "body.obj"],
                          ["cage", "body.obj", "-o", "cage.vtk"]):
            code, out, error = self.call(*arguments)
            self.assertEqual((code, out, error.count("\n")), (2, "", 1), f"{arguments}: {error}")
            self.assertIn(arguments[-1], error)
        self.assertEqual({file: file.read_bytes() for file in sorted(self.folder.iterdir())}, before)

    def test_0_validate_says_what_of_a_file_is_left_out(self):
        corners = "v 0 0 0\nv 9 9 9\nv .04 0 0\nv 0 .04 0\nv 0 0 .04\nf 1 4 3\nf 1 3 5\nf 3 4 5\nf 1 5 4\n"
        (self.folder / "stray.obj").write_text(corners)
        scene = make_scene("press.csv")
        scene["body"] = {"surface": {"file": "stray.obj", "target_tets": 400}, "fixed": scene["body"]["fixed"]}
        scene["contact"] = {"law": "pressure"}
        (self.folder / "stray.json").write_text(json.dumps(scene))
        code, _, error = self.call("validate", "stray.json")
        self.assertEqual(code, 0, error)
        self.assertEqual(error.count("stray.obj: 1 of 5 vertices belong to no triangle and are left out, number 1 (from 0)"), 1)

    def test_2_a_cage_in_another_unit(self):
        (self.folder / "body.obj").write_text("v 0 0 0\nv 40 0 0\nv 0 40 0\nv 0 0 40\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n")
        scene = make_scene("press.csv")
        scene["contact"] = {"law": "pressure"}
        for made, scale, remedy in (("1", 0.001, "argil cage --scale 0.001"), ("0.001", 1, "correct /body/surface/scale")):
            self.call("cage", "body.obj", "-o", "cage.msh", "--tets", "400", "--scale", made)
            scene["body"] = {"surface": {"file": "body.obj", "scale": scale, "cage": "cage.msh"},
                             "fixed": scene["body"]["fixed"]}
            (self.folder / "units.json").write_text(json.dumps(scene))
            for command in ("validate", "run"):
                code, _, error = self.call(command, "units.json")
                self.assertEqual(code, 2, error)
                self.assertRegex(error, r"cage.msh: /body/surface/cage: is [\d.]+ m across, and the surface [\d.]+ m by its scale")
                self.assertIn(remedy, error)

    def test_2_bad_command_lines(self):
        for arguments in ([], ["rum"], ["run"], ["run", "scene.json", "--threads", "0"], ["run", "scene.json", "--sett"]):
            self.assertEqual(self.call(*arguments)[0], 2, arguments)
        self.assertIn("rnu: is no command; did you mean run?", self.call("rnu", "scene.json")[2])

    def test_2_numbers_that_are_none(self):
        for option, others in (("--minimum-separation", ["ccd", "--kind", "edge-edge", "press.csv"]),
                               ("--budget", ["chart", "scene.json"]),
                               ("--scale", ["cage", "press.csv", "-o", "cage.msh"]),
                               ("--megabytes", ["export", "press.csv", "--html", "page.html"])):
            for value in ("nan", "-nan", "inf", "-1", "x"):
                code, _, error = self.call(*others, f"{option}={value}")
                self.assertEqual(code, 2, error)
                self.assertIn(option, error)

    def test_3_a_failed_run_keeps_the_last_good_state_and_the_failure(self):
        # A body whose tets may not lose a tenth of a thousandth of their volume, pressed.
        code, _, error = self.call("run", "scene.json", "-o", "out.h5", "--strict", "--set", "/dynamics/min_volume_ratio=0.9999")
        self.assertEqual(code, 3, error)
        self.assertRegex(error, r"argil: run failed: .*tick \d+")
        self.assertIn("tet", error)
        self.assertIn("0.9999", error)
        for remedy in ("/body/cells/near_tool_m", "/haptics/physics_period_ticks", "/dynamics/model", "/dynamics/strict"):
            self.assertIn(remedy, error)
        self.assertIn("smaller cells (/body/cells/near_tool_m)", self.call("info", "out.h5")[1])
        complete, last, _ = self.read_ends("out.h5")
        self.assertFalse(complete)
        self.assertLess(last, 0.1)
        with h5py.File(self.folder / "out.h5") as file:
            failure = dict(file["failure"].attrs)
        self.assertEqual(failure["bound"], 0.9999)
        self.assertLessEqual(failure["value"], 0.9999)
        self.assertAlmostEqual(last, 0.001 * failure["tick"], delta=0.0015)
        # The last frame is where a run ends that stops a tick before.
        ticks = round(last / 0.001)
        code, _, error = self.call("run", "scene.json", "-o", "before.h5", "--set", "/dynamics/min_volume_ratio=0.9999",
                                   "--set", f"/trace/duration_s={0.001 * ticks}")
        self.assertEqual(code, 0, error)
        with h5py.File(self.folder / "out.h5") as failed, h5py.File(self.folder / "before.h5") as whole:
            frames = [file["frames"][max(file["frames"])] for file in (failed, whole)]
            self.assertEqual([frame.attrs["tick"] for frame in frames], [ticks, ticks])
            for name in ("position", "plastic_strain"):
                self.assertTrue((frames[0][name][()] == frames[1][name][()]).all(), name)

    def test_0_without_strict_the_run_goes_on_and_says_what_was_limited(self):
        bound = ["--set", "/dynamics/min_volume_ratio=0.99"]
        code, _, error = self.call("run", "scene.json", "-o", "out.h5", *bound)
        self.assertEqual(code, 0, error)
        self.assertRegex(error, r"argil: note: the motion of up to \d+ tets? was limited in \d+ steps?")
        complete, last, _ = self.read_ends("out.h5")
        self.assertTrue(complete)
        with h5py.File(self.folder / "out.h5") as file:
            limited = file["physics/limited_tets"][()]
            self.assertGreater(file["physics/min_volume_ratio"][()].min(), 0.99)
            self.assertGreaterEqual(file["physics/limited_tet"][()][limited > 0].min(), 0)
            self.assertEqual(file["physics/limited_tet"][()][limited == 0].max(), -1)
            self.assertEqual(limited[0], 0)
            self.assertGreater(limited.max(), 0)
            first = file["physics/tick"][(limited > 0).argmax()]
        self.assertIn(f"first in tick {first} ", error)
        code, out, _ = self.call("info", "out.h5")
        self.assertIn(f"first in tick {first} ", out)
        code, _, error = self.call("run", "scene.json", "-o", "strict.h5", "--strict", *bound)
        self.assertEqual(code, 3, error)
        self.assertIn(f"tick {first},", error)

    def test_4_a_place_that_cannot_be_written(self):
        code, _, error = self.call("run", "scene.json", "-o", "no/such/folder/out.h5")
        self.assertEqual(code, 4, error)
        self.assertIn("no/such/folder/out.h5", error)

    def test_4_a_folder_that_is_read_only(self):
        self.folder.chmod(0o755)
        place = self.folder / "closed"
        place.mkdir(mode=0o555)
        nobody = 65534 if os.getuid() == 0 else None  # root may write anywhere
        program = shutil.copy(ARGIL, self.folder)  # where anyone may read
        done = subprocess.run([program, "run", "scene.json", "-o", "closed/out.h5"], cwd=self.folder, capture_output=True,
                              text=True, timeout=120, user=nobody)
        self.assertEqual(done.returncode, 4, done.stderr)
        self.assertIn("closed/out.h5: cannot be written: Permission denied", done.stderr)

    def test_4_a_full_disk_leaves_a_readable_file_to_resume(self):
        def limit():  # a limit on the file's size stands for the full disk
            resource.setrlimit(resource.RLIMIT_FSIZE, (700000, 700000))

        often = ["--set", "/haptics/frame_period_ticks=1", "--set", "/output/checkpoint_period_ticks=10"]
        done = subprocess.run([ARGIL, "run", "scene.json", "-o", "out.h5", *often], cwd=self.folder, capture_output=True,
                              text=True, timeout=120, preexec_fn=limit)
        self.assertEqual(done.returncode, 4, done.stderr)
        self.assertIn("out.h5: ", done.stderr)
        self.assertIn("File too large", done.stderr)
        self.assertIn("--resume", done.stderr)
        complete, last, frames = self.read_ends("out.h5")
        self.assertFalse(complete)
        self.assertGreater(frames, 10)
        self.assertGreaterEqual(last, 0.01)
        self.assertEqual(self.call("run", "scene.json", "-o", "out.h5", "--resume", *often)[0], 0)
        self.assertEqual(self.call("run", "scene.json", "-o", "whole.h5", *often)[0], 0)
        self.assertEqual(self.call("compare", "whole.h5", "out.h5")[0], 0)

    def test_2_another_run_is_not_resumed(self):
        self.assertEqual(self.call("run", "scene.json", "-o", "out.h5")[0], 0)
        code, out, _ = self.call("run", "scene.json", "-o", "out.h5", "--resume")
        self.assertEqual((code, out), (0, "out.h5: complete already\n"))
        xdmf = self.folder / "out.xdmf"
        whole = xdmf.read_bytes()
        for left in (None, whole[:len(whole) // 2], b"x"):  # killed before the XDMF was there, or while it was written
            xdmf.unlink()
            if left is not None:
                xdmf.write_bytes(left)
            self.assertEqual(self.call("run", "scene.json", "-o", "out.h5", "--resume")[0], 0)
            self.assertEqual(xdmf.read_bytes(), whole)
        code, _, error = self.call("run", "scene.json", "-o", "out.h5", "--resume", "--set", "/water/porosity=0.31")
        self.assertEqual(code, 2)
        self.assertIn("out.h5: /provenance/scenario_sha256: was written by another scenario", error)
        write_press(self.folder / "press.csv", 0.1, 0.0434)
        code, _, error = self.call("run", "scene.json", "-o", "out.h5", "--resume")
        self.assertEqual(code, 2)
        self.assertIn("read other files", error)
        write_press(self.folder / "press.csv", 0.1, 0.0435)
        with h5py.File(self.folder / "out.h5", "a") as file:
            build = file["provenance/build"][()]
            del file["provenance/build"]
            file["provenance/build"] = build.replace(b"commit ", b"commit 0")
        code, _, error = self.call("run", "scene.json", "-o", "out.h5", "--resume")
        self.assertEqual(code, 2)
        self.assertIn("another build of argil", error)

    def test_2_a_file_to_read_that_is_none(self):
        (self.folder / "folder").mkdir()
        for name, why in (("nowhere", "does not exist"), ("folder", "is a folder")):
            for arguments in (["info", name], ["compare", "scene.json", name], ["cage", name, "-o", "cage.msh"],
                              ["ccd", "--kind", "edge-edge", name], ["run", name], ["validate", name],
                              ["run", "scene.json", "--trace", name], ["validate", "scene.json", "--trace", name]):
                code, _, error = self.call(*arguments)
                self.assertEqual((code, error.count("\n")), (2, 1), f"{arguments}: {error}")
                self.assertIn(f"argil: {name}: {why}; ", error)

    def test_4_a_file_that_cannot_be_read(self):
        (self.folder / "text.h5").write_text("not HDF5")
        code, _, error = self.call("info", "text.h5")
        self.assertEqual(code, 4, error)
        self.assertIn("text.h5", error)

    def test_2_validate_refuses_what_a_run_would_at_its_start(self):
        rows = [f"{k / 1000},0.001,0.0007,{0.03 + 0.0005 * k}" for k in range(50)]  # out of the ball's upper half
        (self.folder / "inside.csv").write_text("\n".join(["t,x,y,z", *rows]) + "\n")
        refusals = [self.call(command, "scene.json", "--trace", "inside.csv")[::2] for command in ("validate", "run")]
        self.assertEqual(refusals[0], refusals[1])
        self.assertEqual(refusals[0][0], 2)
        self.assertIn("inside.csv: the tool starts in or across the body", refusals[0][1])

    def test_5_compare_tells_equal_results_from_different_ones(self):
        for name, more in (("a.h5", []), ("b.h5", ["--threads", "2"]),
                           ("c.h5", ["--set", "/material/youngs_modulus_Pa=1.1e5"])):
            self.assertEqual(self.call("run", "scene.json", "-o", name, *more)[0], 0)
        self.assertEqual(self.call("compare", "a.h5", "b.h5")[0], 0)
        code, out, _ = self.call("compare", "a.h5", "c.h5")
        self.assertEqual(code, 5)
        self.assertIn("/haptic/force", out)
        self.check_figures(out.splitlines())
        verbose = self.call("compare", "a.h5", "c.h5", "--verbose")[1]
        few, all_of_it = ([line for line in said.splitlines() if re.match("  [^ ]", line)] for said in (out, verbose))
        without_hashes = [line for line in all_of_it if not re.search("state_hash|sha256|run_id", line.split(": ")[0])]
        self.assertLess(len(without_hashes), len(all_of_it))
        self.assertEqual(few[:-1], without_hashes[:8])
        self.assertIn(f"{len(all_of_it) - 8} more, hashes among them, by --verbose", few[-1])
        self.assertEqual(len(verbose.splitlines()) - verbose.splitlines().index("") - 2,
                         int(re.search(r"; (\d+) of \d+ datasets", verbose)[1]))
        for wide, expected in ((1.0, 0), (1e-9, 5)):
            (self.folder / "near.json").write_text(json.dumps({
                "ignore": ["/provenance", "/physics/*", "/haptic/num_contacts"],
                "tolerances": [{"dataset": "/haptic/*", "of_largest": wide}, {"dataset": "/frames/*", "absolute": wide}]}))
            self.assertEqual(self.call("compare", "a.h5", "c.h5", "--tolerances", "near.json")[0], expected)
        (self.folder / "near.json").write_text('{"tolerances": [{"dataset": "/haptic/*", "relativ": 1}]}')
        code, _, error = self.call("compare", "a.h5", "c.h5", "--tolerances", "near.json")
        self.assertEqual(code, 2)
        self.assertIn("near.json: /tolerances/0/relativ: is not a known key; did you mean relative?", error)

    def check_figures(self, lines):
        """What compare opens with, against h5py's reading of the two files."""
        def read(name):
            with h5py.File(self.folder / name) as file:
                force = np.linalg.norm(file["haptic/force"][:], axis=1)
                frames = [frame["position"][:] for frame in file["frames"].values()]
                moved = max(np.linalg.norm(x - file["mesh/rest_position"][:], axis=1).max() for x in frames)
                return {"peak force": force.max(), "impulse": force.sum() * 1e-3, "work on the body": file["physics/contact_work"][-1],
                        "water at the end": 1e3 * file["physics/water_mass"][-1], "largest displacement": moved}
        a, c = read("a.h5"), read("c.h5")
        said = {line[:22].strip(): re.findall(r"(-?[0-9.e+-]+) ([numµ]?)(?:N s|N|J|g|m)(?= |$)", line[22:50]) for line in lines[1:7]}
        self.assertRegex(lines[0], "^ +a +b +b - a$")
        for name in a:
            values = [float(number) * {"n": 1e-9, "u": 1e-6, "µ": 1e-6, "m": 1e-3, "": 1}[prefix] for number, prefix in said[name]]
            np.testing.assert_allclose(values, [a[name], c[name]], rtol=6e-4, atol=1e-12, err_msg=name)
        share = 100 * (c["peak force"] / a["peak force"] - 1)
        self.assertAlmostEqual(float(re.search(r"\(([+-][0-9.]+) %\)", lines[1])[1]), share, delta=0.01 * abs(share))

    def wait_for(self, file):
        """Until a run has made its file and is well inside its loop."""
        for _ in range(600):
            if (self.folder / file).exists():
                break
            time.sleep(0.05)
        time.sleep(0.5)

    def test_130_a_terminated_run_goes_on_where_it_was_and_has_one_writer(self):
        write_press(self.folder / "press.csv", 40.0, 0.0435)  # seconds of work
        command = [ARGIL, "run", "scene.json", "-o", "out.h5", "-q", "--set", "/haptics/physics_period_ticks=5"]
        with subprocess.Popen(command, cwd=self.folder, stderr=subprocess.PIPE, text=True) as run:
            self.wait_for("out.h5")
            run.send_signal(signal.SIGSTOP)  # however long the others take, it is not over when they are
            for more in ([], ["--resume"]):
                code, _, error = self.call(*command[1:], *more)
                self.assertEqual(code, 4)
                self.assertIn("out.h5: another process has this file open", error)
            run.send_signal(signal.SIGTERM)
            run.send_signal(signal.SIGCONT)
            _, error = run.communicate(timeout=60)
        self.assertEqual(run.returncode, 130, error)
        self.assertIn("go on with --resume", error)
        with h5py.File(self.folder / "out.h5") as file:
            self.assertEqual(file["checkpoint/tick"][0, 0], file["haptic/tick"][-1])
        code, out, error = self.call(*command[1:4], "out.h5", *command[6:], "--resume")
        self.assertEqual(code, 0, error)
        self.assertRegex(out, r"resumed after tick \d+")
        self.assertEqual(self.call(*command[1:4], "whole.h5", *command[6:])[0], 0)
        self.assertEqual(self.call("compare", "whole.h5", "out.h5")[0], 0)

    def test_130_an_interrupted_run_is_readable_up_to_its_last_frame(self):
        write_press(self.folder / "long.csv", 60.0, 0.0435)  # minutes of work
        self.write_scene("long.json", "long.csv")
        with subprocess.Popen([ARGIL, "run", "long.json", "-o", "out.h5"], cwd=self.folder,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as run:
            self.wait_for("out.h5")
            run.send_signal(signal.SIGINT)
            _, error = run.communicate(timeout=60)
        self.assertEqual(run.returncode, 130, error)
        self.assertIn("interrupted after tick", error)
        complete, last, frames = self.read_ends("out.h5")
        self.assertFalse(complete)
        self.assertGreater(last, 0.0)
        self.assertGreaterEqual(frames, 2)


if __name__ == "__main__":
    unittest.main()
