#!/usr/bin/python3
"""What a local push costs on slabs of one thickness and one size of tets that differ in width: steps of the whole body,
of the region that the hand feels (`fidelity: auto`), and of the region that moves (`extent: local`), and how far their
forces are off.

    scripts/bench_extent.py [--build BUILD] [--cells 14 46 144] [--scenes light push thin slide]

light: a sphere of 8 mm presses 0.5 mm; push: the same, 1.5 mm, and moves 6 mm aside; thin: that push on slabs half as thick
and so much wider that they have as many tets; slide: a sphere of 24 mm presses 1.5 mm and slides (traces/block_slide.csv), on
cells half as large again. Writes results/bench/extent.csv. One thread, time
of the steps' stages: what is written is not counted; the median of five runs, all sizes and modes by turns. A slab of 144 cells a side has 995 328 tets, whose whole takes half
a second a step: `--most-whole TETS` leaves it out, and what it is compared with. `start_s` is the wall time of a run of one tick, from
the process's start to its end, least of five: mesh read, body made, first frame written; `peak_MiB` the largest resident
memory of all runs.
"""
import argparse
import json
import re
import subprocess
import tempfile
import time
from pathlib import Path
from typing import NamedTuple

import h5py
import numpy as np
import provenance

ROOT = Path(__file__).resolve().parent.parent
LAYERS = 8
REPEATS = 5
STAGES = ("contact", "water", "assemble", "solve", "kinematics", "plasticity")
SMALL_TOOL = {"kind": "sphere", "radius_m": 0.008, "subdivisions": 3}


class Scene(NamedTuple):
    """scenarios/study_slide.json on a slab, with another tool, motion and range of the clay kernel, and without friction."""

    cell: float  # [m]
    depth: float = 0.0  # [m] of the press; 0: motion and tool of the scenario
    aside: float = 0.0  # [m]
    layers: int = LAYERS  # of cells

    def widen(self, cells):
        """Cells a side with which a slab of these layers has as many as one of LAYERS."""
        return round(cells * (LAYERS / self.layers) ** 0.5)


