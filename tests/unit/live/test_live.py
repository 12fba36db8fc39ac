#!/usr/bin/python3
"""argil live with devices that are programs: a session replays to the same bits, however it ended.

Usage: test_live.py ARGIL HOSTILE_PLUGIN        the program, and the device of tests/support/hostile_plugin.cpp
"""
import json
import math
import os
import pty
import re
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

import h5py
import numpy

SUPPORT = Path(__file__).resolve().parents[2] / "support"
ARGIL = str(Path(sys.argv.pop(1)).resolve())
HOSTILE = str(Path(sys.argv.pop(1)).resolve())


def write_press(file, seconds):
    """From 2 mm over the ball 2.5 mm into it and out again, once a second."""
    lines = ["t,x,y,z"]
    for k in range(int(seconds * 100) + 1):
        share = 0.5 - 0.5 * math.cos(2 * math.pi * k / 100)
        lines.append(f"{k / 100},0.001,0.0007,{0.048 - 0.0045 * share}")
    file.write_text("\n".join(lines) + "\n")


def make_scene(haptics):
    return {
        "about": "a ball pressed from above",
        "body": {"shape": {"kind": "sphere", "size_m": 0.04, "target_tets": 600, "skin_triangles": 500},
                 "fixed": [{"kind": "half_space", "normal": [0, 0, 1], "offset_m": 0.006}]},
        "material": {"youngs_modulus_Pa": 1e5, "poissons_ratio": 0.3,
                     "clay_kernel": {"k1_per_m": 2, "k2_per_m": 60, "radius_m": 0.03}},
        "tool": {"shape": {"kind": "sphere", "radius_m": 0.006, "subdivisions": 2}, "mode": "push"},
        "contact": {"law": "pairs", "vertex_face_stiffness_N_per_m": 400, "edge_edge_stiffness_N_per_m": 400},
        "haptics": {"physics_period_ticks": 2, "water_period_ticks": 10, "frame_period_ticks": 50, **haptics},
        "trace": {"file": "press.csv"},
    }


