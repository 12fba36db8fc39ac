"""The press in MuJoCo, whose flex is a body of tets; the program is npm's package mujoco-js, run by node."""
import json
import shutil
import subprocess
from pathlib import Path

import numpy as np
from peer_programs import block as b

HERE = Path(__file__).resolve().parent
SKIN = 1e-5  # radius of the flex about its nodes [m]
DAMPING = 0.01  # of each joint of a node [N s/m]


def why_not(folder):
    """Empty where MuJoCo can run; `folder` is where npm put the package."""
    if shutil.which("node") is None:
        return "needs node of Debian's nodejs"
    if not (folder / "node_modules/mujoco-js/dist/mujoco_wasm.js").is_file():
        return f"needs npm's mujoco-js: npm install --prefix {folder} mujoco-js@0.0.7"
    return ""


def press(folder, installed, cells, step):
    nodes, tets = b.make_tets(cells)
    t = step * np.arange(round(b.END / step))
    problem = {"nodes": nodes.round(9).tolist(), "tets": tets.tolist(),
               "held": np.flatnonzero(nodes[:, 2] < -b.HEIGHT * (1 - 1e-9)).tolist(), "radius_m": b.RADIUS, "skin_m": SKIN,
               "mass_kg": b.DENSITY * b.WIDTH**2 * b.HEIGHT, "youngs_modulus_Pa": b.YOUNG, "poissons_ratio": b.POISSON,
               "damping": DAMPING, "step_s": step, "height_m": b.height_of_ball(t).tolist(), "steps_held": round(b.HELD / step)}
    (folder / "problem.json").write_text(json.dumps(problem), encoding="ascii")
    done = subprocess.run(["node", HERE / "press_mujoco.mjs", installed / "node_modules/mujoco-js", folder / "problem.json"],
                          capture_output=True, text=True, check=True, cwd=folder)
    report = done.stdout.splitlines()[-1]  # MuJoCo warns of what is unstable there, too
    return {**json.loads(report), "tets": len(tets), "nodes": len(nodes)}
