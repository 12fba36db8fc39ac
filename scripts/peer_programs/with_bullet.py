"""The press in Bullet's deformable body, a program that is compiled here against Debian's libbullet-dev."""
import json
import shlex
import shutil
import subprocess
from pathlib import Path

import numpy as np
from peer_programs import block as b

HERE = Path(__file__).resolve().parent
SCALE = 10  # of lengths: at 1 the body flies apart in its first steps
VOXEL, MARGIN = 5e-4, 1e-4  # of the ball's field of distances, of contact [m]
DAMPING = 0.002  # Rayleigh's, of the stiffness [s]
# In single precision. In double, libbullet-dev's other library, the body flies apart with the same settings.
PACKAGE = "bullet"


def why_not():
    if shutil.which("g++") is None or shutil.which("pkg-config") is None:
        return "needs g++ and pkg-config"
    if subprocess.run(["pkg-config", "--exists", PACKAGE], check=False).returncode != 0:
        return "needs Debian's libbullet-dev"
    return ""


def build(folder):
    """The program, made where it is missing or older than its source."""
    source, program = HERE / "press_bullet.cpp", folder / "press_bullet"
    if program.is_file() and program.stat().st_mtime > source.stat().st_mtime:
        return program
    folder.mkdir(parents=True, exist_ok=True)
    flags = subprocess.run(["pkg-config", "--cflags", "--libs", PACKAGE], capture_output=True, text=True,
                           check=True).stdout
    subprocess.run(["g++", "-std=c++20", "-O3", "-march=native", "-DNDEBUG", source, "-o", program, *shlex.split(flags)], check=True)
    return program


def version():
    return subprocess.run(["pkg-config", "--modversion", PACKAGE], capture_output=True, text=True, check=True).stdout.strip()


def press(folder, program, cells, step):
    nodes, tets = b.make_tets(cells)
    # Nodes that are held come last: Bullet's implicit step takes the numbers of the free ones for places in its vectors.
    order = np.argsort(nodes[:, 2] < -b.HEIGHT * (1 - 1e-9), kind="stable")
    number = np.empty_like(order)
    number[order] = np.arange(len(order))
    with open(folder / "block.txt", "w", encoding="ascii") as out:
        out.write(f"{len(nodes)} {len(tets)}\n")
        np.savetxt(out, nodes[order], fmt="%.12g")
        np.savetxt(out, number[tets], fmt="%d")
    given = {"scale": SCALE, "radius": b.RADIUS, "height": b.HEIGHT, "depth": b.DEPTH, "young": b.YOUNG, "poisson": b.POISSON,
             "density": b.DENSITY, "damping": DAMPING, "voxel": VOXEL, "margin": MARGIN, "down": b.DOWN, "end": b.END,
             "held": b.HELD}
    done = subprocess.run([program, folder / "block.txt", str(step), *(f"{name}={value}" for name, value in given.items())],
                          capture_output=True, text=True, check=True)
    return {**json.loads(done.stdout), "tets": len(tets), "nodes": len(nodes)}
