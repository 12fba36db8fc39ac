#!/usr/bin/python3
"""A rigid ball pressed slowly into a large block of elastic, perfectly plastic clay and drawn off again, on cells that are finer and
finer under the ball, beside solutions by another program: force over depth, dent and pile-up left behind.

A reference is {"cases": [{"name", "ball_radius_m", "youngs_modulus_Pa", "poissons_ratio", "c_u_Pa", "depth_m": [...], "force_N": [...],
"residual_depth_m", "pile_up_m"}, ...]}: quasi-static, without friction, von Mises's law on Kirchhoff stress, logarithmic strain.

Usage: clay_press.py ARGIL REFERENCE.json [-o STEM]         writes STEM.csv, STEM.png and STEM.pdf
"""
import argparse
import csv
import json
import subprocess
import tempfile
from pathlib import Path

import argil_plot as ap
import h5py
from argil_plot import np, plt
from argil.plot.style import entries_of, put_legend

ROOT = Path(__file__).resolve().parent.parent
EDGE_OVER_RADIUS = 25  # of the block, over the ball's radius
GAP_OVER_RADIUS = 1 / 30
DOWN, UP = 1.0, 0.5  # [s]
SECTORS = 8
AWAY = (0.02, 0.03)  # of the ball's radius, off the block's axis: not over a node
# Size of the cells near the ball over its radius of contact; how fast they grow; tets of one size to begin with. None: as chosen where
# nothing is said of cells.
CELLS = (None, (1 / 2, 0.8, 1000), (1 / 3, 0.8, 1500), (1 / 4.7, 0.8, 2000))


def write_scene(folder, case):
    radius, depth = case["ball_radius_m"], case["depth_m"][-1]
    edge = EDGE_OVER_RADIUS * radius
    gap = GAP_OVER_RADIUS * radius
    t = np.arange(0, DOWN + UP + 1e-9, 0.001)
    height = np.where(t <= DOWN, gap - (gap + depth) * t / DOWN, -depth + (depth + gap) * (t - DOWN) / UP)
    place = np.c_[t, np.full_like(t, AWAY[0] * radius), np.full_like(t, AWAY[1] * radius), edge + radius + height]
    np.savetxt(folder / "press.csv", place, delimiter=",", header="t,x,y,z", comments="")
    scenario = {
        "about": "A ball pressed into clay whose strength is a stress.",
        "body": {"shape": {"kind": "box", "size_m": edge, "skin_triangles": 0}, "cells": {"kind": "graded"},
                 "fixed": [{"kind": "plane", "normal": [0, 0, 1], "offset_m": 0}]},
        "material": {"youngs_modulus_Pa": case["youngs_modulus_Pa"], "poissons_ratio": case["poissons_ratio"],
                     "clay_kernel": {"form": "off"}, "plasticity": {"strength_Pa": case["c_u_Pa"]}},
        "tool": {"shape": {"kind": "sphere", "radius_m": radius}},
        "haptics": {"frame_period_ticks": 500},
        "trace": {"file": "press.csv"},
    }
    (folder / "press.json").write_text(json.dumps(scenario), encoding="utf-8")
    return folder / "press.json", edge


def measure_dent(file, edge, radius):
    """Of the last frame [m]: how deep the dent is, how high its rim, the mean of its highest vertices in eight sectors about the ball's
    axis, and the highest vertex of all."""
    frame = file["frames"][sorted(file["frames"])[-1]]
    epoch = frame.attrs.get("epoch", 0)
    cells = file["mesh"] if epoch == 0 else file[f"epochs/{epoch:06d}/mesh"]
    x = frame["position"][:][np.unique(cells["surface_triangles"][:])]
    x = x[(x[:, 2] > 0.5 * edge) & (np.abs(x[:, :2]).max(axis=1) < 0.45 * edge)]
    height = x[:, 2] - edge
    sector = np.floor(np.arctan2(x[:, 1] - AWAY[1] * radius, x[:, 0] - AWAY[0] * radius) / (2 * np.pi) * SECTORS) % SECTORS
    rim = np.mean([height[sector == k].max() for k in range(SECTORS)])
    return -height.min(), rim, height.max()


