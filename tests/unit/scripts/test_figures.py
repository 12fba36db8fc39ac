#!/usr/bin/python3
"""The figures show what the result file holds: a cube of six tets, pressed and wetted by a small tool, in a file made
here by h5py. Expected values: the numbers put in. Skipped where numpy, h5py, matplotlib or VTK are absent."""
import importlib.util
import json
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SCRIPTS = Path(__file__).resolve().parents[3] / "scripts"
MISSING = [name for name in ("numpy", "h5py", "matplotlib") if importlib.util.find_spec(name) is None]
if not MISSING:
    sys.path.insert(0, str(SCRIPTS))
    sys.dont_write_bytecode = True
    import argil_plot
    import h5py
    import matplotlib.image
    import numpy as np
    import paper_sculpt
    import plot_give
    import render
    import render_shots
    import render_vtk
    import summarise
    from argil.plot import energy_figure, force_figure, water_figure

PUSH, WET = 0, 2


def write_result(file, saturation, leak=0.0, touch=True):
    """200 ticks: wet for 50, away for 50, push for 50 with 2 N at tick 120, away; wetting is felt stronger. Frames every 20
    ticks. `leak` [kg] is missing from the ledger at the end."""
    tick = np.arange(200)
    corner = np.array([[i, j, k] for i in (0, 1) for j in (0, 1) for k in (0, 1)], dtype=float)
    tets = np.array([(0, 4, 6, 7), (0, 6, 2, 7), (0, 2, 3, 7), (0, 3, 1, 7), (0, 1, 5, 7), (0, 5, 4, 7)])
    sides = np.array([(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1), (2, 3, 7), (2, 7, 6), (0, 2, 6),
                      (0, 6, 4), (1, 5, 7), (1, 7, 3)])
    force = np.zeros((200, 3))
    if touch:
        force[20:40, 1], force[110:140, 1], force[120, 1] = -3.0, -1.0, -2.0
    with h5py.File(file, "w") as result:
        result.attrs.update(haptic_period_s=1e-3, format="argil-result", format_version=1, complete=1, outcome="done")
        for name, data in {
                "haptic/time": 1e-3 * tick, "haptic/tool_position": np.tile([0.05, -0.02, 0.05], (200, 1)),
                "haptic/tool_orientation": np.tile([0.0, 0.0, 0.0, 1.0], (200, 1)), "haptic/force": force,
                "haptic/mode": np.where(tick < 50, WET, PUSH).astype("u1"), "physics/time": 1e-3 * tick,
                "physics/water_mass": 1e-3 + 1e-5 * tick - np.linspace(0, leak, 200),
                "physics/contact_work": 5e-4 * tick, "physics/elastic_energy": 1e-4 + 2e-4 * tick,
                "physics/plastic_dissipation": 1.5e-4 * tick, "physics/kinetic_energy": 0.5e-4 * tick,
                "haptic/port_energy": -3e-4 * (tick + 1), "physics/water_added": 2e-5 * tick, "physics/water_removed": 1e-5 * tick,
                "mesh/rest_position": 0.1 * corner, "mesh/tets": tets, "mesh/surface_triangles": sides,
                "mesh/skin_triangles": np.zeros((0, 3), int), "mesh/tool_vertices": 0.01 * corner,
                "mesh/tool_triangles": sides}.items():
            result[name] = data
        for name, words in {"build": "argil 0\ncommit abc\n", "scenario_sha256": "1", "trace_sha256": "2"}.items():
            result[f"provenance/{name}"] = words
        for number in range(10):
            frame = result.create_group(f"frames/{number:06d}")
            frame.attrs.update(tick=20 * number, time=0.02 * number)
            frame["position"] = 0.1 * corner
            frame["saturation"] = np.array([saturation * number / 9, 0, 0, 0, 0, 0])
            frame["plastic_strain_norm"] = np.full(6, 0.1)


