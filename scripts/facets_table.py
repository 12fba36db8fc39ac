#!/usr/bin/python3
"""How much the force changes in a tick where a ball slides over the facets of an imported surface: an elastic body whose surface file is
a ball of 80, 320 or 1280 triangles, along an arc at constant distance from its middle.

Usage: facets_table.py ARGIL [-o FILE.csv]      writes results/contact/facets.csv

Columns: triangles, speed, mean force, its range over the mean, largest change in a tick over the peak. A change that falls with the
speed is no jump.
"""
import argparse
import tempfile
from pathlib import Path

import numpy as np

from ball_on_block import PERIOD, run_along
from table_file import write_table

ROOT = Path(__file__).resolve().parent.parent
BODY, TOOL, DEPTH = 0.04, 0.006, 0.0015  # radii, and depth below the innermost facet [m]
ANGLE = 0.35  # half the arc
DOWN, REST = 150, 50  # ticks


def make_ball(splits):
    """Vertices and faces of an icosahedron whose faces are split in four, turned so that nothing is symmetric about the way."""
    g = 0.5 * (1 + 5 ** 0.5)
    vertices = [np.array(p) / np.hypot(1, g) for p in (
        (-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g), (0, -1, -g), (0, 1, -g), (g, 0, -1), (g, 0, 1),
        (-g, 0, -1), (-g, 0, 1))]
    faces = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2), (10, 7, 6), (7, 1, 8),
             (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10), (8, 6, 7), (9, 8, 1)]
    for _ in range(splits):
        middles, split = {}, []

        def middle(a, b):
            key = min(a, b), max(a, b)
            if key not in middles:
                vertices.append((vertices[a] + vertices[b]) / np.linalg.norm(vertices[a] + vertices[b]))
                middles[key] = len(vertices) - 1
            return middles[key]

        for a, b, c in faces:
            x, y, z = middle(a, b), middle(b, c), middle(c, a)
            split += [(a, x, z), (b, y, x), (c, z, y), (x, y, z)]
        faces = split
    turn = np.linalg.qr(np.array([[0.3, 0.5, 0.7], [-0.2, 0.8, 0.1], [0.9, 0.1, 0.4]]))[0]
    return BODY * np.array(vertices) @ turn.T, np.array(faces)


def find_force(argil, folder, vertices, faces, speed):
    """Force at the hand [N] in each tick of the slide."""
    corners = vertices[faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    innermost = np.einsum("ij,ij->i", normals, corners[:, 0]) / np.linalg.norm(normals, axis=1)
    inner = np.abs(innermost).min() + TOOL - DEPTH
    if np.linalg.det(corners[0]) < 0.0:
        faces = faces[:, ::-1]
    radius = np.concatenate([np.linspace(BODY + TOOL + 0.001, inner, DOWN), np.full(REST, inner)])
    slide = np.arange(-ANGLE, ANGLE, speed * PERIOD / BODY)
    radius = np.concatenate([radius, np.full(slide.size, inner)])
    angle = np.concatenate([np.full(DOWN + REST, -ANGLE), slide])
    (folder / "ball.obj").write_text("".join(f"v {x:.9f} {y:.9f} {z:.9f}\n" for x, y, z in vertices)
                                     + "".join(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in faces), encoding="ascii")
    scene = {
        "about": "A ball on facets.",
        "body": {"surface": {"file": "ball.obj"}, "fixed": [{"kind": "half_space", "normal": [0, 0, 1], "offset_m": -0.5 * BODY}]},
        "material": {"youngs_modulus_Pa": 1e5, "poissons_ratio": 0.3, "plasticity": {"enabled": False}, "clay_kernel": {"form": "off"}},
        "tool": {"shape": {"kind": "sphere", "radius_m": TOOL}, "mode": "push"},
        "haptics": {"physics_period_ticks": 1, "water_period_ticks": 1, "frame_period_ticks": 100, "chatter_limit": 1},
    }
    places = np.column_stack([radius * np.sin(angle), np.zeros(angle.size), radius * np.cos(angle)])
    return run_along(argil, folder, places, scene)[DOWN + REST:]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", maxsplit=1)[0])
    parser.add_argument("argil", type=Path)
    parser.add_argument("-o", "--output", type=Path, default=ROOT / "results/contact/facets.csv", metavar="FILE")
    options = parser.parse_args()
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for splits in (1, 2, 3):
            vertices, faces = make_ball(splits)
            for speed in (0.05, 0.0125):
                force = find_force(options.argil, Path(folder), vertices, faces, speed)
                size = np.linalg.norm(force, axis=1)
                change = np.linalg.norm(np.diff(force, axis=0), axis=1).max() / size.max()
                rows.append([len(faces), speed, f"{size.mean():.4f}", f"{np.ptp(size) / size.mean():.4f}", f"{change:.5f}"])
                print(*rows[-1], flush=True)
    write_table(options.output, ["triangles", "speed_m_per_s", "mean_force_N", "range_over_mean",
                                 "largest_change_in_a_tick_over_peak"], rows)


if __name__ == "__main__":
    main()
