#!/usr/bin/python3
"""The Python package computes what the program computes, to the same bits, and says what it refuses.

Usage: test_simulation.py ARGIL PACKAGE        the program, and the folder that the package lies in
Expected values: the files of `argil run`, read by h5py; the keys of scenarios; the motion that the trace was written
with.
"""
import json
import os
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest
from pathlib import Path

import h5py
import numpy as np

ARGIL, PACKAGE = (str(Path(word).resolve()) for word in sys.argv[1:3])
del sys.argv[1:3]
sys.path.insert(0, PACKAGE)
sys.dont_write_bytecode = True
import argil  # noqa: E402  pylint: disable=wrong-import-position

ROOT = Path(__file__).resolve().parents[2]
BALL = ROOT / "tests/golden/ball.json"
SET = {"/haptics/frame_period_ticks": 28}


def call(*words, code=0):
    done = subprocess.run([ARGIL, *map(str, words)], capture_output=True, text=True)
    if done.returncode != code:
        raise AssertionError(f"{words}: exit code {done.returncode}\n{done.stdout}\n{done.stderr}")
    return done.stdout + done.stderr


class Folder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="argil_python_")
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def file(self, name):
        return str(self.folder / name)


class SameBits(Folder):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="argil_python_")
        cls.addClassCleanup(folder.cleanup)
        cls.program = str(Path(folder.name, "program.h5"))
        call("run", BALL, *(f"--set={pointer}={value}" for pointer, value in SET.items()), "-o", cls.program, "--quiet")
        with h5py.File(cls.program) as file:
            cls.haptic = {name: data[:] for name, data in file["haptic"].items()}
            cls.last = {name: data[:] for name, data in file["frames/000003"].items()}
            cls.mesh = {name: data[:] for name, data in file["mesh"].items()}
            cls.hash = file["frames/000003"].attrs["state_hash"]
            cls.physics = {name: data[-1] for name, data in file["physics"].items()}
        cls.position = cls.haptic["tool_position"]

    def expect_equal(self, result):
        self.assertIn("equal", call("compare", self.program, result))

    def test_a_run_to_a_file_is_the_programs(self):
        result = argil.run(BALL, self.file("a.h5"), set=SET, threads=2)
        self.assertTrue(result.is_complete)
        self.assertTrue(os.path.exists(self.file("a.xdmf")))
        self.expect_equal(self.file("a.h5"))

    def test_a_dict_is_the_scenario_of_a_file(self):
        document = {**json.loads(BALL.read_text()), "haptics": {"frame_period_ticks": 28}}
        scene = argil.Scenario(document, folder=BALL.parent)
        scene.run(self.file("a.h5"))
        self.expect_equal(self.file("a.h5"))

    def test_ticks_one_by_one_are_the_programs(self):
        with argil.load(BALL, set=SET).start(record=self.file("a.h5")) as sim:
            self.assertEqual((sim.ticks, sim.num_ticks, sim.period), (0, 84, 1e-3))
            for k in range(84):
                np.testing.assert_array_equal(sim.tick(), self.haptic["force"][k])
                for name in ("torque", "device_force", "tool_position", "tool_orientation", "time", "num_contacts"):
                    np.testing.assert_array_equal(getattr(sim, name), self.haptic[name][k], err_msg=name)
            self.assertGreater(np.linalg.norm(self.haptic["force"], axis=1).max(), 1.0)
            self.assertEqual({name: sim.physics[name] for name in self.physics}, self.physics)
            self.assertEqual(sim.state_hash, self.hash if isinstance(self.hash, str) else self.hash.decode())
        self.expect_equal(self.file("a.h5"))

    def test_arrays_are_those_of_the_file_in_its_order(self):
        sim = argil.load(BALL, set=SET).start()
        sim.run()
        for ours, theirs in (("positions", "position"), ("saturation", "saturation"),
                             ("plastic_strain", "plastic_strain"), ("skin_positions", "skin_position"),
                             ("skin_saturation", "skin_saturation")):
            np.testing.assert_array_equal(getattr(sim, ours), self.last[theirs], err_msg=ours)
        for name, array in sim.mesh.items():
            np.testing.assert_array_equal(array, self.mesh[name], err_msg=name)
        self.assertIs(sim.tets, sim.mesh["tets"])
        self.assertGreater(np.ptp(sim.plastic_strain), 0.0)  # so that the order is seen

    def test_arrays_are_of_their_moment_and_read_only(self):
        sim = argil.load(BALL).start()
        before, rest = sim.positions, sim.positions.copy()
        sim.run(40)
        self.assertGreater(np.abs(sim.positions - before).max(), 1e-4)
        np.testing.assert_array_equal(before, rest)
        with self.assertRaises(ValueError):
            sim.positions[0, 0] = 1.0
        kept = sim.positions
        expected = kept.copy()
        del sim
        np.testing.assert_array_equal(kept, expected)

    def test_a_hand_that_goes_where_the_trace_goes_gives_the_same_bits(self):
        times = []

        def hand(at, force):
            times.append(at)
            self.assertEqual(force.shape, (3,))
            return self.position[len(times) - 1]

        with argil.load(BALL, set=SET).start(record=self.file("a.h5")) as sim:
            sim.run(84, hand=hand)
        np.testing.assert_allclose(times, self.haptic["time"], rtol=1e-14)
        with argil.open(self.file("a.h5")) as own:
            self.assertTrue(own.is_complete)
            for name, values in self.haptic.items():
                np.testing.assert_array_equal(getattr(own.haptic, name), values, err_msg=name)
            np.testing.assert_array_equal(own.frames[-1].position, self.last["position"])
            self.assertEqual(own.provenance.trace_sha256, "")
            self.assertIn("the hand was a program's own", own.provenance.notes)
            self.assertEqual(json.loads(own.provenance.scenario)["trace"]["file"], "")
        self.assertIn("hand: was a program's own", call("info", self.file("a.h5")))

    def test_a_hand_feels_the_force_of_the_tick_before(self):
        felt = []
        sim = argil.load(BALL, set=SET).start()
        sim.run(84, hand=lambda at, force: (felt.append(force), tuple(self.position[round(1e3 * at) - 1]))[1])
        np.testing.assert_array_equal(felt[1:], self.haptic["device_force"][:-1])

    def test_a_hand_may_turn_the_tool_and_change_its_mode(self):
        sim = argil.load(BALL, set={"/tool/mode": "trace"}).start()
        half = np.sqrt(0.5)
        sim.tick(self.position[0], orientation=[0, 0, half, half], mode="wet")
        self.assertEqual(sim.mode, "wet")
        np.testing.assert_allclose(sim.tool_orientation, [0, 0, half, half], rtol=1e-15)
        sim.tick(self.position[1])  # what is left out stays
        self.assertEqual(sim.mode, "wet")
        np.testing.assert_allclose(sim.tool_orientation, [0, 0, half, half], rtol=1e-15)
        sim.run(1, hand=lambda at, force: (self.position[2], None, "dry"))
        self.assertEqual(sim.mode, "dry")

    def test_a_hand_may_start_elsewhere(self):
        start = self.position[30]
        with self.assertRaisesRegex(argil.InputError, "the tool starts in or across the body.*start outside the body"):
            argil.load(BALL).start(position=start)
        sim = argil.load(BALL).start(position=start + [0, 0, 0.03], orientation=[1, 0, 0, 0])
        sim.tick(start + [0, 0, 0.03])
        np.testing.assert_array_equal(sim.tool_orientation, [1, 0, 0, 0])
        np.testing.assert_array_equal(sim.force, 0.0)

    def test_a_hand_of_ones_own_needs_no_motion(self):
        with open(BALL, encoding="utf-8") as file:
            scene = json.load(file)
        del scene["trace"]
        scenario = argil.Scenario(scene, folder=os.path.dirname(BALL), set=SET)
        with self.assertRaisesRegex(argil.InputError, "/trace/file: is missing; add it, or give the position"):
            scenario.start()
        with self.assertRaisesRegex(argil.InputError, "/trace/file: is missing; add it, or move the tool tick by tick"):
            scenario.run(self.file("a.h5"))
        start = self.position[0] + [0, 0, 0.03]
        sim = scenario.start(position=start, record=self.file("own.h5"))
        with self.assertRaisesRegex(argil.InputError, "/trace/file: is missing; give the hand's position"):
            sim.tick()
        sim.run(5, hand=lambda at, force: start)
        sim.close()
        with argil.open(self.file("own.h5")) as result:
            self.assertEqual((result.outcome, len(result.time)), ("done", 5))
        # a simulated hand has nothing to mean without a motion, and one's own is no simulated one
        argil.Scenario(scene, folder=os.path.dirname(BALL), set={"/hand/kind": "simulated"}).start(position=start).tick(start)
        again = argil.Scenario(scenario.resolved, folder=os.path.dirname(BALL))
        again.start(position=start).tick(start)

    def test_a_motion_that_is_left_early_leaves_an_interrupted_record(self):
        with argil.load(BALL, set=SET).start(record=self.file("a.h5")) as sim:
            sim.run(50)
        with argil.open(self.file("a.h5")) as result:
            self.assertEqual((result.outcome, len(result.time)), ("interrupted", 50))
            np.testing.assert_array_equal(result.force, self.haptic["force"][:50])
        with self.assertRaisesRegex(argil.InputError, "comes after the record's end"):
            sim.tick()


