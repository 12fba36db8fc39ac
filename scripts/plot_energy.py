#!/usr/bin/python3
"""Draws where the energy of runs goes: what the hand and the contact give, what the body holds, what flow dissipates.

Usage: plot_energy.py A.h5 [B.h5 ...] [--labels A B ...] [-o STEM]     → STEM.png, STEM.pdf, a panel a run
"""
import argparse

import argil_plot as ap
from argil.plot.energy_figure import make_figure


@ap.refusing
def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("files", nargs="+", metavar="RESULT.h5")
    parser.add_argument("--labels", nargs="+", help="one a file; default: the files' names")
    parser.add_argument("-o", "--output", default="energy", metavar="STEM", help="default: %(default)s")
    options = parser.parse_args()
    ap.save(make_figure(options.files, options.labels), options.output)


if __name__ == "__main__":
    main()