class Live(unittest.TestCase):
    def setUp(self):
        self.temp = tempfile.TemporaryDirectory()
        self.addCleanup(self.temp.cleanup)
        self.folder = Path(self.temp.name)
        write_press(self.folder / "press.csv", 200)
        self.write_scene("scene.json", {"between_frames": "re_evaluate"})

    def write_scene(self, name, haptics):
        (self.folder / name).write_text(json.dumps(make_scene(haptics)))

    def call(self, *arguments, environment=None):
        return subprocess.run([ARGIL, *arguments], cwd=self.folder, capture_output=True, text=True, timeout=300,
                              env={**os.environ, **(environment or {})})

    def start(self, *arguments):
        device = [] if "--device" in arguments else ["--device", "simulated"]
        process = subprocess.Popen([ARGIL, "live", "scene.json", "-o", "live.h5", *device, *arguments],
                                   cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(process.kill)
        return process

    def wait_for_rows(self, process, wanted, table="haptic"):
        """Until so many ticks, or steps, are in the file."""
        while process.poll() is None:
            time.sleep(0.05)
            try:
                with h5py.File(self.folder / "live.h5", "r", locking=False) as file:
                    if file[table]["tick"].shape[0] >= wanted:
                        return
            except (OSError, RuntimeError, KeyError):
                pass  # between two flushes
        self.fail(process.stderr.read())

    def replay(self, *arguments):
        done = self.call("run", "scene.json", "--trace", "live.h5", "-o", "again.h5", *arguments)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done

    def assert_equal(self):
        done = self.call("compare", "live.h5", "again.h5")
        self.assertEqual(done.returncode, 0, done.stdout)

    def test_a_replay_finds_no_difference(self):
        for way in "hold", "re_evaluate":
            self.write_scene("scene.json", {"between_frames": way})
            done = self.call("live", "scene.json", "--device", "simulated", "-o", "live.h5", "--duration", "1.2")
            self.assertEqual(done.returncode, 0, done.stderr)
            self.replay()
            self.assert_equal()
            with h5py.File(self.folder / "live.h5") as file:
                self.assertEqual(file.attrs["complete"], 1)
                self.assertEqual(file["haptic/tick"].shape[0], 1200)
                self.assertEqual(file["timing/ticks/wake_late"].shape[0], 1200)
                self.assertEqual(file["timing/steps/work"].shape[0], file["physics/tick"].shape[0])
                self.assertGreater(numpy.abs(file["haptic/force"]).max(), 0.01)
                self.assertEqual(file["timing/num_ticks"][0], 1200)

    def test_a_force_that_trembles_ends_it_and_its_replay_alike(self):
        # Contact that is held and not in the solve, stiffer than the clay: the body is thrown off the tool, step by step.
        self.write_scene("scene.json", {"between_frames": "hold"})
        bare = ["--set", "/dynamics/implicit_contact=false", "--set", "/contact/vertex_face_stiffness_N_per_m=1000",
                "--strict"]
        done = self.call("live", "scene.json", "--device", "simulated", "-o", "live.h5", "--duration", "6", *bare)
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertIn("trembles above 50 Hz", done.stderr)
        done = self.call("run", "scene.json", "--trace", "live.h5", "-o", "again.h5", *bare)
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertIn("trembles above 50 Hz", done.stderr)
        self.assert_equal()
        with h5py.File(self.folder / "live.h5") as file:
            self.assertEqual(file["failure"].attrs["tick"], file["haptic/tick"][-1] + 1)

    def test_a_replay_is_a_session_that_replays_again(self):
        self.call("live", "scene.json", "--device", "simulated", "-o", "first.h5", "--duration", "0.5")
        (self.folder / "first.h5").rename(self.folder / "live.h5")
        self.replay()
        (self.folder / "again.h5").rename(self.folder / "live.h5")
        self.replay()
        self.assert_equal()

    def test_a_device_needs_no_trace(self):
        scene = make_scene({"between_frames": "re_evaluate"})
        del scene["trace"]
        (self.folder / "scene.json").write_text(json.dumps(scene))
        done = self.call("live", "scene.json", *self.hostile("good"), "-o", "live.h5", "--duration", "1")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.replay()
        self.assert_equal()
        with h5py.File(self.folder / "live.h5") as file:
            self.assertEqual(file["haptic/tick"].shape[0], 1000)
        for command in (("live", "--device", "simulated"), ("run",), ("validate",)):
            done = self.call(command[0], "scene.json", *command[1:])
            self.assertEqual(done.returncode, 2, command)
            self.assertIn("scene.json: /trace/file: is missing", done.stderr)

    def test_a_replay_with_other_settings_says_which(self):
        self.call("live", "scene.json", "--device", "simulated", "-o", "live.h5", "--duration", "0.3")
        done = self.replay("--set", "/material/youngs_modulus_Pa=2e5")
        self.assertIn("live.h5 is a session of another scenario or other inputs: only its motion is taken; other settings: "
                      "/material/youngs_modulus_Pa\n", done.stderr)
        self.assertNotIn("session of another", self.replay().stderr)

    def test_a_record_survives_a_kill_and_replays(self):
        process = self.start()
        self.wait_for_rows(process, 1024)
        self.wait_for_rows(process, 256, "physics")  # long after, where the physics is slow
        process.kill()
        process.communicate()
        done = self.replay()
        self.assertIn("was killed", done.stderr)
        with h5py.File(self.folder / "live.h5") as live, h5py.File(self.folder / "again.h5") as again:
            for name in "force", "torque", "device_force", "force_age", "tool_position":
                numpy.testing.assert_array_equal(live["haptic"][name], again["haptic"][name])
            # Ticks and steps are flushed apart: the last steps may be of ticks that are lost, or the other way about.
            steps = min(live["physics/tick"].shape[0], again["physics/tick"].shape[0])
            numpy.testing.assert_array_equal(live["physics/elastic_energy"][:steps],
                                             again["physics/elastic_energy"][:steps])
            self.assertGreater(steps, 0)

    def test_an_interrupt_ends_it_with_a_complete_file_and_130(self):
        process = self.start()
        self.wait_for_rows(process, 1024)
        process.send_signal(signal.SIGINT)
        said = process.communicate()[1]
        self.assertEqual(process.returncode, 130)
        self.assertIn("interrupted", said)
        self.replay()
        self.assert_equal()

    def test_another_program_reads_the_watched_file_while_it_grows(self):
        process = self.start("--watch", "watch.h5", "--duration", "4")
        seen = []
        while process.poll() is None:
            time.sleep(0.05)
            try:
                with h5py.File(self.folder / "watch.h5", "r", swmr=True) as file:
                    frames = file["frames/tick"].shape[0]
                    seen.append(frames)
                    self.assertGreaterEqual(file["frames/position"].shape[0], frames)
                    if frames:
                        self.assertGreaterEqual(file["ticks/tick"][-1] + 1, file["frames/tick"][frames - 1])
            except (OSError, KeyError):
                pass  # not shared yet
        self.assertEqual(process.returncode, 0, process.communicate()[1])
        self.assertGreater(len(set(seen)), 3, seen)
        with h5py.File(self.folder / "live.h5") as file:
            self.assertGreater(file["timing/picture_delay_max"][0], 0)

    def start_support(self, program, *arguments):
        """What it prints first, without the word before it."""
        process = subprocess.Popen([SUPPORT / program, *arguments], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.addCleanup(process.communicate)
        self.support = process
        return process.stdout.readline().split()[1]

    def start_stand_in(self, mode, good=1500):
        """A service on loopback whose hand circles over the ball's flank and touches it after a second."""
        port = self.start_support("haply_stand_in.py", "--mode", mode, "--good", str(good))
        return ["--device", "haply:127.0.0.1:" + port,
                "--set", "/trace/device_to_world/translation_m=[0.012, 0.12, -0.1075]"]

    def run_with_stand_in(self, mode, seconds, *arguments, good=1500):
        """The session, which replays, and what the service says of its connection."""
        done = self.call("live", "scene.json", "-o", "live.h5", "--duration", seconds, *arguments,
                         *self.start_stand_in(mode, good))
        report = json.loads(self.support.stdout.readline())
        self.assertEqual(report["forced_too_early"], 0)
        if done.returncode == 0 or "device was lost" in done.stderr:
            self.replay(*arguments)
            self.assert_equal()
        return done, report

    def test_a_haply_service_is_felt_and_replays(self):
        done, report = self.run_with_stand_in("normal", "2.5")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertGreater(report["largest_force"], 0.01)
        self.assertEqual(report["last_force"], [0, 0, 0])

    def test_a_service_that_goes_wrong_leaves_the_hand_without_force_and_a_complete_file(self):
        for mode, words in (("garbage", "no JSON object"), ("half", "no usable sample"), ("zero_quaternion", "quaternion"),
                            ("huge", "position or quaternion is none"), ("unplugged", "not connected any more")):
            with self.subTest(mode):
                done, report = self.run_with_stand_in(mode, "60")
                self.assertEqual(done.returncode, 4, done.stderr)
                self.assertIn("the device was lost", done.stderr)
                self.assertIn(words, done.stderr)
                self.assertGreater(report["largest_force"], 0.01)
                self.assertEqual(report["last_force"], [0, 0, 0])
                with h5py.File(self.folder / "live.h5") as file:
                    self.assertTrue((file["haptic/gate_events"][-1] & 16) != 0)  # the watchdog had acted before
                    self.assertEqual(list(file["haptic/device_force"][-1]), [0, 0, 0])

    def test_late_samples_let_the_hand_go_until_they_come_again(self):
        done, _ = self.run_with_stand_in("late", "4", good=200)
        self.assertEqual(done.returncode, 0, done.stderr)
        with h5py.File(self.folder / "live.h5") as file:
            is_watched = (file["haptic/gate_events"][:] & 16) != 0
            force, sent = (numpy.linalg.norm(file["haptic"][name][:], axis=1) for name in ("force", "device_force"))
            let_go = numpy.flatnonzero(is_watched & (force > 0.01) & (sent == 0))
            self.assertGreater(len(let_go), 0)
            self.assertGreater(sent[let_go[0]:].max(), 0)

    def test_duplicate_samples_change_nothing(self):
        done, report = self.run_with_stand_in("surplus", "2.5")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertGreater(report["largest_force"], 0.01)
        self.assertEqual(report["last_force"], [0, 0, 0])

    def test_a_huge_force_is_never_sent(self):
        stiff = [word for pair in ("vertex_face", "edge_edge")
                 for word in ("--set", f"/contact/{pair}_stiffness_N_per_m=1e6")]
        done, report = self.run_with_stand_in("normal", "2.5", *stiff)
        self.assertIn(done.returncode, (0, 3), done.stderr)
        self.assertGreater(report["largest_force"], 1.0)
        self.assertLessEqual(report["largest_force"], 3.3 * (1 + 1e-12))
        self.assertEqual(report["last_force"], [0, 0, 0])
        with h5py.File(self.folder / "live.h5") as file:
            self.assertGreater(numpy.linalg.norm(file["haptic/force"][:], axis=1).max(), 33)
            self.assertTrue(((file["haptic/gate_events"][:] & 2) != 0).any())

    @unittest.skipUnless(shutil.which("spacenavd"), "spacenavd is not installed")
    def test_a_controller_presses_and_replays(self):
        # Its reach ends at y = 0.2 m: there the tool is 2 mm deep in the ball's flank, at y = -0.018 m.
        socket = self.start_support("spacenav_stand_in.py", "--counts", "350", "--stroke", "2")
        done = self.call("live", "scene.json", "-o", "live.h5", "--device", "spacenav", "--duration", "8",
                         "--set", "/trace/device_to_world/translation_m=[0.001, -0.224, 0.02]",
                         environment={"SPNAV_SOCKET": socket})
        if "built without" in done.stderr or "unknown device" in done.stderr:
            self.skipTest("built without libspnav")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.replay()
        self.assert_equal()
        with h5py.File(self.folder / "live.h5") as file:
            self.assertLessEqual(file["haptic/tool_position"][:, 1].max(), -0.024 + 1e-12)
            self.assertGreater(numpy.abs(file["haptic/force"][:, 1]).max(), 0.01)

    def test_a_hand_of_4_kHz_replays(self):
        self.write_scene("scene.json", {"period_s": 0.00025, "physics_period_ticks": 8, "water_period_ticks": 40,
                                        "frame_period_ticks": 200})
        for device in ["--device", "simulated"], self.hostile("good"):
            with self.subTest(device[1]):
                done = self.call("live", "scene.json", *device, "-o", "live.h5", "--duration", "2")
                self.assertEqual(done.returncode, 0, done.stderr)
                self.replay()
                self.assert_equal()
                with h5py.File(self.folder / "live.h5") as file:
                    self.assertEqual(file["haptic/tick"].shape[0], 8000)
                    self.assertGreater(numpy.abs(file["haptic/device_force"]).max(), 0.01)

    def start_in_terminal(self, seconds):
        terminal, end = pty.openpty()
        words = [ARGIL, "live", "scene.json", "--device", "simulated", "-o", "live.h5", "--duration", seconds]
        process = subprocess.Popen(words, cwd=self.folder, stdout=subprocess.DEVNULL, stderr=end)
        os.close(end)
        self.addCleanup(os.close, terminal)
        self.addCleanup(process.kill)
        return process, terminal

    def read_to_end(self, terminal):
        seen = b""
        try:
            while piece := os.read(terminal, 4096):
                seen += piece
        except OSError:  # the other end is closed
            pass
        return seen

    def test_a_terminal_sees_force_water_rate_and_lateness(self):
        process, terminal = self.start_in_terminal("2")
        seen = self.read_to_end(terminal)
        self.assertEqual(process.wait(), 0, seen)
        lines = re.findall(r"(\d+\.\d) s +(\d+) ticks/s +force +(\d+\.\d+) N +S +(\d+\.\d) % +late +(\d+) us p99",
                           seen.decode())
        self.assertGreater(len(lines), 3, seen)
        self.assertGreater(max(float(line[2]) for line in lines), 0.01)  # the hand is at its deepest after half a second
        self.assertEqual({line[3] for line in lines}, {"0.0"})  # dry

    def test_a_terminal_that_its_user_has_stopped_does_not_hold_up_the_record(self):
        process, terminal = self.start_in_terminal("4")
        os.read(terminal, 4096)  # it draws
        os.write(terminal, b"\x13")  # Ctrl-S
        self.wait_for_rows(process, 2048)
        os.write(terminal, b"\x11")  # Ctrl-Q
        seen = self.read_to_end(terminal)
        self.assertEqual(process.wait(), 0, seen)
        self.replay()
        self.assert_equal()

    def test_a_service_that_vanishes_ends_it_with_a_complete_file(self):
        done = self.call("live", "scene.json", "-o", "live.h5", "--duration", "60", *self.start_stand_in("vanish"))
        self.assertEqual(done.returncode, 4, done.stderr)
        self.assertIn("the device was lost", done.stderr)
        self.replay()
        self.assert_equal()

    def hostile(self, mode):
        """A device that goes wrong in that way when its hand is in the ball."""
        (self.folder / "rendered").write_bytes(bytes(256))
        return ["--device", f"plugin:{HOSTILE},{mode}:{self.folder}/rendered"]

    def read_rendered(self):
        """Force, torque, largest of each, whether the device has gone wrong: as hostile_plugin.h lays them out."""
        values = struct.unpack("8d3i", (self.folder / "rendered").read_bytes()[:76])
        return values[:3], values[3:6], values[6], values[7], values[10]

    def wait_for_wrong(self, process):
        while process.poll() is None and not self.read_rendered()[4]:
            time.sleep(0.01)

    def test_a_device_that_does_not_answer_is_let_go_and_holds_nothing_up(self):
        process = self.start(*self.hostile("blocks"))
        self.wait_for_wrong(process)
        process.send_signal(signal.SIGINT)
        said = process.communicate(timeout=60)[1]
        self.assertIn(process.returncode, (130, 4), said)  # 4 when the device was lost before, after 2 s
        force, torque, largest_force, _, _ = self.read_rendered()
        self.assertGreater(largest_force, 0.01)
        self.assertEqual(force + torque, (0,) * 6)
        self.replay()
        self.assert_equal()

    def test_a_second_interrupt_ends_at_once_what_waits_for_a_device(self):
        process = self.start(*self.hostile("blocks"))
        self.wait_for_wrong(process)
        begin = time.monotonic()
        while process.poll() is None and time.monotonic() < begin + 60:
            process.send_signal(signal.SIGINT)
            time.sleep(0.2)
        said = process.communicate(timeout=60)[1]
        self.assertIn(process.returncode, (-signal.SIGINT, 130, 4), said)
        self.assertEqual(self.read_rendered()[0], (0, 0, 0))
        self.replay()

    def test_a_device_that_does_not_answer_is_lost(self):
        done = self.call("live", "scene.json", "-o", "live.h5", *self.hostile("blocks"))
        self.assertEqual(done.returncode, 4, done.stderr)
        self.assertIn("does not come back", done.stderr)
        self.assertEqual(self.read_rendered()[0], (0, 0, 0))

    def test_a_signal_that_kills_leaves_zero_force(self):
        for number in signal.SIGQUIT, signal.SIGUSR1, signal.SIGXCPU:
            process = self.start(*self.hostile("good"))
            self.wait_for_wrong(process)
            process.send_signal(number)
            process.communicate(timeout=60)
            self.assertEqual(process.returncode, -number)
            force, torque, largest_force, _, _ = self.read_rendered()
            self.assertGreater(largest_force, 0.01)
            self.assertEqual(force + torque, (0,) * 6)

    def test_what_a_device_declares_is_kept_to_and_replays(self):
        done = self.call("live", "scene.json", "-o", "live.h5", "--duration", "1.8", *self.hostile("weak"))
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("400 N/m is more than the 100 N/m that hostile declares", done.stderr)
        _, _, largest_force, largest_torque, _ = self.read_rendered()
        self.assertGreater(largest_force, 0.01)
        self.assertLessEqual(largest_force, 0.02 * (1 + 1e-12))
        self.assertGreater(largest_torque, 0)
        self.assertLessEqual(largest_torque, 1e-6 * (1 + 1e-12))
        self.replay()
        self.assert_equal()

    def test_a_session_of_another_material_is_a_motion_alone_and_says_so(self):
        self.call("live", "scene.json", "--device", "simulated", "-o", "live.h5", "--duration", "0.3")
        done = self.call("run", "scene.json", "--trace", "live.h5", "-o", "other.h5",
                         "--set", "/material/youngs_modulus_Pa=5e4")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("only its motion is taken", done.stderr)

    def test_what_cannot_run_live_is_refused_and_nothing_is_written(self):
        self.write_scene("scene.json", {"between_frames": "compliant"})
        for arguments, words in ((["--device", "simulated"], ["/haptics/between_frames", "re_evaluate"]),
                                 (["--device", "teapot"], ["between_frames"])):
            done = self.call("live", "scene.json", "-o", "live.h5", *arguments)
            self.assertEqual(done.returncode, 2)
            for word in words:
                self.assertIn(word, done.stderr)
        self.write_scene("scene.json", {"physics_period_ticks": 400, "water_period_ticks": 400, "frame_period_ticks": 400})
        done = self.call("live", "scene.json", "-o", "live.h5", "--device", "simulated")
        self.assertEqual(done.returncode, 2)
        self.assertIn("/haptics/physics_period_ticks: 400 ticks", done.stderr)
        self.assertIn("/haptics/device/watchdog/max_physics_age_s", done.stderr)
        self.write_scene("scene.json", {})
        for duration in ("0.0005", "1e300", "-1", "nan"):
            done = self.call("live", "scene.json", "-o", "live.h5", "--device", "simulated", "--duration", duration)
            self.assertEqual(done.returncode, 2)
            self.assertIn("--duration", done.stderr)
        for watch, words in (("live.h5", "is what the result is written to; give another name to --watch"),
                             ("live.xdmf", "--watch"), ("press.csv", "give another name to --watch"),
                             ("no/such/folder/w.h5", "no/such/folder/w.h5")):
            done = self.call("live", "scene.json", "-o", "live.h5", "--device", "simulated", "--watch", watch,
                             "--duration", "0.1")
            self.assertIn(done.returncode, (2, 4))
            self.assertIn(words, done.stderr)
            self.assertFalse((self.folder / "live.h5").exists())
        done = self.call("live", "scene.json", "-o", "live.h5", "--device", "teapot")
        self.assertEqual(done.returncode, 2)
        self.assertIn("teapot", done.stderr)
        self.assertFalse((self.folder / "live.h5").exists())


if __name__ == "__main__":
    unittest.main()
