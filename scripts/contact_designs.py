#!/usr/bin/python3
"""Compares designs of the contact of a rigid sphere with the surface of a body of linear tetrahedra: force over Hertz's closed form,
smoothness while the sphere slides, a tip smaller than a triangle, and cost. It uses numpy and scipy and nothing of argil. Strains are
small, there is no friction, and the body is in equilibrium.

    argil       quadrature on the body's triangles, p = kappa depth, as src/contact/pressure.cpp: pieces are a third as large as the
                radius of the patch, and triangles that are smaller press with their corners
    quadrature  the same with pieces of a quarter of the radius
    fine        the same, and pieces are never larger than a sixteenth of a triangle
    nodes       a spring at each node, kappa times the node's area
    pairs       a spring of stiffness E* a for each pair: node and facet, vertex of the tool and triangle, edge and edge
    patches     a pressure sample for each polygon of the tool's facets, cut by the body's triangles and where they leave the body;
                p = kappa depth below the body's surface along the facet's normal. The idea is that of R. Elandt et al., A pressure field
                model for fast, robust approximation of net contact force and moment between nominally rigid objects, IROS 2019. They
                take the depth from a field inside the body instead
    mortar      gap >= 0 for each node, weighted by its shape function; the pressure is linear on triangles. Exact, without kappa
    dual        the same with dual shape functions: B. Wohlmuth, SIAM J. Numer. Anal. 38 (2000) 989

The body is the matrix of displacements of its top's nodes by unit forces on them, so each equilibrium is a small dense problem.
kappa = 80 E*/h as in argil, h the edge of a regular tetrahedron as large as the mean one of a cell.

Usage: contact_designs.py [-o FILE.csv] [--quick]        writes results/contact/designs.csv; times go to the screen alone
"""
import argparse
import csv
import tempfile
import time
from dataclasses import dataclass, replace
from pathlib import Path

import plot_hertz as press
import scipy.sparse as sparse
from argil_plot import np
from elastic_top import REACH, make_lattice, make_quarter
from matplotlib.tri import Triangulation
from scipy.optimize import nnls

REDUCED = press.REDUCED  # E* [Pa]
PRESS_SLOPE, SLIDE_SLOPE = 0.02, 0.4  # a/R; of a ball of 10 mm and a patch of 4 mm
STEPS_PER_CELL, CELLS_OF_SLIDE, ANGLE = 50, 3, 0.4  # of the slide; its angle to the mesh [rad]
JITTER = 0.18  # how far nodes are moved, over the cell
SEED = 20
ROUNDS, CHANGE = 40, 1e-9  # most rounds of an equilibrium; change of the force that ends them
DESIGNS = ("argil", "quadrature", "fine", "nodes", "pairs", "patches", "mortar", "dual")


@dataclass
class Tool:
    """A sphere of radius R, its lowest point at (x, y) and `depth` below the top; and facets of it."""
    radius: float
    depth: float
    vertices: np.ndarray  # relative to the lowest point [m]
    facets: np.ndarray
    extent: float  # it ends so far from its axis [m]
    bound: float  # radius of a ball around it [m]
    at: np.ndarray = None

    def depth_of(self, x):
        """How deep points (x, y) of the undeformed top are in it, and the unit normal out of it there. To first order a displacement
        u of the body takes normal·u from the depth."""
        away = x - self.at
        normal = np.concatenate([away, np.full((*away.shape[:-1], 1), self.depth - self.radius)], axis=-1)
        distance = np.linalg.norm(normal, axis=-1)
        aside = np.linalg.norm(away, axis=-1)
        return np.where(aside < self.extent, self.radius - distance, self.extent - aside), normal / distance[..., None]


