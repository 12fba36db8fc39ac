#!/usr/bin/python3
"""Cook's membrane in plane strain at ν = 0.4999: the fine value that results/verification measures against, beside
CalculiX's 20-node bricks of reduced integration, which do not lock.

Usage: check_cook.py [CELLS ...]      prints CalculiX's tip displacement for each; none: 32, compared with the table
"""
import csv
import itertools
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

TABLE = Path(__file__).resolve().parents[2] / "results" / "verification" / "cook_plane_strain.csv"
NU = 0.4999
# Nodes of C3D20R in half cells: corners of the lower and upper face, then middles of their edges and of the uprights.
CORNERS = ((0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (0, 0, 2), (2, 0, 2), (2, 2, 2), (0, 2, 2))
MIDDLES = ((1, 0, 0), (2, 1, 0), (1, 2, 0), (0, 1, 0), (1, 0, 2), (2, 1, 2), (1, 2, 2), (0, 1, 2),
           (0, 0, 1), (2, 0, 1), (2, 2, 1), (0, 2, 1))


def position(place, cells):
    s, t = place[0] / (2 * cells), place[1] / (2 * cells)
    return 48.0 * s, 44.0 * s + t * (44.0 - 28.0 * s), 0.5 * place[2]


def make_model(cells):
    """Input of CalculiX: unit load upward, spread evenly over the right side by the shape functions."""
    numbers, bricks, load = {}, [], {}
    for a, b in itertools.product(range(cells), repeat=2):
        bricks.append([numbers.setdefault((2 * a + i, 2 * b + j, k), len(numbers) + 1) for i, j, k in CORNERS + MIDDLES])
    for b in range(cells):
        for j, k in itertools.product(range(3), repeat=2):
            is_corner = j != 1 and k != 1
            if is_corner or (j == 1) != (k == 1):  # an 8-node face has no middle
                node = numbers[2 * cells, 2 * b + j, k]
                load[node] = load.get(node, 0.0) + (-1.0 / 12.0 if is_corner else 1.0 / 3.0) / cells
    lines = ["*NODE, NSET=ALL", *(f"{n}, " + ", ".join(f"{x:.12e}" for x in position(p, cells))
                                  for p, n in numbers.items()), "*ELEMENT, TYPE=C3D20R, ELSET=E"]
    for n, brick in enumerate(bricks, 1):
        words = [str(n), *map(str, brick)]
        lines += [", ".join(words[:11]) + ",", ", ".join(words[11:])]
    lines += ["*NSET, NSET=LEFT", *(str(n) for p, n in numbers.items() if p[0] == 0),
              f"*NSET, NSET=TIP\n{numbers[2 * cells, cells, 0]}",
              f"*MATERIAL, NAME=M\n*ELASTIC\n1, {NU}\n*SOLID SECTION, ELSET=E, MATERIAL=M",
              "*BOUNDARY\nALL, 3, 3\nLEFT, 1, 2\n*STEP\n*STATIC\n*CLOAD", *(f"{n}, 2, {f:.12e}" for n, f in load.items()),
              "*NODE PRINT, NSET=TIP\nU\n*END STEP"]
    return "\n".join(lines) + "\n"


def solve(cells):
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "cook.inp").write_text(make_model(cells))
        done = subprocess.run(["ccx", "cook"], cwd=folder, capture_output=True, text=True)
        if done.returncode != 0:
            raise SystemExit(f"ccx failed:\n{done.stdout[-2000:]}")
        return float(Path(folder, "cook.dat").read_text().split()[-2])


def main():
    if shutil.which("ccx") is None:
        print("skipped: needs ccx of Debian's calculix-ccx")
        return 77
    if len(sys.argv) > 1:
        for cells in map(int, sys.argv[1:]):
            print(cells, solve(cells), flush=True)
        return 0
    with open(TABLE, encoding="ascii") as file:
        ours = float(next(csv.DictReader(file))["fine"])
    theirs = solve(32)
    print(f"tip displacement on 32 cells: ours {ours:.5g}, CalculiX {theirs:.5g}")
    return 0 if abs(ours - theirs) <= 0.003 * theirs else 1  # both still converge: 0.3 % to the next mesh


if __name__ == "__main__":
    sys.exit(main())
