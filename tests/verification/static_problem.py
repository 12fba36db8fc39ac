"""A body at rest, its supports and loads, posed anew from a static scenario: what check_static.py and
check_static_large.py compare argil with. Nothing is shared with argil but the words of its reference page.

Arrays have a row a node: positions and displacements in m, forces in N. A 10-node tet has its corners, then the
midpoints of the edges EDGES. A test that cannot run ends with SKIP, which ctest shows as skipped.
"""
import json
import subprocess
import sys
from typing import NamedTuple

SKIP = 77
EDGES = ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))
FACES = ((0, 1, 2), (0, 3, 1), (1, 3, 2), (2, 3, 0))  # of a tet, seen from outside clockwise; the order of C3D4


def skip(words):
    print("skipped:", words)
    sys.exit(SKIP)


try:
    import h5py
    import numpy as np
    import scipy.sparse as sparse
    import scipy.sparse.linalg as linalg
except ImportError as missing:
    skip(f"needs Debian's python3 with h5py, numpy and scipy ({missing})")


class Problem(NamedTuple):
    """Everything that an elastostatic solution depends on."""

    nodes: np.ndarray  # vertices, then midpoints
    tets: np.ndarray  # 4 or 10 nodes each
    num_vertices: int
    lame: np.ndarray  # λ, μ of each tet [Pa]
    prescribed: np.ndarray  # displacement, nan where it is free
    nodal_force: np.ndarray
    pressures: list  # (tet, number in FACES, pressure [Pa])
    body_force: np.ndarray  # density times gravity [N/m³]

    def force(self):
        """Nodal forces of all loads together: the integrals of the shape functions over faces and tets."""
        force = self.nodal_force.copy()
        for tet, face, pressure in self.pressures:
            a, b, c = self.nodes[self.tets[tet, list(FACES[face])]]
            inward = pressure * 0.5 * np.cross(b - a, c - a)
            force[self.face_carriers(tet, face)] += inward / 3.0
        volume = np.linalg.det(self.edge_vectors()) / 6.0
        shares = [0.25] * 4 if self.tets.shape[1] == 4 else [-0.05] * 4 + [0.2] * 6
        for k, share in enumerate(shares):
            np.add.at(force, self.tets[:, k], share * volume[:, None] * self.body_force)
        return force

    def edge_vectors(self):
        corners = self.nodes[self.tets[:, :4]]
        return corners[:, 1:] - corners[:, :1]

    def face_carriers(self, tet, face):
        """Nodes of a face that an even pressure loads: its corners, or on a quadratic face its midpoints."""
        corners = FACES[face]
        if self.tets.shape[1] == 4:
            return self.tets[tet, list(corners)]
        return [self.tets[tet, 4 + k] for k, edge in enumerate(EDGES) if set(edge) <= set(corners)]


def solve_free(stiffness, force, prescribed):
    """u with K u = f where u is free, and as prescribed elsewhere. One refinement takes the factor's rounding out."""
    u = np.nan_to_num(prescribed).ravel()
    free = np.flatnonzero(np.isnan(prescribed.ravel()))
    inner = stiffness[free][:, free].tocsc()
    factor = linalg.splu(inner, permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True})
    right = (force.ravel() - stiffness @ u)[free]
    u[free] = factor.solve(right)
    u[free] += factor.solve(right - inner @ u[free])
    return u.reshape(-1, 3)


def bar_mesh(cells, size):
    """Bar from the origin, each of its cells cut into the six tets around a diagonal."""
    counts = np.array(cells) + 1
    grid = np.stack(np.meshgrid(*(np.arange(n) for n in counts), indexing="ij"), axis=-1)
    number = np.arange(counts.prod()).reshape(counts)
    tets = []
    for cell in np.ndindex(*cells):
        for axes in ((0, 1, 2), (1, 2, 0), (2, 0, 1), (0, 2, 1), (2, 1, 0), (1, 0, 2)):
            path = [np.array(cell)]
            for axis in axes:
                path.append(path[-1] + np.eye(3, dtype=int)[axis])
            corners = [number[tuple(p)] for p in path]
            is_even = axes in ((0, 1, 2), (1, 2, 0), (2, 0, 1))
            tets.append(corners if is_even else [corners[0], corners[2], corners[1], corners[3]])
    return grid.reshape(-1, 3) * np.array(size) / np.array(cells), np.array(tets)


def write_mesh(file, nodes, tets, modulus=None):
    """Gmsh 2.2, with Young's modulus as cell data "modulus" if given."""
    with open(file, "w") as out:
        out.write(f"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{len(nodes)}\n")
        out.writelines(f"{i} {x[0]!r} {x[1]!r} {x[2]!r}\n" for i, x in enumerate(nodes.tolist(), 1))
        out.write(f"$EndNodes\n$Elements\n{len(tets)}\n")
        out.writelines(f"{i} 4 0 {' '.join(map(str, t + 1))}\n" for i, t in enumerate(tets, 1))
        out.write("$EndElements\n")
        if modulus is not None:
            out.write(f'$ElementData\n1\n"modulus"\n1\n0\n3\n0\n1\n{len(tets)}\n')
            out.writelines(f"{i} {value!r}\n" for i, value in enumerate(modulus.tolist(), 1))
            out.write("$EndElementData\n")


