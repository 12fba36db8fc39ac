#!/usr/bin/python3
"""Do ten-node tets near the tool and four-node ones away from it pay? A block of linear elastic clay bears Hertz's pressure of a ball, once in
ten-node tets, once in four-node ones, and with ten-node tets as far as so many radii of contact from the tool: there the middle of an edge that no
nearer tet has lies midway between its ends, which conforms. The work that the load does is its compliance; its error is that of a force.

Usage: mixed_orders.py ARGIL [-o TABLE.csv]     writes results/accuracy/mixed.csv
Columns: size of the cells near the tool over the radius of contact; reach of the ten-node tets over that radius (0: all four-node, inf: all
ten-node); tets; free unknowns; numbers in the upper half of the matrix; error of the work [%], against ten-node tets of the finest row.
"""
import argparse
import json
import subprocess
import tempfile
from pathlib import Path

import h5py
import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import cg
from table_file import write_table

ROOT = Path(__file__).resolve().parent.parent
EDGE, RADIUS, DEPTH, AT = 0.04, 0.01, 0.001, (0.0006, -0.0007)  # of the block, the ball, its press and where [m]
MODULUS, POISSON = 1e5, 0.3
PATCH = (RADIUS * DEPTH)**0.5  # Hertz's radius of contact [m]
EDGES = ((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3))
REACHES = (0.0, 1.5, 2.0, 3.0, 5.0, np.inf)
COLUMNS = ("cell_over_radius", "reach_over_radius", "tets", "unknowns", "matrix_numbers", "error_percent")


def make_mesh(argil, size, first):
    """Corners [m] and tets of a block whose cells are small where the ball comes."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        t = np.arange(3) * 1e-3
        height = EDGE + RADIUS - np.array([-1e-4, 0.5 * DEPTH, DEPTH])
        np.savetxt(folder / "press.csv", np.c_[t, 0 * t + AT[0], 0 * t + AT[1], height], delimiter=",", header="t,x,y,z", comments="")
        (folder / "scene.json").write_text(json.dumps({
            "about": "a mesh", "body": {"shape": {"kind": "box", "size_m": EDGE, "target_tets": first, "skin_triangles": 0},
                                        "cells": {"near_tool_m": size}, "fixed": [{"kind": "plane", "normal": [0, 0, 1], "offset_m": 0}]},
            "material": {"youngs_modulus_Pa": MODULUS, "poissons_ratio": POISSON, "plasticity": {"enabled": False}},
            "tool": {"shape": {"kind": "sphere", "radius_m": RADIUS}}, "trace": {"file": "press.csv"}}), encoding="ascii")
        subprocess.run([argil, "run", folder / "scene.json", "-o", folder / "run.h5", "--quiet"], check=True)
        with h5py.File(folder / "run.h5") as run:
            return run["mesh/rest_position"][:], run["mesh/tets"][:].astype(int)


def add_middles(x, tets):
    """Ten-node tets, corners first, and the two ends of every edge."""
    pairs = np.sort(np.stack([tets[:, list(pair)] for pair in EDGES], axis=1), axis=2)
    edges, number = np.unique(pairs.reshape(-1, 2), axis=0, return_inverse=True)
    return np.r_[x, x[edges].mean(axis=1)], np.c_[tets, len(x) + number.reshape(-1, 6)], edges


def shape_slopes(barycentric):
    """∂N/∂λ (10×4) of a ten-node tet."""
    slopes = np.zeros((10, 4))
    for i in range(4):
        slopes[i, i] = 4 * barycentric[i] - 1
    for k, (i, j) in enumerate(EDGES):
        slopes[4 + k, i], slopes[4 + k, j] = 4 * barycentric[j], 4 * barycentric[i]
    return slopes


def assemble(x, ten):
    lam, mu = MODULUS * POISSON / ((1 + POISSON) * (1 - 2 * POISSON)), MODULUS / (2 * (1 + POISSON))
    corners = x[ten[:, :4]]
    sides = (corners[:, 1:] - corners[:, :1]).transpose(0, 2, 1)
    inverse = np.linalg.inv(sides)
    of_corner = np.concatenate([-inverse.sum(axis=1, keepdims=True), inverse], axis=1)  # ∂λ/∂x
    volume = np.abs(np.linalg.det(sides)) / 6
    near, far = (5 - 5**0.5) / 20, (5 + 3 * 5**0.5) / 20
    block = np.zeros((len(ten), 10, 3, 10, 3))
    for p in range(4):
        point = np.full(4, near)
        point[p] = far
        g = np.einsum("nk,tki->tni", shape_slopes(point), of_corner)
        w = volume / 4
        block += lam * np.einsum("t,tai,tbj->taibj", w, g, g) + mu * np.einsum("t,taj,tbi->taibj", w, g, g)
        same = mu * np.einsum("t,tak,tbk->tab", w, g, g)
        for i in range(3):
            block[:, :, i, :, i] += same
    unknown = (3 * ten[:, :, None] + np.arange(3)).reshape(len(ten), 30)
    rows, columns = np.repeat(unknown, 30, axis=1).ravel(), np.tile(unknown, (1, 30)).ravel()
    return sp.csr_matrix((block.reshape(-1), (rows, columns)), shape=(3 * len(x), 3 * len(x)))


def load_top(x, ten, edges_of_node):
    """Hertz's pressure on the top, by many points in each of its faces, to ten-node shape functions."""
    force = np.zeros(3 * len(x))
    peak = 2 * MODULUS / (1 - POISSON**2) / np.pi * PATCH / RADIUS
    parts = 40
    points = np.array([((i + 1 / 3) / parts, (j + 1 / 3) / parts) for i in range(parts) for j in range(parts - i)]
                      + [((i + 2 / 3) / parts, (j + 2 / 3) / parts) for i in range(parts) for j in range(parts - i - 1)])
    points = np.c_[points, 1 - points.sum(axis=1)]
    top = np.abs(x[:, 2] - EDGE) < 1e-9
    for tet in ten:
        for face in ((0, 1, 2), (0, 1, 3), (0, 2, 3), (1, 2, 3)):
            v = tet[list(face)]
            if not top[v].all():
                continue
            place = points @ x[v]
            r = np.hypot(place[:, 0] - AT[0], place[:, 1] - AT[1])
            if r.min() > PATCH:
                continue
            area = 0.5 * np.linalg.norm(np.cross(x[v[1]] - x[v[0]], x[v[2]] - x[v[0]]))
            pressure = peak * np.sqrt(np.maximum(0, 1 - (r / PATCH)**2)) * area / len(points)
            for k in range(3):
                force[3 * v[k] + 2] -= (pressure * points[:, k] * (2 * points[:, k] - 1)).sum()
                a, b = v[k], v[(k + 1) % 3]
                middle = edges_of_node[(min(a, b), max(a, b))]
                force[3 * middle + 2] -= (pressure * 4 * points[:, k] * points[:, (k + 1) % 3]).sum()
    return force


