"""Figures of results and of tables, as the scripts draw them; each function returns matplotlib's figure.

    argil.plot.force("dry.h5", "wet.h5", labels=["dry", "wet"])
    argil.plot.save(argil.plot.water("wet.h5"), "water")     # water.png, water.pdf

A result is a file's name or an argil.Result. What cannot be drawn raises InputError.
"""
from . import chart_figure, energy_figure, force_figure, map_figure, sweep_figure, water_figure
from .style import COLOURS, DASHES, STYLE, save, styled

__all__ = ["COLOURS", "DASHES", "STYLE", "chart", "energy", "force", "save", "stability", "sweep", "water"]


@styled
def force(*results, labels=None, align_press=False, smooth=0.0, start=None):
    """The size of the force at the hand [N] against time [s], a line a run, and a closer look at the strongest press.

    labels: one a result; by default the files' names. align_press: time counts from the first push or pull. smooth:
    draw the moving mean over so long [s]. start: where the axis of time begins [s].
    """
    return force_figure.make_figure(results, labels, align_press, smooth, start)


@styled
def energy(*results, labels=None):
    """What the hand and the contact give, what the body holds and what flow dissipates [J] against time [s], a panel a
    run. While a press grows the contact gives more than the hand, by the length of a physics step."""
    return energy_figure.make_figure(results, labels)


@styled
def water(result):
    """Saturation [–], the ledger of the water [mg] and by how much it fails to close, against time [s]."""
    return water_figure.make_figure(result)


@styled
def chart(table, error=chart_figure.ERROR, title=""):
    """Error against cost of the runs of `argil chart`, a curve a method. error: name of the table's column."""
    return chart_figure.make_figure(table, error, title)


@styled
def stability(table, title="", forces=None):
    """What became of each run of `argil stability`. forces: names of the method and the reference, whose largest forces
    a second panel has then."""
    return map_figure.make_figure(table, title, forces)


@styled
def sweep(table, x=None, y=sweep_figure.FIRST_FIGURE, only=()):
    """A figure of the table of `argil sweep collect` against one setting. x: the setting, by default the first that
    varies.
    y: the figure. only: texts "SETTING=VALUE", the points where they hold."""
    return sweep_figure.make_figure(table, x, y, only)