def run_argil(argil, folder, scenario, expected_exit=0):
    """Rest positions, tets and positions in equilibrium of the vertices."""
    file = folder / "scene.json"
    file.write_text(json.dumps(scenario))
    done = subprocess.run([argil, "run", file, "-o", folder / "out.h5", "--quiet"], capture_output=True, text=True)
    if done.returncode != expected_exit:
        raise SystemExit(f"argil run ended with {done.returncode}: {done.stderr}")
    with h5py.File(folder / "out.h5") as result:
        return (result["mesh/rest_position"][:], result["mesh/tets"][:].astype(int),
                result["frames/000000/position"][:])


def count_linearisations(folder):
    """That argil's last run took, over all shares of the load."""
    with h5py.File(folder / "out.h5") as result:
        return int(result["physics/newton_iterations"][-1])


def read_body(argil, folder, body):
    """Vertices and tets of a scenario's body, as argil numbers them: every vertex held, nothing moves."""
    held = {"kind": "half_space", "normal": [0, 0, 1], "offset_m": 1e300}
    rest, tets, moved = run_argil(argil, folder, make_scenario({**body, "fixed": [held]}, "linear", "p1"))
    if not np.array_equal(rest, moved):
        raise SystemExit("a body that is held everywhere moved")
    return rest, tets


def make_scenario(body, model, element, youngs_modulus=1e5, poissons_ratio=0.3):
    return {"about": "equilibrium, compared with another program", "body": body,
            "material": {"youngs_modulus_Pa": youngs_modulus, "poissons_ratio": poissons_ratio,
                         "density_kg_per_m3": 1500},
            "dynamics": {"mode": "static", "model": model, "element": element}}


def add_midpoints(nodes, tets):
    ends = np.sort(tets[:, EDGES], axis=2).reshape(-1, 2)
    edges, edge_of = np.unique(ends, axis=0, return_inverse=True)
    return (np.vstack([nodes, nodes[edges].mean(axis=1)]),
            np.hstack([tets, len(nodes) + edge_of.reshape(-1, len(EDGES))]))


def find_region(nodes, num_vertices, region):
    """Numbers of the nodes in a region, or of a list of vertices."""
    if region["kind"] == "nodes":
        assert max(region["nodes"]) < num_vertices
        return np.array(region["nodes"])
    assert region["kind"] == "box"
    return np.flatnonzero(np.all((nodes >= region["lower_m"]) & (nodes <= region["upper_m"]), axis=1))


def with_midpoints(held, tets):
    """Of ten-node tets also the midpoints of edges both of whose ends are held."""
    between = np.isin(tets[:, EDGES], held).all(axis=2)
    return np.union1d(held, tets[:, 4:][between])


def pose(scenario, vertices, tets, modulus=None):
    """The problem that a scenario states for a mesh."""
    material, body = scenario["material"], scenario["body"]
    nodes = vertices
    E = np.full(len(tets), material["youngs_modulus_Pa"]) if modulus is None else modulus
    nu = material["poissons_ratio"]
    corners = tets
    if scenario["dynamics"]["element"] == "p2":
        nodes, tets = add_midpoints(vertices, tets)
    prescribed = np.full_like(nodes, np.nan)
    for support in body["fixed"]:
        held = find_region(nodes, len(vertices), support)
        if tets.shape[1] == 10:
            held = with_midpoints(held, tets)
        for k, axis in enumerate("xyz"):
            if support.get("fixes_" + axis, True):
                prescribed[held, k] = support.get("displacement_m", (0, 0, 0))[k]
    loads = body.get("loads", {})
    nodal = np.zeros_like(nodes)
    for load in loads.get("nodal", []):
        nodal[load["nodes"]] += load["force_N"]
    faces = np.sort(corners[:, FACES], axis=2).reshape(-1, 3)
    _, first, count = np.unique(faces, axis=0, return_index=True, return_counts=True)
    boundary = first[count == 1]
    pressures = [(f // 4, f % 4, load["pressure_Pa"]) for load in loads.get("pressure", []) for f in boundary
                 if np.isin(faces[f], find_region(nodes, len(vertices), load)).all()]
    body_force = material["density_kg_per_m3"] * np.array(loads.get("gravity_m_per_s2", (0.0, 0.0, 0.0)))
    lame = np.stack([E * nu / ((1 + nu) * (1 - 2 * nu)), E / (2 * (1 + nu))], axis=1)
    return Problem(nodes, tets, len(vertices), lame, prescribed, nodal, pressures, body_force)


def relative_error(displacement, reference):
    """Largest difference of a vertex over the largest displacement of any."""
    reference = reference[:len(displacement)]
    return np.linalg.norm(displacement - reference, axis=1).max() / np.linalg.norm(reference, axis=1).max()
