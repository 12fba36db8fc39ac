"""The press in CalculiX: a static step with contact; the ball is a cap of hexahedra whose nodes are all led.

Lengths are in mm, forces in N, stresses in MPa. With NLGEOM its linear elastic law is Saint Venant and Kirchhoff's: the second
Piola stress is linear in Green's strain.
"""
import os
import re
import resource
import shutil
import subprocess

import numpy as np
from peer_programs import block as b

CONTACT_STIFFNESS = 1000 * b.YOUNG * 1e-6  # of the penalty, pressure [MPa] over overlap [mm]
FACES = {"tet": ((0, 1, 2), (0, 1, 3), (1, 2, 3), (2, 0, 3)),  # S1 to S4 and S1 to S6 of CalculiX
         "hex": ((0, 1, 2, 3), (4, 7, 6, 5), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 4, 0))}


def why_not():
    return "" if shutil.which("ccx") else "needs ccx of Debian's calculix-ccx"


def version():
    """CalculiX prints it and exits with an error, which is none."""
    printed = subprocess.run(["ccx", "-v"], capture_output=True, text=True, check=False).stdout
    return re.search(r"[Vv]ersion ([\d.]+)", printed)[1]


def write_set(out, heading, numbers):
    out.write(heading + "\n")
    out.writelines(", ".join(map(str, numbers[i:i + 8])) + "\n" for i in range(0, len(numbers), 8))


def make_cap(first_node, fine, is_quarter):
    """Nodes [mm], hexahedra and numbers of the ball's lower side: a square grid of directions, over 1 mm of thickness."""
    slopes = np.linspace(-0.05 if is_quarter else -0.75, 0.75, fine + 1)
    u, v = (axis.ravel() for axis in np.meshgrid(slopes, slopes, indexing="ij"))
    directions = np.stack([u, v, -np.ones_like(u)], axis=1)
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    radius = 1e3 * b.RADIUS
    nodes = np.concatenate([radius * directions, (radius - 1) * directions]) + [0, 0, radius]
    number = first_node + np.arange(len(nodes)).reshape(2, fine + 1, fine + 1)
    corners = ((0, 0, 0), (0, 1, 0), (0, 1, 1), (0, 0, 1), (1, 0, 0), (1, 1, 0), (1, 1, 1), (1, 0, 1))
    hexes = np.stack([number[k, i:fine + i, j:fine + j].ravel() for k, i, j in corners], axis=1)
    return nodes, hexes


