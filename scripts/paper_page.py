#!/usr/bin/python3
"""Writes results/paper/README.md from what scripts/reproduce has made, each item beside the paper's.

Usage: paper_page.py [--check-limits]. What has not been made is named as missing. With --check-limits only looks whether
the figures that other scripts make are there.
"""
import argparse
import csv
import json
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PAPER = ROOT / "results/paper"
PAPER_RATES = {"dinosaur": (71.3, 792.6), "figure": (87.9, 863.7), "sphere": (85.9, 841.1), "cylinder": (85.9, 841.1)}
LIMITS = [  # what fails in the paper's form, figure, what is done instead
    ("Eq. 6 leaves the Voigt bound in shear at φ = 0.42 to 0.49, and undrained at ν = 0.3 its bulk modulus is negative past "
     "φ = 0.619",
     "../stability/dilute_pole.png", "Mori–Tanaka by default; every result says where its medium stands, and one that "
     "is not positive definite is refused before the run"),
    ("Eq. 9 once a step: the same clay answers otherwise at another step", "../stability/kernel_step.png",
     "the kernel to the power h/h_ref, the rate form"),
    ("Linear tets with undrained water lock", "../verification/locking.png",
     "drained by default; undrained clay needs `p1_nodal` or `p2`, or says that it locks"),
    ("Linear strain grows under rotation", "../stability/rotation.png", "corotational strain"),
    ("A contact force held between slow physics steps makes the hand chatter", "../contact/stability.png",
     "contact in the solve; re-evaluated contact, local compliance and a passivity controller as options"),
]


def picture(name, words):
    return f"![{words}]({name})\n" if (PAPER / name).resolve().is_file() else f"*Not made yet: {name}*\n"


def read_rows(name):
    if not (PAPER / name).is_file():
        return []
    with open(PAPER / name, encoding="utf-8") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def read_json(file):
    return json.loads(file.read_text(encoding="utf-8")) if file.is_file() else {}


def table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    return "\n" + "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows]) + "\n"


def push_pull():
    return ("The paper shows a figure before a push, pushed and pulled, with the region of influence coloured; neither mesh "
            "nor clay is given, so the course can be compared, not its size. Ours is 0.2 m tall, its back against a board.\n\n"
            + picture("push_pull_influence.png", "region of influence before, under a push, under a pull, after")
            + picture("push_pull.png", "displacement of the skin before, under a push, under a pull, after")
            + picture("push_pull_force.png", "force on the hand against time")
            + "\nA pull feeds itself, as the drawn clay follows the tool into contact: the penalty must be softer than the "
            "clay (15 N/m a pair here; at 100 N/m tets turn inside out, and the run says so and stops).\n")


def dry_wet():
    demo = read_json(ROOT / "results/demo/run.json")
    words = ("The paper draws the hand's force against time, dry and wet. Without its clay, mesh and motion the order can be "
             "compared, not the size: dry is above wet.\n\n" + picture("../demo/dinosaur.png", "dry and wet, before, during, after")
             + picture("../demo/force.png", "force dry and wet")
             + picture("../demo/force_split.png", "elasticity alone, yield alone"))
    if demo:
        runs = demo["runs"]
        dry = runs["dry"]
        rows = [[name.replace("_", " "), f"{run['peak_N']:.2f}", f"{run['impulse_N_s']:.2f}",
                 f"{100 * (run['peak_N'] / dry['peak_N'] - 1):+.0f} %",
                 f"{100 * (run['impulse_N_s'] / dry['impulse_N_s'] - 1):+.0f} %"] for name, run in runs.items()]
        words += "\n" + table(["run", "peak [N]", "impulse [N s]", "peak, to dry", "impulse, to dry"], rows)
    return (words + "\nLocking plays no part there, for the water is drained. Where it cannot leave (a block, 2.2 GPa), a linear tet "
            "and the locking-free `p1_nodal` still give nearly the same force under this light press; what locking does to an "
            "elastic body that is bent is under [7](#7-where-the-formulas-fail).\n\n"
            + picture("locking_force.png", "force of a locking and of a locking-free element on undrained clay"))


def sculpted():
    return ("The paper shows a tyrannosaur before and after sculpting; its session is not published. Ours is one motion of "
            "25 s, generated: wipe with water, press three times, pull, dry, press again. The pull "
            "meets nothing here, for the press before it took the clay from under it: one that reached 1.5 mm into clay "
            "so wet grew to 27 N.\n\n"
            + picture("sculpted.png", "before, wetting, drying, after")
            + picture("sculpted_skin.png", "the skin before and after, its displacement")
            + picture("sculpted_force.png", "force on the hand against time"))


