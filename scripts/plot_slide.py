#!/usr/bin/python3
"""Slides a sphere over a facetted sphere that does not give way, and draws how the force at the hand ripples: by the pressure law; by
that of pairs, with the blended direction, with the nearest face alone, with the discrete penalty; found every tick, or held for 14 ticks.

The tool's centre runs at 0.1 m/s on a circle, 1 mm nearer than where the round shapes would touch, so that between
round shapes the force would be the same all the way.

Usage: plot_slide.py [--argil PROGRAM] [-o STEM]          writes STEM.png, STEM.pdf and STEM.csv
"""
import argparse
import csv
import json
import subprocess
import tempfile
from pathlib import Path

import argil_plot as ap
from argil_plot import np, plt

ROOT = Path(__file__).resolve().parent.parent
BODY_RADIUS, TOOL_RADIUS, DEPTH, SPEED = 0.03, 0.008, 0.001, 0.1  # [m], [m/s]
APPROACH = 0.1  # [s]
SECONDS = 0.7
PERIOD = 0.001  # [s]

SCENARIO = {
    "about": "A sphere slides over a facetted sphere; with round shapes the force would not change.",
    "body": {"shape": {"kind": "sphere", "size_m": 2 * BODY_RADIUS, "target_tets": 3000},
             "fixed": [{"kind": "half_space", "normal": [0, 0, 1], "offset_m": 0.01}]},
    "material": {"youngs_modulus_Pa": 1e5, "poissons_ratio": 0.3, "density_kg_per_m3": 1500,
                 "clay_kernel": {"form": "off"}},
    # A drying tool feels a force and deforms nothing; the body is dry.
    "tool": {"shape": {"kind": "sphere", "radius_m": TOOL_RADIUS, "subdivisions": 2}, "mode": "dry"},
    "contact": {"vertex_face_stiffness_N_per_m": 100, "edge_edge_stiffness_N_per_m": 100},
    "haptics": {"physics_period_ticks": 14, "water_period_ticks": 14, "frame_period_ticks": 700},
    "trace": {"file": "slide.csv"},
}

# name → (law, penalty, face_blend, between_frames)
CASES = {
    "pressure, every tick": ("pressure", "continuous", 0.25, "re_evaluate"),
    "pressure, held 14 ticks": ("pressure", "continuous", 0.25, "hold"),
    "pairs, every tick, faces blended": ("pairs", "continuous", 0.25, "re_evaluate"),
    "pairs, every tick, nearest face": ("pairs", "continuous", 0, "re_evaluate"),
    "pairs, every tick, discrete": ("pairs", "discrete", 0, "re_evaluate"),
    "pairs, held 14 ticks, nearest face (paper)": ("pairs", "continuous", 0, "hold"),
    "pairs, held 14 ticks, discrete": ("pairs", "discrete", 0, "hold"),
}
SHOWN = ["pressure, every tick", "pairs, every tick, faces blended", "pairs, held 14 ticks, nearest face (paper)"]


def write_trace(file):
    across = np.array([0.3, 0.2, 0.93]) / np.linalg.norm([0.3, 0.2, 0.93])  # a circle askew to the mesh
    along = np.cross(across, [0.1, 0.9, -0.2])
    along /= np.linalg.norm(along)
    with open(file, "w", encoding="ascii") as out:
        out.write("# argil-trace: 1\n# device: arc\n# units: m\n# rate_hz: 1000\n"
                  "time_s,x_m,y_m,z_m,qx,qy,qz,qw,mode\n")
        for tick in range(round(SECONDS / PERIOD)):
            t = tick * PERIOD
            depth = DEPTH * min(1.0, 3.0 * t / APPROACH - 2.0)
            distance = BODY_RADIUS + TOOL_RADIUS - depth
            angle = max(0.0, t - APPROACH) * SPEED / distance - 0.8
            x = [0.0, 0.0, BODY_RADIUS] + distance * (np.cos(angle) * across + np.sin(angle) * along)
            out.write(f"{t:.3f},{x[0]:.9f},{x[1]:.9f},{x[2]:.9f},0,0,0,1,dry\n")


def run_case(argil, folder, case):
    law, penalty, blend, between = case
    result = folder / "slide.h5"
    subprocess.run([argil, "run", folder / "slide.json", "--quiet", "-o", result,
                    "--set", f"/contact/law={law}", "--set", f"/contact/penalty={penalty}",
                    "--set", f"/contact/face_blend={blend}", "--set", f"/haptics/between_frames={between}"], check=True)
    with ap.open_result(result) as data:
        return data["haptic/time"][:], data["haptic/force"][:]


def measure(time, force):
    """Path [mm], the force's size over its mean, and the ripple: changes from tick to tick over the mean [%]."""
    sliding = (time > APPROACH + 0.02) & (time < SECONDS - 0.02)
    size = np.linalg.norm(force, axis=1)[sliding]
    change = np.linalg.norm(np.diff(force[sliding], axis=0), axis=1) / size.mean()
    ripple = {"mean_N": size.mean(), "rms_change_percent": 100 * np.sqrt(np.mean(change**2)),
              "largest_change_percent": 100 * change.max()}
    return 1e3 * SPEED * (time[sliding] - APPROACH), size / size.mean(), 100 * change, ripple


def draw(measured):
    figure, (sizes, changes) = plt.subplots(2, 1, sharex=True, figsize=(180 * ap.MILLIMETRES, 120 * ap.MILLIMETRES))
    for number, name in enumerate(SHOWN):
        path, size, change, _ = measured[name]
        style = {"color": ap.COLOURS[number], "linestyle": ap.DASHES[number]}
        sizes.plot(path, size, label=name, **style)
        changes.plot(path[1:], change, color=ap.COLOURS[number], linewidth=0.8)  # spikes: dashes would break them
    sizes.set_ylabel("force over its mean [–]")
    changes.set_ylabel("change in a tick\n[% of the mean force]")
    changes.set_xlabel("path of the tool [mm]")
    changes.set_ylim(bottom=0)
    changes.margins(x=0)
    sizes.legend(loc="lower left", bbox_to_anchor=(0, 1.0), borderaxespad=0.3)
    return figure


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", maxsplit=1)[0])
    parser.add_argument("--argil", type=Path, default=ROOT / "build/bin/argil", metavar="PROGRAM")
    parser.add_argument("-o", "--output", type=Path, default=ROOT / "results/contact/slide", metavar="STEM")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "slide.json").write_text(json.dumps(SCENARIO))
        write_trace(folder / "slide.csv")
        measured = {name: measure(*run_case(options.argil, folder, case)) for name, case in CASES.items()}
    ap.save(draw(measured), options.output)
    with open(options.output.with_suffix(".csv"), "w", newline="", encoding="ascii") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["case", *next(iter(measured.values()))[3]])
        for name, (*_, ripple) in measured.items():
            table.writerow([name, *(f"{value:.3g}" for value in ripple.values())])


if __name__ == "__main__":
    main()
