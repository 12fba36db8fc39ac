#!/usr/bin/python3
"""The estimated error of the force at the hand beside the true one: scenes on the cells that they come with, beside ten-node tets that are
small where the tool comes. These are run twice, on coarser and on finer cells; how far the two differ is the doubt of the truth. A tick counts
where the true error is above 0.5 % of the scene's peak and five times the doubt. Effectivity is estimate over true error; clay that flows
may be within 0.3 and 3, all else within 0.5 and 2.

Usage: error_bar_table.py ARGIL [-o STEM] [--scene NAME ...]       writes STEM.csv, STEM.png and STEM.pdf
"""
import argparse
import json
import subprocess
import tempfile
from pathlib import Path
from typing import NamedTuple

import argil_plot as ap
import h5py
from argil_plot import np, plt
from argil.plot.style import entries_of, put_legend
from table_file import write_table

ROOT = Path(__file__).resolve().parent.parent
EDGE, RADIUS, GAP = 0.04, 0.01, 0.0002  # of the block, of the ball, before the touch [m]
PUNCH = 0.004  # half the side of the punch's face [m]
PEAK_SHARE = 0.005  # of the peak, above which an error counts
DOUBT_TIMES = 5  # of the truth, above which an error counts


class Scene(NamedTuple):
    """One scene: what is run, what makes it the truth, coarser and finer, and within which factor the estimate should be."""

    name: str
    scenario: dict  # or the name of a file in scenarios
    places: np.ndarray = None  # of the tool, one a tick [m]
    settings: tuple = ()
    truths: tuple = ()
    factor: float = 2.0


def press(depth, ticks, radius=RADIUS):
    t = np.arange(ticks + 1) / ticks
    return np.c_[0 * t + 0.0006, 0 * t - 0.0007, EDGE + radius + GAP - (GAP + depth) * t]


def slide(depth, ticks):
    t = np.arange(ticks + 1) / ticks
    down, along = np.minimum(1, t / 0.4), np.maximum(0, t - 0.4) / 0.6
    return np.c_[-0.004 + 0.008 * along, 0 * t + 0.0003, EDGE + RADIUS + GAP - (GAP + depth) * down]


def block(cells="graded", tets=4000, friction=0.0, strength=None, tool=None, model="hencky"):
    plasticity = {"strength_Pa": strength} if strength else {"enabled": False}
    return {
        "about": "A tool on a block.",
        "body": {"cells": {"kind": cells, "remesh": "never"},
                 "shape": {"kind": "box", "size_m": EDGE, "target_tets": tets, "skin_triangles": 0},
                 "fixed": [{"kind": "plane", "normal": [0, 0, 1], "offset_m": 0}]},
        "material": {"youngs_modulus_Pa": 1e5, "poissons_ratio": 0.3, "plasticity": plasticity, "clay_kernel": {"form": "off"}},
        "tool": {"shape": tool or {"kind": "sphere", "radius_m": RADIUS}},
        "contact": {"friction": friction},
        "dynamics": {"rayleigh_stiffness_s": 0.0005, "model": model},
        "haptics": {"frame_period_ticks": 1000, "chatter_limit": 1},
    }


def near(size, first):
    return (f"/body/cells/near_tool_m={size}", f"/body/shape/target_tets={first}")


def ten_nodes(coarser, finer):
    """Sizes of the cells near the tool [m]."""
    element = ("/dynamics/element=p2", "/body/cells/kind=graded")
    return tuple((*element, *near(size, first)) for size, first in ((coarser, 800), (finer, 1200)))


def fitted(coarser, finer):
    """Numbers of tets, and a step a tick."""
    words = ("/dynamics/element=p2", "/haptics/physics_period_ticks=1")
    return tuple((*words, f"/body/shape/target_tets={number}") for number in (coarser, finer))


def write_punch(folder):
    """A flat punch with a square face, its point at the middle of the face."""
    r = PUNCH
    corners = [(x, y, z) for z in (0, 2 * r) for y in (-r, r) for x in (-r, r)]
    faces = [(1, 3, 4), (1, 4, 2), (5, 6, 8), (5, 8, 7), (1, 2, 6), (1, 6, 5), (3, 7, 8), (3, 8, 4), (1, 5, 7), (1, 7, 3), (2, 4, 8), (2, 8, 6)]
    lines = [f"v {x} {y} {z}" for x, y, z in corners] + [f"f {a} {b} {c}" for a, b, c in faces]
    (folder / "punch.obj").write_text("\n".join(lines) + "\n", encoding="ascii")


def list_scenes():
    stylus = {"kind": "stylus", "tip_radius_m": 0.001, "radius_m": 0.006, "length_m": 0.012}
    dry = ("/trace/duration_s=0.9", "/haptics/physics_period_ticks=2", "/material/clay_kernel/form=off", "/body/cells/remesh=never")
    wet = (*dry, "/body/initial_saturation=0.8")
    ball, fine_press = press(0.003, 200), ten_nodes(0.002, 0.0014)
    return [
        Scene("ball, even cells", block("even", 8000), ball, truths=fine_press),
        Scene("ball, graded cells", block(), ball, truths=fine_press),
        Scene("stylus", block(tool=stylus), press(0.0015, 200, 0.001), truths=ten_nodes(0.0008, 0.0005)),
        Scene("punch", block(tool={"kind": "mesh", "file": "punch.obj"}), press(0.001, 200, 0.0), near(0.0015, 4000),
              ten_nodes(0.0016, 0.001)),
        Scene("slide with friction", block(friction=0.5), slide(0.002, 300), near(0.002, 4000), ten_nodes(0.0026, 0.0018)),
        Scene("clay", block(strength=1100), press(0.004, 400), truths=ten_nodes(0.0026, 0.0018), factor=3.0),
        Scene("demonstration, dry", "demo_dino_dry.json", None, dry, fitted(5000, 10000), 3.0),
        Scene("demonstration, wet", "demo_dino_dry.json", None, wet, fitted(5000, 10000), 3.0),
        Scene("ball, ten nodes", block("even", 1000), ball, ("/dynamics/element=p2",), fine_press),
    ]


