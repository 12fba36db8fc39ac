"""Static solutions of argil at large rotation against a small program of numpy and scipy, node by node.

Usage: check_static_large.py ARGIL [--fine]

Every law with every element on coarse bars, 8 s; --fine: on bars of 360 and 192 tets, a minute of an idle core.

The laws, with F = R S by singular value decomposition, J = det F, W per rest volume [J/m³] and P = ∂W/∂F [Pa]:
  corotational  P = 2μ (F − R) + λ tr(S − 1) R
  hencky        W = μ Σ εᵢ² + ½λ (Σ εᵢ)² in the logarithms εᵢ of the stretches sᵢ, F = U diag(s) Vᵀ,
                P = U diag((2μ εᵢ + λ Σ εⱼ)/sᵢ) Vᵀ
  neo_hookean   W = ½μ (tr FᵀF − 3) − μ (J − 1) + ½(λ + μ)(J − 1)²,  P = μ F + ((λ + μ)(J − 1) − μ) ∂J/∂F
Loads grow in equal shares, each solved by Newton's method with central differences of P as its tangent, and
without line search: it follows the path from rest, which argil need not do.
"""
import pathlib
import sys
import tempfile
from typing import NamedTuple

import static_problem as sp
from static_problem import np, sparse

TOLERANCE = 1e-8  # of the largest displacement: the demand; what the runs reach is printed
MOST_LINEARISATIONS = 100  # of argil in one run: bounds the work, not the time; runs are seen to take 8 to about 45
CONVERGED = 1e-12  # residual over the norm of the internal forces' parts: near round-off
UNDERWAY = 1e-5  # the same on the path to the full loads
DIFFERENCE = 1e-5  # in F, central: leaves 1e-10 of the tangent, so that Newton's method keeps its speed


class Points(NamedTuple):
    """Integration points, a row each."""

    weight: np.ndarray  # [m³]
    gradient: np.ndarray  # ∇N [1/m], node by direction
    nodes: np.ndarray
    lame: np.ndarray  # λ, μ [Pa]


def make_points(problem):
    edges = problem.edge_vectors()
    inner = np.linalg.inv(edges).transpose(0, 2, 1)
    of_corner = np.concatenate([-inner.sum(axis=1, keepdims=True), inner], axis=1)
    volume = np.linalg.det(edges) / 6.0
    if problem.tets.shape[1] == 4:
        return Points(volume, of_corner, problem.tets, problem.lame)
    near = (5.0 - np.sqrt(5.0)) / 20.0
    gradient = []
    for q in range(4):
        L = np.where(np.arange(4) == q, 1.0 - 3.0 * near, near)
        corners = (4.0 * L - 1.0)[:, None] * of_corner
        edge = [4.0 * (L[a] * of_corner[:, b] + L[b] * of_corner[:, a]) for a, b in sp.EDGES]
        gradient.append(np.concatenate([corners, np.stack(edge, axis=1)], axis=1))
    return Points(np.tile(volume / 4.0, 4), np.concatenate(gradient), np.tile(problem.tets, (4, 1)),
                  np.tile(problem.lame, (4, 1)))


def find_rotation(F):
    """Nearest rotation, det R = +1."""
    U, _, V = np.linalg.svd(F)
    U[..., -1] *= np.sign(np.linalg.det(U @ V))[..., None]
    return U @ V


def corotational(F, lame):
    R = find_rotation(F)
    trace = np.einsum("...ij,...ij->...", R, F) - 3.0
    return 2.0 * lame[:, 1, None, None] * (F - R) + (lame[:, 0] * trace)[:, None, None] * R


def neo_hookean(F, lame):
    J = np.linalg.det(F)
    pressure = (lame[:, 0] + lame[:, 1]) * (J - 1.0) - lame[:, 1]
    cofactor = np.stack([np.cross(F[:, 1], F[:, 2]), np.cross(F[:, 2], F[:, 0]), np.cross(F[:, 0], F[:, 1])], axis=1)
    return lame[:, 1, None, None] * F + pressure[:, None, None] * cofactor


def hencky(F, lame):
    U, s, V = np.linalg.svd(F)
    strain = np.log(s)
    tau = 2.0 * lame[:, 1, None] * strain + (lame[:, 0] * strain.sum(axis=-1))[:, None]
    return U * (tau / s)[:, None, :] @ V


LAWS = {"corotational": corotational, "neo_hookean": neo_hookean, "hencky": hencky}


def find_motion(points, x):
    return np.einsum("pni,pnj->pij", x[points.nodes], points.gradient)


def assemble_force(points, stress, num_nodes):
    """Internal force, and the norm of its parts that rounding is measured by."""
    parts = points.weight[:, None, None] * np.einsum("pij,pnj->pni", stress, points.gradient)
    force = np.zeros((num_nodes, 3))
    np.add.at(force, points.nodes, parts)
    return force, np.linalg.norm(parts)


