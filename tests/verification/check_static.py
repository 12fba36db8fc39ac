"""Linear static solutions of argil against CalculiX, another finite element program, node by node.

Usage: check_static.py ARGIL [FOLDER OF PUBLIC DATA]

Two comparisons a case. CalculiX prints displacements to seven digits only, but its stiffness matrix to fourteen
(*FREQUENCY, SOLVER=MATRIXSTORAGE): K u = f with that matrix is solved here and compared to 1e-8. CalculiX's own
displacements confirm, to their digits, that its loads and supports are ours too. C3D4 stands for p1, C3D10 for p2.
"""
import pathlib
import shutil
import subprocess
import sys
import tempfile

import static_problem as sp
from static_problem import np, sparse

TOLERANCE = 1e-8  # of the largest displacement: the demand; what the runs reach is printed
PRINTED = 2e-6  # seven digits of each component, and loads that CalculiX keeps in seven


def write_list(out, heading, rows):
    if rows:
        out.write(heading + "\n" + "\n".join(", ".join(map(str, row)) for row in rows) + "\n")


def digits(value):
    return f"{value:.13e}"  # CalculiX reads twenty characters of a number


def write_model(out, problem, youngs_modulus, poissons_ratio, density):
    write_list(out, "*NODE, NSET=ALL", [(i, *map(digits, x)) for i, x in enumerate(problem.nodes, 1)])
    kind = "C3D4" if problem.tets.shape[1] == 4 else "C3D10"
    values, group = np.unique(youngs_modulus, return_inverse=True)
    for g, value in enumerate(values):
        write_list(out, f"*ELEMENT, TYPE={kind}, ELSET=E{g}",
                   [(t + 1, *(problem.tets[t] + 1)) for t in np.flatnonzero(group == g)])
        out.write(f"*MATERIAL, NAME=M{g}\n*ELASTIC\n{digits(value)}, {digits(poissons_ratio)}\n"
                  f"*DENSITY\n{digits(density)}\n*SOLID SECTION, ELSET=E{g}, MATERIAL=M{g}\n")
    return len(values)


def run_ccx(folder, job):
    done = subprocess.run(["ccx", job], cwd=folder, capture_output=True, text=True)
    if done.returncode != 0 or "Job finished" not in done.stdout:
        raise SystemExit(f"ccx {job} failed:\n{done.stdout[-2000:]}{done.stderr}")


def read_stiffness(folder, num_nodes):
    """CalculiX's matrix of the body without supports; its rows in the order node, direction."""
    dofs = np.loadtxt(folder / "stiffness.dof", dtype=str)
    if not np.array_equal(dofs, [f"{n}.{k}" for n in range(1, num_nodes + 1) for k in (1, 2, 3)]):
        raise SystemExit("stiffness.dof is not in the order of the nodes")
    rows = np.loadtxt(folder / "stiffness.sti")
    i, j = (rows[:, k].astype(int) - 1 for k in (0, 1))
    upper = sparse.coo_matrix((rows[:, 2], (i, j)), shape=(3 * num_nodes,) * 2).tocsr()
    return upper + sparse.triu(upper, 1).T + sparse.tril(upper, -1).T


def solve_with_ccx(folder, problem, material, youngs_modulus):
    """Displacements by CalculiX's matrix, and those that it prints."""
    model = (problem, youngs_modulus, material["poissons_ratio"], material["density_kg_per_m3"])
    with open(folder / "stiffness.inp", "w") as out:
        write_model(out, *model)
        out.write("*STEP\n*FREQUENCY, SOLVER=MATRIXSTORAGE\n*END STEP\n")
    with open(folder / "static.inp", "w") as out:
        num_groups = write_model(out, *model)
        held = np.argwhere(~np.isnan(problem.prescribed))
        loaded = np.argwhere(problem.nodal_force != 0)
        out.write("*STEP\n*STATIC\n")
        write_list(out, "*BOUNDARY",
                   [(n + 1, k + 1, k + 1, digits(problem.prescribed[n, k])) for n, k in held])
        write_list(out, "*CLOAD", [(n + 1, k + 1, digits(problem.nodal_force[n, k])) for n, k in loaded])
        write_list(out, "*DLOAD", [(t + 1, f"P{face + 1}", digits(p)) for t, face, p in problem.pressures])
        g = problem.body_force / material["density_kg_per_m3"]
        size = np.linalg.norm(g)
        if size > 0:
            write_list(out, "*DLOAD",
                       [(f"E{k}", "GRAV", digits(size), *map(digits, g / size)) for k in range(num_groups)])
        out.write("*NODE PRINT, NSET=ALL\nU\n*END STEP\n")
    for job in ("stiffness", "static"):
        run_ccx(folder, job)
    u = sp.solve_free(read_stiffness(folder, len(problem.nodes)), problem.force(), problem.prescribed)
    printed = np.loadtxt(folder / "static.dat", skiprows=3)
    if not np.array_equal(printed[:, 0], np.arange(1, len(problem.nodes) + 1)):
        raise SystemExit("static.dat does not hold every node")
    return u, printed[:, 1:]


