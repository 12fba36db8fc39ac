#!/usr/bin/python3
"""Does the force hang on how many triangles draw the tool or the skin? A ball of 8 mm, 2 mm deep in an elastic block, pushing and wetting:
its exact shape and meshes of it, and on skins of many sizes over the same cells.

Usage: triangles_table.py ARGIL [-o FILE.csv]      writes results/contact/triangles.csv

The meshes' corners lie as far out as gives them the ball's volume. Columns: what is varied, its triangles (0: the exact ball), mode, force
at rest, that over the exact ball's or over the finest skin's.
"""
import argparse
import tempfile
from pathlib import Path

import h5py
import numpy as np

from ball_on_block import EDGE, run_along
from facets_table import make_ball
from table_file import write_table

ROOT = Path(__file__).resolve().parent.parent
RADIUS, DEPTH, GAP, AT = 0.008, 0.002, 0.0002, (0.0007, -0.0004)  # of the ball; where it presses [m]
DOWN, REST = 100, 50  # ticks
SPLITS = (3, 4, 5)  # of an icosahedron: 1280, 5120 and 20 480 triangles
SKINS = (2000, 8000, 32000, 128000)


def make_scene(mode, tool, skin_triangles):
    return {
        "about": "A ball on a block.",
        "body": {"cells": {"kind": "even" if skin_triangles else "graded"},  # graded ones hang on the skin
                 "shape": {"kind": "box", "size_m": EDGE, "target_tets": 8000, "skin_triangles": skin_triangles},
                 "fixed": [{"kind": "half_space", "normal": [0, 0, 1], "offset_m": 1e-6}]},
        "material": {"youngs_modulus_Pa": 1e5, "poissons_ratio": 0.3, "plasticity": {"enabled": False}, "clay_kernel": {"form": "off"}},
        "tool": {"shape": tool, "mode": mode},
        "contact": {"law": "pressure"},
        "haptics": {"physics_period_ticks": 1, "water_period_ticks": 10, "frame_period_ticks": 100, "chatter_limit": 1},
    }


def write_ball(file, splits):
    """Of the volume of a ball of RADIUS; returns how many triangles."""
    vertices, faces = make_ball(splits)
    vertices, faces = np.asarray(vertices), np.asarray(faces)
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    volume = np.einsum("ij,ij->", a, np.cross(b, c)) / 6
    faces = faces if volume > 0 else faces[:, ::-1]
    vertices = vertices * RADIUS * np.cbrt(4 * np.pi / 3 / abs(volume))
    lines = [f"v {x:.12g} {y:.12g} {z:.12g}" for x, y, z in vertices] + [f"f {i + 1} {j + 1} {k + 1}" for i, j, k in faces]
    file.write_text("\n".join(lines) + "\n", encoding="ascii")
    return len(faces)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", maxsplit=1)[0])
    parser.add_argument("argil", type=Path)
    parser.add_argument("-o", "--output", type=Path, default=ROOT / "results/contact/triangles.csv", metavar="FILE")
    options = parser.parse_args()
    heights = EDGE + RADIUS + np.concatenate([np.linspace(GAP, -DEPTH, DOWN + 1), np.full(REST, -DEPTH)])
    places = [(*AT, z) for z in heights]
    exact = {"kind": "sphere", "radius_m": RADIUS}
    rows = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)

        def press(*scene):
            return run_along(options.argil, folder, places, make_scene(*scene))[-1, 2]

        for mode in ("push", "wet"):
            ball = press(mode, exact, 0)
            rows.append(["tool", 0, mode, f"{ball:.5f}", "1.0000"])
            print(*rows[-1], flush=True)
            for splits in SPLITS:
                count = write_ball(folder / "ball.obj", splits)
                force = press(mode, {"kind": "mesh", "file": "ball.obj"}, 0)
                rows.append(["tool", count, mode, f"{force:.5f}", f"{force / ball:.4f}"])
                print(*rows[-1], flush=True)
            skins = []
            for triangles in SKINS:
                force = press(mode, exact, triangles)
                with h5py.File(folder / "run.h5") as run:
                    skins.append((len(run["mesh/skin_triangles"]), force))
            for count, force in skins:
                rows.append(["skin", count, mode, f"{force:.5f}", f"{force / skins[-1][1]:.4f}"])
                print(*rows[-1], flush=True)
    write_table(options.output, ["varied", "triangles", "mode", "force_N", "over_reference"], rows)


if __name__ == "__main__":
    main()
