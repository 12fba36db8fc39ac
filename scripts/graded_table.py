#!/usr/bin/python3
"""Forces on cells that are small where the tool comes, beside cells of one size: tips of 1 and 3 mm pressed a tenth of their radius into
an elastic block of 200 mm, over Hertz's closed form; and peaks over their limits: of scenarios/study_light_press.json, and of the first
press of scenarios/study_soft_dino.json on elastic clay.

Usage: graded_table.py ARGIL [-o FILE.csv]      writes results/contact/graded.csv
"""
import argparse
import json
import subprocess
import tempfile
from pathlib import Path

import h5py
import numpy as np

from table_file import write_table

ROOT = Path(__file__).resolve().parent.parent
EDGE, MODULUS, POISSON = 0.2, 1e5, 0.3  # of the block [m, Pa, –]
GAP, SECONDS, DOWN = 0.0005, 0.3, 0.25  # way before the touch [m]; of the motion, and of its way down [s]
LIMIT = 2.065  # of the light press [N], to 0.01, by cells that are made finer and finer
NUMBERS = (2200, 5000, 10000, 20000)
DEMONSTRATION = ["/dynamics/model=hencky", "/material/plasticity/enabled=false", "/material/clay_kernel/form=off", "/trace/duration_s=0.9",
                 "/haptics/physics_period_ticks=10"]
FINEST = (60000, 240000)  # from which its limit is extrapolated: linear tets err as the square root of their number


def run(argil, folder, scenario, *settings):
    """Forces at the hand [N] and the number of tets."""
    result = folder / "result.h5"
    words = [word for setting in settings for word in ("--set", setting)]
    subprocess.run([argil, "run", scenario, "-o", result, "--quiet", *words], check=True)
    with h5py.File(result) as file:
        return np.linalg.norm(file["haptic/force"][:], axis=1), len(file["mesh/tets"])


def write_tip(folder, radius, depth):
    t = np.arange(0, SECONDS + 1e-9, 0.001)
    z = EDGE + radius + GAP - (GAP + depth) * np.minimum(1, t / DOWN)
    np.savetxt(folder / "tip.csv", np.c_[t, 0 * t, 0 * t, z], delimiter=",", header="t,x,y,z", comments="")
    scenario = {
        "about": "A small tip on a large elastic block.",
        "body": {"shape": {"kind": "box", "size_m": EDGE, "skin_triangles": 0},
                 "fixed": [{"kind": "plane", "normal": [0, 0, 1], "offset_m": 0}]},
        "material": {"youngs_modulus_Pa": MODULUS, "poissons_ratio": POISSON, "density_kg_per_m3": 1500,
                     "plasticity": {"enabled": False}, "clay_kernel": {"form": "off"}},
        "tool": {"shape": {"kind": "sphere", "radius_m": radius}},
        "dynamics": {"rayleigh_stiffness_s": 0.001},
        "trace": {"file": "tip.csv"},
    }
    (folder / "tip.json").write_text(json.dumps(scenario), encoding="utf-8")
    return folder / "tip.json"


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", maxsplit=1)[0])
    parser.add_argument("argil", type=Path)
    parser.add_argument("-o", "--output", type=Path, default=ROOT / "results/contact/graded.csv", metavar="FILE")
    options = parser.parse_args()
    argil = options.argil.resolve()
    rows = []

    def add(*row):
        rows.append(row)
        print(*row, flush=True)

    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for radius in (0.001, 0.003):
            depth = 0.1 * radius
            hertz = 4 / 3 * MODULUS / (1 - POISSON**2) * radius**0.5 * depth**1.5
            scenario = write_tip(folder, radius, depth)
            for model in ("corotational", "curnier"):
                for number in NUMBERS:
                    force, tets = run(argil, folder, scenario, f"/dynamics/model={model}", f"/body/shape/target_tets={number}")
                    add(f"tip of {1e3 * radius:g} mm, {model}", "graded", tets, f"{force[-1] / hertz:.3f}")
        press = ROOT / "scenarios/study_light_press.json"
        for cells in ("even", "graded"):
            for number in NUMBERS:
                force, tets = run(argil, folder, press, "/contact/law=pressure", f"/body/cells/kind={cells}",
                                  f"/body/shape/target_tets={number}")
                add("light press", cells, tets, f"{force.max() / LIMIT:.3f}")
        force, tets = run(argil, folder, press, "/contact/law=pressure", "/body/cells/kind=graded", "/body/cells/growth=0.1",
                          "/body/shape/target_tets=20000")
        add("light press", "graded, growth 0.1", tets, f"{force.max() / LIMIT:.3f}")
        press = ROOT / "scenarios/study_soft_dino.json"

        def peak(cells, number):
            force, tets = run(argil, folder, press, f"/body/cells/kind={cells}", f"/body/shape/target_tets={number}", *DEMONSTRATION)
            return force.max(), tets

        finest = [peak("graded", number) for number in FINEST]
        (coarse, few), (fine, many) = finest
        limit = fine - (coarse - fine) / ((many / few) ** 0.5 - 1)
        print(f"demonstration: limit {limit:.3f} N, certain to {fine - limit:.3f} N")
        for cells, numbers in (("even", (5000, 20000, 80000, 320000)), ("graded", (5000, 10000, 15000))):
            for number in numbers:
                force, tets = peak(cells, number)
                add("demonstration", cells, tets, f"{force / limit:.3f}")
        for force, tets in finest:
            add("demonstration", "graded", tets, f"{force / limit:.3f}")
    write_table(options.output, ["scene", "cells", "tets", "force_over_limit"], rows)


if __name__ == "__main__":
    main()
