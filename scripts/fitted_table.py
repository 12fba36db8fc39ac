#!/usr/bin/python3
"""How well bodies follow the surfaces that they are made from: volume, distances, angles, time and memory of `argil cage`, fitted and
enclosing, for plain shapes that this script writes, argil's own creatures and the OBJ, OFF, PLY and STL files of folders.

Usage: fitted_table.py ARGIL [FOLDER …] [--tets 2000 10000 50000] [-o FILE.csv]      writes results/fitted/fitted.csv
"""
import argparse
import json
import re
import resource
import subprocess
import tempfile
import time
from pathlib import Path

import numpy as np

from table_file import write_table

ROOT = Path(__file__).resolve().parent.parent
LONGEST = 300  # [s] for a body
NUMBER = r"([-+.\de]+)"
PATTERN = re.compile(rf"{NUMBER} tets, cells of {NUMBER} mm(?:, volume {NUMBER} of the surface's)?; boundary off the surface by {NUMBER} mm "
                     rf"in the median, {NUMBER} mm at most, surface off the boundary by {NUMBER} mm at most; {NUMBER} of its {NUMBER} "
                     rf"vertices inside; dihedral angles {NUMBER} to {NUMBER} degrees")


def write_prism(file, outline, height, hole=None):
    """A straight prism over a polygon that is seen whole from its first corner, or over a ring of two alike polygons."""
    n = len(outline)
    rings = [outline] if hole is None else [outline, hole]
    points = [(*p, z) for ring in rings for z in (0, height) for p in ring]
    faces = []
    for r in range(len(rings)):
        low, high = 2 * n * r, 2 * n * r + n
        for i in range(n):
            j = (i + 1) % n
            sides = [(low + i, low + j, high + j), (low + i, high + j, high + i)]
            faces += sides if r == 0 else [side[::-1] for side in sides]
    if hole is None:
        faces += [(0, i + 1, i) for i in range(1, n - 1)] + [(n, n + i, n + i + 1) for i in range(1, n - 1)]
    else:
        for i in range(n):
            j = (i + 1) % n
            faces += [(i, 2 * n + j, j), (i, 2 * n + i, 2 * n + j)]
            faces += [(n + i, n + j, 3 * n + j), (n + i, 3 * n + j, 3 * n + i)]
    lines = [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in points] + ["f " + " ".join(str(v + 1) for v in face) for face in faces]
    file.write_text("\n".join(lines) + "\n", encoding="utf-8")


def write_shapes(folder):
    angle = np.linspace(0, 2 * np.pi, 64, endpoint=False)
    circle = np.c_[np.cos(angle), np.sin(angle)]
    write_prism(folder / "block.obj", [(0, 0), (0.1, 0), (0.1, 0.06), (0, 0.06)], 0.04)
    write_prism(folder / "l_prism.obj", [(0, 0), (0.1, 0), (0.1, 0.03), (0.03, 0.03), (0.03, 0.1), (0, 0.1)], 0.03)
    write_prism(folder / "tube.obj", 0.04 * circle, 0.1, 0.025 * circle)
    write_prism(folder / "thin_sheet.obj", [(0, 0), (0.1, 0), (0.1, 0.1), (0, 0.1)], 0.004)


def write_creature(file, kind):
    """A scenario with one of the creatures that argil makes, to be pressed by nothing."""
    file.with_suffix(".csv").write_text("t,x,y,z\n0,0,0,1\n0.001,0,0,1\n", encoding="utf-8")
    file.write_text(json.dumps({
        "about": "a creature in cells", "body": {"shape": {"kind": kind, "size_m": 0.1, "skin_triangles": 20000}, "cells": {"kind": "even"},
                                                 "fixed": [{"kind": "box", "lower_m": [-1, -1, -1], "upper_m": [1, 1, 0.005]}]},
        "material": {"youngs_modulus_Pa": 1e5, "poissons_ratio": 0.3, "plasticity": {"strength_Pa": 1500}},
        "tool": {"shape": {"kind": "sphere", "radius_m": 0.005}}, "trace": {"file": file.with_suffix(".csv").name}}), encoding="utf-8")


def measure(argil, surface, number, fit, folder):
    words = ["cage", surface, "-o", folder / "cage.msh", "--tets", str(number), "--fit", fit]
    if surface.suffix == ".json":
        words = ["run", surface, "--dry-run", "--set", f"/body/shape/target_tets={number}", "--set", f'/body/shape/fit="{fit}"']
    start = time.monotonic()
    try:
        done = subprocess.run([argil, *words], capture_output=True, text=True, timeout=LONGEST)
    except subprocess.TimeoutExpired:
        return [f"not within {LONGEST} s"]
    seconds = time.monotonic() - start
    found = PATTERN.search(done.stdout + done.stderr)
    if not found:
        return [done.stderr.strip().rsplit(": ", 1)[-1]]
    tets, cell, ratio, median, most, skin, _, _, smallest, largest = found.groups()
    cell = float(cell)
    return [tets, ratio or "", *(f"{float(x) / cell:.3f}" for x in (median, most, skin)), smallest, largest, f"{seconds:.1f}"]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", maxsplit=1)[0])
    parser.add_argument("argil", type=Path)
    parser.add_argument("folders", type=Path, nargs="*", metavar="FOLDER")
    parser.add_argument("--tets", type=int, nargs="+", default=[2000, 10000, 50000])
    parser.add_argument("-o", "--output", type=Path, default=ROOT / "results/fitted/fitted.csv", metavar="FILE")
    options = parser.parse_args()
    argil = options.argil.resolve()
    rows = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        write_shapes(folder)
        for kind in ("dinosaur", "figure"):
            write_creature(folder / f"{kind}.json", kind)
        surfaces = sorted([*folder.glob("*.obj"), *folder.glob("*.json")])
        for other in options.folders:
            surfaces += sorted(file for file in other.iterdir() if file.suffix.lower() in (".obj", ".off", ".ply", ".stl"))
        for surface in surfaces:
            for fit in ("surface", "enclose"):
                for number in options.tets:
                    rows.append([surface.name, fit, number, *measure(argil, surface, number, fit, folder)])
                    print(*rows[-1], flush=True)
    print(f"largest memory of a body: {resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024:.0f} MiB")
    write_table(options.output, ["surface", "fit", "wanted_tets", "tets_or_refusal", "volume_over_surface",
                                 "median_distance_over_cell", "largest_distance_over_cell", "surface_off_boundary_over_cell",
                                 "smallest_angle_deg", "largest_angle_deg", "seconds"], rows)


if __name__ == "__main__":
    main()