def cages():
    rows = [[row["body"], row["tets"], row["skin_vertices"], f"{float(row['lowest_weight']):.1e}",
             f"{float(row['embedding_error_m']):.1e}", f"{1e3 * float(row['skin_difference_m']):.3f}",
             f"{1e3 * float(row['largest_displacement_m']):.2f}", f"{float(row['peak_N']):.2f}"] for row in read_rows("cages.csv")]
    head = ["body", "tets", "skin vertices", "lowest weight [–]", "embedding error [m]",
            "rms distance from the finest [mm]", "largest displacement [mm]", "peak force [N]"]
    return ("The paper shows both cages and gives no count of tets. The skin has the same vertices whatever the cage. Embedding "
            "error: distance of a skin vertex from Σ wᵢ xᵢ, the largest over all frames; a lowest weight of 0 or more means "
            "that every skin vertex lies in its tet.\n\n" + picture("cage_dinosaur.png", "cages of the dinosaur")
            + picture("cage_figure.png", "cages of the figure")
            + (table(head, rows) if rows else "*Not made yet: cages.csv*\n") + picture("cages.png", "against the cage's tets"))


def rates():
    rows = []
    for row in read_rows("rates.csv"):
        paper = PAPER_RATES[row["body"]]
        rows.append([row["body"], row["tets"], f"{paper[0]:g}", row["push_Hz"], row["pull_Hz"], f"{paper[1]:g}", row["wet_Hz"],
                     row["dry_Hz"]])
    head = ["body", "tets here", "paper push/pull [Hz]", "push", "pull", "paper wet/dry [Hz]", "wet", "dry"]
    first = (PAPER / "rates.csv").read_text(encoding="utf-8").splitlines()[0] if rows else ""
    return ("The paper: i7-4770K and a GTX Titan, sizes of the meshes not given; sphere and cylinder share its row. Here: "
            "one thread, no graphics card, everything in the tick (contact, water, solid, records): "
            + first.lstrip("# ") + ".\n\n" + (table(head, rows) if rows else "*Not made yet: rates.csv*\n"))


def measures():
    found = read_json(PAPER / "measures.json")
    words = ("The paper asked users four questions, which no program can ask again. What can be measured of each:\n\n")
    if not found:
        return words + "*Not made yet: measures.json*\n"
    work = ", ".join(f"{name} {1e3 * value:.2f} mJ" for name, value in found["work_of_hand_J"].items())
    ages = ", ".join(f"{name.replace('delay_', '')} {1e3 * value['mean_s']:.1f} ms (worst {1e3 * value['worst_s']:.0f} ms)"
                     for name, value in found["force_age"].items())
    near = "; ".join(f"{name}: {value:.2f}" for name, value in found["rms_log10_distance_from_measured_clay"].items())
    return (words + f"- **Is force worth having?** Work of the hand against it over the same presses: {work}; with the force "
            "off, 0 by definition.\n"
            f"- **Do force and picture come together?** Age of the felt force at physics of 71.4 Hz: {ages}. The picture is as "
            "old as the physics step, at most 14 ms.\n"
            f"- **Is it like clay?** Rms distance of log10 of the strength, over its value at the liquid limit, from measured "
            f"clays: {near}.\n- **Is it physical?** The [table of verification](../verification/README.md).\n\n"
            + picture("measures.png", "strength against water beside measured clays"))


def limits():
    rows = [[f"{what}" if (PAPER / figure).resolve().is_file() else f"{what} (figure not made)", f"[figure]({figure})", remedy]
            for what, figure, remedy in LIMITS]
    return table(["what fails or misleads", "where it is seen", "what is done here"], rows) + "\n" + "".join(
        picture(figure, what) for what, figure, _ in LIMITS)


ITEMS = [("Push and pull", push_pull), ("Dry and wet", dry_wet), ("Sculpted", sculpted), ("Cage and skin", cages),
         ("Rates", rates), ("The user study's measurable side", measures), ("Where the formulas fail", limits)]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--check-limits", action="store_true")
    if parser.parse_args().check_limits:
        missing = [figure for _, figure, _ in LIMITS if not (PAPER / figure).resolve().is_file()]
        sys.exit(f"missing: {', '.join(missing)}" if missing else 0)
    page = ("# The paper beside argil\n\n`scripts/reproduce` makes this page and all that is on it from a clean clone; "
            "`scripts/reproduce ITEM` one item. The paper: [arXiv 2112.04362](https://arxiv.org/abs/2112.04362). Its meshes, "
            "clays and motions are not published, so pictures and courses are compared, not numbers, except the rates.\n")
    for number, (title, write) in enumerate(ITEMS, start=1):
        page += f"\n## {number}. {title}\n\n{write()}"
    PAPER.mkdir(parents=True, exist_ok=True)
    (PAPER / "README.md").write_text(page, encoding="utf-8")
    print("results/paper/README.md")


if __name__ == "__main__":
    main()
