#!/usr/bin/python3
"""`argil export` as a user meets it: pages opened by Chromium without a window.

Usage: test_export.py ARGIL. Exit code 77 (skipped) without h5py, Chromium or a built viewer. The expected numbers come
from the result file through h5py, and every page may ask for nothing but itself and must leave the console empty.
Set ARGIL_SCREENSHOTS to a folder to keep what was seen.
"""
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "tests/support"))
try:
    import h5py
    import numpy as np
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)
from browser import Browser

ARGIL = None
RESULT = None  # of a ball with a skin that is pressed, 13 frames
# How many pixels of the scene are not as its background; and a number that changes with any of them.
PIXELS = """(() => {
  const seen = document.querySelector('#scene canvas');
  const copy = Object.assign(document.createElement('canvas'), {width: seen.width, height: seen.height});
  const pen = copy.getContext('2d');
  pen.drawImage(seen, 0, 0);
  const bytes = pen.getImageData(0, 0, copy.width, copy.height).data;
  let count = 0, hash = 7;
  for (let i = 0; i < bytes.length; i += 4) {
    if (bytes[i] !== bytes[0] || bytes[i + 1] !== bytes[1] || bytes[i + 2] !== bytes[2]) ++count;
    hash = (hash * 31 + bytes[i] + 256 * bytes[i + 1] + 65536 * bytes[i + 2]) % 4294967291;
  }
  return [count, hash];
})()"""


def press_a_ball(result, *settings):
    sets = [word for setting in ("/haptics/frame_period_ticks=7", *settings) for word in ("--set", setting)]
    subprocess.run([ARGIL, "run", str(ROOT / "tests/golden/ball.json"), "-o", result, "--quiet", *sets], check=True)


def export(*arguments, program=None):
    return subprocess.run([program or ARGIL, "export", *map(str, arguments)], capture_output=True, text=True)


def frames_of(result):
    """Groups of the frames in the order of time."""
    return [result["frames"][name] for name in sorted(result["frames"])]


