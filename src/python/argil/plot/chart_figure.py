"""A chart of `argil chart`: error against cost, a curve a method, the Pareto front marked. Every run has its mark:
along the top those without an error, at the left those without a cost.
"""
import csv
import math

import matplotlib.pyplot as plt

from ..errors import InputError
from .style import COLOURS, DASHES, GREY, MARKS, MILLIMETRES

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


def draw_curve(axes, placed, name, place):
    """Of one name, as `place_runs` has it; the points of good runs."""
    style = {"color": COLOURS[place % len(COLOURS)], "marker": MARKS[place % len(MARKS)], "markersize": 4.5}
    points = {kind: [(cost, error) for _, its, cost, error in placed if its == kind] for kind in ("good", "shaky", "ended", "alone")}
    whole = [(cost, error) for _, kind, cost, error in placed if kind in ("good", "shaky")]
    dashes = DASHES[place // len(COLOURS) % 2 * 2]
    axes.loglog(*zip(*whole) if whole else ([], []), linestyle=dashes, linewidth=1.0, color=style["color"])
    for kind, look in (("good", {"label": name, **style}), ("shaky", {"markerfacecolor": "white", **style}),
                       ("ended", {"color": style["color"], "marker": "x", "clip_on": False}),
                       ("alone", {"color": style["color"], "marker": "1", "markersize": 8, "clip_on": False})):
        axes.loglog(*zip(*points[kind]) if points[kind] else ([], []), linestyle="none", **look)
    return points["good"]


def draw(rows, error, title):
    reference, rest = rows[0], rows[2:]
    figure, axes = plt.subplots(figsize=(175 * MILLIMETRES, 105 * MILLIMETRES))
    placed = place_runs(rest, error, number(reference, error))
    names = list(dict.fromkeys(row["curve"] for row in rest))
    points = []
    for place, name in enumerate(names):
        points += draw_curve(axes, [run for run in placed if run[0]["curve"] == name], name, place)
    front = find_front(points)
    axes.loglog(*zip(*front) if front else ([], []), color="black", linewidth=3.5, alpha=0.18, zorder=1, label="best at its cost")
    if error.endswith("force_error"):
        axes.axhspan(*JND, color=GREY, alpha=0.15, linewidth=0)
        axes.annotate("just noticeable", (axes.get_xlim()[0], JND[0]), color=GREY, fontsize=7, va="bottom",
                      xytext=(3, 1), textcoords="offset points")
    own = number(reference, error)
    if own > 0.0:
        axes.axhline(own, color=GREY, linewidth=0.8, linestyle=":")
        axes.annotate("the reference's own error", (axes.get_xlim()[1], own), color=GREY, fontsize=7, ha="right",
                      va="bottom", xytext=(-3, 1), textcoords="offset points")
    axes.axvline(1.0, color=GREY, linewidth=0.8)
    axes.annotate("real time", (1.0, axes.get_ylim()[1]), color=GREY, fontsize=7, rotation=90, va="top", ha="right",
                  xytext=(-2, -3), textcoords="offset points")
    kinds = {kind for _, kind, _, _ in placed}
    for kind, marker, words in (("shaky", "o", "hollow: chatters or gains energy"), ("ended", "x", "ended early; at the left: refused"),
                                ("alone", "1", "has nothing to be compared with")):
        if kind in kinds:
            axes.plot([], [], linestyle="none", marker=marker, markerfacecolor="white", color=GREY, label=words)
    axes.set_xlabel("CPU time of a simulated second, one thread [s/s]")
    axes.set_ylabel(LABELS.get(error, error))
    axes.set_title(title)
    axes.legend(loc="center left", bbox_to_anchor=(1.01, 0.5), fontsize=7)
    return figure


def make_figure(table, error=ERROR, title=""):
    """Of a table of `argil chart`; `error`: one of LABELS."""
    rows = read_table(table)
    if len(rows) < 3 or "cpu_s_per_s" not in rows[0]:
        raise InputError(f"{table}: is not a table of argil chart")
    if not any(number(row, error) > 0.0 for row in rows[2:]):
        raise InputError(f"{table}: no run has a {error}; choose another error")
    return draw(rows, error, title)
