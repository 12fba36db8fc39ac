#!/usr/bin/python3
"""How exactly a step must be solved: the force at the hand of the whole dry demonstration at a physics step a tick, for
tolerances of the solver, against that of 1e-10: results/bench/tolerance.csv.

    scripts/bench_tolerance.py [--build BUILD] [--tets 2390 10000] [-o TABLE.csv]

With and without the clay kernel, and with `fidelity: auto`, which stops its solves by itself, against the full model's
converged force. The meshes are those of bench_step, which are made for about so many tets. Largest error over the force's
peak, root mean square error over that of the force while the tool touches, what peak and impulse (∫|F| dt) are off by, the
largest error over the bound that auto keeps, 1 % of the force or 0.02 N, and the mean iterations of all steps but those
that solve nothing. One thread.
"""
import argparse
import csv
import subprocess
import tempfile
from pathlib import Path

import h5py
import numpy as np
import provenance

ROOT = Path(__file__).resolve().parent.parent
SCENARIO = ROOT / "scenarios" / "demo_dino_dry.json"
CONVERGED = "1e-10"
TOLERANCES = ("1e-1", "1e-2", "1e-3", "1e-4")
DEFAULT = "1e-3"
KERNELS = {"rate": [], "off": ["/material/clay_kernel/form=off"]}
COLUMNS = ("tets", "clay_kernel", "fidelity", "tolerance", "largest_error_over_peak", "rms_error_over_rms", "peak_off_by",
           "impulse_off_by", "error_over_bound", "cg_iterations_mean", "peak_N", "rms_N")


def run(argil, folder, settings):
    """Forces, mean number of iterations, number of tets."""
    sets = [word for setting in ["/haptics/physics_period_ticks=1", *settings] for word in ("--set", setting)]
    subprocess.run([argil, "run", SCENARIO, "-q", "-o", folder / "out.h5", "--threads", "1", *sets], check=True,
                   stdout=subprocess.DEVNULL)
    with h5py.File(folder / "out.h5") as file:
        iterations = file["physics/iterations"][:]
        return file["haptic/force"][:], iterations[iterations > 0].mean(), len(file["mesh/tets"])


def compare(force, reference):
    """The columns that say how far a force is off."""
    size, lean = (np.linalg.norm(f, axis=1) for f in (reference, force))
    error = np.linalg.norm(force - reference, axis=1)
    touches = size > 0
    rms = np.sqrt((size[touches] ** 2).mean())
    figures = {"largest_error_over_peak": error.max() / size.max(),
               "rms_error_over_rms": np.sqrt((error[touches] ** 2).mean()) / rms,
               "peak_off_by": abs(lean.max() / size.max() - 1), "impulse_off_by": abs(lean.sum() / size.sum() - 1),
               "error_over_bound": (error / np.maximum(0.02, 0.01 * size)).max()}
    return {name: f"{value:.2e}" for name, value in figures.items()} | {"peak_N": f"{size.max():.3f}", "rms_N": f"{rms:.3f}"}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", default=ROOT / "build", type=Path)
    parser.add_argument("--tets", nargs="+", default=[2390, 10000], type=int)
    parser.add_argument("-o", "--output", default=ROOT / "results" / "bench" / "tolerance.csv", type=Path, metavar="TABLE.csv")
    options = parser.parse_args()
    argil = options.build / "bin" / "argil"
    about = provenance.describe()
    with open(options.output, "w", encoding="utf-8", newline="") as out, tempfile.TemporaryDirectory() as folder:
        out.write(f"# {about}, one thread; scenarios/{SCENARIO.name} at a physics step a tick; force at the hand against "
                  f"that of the full model at {CONVERGED}\n")
        table = csv.DictWriter(out, COLUMNS, lineterminator="\n")
        table.writeheader()
        for target in options.tets:
            for kernel, settings in KERNELS.items():
                settings = [f"/body/shape/target_tets={target}", *settings]

                def force_at(tolerance, fidelity="full"):
                    return run(argil, Path(folder), [*settings, f"/dynamics/solver/tolerance={tolerance}",
                                                     f"/fidelity/mode={fidelity}"])

                reference, _, _ = force_at(CONVERGED)
                for fidelity, tolerance in [*(("full", t) for t in TOLERANCES), ("auto", DEFAULT)]:
                    force, iterations, tets = force_at(tolerance, fidelity)
                    row = {"tets": tets, "clay_kernel": kernel, "fidelity": fidelity, "tolerance": tolerance,
                           **compare(force, reference), "cg_iterations_mean": f"{iterations:.1f}"}
                    table.writerow(row)
                    out.flush()
                    print(", ".join(f"{key} {row[key]}" for key in COLUMNS), flush=True)


if __name__ == "__main__":
    main()
