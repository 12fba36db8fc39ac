#!/usr/bin/python3
"""Cage and skin: what the embedding errs by, and how the pressed skin depends on the cage's resolution.

Usage: paper_cages.py COARSE.h5 … FINE.h5 [-o STEM]. Runs of one scenario with other target_tets, of one or more
bodies (files are named cage_BODY_TETS.h5); the finest of each is the measure. Writes STEM.csv, STEM.png, STEM.pdf.
"""
import argparse
import csv
from pathlib import Path

import argil_plot as ap
from argil_plot import np, plt
from render_shots import list_weights

NEAREST = 128  # tets around a skin vertex, by their centroids
ROUNDING = 1e-13  # of a place [m]


def find_carriers(frames, tets):
    """Weights [vertices, 4] of each skin vertex in the tet that carries it best, and what it errs by [vertices, m].

    Error: distance of the vertex from Σ wᵢ xᵢ with the weights of the first frame, the largest over all frames. A
    wrong tet strains otherwise than the skin, and errs. Where nothing strains, and several carry the vertex to
    rounding, the one with the highest least weight.
    """
    first = frames[0]["skin_position"][:]
    nearest, weights = list_weights(frames[0]["position"][:], tets, first, NEAREST)
    error = np.zeros(nearest.shape)
    for frame in frames:
        carried = np.einsum("vni,vnij->vnj", weights, frame["position"][:][tets[nearest]])
        error = np.maximum(error, np.linalg.norm(carried - frame["skin_position"][:][:, None], axis=2))
    is_carrier = error <= np.maximum(error.min(axis=1, keepdims=True), ROUNDING)
    rows, best = np.arange(len(first)), np.where(is_carrier, weights.min(axis=2), -np.inf).argmax(axis=1)
    return weights[rows, best], error[rows, best]


def measure(file):
    """Figures of one run."""
    with ap.open_result(file) as result:
        frames = ap.frames_of(result)
        tets = result["mesh/tets"][:]
        first = frames[0]["skin_position"][:]
        weights, error = find_carriers(frames, tets)
        return {"body": Path(file).stem.split("_")[1], "tets": len(tets), "skin_vertices": len(first),
                "lowest_weight": weights.min(), "embedding_error_m": error.max(),
                "peak_N": ap.force_norm(result).max(), "displacement": frames[-1]["skin_position"][:] - first}


def draw(rows):
    figure, (left, right) = plt.subplots(1, 2, figsize=(160 * ap.MILLIMETRES, 65 * ap.MILLIMETRES))
    for number, body in enumerate(sorted({row["body"] for row in rows})):
        mine = [row for row in rows if row["body"] == body]
        style = {"color": ap.COLOURS[number], "linestyle": ap.DASHES[number],
                 "marker": "os"[number % 2], "markersize": 3}
        left.loglog([r["tets"] for r in mine[:-1]], [1e3 * r["skin_difference_m"] for r in mine[:-1]], label=body,
                    **style)
        right.semilogx([r["tets"] for r in mine], [r["peak_N"] for r in mine], label=body, **style)
    left.set_yticks([0.02, 0.05, 0.1, 0.2, 0.5], ["0.02", "0.05", "0.1", "0.2", "0.5"])
    left.set_ylabel("final skin: rms distance\nfrom the finest [mm]")
    right.set_ylabel("peak force [N]")
    right.set_ylim(bottom=0.0)
    for axes in (left, right):
        axes.set_xticks([1000, 2500, 5000, 10000], ["1000", "2500", "5000", "10000"])
        axes.minorticks_off()
        axes.set_xlabel("tets of the cage [–]")
        axes.legend()
    return figure


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("files", nargs="+", metavar="RESULT.h5")
    parser.add_argument("-o", "--output", default="cages", metavar="STEM")
    options = parser.parse_args()
    rows = [measure(file) for file in options.files]
    for row in rows:
        finest = max((r for r in rows if r["body"] == row["body"]), key=lambda r: r["tets"])
        if finest["displacement"].shape != row["displacement"].shape:
            ap.refuse("runs of one body have different skins")
        difference = row["displacement"] - finest["displacement"]
        row["skin_difference_m"] = np.sqrt((difference**2).sum(axis=1).mean())
        row["largest_displacement_m"] = np.linalg.norm(row["displacement"], axis=1).max()
    names = [name for name in rows[0] if name != "displacement"]
    with open(f"{options.output}.csv", "w", newline="", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(names)
        table.writerows([f"{row[name]:.4g}" if isinstance(row[name], float) else row[name] for name in names]
                        for row in rows)
    print(f"{options.output}.csv")
    ap.save(draw(rows), options.output)


if __name__ == "__main__":
    main()
