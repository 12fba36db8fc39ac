#!/usr/bin/python3
"""One elastic press in argil and in other programs: how far off each one's force is, and what it costs.

A rigid ball of 8 mm goes 2 mm into the middle of a block of 60 × 60 × 30 mm that is held at its underside, without friction, and stays
there. Meshes are the same for all. Programs that are not there are left out, with a word that says how to get them.

At this depth laws of elasticity differ by half, so each force stands beside the limit of its own law. reference.csv has the limits,
which --reference finds anew in half an hour.

Usage: peers.py [--argil PROGRAM] [-o FOLDER] [--quick]         writes FOLDER/peers.csv, peers.png and peers.pdf
       peers.py --reference [LAW …]                             writes FOLDER/reference.csv
"""
import argparse
import csv
import math
import statistics
import tempfile
from pathlib import Path

import argil_plot as ap
import provenance
from argil_plot import plt
from peer_programs import with_argil, with_bullet, with_calculix, with_mujoco

ROOT = Path(__file__).resolve().parent.parent
COLUMNS = ("program", "version", "law", "element", "tets", "nodes", "step_ms", "force_N", "swing_percent", "limit_N",
           "error_percent", "cpu_s", "repeats")
UNSTEADY = 0.5  # swing of a force that is held, over its median, from which on a run counts as unstable
QUICK = ((4, 10), (4, 0.2), (4, None))  # cells and step [ms] of what --quick makes
SHORT = 10  # runs of less CPU time are made three times [s]
PROGRAMS = ("argil", "Bullet", "MuJoCo", "CalculiX")
SVK, COROTATIONAL, LINEAR = "Saint Venant-Kirchhoff", "corotational", "linear"


def read_limits(folder):
    """Limit of each law and how certain it is [N]: the finest mesh, and the change from the one before."""
    limits = {}
    for row in read_table(folder / "reference.csv")[1]:
        if row["is_limit"] == "yes":
            limits[row["law"]] = float(row["force_N"]), float(row["error_N"])
    return limits


def list_presses(argil, tools, is_quick):
    """(program, version, law, element, step [ms] or None, function of a folder) of every press, in the chart's order."""
    presses = []
    for element, steps in (("p1", {4: (1, 10, 50), 6: (1, 10, 50), 8: (1, 10, 50), 11: (1, 10, 50)}),
                           ("p2", {4: (1, 10, 50), 5: (10, 50), 6: (10, 50), 7: (10, 50)})):
        for cells, milliseconds in steps.items():
            presses += [("argil", "", COROTATIONAL, element, cells, ms,
                         lambda folder, cells=cells, ms=ms, element=element: with_argil.press(
                             folder, argil, cells, ms / 1e3, element=element)) for ms in milliseconds]
    word = with_bullet.why_not()
    if word:
        print(f"Bullet is left out: {word}")
    else:
        program = with_bullet.build(tools)
        for cells, milliseconds in {4: (1, 5, 10), 6: (1, 5)}.items():
            presses += [("Bullet", with_bullet.version(), COROTATIONAL, "p1", cells, ms,
                         lambda folder, cells=cells, ms=ms: with_bullet.press(folder, program, cells, ms / 1e3)) for ms in milliseconds]
    word = with_mujoco.why_not(tools)
    if word:
        print(f"MuJoCo is left out: {word}")
    else:
        presses += [("MuJoCo", "", SVK, "p1", cells, ms,
                     lambda folder, cells=cells, ms=ms: with_mujoco.press(folder, tools, cells, ms / 1e3))
                    for cells, milliseconds in ((4, (0.5, 0.2)), (5, (0.2, 0.1)), (6, (0.2, 0.1))) for ms in milliseconds]
    word = with_calculix.why_not()
    if word:
        print(f"CalculiX is left out: {word}")
    else:
        presses += [("CalculiX", with_calculix.version(), SVK, kind, cells, None,
                     lambda folder, kind=kind, cells=cells: with_calculix.press_as_peer(folder, kind, cells))
                    for kind, meshes in (("C3D8", (4, 6, 8)), ("C3D4", (4, 6)), ("C3D10", (4,))) for cells in meshes]
    return [press for press in presses if not is_quick or press[4:6] in QUICK and press[3] != "C3D10"]