class Folder(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory(prefix="argil_export_")
        self.addCleanup(self.folder.cleanup)

    def path(self, name):
        return Path(self.folder.name) / name


class Pages(Folder):
    """What a browser makes of a page."""

    @classmethod
    def setUpClass(cls):
        if not (Path(ARGIL).resolve().parents[1] / "share/argil/viewer.html").exists():
            raise unittest.SkipTest("the viewer was not built (needs node and npm)")
        if not Browser.find():
            raise unittest.SkipTest("needs chromium")
        cls.browser = Browser()

    @classmethod
    def tearDownClass(cls):
        cls.browser.__exit__()

    def open(self, *options, result=None):
        page = self.path("a page & more.html")
        done = export(result or RESULT, "--html", page, *options)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.browser.complaints.clear()
        self.browser.requests.clear()
        self.browser.open(page)
        self.browser.wait_for("document.body.dataset.frame !== undefined")
        return done.stdout

    def frame(self):
        return int(self.browser.evaluate("document.body.dataset.frame"))

    def tearDown(self):
        if folder := os.environ.get("ARGIL_SCREENSHOTS"):
            Path(folder, f"{self._testMethodName}.png").write_bytes(self.browser.screenshot())
        self.assertEqual(self.browser.complaints, [])
        self.assertEqual([url for url in self.browser.requests if not url.startswith(("file://", "data:"))], [])
        self.assertEqual(len([url for url in self.browser.requests if url.startswith("file://")]), 1)
        super().tearDown()

    def positions(self):
        return np.array(self.browser.evaluate("Array.from(argil.view.positions)")).reshape(-1, 3)

    def test_each_frame_shows_the_files_skin_force_and_saturation(self):
        self.open()
        with h5py.File(RESULT) as result:
            frames = frames_of(result)
            grid = max(np.ptp(np.concatenate([f["skin_position"][:] for f in frames]), axis=0)) / 65535
            for number, frame in enumerate(frames):
                self.browser.evaluate(f"argil.show({number})")
                self.assertLess(np.abs(self.positions() - frame["skin_position"][:]).max(), 0.51 * grid + 1e-7)
                row = np.searchsorted(result["haptic/tick"][:], frame.attrs["tick"])
                force = np.linalg.norm(result["haptic/force"][min(row, len(result["haptic/tick"]) - 1)])
                seen = re.search(r"force ([\d.]+) N", self.browser.evaluate("readout.textContent"))
                self.assertAlmostEqual(float(seen[1]), force, delta=0.00051)

    def test_the_whole_path_is_drawn_faintly(self):
        self.open()
        path = np.array(self.browser.evaluate("Array.from(argil.view.path.geometry.attributes.position.array)")).reshape(-1, 3)
        with h5py.File(RESULT) as result:
            np.testing.assert_allclose(path, result["haptic/tool_position"][:], rtol=1e-6, atol=1e-9)
        self.assertLess(self.browser.evaluate("argil.view.path.material.opacity"), 0.5)
        with_path = self.browser.evaluate(PIXELS)[1]
        self.browser.evaluate("argil.view.path.material.opacity = 0; argil.view.draw()")
        self.assertNotEqual(self.browser.evaluate(PIXELS)[1], with_path)

    def test_it_opens_at_the_largest_force_and_plays_from_the_start(self):
        self.open()
        forces = self.browser.evaluate("argil.result.frames.map((frame) => Math.hypot(...frame.force_N))")
        self.assertGreater(int(np.argmax(forces)), 0)
        self.assertEqual(self.frame(), int(np.argmax(forces)))
        self.assertEqual(self.browser.evaluate("(argil.play(), argil.playingSince.time)"), 0.0)
        self.browser.evaluate("argil.pause(), argil.show(3), argil.play()")
        self.assertGreater(self.browser.evaluate("argil.playingSince.time"), 0.0)  # from then on where it stands

    def test_no_number_lies_on_a_title_and_the_legend_is_beside_the_scene(self):
        self.open()
        for peak in (9e-4, 0.0102, 1234.0):
            self.browser.evaluate(f"argil.plot.top = {peak}; argil.plot.left = argil.plot.findLeft(); argil.plot.resize()")
            widest = self.browser.evaluate("""(() => {
              const pen = plot.getContext('2d');
              pen.font = '12px "DejaVu Sans", system-ui, sans-serif';
              return Math.max(...[0.25, 0.5, 0.75, 1].map((part) => pen.measureText(`${+(part * argil.plot.top).toPrecision(1)}`).width));
            })()""")
            self.assertGreater(self.browser.evaluate("argil.plot.left") - 6 - widest, 18)  # the title's right side
        for width in (1280, 420):
            self.browser.call("Emulation.setDeviceMetricsOverride", width=width, height=800, deviceScaleFactor=1, mobile=False)
            self.browser.wait_for(f"innerWidth === {width}")
            scene, bar = (self.browser.evaluate(f"(({{left, right}}) => [left, right])(document.getElementById('{name}')"
                                                ".getBoundingClientRect())") for name in ("scene", "legend-bar"))
            self.assertLess(scene[1], bar[0])
        self.browser.call("Emulation.clearDeviceMetricsOverride")

    def test_a_click_on_the_slider_changes_frame_and_picture(self):
        self.open()
        last = int(self.browser.evaluate("slider.max"))
        self.assertGreater(last, 1)
        count, first_hash = self.browser.evaluate(PIXELS)
        self.assertGreater(count, 5000)
        self.browser.click("#slider", across=0.99)
        self.assertEqual(self.frame(), last)
        self.assertNotEqual(self.browser.evaluate(PIXELS)[1], first_hash)

    def test_a_click_on_the_force_goes_to_its_time(self):
        self.open()
        self.browser.click("#plot", across=0.5)
        with h5py.File(RESULT) as result:
            times = [frame.attrs["time"] for frame in frames_of(result)]
            middle = self.browser.evaluate("argil.plot.timeAt(plot.clientWidth / 2)")
            self.assertAlmostEqual(middle, result["haptic/time"][-1] / 2, delta=0.03 * result["haptic/time"][-1])
        self.assertEqual(self.frame(), np.searchsorted(times, middle, side="right") - 1)

    def test_play_goes_on_to_the_last_frame_and_stops(self):
        self.open()
        self.browser.evaluate("speed.value = '4', speed.dispatchEvent(new Event('change'))")
        self.browser.click("#play")
        self.browser.wait_for("document.body.dataset.frame === slider.max")
        self.browser.wait_for("document.getElementById('play').getAttribute('aria-label') === 'play'")

    def test_every_field_has_its_legend_with_a_unit(self):
        self.open()
        self.browser.evaluate("argil.show(Number(slider.max))")
        seen = {}
        for name in self.browser.evaluate("Array.from(field.options, (option) => option.value)"):
            self.browser.evaluate(f"field.value = '{name}', field.dispatchEvent(new Event('change'))")
            seen[name] = self.browser.evaluate("document.getElementById('legend-title').textContent")
        self.assertEqual(seen["saturation"], "saturation S [–]")
        self.assertEqual(seen["displacement"], "displacement [mm]")
        with h5py.File(RESULT) as result:
            frames = frames_of(result)
            moved = [np.linalg.norm(f["skin_position"][:] - frames[0]["skin_position"][:], axis=1).max() for f in frames]
        self.browser.evaluate("field.value = 'displacement', field.dispatchEvent(new Event('change'))")
        top = float(self.browser.evaluate("document.querySelector('#legend-ticks li').textContent"))
        self.assertAlmostEqual(top, 1e3 * max(moved), delta=0.01 * 1e3 * max(moved))

    def test_a_result_that_does_not_fit_shows_fewer_frames_and_says_so(self):
        with h5py.File(RESULT) as result:
            count = len(result["frames"])
        said = self.open("--megabytes", "0.001")
        self.assertIn(f"Decimated in time: shows 2 of {count} frames", said)
        self.assertIn(f"shows 2 of {count} frames", self.browser.evaluate("notes.textContent"))
        self.assertEqual(self.browser.evaluate("slider.max"), "1")

    def test_a_result_of_100_MB_becomes_a_page_that_can_be_sent(self):
        big = self.path("big.h5")
        press_a_ball(big, "/body/shape/skin_triangles=80000", "/haptics/frame_period_ticks=1")
        with h5py.File(big) as result:  # as frames give it; stored it is smaller
            self.assertGreater(sum(data.nbytes for frame in frames_of(result) for data in frame.values()), 100e6)
        self.assertIn("Decimated in time", self.open(result=big))
        self.assertLess(self.path("a page & more.html").stat().st_size, 10e6)
        self.browser.click("#slider", across=0.99)
        self.assertEqual(self.frame(), int(self.browser.evaluate("slider.max")))
        self.assertGreater(self.browser.evaluate(PIXELS)[0], 5000)

    def test_body_tool_and_arrow_are_in_the_picture_whatever_its_aspect(self):
        self.open("--cage")
        for width, height in ((1280, 900), (480, 900), (1600, 500)):
            self.browser.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1,
                              mobile=False)
            self.browser.wait_for(f"innerWidth === {width} && argil.view.renderer.domElement.width <= {width} && "
                                  "Math.abs(argil.view.camera.aspect - scene.clientWidth / scene.clientHeight) < 0.01")
            farthest = """(() => {
              const {view, result} = argil, {body, tool, arrow} = view;
              let most = 0;
              for (let number = 0; number < result.frames.length; ++number) {
                argil.show(number);
                view.scene.updateMatrixWorld();
                for (const mesh of [body, tool, ...(arrow.visible ? arrow.children : [])]) {
                  const {array} = mesh.geometry.attributes.position;
                  for (let i = 0; i < array.length; i += 3) {
                    const at = view.target.clone().fromArray(array, i).applyMatrix4(mesh.matrixWorld).project(view.camera);
                    most = Math.max(most, Math.abs(at.x), Math.abs(at.y));
                  }
                }
              }
              return most;
            })()"""
            self.assertLess(self.browser.evaluate(farthest), 1.0)
            fitted = """Math.max(...argil.view.points.flatMap((point) => {
              const at = point.clone().project(argil.view.camera);
              return [Math.abs(at.x), Math.abs(at.y)];
            }))"""
            self.assertAlmostEqual(self.browser.evaluate(fitted), 1 / 1.06, delta=0.01)  # no farther away than that needs
        self.browser.call("Emulation.clearDeviceMetricsOverride")

    def test_an_arrow_that_would_go_into_the_body_ends_at_the_hand(self):
        pulled = self.path("pulled.h5")
        press_a_ball(pulled, "/tool/mode=pull", "/contact/grip_strength_Pa=1e5")
        self.open("--cage", result=pulled)
        ends = self.browser.evaluate("""argil.result.frames.map((frame, number) => {
          argil.show(number);
          const {arrow, tool} = argil.view;
          arrow.updateMatrixWorld();
          const [tail, tip] = [0, 1].map((y) => arrow.localToWorld(argil.view.target.clone().set(0, y, 0)).distanceTo(tool.position));
          return arrow.visible ? [tail, tip] : null;
        })""")
        with h5py.File(pulled) as result:
            middle = result["mesh/rest_position"][:].mean(axis=0)
            inward = 0
            for frame, end in zip(self.browser.evaluate("argil.result.frames"), ends, strict=True):
                if end is None:
                    continue
                is_inward = int(np.dot(frame["force_N"], np.array(frame["tool_position_m"]) - middle) < 0)
                inward += is_inward
                self.assertAlmostEqual(end[is_inward], 0.0, delta=1e-6)
                self.assertGreater(end[not is_inward], 1e-4)
            self.assertTrue(0 < inward < len(ends))

    def test_the_axis_that_is_chosen_points_up(self):
        self.open("--cage")
        self.assertEqual(self.browser.evaluate("document.getElementById('up').value"), "z")
        seen = []
        for name, axis in (("y", (0, 1, 0)), ("x", (1, 0, 0)), ("z", (0, 0, 1))):
            self.browser.evaluate(f"document.getElementById('up').value = '{name}', "
                                  "document.getElementById('up').dispatchEvent(new Event('change'))")
            right, up = self.browser.evaluate(f"""(() => {{
              const {{target, camera}} = argil.view;
              const tip = target.clone();
              tip.set({",".join(map(str, axis))}).multiplyScalar(0.01).add(target).project(camera);
              return [tip.x, tip.y];
            }})()""")
            self.assertAlmostEqual(right, 0.0, delta=1e-6)
            self.assertGreater(up, 0.01)
            seen.append(self.browser.evaluate(PIXELS)[1])
        self.assertEqual(len(set(seen)), 3)

    def test_a_body_that_is_held_at_its_foot_in_y_stands_on_it(self):
        standing = self.path("standing.h5")
        shutil.copy(RESULT, standing)
        with h5py.File(standing, "r+") as result:  # turned about x: y is what was z, z is what was -y
            turned = [result["mesh/rest_position"], *(frame["position"] for frame in frames_of(result))]
            values = [data[:] for data in turned]  # all before any is written: equal ones may be one
            for data, (x, y, z) in zip(turned, (value.T for value in values)):
                data[:] = np.stack([x, z, -y], axis=1)
        self.open("--cage", result=standing)
        self.assertEqual(self.browser.evaluate("document.getElementById('up').value"), "y")

    def test_a_result_without_a_frame_at_rest_shows_how_far_it_moved(self):
        with h5py.File(RESULT) as result, h5py.File(self.path("static.h5"), "w") as static:
            for name in ("mesh", "haptic", "physics", "provenance", "timing"):
                result.copy(name, static)
            static.attrs.update(result.attrs)
            result.copy(frames_of(result)[-1], static.create_group("frames"), "000000")
            moved = (result["mesh/rest_position"][:] - frames_of(result)[-1]["position"][:])[
                np.unique(result["mesh/surface_triangles"][:])]
        self.open("--cage", result=self.path("static.h5"))
        self.browser.evaluate("field.value = 'displacement', field.dispatchEvent(new Event('change'))")
        top = float(self.browser.evaluate("document.querySelector('#legend-ticks li').textContent"))
        self.assertAlmostEqual(top, 1e3 * np.linalg.norm(moved, axis=1).max(), delta=0.01 * top)

    def test_the_cage_is_shown_on_request(self):
        self.open("--cage")
        with h5py.File(RESULT) as result:
            self.assertEqual(len(self.positions()), len(np.unique(result["mesh/surface_triangles"][:])))


