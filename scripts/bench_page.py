#!/usr/bin/python3
"""Writes the tables of results/bench/README.md and parts.md from the CSV files beside them, each below the line of its columns.

    scripts/bench_page.py [--check]

With --check nothing is written; exit code 1 when a table is not that of its file.
"""
import argparse
import csv
import re
import sys
from pathlib import Path

BENCH = Path(__file__).resolve().parent.parent / "results/bench"


def read(name):
    with open(BENCH / f"{name}.csv", encoding="utf-8", newline="") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def three(value):
    """Three digits, and no power of ten below a million."""
    return f"{float(value):.0f}" if float(value) >= 100 else f"{float(value):#.3g}".rstrip(".")


def ms(value):
    """Of microseconds."""
    return three(float(value) / 1000)


def list_costs():
    """A row a setting, with its one and two threads side by side; the reference of a scene first."""
    runs = {}
    for row in read("cost"):
        runs.setdefault((row["scene"], row["element"], row["wanted_tets"], row["ticks_of_step"], row["fidelity"]), []).append(row)
    elements = {"p1": "four-node", "p2": "ten-node"}
    for (scene, element, _, ticks, fidelity), rows in runs.items():
        one, *two = rows
        if fidelity == "reference":
            yield [scene, f"*reference: {one['wanted_tets']} {elements[element]}, 0.5 ms*",
                   *(f"*{value} %*" for value in errors(one)), "", ""]
            continue
        words = [f"{one['tets']} {elements[element]}", *([f"{ticks} ms"] if ticks != "1" else []), *(["`auto`"] if fidelity == "auto" else [])]
        yield [scene, ", ".join(words), *(f"{value} %" for value in errors(one)),
               *(f"{row['touching_ticks_per_s']}; {three(row['step_ms'])} / {three(row['step_p99_ms'])}" for row in (one, *two))]


def errors(row):
    return three(row["error_percent"]), f"{float(row['error_at_peak_percent']):+.1f}".replace("-", "−")


def list_steps():
    stages = "contact", "water", "assemble", "solve", "kinematics", "plasticity"
    for row in read("step"):
        mode, _, threads = row["name"].split("/")[:3]
        yield [mode, row["tets"], threads.split(":")[1], *(f"{float(row[k]) / 1000:.3f}" if row[k] else "–" for k in stages),
               ms(row["step"]), ms(row["step_p99"]), three(row["cg_iterations"]) if float(row["cg_iterations"]) else "0",
               f"{float(row['steps_per_s']):.0f}", f"{float(row['real_time']) / float(row['cpu_time']):.2f}"]


def list_sizes():
    rows = {tuple(row["name"].split("/")[:4]): row for row in read("sizes")}
    for body, fidelity, size, threads in rows:
        if (fidelity, threads) != ("full", "threads:1"):
            continue
        runs = [rows[body, f, size, f"threads:{t}"] for f in ("full", "auto") for t in (1, 2)]
        full, auto = float(runs[0]["force_N"]), float(runs[2]["force_N"])
        yield [body, runs[0]["tets"], *(f"{ms(run['step'])} / {ms(run['step_p99'])}" for run in runs),
               f"{100 * abs(auto / full - 1):.2f} %", f"{abs(auto - full) / max(0.02, 0.01 * full):.2f}"]


def list_tolerances():
    rows = read("tolerance")
    for tets, kernel in dict.fromkeys((row["tets"], row["clay_kernel"]) for row in rows):
        of_scene = [row for row in rows if (row["tets"], row["clay_kernel"]) == (tets, kernel)]
        yield [tets, "off" if kernel == "off" else "on",
               *(f"{100 * float(row['largest_error_over_peak']):.2g}, {row['cg_iterations_mean']}" for row in of_scene)]


DESIGNS = {"block Jacobi, double": ("block_jacobi", 1), "incomplete Cholesky, double": ("block_ic0", 1),
           "block Jacobi, floats": ("block_jacobi_floats", 1), "the same, 2 threads": ("block_jacobi_floats", 2),
           "Eisenstat, whole": ("eisenstat_floats_whole", 1), "Eisenstat, 8 groups": ("eisenstat_floats_8_groups", 1),
           "Eisenstat, 2 separated": ("eisenstat_floats_2_separated", 1),
           "the same, on 2 threads": ("eisenstat_floats_2_separated", 2)}


def list_designs():
    rows = read("preconditioners")
    for name, (design, threads) in DESIGNS.items():
        yield [name, *(f"{row['iterations_1e-3']}, {three(row['ms_1e-3'])}" for row in rows
                       if (row["design"], row["threads"]) == (design, str(threads)))]


def list_extents():
    for row in read("extent"):
        yield [row["scene"], row["tets"], row["mode"], row["nodes_mean"], f"{float(row['ms_a_step']):.2f}",
               row["error_over_bound"] or "–", row["start_s"] or "–", row["peak_MiB"] or "–"]


def list_instructions():
    for row in read("instructions"):
        yield [row["tets"], *(three(float(row[stage]) / 1e6)
                              for stage in ("contact", "assemble", "solve", "kinematics", "plasticity", "step"))]


def list_wet_ticks():
    rows = read("water")
    water = [row for row in rows if re.match(r"touch/edge:\d+/implicit:0/real_time", row["name"])]
    ticks = [row for row in rows if row["name"].startswith("tick/")]
    for touch, tick in zip(water, ticks, strict=True):
        yield [touch["tets"], f"{float(touch['real_time']):.1f}", touch["active"], three(tick["real_time"]), tick["active"],
               tick["contacts"], f"{float(tick['steps_per_s']):.0f}"]


def list_contacts():
    for row in read("contact"):
        kind = row["name"].removeprefix("find_contacts/").split("/")[0]
        yield [kind.replace("_", " "), row["triangles"], row["contacts"], three(row["cpu_time"])]


PAGES = {
    "README.md": {"| scene | cells, step |": list_costs},
    "parts.md": {
        "| mode | tets | threads | contact |": list_steps,
        "| tets | clay kernel |": list_tolerances,
        "| design |": list_designs,
        "| body | tets | full, 1 thread |": list_sizes,
        "| scene | tets | mode |": list_extents,
        "| tets | contact | assemble |": list_instructions,
        "| tets | water [µs] |": list_wet_ticks,
        "| tool | triangles |": list_contacts,
    },
}


def write_tables(page, tables):
    lines = page.split("\n")
    for header, rows in tables.items():
        first = next(i for i, line in enumerate(lines) if line.startswith(header)) + 2
        end = next(i for i in range(first, len(lines) + 1) if i == len(lines) or not lines[i].startswith("|"))
        table = [f"| {' | '.join(row)} |" for row in rows()]
        columns = lines[first - 2].count("|")
        assert all(row.count("|") == columns for row in table), f"{header}: not as many columns as the page has"
        lines[first:end] = table
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true")
    options = parser.parse_args()
    for name, tables in PAGES.items():
        page = (BENCH / name).read_text(encoding="utf-8")
        written = write_tables(page, tables)
        if not options.check:
            (BENCH / name).write_text(written, encoding="utf-8")
        elif written != page:
            sys.exit(f"{BENCH / name}: its tables are not those of the files beside it: run scripts/bench_page.py")


if __name__ == "__main__":
    main()
