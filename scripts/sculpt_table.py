#!/usr/bin/python3
"""Clay that is sculpted far: six motions that take a body of clay far from the shape that it began with.

Usage: sculpt_table.py ARGIL [-o TABLE.csv] [--scenes NAME ...] [--tets N] [--element p1|p2] [--share S] [--keep FOLDER]

`presses`: a ball is pressed by 30 % of a block's height into about one place, twenty times. `knead`: a ball presses and slides over a
wet lump for a minute, at random. `horn`: a horn of 20 mm is pulled from a lump, and let go. `tear`: it is pulled until it tears. `bend`: the end of a bar is led half
round and back. `flatten`: a lump is pressed to a third of its height.
Columns: element; exit code; share of the motion that was made; times that the body got new cells; least volume ratio; worst mean ratio of a tet in a
frame; volume at the end, with the tool away, off that at the start [%]; water that the books miss [%]; largest force [N]; largest change of the force in the
step after new cells, less that of the step before [N] and over the largest force [%]; triangles that the tool
meets over faces of cells, at the end; seconds of the processor a second of motion; force against that of twice as many cells, root mean square
over the largest [%]; equal bits with two threads, and after a stop and a return ("-": not looked at).
"""
import argparse
import json
import os
import signal
import subprocess
import tempfile
from pathlib import Path

import h5py
import numpy as np

from table_file import write_table

TICK = 1e-3  # [s]
COLUMNS = ("scene", "element", "tets", "exit_code", "made_percent", "new_cells", "least_volume_ratio", "worst_mean_ratio", "volume_percent",
           "water_percent", "peak_N", "jump_N", "jump_percent", "touched_per_face", "cpu_s_per_s", "finer_percent", "two_threads",
           "resumed")
CLAY = {"youngs_modulus_Pa": 1.2e6, "poissons_ratio": 0.3, "plasticity": {"strength_Pa": 15e3}}


def follow(places, speed, start=0.0):
    """Samples of straight ways between places at that speed, which may be given for each way."""
    places = np.asarray(places, dtype=float)
    length = np.linalg.norm(np.diff(places[:, :3], axis=0), axis=1)
    times = start + np.r_[0, np.cumsum(np.maximum(length / speed, 2 * TICK))]
    t = np.arange(0, times[-1], TICK)
    return t, np.stack([np.interp(t, times, places[:, k]) for k in range(places.shape[1])], axis=1)


def write_motion(file, t, places, modes=None, turns=None):
    """`turns`: angles about y [rad]."""
    names = ["t", "x", "y", "z"]
    columns = [np.char.mod("%.4f", t)] + [np.char.mod("%.7f", places[:, k]) for k in range(3)]
    if turns is not None:
        names += ["qx", "qy", "qz", "qw"]
        columns += [np.char.mod("%.9f", q) for q in (0 * turns, np.sin(turns / 2), 0 * turns, np.cos(turns / 2))]
    if modes is not None:
        names.append("mode")
        columns.append(np.asarray(modes))
    file.write_text("\n".join([",".join(names)] + [",".join(row) for row in zip(*columns)]) + "\n", encoding="ascii")


def presses(share):
    edge, radius = 0.03, 0.006
    random = np.random.default_rng(1)
    places = [(0, 0, edge + radius + 0.001)]
    for _ in range(max(2, round(20 * share))):
        x, y = random.uniform(-0.0015, 0.0015, 2)
        places += [(x, y, edge + radius + 0.001), (x, y, 0.7 * edge + radius), (x, y, edge + radius + 0.001)]
    t, places = follow(places, 0.03)
    body = {"shape": {"kind": "box", "size_m": edge, "skin_triangles": 0}, "fixed": [{"kind": "plane", "normal": [0, 0, 1], "offset_m": 0}]}
    return {"body": body, "tool": {"shape": {"kind": "sphere", "radius_m": radius}}}, (t, places)


def find_low(body, radius):
    """Lumps stand on the ground plane's place of the shape's lowest point."""
    return radius if body == "sphere" else 0.0


def knead(share):
    size, radius = 0.05, 0.008
    random = np.random.default_rng(2)
    places = [(0, 0, size + 2 * radius)]
    seconds = 60 * share
    ways = []
    middle = np.array([0, 0, size / 2])
    while sum(ways) < seconds:
        def direction():
            up, round_ = random.uniform(0.2, 1.0), random.uniform(0, 2 * np.pi)
            flat = np.sqrt(1 - up * up)
            return np.array([flat * np.cos(round_), flat * np.sin(round_), up])
        first = direction()
        second = first + 0.5 * direction()
        second /= np.linalg.norm(second)
        away, deep = size / 2 + radius + 0.005, size / 2 + radius - random.uniform(0.005, 0.010)
        for place in (middle + away * first, middle + deep * first, middle + deep * second, middle + away * second,
                      middle + (away + 0.015) * np.array([0, 0, 1])):
            ways.append(max(np.linalg.norm(place - places[-1]) / 0.04, 2 * TICK))
            places.append(tuple(place))
    t, places = follow(places, 0.04)
    body = {"shape": {"kind": "sphere", "size_m": size, "skin_triangles": 0}, "initial_saturation": 0.3,
            "fixed": [{"kind": "half_space", "normal": [0, 0, 1], "offset_m": 0.2 * size}]}
    return {"body": body, "tool": {"shape": {"kind": "sphere", "radius_m": radius}}}, (t, places)


