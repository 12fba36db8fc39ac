#!/usr/bin/python3
"""Draws a figure of `argil sweep collect` against one setting, a line for each combination of the others.

Usage: plot_sweep.py TABLE.csv [-o STEM] [--x body.initial_saturation] [--y peak_force_N]     writes STEM.png, STEM.pdf
"""
import argparse
import csv
from pathlib import Path

import argil_plot as ap
from argil_plot import COLOURS, DASHES, MILLIMETRES, plt

LABELS = {"body.initial_saturation": "water: initial saturation [–]",
          "peak_force_N": "largest force at the hand [N]", "material.youngs_modulus_Pa": "E [Pa]",
          "material.plasticity.yield": "yield strain [–]"}


def read_table(file):
    with open(file, encoding="utf-8") as lines:
        return list(csv.DictReader(line for line in lines if not line.startswith("#")))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("table", type=Path)
    parser.add_argument("-o", "--output", type=Path)
    parser.add_argument("--x", default="body.initial_saturation")
    parser.add_argument("--y", default="peak_force_N")
    options = parser.parse_args()
    rows = [row for row in read_table(options.table) if row["outcome"] == "done"]
    names = list(rows[0])
    settings = [name for name in names[2:names.index("peak_force_N")] if name != options.x]
    figure, axes = plt.subplots(figsize=(150 * MILLIMETRES, 85 * MILLIMETRES))
    first = sorted({row[settings[0]] for row in rows}, key=float) if settings else [""]
    second = sorted({row[settings[1]] for row in rows}, key=float) if len(settings) > 1 else [""]
    for i, one in enumerate(first):
        for j, other in enumerate(second):
            line = sorted((float(row[options.x]), float(row[options.y])) for row in rows
                          if (not settings or row[settings[0]] == one) and (len(settings) < 2 or row[settings[1]] == other))
            axes.plot(*zip(*line), color=COLOURS[i % len(COLOURS)], linestyle=DASHES[(j + 1) % len(DASHES)], marker="o", markersize=3)
    for i, one in enumerate(first):
        axes.plot([], [], color=COLOURS[i % len(COLOURS)], label=f"{LABELS.get(settings[0], settings[0])} {float(one):g}" if settings else "")
    if len(settings) > 1:
        for j, other in enumerate(second):
            axes.plot([], [], color="black", linestyle=DASHES[(j + 1) % len(DASHES)],
                      label=f"{LABELS.get(settings[1], settings[1])} {float(other):g}")
    axes.set_xlabel(LABELS.get(options.x, options.x))
    axes.set_ylabel(LABELS.get(options.y, options.y))
    axes.set_ylim(bottom=0.0)
    axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
    ap.save(figure, options.output or options.table.with_suffix(""))


if __name__ == "__main__":
    main()
