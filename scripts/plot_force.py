#!/usr/bin/python3
"""Draws the size of the force at the hand against time, one line a run, and a closer look at the strongest press.

Usage: plot_force.py A.h5 [B.h5 ...] [--labels A B ...] [--align-press] [--from SECONDS] [--smooth SECONDS]
                     [-o STEM]
"""
import argparse

import argil_plot as ap
from argil.plot.force_figure import make_figure


@ap.refusing
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
    ap.save(make_figure(options.files, options.labels, options.align_press, options.smooth, options.start),
            options.output)


if __name__ == "__main__":
    main()