def solve(matrix, force, x, ten, edges, reach):
    """Work of the load, unknowns and numbers in the matrix, with ten-node tets up to `reach` radii of contact."""
    num_corners = len(x) - len(edges)
    centre = x[ten[:, :4]].mean(axis=1) - np.array([*AT, EDGE])
    is_near = np.linalg.norm(centre, axis=1) < reach * PATCH
    is_free = np.r_[np.ones(num_corners, bool), np.zeros(len(edges), bool)]
    is_free[ten[is_near].ravel()] = True
    number = np.cumsum(is_free) - 1
    rows, columns, values = [np.flatnonzero(is_free)], [number[is_free]], [np.ones(is_free.sum())]
    bound = np.flatnonzero(~is_free)
    for end in range(2):
        rows.append(bound)
        columns.append(number[edges[bound - num_corners, end]])
        values.append(np.full(len(bound), 0.5))
    nodes = sp.csr_matrix((np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))), shape=(len(x), is_free.sum()))
    share = sp.kron(nodes, sp.identity(3), format="csr")
    held = np.repeat(x[is_free][:, 2] < 1e-9, 3)
    small = (share.T @ matrix @ share).tocsr()[~held][:, ~held]
    small.eliminate_zeros()
    loads = (share.T @ force)[~held]
    moved, failure = cg(small, loads, M=sp.diags(1 / small.diagonal()), tol=1e-9, maxiter=20000)
    assert failure == 0
    work = loads @ moved
    return work, len(loads), (small.nnz + len(loads)) // 2


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("argil", type=Path)
    parser.add_argument("-o", "--output", type=Path, default=ROOT / "results/accuracy/mixed.csv")
    options = parser.parse_args()
    rows = []
    for size, first in ((1.0, 300), (0.5, 700), (0.25, 1500)):
        corners, tets = make_mesh(options.argil.resolve(), size * PATCH, first)
        x, ten, edges = add_middles(corners, tets)
        middles = {tuple(edge): len(corners) + k for k, edge in enumerate(edges.tolist())}
        matrix, force = assemble(x, ten), load_top(x, ten, middles)
        for reach in REACHES:
            rows.append([size, reach, len(tets), *solve(matrix, force, x, ten, edges, reach)])
    limit = rows[-1][3]
    rows = [[size, reach, count, unknowns, numbers, f"{100 * (work / limit - 1):.2f}"] for size, reach, count, work, unknowns, numbers in rows]
    for row in rows:
        print(*row, sep="  ")
    write_table(options.output, COLUMNS, rows)


if __name__ == "__main__":
    main()
