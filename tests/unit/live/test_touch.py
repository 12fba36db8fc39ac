#!/usr/bin/python3
"""The plug-in of examples/touch, loaded by argil live and by hand, with a stand-in for the vendor's library.

Usage: test_touch.py ARGIL TOUCH.so       the program, and the plug-in linked to tests/support/openhaptics_stand_in.cpp
"""
import ctypes
import json
import os
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

import h5py
import numpy

ARGIL = str(Path(sys.argv.pop(1)).resolve())
TOUCH = str(Path(sys.argv.pop(1)).resolve())

MOST = 3.3  # [N] that the stand-in declares
HEAD = ["num_rows", "num_misuses", "is_enabled", "is_stopped", "is_disabled", "num_updates"]
ROW = numpy.dtype([("time", "f8"), ("pen_height", "f8"), ("force", "f8", 3), ("buttons", "i8"), ("fault", "i8")])
NUM_ROWS = 60000
NONE, SAMPLE = 0, 1  # of plugin_api.h
# The device's axes (x right, y up, z to the user) in the world, whose z is up: (x, y, z) is (x, -z, y).
TO_WORLD = numpy.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]], float)
SCENE = {
    "about": "a ball pressed from above",
    "body": {"shape": {"kind": "sphere", "size_m": 0.04, "target_tets": 600, "skin_triangles": 500},
             "fixed": [{"kind": "half_space", "normal": [0, 0, 1], "offset_m": 0.006}]},
    "material": {"youngs_modulus_Pa": 1e5, "poissons_ratio": 0.3},
    "tool": {"shape": {"kind": "sphere", "radius_m": 0.006, "subdivisions": 2}, "mode": "trace"},
    "contact": {"law": "pairs", "vertex_face_stiffness_N_per_m": 400, "edge_edge_stiffness_N_per_m": 400},
    "haptics": {"physics_period_ticks": 2, "water_period_ticks": 10, "frame_period_ticks": 50},
    "trace": {"device_to_world": {"rotation_xyzw": [0.5 ** 0.5, 0, 0, 0.5 ** 0.5]}},
}


class Log:
    """What the stand-in did, while it does it and after its process has died."""

    def __init__(self, file):
        self.file = str(file)
        with open(file, "wb") as empty:
            empty.truncate(8 * len(HEAD) + ROW.itemsize * NUM_ROWS)

    def __getattr__(self, name):
        return int(numpy.fromfile(self.file, "i8", len(HEAD))[HEAD.index(name)])

    @property
    def rows(self):
        return numpy.fromfile(self.file, ROW, self.num_rows, offset=8 * len(HEAD))

    @property
    def force(self):
        """[N] that the motors were told, a row a servo period, device axes."""
        return self.rows["force"]

    @property
    def norms(self):
        return numpy.linalg.norm(self.force, axis=1)


class WithLog(unittest.TestCase):
    def setUp(self):
        self.temp = tempfile.TemporaryDirectory()
        self.addCleanup(self.temp.cleanup)
        self.folder = Path(self.temp.name)
        self.log = Log(self.folder / "log")

    def assert_let_go(self):
        """The motors' last word is zero force, then the device is closed; no call was out of order."""
        self.assertEqual(list(self.log.force[-1]), [0, 0, 0])
        self.assertEqual((self.log.is_stopped, self.log.is_disabled, self.log.num_misuses), (1, 1, 0))


