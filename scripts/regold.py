#!/usr/bin/python3
"""Golden results: one small run for each mode, model, element, integrator and method between frames (tests/golden/).

Usage: regold.py ARGIL --check [--threads 1 2]
                                        compares runs with the golden files; exit code 1 when one is different
       regold.py ARGIL [NAME …]         rewrites golden files, all or those named: only when results are meant to change

Runs of one program must have the same bits for any number of threads. Bits must equal the golden ones when compiler, flags, libraries and processor family are those that the golden file names in its
/provenance/build and /provenance/machine; elsewhere numbers must agree within tests/golden/near.json.
"""
import argparse
import json
import platform
import subprocess
import sys
import tempfile
from pathlib import Path

import h5py

GOLDEN = Path(__file__).resolve().parent.parent / "tests" / "golden"


def run(argil, name, settings, output, threads=1):
    sets = [word for setting in settings for word in ("--set", setting)]
    done = subprocess.run([argil, "run", GOLDEN / "ball.json", "-q", "-o", output, "--threads", str(threads), *sets],
                          capture_output=True, text=True)
    if done.returncode != 0:
        raise SystemExit(f"{name}: argil run ended with {done.returncode}: {done.stderr}")


def copy_small(source, target, machine):
    """The same objects, compressed; what may differ between equal runs is left out."""
    def copy(name, item):
        if name.split("/")[0] == "timing":
            return
        if isinstance(item, h5py.Group):
            made = target.create_group(name)
        elif item.shape:
            made = target.create_dataset(name, data=item[()], dtype=item.dtype, compression="gzip" if item.size > 50 else None,
                                         compression_opts=9 if item.size > 50 else None, shuffle=item.size > 50)
        else:
            made = source.copy(item, target, name)
            made = target[name]
        for key in item.attrs:
            if key not in made.attrs:
                made.attrs.create(key, item.attrs[key])

    for key, value in source.attrs.items():
        target.attrs.create(key, value)
    source.visititems(copy)
    target.require_group("timing")
    target["provenance/machine"] = machine


def regold(argil, name, settings):
    with tempfile.TemporaryDirectory() as folder:
        output = Path(folder) / "run.h5"
        run(argil, name, settings, output)
        with h5py.File(output) as source, h5py.File(GOLDEN / f"{name}.h5", "w", libver="latest") as target:
            copy_small(source, target, platform.machine())


def without_commit(text):
    return [line for line in text.splitlines() if line and not line.startswith("commit ")]


def compare(argil, a, b, rule):
    """Whether they are the same, and what the program says of it."""
    done = subprocess.run([argil, "compare", a, b, "--tolerances", GOLDEN / f"{rule}.json"], capture_output=True, text=True)
    return done.returncode == 0, "\n    ".join((done.stdout + done.stderr).splitlines()[:4])


def check(argil, name, settings, threads):
    """Line to print, and whether it is as it should be."""
    golden = GOLDEN / f"{name}.h5"
    with h5py.File(golden) as file:
        build = file["provenance/build"][()].decode()
        machine = file["provenance/machine"][()].decode()
    version = subprocess.run([argil, "--version"], capture_output=True, text=True, check=True).stdout
    is_same_build = without_commit(build) == without_commit(version) and machine == platform.machine()
    with tempfile.TemporaryDirectory() as folder:
        outputs = [Path(folder) / f"threads_{count}.h5" for count in threads]
        for count, output in zip(threads, outputs):
            run(argil, name, settings, output, count)
        is_equal, what = compare(argil, golden, outputs[0], "exact" if is_same_build else "near")
        line = f"{name} ({'bits' if is_same_build else 'within tolerance, made by another build'}): {what}"
        for count, output in zip(threads[1:], outputs[1:]):
            same_bits, what = compare(argil, outputs[0], output, "exact")
            line += f"; {count} threads: {'the same bits' if same_bits else what}"
            is_equal = is_equal and same_bits
    return line, is_equal


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("argil")
    parser.add_argument("names", nargs="*")
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--threads", type=int, nargs="+", default=[1, 2])
    options = parser.parse_intermixed_args()
    argil = str(Path(options.argil).resolve())
    runs = json.loads((GOLDEN / "runs.json").read_text())
    unknown = [name for name in options.names if name not in runs]
    if unknown:
        raise SystemExit(f"{unknown[0]} is not in {GOLDEN / 'runs.json'}")
    different = 0
    for name in options.names or runs:
        if options.check:
            line, is_equal = check(argil, name, runs[name], options.threads)
            print(line, flush=True)
            different += not is_equal
        else:
            regold(argil, name, runs[name])
            print(f"wrote {name}.h5", flush=True)
    if different:
        print(f"{different} of {len(runs)} golden runs differ. If that is meant: scripts/regold.py ARGIL, and say why in the commit.")
    return different > 0


if __name__ == "__main__":
    sys.exit(main())
