#!/usr/bin/python3
"""Friction of the pressure law: a ball slides over an elastic block at constant depth, for several coefficients, moduli, meshes,
lengths of a step and ways to find the force between steps.

Usage: friction_table.py ARGIL [-o FILE.csv] [--tets COUNT …] [--only-steps]      writes results/contact/friction.csv, friction_steps.csv

Columns: side force over normal force, mean over the way, over the coefficient; the largest change of that from step to step that goes
back and forth (second difference); both forces are those at the hand. The second table: side over normal force by the way of the tool
in a step, with one linearised solve a step and with Newton's iteration.
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
RATES = ((1, "hold"), (5, "hold"), (14, "hold"), (14, "re_evaluate"))  # ticks of a step, between them
DOWN, REST, SLIDE, SETTLED = 112, 56, 420, 182  # ticks; the last: of the slide before the first that counts


# of the second table: friction, ticks of a step, how many times slower, iteration
STEPS = [*((friction, step, 1, "one") for friction in (0.0, 0.2) for step in (1, 2, 4, 7, 14)),
         (0.2, 14, 2, "one"), *((friction, 14, 1, "newton") for friction in (0.0, 0.2))]


def make_motion(slower=1):
    top = EDGE + RADIUS
    down = [(START, OFF, z) for z in np.linspace(top + GAP, top - DEPTH, DOWN + 1)]
    return down + [down[-1]] * REST + [(x, OFF, top - DEPTH) for x in np.linspace(START, END, slower * SLIDE + 1)[1:]]


def measure_steps(argil, folder):
    """Rows of the second table, 8000 tets of 30 kPa."""
    for friction, step, slower, iteration in STEPS:
        force = find_force(argil, folder, make_motion(slower), radius=RADIUS, friction=friction, ticks_of_step=step, modulus=3e4,
                           iteration=iteration)[DOWN + REST + slower * SETTLED::step]
        way = step * (END - START) / (slower * SLIDE)
        yield [friction, step, slower, iteration, f"{way:.3g}", f"{-(force[:, 0] / force[:, 2]).mean():.5f}"]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", maxsplit=1)[0])
    parser.add_argument("argil", type=Path)
    parser.add_argument("-o", "--output", type=Path, default=ROOT / "results/contact/friction.csv", metavar="FILE")
    parser.add_argument("--tets", type=int, nargs="+", default=[8000], metavar="COUNT", help="meshes of the block")
    parser.add_argument("--only-steps", action="store_true", help="only the second table")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        write_table(options.output.with_stem(options.output.stem + "_steps"),
                    ["friction", "ticks_of_step", "times_slower", "iteration", "way_in_a_step_m", "side_over_normal"],
                    measure_steps(options.argil, Path(folder)))
    if options.only_steps:
        return
    rows = []
    places = make_motion()
    with tempfile.TemporaryDirectory() as folder:
        for tets, modulus, (step, between), friction in itertools.product(options.tets, (3e4, 1e5), RATES, (0.2, 0.5, 1.0)):
            force = find_force(options.argil, Path(folder), places, radius=RADIUS, friction=friction, ticks_of_step=step,
                               between=between, modulus=modulus, target_tets=tets)[DOWN + REST + SETTLED::step]
            ratio = -force[:, 0] / force[:, 2] / friction
            buzz = np.abs(np.diff(ratio, 2)).max()
            rows.append([tets, modulus, step, between, friction, f"{ratio.mean():.4f}", f"{buzz:.4f}", f"{force[:, 2].mean():.4f}"])
            print(*rows[-1], flush=True)
    write_table(options.output, ["target_tets", "modulus_Pa", "ticks_of_step", "between_steps", "friction",
                                 "side_over_normal_over_friction", "largest_buzz", "normal_N"], rows)


if __name__ == "__main__":
    main()
