"""The press in argil."""
import json
import subprocess

import h5py
import numpy as np
from peer_programs import block as b

TICK = 0.001  # [s]


def write_scene(folder, cells, law, element):
    t = np.arange(0, b.END + TICK / 2, TICK)
    height = b.RADIUS + b.height_of_ball(t) + 1e-9  # argil wants to begin outside the body
    np.savetxt(folder / "motion.csv", np.c_[t, 0 * t, 0 * t, height], delimiter=",", header="t,x,y,z", comments="", fmt="%.10g")
    b.write_msh(folder / "block.msh", *b.make_tets(cells))
    scene = {
        "about": "A ball pressed into an elastic block and held.",
        "body": {"mesh": {"file": "block.msh"},
                 "fixed": [{"kind": "half_space", "normal": [0, 0, 1], "offset_m": -b.HEIGHT + 1e-6}]},
        "material": {"youngs_modulus_Pa": b.YOUNG, "poissons_ratio": b.POISSON, "density_kg_per_m3": b.DENSITY,
                     "plasticity": {"enabled": False}, "clay_kernel": {"form": "off"}},
        "tool": {"shape": {"kind": "sphere", "radius_m": b.RADIUS}},
        "dynamics": {"model": law, "element": element, "allow_locking": True},
        "haptics": {"period_s": TICK, "frame_period_ticks": 1000000},
        "trace": {"file": "motion.csv"},
    }
    (folder / "press.json").write_text(json.dumps(scene), encoding="utf-8")


def press(folder, argil, cells, step, law="corotational", element="p1"):
    """What a row of the table says of a run in steps of `step` [s]."""
    write_scene(folder, cells, law, element)
    ticks = round(step / TICK)
    settings = [f"/haptics/{name}_period_ticks={value}"
                for name, value in (("physics", ticks), ("water", ticks), ("frame", 100 * ticks))]
    result = folder / "press.h5"
    subprocess.run([argil, "run", folder / "press.json", "-o", result, "--quiet", "--threads", "1",
                    *(word for setting in settings for word in ("--set", setting))], check=True, capture_output=True)
    with h5py.File(result) as run:
        held = run["haptic/force"][-round(b.HELD / TICK):, 2]
        return {"force_N": float(np.median(held)), "swing_N": float(np.ptp(held)), "tets": len(run["mesh/tets"]),
                "nodes": len(run["mesh/rest_position"]), "cpu_s": float(run["timing/cpu"][0])}
