#!/usr/bin/python3
"""What steps of the region that moves cost and how far their force is off, beside steps of the whole body, on slabs of one
thickness and one size of tets that differ in width: a sphere presses 1.5 mm and slides (traces/block_slide.csv).

    scripts/bench_extent.py [--build BUILD] [--cells 14 46 144] [--tolerances 0.03 0.01]

writes results/bench/extent.csv. One thread, processor time of the whole program and, from `run --dry-run`, of its start.
A slab of 144 cells a side has 995 328 tets; the three take a quarter of an hour.
"""
import argparse
import json
import resource
import subprocess
import tempfile
from pathlib import Path

import h5py
import numpy as np

ROOT = Path(__file__).resolve().parent.parent
CELL = 0.00375  # [m]
LAYERS = 8


def write_slab(file, cells):
    """`cells` by `cells` by LAYERS cells of six tets each, about the axis x = y = 0, on z = 0."""
    line = (np.arange(cells + 1) - cells / 2) * CELL
    z, y, x = np.meshgrid(np.arange(LAYERS + 1) * CELL, line, line, indexing="ij")
    number = np.arange(x.size).reshape(x.shape)
    k, j, i = (a.ravel() for a in np.meshgrid(np.arange(LAYERS), np.arange(cells), np.arange(cells), indexing="ij"))
    corner = {(a, b, c): number[k + c, j + b, i + a] for a in (0, 1) for b in (0, 1) for c in (0, 1)}
    tets = []
    for axes in ((0, 1, 2), (1, 2, 0), (2, 0, 1), (0, 2, 1), (2, 1, 0), (1, 0, 2)):
        at, path = [0, 0, 0], [corner[0, 0, 0]]
        for axis in axes:
            at[axis] = 1
            path.append(corner[tuple(at)])
        if axes not in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
            path[1], path[2] = path[2], path[1]
        tets.append(np.stack(path, axis=1))
    tets = np.stack(tets, axis=1).reshape(-1, 4)
    nodes = np.stack([x, y, z], axis=-1).reshape(-1, 3)
    with open(file, "w", encoding="ascii") as out:
        out.write(f"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{len(nodes)}\n")
        np.savetxt(out, np.column_stack([np.arange(1, len(nodes) + 1), nodes]), fmt="%d %.17g %.17g %.17g")
        out.write(f"$EndNodes\n$Elements\n{len(tets)}\n")
        head = np.tile([4, 0], (len(tets), 1))
        np.savetxt(out, np.column_stack([np.arange(1, len(tets) + 1), head, tets + 1]), fmt="%d")
        out.write("$EndElements\n")
    return len(tets)


def run(argil, folder, settings, *options):
    """Processor time [s] of a run."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    sets = [word for setting in settings for word in ("--set", setting)]
    subprocess.run([argil, "run", folder / "slab.json", "-q", "-o", folder / "slab.h5", "--threads", "1", *sets, *options],
                   check=True, stdout=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def read(folder):
    with h5py.File(folder / "slab.h5") as file:
        active = file["physics/active_nodes"][:]
        return file["haptic/force"][:], active[active > 0]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", default=ROOT / "build", type=Path)
    parser.add_argument("--cells", nargs="+", type=int, default=[14, 46, 144])
    parser.add_argument("--tolerances", nargs="+", type=float, default=[0.03, 0.01])
    options = parser.parse_args()
    argil = options.build / "bin" / "argil"
    commit = subprocess.run(["git", "-C", ROOT, "rev-parse", "--short", "HEAD"], capture_output=True, text=True,
                            check=True).stdout.strip()
    lines = [f"# commit {commit}, one thread; times in s of a processor",
             "tets,extent,tolerance,steps,nodes_mean,nodes_free,start,run,ms_a_step,force_off_largest_over_peak,force_off_rms"]
    for cells in options.cells:
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            tets = write_slab(folder / "slab.msh", cells)
            scenario = json.loads((ROOT / "scenarios" / "study_slide.json").read_text(encoding="utf-8"))
            scenario["body"] = {"mesh": {"file": "slab.msh"}, "fixed": scenario["body"]["fixed"]}
            scenario["trace"]["file"] = str(ROOT / "traces" / "block_slide.csv")
            (folder / "slab.json").write_text(json.dumps(scenario), encoding="utf-8")
            start = run(argil, folder, [], "--dry-run")
            time = run(argil, folder, [])
            force, active = read(folder)
            free = active.max()
            steps = len(force) - int(np.argmax(np.linalg.norm(force, axis=1) > 0))  # before the touch it rests
            peak, size = np.linalg.norm(force, axis=1).max(), np.sqrt((force**2).sum(axis=1).mean())
            lines.append(f"{tets},whole,,{steps},{free},{free},{start:.2f},{time:.2f},{1e3 * (time - start) / steps:.3f},0,0")
            for tolerance in options.tolerances:
                time = run(argil, folder, ["/dynamics/extent=local", f"/dynamics/region_tolerance={tolerance}"])
                local, active = read(folder)
                off = np.linalg.norm(local - force, axis=1)
                lines.append(f"{tets},local,{tolerance:g},{steps},{active.mean():.0f},{free},{start:.2f},{time:.2f},"
                             f"{1e3 * (time - start) / steps:.3f},{off.max() / peak:.2e},{np.sqrt((off**2).mean()) / size:.2e}")
            print("\n".join(lines[-1 - len(options.tolerances):]), flush=True)
    (ROOT / "results" / "bench" / "extent.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
