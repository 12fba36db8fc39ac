#!/usr/bin/python3
"""The pressure law against Hertz and Sneddon: force at the hand over the closed form on the blocks of plot_hertz.py, with the
stiffness that argil chooses and with twice that.

Usage: pressure_table.py ARGIL [-o FILE.csv] [--quick]      writes results/contact/pressure.csv
"""
import argparse
import tempfile
from pathlib import Path

import plot_hertz

from table_file import write_table

CHOSEN = 80  # kappa is so many times E* over the cell
CELL = (6 * 2**0.5 / 6) ** (1 / 3)  # edge of a regular tet that has a sixth of a cube's volume, over the cube's edge


def press(argil, folder, tool, cells, times, steepness):
    plot_hertz.STEEPNESS = steepness
    contact = {"law": "pressure"}
    if times != 1:
        cell = plot_hertz.CONTACT_RADIUS / cells * CELL
        contact["stiffness_Pa_per_m"] = times * CHOSEN * plot_hertz.REDUCED / cell
    return plot_hertz.press(argil, folder, tool, cells, contact, "p1")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", maxsplit=1)[0])
    parser.add_argument("argil", type=Path)
    parser.add_argument("-o", "--output", type=Path, default=plot_hertz.ROOT / "results/contact/pressure.csv", metavar="FILE")
    parser.add_argument("--quick", action="store_true", help="without the finest mesh")
    options = parser.parse_args()
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for tool in ("sphere", "cone", "punch"):
            for cells in (2, 4) if options.quick else (2, 4, 8):
                for steepness in (0.1, 0.001):  # closed forms are those of small slopes
                    force = [press(options.argil, Path(folder), tool, cells, times, steepness)[0] for times in (1, 2)]
                    rows.append([tool, cells, steepness, f"{force[0]:.4f}", f"{force[1] / force[0] - 1:.4f}"])
                    print(*rows[-1], flush=True)
    write_table(options.output, ["tool", "cells_per_contact_radius", "slope", "force_over_closed_form",
                                 "change_when_stiffness_doubles"], rows)


if __name__ == "__main__":
    main()
