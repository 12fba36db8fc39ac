#!/usr/bin/python3
"""How deep runs dent the skin and how far they draw it out, along the outward normal of the body at rest.

Usage: paper_skin.py RESULT.h5 … [-o skin.json]     → {"NAME": {"deepest_dent_m", "dent_left_m", …}}

Deepest and highest are over all frames and vertices, what is left is of the last frame.
"""
import argparse
import json
from pathlib import Path

import argil_plot as ap
import render_shots
from argil_plot import np


def measure(file):
    with ap.open_result(file) as result:
        skinned = len(result["mesh/skin_triangles"]) > 0
        rest = render_shots.rest_points(result, skinned)
        triangles = result["mesh/skin_triangles" if skinned else "mesh/surface_triangles"][:]
        normals = render_shots.vertex_normals(rest, triangles)
        moved = [np.einsum("vi,vi->v", frame["skin_position" if skinned else "position"][:] - rest, normals)
                 for frame in ap.frames_of(result)]
    dents, bumps = [-each.min() for each in moved], [each.max() for each in moved]
    return {"deepest_dent_m": max(0.0, *dents), "dent_left_m": max(0.0, dents[-1]),
            "highest_bump_m": max(0.0, *bumps), "bump_left_m": max(0.0, bumps[-1])}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("files", nargs="+", metavar="RESULT.h5")
    parser.add_argument("-o", "--output", default="skin.json", metavar="FILE.json")
    options = parser.parse_args()
    figures = {Path(file).stem: {name: float(f"{value:.4g}") for name, value in measure(file).items()}
               for file in options.files}
    Path(options.output).write_text(json.dumps(figures, indent=2) + "\n", encoding="utf-8")
    print(options.output)


if __name__ == "__main__":
    main()