class Sessions(WithLog):
    def setUp(self):
        super().setUp()
        (self.folder / "scene.json").write_text(json.dumps(SCENE))

    def start(self, script, *arguments, device=TOUCH):
        process = subprocess.Popen(
            [ARGIL, "live", "scene.json", "-o", "live.h5", "--device", f"plugin:{device}", *arguments], cwd=self.folder,
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
            env={**os.environ, "ARGIL_STAND_IN": script, "ARGIL_STAND_IN_LOG": self.log.file})
        self.addCleanup(process.kill)
        return process

    def call(self, script, *arguments, **options):
        process = self.start(script, *arguments, **options)
        _, said = process.communicate(timeout=300)
        return process.returncode, said

    def wait_for_force(self, process):
        while process.poll() is None and not (self.log.num_rows and self.log.norms[-1] > 0.01):
            time.sleep(0.005)
        self.assertIsNone(process.poll())

    def test_a_motion_comes_in_and_its_force_goes_out(self):
        code, said = self.call("", "--duration", "3")
        self.assertEqual(code, 0, said)
        self.assertEqual(self.log.is_enabled, 1)
        self.assert_let_go()
        with h5py.File(self.folder / "live.h5") as file:
            self.assertEqual(file["session"].attrs["device"], b"Stand-in for a Touch")
            self.assertEqual(file["session"].attrs["max_force_N"], MOST)
            place, turn = file["haptic/tool_position"][:], file["haptic/tool_orientation"][:]
            sent = file["haptic/device_force"][:]
        # The pen stands at (1, height, -0.7) mm, turned by 30° about its y; the world's rotation is 90° about x.
        numpy.testing.assert_allclose(place[:, :2], [[0.001, 0.0007]] * len(place), atol=1e-12)
        self.assertAlmostEqual(place[:, 2].max(), 0.048, delta=1e-9)
        self.assertAlmostEqual(place[:, 2].min(), 0.0435, delta=1e-5)
        half = numpy.radians([45, 15])
        expected = [numpy.sin(half[0]) * numpy.cos(half[1]), numpy.cos(half[0]) * numpy.sin(half[1]),
                    numpy.sin(half[0]) * numpy.sin(half[1]), numpy.cos(half[0]) * numpy.cos(half[1])]  # Hamilton's product
        numpy.testing.assert_allclose(turn, [expected] * len(turn), atol=1e-12)
        # What the motors were told are forces of the ticks, in the device's axes; upward while the ball is pressed.
        told = self.log.force[self.log.norms > 0]
        self.assertGreater(len(told), 500)
        self.assertGreater(numpy.median(told[:, 1] / numpy.linalg.norm(told, axis=1)), 0.9)
        ticks = sent[numpy.linalg.norm(sent, axis=1) > 0] @ TO_WORLD
        for force in told[::25]:
            self.assertLess(numpy.abs(ticks - force).sum(axis=1).min(), 1e-12)

    def test_buttons_choose_the_tools_mode(self):
        code, said = self.call("buttons", "--duration", "3")
        self.assertEqual(code, 0, said)
        with h5py.File(self.folder / "live.h5") as file:
            mode = file["haptic/mode"][:]
        changes = [int(mode[0]), *mode[1:][numpy.diff(mode.astype(int)) != 0]]
        self.assertEqual(changes, [0, 1, 0])  # button 1: push to pull; button 2: back

    def test_no_more_force_than_the_device_declares(self):
        stiff = [word for pair in ("vertex_face", "edge_edge")
                 for word in ("--set", f"/contact/{pair}_stiffness_N_per_m=1e6")]
        code, said = self.call("", "--duration", "2.5", "--set", "/haptics/device/max_force_N=50", *stiff)
        self.assertIn(code, (0, 3), said)
        with h5py.File(self.folder / "live.h5") as file:
            self.assertGreater(numpy.linalg.norm(file["haptic/force"][:], axis=1).max(), 2 * MOST)
        self.assertGreater(self.log.norms.max(), 0.9 * MOST)
        self.assertLessEqual(self.log.norms.max(), MOST * (1 + 1e-12))
        self.assert_let_go()

    def test_a_device_that_is_not_calibrated_asks_for_the_inkwell(self):
        code, said = self.call("uncalibrated", "--duration", "3")
        self.assertEqual(code, 4, said)
        self.assertIn("touch: the device is not calibrated: put the pen into its inkwell", said)
        self.assertRegex(said, "argil: .*put the pen into its inkwell.*start again")
        self.assertFalse((self.folder / "live.h5").exists())
        self.assertEqual((self.log.is_stopped, self.log.is_disabled, self.log.num_misuses), (1, 1, 0))

    def test_a_pen_that_is_put_into_its_inkwell_in_time(self):
        code, said = self.call("uncalibrated put_in@0.5", "--duration", "0.5")
        self.assertEqual(code, 0, said)
        self.assertEqual(said.count("put the pen into its inkwell"), 1)

    def test_an_error_on_the_way_to_the_first_sample_is_said(self):
        header = (Path(__file__).parents[2] / "support/openhaptics/HD/hd.h").read_text()
        code = header.split("#define HD_COMM_ERROR ")[1].split("u")[0]
        for place in "open", "start", "look", "schedule":
            with self.subTest(place):
                self.log = Log(self.folder / "log")
                exit_code, said = self.call(f"{place}_error={code}", "--duration", "0.5")
                self.assertEqual(exit_code, 4, said)
                self.assertIn("check its cable", said)
                self.assertEqual((self.log.is_disabled, self.log.num_misuses), (1, 0))
                self.assertFalse((self.folder / "live.h5").exists())

    def test_what_the_device_says_of_itself_is_in_SI_units(self):
        # The data sheet's workspace, 160 W x 120 H x 70 D mm, and a stiffness of 1 N/mm.
        done = subprocess.run([ARGIL, "devices", f"plugin:{TOUCH}"], capture_output=True, text=True, timeout=60, check=False,
                              env={**os.environ, "ARGIL_STAND_IN": "", "ARGIL_STAND_IN_LOG": self.log.file})
        self.assertIn("ready, Stand-in for a Touch, largest force 3.3 N, torque not stated, stiffness 1000 N/m, rate 1000 Hz, "
                      "workspace 0.16 x 0.12 x 0.07 m", done.stdout)

    def test_a_calibration_that_is_out_of_date_is_updated_once(self):
        code, said = self.call("outdated", "--duration", "0.5")
        self.assertEqual(code, 0, said)
        self.assertEqual((self.log.num_updates, self.log.num_misuses), (1, 0))

    def test_a_fault_lets_the_hand_go_and_says_what_to_do(self):
        header = (Path(__file__).parents[2] / "support/openhaptics/HD/hd.h").read_text()
        for name, words in (("HD_DEVICE_FAULT", "check its power and its cable"), ("HD_COMM_ERROR", "check its cable"),
                            ("HD_WARM_MOTORS", "motors are too warm"), ("HD_EXCEEDED_MAX_FORCE", "max_force_N"),
                            ("HD_EXCEEDED_MAX_VELOCITY", "move it more slowly"),
                            ("HD_BAD_HANDLE", "OpenHaptics says: an error of the stand-in")):
            with self.subTest(name):
                code = header.split(f"#define {name} ")[1].split("u")[0]
                self.log = Log(self.folder / "log")
                exit_code, said = self.call(f"fault={code}@1.5", "--duration", "60")  # at its deepest
                self.assertEqual(exit_code, 4, said)
                self.assertIn("the device was lost", said)
                self.assertIn(words, said)
                rows = self.log.rows
                first = int(numpy.argmax(rows["fault"]))
                self.assertGreater(self.log.norms[first - 20:first].max(), 0.01)
                self.assertEqual(self.log.norms[first + 1:].max(), 0.0)
                self.assert_let_go()

    def test_a_servo_loop_that_stops_is_a_lost_device(self):
        code, said = self.call("stalls@1.5", "--duration", "60")
        self.assertEqual(code, 4, said)
        self.assertIn("servo loop has stopped", said)

    def test_a_device_that_is_not_there_is_said(self):
        for script, device, words in (("absent", TOUCH, "check its cable"), ("", f"{TOUCH},Other", "check its cable"),
                                      ("limitless", TOUCH, "does not say how much force")):
            with self.subTest(words):
                code, said = self.call(script, "--duration", "1", device=device)
                self.assertEqual(code, 4, said)
                self.assertIn(words, said)
                self.assertEqual(self.log.num_misuses, 0)

    def test_an_interrupt_ends_with_zero_force(self):
        process = self.start("", "--duration", "60")
        self.wait_for_force(process)
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=60)
        self.assertEqual(process.returncode, 130)
        self.assert_let_go()

    def test_a_crash_ends_with_zero_force(self):
        for _ in range(5):  # as in test_release_is_zero_force_when_it_returns_and_until_the_next_one
            self.log = Log(self.folder / "log")
            process = self.start("", "--duration", "60")
            self.wait_for_force(process)
            process.send_signal(signal.SIGSEGV)
            process.communicate(timeout=60)
            self.assertEqual(process.returncode, -signal.SIGSEGV)
            if not self.log.norms[-1]:
                break
        self.assertEqual(list(self.log.force[-1]), [0, 0, 0])
        self.assertEqual(self.log.is_disabled, 0)  # it did crash


