#!/usr/bin/python3
"""Presses a rigid sphere, a flat punch and a cone into a large elastic block and compares the force at the hand with
the closed forms of the elastic half-space; finer and finer meshes, stiffer and stiffer penalties.

Sphere [Hertz1882] F = 4/3 E* √(R d³), punch [Sneddon1965] F = 2 E* a d, cone [Sneddon1965] F = 2/π E* d² tan α, with
E* = E/(1−ν²), depth d and contact radius a.

A quarter of the block with rollers on its planes of symmetry bears a quarter of the force. The tool goes down and waits;
steps of half a second in a light body leave no inertia, and the penalty of the depth at the end of the step (at rest the
same as the mean over it) makes every step one of Newton's method for the body in balance with the tool.

Usage: plot_hertz.py [--argil PROGRAM] [-o STEM] [--quick]          writes STEM.csv, STEM.png and STEM.pdf
"""
import argparse
import csv
import json
import math
import subprocess
import tempfile
from pathlib import Path

import argil_plot as ap
from argil_plot import np, plt

ROOT = Path(__file__).resolve().parent.parent
YOUNG, POISSON = 1e5, 0.3  # [Pa], [–]
REDUCED = YOUNG / (1 - POISSON**2)
CONTACT_RADIUS = 0.002  # a [m]
STEEPNESS = 0.1  # a/R of the sphere; slope of the cone: the closed forms are those of small slopes
HALF_WIDTH = 240 * CONTACT_RADIUS  # of the block, and its height [m]
PERIOD = 0.5  # [s]
APPROACH, REST = 4, 10  # [ticks]
SETTLED = 0.01  # change of the force in the last step, over the closed form; what flickers more is not drawn
FINE_TOOL = 1.5  # edges of the tool for each cell of the body


def shape_of(tool):
    """Depth [m], force [N], and height of the tool over its tip at a distance r from its axis."""
    a = CONTACT_RADIUS
    if tool == "sphere":
        radius = a / STEEPNESS
        depth = a**2 / radius
        return depth, 4 / 3 * REDUCED * math.sqrt(radius * depth**3), lambda r: radius - np.sqrt(radius**2 - r**2)
    if tool == "punch":
        depth = 0.05 * a
        return depth, 2 * REDUCED * a * depth, lambda r: 0 * r
    depth = math.pi / 2 * a * STEEPNESS  # a = 2/π d tan α
    return depth, 2 / math.pi * REDUCED * depth**2 / STEEPNESS, lambda r: STEEPNESS * r


def spaced(cells_per_radius, cells):
    """From 0: `cells` equal cells, then growing ones up to HALF_WIDTH; on finer meshes they grow more slowly."""
    fine, growth = CONTACT_RADIUS / cells_per_radius, 1 + 2 / cells_per_radius
    x = [fine * i for i in range(cells + 1)]
    growing = math.ceil(math.log(1 + (HALF_WIDTH - x[-1]) * (growth - 1) / (fine * growth)) / math.log(growth))
    widths = np.array([fine * growth**(i + 1) for i in range(growing)])
    widths *= (HALF_WIDTH - x[-1]) / widths.sum()
    return np.array(x + list(x[-1] + np.cumsum(widths)))


def round_off(x, y):
    """Nodes of squares about the axis go towards circles, those of the square of half width a onto the rim of the contact:
    a force that is singular there is no matter for cells that it cuts in two. None on the axis and beyond 3a moves."""
    half, radius = np.maximum(x, y), np.maximum(np.hypot(x, y), 1e-300)
    share = np.minimum(half / CONTACT_RADIUS, np.maximum(0, 1.5 - half / (2 * CONTACT_RADIUS)))
    scale = 1 + share * (half / radius - 1)
    return x * scale, y * scale


