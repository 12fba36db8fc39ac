"""Linear static solutions of the locking-free p1_nodal against a small program of numpy and scipy, node by node.

Usage: check_nodal.py ARGIL

Energy of a displacement u with θ = ∇·u, constant in each tet of volume V:
  Σ V (½ λ' θ² + μ ε:ε) + ½ Σ_a D_a θ_a²,   θ_a = Σ (V κ/4) θ / D_a,   D_a = Σ V κ/4 over the tets around node a
κ is the bulk modulus above that of Poisson's ratio 0.3 at the same μ, λ' = λ − κ. Minimised here as one sparse system.
"""
import pathlib
import sys
import tempfile

import static_problem as sp
from static_problem import np, sparse

TOLERANCE = 1e-8  # of the largest displacement: the demand; what the runs reach is printed


def make_stiffness(problem):
    edges = problem.edge_vectors()
    inner = np.linalg.inv(edges).transpose(0, 2, 1)
    gradient = np.concatenate([-inner.sum(axis=1, keepdims=True), inner], axis=1)  # tet, corner, direction
    volume = np.linalg.det(edges) / 6.0
    lam, mu = problem.lame.T
    own_bulk = 2.0 * 1.3 / (3.0 * (1.0 - 0.6)) * mu  # K = 2μ(1+ν)/(3(1−2ν)) at ν = 0.3
    excess = np.maximum(0.0, lam + 2.0 / 3.0 * mu - own_bulk)
    gg = np.einsum("tia,tjb->tiajb", gradient, gradient)
    blocks = (lam - excess)[:, None, None, None, None] * gg + mu[:, None, None, None, None] * (
        gg.transpose(0, 1, 4, 3, 2) + np.einsum("tic,tjc,ab->tiajb", gradient, gradient, np.eye(3)))
    blocks *= volume[:, None, None, None, None]
    count = 3 * len(problem.nodes)
    dofs = 3 * problem.tets[:, :, None] + np.arange(3)
    i = np.broadcast_to(dofs[:, :, :, None, None], blocks.shape).ravel()
    j = np.broadcast_to(dofs[:, None, None], blocks.shape).ravel()
    own = sparse.coo_matrix((blocks.ravel(), (i, j)), shape=(count, count))
    weight = 0.25 * volume * excess
    D = np.zeros(len(problem.nodes))
    np.add.at(D, problem.tets, weight[:, None])
    parts = np.broadcast_to((weight[:, None, None] * gradient)[:, None], (len(weight), 4, 4, 3))
    rows = np.broadcast_to(problem.tets[:, :, None, None], parts.shape).ravel()
    columns = np.broadcast_to(dofs[:, None], parts.shape).ravel()
    mean = sparse.coo_matrix((parts.ravel(), (rows, columns)), shape=(len(D), count)).tocsr()  # D_a θ_a = mean · u
    inverse = np.divide(1.0, D, out=np.zeros_like(D), where=D > 0.0)
    return (own.tocsr() + mean.T @ sparse.diags(inverse) @ mean).tocsr()


def compare(argil, folder, poissons_ratio, is_uneven):
    nodes, tets = sp.bar_mesh((10, 3, 2), (0.1, 0.03, 0.02))
    modulus = 1e5 * 10.0 ** np.random.default_rng(5).uniform(-1, 1, len(tets)) if is_uneven else None
    sp.write_mesh(folder / "bar.msh", nodes, tets, modulus)
    low, high = nodes.min(axis=0), nodes.max(axis=0)
    tip = np.flatnonzero(nodes[:, 0] == high[0]).tolist()
    body = {"mesh": {"file": "bar.msh", **({"youngs_modulus_field": "modulus"} if is_uneven else {})},
            "fixed": [{"kind": "nodes", "nodes": np.flatnonzero(nodes[:, 0] == low[0]).tolist()},
                      {"kind": "nodes", "nodes": tip[:2], "fixes_y": False, "displacement_m": [1e-3, 0, 2e-3]}],
            "loads": {"nodal": [{"nodes": tip, "force_N": [0, 0.01, -0.02]}], "gravity_m_per_s2": [1, 0, -9.81],
                      "pressure": [{"kind": "box", "lower_m": [low[0], low[1], high[2] - 1e-9],
                                    "upper_m": [high[0], high[1], high[2] + 1e-9], "pressure_Pa": 50}]}}
    scenario = sp.make_scenario(body, "linear", "p1_nodal", poissons_ratio=poissons_ratio)
    rest, tets, moved = sp.run_argil(argil, folder, scenario)
    problem = sp.pose(scenario, rest, tets, modulus)
    reference = sp.solve_free(make_stiffness(problem), problem.force(), problem.prescribed)
    error = sp.relative_error(moved - rest, reference)
    print(f"ν = {poissons_ratio:6} {'uneven' if is_uneven else 'even  '} modulus {len(tets)} tets: {error:.1e}", flush=True)
    return error <= TOLERANCE


def main(argil):
    with tempfile.TemporaryDirectory() as name:
        results = [compare(argil, pathlib.Path(name), nu, is_uneven)
                   for nu in (0.2, 0.45, 0.49, 0.4999) for is_uneven in (False, True)]
    if not all(results):
        raise SystemExit(f"{results.count(False)} of {len(results)} differ by more than {TOLERANCE}")


if __name__ == "__main__":
    main(sys.argv[1])
