"""A map of `argil stability`: what became of each run over one or two parameters, the boundaries found, and the limits
of theory.
"""
import csv
import math

import matplotlib.pyplot as plt

from ..errors import InputError
from .style import COLOURS, DASHES, GREY, MILLIMETRES

# outcome → words, colour, mark
OUTCOMES = {
    "accurate": ("stable and accurate", COLOURS[2], "o"), "wrong": ("stable but wrong", COLOURS[4], "s"),
    "growing_energy": ("gains energy", COLOURS[0], "X"), "chatter": ("chatters at the hand", COLOURS[3], "D"),
    "inverted": ("a tet turns inside out", COLOURS[1], "v"), "not_converged": ("no solution found", COLOURS[5], "P"),
    "failed": ("ended for another reason", "black", "x"), "refused": ("refused before the start", GREY, "_"),
    "killed": ("killed", "black", "+"), "unknown": ("has nothing to be compared with", GREY, "1")}
ERROR_TOP = 10.0  # errors above are drawn there
ERROR_BOTTOM = 1e-6  # and those below there


def read_table(file):
    """Rows, and the provenance as a dictionary."""
    provenance, lines = {}, []
    with open(file, encoding="utf-8") as text:
        for line in text:
            if line.startswith("# "):
                name, _, value = line[2:].rstrip("\n").partition(": ")
                provenance[name] = value
            else:
                lines.append(line)
    return list(csv.DictReader(lines)), provenance


def number(row, key):
    return float(row[key]) if row[key] else math.nan


def draw_runs(axes, runs, height):
    is_compared = any(row["force_error"] for row in runs)
    for outcome, (words, colour, mark) in OUTCOMES.items():
        mine = [row for row in runs if row["outcome"] == outcome]
        if mine:
            words = words if is_compared or outcome != "accurate" else "stable"
            axes.plot([number(row, "x") for row in mine], [height(row) for row in mine], linestyle="none",
                      marker=mark, markersize=4.5, color=colour, label=words, clip_on=False, zorder=3)


def draw_limits(axes, rows, is_plane):
    names = dict.fromkeys(row["outcome"] for row in rows)
    for place, name in enumerate(names):
        mine = [row for row in rows if row["outcome"] == name]
        style = {"color": "black", "linewidth": 1.0, "linestyle": DASHES[2 + place % 4], "label": name}
        if is_plane:
            axes.plot([number(row, "x") for row in mine], [number(row, "y") for row in mine], **style)
        else:
            for k, row in enumerate(mine):
                axes.axvline(number(row, "x"), **dict(style, label=name if k == 0 else None))


def draw_forces(axes, runs, names, y_name):
    """Marks: the method; lines: the reference. One colour for each y."""
    rows_of_y = list(dict.fromkeys(row["y"] for row in runs))
    for place, y in enumerate(rows_of_y):
        mine = sorted((row for row in runs if row["y"] == y), key=lambda row: number(row, "x"))
        x = [number(row, "x") for row in mine]
        colour = COLOURS[place % len(COLOURS)]
        axes.plot(x, [number(row, "reference_peak_force_N") for row in mine], color=colour, zorder=2)
        axes.plot(x, [number(row, "peak_force_N") for row in mine], linestyle="none", marker="o", markersize=3.5,
                  color=colour, label=f"{number(mine[0], 'y'):g}" if y else None, zorder=3)
    axes.set_ylabel("largest hand force [N]")
    axes.set_ylim(bottom=0.0)
    kinds = [plt.Line2D([], [], color="black", linestyle="none", marker="o", markersize=3.5, label=names[0]),
             plt.Line2D([], [], color="black", label=names[1])]
    title = None
    if len(rows_of_y) > 1:
        kinds += axes.get_legend_handles_labels()[0]
        title = f"colours: {y_name}"
    axes.legend(handles=kinds, title=title, title_fontsize=7, loc="center left", bbox_to_anchor=(1.01, 0.5), fontsize=7)


def draw(rows, provenance, title, force_names=None):
    runs, boundaries, limits = ([row for row in rows if row["kind"] == kind] for kind in ("run", "boundary", "limit"))
    is_plane = any(row["y"] for row in runs)
    panels = 2 if force_names else 1
    figure, all_axes = plt.subplots(panels, 1, sharex=True, squeeze=False,
                                    figsize=(150 * MILLIMETRES, (25 + 60 * panels) * MILLIMETRES))
    axes = all_axes[0, 0]
    if is_plane:
        draw_runs(axes, runs, lambda row: number(row, "y"))
        axes.plot([number(row, "x") for row in boundaries], [number(row, "y") for row in boundaries], linestyle="none",
                  marker="|", markersize=14, color="black", markeredgewidth=1.6, label="boundary found", zorder=4)
        axes.set_ylabel(provenance.get("y", ""))
    else:
        def height(row):
            error = number(row, "force_error")
            return ERROR_TOP if math.isnan(error) else min(max(error, ERROR_BOTTOM), ERROR_TOP)
        draw_runs(axes, runs, height)
        for k, row in enumerate(boundaries):
            axes.axvline(number(row, "x"), color=GREY, linewidth=1.0, label="boundary found" if k == 0 else None)
        axes.set_yscale("log")
        axes.set_ylabel("error of the hand force, relative L² [–]\n(at the top: none known)")
    scales = provenance.get("logarithmic", "")
    if "x" in scales:
        axes.set_xscale("log")
    if "y" in scales:
        axes.set_yscale("log")
    draw_limits(axes, limits, is_plane)
    axes.set_title(title)
    axes.legend(loc="center left", bbox_to_anchor=(1.01, 0.5), fontsize=7)
    if force_names:
        draw_forces(all_axes[1, 0], runs, force_names, provenance.get("y", ""))
    all_axes[-1, 0].set_xlabel(provenance.get("x", ""))
    return figure


def make_figure(table, title="", force_names=None):
    """Of a table of `argil stability`. `force_names`: of the method and the reference, whose forces a second panel has
    then."""
    rows, provenance = read_table(table)
    if not rows or "kind" not in rows[0]:
        raise InputError(f"{table}: is not a table of argil stability")
    strange = {row["outcome"] for row in rows if row["kind"] == "run"} - set(OUTCOMES)
    if strange:
        raise InputError(f"{table}: has outcomes that are not known here: {', '.join(sorted(strange))}")
    if force_names and not any(row.get("reference_peak_force_N") for row in rows):
        raise InputError(f"{table}: has no forces of a reference, for its study has none; leave them out")
    return draw(rows, provenance, title, force_names)
