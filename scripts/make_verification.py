#!/usr/bin/python3
"""Rebuild results/verification: the tables by the solid's own code, the figures from the tables.

    scripts/make_verification.py [--build BUILD] [--tables-as-they-are]

Takes a minute or two on one core.
"""
import argparse
import csv
import os
import subprocess
import sys
from pathlib import Path

import argil_plot
from argil_plot import COLOURS, GREY, MILLIMETRES, plt
from argil.plot.style import entries_of, put_legend

ROOT = Path(__file__).resolve().parent.parent
FOLDER = ROOT / "results" / "verification"
STYLE = {name: {"color": COLOURS[i], "marker": "os^D"[i], "markersize": 4}
         for group in (("p1", "p1_nodal", "p2"), ("backward_euler", "bdf2", "newmark", "symplectic_euler"))
         for i, name in enumerate(group)}
ALIKE = 0.005  # of a ratio: lines that lie on each other
ROUNDING = 1e-7  # changes below are drawn there, for a curve at rounding would squeeze the others


def make_tables(build):
    subprocess.run(["cmake", "--build", build, "--target", "argil_solid_tables"], check=True)
    FOLDER.mkdir(parents=True, exist_ok=True)
    one_thread = {**os.environ, "OPENBLAS_NUM_THREADS": "1"}  # its threads change bits, and wait for each other
    subprocess.run([Path(build) / "bin" / "argil_solid_tables", FOLDER], check=True, env=one_thread)


def read(name):
    """Rows of a table, numbers as numbers."""
    def value(text):
        try:
            return float(text)
        except ValueError:
            return text
    with open(FOLDER / f"{name}.csv", encoding="utf-8") as file:
        return [{key: value(text) for key, text in row.items()} for row in csv.DictReader(file)]


def groups(rows, key):
    """Rows by the value of a column, in the order of the table."""
    found = {}
    for row in rows:
        found.setdefault(row[key], []).append(row)
    return found.items()


def draw_slope(axes, x, y, order):
    """A grey line of the given order through a point, over a factor of four to its left."""
    axes.loglog([x / 4.0, x], [y * 4.0 ** -order, y], color=GREY, linewidth=0.8, linestyle=":")
    axes.annotate(f"{order}", (x / 2.0, y * 2.0 ** -order), color=GREY, fontsize=8, ha="left", va="top",
                  xytext=(3, -2), textcoords="offset points")


def make_figure(columns, height=72):
    figure, axes = plt.subplots(1, columns, figsize=(170 * MILLIMETRES, height * MILLIMETRES))
    return figure, axes


def save(figure, name):
    argil_plot.save(figure, FOLDER / name)


def draw_manufactured():
    figure, panels = make_figure(2)
    slopes = {"l2": ((0.25, 0.1, 2), (0.25, 0.01, 3)), "h1": ((0.25, 0.35, 1), (0.25, 0.06, 2))}
    for axes, norm, title in zip(panels, ("l2", "h1"), ("displacement, $L^2$", "its gradient, $H^1$")):
        for element, rows in groups(read("manufactured"), "element"):
            axes.loglog([1.0 / r["cells"] for r in rows], [r[norm] for r in rows], label=element, **STYLE[element])
        for slope in slopes[norm]:
            draw_slope(axes, *slope)
        axes.set_xticks([1 / 2, 1 / 4, 1 / 8, 1 / 16], ["1/2", "1/4", "1/8", "1/16"])
        axes.minorticks_off()
        axes.set(xlabel="cell of the unit cube [–]", ylabel="relative error [–]", title=title)
    panels[0].legend()
    save(figure, "manufactured")