class Refusals(Folder):
    def expect(self, words, function, *arguments, **options):
        with self.assertRaises(argil.InputError) as caught:
            function(*arguments, **options)
        self.assertIn(words, str(caught.exception))
        self.assertIsInstance(caught.exception, ValueError)

    def test_a_key_that_is_not_known_is_named_with_its_place_and_the_nearest(self):
        self.expect(f'{BALL}: /material/youngs_modulus: is not a known key; did you mean "youngs_modulus_Pa"?',
                    argil.load, BALL, set={"/material/youngs_modulus": 1e5})

    def test_values_are_checked_as_the_program_checks_them(self):
        for pointer, value in (("/material/poissons_ratio", 0.7), ("/material/poissons_ratio", float("nan")),
                               ("/tool/mode", "press"), ("/body/fixed/0/normal", np.zeros(3))):
            self.expect(f"{BALL}: {pointer}", argil.load, BALL, set={pointer: value})

    def test_a_dict_is_named_by_its_folder(self):
        self.expect("nowhere/scenario: /body: is missing", argil.Scenario, {"about": "nothing"}, folder="nowhere")

    def test_files_that_are_not_there(self):
        self.expect("none.json: does not exist", argil.load, "none.json")
        self.expect("none.csv: does not exist", argil.load, BALL, trace="none.csv")
        self.expect("none.json: does not exist", argil.load, BALL, patches=["none.json"])

    def test_results_in_the_place_of_inputs_and_folders_that_are_not_there(self):
        self.expect("is the scenario and would be overwritten", argil.run, BALL, BALL)
        with self.assertRaises(argil.IoError) as caught:
            argil.run(BALL, self.file("none/out.h5"))
        self.assertIsInstance(caught.exception, OSError)

    def test_hands_that_are_nowhere(self):
        sim = argil.load(BALL).start()
        self.expect("tick 1: the hand's position (nan, 0, 0) is not finite", sim.tick, [float("nan"), 0, 0])
        self.expect("no unit quaternion", sim.tick, [0, 0, 0.06], [0, 0, 0, 2])
        self.expect("has the shape (2,); give 3 numbers", sim.tick, [0, 0])
        self.expect('the hand\'s mode is "wet", but /tool/mode is "push"', sim.tick, [0, 0, 0.06], mode="wet")
        self.expect("press: is no mode of a tool", sim.tick, [0, 0, 0.06], mode="press")
        self.assertEqual(sim.ticks, 0)

    def test_a_hand_that_returns_nothing(self):
        sim = argil.load(BALL).start()
        self.expect("the hand returned None; return a position", sim.run, 5, hand=lambda at, force: None)
        self.assertEqual(sim.ticks, 0)

    def test_settings_that_are_none(self):
        self.expect("set: is a list; give a dict", argil.load, BALL, set=["/tool/mode=push"])
        self.expect('set: "youngs_modulus_Pa" is no JSON pointer', argil.load, BALL, set={"youngs_modulus_Pa": 2e4})

    def test_a_run_has_one_hand_and_the_motion_an_end(self):
        sim = argil.load(BALL).start()
        sim.run()
        self.expect("the scenario's motion has 84 ticks", sim.tick)
        self.expect("the hand has followed the scenario's motion so far", sim.tick, [0, 0, 0.06])

    def test_numbers_of_threads(self):
        self.expect("threads: 0 is outside [1, 256]", argil.load(BALL).start, threads=0)
        self.expect("threads: 257 is outside [1, 256]", argil.run, BALL, self.file("a.h5"), threads=257)


