#!/usr/bin/python3
"""Draws the size of the force at the hand against time, one line a run, and a closer look at the strongest press.

Usage: plot_force.py A.h5 [B.h5 ...] [--labels A B ...] [--align-press] [--from SECONDS] [--smooth SECONDS]
                     [-o STEM]
"""
import argparse
from typing import NamedTuple

import argil_plot as ap
from argil_plot import np, plt


class Run(NamedTuple):
    """What one line shows."""

    label: str
    time: np.ndarray  # [s]
    force: np.ndarray  # [N]
    deforming: np.ndarray  # the tool pushes or pulls


def moving_mean(time, values, window):
    """Mean over `window` [s] around each sample, over what there is of it at the ends."""
    width = 2 * round(0.5 * window / (time[1] - time[0])) + 1 if len(time) > 1 else 1
    ones = np.ones(width)
    return np.convolve(values, ones, "full")[width // 2:][:len(values)] / np.convolve(
        np.ones(len(values)), ones, "full")[width // 2:][:len(values)]


def read_run(file, label, align_press, smooth=0.0):
    with ap.open_result(file) as result:
        time, force, deforming = result["haptic/time"][:], ap.force_norm(result), ap.is_deforming(result)
    if len(time) == 0:
        ap.refuse(f"{file}: has no haptic ticks")
    if smooth > 0.0:
        force = moving_mean(time, force, smooth)
    if align_press:
        if not deforming.any():
            ap.refuse(f"{file}: the tool never pushes or pulls, so there is no press to align")
        time = time - time[np.argmax(deforming)]
    return Run(label, time, force, deforming)


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
    for number, run in enumerate(runs):
        axes.plot(run.time, run.force, label=run.label, color=ap.COLOURS[number % len(ap.COLOURS)],
                  linestyle=ap.DASHES[number % len(ap.DASHES)])
    axes.set_xlabel(time_label)


def draw_water_bands(axes, runs):
    """A blue band where a run's tool wets or dries: what it feels there deforms nothing."""
    drawn = set()
    for run in runs:
        for first, last in ap.spans(~run.deforming):
            band = (round(run.time[first], 3), round(run.time[last], 3))
            if band not in drawn:
                axes.axvspan(*band, color=ap.WATER_BAND, alpha=0.16, linewidth=0,
                             label=None if drawn else "tool wets or dries")
                drawn.add(band)


def draw(runs, align_press, smooth, start=None):
    peak = find_peak(runs)
    time_label = "time since the push began [s]" if align_press else "time [s]"
    figure, panels = plt.subplots(1, 2 if peak else 1, figsize=(180 * ap.MILLIMETRES, 72 * ap.MILLIMETRES),
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
        close.set_title("strongest contact", loc="left", color=ap.GREY)
        whole.add_patch(plt.Rectangle((left, 0), right - left, height, fill=False, edgecolor=ap.GREY, linewidth=0.8,
                                      linestyle=":"))
    if len(runs) > 1 or whole.get_legend_handles_labels()[1] != [runs[0].label]:
        whole.legend(loc="lower left", bbox_to_anchor=(0, 1.0), ncol=3, borderaxespad=0.3)
    return figure


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("files", nargs="+", metavar="RESULT.h5")
    parser.add_argument("--labels", nargs="+", help="one a file; default: the files' names")
    parser.add_argument("--align-press", action="store_true", help="time counts from the first push or pull sample")
    parser.add_argument("--from", type=float, dest="start", metavar="SECONDS",
                        help="where the axis of time starts; default: with the first run")
    parser.add_argument("--smooth", type=float, default=0.0, metavar="SECONDS",
                        help="draw the moving mean over so long; 0.1 takes out a hand's tremor")
    parser.add_argument("-o", "--output", default="force", metavar="STEM", help="default: force")
    options = parser.parse_args()
    labels = ap.labels_for(options.files, options.labels)
    if not options.smooth >= 0.0:
        ap.refuse(f"--smooth {options.smooth:g}: give 0 or more seconds")
    runs = [read_run(file, label, options.align_press, options.smooth) for file, label in zip(options.files, labels)]
    ap.save(draw(runs, options.align_press, options.smooth, options.start), options.output)


if __name__ == "__main__":
    main()
