#!/usr/bin/python3
"""What a step costs and how far off its force is: scenarios of this project as a user runs them, on one and on two threads, beside a
reference of ten-node tets and steps of 0.5 ms.

Usage: cost_table.py [-o FILE.csv] [--scenes NAME ...] [--repeats N]      writes results/bench/cost.csv

Runs go tick by tick through the package `argil` of build/python. Times are of the ticks in which the tool touches: of the repeats, which
alternate with the other settings, the least median and the least 99th percentile. `error_percent` is the root mean square of the error of
the force at the hand over that of the force, while either touches; `error_at_peak_percent` is that of the largest force. A scene's first
row, of fidelity `reference`, has the distance of the reference from a run of half as many cells in steps of a tick. References stay in
build/cost/, under the hash of their resolved scenario and of the program that made them.
"""
import argparse
import hashlib
import sys
import time
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "build/python"))
import argil  # noqa: E402  pylint: disable=wrong-import-position

from provenance import describe  # noqa: E402  pylint: disable=wrong-import-position
from table_file import write_table  # noqa: E402  pylint: disable=wrong-import-position

COLUMNS = ("scene", "element", "wanted_tets", "tets", "ticks_of_step", "fidelity", "threads", "touching_ticks_per_s", "step_ms", "step_p99_ms",
           "error_percent", "error_at_peak_percent")
TOUCH = 0.01  # [N] the tool touches from here on


PRESSURE = {"/contact/law": "pressure", "/body/cells/kind": "graded"}
SMALL_STRAIN = {"/dynamics/model": "corotational", "/material/plasticity": {"yield": 0.02, "creep_per_s": 20, "max": 0.5}}
PAIRS = {"/contact/law": "pairs", "/contact/vertex_face_stiffness_N_per_m": 100, "/contact/edge_edge_stiffness_N_per_m": 100,
         "/body/cells/kind": "even"}
FIRST_PRESS = {"/trace/duration_s": 0.9}
SCENES = {  # scenario; what all of its runs set; what they set besides the reference; tets of the reference; element, tets, ticks, fidelity
    "light press": ("study_light_press", PRESSURE, {}, 4000,
                    [("p1", 2500, 1, "full"), ("p1", 10000, 1, "full"), ("p2", 600, 1, "full"), ("p2", 1200, 1, "full"), ("p2", 1200, 2, "full")]),
    "soft clay": ("study_soft_dino", FIRST_PRESS, {}, 16000,
                  [("p1", 2500, 1, "full"), ("p1", 10000, 1, "full"), ("p1", 10000, 1, "auto"), ("p1", 10000, 2, "full"), ("p1", 40000, 1, "full"),
                   ("p2", 2500, 1, "full"), ("p2", 5000, 1, "full")]),
    "soft clay, by small strain and pairs": ("study_soft_dino", {**FIRST_PRESS, **SMALL_STRAIN}, PAIRS, 16000,
                                             [("p1", 2500, 1, "full"), ("p1", 10000, 1, "full"), ("p1", 42000, 1, "full")]),
    "potter's clay": ("demo_dino_dry", {"/trace/duration_s": 1.2}, {}, 16000,
                      [("p1", 5000, 1, "full"), ("p1", 15000, 1, "full"), ("p1", 15000, 2, "full"), ("p2", 5000, 1, "full")]),
    "slide with friction": ("study_slide", PRESSURE, {}, 1200,
                            [("p1", 2500, 1, "full"), ("p1", 10000, 1, "full"), ("p2", 600, 1, "full")]),
}


def load(scenario, settings):
    return argil.load(ROOT / "scenarios" / f"{scenario}.json", set=settings)


def run(scene, threads):
    """Times of the ticks [s], forces [N] and the number of tets."""
    with scene.start(threads=threads) as simulation:
        count = simulation.num_ticks
        times, forces = np.empty(count), np.empty((count, 3))
        for tick in range(count):
            start = time.perf_counter()
            force = simulation.tick()
            times[tick] = time.perf_counter() - start
            forces[tick] = force
        return times, forces, len(simulation.tets)


