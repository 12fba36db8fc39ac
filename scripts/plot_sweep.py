#!/usr/bin/python3
"""Draws a figure of `argil sweep collect` against one setting, a line for each combination of the others.

Usage: plot_sweep.py TABLE.csv [-o STEM] [--x SETTING] [--y FIGURE] [--only SETTING=VALUE ...]  → STEM.png, STEM.pdf

Colours tell the values of the other setting with the most, dashes those of one more; where more vary, --only says at
which value. A setting that is text is an axis of names. What had no figure is counted in the picture and on stderr.
"""
import argparse
from pathlib import Path

import argil_plot as ap
from argil.plot.sweep_figure import FIRST_FIGURE, make_figure


@ap.refusing
def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("table", type=Path, metavar="TABLE.csv")
    parser.add_argument("-o", "--output", type=Path, metavar="STEM", help="default: the table's name")
    parser.add_argument("--x", metavar="SETTING", help="default: the first setting of the table that varies")
    parser.add_argument("--y", default=FIRST_FIGURE, metavar="FIGURE", help="default: %(default)s")
    parser.add_argument("--only", nargs="+", default=[], metavar="SETTING=VALUE", help="the points where that holds")
    options = parser.parse_args()
    figure = make_figure(options.table, options.x, options.y, options.only)
    ap.save(figure, options.output or options.table.with_suffix(""))


if __name__ == "__main__":
    main()
