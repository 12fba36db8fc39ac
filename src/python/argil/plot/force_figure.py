"""The size of the force at the hand against time, one line a run, and a closer look at the strongest press."""
from typing import NamedTuple

import matplotlib.pyplot as plt
import numpy as np

from ..errors import InputError
from .reading import force_norm, is_deforming, labels_for, name_of, opened, spans
from .style import COLOURS, DASHES, GREY, MILLIMETRES, WATER_BAND, entries_of, put_legend


class Run(NamedTuple):
    """What one line shows."""

    label: str
    time: np.ndarray  # [s]
    force: np.ndarray  # [N]
    deforming: np.ndarray  # the tool pushes or pulls
    band: tuple = None  # lower and upper end of where the force should be [N], where the run has estimated it


def moving_mean(time, values, window):
    """Mean over `window` [s] around each sample, over what there is of it at the ends."""
    width = 2 * round(0.5 * window / (time[1] - time[0])) + 1 if len(time) > 1 else 1
    ones = np.ones(width)
    return np.convolve(values, ones, "full")[width // 2:][:len(values)] / np.convolve(
        np.ones(len(values)), ones, "full")[width // 2:][:len(values)]


def read_band(result, force):
    """The force less what is known to be too much of it, and what may be either; None where nothing was estimated."""
    if "force_error_parts" not in result["haptic"]:
        return None
    parts = result["haptic/force_error_parts"][:]
    signed, either = parts[:, 0] + parts[:, 2], parts[:, 1] + parts[:, 3] + parts[:, 4]
    return np.maximum(0, force - np.maximum(signed, 0) - either), force + np.maximum(-signed, 0) + either


def read_run(source, label, align_press, smooth=0.0):
    """Of a result, by its name or opened."""
    with opened(source) as result:
        time, force, deforming = result["haptic/time"][:], force_norm(result), is_deforming(result)
        band = read_band(result, force)
    if len(time) == 0:
        raise InputError(f"{name_of(source)}: has no haptic ticks")
    if smooth > 0.0:
        force = moving_mean(time, force, smooth)
        band = band and tuple(moving_mean(time, end, smooth) for end in band)
    if align_press:
        if not deforming.any():
            raise InputError(f"{name_of(source)}: the tool never pushes or pulls, so there is no press to align")
        time = time - time[np.argmax(deforming)]
    return Run(label, time, force, deforming, band)


def find_peak(runs):
    """Start and end [s] of the contact that holds the largest force while the tool pushes or pulls, of any run."""
    def peak_of(run):
        return np.max(run.force * run.deforming, initial=0.0)

    run = max(runs, key=peak_of)
    if not peak_of(run) > 0.0:
        return None
    peak = np.argmax(run.force * run.deforming)
    # The hand's tremor breaks a contact for moments: gaps shorter than this belong to it.
    gap = 0.05
    touching = run.time[(run.force > 0.0) & run.deforming]
    parts = np.split(touching, np.flatnonzero(np.diff(touching) > gap) + 1)
    part = next(p for p in parts if p[0] <= run.time[peak] <= p[-1])
    return part[0], part[-1]


def draw_lines(axes, runs, time_label):
    first_with_band = next((run for run in runs if run.band), None)
    for number, run in enumerate(runs):
        axes.plot(run.time, run.force, label=run.label, color=COLOURS[number % len(COLOURS)],
                  linestyle=DASHES[number % len(DASHES)])
        if run.band:
            axes.fill_between(run.time, *run.band, color=COLOURS[number % len(COLOURS)], alpha=0.2, linewidth=0,
                              label="where it should be, as the run estimates" if run is first_with_band else None)
    axes.set_xlabel(time_label)


def draw_water_bands(axes, runs):
    """A blue band where a run's tool wets or dries: what it feels there deforms nothing."""
    drawn = set()
    for run in runs:
        for first, last in spans(~run.deforming):
            band = (round(run.time[first], 3), round(run.time[last], 3))
            if band not in drawn:
                axes.axvspan(*band, color=WATER_BAND, alpha=0.16, linewidth=0,
                             label=None if drawn else "tool wets or dries")
                drawn.add(band)


def find_close_up(runs, start):
    """The strongest contact, where it is less than half of the time that is drawn: else the whole shows it as well."""
    peak = find_peak(runs)
    begin = min(run.time[0] for run in runs) if start is None else start
    return peak if peak and peak[1] - peak[0] < 0.5 * (max(run.time[-1] for run in runs) - begin) else None


def draw(runs, align_press, smooth, start=None):
    peak = find_close_up(runs, start)
    time_label = "time since the push began [s]" if align_press else "time [s]"
    figure, panels = plt.subplots(1, 2 if peak else 1, figsize=(180 * MILLIMETRES, 72 * MILLIMETRES),
                                  squeeze=False, gridspec_kw={"width_ratios": [2, 1] if peak else [1]})
    whole = panels[0][0]
    draw_lines(whole, runs, time_label)
    draw_water_bands(whole, runs)
    whole.set_ylabel("force at the hand [N]" + (f"\nmean over {smooth:g} s" if smooth > 0.0 else ""))
    whole.margins(x=0)
    if start is not None:
        whole.set_xlim(left=start)
    whole.set_ylim(bottom=0, top=1.08 * (max(np.max(run.force, initial=0.0) for run in runs) or 1.0))
    if peak:
        close = panels[0][1]
        draw_lines(close, runs, time_label)
        margin = 0.06 * (peak[1] - peak[0]) + 0.005
        left, right = peak[0] - margin, peak[1] + margin
        # Its own height: what wetting feels, which deforms nothing, may be far above.
        height = 1.08 * max(np.max(run.force[(run.time >= left) & (run.time <= right)], initial=0.0) for run in runs)
        close.set_xlim(left, right)
        close.set_ylim(0, height)
        close.set_title("strongest contact", loc="left", color=GREY)
        whole.add_patch(plt.Rectangle((left, 0), right - left, height, fill=False, edgecolor=GREY, linewidth=0.8,
                                      linestyle=":"))
    handles, words = entries_of(whole)
    if words != [runs[0].label]:
        put_legend(figure, handles, words, above=True)
    return figure


def make_figure(sources, labels=None, align_press=False, smooth=0.0, start=None):
    """A line for each result."""
    if not smooth >= 0.0:
        raise InputError(f"smooth {smooth:g}: give 0 or more seconds")
    labels = labels_for(sources, labels)
    runs = [read_run(source, label, align_press, smooth) for source, label in zip(sources, labels)]
    return draw(runs, align_press, smooth, start)