def write_model(file, kind, cells, *, law="", is_quarter=False, stiffness=CONTACT_STIFFNESS, fine=40, increment=0.25,
                is_large=True, holds=2, contact="SURFACE TO SURFACE"):
    """`kind`: CalculiX's name of the element; `fine`: edges of the cap along a side; `increment`: share of the depth; `is_large`: the law
    of large strain. Returns how many elements and nodes there are."""
    nodes, elements = b.make_grid(cells, is_quarter)
    shape = "hex"
    if kind.startswith(("C3D4", "C3D10")):
        shape, elements = "tet", b.cut_into_tets(elements)
    if kind.startswith("C3D10"):
        nodes, elements = b.add_middles(nodes, elements, b.TET_EDGES)
    if kind.startswith("C3D20"):
        nodes, elements = b.add_middles(nodes, elements, b.HEX_EDGES)
    nodes = 1e3 * nodes
    cap_nodes, cap = make_cap(len(nodes), fine, is_quarter)
    top = np.abs(nodes[:, 2]) < 1e-9
    near = top & (np.hypot(nodes[:, 0], nodes[:, 1]) < 1e3 * b.RADIUS)
    with open(file, "w", encoding="ascii") as out:
        out.write("*NODE, NSET=ALL\n")
        out.writelines(f"{i}, {x:.12g}, {y:.12g}, {z:.12g}\n"
                       for i, (x, y, z) in enumerate(np.concatenate([nodes, cap_nodes]), 1))
        for name, element_kind, rows, first in (("BLOCK", kind, elements, 1), ("BALL", "C3D8", cap, len(elements) + 1)):
            out.write(f"*ELEMENT, TYPE={element_kind}, ELSET={name}\n")
            for i, row in enumerate(rows + 1, first):
                words = [str(i), *map(str, row)]
                out.write(", ".join(words[:16]) + (",\n" + ", ".join(words[16:]) if len(words) > 16 else "") + "\n")
        write_set(out, "*NSET, NSET=HELD", np.flatnonzero(nodes[:, 2] < -1e3 * b.HEIGHT + 1e-6) + 1)
        write_set(out, "*NSET, NSET=CAP", len(nodes) + 1 + np.arange(len(cap_nodes)))
        for axis, name in ((0, "SX"), (1, "SY")):
            if is_quarter:
                write_set(out, f"*NSET, NSET={name}", np.flatnonzero(np.abs(nodes[:, axis]) < 1e-9) + 1)
        out.write("*SURFACE, NAME=TOP, TYPE=ELEMENT\n")
        for side, corners in enumerate(FACES[shape], 1):
            on_top = np.all(top[elements[:, corners]], axis=1) & np.any(near[elements[:, corners]], axis=1)
            out.writelines(f"{e + 1}, S{side}\n" for e in np.flatnonzero(on_top))
        out.write("*SURFACE, NAME=UNDERSIDE, TYPE=ELEMENT\n")
        out.writelines(f"{len(elements) + 1 + e}, S1\n" for e in range(len(cap)))
        out.write(f"*MATERIAL, NAME=CLAY\n*ELASTIC\n{1e-6 * b.YOUNG:.12g}, {b.POISSON}\n{law}"
                  "*MATERIAL, NAME=STEEL\n*ELASTIC\n1, 0.3\n"
                  "*SOLID SECTION, ELSET=BLOCK, MATERIAL=CLAY\n*SOLID SECTION, ELSET=BALL, MATERIAL=STEEL\n"
                  "*SURFACE INTERACTION, NAME=TOUCH\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n"
                  f"{stiffness:.12g}\n*CONTACT PAIR, INTERACTION=TOUCH, TYPE={contact}\nTOP, UNDERSIDE\n"
                  "*BOUNDARY\nHELD, 1, 3\n")
        if is_quarter:
            out.write("*BOUNDARY\nSX, 1, 1\nSY, 2, 2\n")
        step = "*STEP, NLGEOM, INC=200\n" if is_large else "*STEP, INC=200\n"
        lead = f"*BOUNDARY\nCAP, 1, 2\nCAP, 3, 3, {-1e3 * b.DEPTH:.12g}\n"
        out.write(f"{step}*STATIC\n{increment}, 1, 1e-4, {increment}\n{lead}"
                  "*NODE PRINT, NSET=HELD, TOTALS=ONLY\nRF\n*END STEP\n")
        # Each increment presses on the pairs of faces that it finds at its start: once more where the ball is now.
        for _ in range(holds):
            out.write(f"{step}*STATIC\n1, 1\n{lead}*NODE PRINT, NSET=HELD, TOTALS=ONLY\nRF\n*END STEP\n")
    return len(elements), len(nodes)


def press(folder, kind, cells, is_quarter=False, **options):
    """What a row of the table says of a static press."""
    elements, nodes = write_model(folder / "press.inp", kind, cells, is_quarter=is_quarter, **options)
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(["ccx", "press"], cwd=folder, capture_output=True, text=True, check=False,
                          env={**os.environ, "OMP_NUM_THREADS": "1"})
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode != 0 or "Job finished" not in done.stdout:
        raise RuntimeError(f"ccx failed on {kind}, {cells} cells: {done.stdout[-500:]}")
    totals = re.findall(r"total force.*\s+(\S+)\s+(\S+)\s+(\S+)", (folder / "press.dat").read_text())
    force = abs(float(totals[-1][2])) * (4 if is_quarter else 1)
    return {"force_N": force, "swing_N": 0.0, "tets": elements, "nodes": nodes,
            "cpu_s": after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime}


def press_as_peer(folder, kind, cells):
    """As quick as CalculiX can be. Four-node tets and bricks press with their nodes, which is quicker and nearer to the limit than with
    their faces. Which increments converge cannot be told beforehand: the time is that of the first that do."""
    nodes, faces = {"contact": "NODE TO SURFACE", "holds": 1}, {"contact": "SURFACE TO SURFACE", "holds": 1}
    ways = [{**nodes, "increment": share} for share in (1.0, 0.5, 0.25)] if kind != "C3D10" else []
    for way in [*ways, *({**faces, "increment": share} for share in (0.5, 0.25))]:
        try:
            return press(folder, kind, cells, fine=32, **way)
        except RuntimeError as failure:
            last = failure
    raise last
