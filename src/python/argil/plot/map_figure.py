"""A map of `argil stability`: what became of each run over one or two parameters, the boundaries found, and the limits
of theory.
"""
import csv
import math
import re
from typing import NamedTuple

import matplotlib.pyplot as plt

from ..errors import InputError
from .style import COLOURS, DASHES, GREY, MILLIMETRES, entries_of, math_words, number_log_axis, put_legend

# outcome → words, colour, mark
OUTCOMES = {
    "accurate": ("stable and accurate", COLOURS[2], "o"), "wrong": ("stable but wrong", COLOURS[4], "s"),
    "growing_energy": ("gains energy", COLOURS[0], "X"), "chatter": ("chatters at the hand", COLOURS[3], "D"),
    "inverted": ("a tet turns inside out", COLOURS[1], "v"), "not_converged": ("no solution found", COLOURS[5], "P"),
    "failed": ("ended for another reason", "black", "x"), "refused": ("refused before the start", GREY, "o"),
    "killed": ("killed", "black", "+"), "unknown": ("has nothing to be compared with", GREY, "1")}
ERROR_TOP = 10.0  # errors above are drawn there
ERROR_BOTTOM = 1e-6  # and those below there
HOLLOW = ("refused",)
NARROW = 10.0  # highest over lowest error below which their axis is linear, from 0
READABLE = {"ticks of 1 ms": (1.0, "ms"), "0.1 mm/s": (1e-4, "m/s")}  # units of tables → a scale and a reader's unit


class Quantity(NamedTuple):
    """An axis, as it is read: what a table's number becomes there."""

    name: str
    unit: str
    scale: float = 1.0
    offset: float = 0.0  # in the table's unit

    def of(self, row, key):
        return self.scale * (number(row, key) + self.offset)

    def label(self):
        return self.name + (f" [{self.unit}]" if self.unit else "")


def read_quantity(words):
    """Of "NAME [UNIT]" or of "NAME, less 0.025 m [m]", which says that the table's numbers lack so much."""
    name, unit = re.fullmatch(r"(.*?)(?: \[(.*)\])?", words).groups()
    scale, unit = READABLE.get(unit, (1.0, unit or ""))
    less = re.fullmatch(r"(.*), less ([\d.]+) m", name)
    return Quantity(less[1], "mm", 1e3, float(less[2])) if less and unit == "m" else Quantity(name, unit, scale)


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


def draw_runs(axes, runs, x, height):
    is_compared = any(row["force_error"] for row in runs)
    for outcome, (words, colour, mark) in OUTCOMES.items():
        mine = [row for row in runs if row["outcome"] == outcome]
        if mine:
            words = words if is_compared or outcome != "accurate" else "stable"
            axes.plot([x.of(row, "x") for row in mine], [height(row) for row in mine], linestyle="none", marker=mark, markersize=4.5,
                      color=colour, markerfacecolor="white" if outcome in HOLLOW else colour, label=words, clip_on=False, zorder=3)


def draw_limits(axes, rows, x, y):
    """y: None where the map is a line."""
    names = dict.fromkeys(row["outcome"] for row in rows)
    for place, name in enumerate(names):
        mine = [row for row in rows if row["outcome"] == name]
        style = {"color": "black", "linewidth": 1.0, "linestyle": DASHES[2 + place % 4], "label": math_words(name), "zorder": 2.5}
        if y:
            axes.plot([x.of(row, "x") for row in mine], [y.of(row, "y") for row in mine], **style)
        else:
            for k, row in enumerate(mine):
                axes.axvline(x.of(row, "x"), **dict(style, label=style["label"] if k == 0 else None))


