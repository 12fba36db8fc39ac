#!/usr/bin/python3
"""Finds how stiff a contact may be before it throws the hand off, for a simulated operator in closed loop with argil's
own ticks, and draws it over the operator's damping beside the theory.

The operator is a mass of 0.1 kg that moves through a damper and is pressed down by 0.5 N. The table is the work of
tests/verification/make_stability_table.cpp and takes some minutes.

Usage: plot_stability.py [--build BUILD] [--table-as-it-is]      writes results/contact/stability.csv, .png, .pdf
"""
import argparse
import csv
import subprocess
from pathlib import Path

import argil_plot as ap
from argil_plot import COLOURS, DASHES, GREY, MILLIMETRES, np, plt

ROOT = Path(__file__).resolve().parent.parent
STEM = ROOT / "results" / "contact" / "stability"
MOST = 1e5  # [N/m] where the search ends

# body → title, cases in the order of the legend: name in the table → label, colour, dashes, size of the mark: larger where
# another curve lies on it
PANELS = {
    "wall": ("A wall", {
        "71 Hz re_evaluate": ("71 Hz, re_evaluate", 4, 0, 8), "1 kHz": ("1 kHz, force of the place", 0, 0, 4),
        "1 kHz mean": ("1 kHz, mean over the motion", 3, 2, 4), "71 Hz hold": ("71 Hz, hold", 1, 0, 4),
        "71 Hz hold mean": ("71 Hz, hold, mean (the paper)", 5, 2, 4)}),
    "elastic": ("A body of 389 N/m", {
        "71 Hz re_evaluate": ("71 Hz, re_evaluate", 4, 0, 8), "1 kHz": ("1 kHz physics", 0, 0, 4),
        "71 Hz hold": ("71 Hz, hold", 1, 0, 4)}),
}


def read_table():
    with open(STEM.with_suffix(".csv"), encoding="ascii") as file:
        return [{key: value if key in ("body", "case") else float(value) for key, value in row.items()}
                for row in csv.DictReader(file)]


def draw_panel(axes, rows, body):
    title, labels = PANELS[body]
    for number, (case, (label, colour, dashes, size)) in enumerate(labels.items()):
        mine = [row for row in rows if row["body"] == body and row["case"] == case]
        damping = [row["damping_N_s_per_m"] for row in mine]
        style = {"color": COLOURS[colour], "markersize": size}
        axes.loglog(damping, [row["nudge_N_per_m"] for row in mine], marker="o", linestyle=DASHES[dashes],
                    label=label, **style)
        # Beside each other, where many are equal.
        aside = 1.045 ** (number - 0.5 * (len(labels) - 1))
        axes.loglog([aside * b for b in damping], [row["drop_passivity_N_per_m"] for row in mine], marker="^", linestyle="none",
                    markerfacecolor="none", color=COLOURS[colour], markersize=4)
    axes.axhline(MOST, color=GREY, linewidth=0.8)
    axes.annotate("search ends", (0.7, MOST), color=GREY, fontsize=8, xytext=(0, 6), textcoords="offset points", ha="center")
    damping = np.array([0.1, 5.0])
    for period, name in ((0.001, "2b/δ"), (0.014, "2b/T")):
        axes.loglog(damping, 2.0 * damping / period, color=GREY, linewidth=0.8, linestyle=":")
        axes.annotate(name, (damping[1], 2.0 * damping[1] / period), color=GREY, fontsize=8, ha="left", va="center",
                      xytext=(9, 0), textcoords="offset points")
    axes.set_ylim(6.0, 3.5 * MOST)
    axes.set_title(title)
    axes.set_xlabel("operator's damping b [N s/m]")
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.2), title_fontsize=8,
                title="hollow triangles, side by side: where it bounces,\nwith the passivity controller")


def draw(rows):
    figure, axes = plt.subplots(1, 2, figsize=(170 * MILLIMETRES, 105 * MILLIMETRES), sharey=True)
    for panel, body in zip(axes, PANELS):
        draw_panel(panel, rows, body)
    axes[0].set_ylabel("largest stable contact stiffness [N/m]")
    return figure


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", maxsplit=1)[0])
    parser.add_argument("--build", type=Path, default=ROOT / "build", metavar="BUILD")
    parser.add_argument("--table-as-it-is", action="store_true")
    options = parser.parse_args()
    if not options.table_as_it_is:
        subprocess.run(["cmake", "--build", options.build, "--target", "argil_stability_table"], check=True)
        made = subprocess.run([options.build / "bin" / "argil_stability_table"], check=True, capture_output=True)
        STEM.with_suffix(".csv").write_bytes(made.stdout)
    ap.save(draw(read_table()), STEM)


if __name__ == "__main__":
    main()
