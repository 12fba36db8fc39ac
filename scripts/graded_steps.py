#!/usr/bin/python3
"""What a step costs on cells that are small where the tool comes, beside cells of one size: the first presses of
scenarios/study_soft_dino.json on elastic clay, and scenarios/study_light_press.json; the whole body solved for, and with /fidelity auto
the region that the hand feels. Times are the processor's, of one thread; that of an iteration is what a finer tolerance costs more.

Usage: graded_steps.py ARGIL [-o FILE.csv]      writes results/contact/graded_steps.csv
"""
import argparse
import subprocess
import tempfile
from pathlib import Path

import h5py

from table_file import write_table

ROOT = Path(__file__).resolve().parent.parent
NUMBERS = (5000, 15000)
FINER = 1e-4  # tolerance of the solver, which keeps to diagonal blocks
SCENES = {
    "demonstration": ("study_soft_dino.json", ["/dynamics/model=hencky", "/material/plasticity/enabled=false", "/material/clay_kernel/form=off",
                                             "/trace/duration_s=1.5", "/haptics/physics_period_ticks=5"]),
    "light press": ("study_light_press.json", ["/contact/law=pressure", "/trace/duration_s=0.21", "/haptics/physics_period_ticks=1"]),
}
FIDELITIES = {"full": ["/fidelity/mode=full", "/dynamics/extent=whole"], "auto": ["/fidelity/mode=auto", "/dynamics/extent=auto"]}


def run(argil, folder, name, settings):
    """Tets, nodes solved for and iterations of the steps that have some, and seconds of the processor."""
    words = [word for setting in settings for word in ("--set", setting)]
    result = folder / "result.h5"
    subprocess.run([argil, "run", ROOT / "scenarios" / name, "-o", result, "--quiet", "--threads", "1", *words], check=True)
    with h5py.File(result) as file:
        iterations = file["physics/iterations"][:]
        solved = iterations > 0
        return len(file["mesh/tets"]), file["physics/active_nodes"][:][solved], iterations[solved], float(file["timing/cpu"][0])


def measure(argil, folder, scene, cells, number, fidelity):
    """Tets, nodes solved for, iterations a step, milliseconds an iteration and a step."""
    name, settings = SCENES[scene]
    settings = [*settings, *FIDELITIES[fidelity], f"/body/cells/kind={cells}", f"/body/shape/target_tets={number}",
                "/dynamics/solver/kind=pcg_jacobi"]
    tets, nodes, iterations, seconds = run(argil, folder, name, settings)
    more = run(argil, folder, name, [*settings, f"/dynamics/solver/tolerance={FINER}"])
    one = (more[3] - seconds) / (more[2].sum() - iterations.sum())
    return [tets, f"{nodes.mean():.0f}", f"{iterations.mean():.1f}", f"{1e3 * one:.3f}", f"{1e3 * seconds / len(iterations):.2f}"]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", maxsplit=1)[0])
    parser.add_argument("argil", type=Path)
    parser.add_argument("-o", "--output", type=Path, default=ROOT / "results/contact/graded_steps.csv", metavar="FILE")
    options = parser.parse_args()
    argil = options.argil.resolve()
    rows = []
    with tempfile.TemporaryDirectory() as name:
        for scene in SCENES:
            for fidelity in FIDELITIES:
                for number in NUMBERS:
                    for cells in ("even", "graded"):
                        rows.append([scene, fidelity, cells, *measure(argil, Path(name), scene, cells, number, fidelity)])
                        print(*rows[-1], flush=True)
    write_table(options.output, ["scene", "fidelity", "cells", "tets", "nodes_solved_for", "iterations_a_step", "ms_an_iteration", "ms_a_step"],
                rows)


if __name__ == "__main__":
    main()