class FacettedTool(Tool):
    """The mesh that plot_hertz.py presses with, its corners on the sphere."""

    def __init__(self, like, cells):
        super().__init__(**vars(like))
        depth, _, height = press.shape_of("sphere")
        assert np.isclose(depth, self.depth)
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "tool.obj"
            press.write_tool(file, height, self.extent, round(press.FINE_TOOL * cells * self.extent / press.CONTACT_RADIUS))
            lines = [line.split() for line in file.read_text(encoding="ascii").splitlines()]
        x = np.array([line[1:] for line in lines if line[0] == "v"], dtype=float)
        facets = np.array([line[1:] for line in lines if line[0] == "f"], dtype=int) - 1
        facets = facets[(x[facets, 2] < 4 * press.CONTACT_RADIUS).all(axis=1)]  # without the lid
        self.find = Triangulation(x[:, 0], x[:, 1], facets).get_trifinder()
        normal = np.cross(x[facets[:, 1]] - x[facets[:, 0]], x[facets[:, 2]] - x[facets[:, 0]])
        self.normal = -normal * np.sign(normal[:, 2:]) / np.linalg.norm(normal, axis=1, keepdims=True)
        self.offset = (self.normal * (x[facets[:, 0]] - [0, 0, self.depth])).sum(axis=1)

    def depth_of(self, x):
        depth, normal = super().depth_of(x)
        if x.size == 0:
            return depth, normal
        facet = np.asarray(self.find(x[..., 0], x[..., 1]))
        on_plane = self.offset[facet] - (self.normal[facet, :2] * x).sum(axis=-1)
        return np.where(facet >= 0, on_plane, depth), np.where((facet >= 0)[..., None], self.normal[facet], normal)


@dataclass
class Samples:
    """Springs: force = stiffness·max(0, depth − normal·Σ weight u) along the normal on the body."""
    node: np.ndarray  # N×3
    weight: np.ndarray  # N×3
    normal: np.ndarray  # N×3
    depth: np.ndarray  # N, of the undeformed body [m]
    stiffness: np.ndarray  # N [N/m]
    evaluated: int  # points whose depth was asked for

    def rows(self, size):
        """N×3n: displacement along the normals."""
        values = (self.weight[:, :, None] * self.normal[:, None, :]).reshape(len(self.depth), 9)
        columns = (3 * self.node[:, :, None] + np.arange(3)).reshape(len(self.depth), 9)
        return sparse.csr_matrix((values.ravel(), columns.ravel(), np.arange(0, values.size + 1, 9)),
                                 shape=(len(self.depth), size))


def make_tool(a, slope, edge, reach):
    """Sphere that touches a half-space over the radius a; facets of a triangular lattice of that edge, in the mean as
    low as the sphere."""
    radius = a / slope
    count = int(np.ceil(reach / edge)) + 2
    i, j = (c.ravel() for c in np.meshgrid(*2 * [np.arange(-2 * count, 2 * count + 1)], indexing="ij"))
    flat = edge * np.stack([i + 0.5 * j + 0.31, 0.75**0.5 * j + 0.17], axis=1)
    turn = 0.237
    flat = flat @ np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    width = 4 * count + 1
    number = np.arange(width**2).reshape(width, width)
    facets = np.concatenate([
        np.stack([number[:-1, :-1].ravel(), number[1:, :-1].ravel(), number[:-1, 1:].ravel()], axis=1),
        np.stack([number[1:, :-1].ravel(), number[1:, 1:].ravel(), number[:-1, 1:].ravel()], axis=1)])
    facets = facets[(np.hypot(*flat[facets].transpose(2, 0, 1)) < reach).all(axis=1)]
    used, facets = np.unique(facets, return_inverse=True)
    flat = flat[used]
    height = radius - np.sqrt(radius**2 - (flat**2).sum(axis=1)) - edge**2 / (8 * radius)
    return Tool(radius, a**2 / radius, np.concatenate([flat, height[:, None]], axis=1), facets.reshape(-1, 3), np.inf, radius)


# ---- Designs: which points press, when the body is displaced by u --------------------------------------------


QUARTERS = np.array([[[2, 0, 0], [1, 1, 0], [1, 0, 1]], [[1, 1, 0], [0, 2, 0], [0, 1, 1]],
                     [[1, 0, 1], [0, 1, 1], [0, 0, 2]], [[1, 1, 0], [0, 1, 1], [1, 0, 1]]]) / 2  # barycentric corners
MOST_LEVELS = 8


def depth_at(body, tool, u, which, weight):
    """Depth [m] of points of triangles `which` (m), weights m×…×3, when the body is displaced."""
    x = np.einsum("m...k,mkd->m...d", weight, body.corner[which])
    depth, normal = tool.depth_of(x)
    moved = np.einsum("m...k,mkd->m...d", weight, u.reshape(-1, 3)[body.triangles[which]])
    return depth - (normal * moved).sum(axis=-1)


def reach_of(body, which, parts):
    """How far the corners of parts (m×3×3, barycentric) of triangles are from their middles [m]."""
    x = np.einsum("mik,mkd->mid", parts, body.corner[which])
    return np.linalg.norm(x - x.mean(axis=1, keepdims=True), axis=2).max(axis=1)


