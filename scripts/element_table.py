#!/usr/bin/python3
"""What a step costs on ten-node tets, beside four-node tets with as many nodes: the press of scenarios/study_light_press.json with the
pressure law, solved as by default. Of each pair of runs, repeated in turn, the one of the least time counts.

Usage: element_table.py ARGIL [-o FILE.csv] [--repeats N]      writes results/bench/elements.csv
"""
import argparse
import subprocess
import tempfile
from pathlib import Path

import h5py

from table_file import write_table

ROOT = Path(__file__).resolve().parent.parent
MODELS = {"corotational": [], "hencky": ["/dynamics/model=hencky", "/material/plasticity/max=0"]}
TETS = {"p1": (8200, 33000), "p2": (1000, 4200)}  # of about as many nodes
STAGES = ("contact", "assemble", "solve", "kinematics", "plasticity")


def run(argil, folder, element, tets, threads, settings):
    """Nodes, and milliseconds of a step by stage."""
    result = folder / "run.h5"
    words = ["/contact/law=pressure", f"/dynamics/element={element}", f"/body/shape/target_tets={tets}", *settings]
    subprocess.run([argil, "run", ROOT / "scenarios/study_light_press.json", "-q", "-o", result, "--threads", str(threads),
                    *[word for setting in words for word in ("--set", setting)]], check=True)
    with h5py.File(result) as file:
        steps = len(file["physics/iterations"])
        cost = [1e3 * file[f"timing/{stage}"][-1] / steps for stage in STAGES]
        return int(file["physics/active_nodes"][:].max()), cost


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", maxsplit=1)[0])
    parser.add_argument("argil", type=Path)
    parser.add_argument("-o", "--output", type=Path, default=ROOT / "results/bench/elements.csv", metavar="FILE")
    parser.add_argument("--repeats", type=int, default=3)
    options = parser.parse_args()
    argil = options.argil.resolve()
    rows = []
    with tempfile.TemporaryDirectory() as name:
        for model, settings in MODELS.items():
            for size in (0, 1):
                for threads in (1, 2):
                    best = {}
                    for _ in range(options.repeats):
                        for element, tets in TETS.items():
                            nodes, cost = run(argil, Path(name), element, tets[size], threads, settings)
                            if element not in best or sum(cost) < sum(best[element][1]):
                                best[element] = (nodes, cost)
                    ratio = sum(best["p2"][1]) / sum(best["p1"][1])
                    for element, (nodes, cost) in best.items():
                        rows.append([model, element, TETS[element][size], nodes, threads, *(f"{c:.3f}" for c in cost), f"{sum(cost):.3f}",
                                     f"{ratio:.2f}" if element == "p2" else "1"])
                        print(*rows[-1], flush=True)
    stages = [f"{stage}_ms" for stage in STAGES]
    write_table(options.output, ["model", "element", "tets", "nodes", "threads", *stages, "step_ms", "over_p1"], rows)


if __name__ == "__main__":
    main()