def find_reference(scenario, settings, tets, half):
    """Forces at the ticks of a millisecond; `half`: with half as many cells, a step a tick."""
    fine = {**settings, "/dynamics/element": "p2", "/body/shape/target_tets": tets // 2 if half else tets, "/haptics/physics_period_ticks": 1}
    if not half:
        fine |= {"/haptics/period_s": 0.0005, "/haptics/water_period_ticks": 20, "/haptics/frame_period_ticks": 200}
    scene = load(scenario, fine)
    key = hashlib.sha256((str(scene.resolved) + str(argil.build())).encode()).hexdigest()[:16]
    file = ROOT / "build/cost" / f"{scenario}_{key}.npy"
    if not file.is_file():
        print(f"{scenario}: {'its refinement' if half else 'reference'} …", flush=True)
        forces = run(scene, 2)[1]
        file.parent.mkdir(exist_ok=True)
        np.save(file, forces if half else forces[1::2])
    return np.load(file)


def compare(forces, reference):
    """Error [%] over the force, and at its largest."""
    sizes = np.linalg.norm(forces, axis=1), np.linalg.norm(reference, axis=1)
    touches = np.maximum(*sizes) > TOUCH
    rms = np.sqrt(np.mean((forces - reference)[touches] ** 2) / np.mean(reference[touches] ** 2))
    return f"{100 * rms:.2f}", f"{100 * (sizes[0].max() / sizes[1].max() - 1):+.2f}"


def measure(name, repeats):
    scenario, settings, besides, tets, runs = SCENES[name]
    reference = find_reference(scenario, settings, tets, half=False)
    doubt = compare(find_reference(scenario, settings, tets, half=True), reference)
    rows = [[name, "p2", tets, "", 0.5, "reference", "", "", "", "", *doubt]]
    touches = np.linalg.norm(reference, axis=1) > TOUCH
    found = {}
    for repeat in range(repeats):
        for kind in [(*of, threads) for of in runs for threads in (1, 2)]:
            element, wanted, ticks, fidelity, threads = kind
            scene = load(scenario, {**settings, **besides, "/dynamics/element": element, "/body/shape/target_tets": wanted,
                                    "/haptics/physics_period_ticks": ticks, "/fidelity/mode": fidelity})
            times, forces, num_tets = run(scene, threads)
            touching = times[touches]
            steps = 1e3 * np.sort(touching)[len(touching) - len(touching) // ticks:]  # the ticks with a step are the longest
            costs = len(touching) / touching.sum(), np.median(steps), np.percentile(steps, 99)
            best = found.get(kind, (num_tets, forces, 0.0, np.inf, np.inf))
            found[kind] = (num_tets, forces, max(best[2], costs[0]), *np.minimum(best[3:], costs[1:]))
        print(f"{name}: {repeat + 1} of {repeats}", flush=True)
    for (element, wanted, ticks, fidelity, threads), (num_tets, forces, rate, median, high) in found.items():
        rows.append([name, element, wanted, num_tets, ticks, fidelity, threads, f"{rate:.0f}", f"{median:.3f}", f"{high:.3f}",
                     *compare(forces, reference)])
    return rows


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", "--output", type=Path, default=ROOT / "results/bench/cost.csv", metavar="FILE")
    parser.add_argument("--scenes", nargs="+", default=list(SCENES), choices=list(SCENES), metavar="NAME")
    parser.add_argument("--repeats", type=int, default=3)
    options = parser.parse_args()
    machine = describe()
    rows = [row for name in options.scenes for row in measure(name, options.repeats)]
    for row in rows:
        print(*row)
    write_table(options.output, COLUMNS, rows)
    options.output.write_text(f"# {machine}\n{options.output.read_text(encoding='utf-8')}", encoding="utf-8")


if __name__ == "__main__":
    main()