def band_of(body, tool, which, level):
    """How far from the tool corners of parts of `level` still count in part as covered [m]."""
    side = body.size[which] * 0.5**level
    return np.minimum(0.5 * side**2 / tool.bound, 0.3 * side)


def measure_cover(body, tool, u, which, level):
    """Area of triangles that the tool covers, found on their parts of `level`; and points asked for."""
    parts = np.broadcast_to(np.eye(3), (len(which), 3, 3))
    area, asked = 0.0, 0
    for left in range(level, -1, -1):
        middle = -depth_at(body, tool, u, which, parts.mean(axis=1))
        asked += len(which)
        reach = reach_of(body, which, parts)
        scale = 0.25 ** (level - left)
        area += scale * body.area[which[middle <= -reach]].sum()
        kept = (middle > -reach) & (middle < reach + band_of(body, tool, which, level))
        which, parts = which[kept], parts[kept]
        if left:
            parts = np.einsum("pij,mjk->mpik", QUARTERS, parts).reshape(-1, 3, 3)
            which = np.repeat(which, 4)
    asked += 3 * len(which)
    share = np.clip(1 + depth_at(body, tool, u, which, parts) / band_of(body, tool, which, level)[:, None], 0, 1)
    return area + scale * (share.mean(axis=1) * body.area[which]).sum(), asked


def find_patch(body, tool, u):
    """As argil: the triangles near the tool, radius of a disc as large as the patch, and points asked for."""
    near = np.flatnonzero(np.hypot(*(body.corner.mean(axis=1) - tool.at).T) < tool.bound + body.size)
    whole = np.broadcast_to(np.eye(3), (len(near), 3, 3))
    middle = -depth_at(body, tool, u, near, whole.mean(axis=1))
    near = near[middle < reach_of(body, near, whole) + band_of(body, tool, near, 0)]
    size = body.size[near]
    asked = len(whole)
    spacing, coarser = size.max(), 0.0
    for _ in range(MOST_LEVELS):
        levels = np.maximum(0, np.ceil(np.log2(size / spacing) - 1e-9)).astype(int)
        area = 0.0
        for level in range(levels.max() + 1):
            more, points = measure_cover(body, tool, u, near[levels == level], level)
            area, asked = area + more, asked + points
        radius = np.sqrt(body.copies * area / np.pi)
        if spacing <= radius and coarser == 0.0:
            return near, radius, asked
        if spacing <= radius:
            above = np.log2(2 * spacing / coarser)
            part = above / (above + np.log2(radius / spacing))
            return near, coarser ** (1 - part) * radius**part, asked
        spacing, coarser = spacing / 2, radius
    return near, 2 * spacing, asked


def sample_triangles(body, tool, u, kappa, points_per_radius, is_always_fine):
    near, radius, evaluated = find_patch(body, tool, u)
    levels = np.clip(np.log2(body.size[near] / (radius / points_per_radius)), 2.0 if is_always_fine else 0.0, MOST_LEVELS)
    part = levels - np.floor(levels)
    node, weight, area = [], [], []
    corner_area = np.zeros(len(body.x))
    for level in range(int(np.ceil(levels.max())) + 1):
        share = np.where(np.floor(levels) == level, 1 - part, 0) + np.where(np.floor(levels) + 1 == level, part, 0)
        which, share = near[share > 0], share[share > 0]
        if level == 0:
            np.add.at(corner_area, body.triangles[which], (share * body.area[which] / 3)[:, None])
            continue
        parts = np.broadcast_to(np.eye(3), (len(which), 3, 3))
        for _ in range(level):
            kept = -depth_at(body, tool, u, which, parts.mean(axis=1)) < reach_of(body, which, parts)
            evaluated += len(which)
            parts = np.einsum("pij,mjk->mpik", QUARTERS, parts[kept]).reshape(-1, 3, 3)
            which, share = np.repeat(which[kept], 4), np.repeat(share[kept] / 4, 4)
        node.append(body.triangles[which])
        weight.append(parts.mean(axis=1))
        area.append(share * body.area[which])
    corners = np.flatnonzero(corner_area)
    node.append(np.repeat(corners[:, None], 3, axis=1))
    weight.append(np.tile([1.0, 0.0, 0.0], (len(corners), 1)))
    area.append(corner_area[corners])
    node, weight, area = (np.concatenate(c) for c in (node, weight, area))
    depth, normal = tool.depth_of(np.einsum("mk,mkd->md", weight, body.x[node]))
    return Samples(node, weight, normal, depth, kappa * area, evaluated + len(depth))


