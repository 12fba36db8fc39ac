#!/usr/bin/python3
"""Forces on cells that are small where the tool comes, beside cells of one size: tips of 1 and 3 mm pressed a tenth of their radius, a
sphere pressed a hundredth of it and a flat punch, into an elastic block of 200 mm, over the closed forms; and peaks over their limits: of
scenarios/study_light_press.json, and of the first press of scenarios/study_soft_dino.json on elastic clay and on the clay that it had.

Usage: graded_table.py ARGIL [--scenes tips hertz press elastic flow] [-o FILE.csv]      writes results/contact/graded.csv
"""
import argparse
import csv
import json
import subprocess
import tempfile
from pathlib import Path

import h5py
import numpy as np
import plot_hertz

from table_file import write_table

ROOT = Path(__file__).resolve().parent.parent
EDGE, MODULUS, POISSON = 0.2, 1e5, 0.3  # of the block [m, Pa, –]
REDUCED = MODULUS / (1 - POISSON**2)
GAP, SECONDS, DOWN = 0.0005, 0.3, 0.25  # way before the touch [m]; of the motion, and of its way down [s]
LIMIT = 2.085  # of the light press [N], to 0.003: 12 000 ten-node tets give 2.0849 N, 324 000 even ones 2.0853 N
NUMBERS = (2200, 5000, 10000, 20000)
DEMONSTRATION = ["/dynamics/model=hencky", "/material/plasticity/enabled=false", "/material/clay_kernel/form=off", "/trace/duration_s=0.9",
                 "/haptics/physics_period_ticks=10"]
DEMONSTRATION_LIMIT = 1.914  # [N], to 0.004: 60 000 and 240 000 graded tets, whose error falls as the square root of their number
FLOW = ["/trace/duration_s=0.9", "/haptics/physics_period_ticks=5", "/material/plasticity/strength_Pa=1500", "/material/youngs_modulus_Pa=140000"]
SMALL = {"near_tool_m": 0.001 / 2.4, "growth": 0.35}  # under a patch of 1 mm
PUNCH, RIM = 0.001, 48  # its radius [m]; balls of small cells along its rim


def run(argil, folder, scenario, *settings):
    """Forces at the hand [N] and the number of tets."""
    result = folder / "result.h5"
    words = [word for setting in settings for word in ("--set", setting)]
    subprocess.run([argil, "run", scenario, "-o", result, "--quiet", *words], check=True)
    with h5py.File(result) as file:
        return np.linalg.norm(file["haptic/force"][:], axis=1), len(file["mesh/tets"])


def write_press(folder, name, tool, height, depth, cells=None, place=(0, 0)):
    """A tool that goes slowly down into a large elastic block and waits; `height`: of its place over its tip, `place`: from the
    middle [m]."""
    t = np.arange(0, SECONDS + 1e-9, 0.001)
    z = EDGE + height + GAP - (GAP + depth) * np.minimum(1, t / DOWN)
    np.savetxt(folder / f"{name}.csv", np.c_[t, 0 * t + place[0], 0 * t + place[1], z], delimiter=",", header="t,x,y,z", comments="")
    scenario = {
        "about": "A small tool on a large elastic block.",
        "body": {"shape": {"kind": "box", "size_m": EDGE, "skin_triangles": 0}, "cells": {"kind": "graded", **(cells or {})},
                 "fixed": [{"kind": "plane", "normal": [0, 0, 1], "offset_m": 0}]},
        "material": {"youngs_modulus_Pa": MODULUS, "poissons_ratio": POISSON, "density_kg_per_m3": 1500,
                     "plasticity": {"enabled": False}, "clay_kernel": {"form": "off"}},
        "tool": tool,
        "dynamics": {"rayleigh_stiffness_s": 0.001},
        "trace": {"file": f"{name}.csv"},
    }
    (folder / f"{name}.json").write_text(json.dumps(scenario), encoding="utf-8")
    return folder / f"{name}.json"


def write_tip(folder, radius, depth, cells=None, place=(0, 0)):
    return write_press(folder, "tip", {"shape": {"kind": "sphere", "radius_m": radius}}, radius, depth, cells, place)


def write_punch(folder, depth, size, growth):
    """Cells of this size along the rim, where the pressure is singular."""
    plot_hertz.CONTACT_RADIUS = PUNCH
    plot_hertz.write_tool(folder / "punch.obj", lambda r: 0 * r, PUNCH, 12)
    angles = 2 * np.pi * np.arange(RIM) / RIM
    rim = [{"centre_m": [PUNCH * np.cos(angle), PUNCH * np.sin(angle), EDGE], "radius_m": 2 * np.pi * PUNCH / RIM / 1.6, "size_m": size}
           for angle in angles]
    return write_press(folder, "punch", {"shape": {"kind": "mesh", "file": "punch.obj"}}, 0, depth, {"near_tool_m": PUNCH / 4, "growth": growth, "regions": rim})


def find_hertz(radius, depth):
    return 4 / 3 * REDUCED * radius**0.5 * depth**1.5


