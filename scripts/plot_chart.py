#!/usr/bin/python3
"""Draws a chart of `argil chart`: error against cost, a curve a method, the Pareto front marked. Every run has its
mark: along the top those without an error, at the left those without a cost.

Usage: plot_chart.py TABLE.csv [-o STEM] [--error force_error] [--title TITLE]      writes STEM.png, STEM.pdf
"""
import argparse
from pathlib import Path

import argil_plot as ap
from argil.plot.chart_figure import ERROR, LABELS, make_figure


@ap.refusing
def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", maxsplit=1)[0])
    parser.add_argument("table", type=Path, metavar="TABLE.csv")
    parser.add_argument("-o", "--output", type=Path, metavar="STEM")
    parser.add_argument("--error", default=ERROR, choices=LABELS)
    parser.add_argument("--title", default="")
    options = parser.parse_args()
    ap.save(make_figure(options.table, options.error, options.title), options.output or options.table.with_suffix(""))


if __name__ == "__main__":
    main()
