#!/usr/bin/python3
"""What new cells do to a force: a ball is pressed into a block of clay by a quarter of its height, and another one is led in
a circle through it, with the cells that the body began with and with cells that are made anew where flow has spoilt them.

Usage: new_cells_table.py ARGIL [-o TABLE.csv] [--tets N ...] [--ten-node-tets N ...]
Columns: force at the deepest [N] of the press; mean force [N] of the second quarter turn to the end of the first turn; how often cells
were made anew; the force's change [%] over the two steps after the first time under the tool; farthest volume of the body from the
first [%]; seconds of the processor.
"""
import argparse
import json
import subprocess
import tempfile
from pathlib import Path

import h5py
import numpy as np
from table_file import write_table

EDGE, RADIUS = 0.03, 0.006  # [m]
COLUMNS = ("motion", "element", "tets", "cells", "force_N", "times", "change_percent", "volume_percent", "cpu_s")


def lead(motion, t):
    """Places of the ball's middle [m]."""
    top = EDGE + RADIUS
    if motion == "press":
        return np.c_[np.full_like(t, 3e-4), np.full_like(t, 2e-4), top - np.interp(t, [0, 0.5], [-0.001, 0.0075])]
    turn = 2 * np.pi * t / 2
    return np.c_[0.006 * np.cos(turn), 0.006 * np.sin(turn), top - np.interp(t, [0, 0.5], [-0.001, 0.006])]


def write_scene(folder, motion):
    t = np.arange(0, 0.501 if motion == "press" else 2.001, 0.001)
    np.savetxt(folder / "motion.csv", np.c_[t, lead(motion, t)], delimiter=",", header="t,x,y,z", comments="")
    (folder / "scene.json").write_text(json.dumps({
        "about": motion,
        "body": {"shape": {"kind": "box", "size_m": EDGE, "skin_triangles": 0}, "fixed": [{"kind": "plane", "normal": [0, 0, 1], "offset_m": 0}]},
        "material": {"youngs_modulus_Pa": 1e6, "poissons_ratio": 0.3, "plasticity": {"strength_Pa": 15e3}},
        "tool": {"shape": {"kind": "sphere", "radius_m": RADIUS}},
        "haptics": {"frame_period_ticks": 100, "physics_period_ticks": 2}, "trace": {"file": "motion.csv"}}))
    return folder / "scene.json"


def compute_volume(result, frame):
    epoch = frame.attrs.get("epoch", 0)
    tets = (result["mesh"] if epoch == 0 else result[f"epochs/{epoch:06d}/mesh"])["tets"][:]
    a, b, c, d = (frame["position"][:][tets[:, k]] for k in range(4))
    return np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a).sum() / 6


def measure(argil, folder, motion, element, tets, cells):
    result = folder / "result.h5"
    settings = (f"/dynamics/element={element}", f"/body/shape/target_tets={tets}", f'/body/cells/remesh="{cells}"')
    words = [word for setting in settings for word in ("--set", setting)]
    subprocess.run([argil, "run", write_scene(folder, motion), "-o", result, "--quiet", *words], check=True)
    with h5py.File(result) as run:
        force = np.linalg.norm(run["haptic/force"][:], axis=1)
        epochs = [int(epoch.attrs["tick"]) for epoch in run.get("epochs", {}).values()]
        touched = [tick for tick in epochs if force[tick - 1] > 0.05]
        change = 100 * (force[touched[0] + 4] / force[touched[0] - 1] - 1) if touched else float("nan")
        volumes = np.array([compute_volume(run, frame) for frame in run["frames"].values()])
        found = force[-1] if motion == "press" else force[500:].mean()
        return (motion, element, len(run["mesh/tets"]), cells, f"{found:.4g}", len(epochs), f"{change:.2g}",
                f"{100 * np.abs(volumes / volumes[0] - 1).max():.2g}", f"{run['timing/cpu'][-1]:.3g}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("argil", type=Path)
    parser.add_argument("-o", "--output", type=Path, default=Path("results/clay/new_cells.csv"))
    parser.add_argument("--tets", type=int, nargs="+", default=[8000, 30000])
    parser.add_argument("--ten-node-tets", type=int, nargs="+", default=[2000])
    arguments = parser.parse_args()
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for motion in ("press", "circle"):
            bodies = [("p1", tets) for tets in arguments.tets] + [("p2", tets) for tets in arguments.ten_node_tets]
            for element, tets in bodies:
                for cells in ("never", "when_spoilt"):
                    rows.append(measure(arguments.argil.resolve(), Path(folder), motion, element, tets, cells))
                    print(*rows[-1], sep="  ", flush=True)
    write_table(arguments.output, COLUMNS, rows)


if __name__ == "__main__":
    main()
