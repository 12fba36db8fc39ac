"""The top of a block of linear tetrahedra as contact_designs.py presses on it: its nodes near the tool, its triangles, and the
displacements of these nodes by unit forces on them, from one factorization of the block's stiffness matrix.
"""
import tempfile
from dataclasses import dataclass, replace

import hertz_mesh
import plot_hertz as press
from argil_plot import np
from scipy.sparse.linalg import splu

CHOSEN, CELL = 80, 2 ** (1 / 6)  # kappa h / E*; h over the edge of a cube of six tets
REACH = 1.6  # no patch goes farther than this from the axis [a]
SEEN = 3.5  # what argil looks at of a block to measure the patch [a]


@dataclass
class Body:
    """The top of a block near the tool."""
    x: np.ndarray  # n×2: its nodes [m]
    triangles: np.ndarray  # t×3
    compliance: np.ndarray  # 3n×3n [m/N]
    cell: float  # [m]
    copies: int = 1  # so many of it make the whole

    def __post_init__(self):
        corner = self.x[self.triangles]
        self.corner = corner
        a, b = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
        self.area = 0.5 * np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
        longest = np.sqrt(np.max([(e**2).sum(axis=1) for e in (a, b, b - a)], axis=0))
        self.size = np.maximum(0.5 * longest, np.sqrt(4 / 3**0.5 * self.area))  # as argil's Face::size
        # Barycentric weights of (x, y): weigh[t] @ (x, y, 1).
        self.weigh = np.linalg.inv(np.concatenate([corner, np.ones((len(corner), 3, 1))], axis=2).transpose(0, 2, 1))
        self.node_area = np.bincount(self.triangles.ravel(), np.repeat(self.area / 3, 3), len(self.x))
        sides = np.sort(self.triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
        self.edges = np.unique(sides, axis=0)
        self.kappa = CHOSEN * press.REDUCED / (CELL * self.cell)


def dissect(index, numbers, order):
    """Nested dissection of nodes of a lattice: both halves, then the plane between them."""
    extent = np.ptp(index[numbers], axis=0) + 1
    if len(numbers) < 60 or extent.max() < 3:
        order.extend(numbers)
        return
    axis = extent.argmax()
    value = index[numbers, axis]
    middle = np.sort(value)[len(value) // 2]
    middle = min(max(middle, value.min() + 1), value.max() - 1)
    for part in (value < middle, value > middle):
        dissect(index, numbers[part], order)
    order.extend(numbers[value == middle])


def condense(block, held, cell, reach, seen=0.0, axes=(0, 1, 2)):
    """Body of the top's nodes within `reach` of the axis, which move along `axes`, and of those within `seen`, which stay where they
    are. `held`: rows of the stiffness matrix."""
    x, tets, index = block
    stiffness = hertz_mesh.assemble(x, tets)
    order = []
    dissect(index, np.arange(len(x)), order)
    rows = (3 * np.array(order)[:, None] + np.arange(3)).ravel()
    rows = rows[~np.isin(rows, held)]
    place = np.full(3 * len(x), -1)
    place[rows] = np.arange(len(rows))
    factor = splu(stiffness[rows][:, rows].tocsc(), permc_spec="NATURAL", diag_pivot_thresh=0.0,
                  options={"SymmetricMode": True})
    is_top = x[:, 2] > -1e-12
    away = np.hypot(x[:, 0], x[:, 1])
    nodes = np.flatnonzero(is_top & (away < max(reach, seen)))
    faces = np.concatenate([tets[:, c] for c in ((0, 1, 2), (0, 1, 3), (0, 2, 3), (1, 2, 3))])
    local = np.full(len(x), -1)
    local[nodes] = np.arange(len(nodes))
    triangles = local[faces]
    triangles = triangles[(triangles >= 0).all(axis=1)]
    row = (3 * nodes[:, None] + np.arange(3)).ravel()
    target = np.flatnonzero((place[row] >= 0) & np.repeat(away[nodes] < reach, 3) & np.isin(row % 3, axes))
    at = place[row[target]]
    compliance = np.zeros((3 * len(nodes), 3 * len(nodes)))
    for first in range(0, len(at), 32):
        load = np.zeros((len(rows), len(at[first:first + 32])))
        load[at[first:first + 32], np.arange(load.shape[1])] = 1
        compliance[np.ix_(target, target[first:first + 32])] = factor.solve(load)[at]
    return Body(x[nodes, :2], triangles, 0.5 * (compliance + compliance.T), cell)


def make_quarter(cells):
    """The block of plot_hertz.py, a quarter. Its top moves along the normal alone, as in the limit of small slopes."""
    with tempfile.TemporaryDirectory() as folder:
        x, tets = hertz_mesh.read_block(folder, cells)
    n = len(press.spaced(cells, int(np.ceil(1.25 * cells))))
    index = np.stack(np.unravel_index(np.arange(len(x)), (n, n, len(x) // n**2)), axis=1)
    far = press.HALF_WIDTH * (1 - 1e-9)
    held = [3 * np.flatnonzero(x[:, axis] < 1e-12) + axis for axis in (0, 1)]
    held += [3 * np.flatnonzero((x[:, 0] > far) | (x[:, 1] > far) | (x[:, 2] < -far)) + axis for axis in range(3)]
    cell = press.CONTACT_RADIUS / cells
    near, seen = REACH * press.CONTACT_RADIUS + 1.5 * cell, SEEN * press.CONTACT_RADIUS
    body = condense((x, tets, index), np.concatenate(held), cell, near, seen, axes=[2])
    return replace(body, copies=4)


def graded(fine, cell, growth, far):
    x = [cell * i for i in range(fine + 1)]
    while x[-1] < far:
        x.append(x[-1] + (x[-1] - x[-2]) * growth)
    return np.array(x)


def make_lattice(cell, fine, reach, jitter, seed):
    """Whole block of Kuhn's six tets a cell with `fine` equal cells to each side of the axis. Their nodes are moved at random, those
    of the top within it. Sides and bottom are held."""
    side = graded(fine, cell, 1.5, 40 * cell)
    side = np.concatenate([-side[:0:-1], side])
    down = -graded(max(3, fine // 2), cell, 1.5, 40 * cell)[::-1]
    x = np.stack([c.ravel() for c in np.meshgrid(side, side, down, indexing="ij")], axis=1)
    shape = (len(side), len(side), len(down))
    index = np.stack(np.unravel_index(np.arange(len(x)), shape), axis=1)
    far = np.array([side[-1], side[-1], -down[0]])
    held = np.flatnonzero((np.abs(x[:, 0]) >= far[0]) | (np.abs(x[:, 1]) >= far[1]) | (x[:, 2] <= -far[2]))
    number = np.arange(len(x)).reshape(shape)
    corner = {(i, j, k): number[i:shape[0] - 1 + i, j:shape[1] - 1 + j, k:shape[2] - 1 + k].ravel()
              for i in (0, 1) for j in (0, 1) for k in (0, 1)}
    tets = []
    for path, order in (((0, 1, 2), 1), ((1, 2, 0), 1), ((2, 0, 1), 1), ((0, 2, 1), -1), ((1, 0, 2), -1), ((2, 1, 0), -1)):
        steps = [tuple(int(axis in path[:k]) for axis in range(3)) for k in range(4)]
        nodes = [corner[step] for step in steps]
        tets.append(np.stack(nodes if order > 0 else [nodes[0], nodes[2], nodes[1], nodes[3]], axis=1))
    tets = np.concatenate(tets)
    is_moved = (np.abs(x[:, :2]) < (fine - 0.5) * cell).all(axis=1) & (x[:, 2] > down[0] / 2)
    move = jitter * cell * np.random.default_rng(seed).uniform(-1, 1, x.shape) * is_moved[:, None]
    move[x[:, 2] > -1e-12, 2] = 0
    x = x + move
    edges = np.stack([x[tets[:, i]] - x[tets[:, 0]] for i in (1, 2, 3)], axis=2)
    assert (np.linalg.det(edges) > 0.05 * cell**3).all()
    return condense((x, tets, index), (3 * held[:, None] + np.arange(3)).ravel(), cell, reach)
