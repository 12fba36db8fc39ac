#!/usr/bin/python3
"""How much the contact's stiffness changes what is felt: a ball pressed into an elastic block and out again, by a tool that pushes and by
one that pulls, with κ as argil chooses it and 1 to 100 times that.

Usage: stiffness_table.py ARGIL [-o FILE.csv] [--tets COUNT]      writes results/contact/stiffness.csv

Columns: κ over the chosen one (0: chosen by itself); force where the ball is deepest; how far the force is off that with the chosen κ, a
pull's until the ball lets go, at most, over its range. Of a pull besides: force over height by a straight line; how
far it is off the line, at most over its range; the largest pull; the height above the block's top at which the ball lets go.
"""
import argparse
import tempfile
from pathlib import Path

import h5py
import numpy as np

from ball_on_block import PERIOD, run_along
from table_file import write_table

ROOT = Path(__file__).resolve().parent.parent
EDGE, MODULUS, POISSON = 0.06, 1e5, 0.3  # of the block [m, Pa, –]
RADIUS, DEPTH, GAP, AT = 0.008, 0.002, 0.0002, (0.0012, -0.0005)  # of the ball; where it presses, off the block's middle [m]
STRENGTH = 3e4  # of the grip [Pa]
DOWN, REST, UP = 150, 100, 1200  # ticks
HIGH = 0.004  # the end of the way out, above the top [m]
CHOSEN = 80  # κ is so many times E* over the cell
TIMES = (1, 3, 10, 30, 100)


def make_motion():
    top = EDGE + RADIUS
    down = np.linspace(top + GAP, top - DEPTH, DOWN + 1)
    heights = [*down, *[down[-1]] * REST, *np.linspace(top - DEPTH, top + HIGH, UP + 1)[1:]]
    return [(*AT, z) for z in heights]


def make_scene(tets, mode, stiffness):
    return {
        "about": "A ball presses on a block and goes out again.",
        "body": {"shape": {"kind": "box", "size_m": EDGE, "target_tets": tets, "skin_triangles": 0},
                 "fixed": [{"kind": "half_space", "normal": [0, 0, 1], "offset_m": 1e-6}]},
        "material": {"youngs_modulus_Pa": MODULUS, "poissons_ratio": POISSON, "plasticity": {"enabled": False},
                     "clay_kernel": {"form": "off"}},
        "tool": {"shape": {"kind": "sphere", "radius_m": RADIUS}, "mode": mode},
        "contact": {"law": "pressure", "stiffness_Pa_per_m": stiffness, "grip_strength_Pa": STRENGTH},
        "dynamics": {"solver": {"tolerance": 1e-6}},
        "haptics": {"physics_period_ticks": 1, "water_period_ticks": 1, "frame_period_ticks": 100, "chatter_limit": 1},
    }


def find_chosen(result):
    """κ [Pa/m] over the cell under the ball, from the block's mesh."""
    with h5py.File(result) as run:
        x, tets = run["mesh/rest_position"][:], run["mesh/tets"][:]
    corners = x[tets]
    volume = np.abs(np.linalg.det(corners[:, 1:] - corners[:, :1])) / 6
    under = np.linalg.norm(corners.mean(axis=1) - (*AT, x[:, 2].max()), axis=1).argmin()
    cell = np.cbrt(6 * 2**0.5 * volume[under])
    return CHOSEN * MODULUS / (1 - POISSON**2) / cell


def measure_pull(force):
    """Of the way out: where its last tick before the ball lets go is, and what is felt until then."""
    height = np.array(make_motion())[DOWN + REST:, 2] - EDGE - RADIUS
    force = force[DOWN + REST:]
    last = force.argmin() + 1
    line = np.polyfit(height[:last], force[:last], 1)
    bend = np.abs(force[:last] - np.polyval(line, height[:last])).max() / np.ptp(force[:last])
    return DOWN + REST + last, [f"{-line[0]:.2f}", f"{bend:.4f}", f"{-force.min():.4f}", f"{1e3 * height[last - 1]:.3f}"]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", maxsplit=1)[0])
    parser.add_argument("argil", type=Path)
    parser.add_argument("-o", "--output", type=Path, default=ROOT / "results/contact/stiffness.csv", metavar="FILE")
    parser.add_argument("--tets", type=int, default=8000, metavar="COUNT", help="mesh of the block")
    options = parser.parse_args()
    rows = []
    places = make_motion()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for mode in ("push", "pull"):
            for times in (0, *TIMES):
                stiffness = times * chosen if times else 0
                force = run_along(options.argil, folder, places, make_scene(options.tets, mode, stiffness))[:, 2]
                if times == 0:
                    first, chosen = force, find_chosen(folder / "run.h5")
                last, pull = measure_pull(force) if mode == "pull" else (len(force), [""] * 4)
                if mode == "pull":
                    last = min(last, measure_pull(first)[0])
                off = np.abs(force - first)[:last] / np.ptp(first[:last])
                rows.append([mode, times, f"{force[DOWN + REST - 1]:.4f}", f"{off.max():.4f}", *pull])
                print(*rows[-1], flush=True)
    write_table(options.output, ["mode", "times_chosen", "deepest_N", "largest_change_over_range", "slope_N_per_m", "off_line",
                                 "largest_pull_N", "lets_go_mm"], rows)


if __name__ == "__main__":
    main()