def support_and_load(nodes):
    """One end held, the other drawn aside and free across; a push on some vertices; pressure; gravity."""
    length = np.ptp(nodes[:, 0])
    order = np.argsort(nodes[:, 0], kind="stable")
    some = max(4, len(nodes) // 12)
    middle = order[len(order) // 2:len(order) // 2 + some // 2]
    low, high = nodes.min(axis=0), nodes.max(axis=0)
    return {
        "fixed": [
            {"kind": "nodes", "nodes": order[:some].tolist()},
            {"kind": "nodes", "nodes": order[-some:].tolist(), "fixes_z": False,
             "displacement_m": [0.01 * length, 0.03 * length, 0]},
            {"kind": "box", "lower_m": (low - length).tolist(),
             "upper_m": [low[0] + 0.02 * length, *(high[1:] + length)]}],
        "loads": {
            "gravity_m_per_s2": [1.0, -2.0, -9.81],
            "nodal": [{"nodes": middle.tolist(), "force_N": [0, 0, 300 * length**2]},
                      {"nodes": middle[:2].tolist(), "force_N": [200 * length**2, 0, 0]}],
            "pressure": [{"kind": "box", "lower_m": [low[0] + 0.3 * length, *(low[1:] - length)],
                          "upper_m": (high + length).tolist(), "pressure_Pa": 900}]}}


def compare(argil, name, body, element, is_uneven=False, poissons_ratio=0.3):
    """Runs a body in both programs and prints how far they are apart. True when that is within the demand."""
    with tempfile.TemporaryDirectory() as name_of_folder:
        folder = pathlib.Path(name_of_folder)
        vertices, tets = sp.read_body(argil, folder, body)
        modulus = None
        if is_uneven:
            modulus = 1e5 * 10.0 ** np.random.default_rng(7).uniform(-1, 1, len(tets))
            sp.write_mesh(folder / "uneven.msh", vertices, tets, modulus)
            body = {"mesh": {"file": "uneven.msh", "youngs_modulus_field": "modulus"}}
        scenario = sp.make_scenario({**body, **support_and_load(vertices)}, "linear", element,
                                    poissons_ratio=poissons_ratio)
        scenario["dynamics"]["allow_locking"] = True  # it is the same in both programs
        rest, tets, moved = sp.run_argil(argil, folder, scenario)
        problem = sp.pose(scenario, rest, tets, modulus)
        material = scenario["material"]
        E = np.full(len(tets), material["youngs_modulus_Pa"]) if modulus is None else modulus
        reference, printed = solve_with_ccx(folder, problem, material, E)
        error = sp.relative_error(moved - rest, reference)
        error_printed = sp.relative_error(printed, reference)
    print(f"{name:24s} {element} {len(tets):6d} tets {len(problem.pressures):5d} faces pressed: "
          f"{error:.1e} by CalculiX's matrix; printed {error_printed:.1e} off", flush=True)
    return error <= TOLERANCE and error_printed <= PRINTED


def make_cage(argil, folder):
    """Cage of a skewed octahedron."""
    corners = ((1.2, 0.1, 0), (0, 0.8, 0.1), (0.2, 0, 0.9), (-1, 0, 0), (0, -0.7, 0), (0.1, 0, -1))
    faces = ((1, 2, 3), (2, 4, 3), (4, 5, 3), (5, 1, 3), (2, 1, 6), (4, 2, 6), (5, 4, 6), (1, 5, 6))
    (folder / "octahedron.obj").write_text(
        "".join(f"v {x} {y} {z}\n" for x, y, z in corners) + "".join(f"f {a} {b} {c}\n" for a, b, c in faces))
    subprocess.run([argil, "cage", folder / "octahedron.obj", "-o", folder / "cage.msh", "--tets", "1500",
                    "--scale", "0.05"], check=True, stdout=subprocess.DEVNULL)
    return {"mesh": {"file": str(folder / "cage.msh")}}


def main(argil, data):
    if shutil.which("ccx") is None:
        sp.skip("needs ccx of Debian's calculix-ccx")
    box = {"shape": {"kind": "box", "size_m": 0.1, "target_tets": 500, "skin_triangles": 0}}
    dinosaur = {"shape": {"kind": "dinosaur", "size_m": 0.2, "target_tets": 2500, "skin_triangles": 0}}
    cases = [("box", box, "p1"), ("box", box, "p2"), ("box, uneven modulus", box, "p1", True),
             ("box, uneven modulus", box, "p2", True), ("dinosaur", dinosaur, "p1"),
             ("box, ν = 0.49", box, "p1", False, 0.49), ("box, ν = 0.49", box, "p2", False, 0.49),
             ("box, uneven, ν = 0.49", box, "p1", True, 0.49)]
    public = (("bar-2523.msh", "p1"), ("bar-2523.msh", "p2"), ("torus.msh", "p2"), ("sphere5K.msh", "p1"))
    for file, element in public:
        if data and (data / "tets" / file).exists():
            cases.append((file, {"mesh": {"file": str(data / "tets" / file)}}, element))
        else:
            print(f"left out: {file} of the public data folder, which is not beside the project")
    with tempfile.TemporaryDirectory() as folder:
        cage = make_cage(argil, pathlib.Path(folder))
        cases += [("cage of an octahedron", cage, "p1"), ("cage of an octahedron", cage, "p2")]
        results = [compare(argil, *case) for case in cases]
    if not all(results):
        raise SystemExit(f"{results.count(False)} of {len(results)} differ by more than {TOLERANCE}, {PRINTED}")


if __name__ == "__main__":
    main(sys.argv[1], pathlib.Path(sys.argv[2]) if len(sys.argv) > 2 else None)