@unittest.skipIf(MISSING, f"needs {', '.join(MISSING)}")
class Figures(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        write_result(self.file("dry.h5"), 0.0)
        write_result(self.file("wet.h5"), 0.9)

    def file(self, name):
        return str(self.folder / name)

    def draw(self, script, *arguments):
        return subprocess.run([SCRIPTS / script, *arguments], capture_output=True, text=True, cwd=self.folder)

    def expect_refusal(self, words, script, *arguments):
        run = self.draw(script, *arguments)
        self.assertEqual(run.returncode, 2)
        self.assertIn(words, run.stderr)
        self.assertNotIn("Traceback", run.stderr)

    def test_the_strongest_contact_is_that_of_the_largest_push(self):
        runs = [force_figure.read_run(self.file("dry.h5"), "dry", align_press=True)]
        self.assertEqual(runs[0].time[0], -0.05)  # the push begins at tick 50
        start, end = force_figure.find_peak(runs)
        self.assertAlmostEqual(start, 0.060)
        self.assertAlmostEqual(end, 0.089)

    def test_smoothing_is_the_mean_of_the_samples_around(self):
        mean = force_figure.moving_mean(1e-3 * np.arange(6), np.array([1.0, 2, 3, 4, 5, 9]), 0.002)
        np.testing.assert_allclose(mean, [1.5, 2, 3, 4, 6, 7])

    def test_a_run_without_contact_has_no_strongest_one(self):
        write_result(self.file("none.h5"), 0.0, touch=False)
        self.assertIsNone(force_figure.find_peak([force_figure.read_run(self.file("none.h5"), "none", False)]))
        self.assertEqual(self.draw("plot_force.py", "none.h5").returncode, 0)

    def test_the_ledger_error_is_the_missing_water(self):
        write_result(self.file("leak.h5"), 0.0, leak=1e-6)
        with h5py.File(self.file("leak.h5")) as leaking, h5py.File(self.file("wet.h5")) as tight:
            largest_number = 2e-5 * 199  # [kg] added is the largest of mass, added and removed
            self.assertAlmostEqual(water_figure.read_ledger(leaking).error()[-1], 1e-6 / largest_number, places=12)
            self.assertLess(water_figure.read_ledger(tight).error().max(), 1e-15)

    def test_the_rest_of_the_energy_is_what_is_neither_held_nor_dissipated_by_flow(self):
        run = energy_figure.read_energies(self.file("wet.h5"), "wet")
        np.testing.assert_allclose(run.rest(), (5e-4 - 2e-4 - 1.5e-4 - 0.5e-4) * np.arange(200), atol=1e-15)

    def test_the_hand_works_only_while_it_presses(self):
        run = energy_figure.read_energies(self.file("wet.h5"), "wet")
        self.assertAlmostEqual(run.hand[49], 0.0)
        self.assertAlmostEqual(run.hand[-1], 150 * 3e-4)  # the 50 ticks that wet do not count

    def test_sizes_of_energies_have_a_prefix(self):
        for energy, words in {0.0: "0 J", 2.0: "2 J", 3.4e-4: "340 µJ", 5e-14: "0.05 pJ"}.items():
            self.assertEqual(energy_figure.with_prefix(energy), words)

    def test_the_summary_holds_the_forces_and_the_water_that_were_put_in(self):
        figures = summarise.summarise(self.file("wet.h5"))
        for name, value in {"peak_N": 2.0, "impulse_N_s": 0.031, "peak_of_wetting_N": 3.0, "peak_at_s": 0.07,
                            "water_added_kg": 2e-5 * 199}.items():
            self.assertAlmostEqual(figures[name], value, places=12)

    def test_the_depth_is_that_of_the_balls_lowest_point_below_the_skin_at_rest(self):
        names = ("ball_dry.h5", "ball_wet.h5")
        for name, depth in zip(names, (0.002, 0.013)):  # of a ball of 10 mm at the side y = 0: less and more than its radius
            write_result(self.file(name), 0.9 if name == "ball_wet.h5" else 0.0)
            with h5py.File(self.file(name), "r+") as result:
                result["haptic/tool_position"][:] = [0.05, -0.01 + depth, 0.05]
                result["haptic/num_contacts"] = (np.arange(200) >= 110).astype(int) * (np.arange(200) < 140)
                result["provenance/scenario"] = json.dumps(
                    {"tool": {"shape": {"kind": "sphere", "radius_m": 0.01}}, "hand": {"kind": "prescribed", "stiffness_N_per_m": 300.0}})
            time, force, found, spring = plot_give.read_way(self.file(name))
            np.testing.assert_allclose(found[(time > 0.0595) & (time < 0.0895)], depth, atol=1e-12)
            self.assertEqual(np.isnan(found).sum(), len(found) - 3)  # nothing is said where it does not touch
            self.assertEqual((time[0], spring), (0.0, 0.0))
        run = self.draw("plot_give.py", *names, *names)
        self.assertIn("same hand: dry 0.", run.stdout)
        self.assertIn("2.00 mm; wet", run.stdout)

    def test_a_summary_keeps_the_commit_that_first_gave_its_figures(self):
        path = Path(self.file("run.json"))
        figures = {"command": "none", "runs": {"dry": {"peak_N": 2.0, "commit": "first"}}}
        summarise.write(figures, path)
        for peak, kept in ((2.0, "first"), (2.5, "second")):
            summarise.write({"command": "none", "runs": {"dry": {"peak_N": peak, "commit": "second"}}}, path)
            self.assertEqual(json.loads(path.read_text())["runs"]["dry"], {"peak_N": peak, "commit": kept})

    def test_the_split_gives_each_part_and_what_they_take_from_each_other(self):
        parts = summarise.split(10.0, 5.0, 8.0, 6.0)  # 50 % lower; alone 20 % and 40 %
        for name, value in {"lower_by": 0.5, "elasticity_alone": 0.2, "yield_alone": 0.4, "interaction": -0.1}.items():
            self.assertAlmostEqual(parts[name], value)
        run = self.draw("summarise.py", "dry.h5", "wet.h5", "dry.h5", "--command", "none")
        self.assertIn("3 files: give dry and wet", run.stderr)

    def test_the_volume_of_a_frame_is_that_of_its_cells_and_within_its_surface(self):
        with h5py.File(self.file("wet.h5"), "r+") as result:
            frame = result["frames/000003"]
            frame["position"][:, 2] = 1.1 * frame["position"][:, 2]
            self.assertAlmostEqual(paper_sculpt.volume_of(result["mesh"], frame), 1.1e-3, places=15)
            surface = result["mesh/surface_triangles"][:]
            self.assertAlmostEqual(paper_sculpt.volume_within(frame["position"][:], surface), 1.1e-3, places=15)

    def test_mean_saturation_is_weighted_by_volume(self):
        with h5py.File(self.file("wet.h5")) as result:
            saturation = water_figure.read_saturation(result)
            self.assertAlmostEqual(water_figure.rest_volumes(result["mesh"]).sum(), 1e-3)
        self.assertAlmostEqual(saturation.mean[-1], 0.9 / 6)
        self.assertAlmostEqual(saturation.largest[-1], 0.9)

    def test_moments_name_the_frames(self):
        with h5py.File(self.file("wet.h5")) as result:
            moments = ("before", "wetting", "during", "after", "0.07")
            times = [float(render_shots.find_time(result, moment)) for moment in moments]
        for found, wanted in zip(times, (0.0, 0.0295, 0.12, 0.18, 0.07)):
            self.assertAlmostEqual(found, wanted)

    def test_values_at_vertices_are_means_of_the_tets_around(self):
        with h5py.File(self.file("wet.h5")) as result:
            values = render_shots.point_values(result, result["frames/000009"], "saturation", skinned=False)
        # Vertex 4 has the wet tet and one dry, vertex 0 and 7 all six, vertex 6 the wet and one dry, the others none.
        np.testing.assert_allclose(values, [0.15, 0, 0, 0, 0.45, 0, 0.45, 0.15])

    def test_a_skin_has_the_plastic_strain_of_the_tets_around_its_vertices(self):
        with h5py.File(self.file("wet.h5"), "r+") as result:
            tets, rest = result["mesh/tets"][:], result["mesh/rest_position"][:]
            del result["mesh/skin_triangles"]
            result["mesh/skin_triangles"] = np.array([(0, 1, 2)])
            for name in result["frames"]:
                result[f"frames/{name}/skin_position"] = rest[tets[[4, 0, 3]]].mean(axis=1)  # the middles of three
            result["frames/000009/plastic_strain_norm"][...] = 0.1 * np.arange(6)
        shot = render_shots.read_shots(self.file("wet.h5"), ["after"], "plastic_strain")[0]
        np.testing.assert_allclose(shot.values, [0.4, 0.0, 0.3])
        self.assertEqual(len(shot.points), 3)

    def test_displacement_is_measured_from_rest_and_along_the_outward_normal(self):
        with h5py.File(self.file("wet.h5"), "r+") as result:
            for name in list(result["frames"])[1:]:  # one frame is left, which is not at rest: as of a static result
                del result[f"frames/{name}"]
            frame, rest = result["frames/000000"], result["mesh/rest_position"][:]
            frame["position"][...] = 0.05 + 1.2 * (rest - 0.05)  # from the middle of the cube: 10 mm along each axis
            field = render_shots.point_values(result, frame, "normal", skinned=False)
            np.testing.assert_allclose(render_shots.point_values(result, frame, "displacement", skinned=False),
                                       0.01 * np.sqrt(3.0))
            self.assertTrue((field > 0.01).all())  # outwards, and more than along a face's normal
            self.assertTrue((field <= 0.01 * np.sqrt(3.0) + 1e-15).all())

    def test_the_skin_of_a_static_result_rests_where_its_cage_does(self):
        with h5py.File(self.file("wet.h5"), "r+") as result:
            frame, rest = result["frames/000000"], result["mesh/rest_position"][:]
            frame["position"][...] = 2.0 * rest
            frame["skin_position"] = np.array([[0.05, 0.1, 0.15], [0.02, 0.02, 0.18]])
            np.testing.assert_allclose(render_shots.rest_points(result, skinned=True), 0.5 * frame["skin_position"][:])

    def test_long_names_are_broken(self):
        self.assertEqual(render.wrapped("a_very_long_name_of_a_file\n0.7 s", 10), "a_very_lon\ng_name_of_\na_file\n0.7 s")

    def test_the_arrow_of_a_force_into_the_body_ends_at_the_tool(self):
        with h5py.File(self.file("dry.h5")) as result:  # the tool is on the side y = 0 of the cube
            shot = render_shots.Shot(result, result["frames/000006"], "saturation")  # pressed: the force is away from it
        np.testing.assert_allclose(shot.force, [0.0, -2.0, 0.0])
        np.testing.assert_allclose(render_vtk.arrow_start(shot, 0.1), [0.05, -0.02, 0.05])
        shot.force = -shot.force
        np.testing.assert_allclose(render_vtk.arrow_start(shot, 0.1), [0.05, -0.12, 0.05])

    def test_a_caption_has_the_frames_own_time_and_says_where_it_is_off(self):
        moments = ["0.06", "0.065", "0.5", "during", "wetting"]  # frames: every 0.02 s up to 0.18 s; the push is strongest at 0.12 s
        shots = render_shots.read_shots(self.file("dry.h5"), moments, "saturation")
        self.assertEqual([render.caption(shot, "dry") for shot in shots], [
            "dry\n0.06 s", "dry\n0.06 s\nnearest to 0.065 s", "dry\n0.18 s\nnearest to 0.5 s", "dry\n0.12 s, 2 N",
            "dry\n0.02 s, 3 N"])
        shots[0].time = shots[0].asked = 0.15
        shots[0].force = np.array([0.0, 0.004123, 0.0])
        self.assertEqual(render.caption(shots[0], "dry"), "dry\n0.15 s, 0.00412 N")

    def test_the_path_is_that_of_the_tool(self):
        with h5py.File(self.file("dry.h5"), "r+") as result:
            result["haptic/tool_position"][:, 2] = np.linspace(0.0, 0.1, 200)
            shot = render_shots.Shot(result, result["frames/000006"], "saturation")
            np.testing.assert_array_equal(shot.path, result["haptic/tool_position"][:])

    def test_rotations_follow_the_quaternion(self):
        half = np.sqrt(0.5)
        np.testing.assert_allclose(render_shots.rotation_matrix([half, 0, 0, half]) @ [0, 0, 1], [0, -1, 0], atol=1e-15)
        # 120 degrees about the diagonal turn the axes into one another.
        np.testing.assert_allclose(render_shots.rotation_matrix([0.5, 0.5, 0.5, 0.5]) @ [1, 2, 3], [3, 1, 2], atol=1e-15)
        np.testing.assert_allclose(render_shots.rotation_matrix([0, 0, half, half]) @ [1, 2, 3], [-2, 1, 3], atol=1e-15)
        np.testing.assert_allclose(render_shots.rotation_matrix([0, half, 0, half]) @ [1, 2, 3], [3, 2, -1], atol=1e-15)

    def test_the_eye_is_on_the_touched_side_however_far_the_tool_goes(self):
        body = 0.1 * np.array([[-1.0, -1.0, 0.0], [1.0, 1.0, 2.0]])
        for side in (1.0, -1.0):
            touched, gone = np.array([[0.1 * side, 0.0, 0.1]]), np.array([[0.5 * side, 0.0, 0.1]])
            camera = render_vtk.Camera(np.concatenate([body, touched, gone]), body, touched[0], render_vtk.View())
            self.assertGreater(side * camera.direction[0], 0.5)

    def test_the_arrow_ends_inside_the_panel_also_from_closer(self):
        with h5py.File(self.file("dry.h5")) as result:
            shot = render_shots.Shot(result, result["frames/000006"], "saturation")
        points = np.concatenate([shot.points, shot.tool_points])
        for force in ([0.0, -2.0, 0.0], [0.0, 2.0, 0.0], [1.0, -1.0, 1.5], [0.0, -0.1, -2.0]):
            shot.force = np.array(force)
            size = np.linalg.norm(force)
            for zoom in (1.0, 2.0, 5.0):
                camera = render_vtk.Camera(points, shot.points, shot.tool_position, render_vtk.View(zoom=zoom))
                length = size * render_vtk.fit_arrows(camera, points, [shot], size)
                ends = shot.tool_position + np.outer([0.0, length], render_vtk.arrow_heading(shot))
                self.assertLess(np.abs(camera.project(ends)).max(), 0.95)
                self.assertGreater(length, 0.3 * camera.half_height)
                if zoom == 1.0:
                    self.assertLess(np.abs(camera.project(points)).max(), 0.95)

    def test_the_axis_that_is_asked_for_points_up(self):
        body = np.array([[-0.1, -0.1, 0.0], [0.1, 0.1, 0.2]])
        for name, axis in zip("xyz", np.eye(3)):
            camera = render_vtk.Camera(body, body, body[0], render_vtk.View(up=name))
            right, up = camera.project(camera.focus + 0.01 * axis)
            self.assertGreater(up, 0.0)
            self.assertAlmostEqual(right, 0.0)
            np.testing.assert_allclose(camera.axes @ camera.axes.T, np.eye(3), atol=1e-15)
            self.assertAlmostEqual(np.linalg.det(camera.axes), 1.0)
            following = np.roll(axis, 1)  # x after z
            for angles, towards in (((0.0, 0.0), following), ((90.0, 0.0), np.roll(axis, 2)), ((30.0, 90.0), axis)):
                camera = render_vtk.Camera(body, body, body[0], render_vtk.View(name, angles))
                np.testing.assert_allclose(camera.direction, towards, atol=1e-15)

    def test_up_is_against_gravity_or_as_the_body_is_held(self):
        def held(axis):  # at its low end, a tenth of the cube
            upper = [0.11, 0.11, 0.11]
            upper[axis] = 0.01
            return {"fixed": [{"kind": "box", "lower_m": [-0.01, -0.01, -0.01], "upper_m": upper}]}
        for body, up in (({}, "z"), (held(0), "z"), (held(1), "y"), (held(2), "z"),
                         ({"fixed": [{"kind": "half_space", "normal": [0, 2, 0], "offset_m": 0.001}]}, "y"),
                         ({**held(1), "loads": {"gravity_m_per_s2": [-9.8, 0, 0]}}, "x"),
                         ({"loads": {"gravity_m_per_s2": [0, -9.8, 0]}}, "y")):
            with h5py.File(self.file("dry.h5"), "r+") as result:
                if "scenario" in result["provenance"]:
                    del result["provenance/scenario"]
                result["provenance/scenario"] = json.dumps({"body": body})
                self.assertEqual(render_shots.find_up(result), up, body)
        self.expect_refusal("view 0 91", "render.py", "dry.h5", "--view", "0", "91")

    def test_figures_are_written_equal_when_drawn_again_and_no_word_is_cut_off_at_the_edge(self):
        for script, files in (("plot_force.py", ["dry.h5", "wet.h5", "--align-press"]), ("plot_water.py", ["wet.h5"]),
                              ("plot_energy.py", ["dry.h5", "wet.h5"])):
            for stem in ("one", "two"):
                run = self.draw(script, *files, "-o", stem)
                self.assertEqual((run.returncode, run.stderr), (0, ""))
                self.assertEqual(run.stdout, f"{stem}.png\n{stem}.pdf\n")
            for suffix in (".png", ".pdf"):
                one, two = ((self.folder / f"{stem}{suffix}").read_bytes() for stem in ("one", "two"))
                self.assertEqual(one, two)
            pixels = matplotlib.image.imread(self.file("one.png"))
            edge = np.concatenate([pixels[0], pixels[-1], pixels[:, 0], pixels[:, -1]])
            self.assertEqual(edge[:, :3].min(), 1.0, script)  # white all around

    def test_long_labels_leave_the_axes_their_width(self):
        label = "a label that tells everything there is to tell about a run of wet clay"
        runs = [force_figure.read_run(self.file(name), label + name, False) for name in ("dry.h5", "wet.h5")] * 3
        energies = [energy_figure.read_energies(self.file("dry.h5"), "dry")]
        for figure in (force_figure.draw(runs, False, 0.0), energy_figure.draw(energies)):
            self.addCleanup(argil_plot.plt.close, figure)
            figure.draw_without_rendering()
            width = sum(axes.get_window_extent().width for axes in figure.axes)
            self.assertGreater(width, 0.7 * figure.bbox.width)
            words = figure.legends[0].get_window_extent()
            self.assertLessEqual(words.width, figure.bbox.width)
            for axes in figure.axes:
                self.assertFalse(words.overlaps(axes.get_tightbbox(figure.canvas.get_renderer())))

    def test_what_has_nothing_to_show_has_no_panel(self):
        with h5py.File(self.file("dry.h5"), "r+") as result:
            result["physics/water_mass"][:] = 1e-3
            result["physics/water_added"][:] = result["physics/water_removed"][:] = 0.0
        write_result(self.file("leak.h5"), 0.0, leak=1e-6)
        for name, panels, words in (("dry.h5", 1, "No water was given"), ("wet.h5", 2, "The ledger closes to"), ("leak.h5", 3, "")):
            figure = water_figure.make_figure(self.file(name))
            self.addCleanup(argil_plot.plt.close, figure)
            self.assertEqual(len(figure.axes), panels)
            self.assertTrue(figure.axes[-1].get_title(loc="left").startswith(words))
        runs = [force_figure.read_run(self.file("wet.h5"), "wet", False)]
        self.assertIsNotNone(force_figure.find_close_up(runs, None))  # 30 ms of 200 ms
        self.assertIsNone(force_figure.find_close_up(runs, 0.15))

    def test_a_label_wider_than_its_axes_is_whole(self):
        figure, (left, right) = argil_plot.plt.subplots(1, 2, figsize=(5, 2), gridspec_kw={"width_ratios": [8, 1]})
        right.set_xlabel("a label that is much wider than its axes")
        argil_plot.save(figure, self.file("wide"))
        pixels = matplotlib.image.imread(self.file("wide.png"))
        self.assertEqual(pixels[:, -1, :3].min(), 1.0)

    def test_what_is_no_result_is_refused(self):
        self.folder.joinpath("text.h5").write_text("no HDF5")
        with h5py.File(self.file("other.h5"), "w"):
            pass
        self.expect_refusal("text.h5: is no HDF5 file", "plot_force.py", "text.h5")
        self.expect_refusal("is not a result file of argil run", "plot_water.py", "other.h5")
        self.expect_refusal("2 files but 1 labels", "plot_force.py", "dry.h5", "wet.h5", "--labels", "dry")

    @unittest.skipUnless(importlib.util.find_spec("vtk") and shutil.which("Xvfb"), "needs python3-vtk9 and xvfb")
    def test_the_picture_is_blue_where_it_is_wet(self):
        for name in ("dry", "wet"):  # one panel each: it takes seconds without a graphics card
            self.assertEqual(self.draw("render.py", f"{name}.h5", "--frames", "after", "-o", f"{name}.png").returncode, 0)

        def share_of_blue(name):
            pixels = matplotlib.image.imread(self.file(name))
            body = pixels[:, : int(0.7 * pixels.shape[1])]  # without the colour bar
            return np.mean(body[..., 2] > body[..., 0] + 0.12)

        self.assertEqual(share_of_blue("dry.png"), 0)
        self.assertGreater(share_of_blue("wet.png"), 1e-3)
        self.expect_refusal("its folder cannot be made", "render.py", "dry.h5", "-o", "dry.png/no.png")
        self.expect_refusal("moment 'soon'", "render.py", "dry.h5", "--frames", "soon")

    @unittest.skipUnless(importlib.util.find_spec("vtk") and shutil.which("Xvfb"), "needs python3-vtk9 and xvfb")
    def test_runs_at_one_moment_stand_beside_each_other(self):
        self.assertEqual(self.draw("render.py", "dry.h5", "wet.h5", "--frames", "after", "--field", "shape", "-o",
                                   "new/two.png").returncode, 0)
        height, width = matplotlib.image.imread(self.file("new/two.png")).shape[:2]
        self.assertGreater(width, 1.2 * height)

    @unittest.skipUnless(importlib.util.find_spec("vtk") and shutil.which("Xvfb") and shutil.which("ffprobe"),
                         "needs python3-vtk9, xvfb and ffmpeg")
    def test_a_movie_has_a_picture_a_frame_in_the_time_of_the_run(self):
        with h5py.File(self.file("wet.h5"), "r+") as result:
            for name in list(result["frames"])[4:]:
                del result[f"frames/{name}"]
        self.assertEqual(self.draw("render.py", "wet.h5", "--movie", "wet.mp4").returncode, 0)
        say = ["ffprobe", "-v", "error", "-show_entries", "stream=codec_name,nb_frames,duration", "-of", "csv=p=0",
               self.file("wet.mp4")]
        codec, seconds, frames = subprocess.run(say, capture_output=True, text=True, check=True).stdout.split(",")
        self.assertEqual((codec, int(frames)), ("h264", 4))
        self.assertAlmostEqual(float(seconds), 4 * 0.02, delta=1e-3)  # four frames, 20 ms apart

    @unittest.skipUnless(importlib.util.find_spec("vtk"), "needs python3-vtk9")
    def test_a_movie_without_ffmpeg_is_refused_with_the_remedy(self):
        run = subprocess.run([SCRIPTS / "render.py", "wet.h5", "--movie", "wet.mp4"], capture_output=True, text=True,
                             cwd=self.folder, env={"PATH": str(self.folder)})
        self.assertEqual(run.returncode, 2)
        self.assertIn("there is no ffmpeg (package ffmpeg); a .gif needs none", run.stderr)
        self.assertFalse(Path(self.file("wet.mp4")).exists())


if __name__ == "__main__":
    unittest.main()
