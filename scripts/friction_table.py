#!/usr/bin/python3
"""Friction of the pressure law: a ball slides over an elastic block at constant depth, for several coefficients, moduli, meshes and
lengths of a step.

Usage: friction_table.py ARGIL [-o FILE.csv] [--tets COUNT …]      writes results/contact/friction.csv

Columns: side force over normal force, mean over the way, over the coefficient; the largest change of that from step to step that goes
back and forth (second difference); both forces are those at the hand.
"""
import argparse
import itertools
import tempfile
from pathlib import Path

import numpy as np

from ball_on_block import EDGE, find_force
from table_file import write_table

ROOT = Path(__file__).resolve().parent.parent
RADIUS, DEPTH, GAP, OFF = 0.008, 0.002, 0.0002, 0.001  # of the ball, below the top, above it at first, off the middle [m]
START, END = -0.006, 0.004  # of the slide [m]
DOWN, REST, SLIDE, SETTLED = 112, 56, 420, 182  # ticks; the last: of the slide before the first that counts


def make_motion():
    top = EDGE + RADIUS
    down = [(START, OFF, z) for z in np.linspace(top + GAP, top - DEPTH, DOWN + 1)]
    return down + [down[-1]] * REST + [(x, OFF, top - DEPTH) for x in np.linspace(START, END, SLIDE + 1)[1:]]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", maxsplit=1)[0])
    parser.add_argument("argil", type=Path)
    parser.add_argument("-o", "--output", type=Path, default=ROOT / "results/contact/friction.csv", metavar="FILE")
    parser.add_argument("--tets", type=int, nargs="+", default=[8000], metavar="COUNT", help="meshes of the block")
    options = parser.parse_args()
    rows = []
    places = make_motion()
    with tempfile.TemporaryDirectory() as folder:
        for tets, modulus, step, friction in itertools.product(options.tets, (3e4, 1e5), (1, 5, 14), (0.2, 0.5, 1.0)):
            force = find_force(options.argil, Path(folder), places, radius=RADIUS, friction=friction, ticks_of_step=step,
                               modulus=modulus, target_tets=tets)[DOWN + REST + SETTLED::step]
            ratio = -force[:, 0] / force[:, 2] / friction
            buzz = np.abs(np.diff(ratio, 2)).max()
            rows.append([tets, modulus, step, friction, f"{ratio.mean():.4f}", f"{buzz:.4f}", f"{force[:, 2].mean():.4f}"])
            print(*rows[-1], flush=True)
    write_table(options.output, ["target_tets", "modulus_Pa", "ticks_of_step", "friction", "side_over_normal_over_friction",
                                 "largest_buzz", "normal_N"], rows)


if __name__ == "__main__":
    main()