class Sample(ctypes.Structure):
    _fields_ = [("position", ctypes.c_double * 3), ("orientation", ctypes.c_double * 4), ("buttons", ctypes.c_uint32)]


class Plugin(ctypes.Structure):
    """argil_plugin of src/device/plugin_api.h."""
    _fields_ = [("version", ctypes.c_uint32),
                ("open", ctypes.CFUNCTYPE(ctypes.c_void_p, ctypes.c_char_p, ctypes.POINTER(ctypes.c_char_p))),
                ("describe", ctypes.c_void_p),
                ("read", ctypes.CFUNCTYPE(ctypes.c_int32, ctypes.c_void_p, ctypes.POINTER(Sample),
                                          ctypes.POINTER(ctypes.c_char_p))),
                ("write", ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_double * 3, ctypes.c_double * 3)),
                ("release", ctypes.CFUNCTYPE(None, ctypes.c_void_p)), ("close", ctypes.CFUNCTYPE(None, ctypes.c_void_p))]


class ByHand(WithLog):
    """Where argil itself does not let it come to that."""

    def setUp(self):
        super().setUp()
        os.environ.update(ARGIL_STAND_IN="", ARGIL_STAND_IN_LOG=self.log.file)
        library = ctypes.CDLL(TOUCH)
        library.argil_plugin_entry.restype = ctypes.POINTER(Plugin)
        self.plugin = library.argil_plugin_entry().contents
        self.reason = ctypes.c_char_p()
        self.device = self.plugin.open(b"", ctypes.byref(self.reason))
        self.assertTrue(self.device, self.reason.value)
        self.addCleanup(self.close)

    def close(self):
        if self.device:
            self.plugin.close(self.device)
        self.device = None

    def open_again(self, script):
        self.close()
        self.log = Log(self.folder / "log")
        os.environ["ARGIL_STAND_IN"] = script
        self.device = self.plugin.open(b"", ctypes.byref(self.reason))
        self.assertTrue(self.device, self.reason.value)

    def read(self):
        return self.plugin.read(self.device, ctypes.byref(Sample()), ctypes.byref(self.reason))

    def write(self, x, y, z):
        self.plugin.write(self.device, (ctypes.c_double * 3)(x, y, z), (ctypes.c_double * 3)())

    def hold(self, wanted, told):
        """Writes `wanted` as argil's device thread does, until the motors are told `told`: a busy machine takes its time."""
        for _ in range(5000):
            self.plugin.read(self.device, ctypes.byref(Sample()), ctypes.byref(self.reason))
            self.write(*wanted)
            if numpy.allclose(self.log.force[-1:], told, rtol=1e-14, atol=0) and self.log.num_rows > 20:
                return
        self.fail(f"the motors are told {self.log.force[-1]}, not {told}")

    def test_its_own_limit_keeps_the_direction(self):
        self.hold((30.0, 0.0, 40.0), (0.6 * MOST, 0.0, 0.8 * MOST))
        self.hold((1e300, 0.0, 0.0), (MOST, 0.0, 0.0))
        self.hold((1.0, 2.0, -0.5), (1.0, 2.0, -0.5))

    def test_a_place_is_given_once(self):
        self.open_again("stalls@0.3")
        self.assertEqual(self.read(), SAMPLE)
        time.sleep(0.4)
        self.assertIn(self.read(), (SAMPLE, NONE))  # the last one before it stalls
        self.assertEqual([self.read() for _ in range(5)], [NONE] * 5)

    def test_after_a_fault_the_motors_rest_whatever_is_asked(self):
        header = (Path(__file__).parents[2] / "support/openhaptics/HD/hd.h").read_text()
        self.open_again("fault=" + header.split("#define HD_WARM_MOTORS ")[1].split("u")[0] + "@0.3")
        end = time.monotonic() + 0.8
        while time.monotonic() < end:
            self.write(1.0, 0.0, 0.0)
            time.sleep(0.001)
        rows = self.log.rows
        first = int(numpy.argmax(rows["fault"]))
        self.assertGreater(first, 0)
        self.assertGreater(self.log.norms[:first].max(), 0.9)
        self.assertEqual(self.log.norms[first + 1:].max(), 0.0)

    def test_a_force_that_is_no_number_is_none(self):
        for wrong in float("nan"), float("inf"):
            self.hold((1.0, 0.0, 0.0), (1.0, 0.0, 0.0))
            self.hold((wrong, 1.0, 0.0), (0.0, 0.0, 0.0))
        self.assertTrue(numpy.isfinite(self.log.force).all())

    def test_without_new_forces_the_motors_rest(self):
        self.hold((1.0, 0.0, 0.0), (1.0, 0.0, 0.0))
        time.sleep(0.3)
        self.assertEqual(list(self.log.force[-1]), [0, 0, 0])
        self.assertGreater(self.log.rows["time"][-1] - self.log.rows["time"][self.log.norms > 0][-1], 0.05)

    def test_release_is_zero_force_when_it_returns_and_until_the_next_one(self):
        for _ in range(20):  # on a busy machine the servo loop may come later than release waits
            self.hold((1.0, 0.0, 0.0), (1.0, 0.0, 0.0))
            self.plugin.release(self.device)
            if not self.log.norms[-1]:
                break
        self.assertEqual(list(self.log.force[-1]), [0, 0, 0])
        time.sleep(0.01)
        self.assertEqual(list(self.log.force[-1]), [0, 0, 0])
        self.hold((0.5, 0.0, 0.0), (0.5, 0.0, 0.0))

    def test_closing_is_zero_force(self):
        self.hold((1.0, 0.0, 0.0), (1.0, 0.0, 0.0))
        self.close()
        self.assertEqual(self.log.norms.max(), 1.0)
        self.assert_let_go()


if __name__ == "__main__":
    unittest.main()
