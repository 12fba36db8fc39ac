#!/usr/bin/python3
"""Instructions of one step of the press, by callgrind, which the load of the machine does not touch.

Usage: bench_instructions.py [TETS …]      writes a table (CSV) to standard output; default 2390 10000

One thread; the mean over the benchmark's steps, in all and by stage. The processor that valgrind shows to the program
has lanes of four numbers at most, so that one with eight needs fewer.
"""
import csv
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

PROGRAM = Path(__file__).resolve().parent.parent / "build/bin/bench_step"
STEPS = 200  # as many as the benchmark measures
STAGES = {
    "contact": "argil::sim::HandSide::find_contact_force",
    "assemble": "argil::sim::BodySide::assemble(",
    "solve": "argil::sim::BodySide::solve(",
    "kinematics": "argil::sim::BodySide::update_kinematics",
    "plasticity": "argil::sim::BodySide::flow(",
}


def count(tets, folder):
    """{stage: instructions a step}, `step` among them."""
    profile = Path(folder) / f"callgrind.{tets}"
    subprocess.run(["valgrind", "-q", "--tool=callgrind", f"--callgrind-out-file={profile}", "--collect-atstart=no",
                    "--toggle-collect=*run_measured_step*", PROGRAM, f"--benchmark_filter=push/tets:{tets}/threads:1/"],
                   check=True, stdout=sys.stderr)
    report = subprocess.run(["callgrind_annotate", "--inclusive=yes", "--threshold=99.99", profile],
                            check=True, capture_output=True, text=True).stdout
    rows = re.findall(r"^ *([\d,]+) \([^)]*\)  (.*)$", report, re.MULTILINE)

    def of(name):
        return max((int(number.replace(",", "")) for number, text in rows if name in text), default=0) / STEPS

    return {stage: of(name) for stage, name in STAGES.items()} | {"step": of("run_measured_step")}


def main():
    if shutil.which("valgrind") is None or not PROGRAM.exists():
        sys.exit(f"{sys.argv[0]}: needs Debian's valgrind and {PROGRAM}, which scripts/build bench_step makes")
    sizes = sys.argv[1:] or ["2390", "10000"]
    table = csv.DictWriter(sys.stdout, ["tets", *STAGES, "step"], lineterminator="\n")
    table.writeheader()
    with tempfile.TemporaryDirectory() as folder:
        for tets in sizes:
            table.writerow({"tets": tets} | {key: f"{n:.0f}" for key, n in count(tets, folder).items()})


if __name__ == "__main__":
    main()
