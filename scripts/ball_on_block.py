"""What the tables of the pressure law share: how a scene is run along a way, and a ball on an elastic block."""
import json
import subprocess

import h5py

EDGE = 0.04  # of the block [m]
PERIOD = 0.001  # [s]


def run_along(argil, folder, places, scene):
    """Force at the hand [N] in each tick (N×3) of a scene whose tool is at `places` (N×3) [m] one tick after the other. `folder` takes
    scene, motion and result."""
    lines = ["t,x,y,z"] + [f"{i * PERIOD:.3f},{x:.9f},{y:.9f},{z:.9f}" for i, (x, y, z) in enumerate(places)]
    (folder / "motion.csv").write_text("\n".join(lines) + "\n", encoding="ascii")
    (folder / "scene.json").write_text(json.dumps({**scene, "trace": {"file": "motion.csv"}}), encoding="ascii")
    subprocess.run([argil, "run", folder / "scene.json", "-q", "-o", folder / "run.h5"], check=True)
    with h5py.File(folder / "run.h5") as run:
        return run["haptic/force"][:]


BLOCK = {"shape": {"size_m": EDGE}, "fixed": [{"kind": "half_space", "normal": [0, 0, 1], "offset_m": 1e-6}]}


def find_force(argil, folder, places, *, radius, friction=0.0, ticks_of_step=1, between="hold", modulus=1e5, target_tets=8000,
               cells="graded", iteration="one", body=None):
    """The same of the ball's middle over a block, or a box of another shape and support. `modulus` is E [Pa]."""
    body = body or BLOCK
    scene = {
        "about": "A ball on a block.",
        "body": {"cells": {"kind": cells}, "shape": {"kind": "box", "target_tets": target_tets, "skin_triangles": 0, **body["shape"]},
                 "fixed": body["fixed"]},
        "material": {"youngs_modulus_Pa": modulus, "poissons_ratio": 0.3, "plasticity": {"enabled": False},
                     "clay_kernel": {"form": "off"}},
        "tool": {"shape": {"kind": "sphere", "radius_m": radius}, "mode": "push"},
        "contact": {"law": "pressure", "friction": friction},
        "dynamics": {"iteration": iteration},
        "haptics": {"physics_period_ticks": ticks_of_step, "water_period_ticks": ticks_of_step,
                    "frame_period_ticks": 100 * ticks_of_step, "between_frames": between, "chatter_limit": 1},
    }
    return run_along(argil, folder, places, scene)