def pull(way, returns):
    """Draws the top of a lump up by `way` [m]; then the hand opens and goes on."""
    size, radius = 0.06, 0.006
    top = size + radius
    places = [(0, 0, top + 0.001), (0, 0, top - 0.004), (0, 0, top - 0.004 + way)]
    if returns:
        places.append((0, 0, top - 0.004 + way + 0.01))
    t, places = follow(places, 0.02)
    modes = np.where((t > 0.005 / 0.02) & (t < (0.005 + way) / 0.02), "pull", "push")
    body = {"shape": {"kind": "sphere", "size_m": size, "skin_triangles": 0},
            "fixed": [{"kind": "half_space", "normal": [0, 0, 1], "offset_m": 0.2 * size}]}
    return {"body": body, "tool": {"shape": {"kind": "sphere", "radius_m": radius}}}, (t, places, modes)


def horn(share):
    return pull(share * 0.024, True)


def tear(share):
    return pull(share * 0.1, False)


def bend(share):
    length, radius = 0.06, 0.006
    top = length + radius
    t, places = follow([(0, 0, top + 0.001), (0, 0, top - 0.002)], 0.02)
    turn = share * np.pi * np.r_[np.linspace(0, 1, 6000), np.linspace(1, 0, 6000)][1:]
    half = length / np.maximum(turn, 1e-9)
    end = np.c_[half * (1 - np.cos(turn)), 0 * turn, half * np.sin(turn)]
    off = (radius - 0.002) * np.c_[np.sin(turn), 0 * turn, np.cos(turn)]
    modes = ["push"] * len(t) + ["pull"] * len(turn)
    turns = np.r_[0 * t, turn]
    places = np.r_[places, end + off]
    t = TICK * np.arange(len(places))
    body = {"shape": {"kind": "box", "size_m": length, "slenderness": 5, "skin_triangles": 0},
            "fixed": [{"kind": "plane", "normal": [0, 0, 1], "offset_m": 0}]}
    return {"body": body, "tool": {"shape": {"kind": "sphere", "radius_m": radius}}}, (t, places, modes, turns)


def flatten(share):
    size, radius = 0.04, 0.08
    top = size + radius
    t, places = follow([(0, 0, top + 0.0005), (0, 0, top - share * 2 / 3 * size), (0, 0, top)], 0.02)
    body = {"shape": {"kind": "sphere", "size_m": size, "skin_triangles": 0},
            "fixed": [{"kind": "half_space", "normal": [0, 0, 1], "offset_m": 0.15 * size}]}
    return {"body": body, "tool": {"shape": {"kind": "sphere", "radius_m": radius}}}, (t, places)


SCENES = {scene.__name__: scene for scene in (presses, knead, horn, tear, bend, flatten)}


def write_scene(folder, name, options):
    scene, motion = SCENES[name](options.share)
    scene["body"]["shape"]["target_tets"] = options.tets
    scene["dynamics"] = {"element": options.element}
    write_motion(folder / f"{name}.csv", *motion)
    scene |= {"about": SCENES[name].__name__, "material": CLAY, "trace": {"file": f"{name}.csv"},
              "haptics": {"frame_period_ticks": 100, "physics_period_ticks": 2, "device": {"max_force_N": 1e3}}}
    (folder / f"{name}.json").write_text(json.dumps(scene), encoding="ascii")
    return folder / f"{name}.json", len(motion[0]) - 1


def run(argil, scene, result, *words):
    with result.with_suffix(".log").open("w", encoding="utf8") as log:
        return subprocess.run([argil, "run", scene, "-o", result, *words], stderr=log, stdout=log).returncode


def run_with_a_stop(argil, scene, result, num_ticks):
    """Stops after new cells in the run's second half, where there are some, and goes on."""
    with subprocess.Popen([argil, "run", scene, "-o", result], stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True) as program:
        for line in program.stderr:
            if "new cells" in line and int(line.split("tick ")[1].split(":")[0]) > num_ticks / 2:
                program.send_signal(signal.SIGINT)
                break
        program.stderr.read()
    return run(argil, scene, result, "--resume") if program.returncode == 130 else program.returncode


def cells_of(result, frame):
    epoch = frame.attrs.get("epoch", 0)
    return (result["mesh"] if epoch == 0 else result[f"epochs/{epoch:06d}/mesh"])["tets"][:]


