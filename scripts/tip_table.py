#!/usr/bin/python3
"""Does a fine tip feel where the mesh has its nodes? A tip of 1 mm is pressed over a node, the middle of an edge and the middle of a face of
one mesh: into elastic clay with two and with one cell to the radius of contact, and into a body that does not give way, whose faces are
finer or coarser than the patch.

Usage: tip_table.py ARGIL [-o FILE.csv]      writes results/contact/tip.csv

Columns: what is pressed, cells to the radius of contact, force over each place [N], its range over its mean.
"""
import argparse
import tempfile
from pathlib import Path

import h5py
import numpy as np

from ball_on_block import run_along
from table_file import write_table

ROOT = Path(__file__).resolve().parent.parent
EDGE, TIP, DEPTH, GAP = 0.02, 0.001, 0.00025, 0.00005  # of the block; radius, how deep, above it at first [m]
CONTACT = np.sqrt(TIP * DEPTH)  # Hertz's radius [m]
DOWN, REST = 60, 40  # ticks


def make_scene(cell, rigid):
    floor = {"kind": "half_space", "normal": [0, 0, 1], "offset_m": 2.0 * EDGE if rigid else 1e-6}
    return {
        "about": "A tip on a block.",
        "body": {"shape": {"kind": "box", "size_m": EDGE, "target_tets": 3000, "skin_triangles": 0}, "fixed": [floor],
                 "cells": {"kind": "graded", "near_tool_m": cell, "growth": 0.35,
                           "regions": [{"centre_m": [0, 0, EDGE], "radius_m": 4.0 * CONTACT, "size_m": cell}]}},
        "material": {"youngs_modulus_Pa": 1e5, "poissons_ratio": 0.3, "plasticity": {"enabled": False}, "clay_kernel": {"form": "off"}},
        "tool": {"shape": {"kind": "sphere", "radius_m": TIP}, "mode": "push"},
    }


def find_force(argil, folder, scene, place):
    """At rest, DEPTH below the top [N]."""
    heights = EDGE + TIP + np.concatenate([np.linspace(GAP, -DEPTH, DOWN + 1), np.full(REST, -DEPTH)])
    return np.linalg.norm(run_along(argil, folder, [(*place, z) for z in heights], scene)[-1])


def find_places(result):
    """Node, middle of an edge and of a face of the top, those nearest to its middle (x, y)."""
    with h5py.File(result) as run:
        x, triangles = run["mesh/rest_position"][:], run["mesh/surface_triangles"][:]
    top = triangles[np.all(np.isclose(x[triangles][:, :, 2], EDGE), axis=1)]
    corners = x[top][:, :, :2]
    nearest = lambda places: places[np.argmin(np.linalg.norm(places - 0.3 * CONTACT, axis=1))]
    edges = 0.5 * (corners + np.roll(corners, 1, axis=1)).reshape(-1, 2)
    return nearest(corners.reshape(-1, 2)), nearest(edges), nearest(corners.mean(axis=1))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", maxsplit=1)[0])
    parser.add_argument("argil", type=Path)
    parser.add_argument("-o", "--output", type=Path, default=ROOT / "results/contact/tip.csv", metavar="FILE")
    options = parser.parse_args()
    rows = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for rigid, cells in ((True, 4.0), (True, 0.5), (True, 0.2), (False, 2.0), (False, 1.0)):
            scene = make_scene(CONTACT / cells, rigid)
            run_along(options.argil, folder, [(0.0, 0.0, EDGE + 2 * TIP)] * 2, scene)  # for its mesh
            forces = [find_force(options.argil, folder, scene, place) for place in find_places(folder / "run.h5")]
            rows.append(["rigid" if rigid else "clay", cells, *(f"{force:.5f}" for force in forces),
                         f"{np.ptp(forces) / np.mean(forces):.4f}"])
            print(*rows[-1], flush=True)
    write_table(options.output, ["body", "cells_to_contact_radius", "node_N", "edge_N", "face_N", "range_over_mean"], rows)


if __name__ == "__main__":
    main()
