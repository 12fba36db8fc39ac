#!/usr/bin/python3
"""What a sculpting session changed: how far the skin moved in each of three places, the clay's volume and the force.

Usage: paper_sculpt.py RESULT.h5 [-o STEM]     → STEM.json, STEM.png, STEM.pdf

The places are those of traces/sculpt.csv on the dinosaur of 200 mm. A place has moved as far as the vertex of the skin there
that moved most between the first and the last frame. The volume is that within the skin; that of the cells is given beside it,
for those at the start do not enclose what the skin does.
"""
import argparse
import json
from pathlib import Path

import argil_plot as ap
import render_shots
from argil_plot import np, plt
from argil.plot.force_figure import moving_mean
from argil.plot.style import entries_of, put_legend

PLACES = {  # name: a place on the body at rest, and how near to it a vertex belongs to it [m]
    "horn": ((0.002, 0.0, 0.087), 0.02), "hole": ((-0.006, -0.0304, 0.062), 0.02), "tail": ((-0.09, 0.0, 0.06), 0.02)}


def volume_of(cells, frame):
    """Of a frame's cells [m³]."""
    a, b, c, d = (frame["position"][:][cells["tets"][:][:, k]] for k in range(4))
    return float(np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a).sum() / 6.0)


def volume_within(points, triangles):
    """Of a closed surface whose triangles look outward [m³]."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    return float(np.einsum("ij,ij->", np.cross(a, b), c) / 6.0)


def measure(result):
    """Times [s] and the skin's volumes [m³] of the frames, and the figures of the session."""
    frames = ap.frames_of(result)
    rest = render_shots.rest_points(result, True)
    moved = np.linalg.norm(frames[-1]["skin_position"][:] - frames[0]["skin_position"][:], axis=1)
    times = np.array([frame.attrs["time"] for frame in frames])
    cells = np.array([volume_of(ap.cells_of(result, frame), frame) for frame in frames])
    triangles = result["mesh/skin_triangles"][:]
    volumes = np.array([volume_within(frame["skin_position"][:], triangles) for frame in frames])
    force, mode = ap.force_norm(result), result["haptic/mode"][:]
    figures = {
        "moved_m": {name: float(moved[np.linalg.norm(rest - place, axis=1) < reach].max())
                    for name, (place, reach) in PLACES.items()},
        "volume_change": float(volumes[-1] / volumes[0] - 1.0),
        "largest_volume_change": float(np.abs(volumes / volumes[0] - 1.0).max()),
        "cells_over_skin": {"first": float(cells[0] / volumes[0]), "last": float(cells[-1] / volumes[-1])},
        "new_cells": len(result.get("epochs", {})), "tets_first": len(result["mesh/tets"]),
        "tets_last": len(ap.cells_of(result, frames[-1])["tets"]),
        "largest_force_N": {name: float(force[mode == number].max(initial=0.0)) for number, name in enumerate(ap.MODES)},
        "water_given_kg": float(result["physics/water_added"][-1]),
        "water_taken_kg": float(result["physics/water_removed"][-1]),
        "seconds": float(result["haptic/time"][-1]), "outcome": str(np.char.decode(np.bytes_(result.attrs["outcome"])))}
    return times, volumes, figures


def draw(result, times, volumes):
    figure, (above, below) = plt.subplots(2, 1, figsize=(160 * ap.MILLIMETRES, 95 * ap.MILLIMETRES), sharex=True)
    time, mode = result["haptic/time"][:], result["haptic/mode"][:]
    above.plot(time, moving_mean(time, ap.force_norm(result), 0.05), color=ap.COLOURS[0])
    below.plot(times, 100.0 * (volumes / volumes[0] - 1.0), color=ap.COLOURS[1])
    epochs = [epoch.attrs["tick"] * result.attrs["haptic_period_s"] for epoch in result.get("epochs", {}).values()]
    if epochs:
        below.plot(epochs, np.zeros(len(epochs)), linestyle="", marker="|", markersize=10, color=ap.GREY, label="new cells")
    for number, name in enumerate(ap.MODES):
        for first, last in ap.spans(mode == number):
            above.axvspan(time[first], time[last], color=ap.COLOURS[number % len(ap.COLOURS)], alpha=0.12, linewidth=0)
            if time[last] - time[first] > 0.8:
                above.text(0.5 * (time[first] + time[last]), 0.97, name, transform=above.get_xaxis_transform(), ha="center",
                           va="top", fontsize=8, color=ap.GREY)
    above.set_ylabel("force at the hand [N]\nmean over 0.05 s")
    above.set_ylim(bottom=0.0)
    below.set_ylabel("change of the\nskin's volume [%]")
    below.set_xlabel("time [s]")
    below.margins(x=0)
    if epochs:
        put_legend(figure, *entries_of(below))
    return figure


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("file", metavar="RESULT.h5")
    parser.add_argument("-o", "--output", default="sculpted", metavar="STEM", help="default: %(default)s")
    options = parser.parse_args()
    with ap.open_result(options.file) as result:
        times, volumes, figures = measure(result)
        Path(f"{options.output}.json").write_text(json.dumps(figures, indent=2) + "\n", encoding="utf-8")
        print(f"{options.output}.json")
        ap.save(draw(result, times, volumes), options.output)


if __name__ == "__main__":
    main()