SCENES = {"light": Scene(0.0025, 0.0005), "push": Scene(0.0025, 0.0015, 0.006),
          "thin": Scene(0.0025, 0.0015, 0.006, LAYERS // 2), "slide": Scene(0.00375)}
MODES = {"whole": ["/dynamics/extent=whole"], "auto": ["/fidelity/mode=auto"],
         "local 0.01": ["/dynamics/extent=local", "/dynamics/region_tolerance=0.01"]}


def write_push(file, scene):
    """Down at 20 mm/s from 0.2 mm above the slab, aside at 30 mm/s, up again."""
    top = scene.layers * scene.cell + SMALL_TOOL["radius_m"]
    with open(file, "w", encoding="ascii") as out:
        out.write("# argil-trace: 1\n# device: press\n# units: m\ntime_s,x_m,y_m,z_m,qx,qy,qz,qw,mode\n")
        for tick in range(401):
            time = 1e-3 * tick
            depth = min(scene.depth, -0.0002 + 0.02 * time, scene.depth - 0.02 * (time - 0.3))
            x = min(max(0.0, 0.03 * (time - 0.1)), scene.aside)
            out.write(f"{time:.3f},{x:.9g},0,{top - max(depth, -0.0005):.9g},0,0,0,1,push\n")


def write_slab(file, cells, layers, cell):
    """`cells` by `cells` by `layers` cells of six tets each, about the axis x = y = 0, on z = 0."""
    line = (np.arange(cells + 1) - cells / 2) * cell
    z, y, x = np.meshgrid(np.arange(layers + 1) * cell, line, line, indexing="ij")
    number = np.arange(x.size).reshape(x.shape)
    k, j, i = (a.ravel() for a in np.meshgrid(np.arange(layers), np.arange(cells), np.arange(cells), indexing="ij"))
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


def write_scene(folder, scene, cells):
    """Returns the number of tets."""
    scenario = json.loads((ROOT / "scenarios" / "study_slide.json").read_text(encoding="utf-8"))
    scenario["body"] = {"mesh": {"file": "slab.msh"}, "fixed": scenario["body"]["fixed"]}
    scenario["trace"]["file"] = str(ROOT / "traces" / "block_slide.csv")
    scenario["haptics"]["frame_period_ticks"] = 100000  # a frame holds the whole body
    if scene.depth > 0.0:
        scenario["tool"]["shape"] = SMALL_TOOL
        scenario["contact"]["friction"] = 0.0
        scenario["material"]["clay_kernel"]["radius_m"] = 0.015
        scenario["trace"]["file"] = "push.csv"
        write_push(folder / "push.csv", scene)
    (folder / "slab.json").write_text(json.dumps(scenario), encoding="utf-8")
    return write_slab(folder / "slab.msh", scene.widen(cells), scene.layers, scene.cell)


def call(argil, folder, settings):
    """Seconds of a run, and its largest resident memory [MiB]."""
    sets = [word for setting in settings for word in ("--set", setting)]
    start = time.perf_counter()
    process = subprocess.Popen([argil, "run", folder / "slab.json", "-q", "-o", folder / "slab.h5", "--threads", "1", *sets],
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    # What the system accounts to an ended child begins with this script's own memory.
    peak = 0.0
    while process.poll() is None:
        peak = read_peak_MiB(process.pid) or peak
        time.sleep(0.002)
    seconds = time.perf_counter() - start
    if process.returncode != 0:
        raise subprocess.CalledProcessError(process.returncode, process.args)
    return seconds, peak


def read_peak_MiB(pid):
    """Largest resident memory so far of a process that runs its own program; 0 of one that has ended."""
    found = re.search(r"^VmHWM:\s*(\d+) kB", Path(f"/proc/{pid}/status").read_text(), re.MULTILINE)
    return int(found[1]) / 1024 if found else 0.0


class Sample(NamedTuple):
    """Of one run."""

    force: np.ndarray
    active: np.ndarray  # nodes that steps solved for
    ms: float  # of a step in which the tool touches
    start: float  # [s]
    peak: float  # [MiB]


def run(argil, folder, settings):
    start, low = call(argil, folder, [*settings, "/trace/duration_s=0.001"])
    _, peak = call(argil, folder, settings)
    with h5py.File(folder / "slab.h5") as file:
        force, active = file["haptic/force"][:], file["physics/active_nodes"][:]
        seconds = sum(file["timing"][stage][0] for stage in STAGES)
    touches = np.linalg.norm(force, axis=1) > 0  # before, the body rests
    return Sample(force, active[active > 0], 1e3 * seconds / touches.sum(), start, max(low, peak))


def describe(samples, whole):
    """The columns of a mode; `whole`: the force of that mode, if there is one."""
    force, active, *_ = samples[0]
    size = np.linalg.norm(force, axis=1)
    ms = np.median([sample.ms for sample in samples])
    start = min(sample.start for sample in samples)
    peak = max(sample.peak for sample in samples)
    row = f"{active.mean():.0f},{active.max()},{ms:.3f},{start:.3f},{peak:.0f},{size.max():.4f}"
    if whole is None:
        return row + ",,"
    error = np.linalg.norm(force - whole, axis=1)
    bound = np.maximum(0.02, 0.01 * np.linalg.norm(whole, axis=1))
    return row + f",{error.max():.5f},{(error / bound).max():.3f}"


def measure(argil, scene, cells_a_side, most_whole):
    """Yields number of tets, mode and columns. All sizes and modes by turns, for the machine's speed changes by the minute."""
    with tempfile.TemporaryDirectory() as top:
        folders = [Path(top) / str(cells) for cells in cells_a_side]
        sizes = []
        for folder, cells in zip(folders, cells_a_side):
            folder.mkdir()
            sizes.append(write_scene(folder, scene, cells))
        samples = {(tets, mode): [] for tets in sizes for mode in MODES if mode == "auto" or tets <= most_whole}
        for _ in range(REPEATS):
            for tets, mode in samples:
                samples[tets, mode].append(run(argil, folders[sizes.index(tets)], MODES[mode]))
        for tets, mode in samples:
            whole = samples.get((tets, "whole"))
            yield tets, mode, describe(samples[tets, mode], whole[0].force if whole else None)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", default=ROOT / "build", type=Path)
    parser.add_argument("--cells", nargs="+", type=int, default=[14, 46, 144])
    parser.add_argument("--most-whole", type=int, default=10**9, metavar="TETS")
    parser.add_argument("--scenes", nargs="+", choices=SCENES, default=list(SCENES))
    options = parser.parse_args()
    lines = [f"# {provenance.describe()}, one thread; ms a step in which the tool touches",
             "scene,tets,mode,nodes_mean,nodes_most,ms_a_step,start_s,peak_MiB,peak_N,error_N,error_over_bound"]
    for name in options.scenes:
        for tets, mode, columns in measure(options.build / "bin" / "argil", SCENES[name], options.cells, options.most_whole):
            lines.append(f"{name},{tets},{mode},{columns}")
            print(lines[-1], flush=True)
    (ROOT / "results" / "bench" / "extent.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