def measure_tets(x, tets):
    """Volumes and mean ratios."""
    a, b, c, d = (x[tets[:, k]] for k in range(4))
    volume = np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a) / 6
    edges = sum(np.sum((p - q) ** 2, axis=1) for p, q in ((a, b), (a, c), (a, d), (b, c), (b, d), (c, d)))
    return volume, 12 * np.cbrt(3 * np.abs(volume)) ** 2 / edges * np.sign(volume)


def find_jump(force, epochs, step):
    """Largest change of the force vector in the step after new cells, less that of the step before [N]."""
    jumps = [np.linalg.norm(force[k - 1 + step] - 2 * force[k - 1] + force[k - 1 - step]) for k in epochs
             if step < k < len(force) - step]
    return max(jumps, default=0.0)


def measure(result, num_ticks):
    with h5py.File(result) as run_:
        force = run_["haptic/force"][:]
        epochs = [int(epoch.attrs["tick"]) for epoch in run_.get("epochs", {}).values()]
        volumes, ratios = zip(*((volume.sum(), ratio.min()) for volume, ratio in (
            measure_tets(frame["position"][:], cells_of(run_, frame)) for frame in run_["frames"].values())))
        water, added, removed = (run_[f"physics/water_{name}"][:] for name in ("mass", "added", "removed"))
        missed = np.abs(water - water[0] - added + removed).max() / water[0] if water[0] > 0 else 0.0
        peak = np.linalg.norm(force, axis=1).max()
        jump = find_jump(force, epochs, 2)
        made = len(force) / num_ticks
        seconds = len(force) * TICK
        last = run_[f"epochs/{len(epochs):06d}/mesh"] if epochs else None
        touched = len(last["touched_triangles"]) / len(last["surface_triangles"]) if last else 1.0
        return {"tets": len(run_["mesh/tets"]), "made_percent": 100 * made, "new_cells": len(epochs),
                "least_volume_ratio": run_["physics/min_volume_ratio"][:].min(), "worst_mean_ratio": min(ratios),
                "volume_percent": 100 * abs(volumes[-1] / volumes[0] - 1), "water_percent": 100 * missed, "peak_N": peak,
                "jump_N": jump, "jump_percent": 100 * jump / peak, "touched_per_face": touched, "cpu_s_per_s": run_["timing/cpu"][-1] / seconds}, force


def is_equal(argil, first, second):
    return "yes" if subprocess.run([argil, "compare", first, second], stdout=subprocess.DEVNULL).returncode == 0 else "no"


def make_row(argil, folder, name, options):
    scene, num_ticks = write_scene(folder, name, options)
    result, finer, other = (folder / f"{name}{word}.h5" for word in ("", "_finer", "_other"))
    code = run(argil, scene, result)
    row, force = measure(result, num_ticks)
    row |= {"scene": name, "element": options.element, "exit_code": code, "finer_percent": "-", "two_threads": "-", "resumed": "-"}
    if options.finer:
        run(argil, scene, finer, "--set", f"/body/shape/target_tets={2 * options.tets}")
        there, of_finer = measure(finer, num_ticks)
        both = min(len(force), len(of_finer))
        off = np.linalg.norm(force[:both] - of_finer[:both], axis=1)
        row["finer_percent"] = 100 * np.sqrt((off**2).mean()) / there["peak_N"]
    if options.bits:
        other.unlink(missing_ok=True)
        run(argil, scene, other, "--threads", "2")
        row["two_threads"] = is_equal(argil, result, other)
        other.unlink()
        run_with_a_stop(argil, scene, other, num_ticks)
        row["resumed"] = is_equal(argil, result, other)
    return [f"{row[name]:.3g}" if isinstance(row[name], float) else row[name] for name in COLUMNS]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("argil", type=Path)
    parser.add_argument("-o", "--output", type=Path, default=Path("results/clay/sculpt.csv"))
    parser.add_argument("--scenes", nargs="+", choices=SCENES, default=list(SCENES))
    parser.add_argument("--tets", type=int, default=4000)
    parser.add_argument("--element", choices=("p1", "p2"), default="p1")
    parser.add_argument("--share", type=float, default=1.0, help="of the motion: of the presses, the time or the way")
    parser.add_argument("--finer", action=argparse.BooleanOptionalAction, default=True, help="a run of twice as many cells, too")
    parser.add_argument("--bits", action=argparse.BooleanOptionalAction, default=True, help="the same on two threads and after a stop")
    parser.add_argument("--keep", type=Path, help="folder for scenes and results")
    options = parser.parse_args()
    rows = []
    with tempfile.TemporaryDirectory() as temporary:
        folder = options.keep or Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        for name in options.scenes:
            rows.append(make_row(options.argil.resolve(), folder, name, options))
            print(*rows[-1], sep="  ", flush=True)
    write_table(options.output, COLUMNS, rows)


if __name__ == "__main__":
    main()