def draw_forces(axes, runs, names, x, y):
    """Marks: the method; lines: the reference. One colour for each y. Handles and labels for the legend."""
    rows_of_y = list(dict.fromkeys(row["y"] for row in runs))
    entries = [(plt.Line2D([], [], color="black", linestyle="none", marker="o", markersize=3.5), names[0]),
               (plt.Line2D([], [], color="black"), names[1])]
    for place, text in enumerate(rows_of_y):
        mine = sorted((row for row in runs if row["y"] == text), key=lambda row: number(row, "x"))
        at = [x.of(row, "x") for row in mine]
        colour = COLOURS[place % len(COLOURS)]
        axes.plot(at, [number(row, "reference_peak_force_N") for row in mine], color=colour, zorder=2)
        axes.plot(at, [number(row, "peak_force_N") for row in mine], linestyle="none", marker="o", markersize=3.5,
                  color=colour, zorder=3)
        if len(rows_of_y) > 1:
            entries.append((plt.Line2D([], [], color=colour), f"{y.name} {y.of(mine[0], 'y'):g} {y.unit}"))
    axes.set_ylabel("largest hand force [N]")
    axes.set_ylim(bottom=0.0)
    return entries


def draw_errors(axes, runs, boundaries, x):
    """Of a map that is a line: the error of each run over x."""
    known = [min(max(number(row, "force_error"), ERROR_BOTTOM), ERROR_TOP) for row in runs if row["force_error"]]
    is_whole = len(known) == len(runs)
    draw_runs(axes, runs, x, lambda row: min(max(number(row, "force_error"), ERROR_BOTTOM), ERROR_TOP) if row["force_error"] else ERROR_TOP)
    for k, row in enumerate(boundaries):  # wide and pale: a limit of theory may lie on it
        axes.axvline(x.of(row, "x"), color=GREY, linewidth=4.0, alpha=0.4, label="boundary found" if k == 0 else None, zorder=1)
    if is_whole and max(known) < NARROW * min(known):
        axes.set_ylim(0.0, 1.15 * max(known))
    else:
        axes.set_yscale("log")
        number_log_axis(axes.yaxis, known + [ERROR_TOP] * (not is_whole), most=1)
    axes.set_ylabel("error of the hand force,\nrelative L² [–]" + ("" if is_whole else " (at the top: none known)"))


def draw(rows, provenance, title, force_names=None):
    runs, boundaries, limits = ([row for row in rows if row["kind"] == kind] for kind in ("run", "boundary", "limit"))
    x, y = (read_quantity(provenance.get(key, "")) for key in "xy")
    is_plane = any(row["y"] for row in runs)
    panels = 2 if force_names else 1
    figure, all_axes = plt.subplots(panels, 1, sharex=True, squeeze=False,
                                    figsize=(130 * MILLIMETRES, (20 + 60 * panels) * MILLIMETRES))
    axes = all_axes[0, 0]
    if is_plane:
        draw_runs(axes, runs, x, lambda row: y.of(row, "y"))
        axes.plot([x.of(row, "x") for row in boundaries], [y.of(row, "y") for row in boundaries], linestyle="none",
                  marker="|", markersize=14, color="black", markeredgewidth=1.6, label="boundary found", zorder=4)
        axes.set_ylabel(math_words(y.label()))
    else:
        draw_errors(axes, runs, boundaries, x)
    scales = provenance.get("logarithmic", "")
    if "x" in scales:
        axes.set_xscale("log")
        number_log_axis(axes.xaxis, [x.of(row, "x") for row in runs], most=1)
    if "y" in scales:
        axes.set_yscale("log")
        number_log_axis(axes.yaxis, [y.of(row, "y") for row in runs])
    draw_limits(axes, limits, x, y if is_plane else None)
    axes.set_title(title)
    handles, labels = entries_of(axes)
    if force_names:
        entries = draw_forces(all_axes[1, 0], runs, force_names, x, y)
        handles, labels = handles + [handle for handle, _ in entries], labels + [label for _, label in entries]
    all_axes[-1, 0].set_xlabel(math_words(x.label()))
    legend = put_legend(figure, handles, labels, fontsize=7)
    for handle in legend.legendHandles:
        if handle.get_marker() == "|":
            handle.set_markersize(8)
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