class Failures(Folder):
    def setUp(self):
        super().setUp()
        # The tool goes through the ball: some tet is crushed below nine tenths of its volume.
        self.scene = argil.load(BALL, set={"/dynamics/min_volume_ratio": 0.9, "/dynamics/strict": True})

    def test_a_run_that_fails_says_where(self):
        with self.assertRaises(argil.RunFailed) as caught:
            self.scene.run(self.file("a.h5"))
        said = call("run", BALL, "--strict", "--set", "/dynamics/min_volume_ratio=0.9", "-o", self.file("b.h5"), "--quiet", code=3)
        self.assertEqual(f"argil: {caught.exception}\n", said)
        self.assertEqual((caught.exception.stage, caught.exception.bound), ("solid", 0.9))
        with argil.open(self.file("a.h5")) as result:
            self.assertEqual((result.outcome, len(result.time)), ("failed", caught.exception.tick - 1))
        self.assertEqual(argil.compare(self.file("a.h5"), self.file("b.h5")), "")

    def test_a_tick_that_fails_leaves_all_as_it_was(self):
        sim = self.scene.start()
        with self.assertRaises(argil.RunFailed) as caught:
            sim.run()
        self.assertEqual(sim.ticks, caught.exception.tick - 1)
        before = sim.state_hash
        with self.assertRaises(argil.RunFailed):
            sim.tick()
        self.assertEqual(sim.state_hash, before)

    def test_what_a_hand_raises_comes_out_and_the_record_is_interrupted(self):
        class Tired(Exception):
            pass

        def hand(at, _):
            if at > 0.0105:
                raise Tired("of pressing")
            return [0.001, 0.0007, 0.0525]

        with self.assertRaisesRegex(Tired, "of pressing"):
            with argil.load(BALL).start(record=self.file("a.h5")) as sim:
                sim.run(84, hand=hand)
        with argil.open(self.file("a.h5")) as result:
            self.assertEqual((result.outcome, len(result.time)), ("interrupted", 10))


