#!/usr/bin/python3
"""Steps in a second while a tool pushes, pulls, wets and dries the paper's three kinds of body.

Usage: paper_rates.py ARGIL [-o TABLE.csv] [--tets 5000]. Each run is 0.4 s of contact at one place, solid and water once
a tick of 1 ms; the rate is ticks over seconds of processor time, of the ticks alone, and `wall_share` what share of it the
clock on the wall saw, at the worst of the four. Best of three runs unless said otherwise.
"""
import argparse
import csv
import json
import subprocess
import tempfile
from pathlib import Path

import argil_plot as ap
import make_traces
import provenance
from argil_plot import np

ROOT = Path(__file__).resolve().parent.parent
TOOL_RADIUS = 0.008  # [m]
BODIES = {"dinosaur": make_traces.HAUNCH, "figure": make_traces.BELLY, "sphere": None, "cylinder": None}  # None: the top
DEPTH = {"push": 2.5, "pull": 0.5, "wet": 0.5, "dry": 0.5}  # [mm]


def scenario(body, trace, mode, tets):
    """study_soft_dino with another body, fixed at its foot."""
    scene = json.loads((ROOT / "scenarios/study_soft_dino.json").read_text())
    scene["about"] = "rate of one kind of step"
    scene["body"] = {"shape": {"kind": body, "size_m": 0.2 if body in ("dinosaur", "figure") else 0.1,
                               "target_tets": tets, "skin_triangles": 20000},
                     "fixed": [{"kind": "half_space", "normal": [0, 0, 1], "offset_m": 0.02}]}
    stiffness = 5 if mode == "pull" else 15  # [N/m] a pair; a pull feeds itself where the contact is not the softer one
    scene["contact"] = {"law": "pairs", "vertex_face_stiffness_N_per_m": stiffness, "edge_edge_stiffness_N_per_m": stiffness}
    scene["tool"]["mode"] = mode
    scene["haptics"] = {"physics_period_ticks": 1, "water_period_ticks": 1, "frame_period_ticks": 400}
    scene["trace"] = trace
    return scene


def run(argil, scene, folder):
    file = Path(folder, "scene.json")
    file.write_text(json.dumps(scene))
    subprocess.run([argil, "run", file, "-o", Path(folder, "out.h5"), "--quiet", "--threads", "1"], check=True)
    return ap.open_result(Path(folder, "out.h5"))


def find_place(argil, body, tets, folder):
    """Where the body is touched, and its number of tets."""
    far = {"file": str(ROOT / "traces/press_flank.csv"), "duration_s": 0.002}
    with run(argil, scenario(body, far, "push", tets), folder) as result:
        points = result["mesh/rest_position"][:]
        count = len(result["mesh/tets"])
    top = points[np.argmax(points[:, 2] - 1e-3 * np.linalg.norm(points[:, :2], axis=1))]
    return BODIES[body] or make_traces.Place(tuple(1e3 * top), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0), 1e3 * TOOL_RADIUS), count


def measure(argil, body, mode, tets, folder, place, repeats):
    """Ticks in a second of processor time and of the wall clock, and the number of nodes that were solved for."""
    place = place._replace(is_smooth=True)
    strokes = [make_traces.Stroke(mode, 0.2, 3.0, 0.0, 0.0), make_traces.Stroke(mode, 0.1, -DEPTH[mode], 0.0, 0.0),
               make_traces.Stroke(mode, 0.3, -DEPTH[mode], 4.0, 0.0)]
    trace = Path(folder, "trace.csv")
    trace.write_text(make_traces.make_trace(place, [], strokes))
    best, best_of_wall, active = 0.0, 0.0, 0
    for _ in range(repeats):
        with run(argil, scenario(body, {"file": str(trace), "start_s": 0.2}, mode, tets), folder) as result:
            best = max(best, len(result["haptic/time"]) / result["timing/cpu"][-1])
            best_of_wall = max(best_of_wall, result["timing/tick_rate_Hz"][-1])
            active = max(active, int(result["physics/active_nodes"][:].max()))
    return best, best_of_wall, active


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("argil")
    parser.add_argument("-o", "--output", default="rates.csv", metavar="TABLE.csv")
    parser.add_argument("--tets", type=int, default=5000)
    parser.add_argument("--repeats", type=int, default=3)
    options = parser.parse_args()
    about = provenance.describe()  # before the table is written, which may be one of the project's
    with open(options.output, "w", newline="", encoding="utf-8") as file, tempfile.TemporaryDirectory() as folder:
        file.write(f"# {about}, one thread; ticks in a second of processor time, best of {options.repeats}\n")
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["body", "tets", *(f"{mode}_Hz" for mode in DEPTH), "nodes_solved_in_push", "wall_share"])
        for body in BODIES:
            place, count = find_place(options.argil, body, options.tets, folder)
            figures = [measure(options.argil, body, mode, options.tets, folder, place, options.repeats)
                       for mode in DEPTH]
            share = min(wall / rate for rate, wall, _ in figures)
            table.writerow([body, count, *(f"{rate:.0f}" for rate, _, _ in figures), figures[0][2], f"{share:.2f}"])
    print(options.output)


if __name__ == "__main__":
    main()