def sample_nodes(body, tool, kappa):
    node = np.flatnonzero(np.hypot(*(body.x - tool.at).T) < tool.radius)
    depth, normal = tool.depth_of(body.x[node])
    return Samples(np.repeat(node[:, None], 3, axis=1), np.tile([1.0, 0, 0], (len(node), 1)), normal, depth,
                   kappa * body.node_area[node], len(node))


def clip(points, count, value):
    """Convex polygons (N×K×2, the first `count` points each) cut where the linear `value` (N×K) is below zero."""
    width = points.shape[1]
    place = np.arange(width)
    valid = place < count[:, None]
    after = np.where(place + 1 < count[:, None], place + 1, 0)
    next_point = np.take_along_axis(points, after[:, :, None], axis=1)
    next_value = np.take_along_axis(value, after, axis=1)
    inside = valid & (value >= 0)
    crosses = valid & ((value >= 0) != (next_value >= 0))
    with np.errstate(divide="ignore", invalid="ignore"):
        cut = points + np.where(crosses, value / (value - next_value), 0)[:, :, None] * (next_point - points)
    both = np.stack([points, cut], axis=2).reshape(len(points), 2 * width, 2)
    kept = np.stack([inside, crosses], axis=2).reshape(len(points), 2 * width)
    order = np.argsort(~kept, axis=1, kind="stable")[:, :width + 1]
    return np.take_along_axis(both, order[:, :, None], axis=1), kept.sum(axis=1)


def overlay(body, tool):
    """Polygons that facets share with triangles, seen along the normal of the top."""
    facet = tool.vertices[tool.facets, :2] + tool.at
    low, high = facet.min(axis=1), facet.max(axis=1)
    body_low, body_high = body.corner.min(axis=1), body.corner.max(axis=1)
    f, t = np.nonzero(((low[:, None] < body_high) & (high[:, None] > body_low)).all(axis=2))
    points, count = facet[f], np.full(len(f), 3)
    for k in range(3):
        weigh = body.weigh[t, k]
        points, count = clip(points, count, np.einsum("nkd,nd->nk", points, weigh[:, :2]) + weigh[:, 2:])
        kept = count > 2
        points, count, f, t = points[kept], count[kept], f[kept], t[kept]
    return points, count, f, t


def facet_planes(tool):
    corner = tool.vertices[tool.facets] + np.append(tool.at, -tool.depth)
    normal = np.cross(corner[:, 2] - corner[:, 0], corner[:, 1] - corner[:, 0])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    assert (normal[:, 2] < 0).all()
    return normal, (normal * corner[:, 0]).sum(axis=1)


def sample_patches(body, tool, u, kappa, polygons):
    points, count, f, t = polygons
    normal, offset = facet_planes(tool)
    n = normal[f]
    moved = u.reshape(-1, 3)[body.triangles[t]]
    slack = np.einsum("nd,nkd->nk", n, moved)  # of the triangle's corners
    weight = np.einsum("nic,nkc->nki", body.weigh[t][:, :, :2], points) + body.weigh[t][:, None, :, 2]
    depth = offset[f][:, None] - np.einsum("nd,nkd->nk", n[:, :2], points) - np.einsum("nki,ni->nk", weight, slack)
    # depth: of the body's surface above the facet's plane, along the facet's normal.
    points, count = clip(points, count, depth)
    kept = count > 2
    points, count, f, t, n = points[kept], count[kept], f[kept], t[kept], n[kept]
    valid = np.arange(points.shape[1]) < count[:, None]
    points = np.where(valid[:, :, None], points, points[:, :1])  # of no area
    a, b = points[:, 1:-1] - points[:, :1], points[:, 2:] - points[:, :1]
    area = 0.5 * np.abs(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])
    whole = np.maximum(area.sum(axis=1), 1e-300)
    centre = points[:, 0] + (area[..., None] * (a + b)).sum(axis=1) / 3 / whole[:, None]
    weight = np.einsum("nic,nc->ni", body.weigh[t][:, :, :2], centre) + body.weigh[t][:, :, 2]
    return Samples(body.triangles[t], weight, n, offset[f] - (n[:, :2] * centre).sum(axis=1),
                   kappa * whole / -n[:, 2], len(polygons[1]))


