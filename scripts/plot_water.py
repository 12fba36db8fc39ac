#!/usr/bin/python3
"""Draws where the water of a run is: saturation, the water ledger, and by how much the ledger fails to close.

Usage: plot_water.py RESULT.h5 [-o STEM]     → STEM.png, STEM.pdf
"""
import argparse

import argil_plot as ap
from argil.plot.water_figure import make_figure


@ap.refusing
def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("file", metavar="RESULT.h5")
    parser.add_argument("-o", "--output", default="water", metavar="STEM", help="default: water")
    options = parser.parse_args()
    ap.save(make_figure(options.file), options.output)


if __name__ == "__main__":
    main()