def press_tips(argil, folder, add):
    for radius in (0.001, 0.003):
        depth = 0.1 * radius
        hertz = find_hertz(radius, depth)
        scenario = write_tip(folder, radius, depth)
        for model in ("corotational", "curnier"):
            for number in NUMBERS:
                force, tets = run(argil, folder, scenario, f"/dynamics/model={model}", f"/body/shape/target_tets={number}")
                add(f"tip of {1e3 * radius:g} mm, {model}", "graded", tets, force[-1] / hertz)


def press_hertz(argil, folder, add):
    """Shallow presses, for which the closed forms are."""
    radius, depth = 0.01, 0.0001
    hertz = find_hertz(radius, depth)
    scenario = write_tip(folder, radius, depth)
    for element, number in (("p1", 5000), ("p1", 10000), ("p1", 20000), ("p1", 60000), ("p2", 5000)):
        force, tets = run(argil, folder, scenario, f"/dynamics/element={element}", f"/body/shape/target_tets={number}")
        add("sphere of 10 mm", "graded" if element == "p1" else "graded, ten nodes", tets, force[-1] / hertz)
    radius, depth = 0.1, 1e-5  # a slope of 0.01
    hertz = find_hertz(radius, depth)
    for where, place, cells, number in (("", (0, 0), None, 20000), ("", (0, 0), SMALL, 300),
                                        (", beside the middle", (0.004, 0.001), SMALL, 300)):
        scenario = write_tip(folder, radius, depth, cells, place)
        force, tets = run(argil, folder, scenario, "/dynamics/model=linear", f"/body/shape/target_tets={number}")
        add("sphere of 100 mm, linear" + where, "a/2.4, growth 0.35" if cells else "graded", tets, force[-1] / hertz)
    depth = 0.05 * PUNCH
    for cells, growth in ((8, 0.8), (8, 0.5), (8, 0.4), (6, 0.3)):
        force, tets = run(argil, folder, write_punch(folder, depth, PUNCH / cells, growth), "/dynamics/model=linear",
                          "/body/shape/target_tets=400")
        add("punch, linear", f"a/{cells} along the rim, growth {growth}", tets, force[-1] / (2 * REDUCED * PUNCH * depth))


def press_lightly(argil, folder, add):
    scenario = ROOT / "scenarios/study_light_press.json"
    for cells in ("even", "graded"):
        for number in NUMBERS:
            force, tets = run(argil, folder, scenario, "/contact/law=pressure", f"/body/cells/kind={cells}",
                              f"/body/shape/target_tets={number}")
            add("light press", cells, tets, force.max() / LIMIT)
    force, tets = run(argil, folder, scenario, "/contact/law=pressure", "/body/cells/kind=graded", "/body/cells/growth=0.1",
                      "/body/shape/target_tets=20000")
    add("light press", "graded, growth 0.1", tets, force.max() / LIMIT)


def press_dinosaur(argil, folder, add):
    for cells, numbers in (("even", (5000, 20000, 80000, 320000)), ("graded", (5000, 10000, 15000, 60000, 240000))):
        for number in numbers:
            force, tets = run(argil, folder, ROOT / "scenarios/study_soft_dino.json", f"/body/cells/kind={cells}",
                              f"/body/shape/target_tets={number}", *DEMONSTRATION)
            add("demonstration", cells, tets, force.max() / DEMONSTRATION_LIMIT)


def press_flowing_dinosaur(argil, folder, add):
    """Over the finest one's."""
    cases = [("graded", number, "p1") for number in (60000, 30000, 15000, 10000, 5000)] + [("graded, ten nodes", 5000, "p2")]
    finest = None
    for cells, number, element in cases:
        force, tets = run(argil, folder, ROOT / "scenarios/study_soft_dino.json", "/body/cells/kind=graded", f"/dynamics/element={element}",
                          f"/body/shape/target_tets={number}", *FLOW)
        finest = finest or force.max()
        add("demonstration that flows", cells, tets, force.max() / finest)


SCENES = {"tips": press_tips, "hertz": press_hertz, "press": press_lightly, "elastic": press_dinosaur, "flow": press_flowing_dinosaur}


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", maxsplit=1)[0])
    parser.add_argument("argil", type=Path)
    parser.add_argument("--scenes", nargs="+", choices=SCENES, default=list(SCENES), help="rows of the others stay as they are")
    parser.add_argument("-o", "--output", type=Path, default=ROOT / "results/contact/graded.csv", metavar="FILE")
    options = parser.parse_args()
    rows = []

    def add(scene, cells, tets, ratio):
        rows.append([scene, cells, str(tets), f"{ratio:.3f}"])
        print(*rows[-1], flush=True)

    with tempfile.TemporaryDirectory() as name:
        for scene in options.scenes:
            SCENES[scene](options.argil.resolve(), Path(name), add)
    kept = []
    if options.output.exists():
        with open(options.output, newline="", encoding="utf-8") as file:
            kept = [row for row in list(csv.reader(file))[1:] if row[0] not in {new[0] for new in rows}]
    write_table(options.output, ["scene", "cells", "tets", "force_over_limit"], kept + rows)


if __name__ == "__main__":
    main()
