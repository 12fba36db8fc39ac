#!/usr/bin/python3
"""The bare elastic step of argil beside that of another program on the same meshes, load and tolerance, one after the
other: results/bench/elastic.csv.

    scripts/bench_elastic.py PROGRAM BOX.msh ... [--build BUILD] [--runs 7] [--steps 100]

PROGRAM makes the step of tests/bench/peers/bench_elastic.cpp. It is called with MESH STEP_S STEPS TOLERANCE THREADS and prints
`med=` and `min=` of a step [ms], `step=` iterations a step, and `tip` [mm], which says how far the patch went. Each runs
as often; `ratio` is the median over the runs of argil's median step over the other's in the same run.
"""
import argparse
import os
import re
import statistics
import subprocess
from pathlib import Path

import provenance

ROOT = Path(__file__).resolve().parent.parent
STEP = "1e-3"  # [s]
TOLERANCES = ("0.01", "0.001")


def run_argil(bench, mesh, steps, tolerance, threads):
    """Tets, then median and least time of a step [ms], iterations a step, way of the patch [mm]."""
    out = subprocess.run([bench, mesh, tolerance, steps, threads], capture_output=True, text=True, check=True).stdout
    tets, _, _, median, least, iterations, down = out.strip().split(",")
    return tets, (float(median), float(least), float(iterations), float(down))


def run_other(program, mesh, steps, tolerance, threads):
    out = subprocess.run([program, mesh, STEP, steps, tolerance, threads], capture_output=True, text=True, check=True,
                         env={**os.environ, "OMP_NUM_THREADS": threads}).stdout
    return tuple(float(re.search(word + r"\s*(-?[\d.]+)", out)[1]) for word in ("med=", "min=", "step=", "tip"))


def write_row(name, tets, threads, tolerance, runs, ratio):
    medians = [run[0] for run in runs]
    return (f"{name},{tets},{threads},{tolerance},{statistics.median(medians):.3f},{min(medians):.3f},"
            f"{min(run[1] for run in runs):.3f},{runs[0][2]:.1f},{runs[0][3]:.6g},{ratio}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=Path)
    parser.add_argument("meshes", nargs="+", type=Path)
    parser.add_argument("--build", default=ROOT / "build", type=Path)
    parser.add_argument("--runs", default=7, type=int)
    parser.add_argument("--steps", default="100")
    options = parser.parse_args()
    bench = options.build / "bin" / "bench_elastic"
    lines = [f"# {provenance.describe()}; {options.runs} runs of {options.steps} steps, one program after the other; ms_median and "
             "ms_least_median over the runs, ms_least of all steps",
             "program,tets,threads,tolerance,ms_median,ms_least_median,ms_least,iterations,down_mm,ratio"]
    for mesh in options.meshes:
        for threads in ("1", "2"):
            for tolerance in TOLERANCES:
                own, others = [], []
                for _ in range(options.runs):
                    tets, figures = run_argil(bench, mesh, options.steps, tolerance, threads)
                    own.append(figures)
                    others.append(run_other(options.program.resolve(), mesh, options.steps, tolerance, threads))
                ratio = statistics.median(a[0] / b[0] for a, b in zip(own, others))
                lines.append(write_row("argil", tets, threads, tolerance, own, f"{ratio:.2f}"))
                lines.append(write_row("other", tets, threads, tolerance, others, ""))
                print("\n".join(lines[-2:]), flush=True)
    (ROOT / "results" / "bench" / "elastic.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