def write_block(stem, cells_per_radius):
    """Graded block as TetGen's .node and .ele, its top at z = 0: cells of a/cells around the contact, six tets each."""
    side = spaced(cells_per_radius, math.ceil(1.25 * cells_per_radius))
    down = -spaced(cells_per_radius, cells_per_radius)[::-1]
    x, y, z = np.meshgrid(side, side, down, indexing="ij")
    x, y = round_off(x, y)
    nodes = np.stack([x.ravel(), y.ravel(), z.ravel()], axis=1)
    number = np.arange(len(nodes)).reshape(x.shape)
    n, m = len(side) - 1, len(down) - 1
    tets = []
    for path, order in (((0, 1, 2), 1), ((1, 2, 0), 1), ((2, 0, 1), 1), ((0, 2, 1), -1), ((1, 0, 2), -1), ((2, 1, 0), -1)):
        at = [0, 0, 0]
        corners = [number[:n, :n, :m]]
        for axis in path:
            at[axis] += 1
            corners.append(number[at[0]:n + at[0], at[1]:n + at[1], at[2]:m + at[2]])
        if order < 0:
            corners[1], corners[2] = corners[2], corners[1]
        tets.append(np.stack([c.ravel() for c in corners], axis=1))
    tets = np.concatenate(tets)
    with open(f"{stem}.node", "w", encoding="ascii") as out:
        out.write(f"{len(nodes)} 3 0 0\n")
        out.writelines(f"{i} {p[0]:.17g} {p[1]:.17g} {p[2]:.17g}\n" for i, p in enumerate(nodes))
    with open(f"{stem}.ele", "w", encoding="ascii") as out:
        out.write(f"{len(tets)} 4 0\n")
        out.writelines(f"{i} {t[0]} {t[1]} {t[2]} {t[3]}\n" for i, t in enumerate(tets))
    return len(tets)


def write_tool(file, height, reach, rings):
    """Disc of `rings` rings of triangles, ring i of 6i, bent to the tool's underside, and a lid above it. No vertex lies
    on the planes of symmetry, where it would belong to the block's side as much as to its top."""
    aside, turn = 0.03 * reach / rings, 0.037
    points, faces = [(aside, 1.5 * aside, float(height(1.8 * aside)))], []
    start = [0]
    for ring in range(1, rings + 1):
        start.append(len(points))
        r = reach * ring / rings
        for k in range(6 * ring):
            angle = 2 * math.pi * k / (6 * ring) + turn
            points.append((r * math.cos(angle), r * math.sin(angle), float(height(r))))
    for ring in range(1, rings + 1):
        outer, inner = 6 * ring, max(1, 6 * (ring - 1))
        k = j = 0
        while k < outer or j < (inner if ring > 1 else 0):
            a = start[ring] + k % outer
            b = start[ring - 1] + j % inner
            if ring == 1 or k * inner <= j * outer and k < outer:
                faces.append((a, b, start[ring] + (k + 1) % outer))
                k += 1
            else:
                faces.append((a, b, start[ring - 1] + (j + 1) % inner))
                j += 1
    rim = start[rings]
    lid = len(points)
    points += [(x, y, 5 * CONTACT_RADIUS) for x, y, _ in points[rim:]] + [(0, 0, 5 * CONTACT_RADIUS)]
    count = 6 * rings
    for k in range(count):
        a, b, c, d = rim + k, rim + (k + 1) % count, lid + k, lid + (k + 1) % count
        faces += [(a, b, d), (a, d, c), (c, d, len(points) - 1)]
    with open(file, "w", encoding="ascii") as out:
        out.writelines(f"v {x:.17g} {y:.17g} {z:.17g}\n" for x, y, z in points)
        out.writelines(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in faces)