def assemble_tangent(points, law, F, num_nodes):
    parts = np.empty((*points.nodes.shape, 3, points.nodes.shape[1], 3))  # point, node, i, node, j
    for j in range(3):
        for k in range(3):
            step = np.zeros((3, 3))
            step[j, k] = DIFFERENCE
            slope = (law(F + step, points.lame) - law(F - step, points.lame)) / (2.0 * DIFFERENCE)
            row = points.weight[:, None, None] * np.einsum("pil,pnl->pni", slope, points.gradient)
            add = row[..., None] * points.gradient[:, None, None, :, k]
            parts[..., j] = add if k == 0 else parts[..., j] + add
    numbers = 3 * points.nodes[..., None] + np.arange(3)
    i = np.broadcast_to(numbers[:, :, :, None, None], parts.shape).ravel()
    j = np.broadcast_to(numbers[:, None, None], parts.shape).ravel()
    return sparse.coo_matrix((parts.ravel(), (i, j)), shape=(3 * num_nodes,) * 2).tocsr()


def solve(problem, law, num_shares):
    """Displacement under all loads."""
    points = make_points(problem)
    count = len(problem.nodes)
    free = np.isnan(problem.prescribed)
    u = np.zeros((count, 3))
    for share in np.arange(1, num_shares + 1) / num_shares:
        change = np.where(free, np.nan, share * problem.prescribed - u)
        for _ in range(60):
            F = find_motion(points, problem.nodes + u)
            force, scale = assemble_force(points, law(F, points.lame), count)
            residual = share * problem.force() - force
            wanted = (CONVERGED if share == 1.0 else UNDERWAY) * scale
            if np.linalg.norm(residual[free]) <= wanted and not np.nan_to_num(change).any():
                break
            u += sp.solve_free(assemble_tangent(points, law, F, count), residual, change)
            change = np.where(free, np.nan, 0.0)
        else:
            raise SystemExit(f"the reference did not converge at {share} of the loads")
    return u, find_rotation(find_motion(points, problem.nodes + u))


def bend(nodes):
    """A bar held at one end, its other end pushed aside by nodal forces, with pressure on its upper side."""
    low, high = nodes.min(axis=0), nodes.max(axis=0)
    tip = np.flatnonzero(nodes[:, 0] == high[0]).tolist()
    return {"fixed": [{"kind": "nodes", "nodes": np.flatnonzero(nodes[:, 0] == low[0]).tolist()}],
            "loads": {"nodal": [{"nodes": tip, "force_N": [0, 0.2 / len(tip), -1.0 / len(tip)]}],
                      "gravity_m_per_s2": [0, 0, -9.81],
                      "pressure": [{"kind": "box", "lower_m": [low[0], low[1], high[2] - 1e-9],
                                    "upper_m": [high[0], high[1], high[2] + 1e-9], "pressure_Pa": 50}]}}


def twist(nodes, degrees):
    """A bar held at one end, the vertices of its other end turned about its axis: a prescribed way each."""
    low, high = nodes.min(axis=0), nodes.max(axis=0)
    fixed = [{"kind": "nodes", "nodes": np.flatnonzero(nodes[:, 0] == low[0]).tolist()}]
    centre = 0.5 * (low + high)
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    for n in np.flatnonzero(nodes[:, 0] == high[0]):
        arm = (nodes[n] - centre)[1:]
        way = np.array([[c, -s], [s, c]]) @ arm - arm
        fixed.append({"kind": "nodes", "nodes": [int(n)], "displacement_m": [0, *way.tolist()]})
    return {"fixed": fixed}


def compare(argil, folder, name, loads, model, element, num_shares):
    """Runs a bar both ways, prints how far they are apart. True when that is within the demand, the turn large
    and argil's work bounded; the reference's own is bounded in solve()."""
    scenario = sp.make_scenario({"mesh": {"file": "bar.msh"}, **loads}, model, element)
    rest, tets, moved = sp.run_argil(argil, folder, scenario)
    count = sp.count_linearisations(folder)
    reference, R = solve(sp.pose(scenario, rest, tets), LAWS[model], num_shares)
    turn = np.degrees(np.arccos(np.clip((np.trace(R, axis1=1, axis2=2) - 1.0) / 2.0, -1.0, 1.0))).max()
    error = sp.relative_error(moved - rest, reference)
    print(f"{name:6s} {model:12s} {element} {len(tets):4d} tets turned by up to {turn:3.0f} degrees: {error:.1e}, "
          f"{count} linearisations", flush=True)
    return error <= TOLERANCE and turn > 30.0 and count <= MOST_LINEARISATIONS


def main(argil, is_fine):
    bars = (("p1", (10, 3, 2)), ("p2", (8, 2, 2))) if is_fine else (("p1", (6, 2, 1)), ("p2", (4, 1, 1)))
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        results = []
        for element, cells in bars:
            nodes, tets = sp.bar_mesh(cells, (0.1, 0.03, 0.02))
            sp.write_mesh(folder / "bar.msh", nodes, tets)
            for motion, loads, num_shares in (("bent", bend(nodes), 8), ("turned", twist(nodes, 80), 10)):
                results += [compare(argil, folder, motion, loads, model, element, num_shares) for model in LAWS]
    if not all(results):
        raise SystemExit(f"{results.count(False)} of {len(results)} differ by more than {TOLERANCE}, "
                         f"hardly turn, or take more than {MOST_LINEARISATIONS} linearisations")


if __name__ == "__main__":
    main(sys.argv[1], "--fine" in sys.argv[2:])
