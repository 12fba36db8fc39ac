#!/usr/bin/python3
"""What ten-node tets gain by edges that bend with the surface: a ball of clay of 60 mm whose lower half is held, pressed by a ball on even
cells and by a smaller one on graded cells, each with bent edges and, the same cells as a mesh file, with straight ones. Force against
cells that are much finer, volume against that of the ball, processor time of a run.

Usage: bent_table.py ARGIL [-o FILE.csv] [--repeats N]      writes results/accuracy/bent.csv
"""
import argparse
import json
import os
import subprocess
import tempfile
from pathlib import Path

import h5py
import numpy as np

from table_file import write_table

ROOT = Path(__file__).resolve().parent.parent
SIZE = 0.06  # of the clay [m]
FINEST = 12000
# Numbers of tets, radius of the tool, depth [m].
PRESSES = {"even": ((300, 600, 1200, 2500), 0.02, 0.002), "graded": ((600, 1200, 2000, 3600), 0.006, 0.0012)}


def make_scene(folder, cells, body):
    _, radius, depth = PRESSES[cells]
    t = np.arange(0, 0.181, 0.001)
    z = SIZE + radius + 0.0002 - (depth + 0.0002) * np.minimum(1, t / 0.15)
    np.savetxt(folder / "press.csv", np.c_[t, 0 * t + 0.0011, 0 * t + 0.0007, z], delimiter=",", header="t,x,y,z", comments="")
    scene = {
        "about": "A ball pressed into a ball.",
        "body": {**body, "fixed": [{"kind": "half_space", "normal": [0, 0, 1], "offset_m": SIZE / 2}]},
        "material": {"youngs_modulus_Pa": 1e5, "poissons_ratio": 0.3, "plasticity": {"enabled": False}, "clay_kernel": {"form": "off"}},
        "tool": {"shape": {"kind": "sphere", "radius_m": radius}},
        "contact": {"law": "pressure"},
        "dynamics": {"element": "p2", "rayleigh_stiffness_s": 0.001},
        "haptics": {"physics_period_ticks": 2},
        "trace": {"file": "press.csv"},
    }
    (folder / "scene.json").write_text(json.dumps(scene), encoding="utf-8")
    return folder / "scene.json"


class Run:
    def __init__(self, argil, folder, cells, body, repeats=1):
        times = []
        for _ in range(repeats):
            before = os.times()
            subprocess.run([argil, "run", make_scene(folder, cells, body), "-q", "-o", folder / "run.h5", "--threads", "1"], check=True)
            after = os.times()
            times.append(after.children_user + after.children_system - before.children_user - before.children_system)
            with h5py.File(folder / "run.h5") as file:
                self.force = file["haptic/force"][:]
                self.x, self.tets = file["mesh/rest_position"][:], file["mesh/tets"][:]
        self.seconds = np.median(times)


def write_mesh(file, x, tets):
    """The cells alone, whose edges are straight."""
    with open(file, "w", encoding="utf-8") as out:
        out.write(f"# vtk DataFile Version 3.0\nball\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS {len(x)} double\n")
        np.savetxt(out, x, fmt="%.17g")
        out.write(f"CELLS {len(tets)} {5 * len(tets)}\n")
        np.savetxt(out, np.c_[np.full(len(tets), 4), tets], fmt="%d")
        out.write(f"CELL_TYPES {len(tets)}\n" + "10\n" * len(tets))


def find_volume(run, bends):
    """Of the body [m³]: of its tets and, with bent edges, of what lies between their flat faces and the bent ones."""
    a, b, c, d = (run.x[run.tets[:, k]] for k in range(4))
    volume = np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a).sum() / 6
    if not bends:
        return volume
    faces = np.concatenate([run.tets[:, list(face)] for face in ((0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2))])
    _, first, count = np.unique(np.sort(faces, axis=1), axis=0, return_index=True, return_counts=True)
    middle, radius = np.array([0, 0, SIZE / 2]), SIZE / 2
    for face in faces[first[count == 1]]:
        p = run.x[face]
        nodes = [(p[k] + p[(k + 1) % 3]) / 2 for k in range(3)]
        bent = [middle + radius * (n - middle) / np.linalg.norm(n - middle) for n in nodes]
        volume += integrate_cap(p, np.array(bent), middle) - np.dot(np.cross(p[1] - p[0], p[2] - p[0]), p[0] - middle) / 6
    return volume


def integrate_cap(p, bent, middle):
    """∫(X − c)·n dA/3 of a six-node face, by points of degree 4 [Dunavant1985], which is exact."""
    total = 0
    for share, far in ((0.223381589678011, 0.108103018168070), (0.109951743655322, 0.816847572980459)):
        for k in range(3):
            L = np.full(3, (1 - far) / 2)
            L[k] = far
            x = sum(L[i] * (2 * L[i] - 1) * p[i] + 4 * L[i] * L[(i + 1) % 3] * bent[i] for i in range(3))
            t = [(4 * L[i] - 1) * p[i] + 4 * L[(i + 1) % 3] * bent[i] + 4 * L[(i + 2) % 3] * bent[(i + 2) % 3] for i in range(3)]
            total += share * np.dot(np.cross(t[1] - t[0], t[2] - t[0]), x - middle) / 6
    return total


def find_error(force, reference):
    return np.sqrt(((force - reference)**2).sum() / (reference**2).sum())


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", maxsplit=1)[0])
    parser.add_argument("argil", type=Path)
    parser.add_argument("-o", "--output", type=Path, default=ROOT / "results/accuracy/bent.csv", metavar="FILE")
    parser.add_argument("--repeats", type=int, default=3)
    options = parser.parse_args()
    argil, ball = options.argil.resolve(), np.pi / 6 * SIZE**3
    rows = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for cells in PRESSES:
            def shape(count, kind):
                return {"shape": {"kind": "sphere", "size_m": SIZE, "target_tets": count, "skin_triangles": 0}, "cells": {"kind": kind}}
            reference = Run(argil, folder, cells, shape(FINEST, "graded"))
            for count in PRESSES[cells][0]:
                bent = Run(argil, folder, cells, shape(count, cells), options.repeats)
                write_mesh(folder / "ball.vtk", bent.x, bent.tets)
                straight = Run(argil, folder, cells, {"mesh": {"file": "ball.vtk"}}, options.repeats)
                for edges, run in (("straight", straight), ("bent", bent)):
                    rows.append([cells, edges, len(run.tets), f"{find_volume(run, edges == 'bent') / ball - 1:.6f}",
                                 f"{find_error(run.force, reference.force):.4f}",
                                 f"{run.force[-1, 2] / reference.force[-1, 2] - 1:.4f}", f"{run.seconds:.2f}"])
                    print(*rows[-1], flush=True)
            rows.append([cells, "reference", len(reference.tets), "", "", "", f"{reference.seconds:.2f}"])
            print(*rows[-1], flush=True)
    write_table(options.output, ["cells", "edges", "tets", "volume_error", "force_error", "last_force_error", "processor_s"], rows)


if __name__ == "__main__":
    main()
