#!/usr/bin/python3
"""What of the error of plot_hertz.py is the mesh's: its presses on the same blocks of linear tetrahedra, by a few lines of scipy
instead of argil, in which the tool moves nodes of the top and nothing else: those that a sphere presses on, and those within the
disc of a flat punch. What lies between these and argil's is a matter of how contact is found, not of the solver.

Usage: hertz_mesh.py [-o FILE.csv] [--quick]        writes results/contact/hertz_mesh.csv
"""
import argparse
import csv
import tempfile
from pathlib import Path

import plot_hertz as press
import scipy.sparse as sparse
from argil_plot import np
from scipy.sparse.linalg import cg

TOLERANCE = 1e-7  # of the residual
MAX_ROUNDS = 12  # of finding the nodes that bear the sphere


def read_block(folder, cells):
    stem = Path(folder) / f"block{cells}"
    press.write_block(stem, cells)
    return (np.loadtxt(stem.with_suffix(".node"), skiprows=1)[:, 1:4],
            np.loadtxt(stem.with_suffix(".ele"), skiprows=1, dtype=int)[:, 1:5])


def assemble(x, tets):
    """Stiffness matrix of linear isotropic elasticity, 3 rows a node."""
    lam = press.YOUNG * press.POISSON / ((1 + press.POISSON) * (1 - 2 * press.POISSON))
    mu = press.YOUNG / (2 * (1 + press.POISSON))
    edges = np.stack([x[tets[:, i]] - x[tets[:, 0]] for i in (1, 2, 3)], axis=2)
    volume = np.linalg.det(edges) / 6
    gradient = np.linalg.inv(edges)
    gradient = np.concatenate([-gradient.sum(axis=1, keepdims=True), gradient], axis=1)  # tet, corner, axis
    blocks = (np.einsum("m,mai,mbj->maibj", lam * volume, gradient, gradient)
              + np.einsum("m,maj,mbi->maibj", mu * volume, gradient, gradient)
              + np.einsum("m,mak,mbk,ij->maibj", mu * volume, gradient, gradient, np.eye(3)))
    rows = (3 * tets[:, :, None] + np.arange(3)).reshape(len(tets), 12)
    return sparse.csr_matrix((blocks.ravel(), (np.repeat(rows, 12, axis=1).ravel(), np.tile(rows, (1, 12)).ravel())),
                             shape=(3 * len(x), 3 * len(x)))


def solve(stiffness, held, values, guess):
    """Displacements in equilibrium with `values` at the rows `held`."""
    free = np.ones(len(guess), dtype=bool)
    free[held] = False
    u = np.zeros(len(guess))
    u[held] = values
    matrix = stiffness[free][:, free]
    u[free], status = cg(matrix, -(stiffness @ u)[free], x0=guess[free], tol=TOLERANCE,
                         M=sparse.diags(1 / matrix.diagonal()))
    assert status == 0
    return u


def compute_force(x, stiffness, tool):
    """Over the closed form. Frictionless: the tool moves nodes down alone."""
    depth, exact, height = press.shape_of(tool)
    far = press.HALF_WIDTH * (1 - 1e-9)
    held = [3 * np.flatnonzero(x[:, axis] < 1e-12) + axis for axis in (0, 1)]
    held += [3 * np.flatnonzero((x[:, 0] > far) | (x[:, 1] > far) | (x[:, 2] < -far)) + axis for axis in range(3)]
    held = np.unique(np.concatenate(held))
    radius = np.hypot(x[:, 0], x[:, 1])
    reach = press.CONTACT_RADIUS * (1.5 if tool == "sphere" else 1 + 1e-9)
    nodes = np.flatnonzero((x[:, 2] > -1e-12) & (radius < reach))
    low = -depth + height(radius[nodes])
    bears = low < 0
    u = np.zeros(3 * len(x))
    for _ in range(MAX_ROUNDS):
        u = solve(stiffness, np.concatenate([held, 3 * nodes[bears] + 2]),
                  np.concatenate([np.zeros(len(held)), low[bears]]), u)
        force = (stiffness @ u)[3 * nodes + 2]
        after = np.where(bears, force < 0, u[3 * nodes + 2] > low + 1e-12) if tool == "sphere" else bears
        if (after == bears).all():
            return -4 * force[bears].sum() / exact
        bears = after
    raise RuntimeError("the nodes that bear the sphere were not found")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", maxsplit=1)[0])
    parser.add_argument("-o", "--output", type=Path, default=press.ROOT / "results/contact/hertz_mesh.csv", metavar="FILE")
    parser.add_argument("--quick", action="store_true", help="without the finest mesh")
    options = parser.parse_args()
    widths = press.HALF_WIDTH * np.array([1, 0.5, 2])
    rows = []
    for cells, width in [(2, widths[0]), (4, widths[0]), (4, widths[1]), (4, widths[2]), (8, widths[0])]:
        if options.quick and cells == 8:
            continue
        press.HALF_WIDTH = width
        with tempfile.TemporaryDirectory() as folder:
            x, tets = read_block(folder, cells)
        stiffness = assemble(x, tets)
        for tool in ("sphere", "punch"):
            if width != widths[0] and tool == "punch":
                continue
            rows.append([tool, cells, round(width / press.CONTACT_RADIUS),
                         f"{compute_force(x, stiffness, tool):.4f}"])
            print(*rows[-1], flush=True)
    with open(options.output, "w", newline="", encoding="ascii") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["tool", "cells_per_contact_radius", "block_over_contact_radius", "force_over_closed_form"])
        table.writerows(rows)


if __name__ == "__main__":
    main()
