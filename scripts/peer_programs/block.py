"""The press that every program makes, and its meshes: a rigid ball goes into the middle of a block that is held at its underside."""
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

WIDTH, HEIGHT = 0.06, 0.03  # of the block, whose top is z = 0 [m]
RADIUS, DEPTH = 0.008, 0.002  # of the ball; how deep it goes [m]
YOUNG, POISSON, DENSITY = 1e5, 0.3, 1500.0  # [Pa], [–], [kg/m³]
DOWN, END = 0.3, 1.0  # the ball is on its way down until the one, and at rest until the other [s]
HELD = 0.1  # the force is the mean over this last part of the motion [s]
GROWTH = 3.0  # cells under the ball are GROWTH / sinh(GROWTH) times those of an even mesh


def height_of_ball(t):
    """Of the lowest point of the ball over the block's top [m] at times t [s]: from touch to the depth, its speed without a jump."""
    return -DEPTH * 0.5 * (1 - np.cos(np.pi * np.minimum(t / DOWN, 1)))


def spaced(length, cells):
    """From 0 to `length`, small cells first."""
    return length * np.sinh(GROWTH * np.linspace(0, 1, cells + 1)) / np.sinh(GROWTH)


def make_grid(cells, is_quarter=False):
    """Nodes (N×3) [m] and hexahedra (M×8, as VTK and CalculiX number them) of the block; `cells`: from the middle to each side."""
    half = spaced(WIDTH / 2, cells)
    side = half if is_quarter else np.r_[-half[:0:-1], half]
    down = -spaced(HEIGHT, cells)[::-1]
    nodes = np.stack([axis.ravel() for axis in np.meshgrid(side, side, down, indexing="ij")], axis=1)
    n, m = len(side), len(down)
    number = np.arange(n * n * m).reshape(n, n, m)
    corners = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))
    hexes = np.stack([number[i:n - 1 + i, j:n - 1 + j, k:m - 1 + k].ravel() for i, j, k in corners], axis=1)
    return nodes, hexes


def cut_into_tets(hexes):
    """Six tets a hexahedron about its diagonal from the first to the seventh corner, so that neighbours' faces meet."""
    around = (1, 2, 3, 7, 4, 5)
    return np.concatenate([hexes[:, [0, around[i], around[(i + 1) % 6], 6]] for i in range(6)])


TET_EDGES = ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))
HEX_EDGES = ((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7))


def add_middles(nodes, cells, edges):
    """Nodes and cells with a node in the middle of each edge."""
    pairs = np.sort(np.stack([cells[:, list(edge)] for edge in edges], axis=1), axis=2).reshape(-1, 2)
    unique, number = np.unique(pairs, axis=0, return_inverse=True)
    middles = len(nodes) + number.reshape(len(cells), len(edges))
    return np.concatenate([nodes, nodes[unique].mean(axis=1)]), np.concatenate([cells, middles], axis=1)


def make_tets(cells):
    nodes, hexes = make_grid(cells)
    return nodes, cut_into_tets(hexes)


def write_msh(file, nodes, tets):
    """Gmsh's format 2.2, numbers from 1."""
    with open(file, "w", encoding="ascii") as out:
        out.write(f"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{len(nodes)}\n")
        out.writelines(f"{i} {x:.12g} {y:.12g} {z:.12g}\n" for i, (x, y, z) in enumerate(nodes, 1))
        out.write(f"$EndNodes\n$Elements\n{len(tets)}\n")
        out.writelines(f"{i} 4 2 0 1 {a + 1} {b + 1} {c + 1} {d + 1}\n" for i, (a, b, c, d) in enumerate(tets, 1))
        out.write("$EndElements\n")
