#!/usr/bin/python3
"""What a hand feels between two steps of the body: a ball pressed into an elastic block, plate or column and out again, with physics
every 5 and 14 ticks by every method, against physics every tick.

Usage: between_table.py ARGIL [-o FILE.csv]      writes results/contact/between.csv
"""
import argparse
import math
import tempfile
from pathlib import Path

import numpy as np

from ball_on_block import BLOCK, EDGE, PERIOD, find_force
from table_file import write_table

ROOT = Path(__file__).resolve().parent.parent
RADIUS, DEPTH, GAP = 0.01, 0.002, 0.0003  # of the ball, deepest place, way before the touch [m]
SECONDS = 1.2
SIDEWAYS = 0.005  # [m/s], of the motion that slides
THICKNESS = 0.004  # of the plate, which is 40 mm square and is held along two sides [m]
PLATE = {"shape": {"size_m": THICKNESS, "slenderness": 0.1},
         "fixed": [{"kind": "half_space", "normal": [side, 0, 0], "offset_m": -0.017} for side in (1, -1)]}
HEIGHT = 0.06  # of the column, which is 15 mm square [m]
COLUMN = {"shape": {"size_m": HEIGHT, "slenderness": 4}, "fixed": BLOCK["fixed"]}
BODIES = {"block": (BLOCK, EDGE, 1e5), "plate": (PLATE, THICKNESS, 1e5), "column": (COLUMN, HEIGHT, 1e6)}  # height of the top [m], E [Pa]
CASES = (("block", 1, 0, 0), ("block", 5, 0, 0), ("block", 1, SIDEWAYS, 0.3), ("plate", 1, 0, 0), ("plate", 5, 0, 0),
         ("column", 1, 0.002, 1.0))


def make_motion(hertz, sideways, top=EDGE):
    places = []
    for tick in range(round(SECONDS / PERIOD)):
        t = tick * PERIOD
        z = top + RADIUS + GAP - DEPTH * 0.5 * (1 - math.cos(2 * math.pi * hertz * t))
        places.append((0.003 + sideways * t, 0.002, z))
    return places


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", maxsplit=1)[0])
    parser.add_argument("argil", type=Path)
    parser.add_argument("-o", "--output", type=Path, default=ROOT / "results/contact/between.csv", metavar="FILE")
    options = parser.parse_args()
    rows = []
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        for name, hertz, sideways, friction in CASES:
            body, top, modulus = BODIES[name]
            places = make_motion(hertz, sideways, top)
            scene = {"radius": RADIUS, "friction": friction, "body": body, "modulus": modulus}
            fine = find_force(options.argil, folder, places, **scene)
            peak = np.linalg.norm(fine, axis=1).max()
            for period in (5, 14):
                for between in ("hold", "re_evaluate"):
                    force = find_force(options.argil, folder, places, ticks_of_step=period, between=between, **scene)
                    off = np.sqrt(((force - fine) ** 2).sum(axis=1).mean()) / peak
                    jump = np.linalg.norm(np.diff(force, axis=0), axis=1).max() / peak
                    rows.append([name, hertz, sideways, friction, period, between, f"{off:.4f}", f"{jump:.4f}"])
                    print(*rows[-1], flush=True)
    write_table(options.output, ["body", "motion_Hz", "sideways_m_per_s", "friction", "physics_period_ticks", "between_frames",
                                 "rms_over_peak", "largest_change_over_peak"], rows)


if __name__ == "__main__":
    main()
