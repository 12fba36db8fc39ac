#!/usr/bin/python3
"""How much the contact's stiffness changes what is felt: a ball pressed into an elastic block and out again, by a tool that pushes and by
one that pulls, with κ as argil chooses it and 2 to 100 times that, in steps of 1 and of 14 ticks, and by a fast push in steps of 7 and
of 14 ticks, on four-node tets; on ten-node ones with --elements. The solver is the default one.

Usage: stiffness_table.py ARGIL [-o FILE.csv] [--elements p1 p2]      writes results/contact/stiffness.csv

Columns: element; law of elasticity; ticks of a step; how forces go on between steps; speed on the way in; push or pull; κ over the chosen
one (0: chosen by itself); force where the ball is deepest; how far the force is off that with the chosen κ, a pull's until the ball lets
go, at most, over its range; of a push also over the force of that tick, where Hertz's radius is two cells and more, and where it is three
and more. Of a pull besides: force over height by a straight line; how far it is off the line, at most over its range; the largest pull;
the height above the block's top at which the ball lets go.
"""
import argparse
import itertools
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
WAYS = {"slow": (150, 100, 1200), "fast": (40, 98, 110)}  # ticks down, at rest, up
HIGH = 0.004  # the end of the way out, above the top [m]
CHOSEN = 80  # κ is so many times E* over the cell
TIMES = (2, 10, 100)
CASES = ((1, "slow", "push", "curnier", "hold"), (1, "slow", "pull", "curnier", "hold"), (1, "slow", "pull", "linear", "hold"),
         (14, "slow", "push", "curnier", "hold"), (14, "slow", "pull", "curnier", "hold"), (7, "fast", "push", "curnier", "hold"),
         (14, "fast", "push", "curnier", "hold"), (14, "fast", "push", "curnier", "re_evaluate"))
TETS = {"p1": 8000, "p2": 2000}  # about as many nodes
CELLS = (2, 3)  # to the radius of contact, from which on a change is looked for


def make_motion(way):
    top = EDGE + RADIUS
    down, rest, up = WAYS[way]
    heights = [*np.linspace(top + GAP, top - DEPTH, down + 1), *[top - DEPTH] * rest, *np.linspace(top - DEPTH, top + HIGH, up + 1)[1:]]
    return [(*AT, z) for z in heights]


def make_scene(element, model, ticks, between, mode, stiffness):
    return {
        "about": "A ball presses on a block and goes out again.",
        "body": {"shape": {"kind": "box", "size_m": EDGE, "target_tets": TETS[element], "skin_triangles": 0},
                 "fixed": [{"kind": "half_space", "normal": [0, 0, 1], "offset_m": 1e-6}]},
        "material": {"youngs_modulus_Pa": MODULUS, "poissons_ratio": POISSON, "plasticity": {"enabled": False},
                     "clay_kernel": {"form": "off"}},
        "tool": {"shape": {"kind": "sphere", "radius_m": RADIUS}, "mode": mode},
        "contact": {"law": "pressure", "stiffness_Pa_per_m": stiffness, "grip_strength_Pa": STRENGTH},
        "dynamics": {"element": element, "model": model},
        "haptics": {"physics_period_ticks": ticks, "water_period_ticks": ticks, "frame_period_ticks": 100 * ticks, "between_frames": between,
                    "chatter_limit": 1},
    }


def find_cell(result, element):
    """Under the ball, per node [m], from the block's mesh."""
    with h5py.File(result) as run:
        x, tets = run["mesh/rest_position"][:], run["mesh/tets"][:]
    corners = x[tets[:, :4]]
    volume = np.abs(np.linalg.det(corners[:, 1:] - corners[:, :1])) / 6
    under = np.linalg.norm(corners.mean(axis=1) - (*AT, x[:, 2].max()), axis=1).argmin()
    return np.cbrt(6 * 2**0.5 * volume[under]) / (2 if element == "p2" else 1)


def measure_pull(force, places, begin):
    """Of the way out, which begins at that tick: where its last one before the ball lets go is, and what is felt until then."""
    height = np.array(places)[begin:, 2] - EDGE - RADIUS
    force = force[begin:]
    last = force.argmin() + 1
    line = np.polyfit(height[:last], force[:last], 1)
    bend = np.abs(force[:last] - np.polyval(line, height[:last])).max() / np.ptp(force[:last])
    return begin + last, [f"{-line[0]:.2f}", f"{bend:.4f}", f"{-force.min():.4f}", f"{1e3 * height[last - 1]:.3f}"]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", maxsplit=1)[0])
    parser.add_argument("argil", type=Path)
    parser.add_argument("-o", "--output", type=Path, default=ROOT / "results/contact/stiffness.csv", metavar="FILE")
    parser.add_argument("--elements", nargs="+", choices=TETS, default=["p1"])
    options = parser.parse_args()
    rows = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for element, (ticks, way, mode, model, between) in itertools.product(options.elements, CASES):
            places = make_motion(way)
            down, rest, _ = WAYS[way]
            radius = np.sqrt(RADIUS * np.maximum(0, EDGE + RADIUS - np.array(places)[1:, 2]))  # Hertz's
            for times in (0, *TIMES):
                stiffness = times * CHOSEN * MODULUS / (1 - POISSON**2) / cell if times else 0
                force = run_along(options.argil, folder, places, make_scene(element, model, ticks, between, mode, stiffness))[:, 2]
                if times == 0:
                    first, cell = force, find_cell(folder / "run.h5", element)
                last, pull = measure_pull(force, places, down + rest) if mode == "pull" else (len(force), [""] * 4)
                if mode == "pull":
                    last = min(last, measure_pull(first, places, down + rest)[0])
                off = np.abs(force - first)[:last] / np.ptp(first[:last])
                wide = [""] * len(CELLS)
                if mode == "push" and way == "slow":
                    counts = [(radius >= cells * cell) & (first > 0) for cells in CELLS]
                    wide = [f"{np.abs(force[at] / first[at] - 1).max():.4f}" for at in counts]
                speed = 1e3 * (GAP + DEPTH) / (down * PERIOD)
                rows.append([element, model, ticks, between, f"{speed:.0f}", mode, times, f"{cell / 1e-3:.3f}", f"{force[down + rest - 1]:.4f}",
                             f"{off.max():.4f}", *wide, *pull])
                print(*rows[-1], flush=True)
    write_table(options.output, ["element", "model", "ticks_of_step", "between_steps", "speed_mm_per_s", "mode", "times_chosen", "cell_mm", "deepest_N",
                                 "largest_change_over_range",
                                 *(f"from_{cells}_cells_over_force" for cells in CELLS), "slope_N_per_m", "off_line",
                                 "largest_pull_N", "lets_go_mm"], rows)


if __name__ == "__main__":
    main()
