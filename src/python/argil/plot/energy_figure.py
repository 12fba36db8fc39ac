"""Where the energy of runs goes: what the hand and the contact give, what the body holds, what flow dissipates.

The hand's work counts while it pushes or pulls, for what it feels when it wets or dries deforms nothing. The rest is
the contact's work less what the body holds more than at the first step and what flow dissipated: damping, the clay's
kernel, moduli that water changed, and the work of weight and loads, which no file records.

The contact's work counts the force at the end of a physics step along all of the step, the hand's work what it feels
meanwhile. While a press grows the first is larger, by the length of the step: 6 % with 2 ms and 19 % with 5 ms in
scenarios/study_light_press.json.
"""
from typing import NamedTuple

import matplotlib.pyplot as plt
import numpy as np

from ..errors import InputError
from .reading import is_deforming, labels_for, name_of, opened
from .style import COLOURS, DASHES, GREY, MILLIMETRES, entries_of, put_legend

PREFIXES = ((1.0, "J"), (1e-3, "mJ"), (1e-6, "µJ"), (1e-9, "nJ"), (1e-12, "pJ"))


class Energies(NamedTuple):
    """Of one run at each physics step [J]; all but elastic and kinetic since the start."""

    label: str
    time: np.ndarray  # [s]
    hand: np.ndarray  # work of the pressing hand against the device's force
    contact: np.ndarray  # work of the contact on the body
    elastic: np.ndarray
    flow: np.ndarray  # dissipated by plastic flow
    kinetic: np.ndarray

    def rest(self):
        held = self.elastic + self.kinetic
        return self.contact - (held - held[0]) - self.flow


def read_energies(source, label):
    """Of a result, by its name or opened."""
    with opened(source) as result:
        physics, haptic = result["physics"], result["haptic"]
        time = physics["time"][:]
        if len(time) == 0:
            raise InputError(f"{name_of(source)}: has no physics steps, so it has no energies")
        given = np.diff(haptic["port_energy"][:], prepend=0.0) * is_deforming(result)  # by the device, each tick
        # A static result has steps and no ticks: no hand works there.
        hand = -np.interp(time, haptic["time"][:], np.cumsum(given)) if len(given) else np.zeros(len(time))
        return Energies(label, time, hand, *(physics[name][:] for name in (
            "contact_work", "elastic_energy", "plastic_dissipation", "kinetic_energy")))


def with_prefix(energy):
    """A size in the unit that keeps it between 1 and 1000, as "1.2 mJ"."""
    scale, unit = next(((s, u) for s, u in PREFIXES if energy >= s), PREFIXES[-1])
    return f"{energy / scale:.3g} {unit}" if energy > 0.0 else "0 J"


def lines_of(run):
    return (("work of the pressing hand", run.hand), ("work of the contact on the body", run.contact), ("elastic", run.elastic),
            ("dissipated by flow", run.flow), ("the rest: damping, loads …", run.rest()), ("kinetic", run.kinetic))


def find_begin(run):
    """A little before the first energy that can be seen; the start where there is none."""
    values = np.abs([values for _, values in lines_of(run)]).max(axis=0)
    first = run.time[np.argmax(values > 1e-3 * values.max())] if values.max() > 0.0 else run.time[0]
    return max(run.time[0], first - 0.05 * (run.time[-1] - first))


def draw(runs):
    largest = max(np.abs(values).max() for run in runs for _, values in lines_of(run))
    scale, unit = next(((s, u) for s, u in PREFIXES if largest >= s), PREFIXES[0])
    figure, panels = plt.subplots(1, len(runs), figsize=((90 + 70 * (len(runs) - 1)) * MILLIMETRES,
                                                         72 * MILLIMETRES), squeeze=False, sharey=True)
    for run, axes in zip(runs, panels[0]):
        for number, (name, values) in enumerate(lines_of(run)):
            axes.plot(run.time, values / scale, label=name, color=COLOURS[number], linestyle=DASHES[number],
                      marker="o" if len(run.time) == 1 else "", markersize=4)
        begin, end = find_begin(run), run.time[-1]
        axes.set_xlim(begin, end if end > begin else begin + 1.0)
        axes.set_xlabel("time [s]")
        axes.set_title(f"{run.label}\nkinetic at most {with_prefix(run.kinetic.max())}", loc="left", color=GREY)
    panels[0][0].set_ylabel(f"energy [{unit}]")
    put_legend(figure, *entries_of(panels[0][0]))
    return figure


def make_figure(sources, labels=None):
    """A panel for each result."""
    return draw([read_energies(*pair) for pair in zip(sources, labels_for(sources, labels))])
