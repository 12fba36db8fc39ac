#!/usr/bin/python3
"""Rebuilds the charts of accuracy against cost and the maps of where methods fail: results/chart and results/stability, from
the studies in scenarios/studies. Runs that were finished before, by the same build, are not run again.

Usage: make_studies.py [NAME ...] [--build BUILD] [--jobs N]      NAME: chart_slide, map_poisson, …; none: all
"""
import argparse
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
TITLES = {
    "chart_light_press": "A light press", "chart_deep_bend": "A deep push that bends a post",
    "chart_wet_undrained": "Wet clay whose water cannot leave", "chart_slide": "A slide with friction",
    "chart_wet_press": "A wet sphere that presses, felt on the skin",
    "map_explicit_step": "Explicit steps", "map_implicit_step": "Long implicit steps",
    "map_contact_stiffness": "Contact force held over the step (the paper)",
    "map_contact_stiffness_implicit": "Contact in the solve", "map_poisson": "Four-node tets towards ν = ½",
    "map_poisson_p1_nodal": "Volumes averaged at nodes, towards ν = ½",
    "map_dilute_pole": "The paper's formula for wet clay",
    "map_rotation": "Linear strain under rotation", "map_creep_step": "Literal plastic flow",
    "map_hand_damping": "A held force and the hand's damping",
    "map_kernel_step": "Clay kernel once a step", "map_approach_speed": "A fast tool",
    "map_sliver": "A flat tet under the tool", "map_wet_contrast": "Wet clay beside dry"}
# Maps whose reference is what argil does instead: the forces of both are drawn too.
REMEDIES = {"map_dilute_pole": ("eq. 6", "Mori–Tanaka"), "map_rotation": ("linear strain", "corotational strain"),
            "map_kernel_step": ("kernel once a step", "kernel at a rate"),
            "map_poisson": ("four-node tets", "ten-node tets")}


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", maxsplit=1)[0])
    parser.add_argument("names", nargs="*", choices=[*TITLES, []], metavar="NAME")
    parser.add_argument("--build", type=Path, default=ROOT / "build", metavar="BUILD")
    parser.add_argument("--jobs", type=int, default=2, metavar="N")
    options = parser.parse_args()
    argil = options.build / "bin" / "argil"
    if not argil.is_file():
        sys.exit(f"{argil}: is not there; scripts/build makes it")
    failed = []
    for name in options.names or TITLES:
        kind, _, stem = name.partition("_")
        command, folder, plot = (("chart", "chart", "plot_chart.py") if kind == "chart"
                                 else ("stability", "stability", "plot_map.py"))
        table = ROOT / "results" / folder / stem
        table.parent.mkdir(parents=True, exist_ok=True)
        words = [argil, command, ROOT / "scenarios" / "studies" / f"{name}.json", "--output", table, "--runs",
                 options.build / "studies", "--jobs", str(options.jobs), "--quiet"]
        if command == "stability":
            words += ["--failures", ROOT / "scenarios" / "failures"]
        print(name, flush=True)
        if subprocess.run(words, check=False).returncode != 0:  # it has said why
            failed.append(name)
            continue
        forces = ["--forces", *REMEDIES[name]] if name in REMEDIES else []
        subprocess.run([ROOT / "scripts" / plot, table.with_suffix(".csv"), "--title", TITLES[name], *forces], check=True,
                       stdout=subprocess.DEVNULL)
    if failed:
        sys.exit(f"not made: {', '.join(failed)}")


if __name__ == "__main__":
    main()