def run(argil, folder, case, cells):
    """Depth [m] and force [N] on the way down, dent, pile-up and highest vertex that are left [m], tets, seconds of the processor."""
    scenario, edge = write_scene(folder, case)
    result, settings = folder / "press.h5", ()
    if cells:
        size, growth, first = cells
        near = size * (case["ball_radius_m"] * case["depth_m"][-1])**0.5
        settings = (f"/body/cells/near_tool_m={near:.4g}", f"/body/cells/growth={growth}", f"/body/shape/target_tets={first}")
    words = [word for setting in settings for word in ("--set", setting)]
    subprocess.run([argil, "run", scenario, "-o", result, "--quiet", *words], check=True)
    with h5py.File(result) as file:
        depth = edge + case["ball_radius_m"] - file["haptic/tool_position"][:, 2]
        force = file["haptic/force"][:, 2]
        dent, pile_up, highest = measure_dent(file, edge, case["ball_radius_m"])
        tets, seconds = len(file["mesh/tets"]), float(file["timing/cpu"][0])
    deepest = np.argmax(depth)
    return depth[:deepest + 1], force[:deepest + 1], dent, pile_up, highest, tets, seconds


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", maxsplit=1)[0])
    parser.add_argument("argil", type=Path)
    parser.add_argument("reference", type=Path)
    parser.add_argument("-o", "--output", type=Path, default=ROOT / "results/clay/press", metavar="STEM")
    options = parser.parse_args()
    cases = json.loads(options.reference.read_text(encoding="utf-8"))["cases"]
    rows = []
    figure, axes = plt.subplots(1, len(cases), figsize=(4.2 * len(cases), 3.4), squeeze=False, layout="constrained")
    for case, axis in zip(cases, axes[0]):
        known_depth, known = np.array(case["depth_m"]), np.array(case["force_N"])
        # Cells a radius of contact: of the size under the ball, over the root of radius times depth.
        for number, cells in enumerate(CELLS):
            with tempfile.TemporaryDirectory() as name:
                depth, force, dent, pile_up, highest, tets, seconds = run(options.argil.resolve(), Path(name), case, cells)
            size = (cells[0] if cells else np.inf) * (case["ball_radius_m"] * known_depth[-1])**0.5
            off = np.interp(known_depth, depth, force) - known
            is_fine = (case["ball_radius_m"] * known_depth)**0.5 >= 4 * size
            fine = f"{100 * np.max(np.abs(off[is_fine] / known[is_fine])):.1f}" if is_fine.any() else ""
            peak = known.max()
            rows.append([case["name"], tets, f"{1 / cells[0]:.1f}" if cells else "as chosen", f"{100 * off[-1] / known[-1]:.1f}",
                         f"{100 * np.max(np.abs(off)) / peak:.1f}", fine,
                         f"{100 * (dent / case['residual_depth_m'] - 1):.1f}", f"{100 * (pile_up / case['pile_up_m'] - 1):.1f}",
                         f"{100 * (highest / case['pile_up_m'] - 1):.1f}", f"{seconds:.0f}"])
            print(*rows[-1], flush=True)
            words = f"{1 / cells[0]:.1f} cells a radius of contact" if cells else "cells as chosen"
            axis.plot(1e3 * depth, force, linewidth=1, color=ap.COLOURS[number], linestyle=ap.DASHES[number], label=words)
        axis.plot(1e3 * known_depth, known, "k.", markersize=5, label="the reference program")
        axis.set(xlim=(0, None), ylim=(0, None), xlabel="depth [mm]", ylabel="force [N]",
                 title=f"ball of {1e3 * case['ball_radius_m']:g} mm, $c_u$ = {case['c_u_Pa'] / 1e3:.3g} kPa")
    put_legend(figure, *entries_of(*axes[0]))
    options.output.parent.mkdir(parents=True, exist_ok=True)
    with open(options.output.with_suffix(".csv"), "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["case", "tets", "cells_per_contact_radius", "force_at_the_end_percent", "largest_over_peak_percent",
                         "largest_from_four_cells_percent", "dent_percent", "pile_up_percent", "highest_vertex_percent", "cpu_s"])
        writer.writerows(rows)
    ap.save(figure, options.output)


if __name__ == "__main__":
    main()
