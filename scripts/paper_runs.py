#!/usr/bin/python3
"""What the runs of the paper's page felt, how deep they dent the skin and draw it out, and what made them.

Usage: paper_runs.py RESULT.h5 … [-o run.json]     → {"NAME": {"outcome", "peak_N", "deepest_dent_m", …, "commit", …}}

Forces are those of ticks that push or pull. Dents and bumps are along the outward normal of the body at rest: deepest and
highest are over all frames and vertices, what is left is of the last frame. What the file says already of other runs stays.
"""
import argparse
import json
from pathlib import Path

import argil_plot as ap
import render_shots
from argil_plot import np
from summarise import read_text


def measure_skin(result):
    """Dents and bumps [m] of a result."""
    skinned = len(result["mesh/skin_triangles"]) > 0
    rest = render_shots.rest_points(result, skinned)
    triangles = result["mesh/skin_triangles" if skinned else "mesh/surface_triangles"][:]
    normals = render_shots.vertex_normals(rest, triangles)
    moved = [np.einsum("vi,vi->v", frame["skin_position" if skinned else "position"][:] - rest, normals)
             for frame in ap.frames_of(result)]
    dents, bumps = [-each.min() for each in moved], [each.max() for each in moved]
    return {"deepest_dent_m": max(0.0, *dents), "dent_left_m": max(0.0, dents[-1]),
            "highest_bump_m": max(0.0, *bumps), "bump_left_m": max(0.0, bumps[-1])}


def measure(file):
    """Figures and origin of one run, which may have failed."""
    with ap.open_result(file) as result:
        felt = ap.force_norm(result) * ap.is_deforming(result)
        build = dict(line.split(" ", 1) for line in read_text(result, "build").splitlines() if " " in line)
        outcome = result.attrs["outcome"]
        numbers = {"peak_N": felt.max(initial=0.0), "impulse_N_s": felt.sum() * result.attrs["haptic_period_s"],
                   **measure_skin(result)}
        return {"outcome": outcome.decode() if isinstance(outcome, bytes) else str(outcome),
                **{name: float(f"{value:.4g}") for name, value in numbers.items()},
                "commit": build.get("commit", ""), "compiler": build.get("compiler", ""),
                **{name: read_text(result, name) for name in ("scenario_sha256", "trace_sha256")}}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("files", nargs="+", metavar="RESULT.h5")
    parser.add_argument("-o", "--output", type=Path, default=Path("run.json"), metavar="FILE.json")
    options = parser.parse_args()
    figures = json.loads(options.output.read_text(encoding="utf-8")) if options.output.is_file() else {}
    figures |= {Path(file).stem: measure(file) for file in options.files}
    options.output.write_text(json.dumps(dict(sorted(figures.items())), indent=2) + "\n", encoding="utf-8")
    print(options.output)


if __name__ == "__main__":
    main()