class Manners(Folder):
    def write_motion_beside_the_ball(self):
        """20 000 ticks, quick to compute."""
        away = self.folder / "away.csv"
        away.write_text("t,x,y,z\n" + "".join(f"{k / 10},0.1,0,{0.1 + 1e-4 * (k % 2)}\n" for k in range(201)))
        return away

    def test_other_threads_go_on_while_one_runs(self):
        scene = argil.load(BALL, trace=self.write_motion_beside_the_ball())
        stamps, done = [], threading.Event()

        def count():
            while not done.wait(1e-3):
                stamps.append(time.monotonic())

        thread = threading.Thread(target=count)
        thread.start()
        start = time.monotonic()
        scene.run(self.file("a.h5"))
        end = time.monotonic()
        done.set()
        thread.join()
        within = [start, *(stamp for stamp in stamps if start < stamp < end), end]
        self.assertLess(max(np.diff(within)), 0.8 * (end - start))

    def test_a_second_thread_is_kept_out_of_a_tick(self):
        sim = argil.load(BALL).start()
        thread = threading.Thread(target=sim.run)
        refused = 0
        thread.start()
        while thread.is_alive():
            try:
                sim.time  # pylint: disable=pointless-statement
            except RuntimeError as error:
                self.assertEqual(str(error), "this simulation is in use by another thread")
                refused += 1
        thread.join()
        self.assertGreater(refused, 0)
        self.assertEqual(sim.ticks, 84)

    def test_ctrl_c_ends_a_run_with_a_file_that_goes_on(self):
        away = self.write_motion_beside_the_ball()
        script = self.folder / "press.py"
        script.write_text(f"""import sys, time
sys.path.insert(0, {PACKAGE!r})
import argil
scene = argil.load({str(BALL)!r}, trace={str(away)!r})
try:
    scene.run({self.file("a.h5")!r})
except KeyboardInterrupt:
    try:
        print("interrupted", flush=True)
        time.sleep(60)
    except KeyboardInterrupt:
        print("as before", flush=True)
""")
        with subprocess.Popen(["/usr/bin/python3", script], stdout=subprocess.PIPE, text=True) as process:
            end = time.monotonic() + 60
            while not (self.folder / "a.h5").exists() and time.monotonic() < end:
                time.sleep(0.002)
            process.send_signal(signal.SIGINT)
            self.assertEqual(process.stdout.readline(), "interrupted\n")
            process.send_signal(signal.SIGINT)
            self.assertEqual(process.stdout.readline(), "as before\n")
        with argil.open(self.file("a.h5")) as result:
            self.assertEqual(result.outcome, "interrupted")
            self.assertLess(len(result.time), 20000)
        with argil.run(BALL, self.file("a.h5"), trace=away, resume=True) as result:
            self.assertEqual((result.outcome, len(result.time)), ("done", 20000))

    def test_resolved_schema_and_reference_are_the_programs(self):
        scene = argil.load(BALL)
        self.assertEqual(scene.resolved, json.loads(call("show", BALL)))
        self.assertEqual(argil.Scenario(scene.resolved).resolved, scene.resolved)
        self.assertEqual(argil.schema(), json.loads(call("schema")))
        self.assertEqual(argil.reference(), call("schema", "--reference"))
        self.assertEqual(argil.build(), call("--version").rstrip("\n") + "\n")
        self.assertEqual(scene.resolved["material"]["youngs_modulus_Pa"], 1e5)
        self.assertEqual(argil.load(BALL, set={"/material/youngs_modulus_Pa": np.float64(5e4)}).resolved["material"]
                         ["youngs_modulus_Pa"], 5e4)

    def test_patches_stand_below_the_settings(self):
        patch = self.folder / "patch.json"
        patch.write_text(json.dumps({"material": {"youngs_modulus_Pa": 3e4, "poissons_ratio": 0.2}}))
        material = argil.load(BALL, patches=[patch], set={"/material/poissons_ratio": 0.1}).resolved["material"]
        self.assertEqual((material["youngs_modulus_Pa"], material["poissons_ratio"]), (3e4, 0.1))
        self.assertEqual(argil.load(BALL, patches=str(patch)).resolved["material"]["poissons_ratio"], 0.2)  # one needs no list

    def test_a_motion_that_misses_is_noted(self):
        sim = argil.load(BALL, set={"/trace/device_to_world/translation_m": [0, 0, 0.05]}).start()
        self.assertTrue(any("never comes nearer than 0.0464 m" in note for note in sim.notes), sim.notes)

    def test_a_static_scenario_has_no_ticks(self):
        with self.assertRaisesRegex(argil.InputError, '/dynamics/mode: "static" has no ticks to step'):
            argil.load(BALL, set={"/dynamics/mode": "static"}).start()

    def test_everything_public_has_a_word_about_it(self):
        for name in argil.__all__:
            self.assertTrue(getattr(argil, name).__doc__, name)
            self.assertIn(name, dir(argil))
        for kind in (argil.Scenario, argil.Simulation, argil.Result, argil.Frame):
            for name in (name for name in dir(kind) if not name.startswith("_")):
                self.assertTrue(getattr(kind, name).__doc__, f"{kind.__name__}.{name}")


if __name__ == "__main__":
    unittest.main()
