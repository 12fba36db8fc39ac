#!/usr/bin/python3
"""Draws a map of `argil stability`: what became of each run over one or two parameters, the boundaries found, and the
limits of theory.

Usage: plot_map.py TABLE.csv [-o STEM] [--title TITLE] [--forces METHOD REFERENCE]      writes STEM.png, STEM.pdf
With --forces a second panel has the largest hand force of the method and of the reference, which are given those names.
"""
import argparse
from pathlib import Path

import argil_plot as ap
from argil.plot.map_figure import make_figure


@ap.refusing
def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", maxsplit=1)[0])
    parser.add_argument("table", type=Path, metavar="TABLE.csv")
    parser.add_argument("-o", "--output", type=Path, metavar="STEM")
    parser.add_argument("--title", default="")
    parser.add_argument("--forces", nargs=2, metavar=("METHOD", "REFERENCE"))
    options = parser.parse_args()
    ap.save(make_figure(options.table, options.title, options.forces), options.output or options.table.with_suffix(""))


if __name__ == "__main__":
    main()
