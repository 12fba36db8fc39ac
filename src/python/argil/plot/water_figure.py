"""Where the water of a run is: saturation, the water ledger, and by how much the ledger fails to close.

What has nothing to show has no panel: words say that no water moved, or how well the ledger closes.
"""
from typing import NamedTuple

import matplotlib.pyplot as plt
import numpy as np

from ..errors import InputError
from .reading import cells_of, frames_of, opened
from .style import COLOURS, DASHES, GREY, MILLIMETRES, entries_of, put_legend

MILLIGRAM = 1e-6  # [kg]
CLOSED = 1e-12  # of the water, a ledger's error that is rounding


class Saturation(NamedTuple):
    """Of the body at each frame."""

    time: np.ndarray  # [s]
    mean: np.ndarray  # over the rest volume
    largest: np.ndarray  # over the tets


class Ledger(NamedTuple):
    """Of each physics step."""

    time: np.ndarray  # [s]
    mass: np.ndarray  # in the body [kg]
    added: np.ndarray  # since the start [kg]
    removed: np.ndarray  # since the start [kg]

    def error(self):
        """|m − m₀ − added + removed| over the most water that the body held or exchanged [–]. m₀ is what the first
        record implies, so a mistake inside the very first step is not seen here."""
        implied_start = self.mass - self.added + self.removed
        scale = max(np.max(np.abs(q)) for q in (self.mass, self.added, self.removed))
        return np.abs(implied_start - implied_start[0]) / (scale if scale > 0.0 else 1.0)

    def is_still(self):
        """No water was given or taken, and none is missing."""
        return not (np.any(self.added) or np.any(self.removed) or np.any(self.mass != self.mass[0]))


def rest_volumes(mesh):
    """Volume of each tet of a group of cells [m³]."""
    corners = mesh["rest_position"][:][mesh["tets"][:]]
    edges = corners[:, 1:] - corners[:, :1]
    return np.abs(np.linalg.det(edges)) / 6.0


def read_saturation(result):
    frames = frames_of(result)
    fields = [frame["saturation"][:] for frame in frames]
    volumes = [rest_volumes(cells_of(result, frame)) for frame in frames]
    return Saturation(np.array([frame.attrs["time"] for frame in frames]),
                      np.array([field @ volume / volume.sum() for field, volume in zip(fields, volumes)]),
                      np.array([field.max() for field in fields]))


def read_ledger(result):
    physics = result["physics"]
    if len(physics["time"]) == 0:
        raise InputError(f"{result.filename}: has no physics steps")
    return Ledger(*(physics[name][:] for name in ("time", "water_mass", "water_added", "water_removed")))


def draw_saturation(axes, saturation):
    for number, (name, values) in enumerate((("largest", saturation.largest), ("mean of the body", saturation.mean))):
        axes.plot(saturation.time, values, label=name, color=COLOURS[number], linestyle=DASHES[number])
    axes.set_ylabel("saturation S [–]")
    axes.set_ylim(-0.02, 1.05)  # dry clay is seen above the axis


def draw_ledger(axes, ledger):
    change = ledger.mass - ledger.mass[0] + ledger.added[0] - ledger.removed[0]
    lines = (("in the body, beyond the start", change), ("added by the tool", ledger.added),
             ("removed by the tool", ledger.removed))
    for number, (name, mass) in enumerate(lines, start=2):  # after those of the saturation
        axes.plot(ledger.time, mass / MILLIGRAM, label=name, color=COLOURS[number], linestyle=DASHES[number])
    axes.set_ylabel("water [mg]")


def draw_error(axes, ledger):
    error = ledger.error()
    rounding = np.finfo(float).eps
    axes.semilogy(ledger.time, np.maximum(error, 0.1 * rounding), color=COLOURS[0], linewidth=0.9)
    axes.axhline(rounding, color=GREY, linewidth=0.8, linestyle=":")
    axes.text(0.98, 1.2 * rounding, "rounding of one number", color=GREY, ha="right", va="bottom", fontsize=8,
              transform=axes.get_yaxis_transform())
    axes.set_ylim(0.1 * rounding, max(1e-12, 3.0 * error.max()))
    axes.set_ylabel("ledger error, relative [–]")
    axes.set_title(f"at most {error.max():.1e}", loc="right", color=GREY, fontsize=8)


def draw(saturation, ledger):
    """Saturation; ledger, unless no water moved; the ledger's error, unless it is rounding, where words say so."""
    error = ledger.error().max()
    has_ledger, has_error = not ledger.is_still(), error > CLOSED
    count = 1 + has_ledger + has_error
    figure, panels = plt.subplots(1, count, squeeze=False, figsize=((40 + 55 * count) * MILLIMETRES, 62 * MILLIMETRES))
    panels = panels[0]
    draw_saturation(panels[0], saturation)
    if has_ledger:
        draw_ledger(panels[1], ledger)
    if has_error:
        draw_error(panels[-1], ledger)
    else:
        words = f"The ledger closes to {error:.0e} of the water." if has_ledger else "No water was given or taken."
        panels[-1].set_title(words, loc="left", color=GREY)
    for axes in panels:
        axes.margins(x=0)
        axes.set_xlim(0, ledger.time[-1] or 1.0)  # a static result has one moment, at 0
        axes.set_xlabel("time [s]")
    put_legend(figure, *entries_of(*panels))
    return figure


def make_figure(source):
    """Of one result."""
    with opened(source) as result:
        return draw(read_saturation(result), read_ledger(result))