def press(argil, folder, tool, cells, stiffness, element):
    """Force at the hand over the closed form; `stiffness`: of a pair over E* a, or a `contact` of a scenario."""
    depth, exact, height = shape_of(tool)
    block = folder / f"block{cells}"
    if not block.with_suffix(".ele").exists():
        write_block(block, cells)
    reach = CONTACT_RADIUS * (1.0 if tool == "punch" else 1.5)
    write_tool(folder / "tool.obj", height, reach, round(FINE_TOOL * cells * reach / CONTACT_RADIUS))
    with open(folder / "press.csv", "w", encoding="ascii") as out:
        out.write("# argil-trace: 1\n# device: press\n# units: m\ntime_s,x_m,y_m,z_m,qx,qy,qz,qw,mode\n")
        for tick in range(APPROACH + REST):
            z = 0.05 * depth - 1.05 * depth * min(1.0, tick / APPROACH)
            out.write(f"{tick * PERIOD:.3f},0,0,{z:.17g},0,0,0,1,push\n")
    far = 1 - 1e-9
    held = [{"kind": "plane", "normal": normal, "offset_m": 0, **{f"fixes_{other}": False for other in free}}
            for normal, free in (([1, 0, 0], "yz"), ([0, 1, 0], "xz"))]
    held += [{"kind": "half_space", "normal": normal, "offset_m": -far * HALF_WIDTH}
             for normal in ([0, 0, 1], [-1, 0, 0], [0, -1, 0])]
    scenario = {
        "about": f"A rigid {tool} pressed slowly into a large elastic block.",
        "body": {"mesh": {"file": f"{block.name}.ele"}, "fixed": held},
        "material": {"youngs_modulus_Pa": YOUNG, "poissons_ratio": POISSON, "density_kg_per_m3": 1,
                     "clay_kernel": {"form": "off"}, "plasticity": {"enabled": False}},
        "tool": {"shape": {"kind": "mesh", "file": "tool.obj"}},
        "contact": stiffness if isinstance(stiffness, dict) else {
            "penalty": "discrete", "law": "pairs", "vertex_face_stiffness_N_per_m": stiffness * REDUCED * CONTACT_RADIUS,
            "edge_edge_stiffness_N_per_m": stiffness * REDUCED * CONTACT_RADIUS},
        "dynamics": {"model": "linear", "element": element,
                     "solver": {"kind": "pcg_jacobi", "max_iterations": 100000}},
        "haptics": {"period_s": PERIOD, "water_period_ticks": 1, "frame_period_ticks": 1000},
        "trace": {"file": "press.csv"},
    }
    (folder / "press.json").write_text(json.dumps(scenario))
    subprocess.run([argil, "run", folder / "press.json", "--quiet", "-o", folder / "press.h5"], check=True)
    with ap.open_result(folder / "press.h5") as data:
        force = 4 * data["haptic/force"][:, 2]
    return force[-1] / exact, abs(force[-1] - force[-2]) / exact


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", maxsplit=1)[0])
    parser.add_argument("--argil", type=Path, default=ROOT / "build/bin/argil", metavar="PROGRAM")
    parser.add_argument("-o", "--output", type=Path, default=ROOT / "results/contact/hertz", metavar="STEM")
    parser.add_argument("--quick", action="store_true", help="without the finest meshes")
    options = parser.parse_args()
    meshes = (("p1", 2), ("p2", 2), ("p1", 4))
    cases = [(tool, element, cells, 1) for element, cells in meshes for tool in ("sphere", "punch", "cone")]
    cases += [("sphere", "p1", 4, stiffness) for stiffness in (0.03, 0.1, 0.3)]
    if not options.quick:
        cases += [(tool, element, cells, 1) for element, cells in (("p2", 4), ("p1", 8))
                  for tool in ("sphere", "punch", "cone")]
        cases.append(("punch", "p2", 8, 1))
    rows = []
    with tempfile.TemporaryDirectory() as name:
        for tool, element, cells, stiffness in cases:
            rows.append((tool, element, cells, stiffness,
                         *press(options.argil, Path(name), tool, cells, stiffness, element)))
            print(*rows[-1], flush=True)
    save(rows, options.output)


def save(rows, output):
    with open(output.with_suffix(".csv"), "w", newline="", encoding="ascii") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["tool", "element", "cells_per_contact_radius", "pair_stiffness_over_Ea",
                        "force_over_closed_form", "last_change"])
        table.writerows([*row[:4], f"{row[4]:.4f}", f"{row[5]:.1e}"] for row in rows)
    ap.save(draw([row for row in rows if row[5] < SETTLED]), output)


def draw(rows):
    figure, (mesh, penalty) = plt.subplots(1, 2, figsize=(180 * ap.MILLIMETRES, 90 * ap.MILLIMETRES), sharey=True)
    for i, tool in enumerate(("sphere", "punch", "cone")):
        for element, dash in (("p1", "-"), ("p2", (0, (5, 1.5)))):
            line = sorted((r[2], r[4]) for r in rows if r[0] == tool and r[1] == element and r[3] == 1)
            if line:
                mesh.plot(*zip(*line), color=ap.COLOURS[i], linestyle=dash, marker="o", markersize=4,
                          markerfacecolor=None if element == "p1" else "white", label=f"{tool}, {element}")
    line = sorted((r[3], r[4]) for r in rows if r[0] == "sphere" and r[1] == "p1" and r[2] == 4)
    penalty.plot(*zip(*line), color=ap.COLOURS[0], marker="o", markersize=4, label="sphere, p1, 4 cells")
    for axes in (mesh, penalty):
        axes.axhline(1, color=ap.GREY, linewidth=0.8)
        axes.set_xscale("log")
        axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.2), ncol=3)
    mesh.set_xticks([2, 4, 8], ["2", "4", "8"])
    mesh.minorticks_off()
    mesh.set_xlabel("cells per contact radius [–]")
    penalty.set_xlabel("stiffness of a pair over E* a [–]")
    mesh.set_ylabel("force at the hand over the closed form [–]")
    return figure


if __name__ == "__main__":
    main()
