"""A chart of `argil chart`: error against cost, a curve a method, the Pareto front marked. Every run has its mark:
along the top those without an error, at the left those without a cost.
"""
import csv
import math
import re

import matplotlib.pyplot as plt

from ..errors import InputError
from .style import COLOURS, DASHES, GREY, MARKS, MILLIMETRES, entries_of, number_log_axis, put_legend

ERROR = "force_error"  # that is drawn unless another is asked for
LABELS = {"force_error": "error of the hand force, relative L² [–]",
          "peak_force_error": "error of the largest hand force, relative [–]",
          "displacement_error": "error of the displacement, relative L² [–]",
          "dissipation_error": "error of the dissipation, relative [–]",
          "skin_error": "error of the skin, relative L² [–]",
          "saturation_error": "error of the saturation, relative L² [–]"}
STABLE = ("accurate", "wrong")
SHAKY = ("chatter", "growing_energy")
JND = (0.07, 0.10)  # just noticeable difference of force


def read_table(file):
    with open(file, encoding="utf-8") as lines:
        return list(csv.DictReader(line for line in lines if not line.startswith("#")))


def number(row, key):
    return float(row[key]) if row[key] else math.nan


def full_names(names):
    """Words of the legend for each curve: "1200 of these" and "these" are the last curve named before them in full."""
    base = next((names[k - 1] for k, name in enumerate(names) if re.search(r"\bthese\b", name)), "")
    return {name: re.sub(r"^these\b", base, re.sub(r"^(\d+) of these\b", rf"\1 {base}", name)) for name in names}


def find_front(points):
    """Of (cost, error) those that no other beats in both, in the order of cost."""
    front = []
    for cost, error in sorted(points):
        if not front or error < front[-1][1]:
            front.append((cost, error))
    return front


def place_runs(rows, error, own_error):
    """(row, kind, cost, error) of every run, where it is drawn: kind `good` and `shaky` by their error, those without
    any at the bottom or at the reference's own error, below which none can be told; at the top, `ended` and `alone`,
    which reached its end but has nothing to be compared with. What has no cost is at the left."""
    def known(key):
        return [number(row, key) for row in rows if number(row, key) > 0.0]
    costs, errors = known("cpu_s_per_s") or [1.0], known(error) or [1.0]
    left, top = 0.5 * min(costs), 2.0 * max(errors)
    bottom = min(0.5 * min(errors), own_error if own_error > 0.0 else math.inf)
    placed = []
    for row in rows:
        cost, value, outcome = number(row, "cpu_s_per_s"), number(row, error), row["outcome"]
        if math.isnan(value):
            kind, value = ("alone" if outcome in STABLE + ("unknown",) else "ended"), top
        else:
            kind, value = ("good" if outcome in STABLE else "shaky"), value if value > 0.0 else bottom
        placed.append((row, kind, cost if cost > 0.0 else left, value))
    return placed


def draw_curve(axes, placed, label, place):
    """Of one curve, as `place_runs` has it; the points of good runs. Its entry in the legend has line and mark."""
    style = {"color": COLOURS[place % len(COLOURS)], "marker": MARKS[place % len(MARKS)], "markersize": 4.5}
    points = {kind: [(cost, error) for _, its, cost, error in placed if its == kind] for kind in ("good", "shaky", "ended", "alone")}
    whole = [(cost, error) for _, kind, cost, error in placed if kind in ("good", "shaky")]
    dashes = DASHES[place // len(COLOURS) % 2 * 2]
    axes.loglog(*zip(*whole) if whole else ([], []), linestyle=dashes, linewidth=1.0, color=style["color"])
    axes.plot([], [], linestyle=dashes if len(whole) > 1 else "none", linewidth=1.0, label=label, **style)
    for kind, look in (("good", style), ("shaky", {"markerfacecolor": "white", **style}),
                       ("ended", {"color": style["color"], "marker": "x", "clip_on": False}),
                       ("alone", {"color": style["color"], "marker": "1", "markersize": 8, "clip_on": False})):
        if points[kind]:  # a mark at no place, not clipped, takes room at the picture's corner
            axes.loglog(*zip(*points[kind]), linestyle="none", **look)
    return points["good"]


def draw(rows, error, title):
    reference, rest = rows[0], rows[2:]
    figure, axes = plt.subplots(figsize=(155 * MILLIMETRES, 95 * MILLIMETRES))
    placed = place_runs(rest, error, number(reference, error))
    names = list(dict.fromkeys(row["curve"] for row in rest))
    points = []
    for place, (name, label) in enumerate(full_names(names).items()):
        points += draw_curve(axes, [run for run in placed if run[0]["curve"] == name], label, place)
    front = find_front(points)
    axes.loglog(*zip(*front) if front else ([], []), color="black", linewidth=3.5, alpha=0.18, zorder=1, label="best at its cost")
    across, along = axes.get_yaxis_transform(), axes.get_xaxis_transform()
    words = {"color": GREY, "fontsize": 7, "textcoords": "offset points", "in_layout": False}  # they lie within the axes
    if error.endswith("force_error"):
        axes.axhspan(*JND, color=GREY, alpha=0.15, linewidth=0)
        axes.annotate("just noticeable", (0.0, JND[0]), xycoords=across, xytext=(3, 1), va="bottom", **words)
    own = number(reference, error)
    if own > 0.0:
        axes.axhline(own, color=GREY, linewidth=0.8, linestyle=":")
        axes.annotate("the reference's own error", (0.0, own), xycoords=across, xytext=(3, 1), va="bottom", **words)
    axes.axvline(1.0, color=GREY, linewidth=0.8)
    axes.annotate("real time", (1.0, 1.0), xycoords=along, xytext=(-2, -3), rotation=90, va="top", ha="right", **words)
    kinds = {kind for _, kind, _, _ in placed}
    for kind, marker, words in (("shaky", "o", "hollow: chatters or gains energy"), ("ended", "x", "ended early; at the left: refused"),
                                ("alone", "1", "has nothing to be compared with")):
        if kind in kinds:
            axes.plot([], [], linestyle="none", marker=marker, markerfacecolor="white", color=GREY, label=words)
    axes.set_xlabel("CPU time of a simulated second, one thread [s/s]")
    axes.set_ylabel(LABELS.get(error, error))
    axes.set_title(title)
    own = [own] if own > 0.0 else []
    number_log_axis(axes.xaxis, [1.0] + [cost for _, _, cost, _ in placed], most=1)
    number_log_axis(axes.yaxis, own + [value for *_, value in placed], most=1)
    put_legend(figure, *entries_of(axes), fontsize=7)
    return figure


def make_figure(table, error=ERROR, title=""):
    """Of a table of `argil chart`; `error`: one of LABELS."""
    rows = read_table(table)
    if len(rows) < 3 or "cpu_s_per_s" not in rows[0]:
        raise InputError(f"{table}: is not a table of argil chart")
    if not any(number(row, error) > 0.0 for row in rows[2:]):
        raise InputError(f"{table}: no run has a {error}; choose another error")
    return draw(rows, error, title)