def off(force, law, limits):
    return f"{100 * (force / limits[law][0] - 1):.1f}"


def measure(press, limits, repeats):
    """A row of the table."""
    program, version, law, element, _, ms, run = press
    with tempfile.TemporaryDirectory(prefix="argil_peers_") as name:
        results = [run(Path(name))]
        if results[0]["cpu_s"] < SHORT:
            results += [run(Path(name)) for _ in range(repeats - 1)]
    result = results[0]
    swing = result["swing_N"] / abs(result["force_N"]) if result["force_N"] else math.inf
    is_stable = math.isfinite(result["force_N"]) and swing < UNSTEADY
    return dict(zip(COLUMNS, (
        program, result.get("version", version), law, element, result["tets"], result["nodes"], "static" if ms is None else ms,
        f"{result['force_N']:.5g}" if is_stable else "unstable", f"{100 * swing:.2g}" if is_stable else "", f"{limits[law][0]:.5g}",
        off(result["force_N"], law, limits) if is_stable else "",
        f"{statistics.median(r['cpu_s'] for r in results):.3g}", len(results))))


def draw(rows, limits, stem):
    """An error that is less than how certain the limit is stands where that is: it cannot be told."""
    figure, axis = plt.subplots(figsize=(7.0, 4.2), layout="constrained")
    rows = [row for row in rows if row["force_N"] != "unstable"]
    for number, kind in enumerate(dict.fromkeys((row["program"], row["element"]) for row in rows)):
        mine = [row for row in rows if (row["program"], row["element"]) == kind]
        steps = list(dict.fromkeys(str(row["step_ms"]) for row in mine))
        for step in steps:
            points = [row for row in mine if str(row["step_ms"]) == step]
            seconds = [float(row["cpu_s"]) for row in points]
            errors = []
            for row in points:
                value, uncertain = limits[row["law"]]
                errors.append(max(abs(float(row["error_percent"])), 100 * uncertain / value))
            colour = [*ap.COLOURS, ap.GREY][number % 7]
            axis.plot(seconds, errors, marker=ap.MARKS[number % len(ap.MARKS)], color=colour, markersize=5, linewidth=1,
                      fillstyle="full" if step == steps[0] else "none", linestyle="-" if step == steps[0] else ":",
                      label=", ".join(kind) if step == steps[0] else None)
            if step != "static":
                axis.annotate(f"{step} ms", (seconds[0], errors[0]), xytext=(0, 5), textcoords="offset points", ha="center",
                              fontsize="x-small", color=colour)
    for law, colour in ((COROTATIONAL, ap.COLOURS[0]), (SVK, ap.COLOURS[5])):
        value, uncertain = limits[law]
        axis.axhline(100 * uncertain / value, color=colour, linewidth=0.8, dashes=(6, 3))
        axis.annotate(f"limit of the {law} law: this certain", (0.99, 100 * uncertain / value), xycoords=("axes fraction", "data"),
                      xytext=(0, -8), textcoords="offset points", ha="right", fontsize="x-small", color=colour)
    axis.set(xscale="log", yscale="log", xlabel="CPU time of the press on one thread (s)", ylabel="error of the force (%)",
             ylim=(0.3, 150))
    axis.legend(loc="upper left", bbox_to_anchor=(1.01, 1), frameon=False, fontsize="small")
    ap.save(figure, stem)


def read_table(file):
    """Its first line's words and its rows."""
    lines = file.read_text(encoding="utf-8").splitlines()
    return lines[0].removeprefix("# "), list(csv.DictReader(lines[1:]))


