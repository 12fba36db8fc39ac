#!/usr/bin/python3
"""How exactly a step must be solved, and what that costs: the force at the hand of the whole dry demonstration at a physics
step a tick, for tolerances of the solver, against that of 1e-10, and the steps per second:
results/bench/tolerance.csv, .png and .pdf.

    scripts/bench_tolerance.py [--build BUILD] [--tets 2390 10000 42000] [-o TABLE.csv]

With and without the clay kernel (42000 tets: with it alone), and with `fidelity: auto`, which stops its solves by itself,
against the full model's converged force. The meshes are those of bench_step, which are made for about so many tets.
Largest error over the force's peak, root mean square error over that of the force while the tool touches, what peak and
impulse (∫|F| dt) are off by, the largest error over the bound that auto keeps, 1 % of the force or 0.02 N, the mean
iterations of all steps but those that solve nothing, and how many of these a second: the least of three runs on two
threads, all stages of a step.
"""
import argparse
import csv
import subprocess
import tempfile
from pathlib import Path

import argil_plot as ap
import h5py
import numpy as np
import provenance
from argil_plot import COLOURS, DASHES, GREY, MILLIMETRES, plt
from argil.plot.style import entries_of, put_legend

ROOT = Path(__file__).resolve().parent.parent
SCENARIO = ROOT / "scenarios" / "study_soft_dino.json"
CONVERGED = ["/dynamics/solver/tolerance=1e-10", "/dynamics/solver/kind=pcg_jacobi"]
TOLERANCES = ("1e-1", "1e-2", "1e-3", "1e-4")
DEFAULT = "1e-3"
KERNELS = {"rate": [], "off": ["/material/clay_kernel/form=off"]}
LARGE = 20000  # tets from which on there is but one run, with the kernel
WANTED = {2502: 3000, 10500: 1000, 42153: 200}  # steps/s on two threads
RATES = (100, 200, 500, 1000, 2000, 5000)  # on the figure's axis
REPEATS = 3
STAGES = ("contact", "water", "assemble", "solve", "kinematics", "plasticity")
COLUMNS = ("tets", "clay_kernel", "fidelity", "tolerance", "largest_error_over_peak", "rms_error_over_rms", "peak_off_by",
           "impulse_off_by", "error_over_bound", "cg_iterations_mean", "steps_per_s", "peak_N", "rms_N")


def run(argil, folder, settings):
    """Forces, mean number of iterations, steps that solve per second, number of tets."""
    sets = [word for setting in ["/haptics/physics_period_ticks=1", *settings] for word in ("--set", setting)]
    subprocess.run([argil, "run", SCENARIO, "-q", "-o", folder / "out.h5", "--threads", "2", *sets], check=True,
                   stdout=subprocess.DEVNULL)
    with h5py.File(folder / "out.h5") as file:
        iterations = file["physics/iterations"][:]
        solving = iterations[iterations > 0]
        seconds = sum(file["timing"][stage][0] for stage in STAGES)
        return file["haptic/force"][:], solving.mean(), len(solving) / seconds, len(file["mesh/tets"])


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


def measure(argil, folder, target, kernel):
    """Rows of one mesh, with or without the kernel."""
    settings = [f"/body/shape/target_tets={target}", *KERNELS[kernel]]
    reference = run(argil, folder, [*settings, *CONVERGED])[0]
    for fidelity, tolerance in [*(("full", t) for t in TOLERANCES), ("auto", DEFAULT)]:
        changed = [*settings, f"/dynamics/solver/tolerance={tolerance}", f"/fidelity/mode={fidelity}"]
        runs = [run(argil, folder, changed) for _ in range(1 if target >= LARGE else REPEATS)]
        force, iterations, _, tets = runs[0]
        yield {"tets": tets, "clay_kernel": kernel, "fidelity": fidelity, "tolerance": tolerance,
               **compare(force, reference), "cg_iterations_mean": f"{iterations:.1f}",
               "steps_per_s": f"{max(rate for _, _, rate, _ in runs):.0f}"}


def draw(rows, stem):
    """Force error against steps per second, a line a mesh, a mark a tolerance."""
    figure, axes = plt.subplots(figsize=(150 * MILLIMETRES, 85 * MILLIMETRES))
    axes.axhline(1.0, color=GREY, linewidth=0.8)
    marks = dict(zip(TOLERANCES, "osD^"))
    for tets, colour, dashes in zip(dict.fromkeys(row["tets"] for row in rows), COLOURS, DASHES):
        of_mesh = [row for row in rows if (row["tets"], row["clay_kernel"]) == (tets, "rate")]
        points = [(float(row["steps_per_s"]), 100 * float(row["largest_error_over_peak"]), row) for row in of_mesh]
        full = [point for point in points if point[2]["fidelity"] == "full"]
        axes.plot(*zip(*[point[:2] for point in full]), color=colour, linestyle=dashes, label=f"{tets} tets")
        for rate, error, row in points:
            is_auto = row["fidelity"] == "auto"
            axes.plot(rate, error, color=colour, marker="*" if is_auto else marks[row["tolerance"]], markersize=10 if is_auto else 5,
                      linestyle="none")
        if int(tets) in WANTED:
            axes.plot(WANTED[int(tets)], 1.0, color=colour, marker="|", markersize=14, markeredgewidth=2.5)
    axes.set(xscale="log", yscale="log", xlabel="physics steps per second on two threads",
             ylabel="largest error of the force, % of its peak")
    axes.set_xticks(RATES, [str(rate) for rate in RATES])
    axes.set_xticks([], minor=True)
    axes.yaxis.set_major_formatter("{x:g}")
    axes.margins(y=0.12)
    handles, labels = entries_of(axes)
    for words, style in (*((f"tolerance {tolerance}", {"marker": mark, "markersize": 5}) for tolerance, mark in marks.items()),
                         ("fidelity auto", {"marker": "*", "markersize": 10}),
                         ("wanted, at 1 %", {"marker": "|", "markersize": 9, "markeredgewidth": 2.5})):
        handles.append(plt.Line2D([], [], color=GREY, linestyle="none", **style))
        labels.append(words)
    put_legend(figure, handles, labels)
    ap.save(figure, stem)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", default=ROOT / "build", type=Path)
    parser.add_argument("--tets", nargs="+", default=[2390, 10000, 42000], type=int)
    parser.add_argument("-o", "--output", default=ROOT / "results" / "bench" / "tolerance.csv", type=Path, metavar="TABLE.csv")
    options = parser.parse_args()
    argil = options.build / "bin" / "argil"
    about = provenance.describe()
    rows = []
    with open(options.output, "w", encoding="utf-8", newline="") as out, tempfile.TemporaryDirectory() as folder:
        out.write(f"# {about}; scenarios/{SCENARIO.name} at a physics step a tick, two threads; force at the hand against "
                  "that of the full model at 1e-10\n")
        table = csv.DictWriter(out, COLUMNS, lineterminator="\n")
        table.writeheader()
        for target in options.tets:
            for kernel in KERNELS if target < LARGE else ["rate"]:
                for row in measure(argil, Path(folder), target, kernel):
                    rows.append(row)
                    table.writerow(row)
                    out.flush()
                    print(", ".join(f"{key} {row[key]}" for key in COLUMNS), flush=True)
    draw(rows, options.output.with_suffix(""))


if __name__ == "__main__":
    main()
