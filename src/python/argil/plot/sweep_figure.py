"""A figure of `argil sweep collect` against one setting, a line for each combination of the others.

Colours tell the values of the other setting with the most, dashes those of one more. A setting that is text is an axis
of names. What had no figure is counted in the picture.
"""
import csv
import warnings
from collections import Counter

import matplotlib.pyplot as plt

from ..errors import InputError
from .style import COLOURS, DASHES, GREY, MARKS, MILLIMETRES, quantity_label

FIRST_SETTING, FIRST_FIGURE, AFTER_FIGURES = 2, "peak_force_N", "outcome"


def read_table(file):
    """Rows, and the names of the settings and of the figures."""
    try:
        with open(file, encoding="utf-8") as lines:
            rows = list(csv.DictReader(line for line in lines if not line.startswith("#")))
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{file}: cannot be read: {error}")
    names = list(rows[0]) if rows else []
    if FIRST_FIGURE not in names or AFTER_FIGURES not in names:
        raise InputError(f"{file}: is not a table of argil sweep collect, or has no points")
    first = names.index(FIRST_FIGURE)
    return rows, names[FIRST_SETTING:first], names[first:names.index(AFTER_FIGURES)]


def choose(file, what, name, names):
    if name not in names:
        raise InputError(f"{file}: no {what} '{name}'; there are: {', '.join(names) or 'none'}")
    return name


def keep_only(file, rows, settings, wanted):
    """The rows where each SETTING=VALUE holds; a number may be spelled in any way."""
    for words in wanted:
        name, _, value = words.partition("=")
        choose(file, "setting", name, settings)
        kept = [row for row in rows if as_value(row[name]) == as_value(value)]
        if not kept:
            raise InputError(f"{file}: no point has {name} = {value}; there are: {', '.join(values_of(rows, name))}")
        rows = kept
    return rows


def as_value(cell):
    """A number where it is one, else its text."""
    try:
        return float(cell)
    except ValueError:
        return cell


def is_text(rows, name):
    return any(isinstance(as_value(row[name]), str) for row in rows)


def values_of(rows, name):
    """The different values of a setting: numbers in their order, texts in that of the table."""
    cells = list(dict.fromkeys(row[name] for row in rows))
    return cells if is_text(rows, name) else sorted(cells, key=float)


def find_others(file, rows, settings, x):
    """The settings besides x that take more than one value: at most two, which colours and dashes tell apart; there
    are fewer dashes."""
    others = [name for name in settings if name != x and len(values_of(rows, name)) > 1]
    others.sort(key=lambda name: -len(values_of(rows, name)))
    if len(others) > 2:
        raise InputError(f"{file}: {len(others)} settings vary besides {x}, a figure tells two apart: "
                         f"{', '.join(others)}; choose one value with --only SETTING=VALUE, or another --x")
    if len(others) > 1 and len(values_of(rows, others[1])) >= len(DASHES):
        raise InputError(f"{file}: {others[1]} has {len(values_of(rows, others[1]))} values, dashes tell {len(DASHES) - 1} "
                         "apart; choose one with --only SETTING=VALUE, or another --x")
    return others


def count_left_out(rows, y):
    """The rows that have the figure, and words about the others."""
    good = [row for row in rows if row["outcome"] == "done" and row[y]]
    reasons = Counter("without the figure" if row["outcome"] == "done" else row["outcome"]
                      for row in rows if row not in good)
    words = ", ".join(f"{count} {reason}" for reason, count in reasons.items())
    return good, f"{len(rows) - len(good)} of {len(rows)} points left out: {words}" if words else ""


def draw_lines(axes, rows, x, y, others):
    """A line for each combination; names of x stand at 0, 1, 2 …"""
    places = {cell: place for place, cell in enumerate(values_of(rows, x))} if is_text(rows, x) else None
    values = [values_of(rows, name) for name in others] + [[None]] * (2 - len(others))
    for i, one in enumerate(values[0]):
        for j, other in enumerate(values[1]):
            mine = [row for row in rows if all(row[name] == cell for name, cell in zip(others, (one, other)))]
            line = sorted((places[row[x]] if places else float(row[x]), float(row[y])) for row in mine)
            axes.plot(*zip(*line) if line else ([], []), color=COLOURS[i % len(COLOURS)],
                      marker=MARKS[i % len(MARKS)], linestyle=DASHES[(j + 1) % len(DASHES)], markersize=3.5)
    if places:
        axes.set_xticks(list(places.values()), list(places))


def draw_legend(axes, rows, others):
    """Each of the other settings under its name: colours and marks, then dashes."""
    for place, name in enumerate(others):
        axes.plot([], [], linestyle="none", label=quantity_label(name, has_unit=not is_text(rows, name)))
        for k, cell in enumerate(values_of(rows, name)):
            style = ({"color": COLOURS[k % len(COLOURS)], "marker": MARKS[k % len(MARKS)], "markersize": 3.5}
                     if place == 0 else {"color": "black", "linestyle": DASHES[(k + 1) % len(DASHES)]})
            axes.plot([], [], label=f"   {as_value(cell):g}" if not is_text(rows, name) else f"   {cell}", **style)
    if others:
        axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))


def draw(rows, x, y, others, left_out):
    figure, axes = plt.subplots(figsize=(150 * MILLIMETRES, 85 * MILLIMETRES))
    draw_lines(axes, rows, x, y, others)
    draw_legend(axes, rows, others)
    axes.set_xlabel(quantity_label(x, has_unit=not is_text(rows, x)))
    axes.set_ylabel(quantity_label(y))
    if min(float(row[y]) for row in rows) >= 0.0:
        axes.set_ylim(bottom=0.0)
    axes.set_title(left_out, loc="left", color=GREY)
    return figure


def make_figure(table, x=None, y=FIRST_FIGURE, only=()):
    """Of a table of `argil sweep collect`: figure `y` against setting `x`, by default the first that varies, at the
    points where each SETTING=VALUE of `only` holds. A warning says how many points have no such figure."""
    rows, settings, figures = read_table(table)
    if not settings:
        raise InputError(f"{table}: no setting varies, so there is nothing to draw against")
    choose(table, "figure", y, figures)
    rows = keep_only(table, rows, settings, only)
    varying = [name for name in settings if len(values_of(rows, name)) > 1]
    x = choose(table, "setting", x or (varying or settings)[0], settings)
    others = find_others(table, rows, settings, x)
    good, left_out = count_left_out(rows, y)
    if not good:
        reason = next((row.get("reason") for row in rows if row.get("reason")), "") or "no reason given"
        raise InputError(f"{table}: no point has {y} ({left_out}); the first: {reason}")
    if left_out:
        warnings.warn(f"{table}: {left_out}", stacklevel=3)
    return draw(good, x, y, others, left_out)
