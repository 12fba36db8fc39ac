#!/usr/bin/python3
"""How smooth the force is where a ball slides without friction over a flat elastic block at constant depth, a patch of 4.5 mm: cells of one
size, and the cells that a scenario gets which says nothing of them.

Usage: slide_table.py ARGIL [-o FILE.csv] [--tets COUNT …]      writes results/contact/slide_block.csv

Columns, in percent: half the range of the normal force over its mean; the mean and the largest side force over the mean normal one; the
largest change in a tick over the peak.
"""
import argparse
import itertools
import tempfile
from pathlib import Path

import numpy as np

from ball_on_block import EDGE, find_force
from table_file import write_table

ROOT = Path(__file__).resolve().parent.parent
RADIUS, DEPTH, GAP, OFF = 0.010, 0.002, 0.0002, 0.0007  # of the ball, below the top, above it at first, off the middle [m]
HALF_WAY = 0.006  # of the slide [m]
DOWN, REST, SLIDE = 100, 50, 480  # ticks


def make_motion():
    """Askew, so that no row of nodes is met all along."""
    top = EDGE + RADIUS
    path = np.linspace(-HALF_WAY, HALF_WAY, SLIDE + 1)
    first = (path[0], OFF + 0.3 * path[0])
    down = [(*first, z) for z in np.linspace(top + GAP, top - DEPTH, DOWN + 1)]
    return down + [down[-1]] * REST + [(x, OFF + 0.3 * x, top - DEPTH) for x in path[1:]]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", maxsplit=1)[0])
    parser.add_argument("argil", type=Path)
    parser.add_argument("-o", "--output", type=Path, default=ROOT / "results/contact/slide_block.csv", metavar="FILE")
    parser.add_argument("--tets", type=int, nargs="+", default=[8000, 33000], metavar="COUNT", help="meshes of the block")
    options = parser.parse_args()
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for tets, cells in itertools.product(options.tets, ("even", "graded")):
            force = find_force(options.argil, Path(folder), make_motion(), radius=RADIUS, target_tets=tets, cells=cells)[DOWN + REST + 20:]
            normal, side = force[:, 2], np.hypot(force[:, 0], force[:, 1])
            jump = np.abs(np.diff(force, axis=0)).max() / normal.max()
            figures = (np.ptp(normal) / 2, np.hypot(*force[:, :2].mean(axis=0)), side.max(), jump * normal.mean())
            rows.append([tets, cells, f"{normal.mean():.4f}", *(f"{100 * figure / normal.mean():.3f}" for figure in figures)])
            print(*rows[-1], flush=True)
    write_table(options.output, ["target_tets", "cells", "normal_N", "half_range_percent", "mean_side_percent",
                                 "largest_side_percent", "largest_change_percent"], rows)


if __name__ == "__main__":
    main()