class Refusals(Folder):
    def test_a_program_without_its_viewer_says_how_to_build_it(self):
        os.mkdir(self.path("bin"))
        alone = shutil.copy(ARGIL, self.path("bin/argil"))
        done = export(RESULT, "--html", self.path("page.html"), program=alone)
        self.assertEqual(done.returncode, 2)
        self.assertIn("the viewer was not built", done.stderr)
        self.assertIn("scripts/build_viewer", done.stderr)
        self.assertFalse(self.path("page.html").exists())

    def test_a_page_never_replaces_its_result(self):
        result = shutil.copy(RESULT, self.path("run.h5"))
        done = export(result, "--html", result)
        self.assertEqual(done.returncode, 2)
        self.assertIn("would be overwritten; give another name to --html", done.stderr)

    def test_a_series_lists_every_frame(self):
        self.assertEqual(export(RESULT, "--vtu", self.path("ball.pvd")).returncode, 0)
        with h5py.File(RESULT) as result:
            self.assertEqual(len(list(self.path("ball").glob("cage_*.vtu"))), len(result["frames"]))

    def test_one_form_must_be_chosen(self):
        self.assertEqual(export(RESULT).returncode, 2)


if __name__ == "__main__":
    ARGIL = os.path.abspath(sys.argv.pop(1))
    with tempfile.TemporaryDirectory(prefix="argil_export_") as results:
        RESULT = os.path.join(results, "ball.h5")
        press_a_ball(RESULT)
        unittest.main()