def draw_beams():
    figure, panels = make_figure(5)
    for axes, name, found, exact, title in zip(
            panels, ("cantilever", "torsion", "twisted_beam", "cook", "cook_plane_strain"),
            ("deflection_m", "constant", "tip", "tip", "tip"),
            ("timoshenko_m", "saint_venant", "literature", "literature", "fine"),
            ("cantilever", "torsion", "twisted beam", "Cook, ν = ⅓", "Cook, ν = 0.4999")):
        for (element, force), rows in groups(
                [{**r, "who": (r["element"], r.get("force"))} for r in read(name)], "who"):
            along_thickness = force == "along_thickness"
            axes.semilogx([r["cells"] for r in rows], [r[found] / r[exact] for r in rows],
                          linestyle="--" if along_thickness else "-",
                          label=None if along_thickness else element, **STYLE[element])
        axes.axhline(1.0, color=GREY, linewidth=0.8)
        ticks = sorted({int(r["cells"]) for r in read(name)})
        axes.set_xticks(ticks, [str(t) for t in ticks])
        axes.minorticks_off()
        axes.set(xlabel="cells across [–]", title=title)
    panels[0].set_ylabel("over the reference [–]")
    panels[2].plot([], [], color=GREY, linestyle="--", label="twisted beam: force along the thickness")
    put_legend(figure, *entries_of(panels[4], panels[2]))
    save(figure, "beams")


def draw_locking():
    figure, axes = make_figure(1)
    linear, lines = {}, {}
    for (element, model), rows in groups(
            [{**r, "who": (r["element"], r["model"])} for r in read("locking")], "who"):
        ratios = [r["deflection_m"] / r["reference_m"] for r in rows]
        if model == "linear":
            linear[element] = ratios
        elif max(abs(one - other) for one, other in zip(ratios, linear[element])) < ALIKE:
            lines[element].set_label(f"{element}: linear, corotational and neo-Hookean lie on each other")
            continue
        dashes = {"linear": "-", "corotational": "--", "neo_hookean": ":"}[model]
        label = element if model == "linear" else f"{element}, {model}"
        lines[element], = axes.semilogx([0.5 - r["poissons_ratio"] for r in rows], ratios, linestyle=dashes, label=label, **STYLE[element])
    axes.axhline(1.0, color=GREY, linewidth=0.8)
    axes.invert_xaxis()
    axes.set(xlabel="½ − ν [–]", ylabel="tip deflection over the fine one [–]", ylim=(0, 1.08),
             title="bar 5 : 1; p1 four cells across, p2 two")
    put_legend(figure, *entries_of(axes))
    save(figure, "locking")


def draw_time():
    figure, panels = make_figure(3, 80)
    for integrator, rows in groups(read("swing"), "integrator"):
        panels[0].loglog([0.05 / r["steps"] for r in rows], [r["error"] for r in rows], label=integrator,
                         **STYLE[integrator])
    draw_slope(panels[0], 1e-3, 1.5e-2, 1)
    draw_slope(panels[0], 1e-3, 1.5e-3, 2)
    panels[0].set(xlabel="step [s]", ylabel="relative error [–]", title="thrown bar")
    for axes, drift in zip(panels[1:], ("energy_drift", "momentum_drift")):
        for (integrator, iteration), rows in groups(
                [{**r, "who": (r["integrator"], r["iteration"])} for r in read("spin")], "who"):
            axes.loglog([1.0 / r["steps_a_turn"] for r in rows], [max(r[drift], ROUNDING) for r in rows],
                        linestyle="-" if iteration == "newton" else "--", **STYLE[integrator])
        axes.set(xlabel="step over turn [–]", title={"energy_drift": "free turn: energy change [–]",
                                                     "momentum_drift": f"its angular momentum [–]\n(at the bottom: {ROUNDING:g} or less)"}[drift])
    panels[1].plot([], [], color=GREY, label="Newton")
    panels[1].plot([], [], color=GREY, linestyle="--", label="one step")
    put_legend(figure, *entries_of(*panels))
    save(figure, "time")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--build", default=str(ROOT / "build"), help="CMake's build folder")
    parser.add_argument("--tables-as-they-are", action="store_true", help="draw only")
    options = parser.parse_args()
    if not options.tables_as_they_are:
        make_tables(options.build)
    draw_manufactured()
    draw_beams()
    draw_locking()
    draw_time()


if __name__ == "__main__":
    sys.exit(main())