def write_table(file, columns, rows, heading):
    file.parent.mkdir(parents=True, exist_ok=True)
    with open(file, "w", newline="", encoding="utf-8") as out:
        out.write(f"# {heading}\n")
        writer = csv.DictWriter(out, columns, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def find_limits(argil, output, laws):
    """Finer and finer meshes of these laws; the table keeps what it has of others."""
    columns = ("law", "program", "element", "contact", "cells", "nodes", "force_N", "cpu_s", "error_N", "is_limit")
    file = output / "reference.csv"
    rows = [row for row in read_table(file)[1] if row["law"] not in laws] if file.is_file() else []

    def add(law, program, element, contact, meshes, press):
        before = None
        for cells in meshes:
            with tempfile.TemporaryDirectory(prefix="argil_peers_") as name:
                result = press(Path(name), cells)
            force = result["force_N"]
            rows.append(dict(zip(columns, (
                law, program, element, contact, cells, result["nodes"], f"{force:.5f}", f"{result['cpu_s']:.3g}",
                "" if before is None else f"{abs(force - before):.5f}", "no"))))
            before = force
            print(*rows[-1].values(), flush=True)
        return rows[-1]

    for law in (law for law in (SVK, LINEAR) if law in laws):
        best, other = (add(law, "CalculiX", element, contact.lower(), meshes,
                           lambda folder, cells, element=element, contact=contact, law=law: with_calculix.press(
                               folder, element, cells, is_quarter=True, is_large=law == SVK, contact=contact,
                               fine=40 if element == "C3D20" else 24))
                       for element, contact, meshes in (("C3D20", "SURFACE TO SURFACE", (4, 6, 8)),
                                                        ("C3D8", "NODE TO SURFACE", (8, 12))))
        # Other elements that touch in another way tell how certain the finest mesh is, besides its change from the one before.
        error = float(best["error_N"]) + abs(float(best["force_N"]) - float(other["force_N"]))
        best.update(is_limit="yes", error_N=f"{error:.5f}")
    if COROTATIONAL in laws:
        add(COROTATIONAL, "argil", "p2", "pressure", (4, 5, 6, 7, 8),
            lambda folder, cells: with_argil.press(folder, argil, cells, 0.05, element="p2"))["is_limit"] = "yes"
    write_table(file, columns, rows, provenance.describe())


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", maxsplit=1)[0])
    parser.add_argument("--argil", type=Path, default=ROOT / "build/bin/argil", metavar="PROGRAM")
    parser.add_argument("-o", "--output", type=Path, default=ROOT / "results/peers", metavar="FOLDER")
    parser.add_argument("--tools", type=Path, default=ROOT / "build/peers", metavar="FOLDER",
                        help="where Bullet's program is compiled and npm has put MuJoCo")
    parser.add_argument("--quick", action="store_true", help="the coarsest mesh in one step each, and once")
    parser.add_argument("--reference", nargs="*", choices=(SVK, COROTATIONAL, LINEAR), metavar="LAW",
                        help="find the limits of these laws anew, or of all")
    parser.add_argument("--only", nargs="+", choices=PROGRAMS, metavar="PROGRAM", help="rows of these anew, in the table that is there")
    parser.add_argument("--repeats", type=int, default=3, help=f"of runs of less than {SHORT} s; their median is taken")
    parser.add_argument("--draw", action="store_true", help="errors and figure alone, from the forces that are in the table")
    options = parser.parse_args()
    argil = options.argil.resolve()
    if options.reference is not None:
        return find_limits(argil, options.output, options.reference or (SVK, COROTATIONAL, LINEAR))
    stem = options.output / "peers"
    limits = read_limits(ROOT / "results/peers")
    if options.draw:
        heading, rows = read_table(stem.with_suffix(".csv"))
        for row in rows:
            if row["force_N"] != "unstable":
                row.update(limit_N=f"{limits[row['law']][0]:.5g}", error_percent=off(float(row["force_N"]), row["law"], limits))
    else:
        heading, rows = provenance.describe(), []
        for press in list_presses(argil, options.tools, options.quick):
            if not options.only or press[0] in options.only:
                rows.append(measure(press, limits, 1 if options.quick else options.repeats))
                print(*rows[-1].values(), flush=True)
        if options.only:
            others = [row for row in read_table(stem.with_suffix(".csv"))[1] if row["program"] not in options.only]
            rows = sorted(others + rows, key=lambda row: PROGRAMS.index(row["program"]))
    write_table(stem.with_suffix(".csv"), COLUMNS, rows, heading)
    return draw(rows, limits, stem)


if __name__ == "__main__":
    main()