def sample_pairs(body, tool, u, stiffness):
    """Nodes and facets, vertices and triangles, edges that cross, seen along the normal of the top."""
    shift = np.append(tool.at, -tool.depth)
    vertices = tool.vertices + shift
    u = u.reshape(-1, 3)
    position = np.concatenate([body.x, np.zeros((len(body.x), 1))], axis=1) + u
    node, weight, normal, depth = [], [], [], []

    corner = vertices[tool.facets][:, :, :2]  # nodes and facets
    weigh = np.linalg.inv(np.concatenate([corner, np.ones((len(corner), 3, 1))], axis=2).transpose(0, 2, 1))
    share = np.einsum("fic,nc->fni", weigh[:, :, :2], body.x) + weigh[:, None, :, 2]
    f, v = np.nonzero((share >= 0).all(axis=2))
    planes, offset = facet_planes(tool)
    node.append(np.repeat(v[:, None], 3, axis=1))
    weight.append(np.tile([1.0, 0, 0], (len(v), 1)))
    normal.append(planes[f])
    depth.append(offset[f] - (planes[f, :2] * body.x[v]).sum(axis=1))

    share = np.einsum("tic,nc->tni", body.weigh[:, :, :2], vertices[:, :2]) + body.weigh[:, None, :, 2]  # vertices and triangles
    t, v = np.nonzero((share >= 0).all(axis=2))
    corner = position[body.triangles[t]]
    n = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    n *= -np.sign(n[:, 2:]) / np.linalg.norm(n, axis=1, keepdims=True)
    node.append(body.triangles[t])
    weight.append(share[t, v])
    normal.append(n)
    depth.append(n[:, 2] * vertices[v, 2])

    sides = np.unique(np.sort(tool.facets[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1), axis=0)  # edges
    p, q = vertices[sides[:, 0]], vertices[sides[:, 1]]
    a, b = body.x[body.edges[:, 0]], body.x[body.edges[:, 1]]
    d, e, w = (q - p)[:, None, :2], (b - a)[None], a[None] - p[:, None, :2]
    cross = d[..., 0] * e[..., 1] - d[..., 1] * e[..., 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        s = (w[..., 0] * e[..., 1] - w[..., 1] * e[..., 0]) / cross
        r = (w[..., 0] * d[..., 1] - w[..., 1] * d[..., 0]) / cross
        i, j = np.nonzero((s >= 0) & (s <= 1) & (r >= 0) & (r <= 1))
    s, r = s[i, j], r[i, j]
    n = np.cross((q - p)[i], (position[body.edges[:, 1]] - position[body.edges[:, 0]])[j])
    n *= -np.sign(n[:, 2:]) / np.linalg.norm(n, axis=1, keepdims=True)
    node.append(np.concatenate([body.edges[j], body.edges[j, :1]], axis=1))
    weight.append(np.stack([1 - r, r, 0 * r], axis=1))
    normal.append(n)
    depth.append(n[:, 2] * (p[i, 2] + s * (q - p)[i, 2]))

    node, weight, normal, depth = (np.concatenate(c) for c in (node, weight, normal, depth))
    return Samples(node, weight, normal, depth, np.full(len(depth), stiffness), len(depth))


# ---- Equilibrium ---------------------------------------------------------------------------------------------


def balance(body, samples, u):
    """u in equilibrium with these springs, force on the body, rounds of Newton's method, and which press."""
    rows = samples.rows(len(u))
    pressing = samples.depth - rows @ u > 0
    for rounds in range(1, ROUNDS):
        active = rows[pressing]
        touched = np.unique(active.indices[active.data != 0])
        small = active[:, touched]
        scaled = sparse.diags(samples.stiffness[pressing]) @ small
        stiffness = (small.T @ scaled).toarray()
        load = scaled.T @ samples.depth[pressing]
        compliance = body.compliance[np.ix_(touched, touched)]
        moved = np.linalg.solve(np.eye(len(touched)) + compliance @ stiffness, compliance @ load)
        force = load - stiffness @ moved
        u = body.compliance[:, touched] @ force
        after = samples.depth - rows @ u > 0
        if (after == pressing).all():
            break
        pressing = after
    pressure = samples.stiffness * np.maximum(0, samples.depth - rows @ u)
    return u, (pressure[:, None] * samples.normal).sum(axis=0), rounds, pressing


def press_with_springs(body, tool, make_samples, u):
    """Which points press depends on how the body is displaced, and it on them, by turns."""
    scale = REDUCED * (tool.radius * tool.depth**3) ** 0.5
    force = np.full(3, np.inf)
    total = 0
    for _ in range(ROUNDS):
        samples = make_samples(u)
        before = force
        u, force, rounds, pressing = balance(body, samples, u)
        total += rounds
        if np.linalg.norm(force - before) < CHANGE * scale:
            break
    return {"u": u, "force": force, "rounds": total, "evaluated": samples.evaluated, "pressing": int(pressing.sum()),
            "is_found": np.linalg.norm(force - before) < CHANGE * scale}


def weigh_gaps(body, tool, is_dual):
    """Rows: displacement along the normal weighted by each node's function; and the depth so weighted, over what the tool covers,
    seen along the normal of the top, without its steep rim."""
    extent = min(tool.extent, 0.9 * tool.radius)
    a = contact_radius(tool)
    away = np.hypot(*(body.corner.mean(axis=1) - tool.at).T)
    near = np.flatnonzero(away < min(extent, REACH * a) + body.size)
    levels = np.clip(np.ceil(np.log2(body.size[near] / (a / 4))), 1, MOST_LEVELS).astype(int)
    triangle, weight, area = [], [], []
    for level in np.unique(levels):
        parts = np.eye(3)[None]
        for _ in range(level):
            parts = np.einsum("pij,mjk->mpik", QUARTERS, parts).reshape(-1, 3, 3)
        which = near[levels == level]
        triangle.append(np.repeat(which, len(parts)))
        weight.append(np.tile(parts.mean(axis=1), (len(which), 1)))
        area.append(np.repeat(body.area[which] / len(parts), len(parts)))
    triangle, weight, area = (np.concatenate(c) for c in (triangle, weight, area))
    evaluated = len(area)
    depth, normal = tool.depth_of(np.einsum("mk,mkd->md", weight, body.corner[triangle]))
    covered = np.linalg.norm(np.einsum("mk,mkd->md", weight, body.corner[triangle]) - tool.at, axis=1) < extent
    triangle, weight, area, depth, normal = (c[covered] for c in (triangle, weight, area, depth, normal))
    samples = Samples(body.triangles[triangle], weight, normal, depth, area, evaluated)
    test = weight
    if is_dual:  # of what is covered of each triangle: diag(∫φ) (∫φφ)⁻¹ φ
        mass = np.zeros((len(body.triangles), 3, 3))
        np.add.at(mass, triangle, area[:, None, None] * weight[:, :, None] * weight[:, None, :])
        dual = mass.sum(axis=2)[:, :, None] * np.linalg.pinv(mass, rcond=1e-9, hermitian=True)
        test = np.einsum("nij,nj->ni", dual[triangle], weight)
    tests = sparse.csr_matrix(((test * area[:, None]).ravel(), (samples.node.ravel(), np.repeat(np.arange(len(depth)), 3))),
                              shape=(len(body.x), len(depth)))
    return (tests @ samples.rows(3 * len(body.x))).tocsr(), tests @ depth, evaluated


def contact_radius(tool):
    return (tool.radius * tool.depth) ** 0.5


def press_exactly(body, tool, is_dual, pressed):
    """λ ≥ 0, gap ≥ 0, λ gap = 0 for each node's weighted gap, by an active set; `pressed` is a guess."""
    rows, depth, evaluated = weigh_gaps(body, tool, is_dual)
    used = np.unique(rows.indices)
    rows = rows[:, used].toarray()
    whole = rows @ body.compliance[np.ix_(used, used)] @ rows.T
    scale = np.diag(whole).max()
    is_covered = np.diag(whole) > 1e-9 * scale
    pressed = is_covered & (depth > 0 if pressed is None else pressed)
    is_found = False
    for rounds in range(1, ROUNDS):
        on = np.flatnonzero(pressed)
        strength = np.zeros(len(depth))
        if len(on):
            strength[on] = np.linalg.solve(whole[np.ix_(on, on)], depth[on])
        after = is_covered & (strength + (depth - whole @ strength) / np.diag(whole).clip(1e-9 * scale) > 0)
        is_found = (after == pressed).all()
        if is_found:
            break
        pressed = after
    if not is_found:
        lower = np.linalg.cholesky(whole + 1e-12 * scale * np.eye(len(depth)))
        strength = nnls(lower.T, np.linalg.solve(lower, depth), maxiter=100 * len(depth))[0]
        pressed = strength > 0
    on_body = rows.T @ strength
    force = np.zeros(3 * len(body.x))
    force[used] = on_body
    return {"u": None, "force": force.reshape(-1, 3).sum(axis=0), "rounds": rounds, "evaluated": evaluated,
            "pressing": int(pressed.sum()), "is_found": True, "pressed": pressed}


def press_by(design, body, tool, before=None, kappa_times=1.0):
    u = np.zeros(3 * len(body.x)) if before is None or before["u"] is None else before["u"]
    if design in ("mortar", "dual"):
        return press_exactly(body, tool, design == "dual", before and before["pressed"])
    return press_with_springs(body, tool, sampler(design, body, tool, kappa_times), u)


def sampler(design, body, tool, times=1.0):
    kappa = times * body.kappa
    if design == "nodes":
        samples = sample_nodes(body, tool, kappa)
        return lambda u: samples
    if design == "pairs":
        return lambda u: sample_pairs(body, tool, u, times * REDUCED * contact_radius(tool))
    if design == "patches":
        polygons = overlay(body, tool)
        return lambda u: sample_patches(body, tool, u, kappa, polygons)
    points = 3 if design == "argil" else 4
    return lambda u: sample_triangles(body, tool, u, kappa, points, design == "fine")


# ---- Trials ----------------------------------------------------------------------------------------------------


def hertz(tool):
    return 4 / 3 * REDUCED * (tool.radius * tool.depth**3) ** 0.5


def tool_edge(a, cell):
    return min(a / 4, cell / 1.5)


def try_press(cells):
    """Force over the closed form; the last two as argil is pressed by plot_hertz.py: with a mesh, and seeing a quarter of the patch."""
    a = press.CONTACT_RADIUS
    body = make_quarter(cells)
    tool = make_tool(a, PRESS_SLOPE, tool_edge(a, body.cell), REACH * a)
    tool.at = np.zeros(2)
    tool.extent, tool.bound = 1.5 * a, 2.9 * a  # of plot_hertz.py's tool, a disc bent to the sphere with a lid
    for design in DESIGNS:
        found = press_by(design, body, tool)
        row = {"trial": "press", "design": design, "cells": cells, "force": f"{-4 * found['force'][2] / hertz(tool):.4f}",
               "evaluated": found["evaluated"], "pressing": found["pressing"], "rounds": found["rounds"],
               "not_found": int(not found["is_found"])}
        if design not in ("mortar", "dual"):
            stiffer = press_by(design, body, tool, kappa_times=2.0)
            row["stiffer"] = f"{stiffer['force'][2] / found['force'][2] - 1:.4f}"
        yield row
    tool, body = FacettedTool(tool, cells), replace(body, copies=1)
    for design in ("argil", "nodes"):
        found = press_by(design, body, tool)
        yield {"trial": "press as plot_hertz.py", "design": design, "cells": cells,
               "force": f"{-4 * found['force'][2] / hertz(tool):.4f}", "not_found": int(not found["is_found"])}


def try_slide(cells, share_of_way):
    """A slide at constant depth askew to an irregular mesh."""
    cell = press.CONTACT_RADIUS
    a = cells * cell
    half = CELLS_OF_SLIDE / 2 * cell
    reach = half + REACH * a + 1.6 * cell
    body = make_lattice(cell, int(np.ceil(reach / cell)) + 1, reach, JITTER, SEED + cells)
    tool = make_tool(a, SLIDE_SLOPE, tool_edge(a, cell), REACH * a)
    steps = round(share_of_way * CELLS_OF_SLIDE * STEPS_PER_CELL)
    along = np.array([np.cos(ANGLE), np.sin(ANGLE)])
    for design in DESIGNS:
        founds = {}
        for times in (1.0, 2.0):
            if times > 1 and design in ("mortar", "dual"):
                continue
            found, list_of = None, []
            for step in range(steps + 1):
                tool.at = np.array([0.13, 0.29]) * cell + (step / STEPS_PER_CELL * cell - half) * along
                found = press_by(design, body, tool, found, times)
                list_of.append(found)
            founds[times] = list_of
        force = np.array([f["force"] for f in founds[1.0]])
        normal, side = -force[:, 2], np.hypot(force[:, 0], force[:, 1])
        change = np.linalg.norm(np.diff(force, axis=0), axis=1)
        row = {"trial": "slide", "design": design, "cells": cells, "force": f"{normal.mean() / hertz(tool):.4f}",
               "swing": f"{(normal.max() - normal.min()) / 2 / normal.mean():.4f}", "side": f"{(side / normal).max():.4f}",
               "change": f"{change.max() / np.linalg.norm(force, axis=1).max():.5f}",
               "rms_change": f"{np.sqrt((change**2).mean()) / np.linalg.norm(force, axis=1).max():.5f}"}
        for name in ("evaluated", "pressing", "rounds"):
            row[name] = f"{np.mean([f[name] for f in founds[1.0]]):.1f}"
        row["not_found"] = sum(not f["is_found"] for f in founds[1.0])
        if 2.0 in founds:
            stiffer = -np.array([f["force"][2] for f in founds[2.0]])
            row["stiffer"] = f"{stiffer.mean() / normal.mean() - 1:.4f}"
        row["milliseconds"] = measure_time(design, body, tool, founds[1.0][-1]["u"])
        yield row


def measure_time(design, body, tool, u):
    """Median of finding the points and their forces, and what they add to the matrix."""
    def evaluate():
        if design in ("mortar", "dual"):
            weigh_gaps(body, tool, design == "dual")
            return
        samples = sampler(design, body, tool)(u)
        rows = samples.rows(len(u))
        pressure = samples.stiffness * np.maximum(0, samples.depth - rows @ u)
        active = rows[pressure > 0]
        _ = rows.T @ pressure, active.T @ (sparse.diags(samples.stiffness[pressure > 0]) @ active)
    spans = []
    for _ in range(15):
        start = time.process_time()
        evaluate()
        spans.append(time.process_time() - start)
    return f"{1e3 * np.median(spans):.2f}"


def try_tip():
    """A patch of a fifth of a cell in the regular lattice: over a node, the middle of an edge, the middle of a face."""
    cell = press.CONTACT_RADIUS
    a = cell / 5
    body = make_lattice(cell, 4, 2.6 * cell, 0.0, 0)
    tool = make_tool(a, SLIDE_SLOPE, a / 4, 2 * a)
    places = {"node": [0.0, 0.0], "edge": [0.5, 0.0], "diagonal": [0.5, 0.5], "face": [2 / 3, 1 / 3]}
    for design in DESIGNS:
        for place, at in places.items():
            tool.at = cell * np.array(at) + 1e-6 * cell
            found = press_by(design, body, tool)
            row = {"trial": "tip over " + place, "design": design, "cells": 0.2,
                   "force": f"{(0.0 - found['force'][2]) / hertz(tool):.4f}"}
            for name in ("evaluated", "pressing", "rounds"):
                row[name] = found[name]
            row["not_found"] = int(not found["is_found"])
            if design not in ("mortar", "dual") and found["force"][2] != 0:
                stiffer = press_by(design, body, tool, kappa_times=2.0)
                row["stiffer"] = f"{stiffer['force'][2] / found['force'][2] - 1:.4f}"
            yield row


COLUMNS = {"trial": "trial", "design": "design", "cells": "cells_per_contact_radius", "force": "force_over_closed_form",
           "stiffer": "change_when_stiffness_doubles", "swing": "normal_force_swing_over_mean", "side": "largest_side_over_normal",
           "change": "largest_change_in_a_fiftieth_cell_over_peak", "rms_change": "rms_change_in_a_fiftieth_cell_over_peak",
           "evaluated": "points_evaluated", "pressing": "points_pressing", "rounds": "rounds_of_equilibrium",
           "not_found": "equilibria_not_found"}


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", maxsplit=1)[0])
    parser.add_argument("-o", "--output", type=Path, default=press.ROOT / "results/contact/designs.csv", metavar="FILE")
    parser.add_argument("--quick", action="store_true", help="without the finest mesh, and a tenth of the slide")
    options = parser.parse_args()
    press.STEEPNESS = PRESS_SLOPE
    trials = [try_press(cells) for cells in ((2, 4) if options.quick else (2, 4, 8))]
    trials += [try_slide(cells, 0.1 if options.quick else 1.0) for cells in (1, 2)]
    trials.append(try_tip())
    rows = []
    for trial in trials:
        for row in trial:
            rows.append(row)
            print(*(f"{name}={value}" for name, value in row.items()), flush=True)
    with open(options.output, "w", newline="", encoding="ascii") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(COLUMNS.values())
        table.writerows([row.get(name, "") for name in COLUMNS] for row in rows)


if __name__ == "__main__":
    main()
