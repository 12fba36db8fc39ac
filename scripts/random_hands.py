#!/usr/bin/python3
"""Hands that do what no one would ask for: a ball goes to random places about and in a block, at up to 1 m/s and down to its bottom, and
changes its mode at random. Every run must come to its end.

Usage: random_hands.py ARGIL [--seeds FIRST LAST] [--seconds S] [-o FILE.csv]      exit code 1 where a run did not

A seed also draws the clay (modulus, strength or none), the ball, friction, the length of a step and the method between steps. Columns:
seed, exit code, clay, ticks of a step, method, steps, steps whose motion was limited, of these the whole body's, least det F, peak force.
"""
import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import h5py
import numpy as np

from table_file import write_table

EDGE = 0.04  # of the block [m]
MODES = ("push", "pull", "wet", "dry")


def make_motion(random, radius, seconds):
    """Lines of a table of motion: from place to place on straight lines, sometimes with a rest, sometimes drawn off in between."""
    places, times = [(0.0, 0.0, EDGE + radius + 0.01)], [0.0]

    def go(place):
        speed = 10.0 ** random.uniform(-2.0, 0.0)
        times.append(times[-1] + max(1e-3, np.linalg.norm(np.subtract(place, places[-1])) / speed))
        places.append(place)

    while times[-1] < seconds:
        x, y = random.uniform(-0.6, 0.6, 2) * EDGE
        go((x, y, EDGE + radius + 0.005 - random.uniform(0.0, EDGE + 0.005)))
        if random.uniform() < 0.3:
            places.append(places[-1])
            times.append(times[-1] + random.uniform(0.01, 0.5))
        if random.uniform() < 0.4:
            go((x, y, EDGE + radius + 0.01))
    t = 1e-3 * np.arange(round(1e3 * seconds))
    path = np.stack([np.interp(t, times, [place[k] for place in places]) for k in range(3)], axis=1)
    mode = random.choice(4, size=len(t) // 250 + 1, p=(0.55, 0.25, 0.1, 0.1))
    return ["t,x,y,z,mode"] + [f"{at:.3f},{x:.6f},{y:.6f},{z:.6f},{MODES[mode[i // 250]]}"
                               for i, (at, (x, y, z)) in enumerate(zip(t, path))]


def make_scene(seed, seconds):
    random = np.random.default_rng(seed)
    modulus = 10.0 ** random.uniform(4.0, 6.0)
    radius = random.uniform(0.003, 0.01)
    flows = random.uniform() < 0.7
    strength = modulus * 10.0 ** random.uniform(-2.5, -1.0)
    ticks = int(random.choice((1, 2, 5, 14)))
    scene = {
        "about": "A hand that goes anywhere.",
        "body": {"shape": {"kind": "box", "size_m": EDGE, "target_tets": 2000, "skin_triangles": 0},
                 "fixed": [{"kind": "half_space", "normal": [0, 0, 1], "offset_m": 1e-6}]},
        "material": {"youngs_modulus_Pa": modulus, "poissons_ratio": float(random.choice((0.2, 0.3, 0.4))),
                     "clay_kernel": {"form": "off"}, "plasticity": {"strength_Pa": strength} if flows else {"enabled": False}},
        "tool": {"shape": {"kind": "sphere", "radius_m": radius}},
        "contact": {"friction": float(random.choice((0.0, 0.3, 0.8))), "grip_strength_Pa": 0.05 * modulus},
        "haptics": {"physics_period_ticks": ticks, "water_period_ticks": 70, "frame_period_ticks": 980,
                    "between_frames": str(random.choice(("hold", "re_evaluate", "compliant")))},
        "trace": {"file": "motion.csv"},
    }
    return scene, make_motion(random, radius, seconds)


def run(argil, folder, seed, seconds):
    """A row of the table."""
    scene, motion = make_scene(seed, seconds)
    (folder / "scene.json").write_text(json.dumps(scene), encoding="ascii")
    (folder / "motion.csv").write_text("\n".join(motion) + "\n", encoding="ascii")
    result = folder / "run.h5"
    result.unlink(missing_ok=True)
    done = subprocess.run([argil, "run", folder / "scene.json", "-q", "-o", result], capture_output=True, text=True)
    clay = "flows" if "strength_Pa" in scene["material"]["plasticity"] else "elastic"
    row = [seed, done.returncode, clay, scene["haptics"]["physics_period_ticks"], scene["haptics"]["between_frames"]]
    if not result.exists():
        print(done.stderr, file=sys.stderr)
        return row
    with h5py.File(result) as file:
        limited = file["physics/limited_tets"][:]
        force = np.linalg.norm(file["haptic/force"][:], axis=1)
        whole = limited == file["mesh/tets"].shape[0]
        row += [len(limited), np.count_nonzero(limited), np.count_nonzero(whole), f"{file['physics/min_volume_ratio'][:].min():.3f}",
                f"{force.max():.4g}"]
    return row


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", maxsplit=1)[0])
    parser.add_argument("argil", type=Path)
    parser.add_argument("--seeds", type=int, nargs=2, default=(0, 99), metavar=("FIRST", "LAST"))
    parser.add_argument("--seconds", type=float, default=10.0, metavar="S", help="of each motion")
    parser.add_argument("-o", "--output", type=Path, metavar="FILE", help="table")
    options = parser.parse_args()
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for seed in range(options.seeds[0], options.seeds[1] + 1):
            rows.append(run(options.argil.resolve(), Path(folder), seed, options.seconds))
            print(*rows[-1], flush=True)
    if options.output:
        write_table(options.output, ["seed", "exit_code", "clay", "ticks_of_step", "between_frames", "steps", "limited_steps",
                                     "limited_as_a_whole", "least_volume_ratio", "peak_N"], rows)
    return int(any(row[1] != 0 for row in rows))


if __name__ == "__main__":
    sys.exit(main())
