#!/usr/bin/python3
"""What a hand feels between two steps of the body: a ball pressed into an elastic block and out again, with physics every 5 and
14 ticks by every method, against physics every tick.

Usage: between_table.py ARGIL [-o FILE.csv]      writes results/contact/between.csv
"""
import argparse
import csv
import json
import math
import subprocess
import tempfile
from pathlib import Path

import h5py
import numpy as np

ROOT = Path(__file__).resolve().parent.parent
RADIUS, EDGE, DEPTH, GAP = 0.01, 0.04, 0.002, 0.0003  # of ball and block, deepest place, way before the touch [m]
SECONDS, PERIOD = 1.2, 0.001  # [s]
SIDEWAYS = 0.005  # [m/s], of the motion that slides


def write_motion(file, hertz, sideways):
    lines = ["t,x,y,z"]
    for tick in range(round(SECONDS / PERIOD)):
        t = tick * PERIOD
        z = EDGE + RADIUS + GAP - DEPTH * 0.5 * (1 - math.cos(2 * math.pi * hertz * t))
        lines.append(f"{t:.3f},{0.003 + sideways * t:.9f},0.002,{z:.9f}")
    file.write_text("\n".join(lines) + "\n")


def find_force(argil, folder, friction, period, between):
    scene = {
        "about": "A ball goes into a block and out again.",
        "body": {"shape": {"kind": "box", "size_m": EDGE, "target_tets": 8000, "skin_triangles": 0},
                 "fixed": [{"kind": "half_space", "normal": [0, 0, 1], "offset_m": 1e-6}]},
        "material": {"youngs_modulus_Pa": 1e5, "poissons_ratio": 0.3, "plasticity": {"enabled": False},
                     "clay_kernel": {"form": "off"}},
        "tool": {"shape": {"kind": "sphere", "radius_m": RADIUS}, "mode": "push"},
        "contact": {"law": "pressure", "friction": friction},
        "haptics": {"physics_period_ticks": period, "water_period_ticks": period, "frame_period_ticks": 100 * period,
                    "between_frames": between, "chatter_limit": 1},
        "trace": {"file": "motion.csv"},
    }
    (folder / "scene.json").write_text(json.dumps(scene))
    subprocess.run([argil, "run", folder / "scene.json", "-q", "-o", folder / "run.h5"], check=True)
    with h5py.File(folder / "run.h5") as run:
        return run["haptic/force"][:]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", maxsplit=1)[0])
    parser.add_argument("argil", type=Path)
    parser.add_argument("-o", "--output", type=Path, default=ROOT / "results/contact/between.csv", metavar="FILE")
    options = parser.parse_args()
    rows = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for hertz, sideways, friction in ((1, 0, 0), (5, 0, 0), (1, SIDEWAYS, 0.3)):
            write_motion(folder / "motion.csv", hertz, sideways)
            fine = find_force(options.argil, folder, friction, 1, "hold")
            peak = np.linalg.norm(fine, axis=1).max()
            for period in (5, 14):
                for between in ("hold", "re_evaluate", "compliant"):
                    force = find_force(options.argil, folder, friction, period, between)
                    off = np.sqrt(((force - fine) ** 2).sum(axis=1).mean()) / peak
                    jump = np.linalg.norm(np.diff(force, axis=0), axis=1).max() / peak
                    rows.append([hertz, sideways, friction, period, between, f"{off:.4f}", f"{jump:.4f}"])
                    print(*rows[-1], flush=True)
    options.output.parent.mkdir(parents=True, exist_ok=True)
    with open(options.output, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["motion_Hz", "sideways_m_per_s", "friction", "physics_period_ticks", "between_frames", "rms_over_peak",
                         "largest_change_over_peak"])
        writer.writerows(rows)


if __name__ == "__main__":
    main()