def run(argil, folder, scene, settings):
    """Force, its estimated error, its parts [N] and the number of tets."""
    if scene.places is None:
        scenario = ROOT / "scenarios" / scene.scenario
    else:
        time = np.arange(len(scene.places)) * 1e-3
        np.savetxt(folder / "motion.csv", np.c_[time, scene.places], delimiter=",", header="t,x,y,z", comments="", fmt="%.9g")
        write_punch(folder)
        scenario = folder / "scene.json"
        scenario.write_text(json.dumps({**scene.scenario, "trace": {"file": "motion.csv"}}), encoding="ascii")
    words = [word for setting in ("/haptics/force_error=true", *settings) for word in ("--set", setting)]
    subprocess.run([argil, "run", scenario, "-q", "-o", folder / "run.h5", *words], check=True)
    with h5py.File(folder / "run.h5") as file:
        return (np.linalg.norm(file["haptic/force"][:], axis=1), file["haptic/force_error"][:], file["haptic/force_error_parts"][:],
                len(file["mesh/tets"]))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", maxsplit=1)[0])
    parser.add_argument("argil", type=Path)
    parser.add_argument("-o", "--output", type=Path, default=ROOT / "results/fidelity/error_bar", metavar="STEM")
    parser.add_argument("--scene", nargs="+", metavar="NAME", help="only these")
    options = parser.parse_args()
    rows = []
    scenes = [scene for scene in list_scenes() if not options.scene or scene.name in options.scene]
    figure, axes = plt.subplots(3, 3, figsize=(10.5, 8.4), layout="constrained")
    all_ticks = []
    for scene, axis in zip(scenes, axes.flat):
        with tempfile.TemporaryDirectory() as name:
            force, estimate, parts, number = run(options.argil.resolve(), Path(name), scene, scene.settings)
            (coarser, *_), (finer, _, _, many) = (run(options.argil.resolve(), Path(name), scene, (*scene.settings, *settings))
                                                  for settings in scene.truths)
        true, doubt = np.abs(force - finer), np.abs(finer - coarser)
        counts = (force > 0) & (finer > 0) & (true > PEAK_SHARE * force.max()) & (true > DOUBT_TIMES * doubt)
        effectivity = estimate / np.maximum(true, 1e-12)
        is_inside = ((effectivity > 1 / scene.factor) & (effectivity < scene.factor))[counts]
        all_ticks.extend(is_inside)
        quantiles = [f"{q:.2f}" for q in np.quantile(effectivity[counts], (0.05, 0.5, 0.95))] if counts.any() else [""] * 3
        peak = np.argmax(force)
        rows.append([scene.name, number, many, f"{force.max():.3f}", f"{100 * true[peak] / force[peak]:.1f}",
                     f"{100 * estimate[peak] / force[peak]:.1f}", *(f"{100 * part / force[peak]:.2f}" for part in parts[peak]),
                     f"{100 * doubt[peak] / force[peak]:.1f}", f"{scene.factor:g}", ((force > 0) & (finer > 0)).sum(), counts.sum(),
                     *quantiles, f"{100 * np.mean(is_inside):.0f}" if counts.any() else ""])
        print(*rows[-1], sep=", ", flush=True)
        time = np.arange(1, len(force) + 1)
        axis.plot(time, true, "k-", linewidth=1.2, label="true error")
        axis.plot(time, estimate, color=ap.COLOURS[0], linewidth=1, label="estimate")
        axis.fill_between(time, estimate / scene.factor, estimate * scene.factor, color=ap.COLOURS[0], alpha=0.15, linewidth=0,
                          label="estimate, times and over the scene's factor")
        axis.plot(time, doubt, ":", color="grey", linewidth=1, label="doubt of the truth")
        axis.set(title=f"{scene.name}: {number} tets", xlabel="time [ms]", ylabel="error of the force [N]", ylim=(0, None))
        touching = time[(force > 0) | (finer > 0)]
        if len(touching):
            axis.set_xlim(touching[0], touching[-1])
        axis.title.set_fontsize(9)
    print(f"{100 * np.mean(all_ticks):.1f} % of {len(all_ticks)} ticks are within their factor")
    for axis in axes.flat[len(scenes):]:
        axis.remove()
    put_legend(figure, *entries_of(axes.flat[0]))
    write_table(options.output.with_suffix(".csv"), ["scene", "tets", "tets_of_truth", "peak_N", "error_at_peak_percent",
                "estimate_at_peak_percent", "mesh_percent", "step_percent", "contact_percent", "solver_percent", "left_out_percent",
                "doubt_at_peak_percent", "factor", "touching_ticks", "counted_ticks", "effectivity_5_percent", "effectivity_median",
                "effectivity_95_percent", "within_percent"], rows)
    ap.save(figure, options.output)


if __name__ == "__main__":
    main()
