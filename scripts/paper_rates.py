#!/usr/bin/python3
"""Steps in a second while a tool pushes, pulls, wets and dries the paper's three kinds of body.

Usage: paper_rates.py ARGIL [-o TABLE.csv] [--tets 5000]. Each run is 0.4 s of contact at one place, solid and water once
a tick of 1 ms; the rate is ticks over wall-clock seconds of the loop, everything in it. Best of three runs.
"""
import argparse
import csv
import json
import platform
import subprocess
import tempfile
from pathlib import Path

import argil_plot as ap
import make_traces
from argil_plot import np

ROOT = Path(__file__).resolve().parent.parent
TOOL_RADIUS = 0.008  # [m]
BODIES = {"dinosaur": (0, -1, 0), "figure": (1, 0, 0), "sphere": (0, 0, 1), "cylinder": (0, 0, 1)}  # touched from there
DEPTH = {"push": 2.5, "pull": 0.5, "wet": 0.5, "dry": 0.5}  # [mm]
REPEATS = 3


def scenario(body, trace, mode, tets):
    """demo_dino_dry with another body on its foot and a contact that is softer than the clay, as a pull needs it."""
    scene = json.loads((ROOT / "scenarios/demo_dino_dry.json").read_text())
    scene["about"] = "rate of one kind of step"
    scene["body"] = {"shape": {"kind": body, "size_m": 0.2 if body in ("dinosaur", "figure") else 0.1,
                               "target_tets": tets, "skin_triangles": 20000},
                     "fixed": [{"kind": "half_space", "normal": [0, 0, 1], "offset_m": 0.02}]}
    scene["contact"] = {"vertex_face_stiffness_N_per_m": 15, "edge_edge_stiffness_N_per_m": 15}
    scene["tool"]["mode"] = mode
    scene["haptics"] = {"physics_period_ticks": 1, "water_period_ticks": 1, "frame_period_ticks": 400}
    scene["trace"] = trace
    return scene


def run(argil, scene, folder):
    file = Path(folder, "scene.json")
    file.write_text(json.dumps(scene))
    subprocess.run([argil, "run", file, "-o", Path(folder, "out.h5"), "--quiet"], check=True)
    return ap.open_result(Path(folder, "out.h5"))


def touched_place(argil, body, tets, folder):
    """Point of the surface that faces the wanted side nearest to the body's middle line, and the number of tets."""
    far = {"file": str(ROOT / "traces/press_flank.csv"), "duration_s": 0.002}
    with run(argil, scenario(body, far, "push", tets), folder) as result:
        points, triangles = result["mesh/rest_position"][:], result["mesh/surface_triangles"][:]
        count = len(result["mesh/tets"])
    side = np.array(BODIES[body], dtype=float)
    corners = points[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    centres = corners.mean(axis=1)
    offset = centres - points.mean(axis=0)
    height = offset @ side
    aside = np.linalg.norm(offset - height[:, None] * side, axis=1)
    facing = (normals @ side > 0.9) & (height > 0.0)
    best = np.argmin(np.where(facing, aside - 0.1 * height, np.inf))
    return centres[best], normals[best], count


def measure(argil, body, mode, tets, folder):
    """Ticks in a second, the number of tets, and of nodes that were solved for."""
    point, normal, count = touched_place(argil, body, tets, folder)
    across = np.eye(3)[np.argmin(np.abs(normal))]
    place = make_traces.Place(tuple(1e3 * point), tuple(normal), tuple(across), 1e3 * TOOL_RADIUS, True)
    strokes = [make_traces.Stroke(mode, 0.2, 0.2, 0.0, 0.0), make_traces.Stroke(mode, 0.1, -DEPTH[mode], 0.0, 0.0),
               make_traces.Stroke(mode, 0.3, -DEPTH[mode], 4.0, 0.0)]
    trace = Path(folder, "trace.csv")
    trace.write_text(make_traces.make_trace(place, [], strokes))
    best, active = 0.0, 0
    for _ in range(REPEATS):
        with run(argil, scenario(body, {"file": str(trace), "start_s": 0.2}, mode, tets), folder) as result:
            best = max(best, result["timing/tick_rate_Hz"][-1])
            active = max(active, int(result["physics/active_nodes"][:].max()))
    return best, count, active


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("argil")
    parser.add_argument("-o", "--output", default="rates.csv", metavar="TABLE.csv")
    parser.add_argument("--tets", type=int, default=5000)
    options = parser.parse_args()
    machine = next((line.split(":")[1].strip() for line in Path("/proc/cpuinfo").read_text().splitlines()
                    if line.startswith("model name")), platform.machine())
    with open(options.output, "w", newline="", encoding="utf-8") as file, tempfile.TemporaryDirectory() as folder:
        file.write(f"# {machine}, one thread; ticks in a second, best of {REPEATS}\n")
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["body", "tets", *(f"{mode}_Hz" for mode in DEPTH), "nodes_solved_in_push"])
        for body in BODIES:
            figures = [measure(options.argil, body, mode, options.tets, folder) for mode in DEPTH]
            table.writerow([body, figures[0][1], *(f"{rate:.0f}" for rate, _, _ in figures), figures[0][2]])
    print(options.output)


if __name__ == "__main__":
    main()
