#!/usr/bin/python3
"""Golden results: one small run for each mode, model, element, integrator and method between frames (tests/golden/).

Usage: regold.py ARGIL --check [--threads 1 2] [--keep FOLDER] [NAME …]
                                        compares runs with the golden files; exit code 1 when one is different
       regold.py ARGIL NAME …           rewrites those golden files: only when results are meant to change
       regold.py ARGIL --all            rewrites every one

Runs of one program must have the same bits for any number of threads. Bits must equal the golden ones when compiler and flags are
those in the golden file's /provenance/build, and libraries, the kernel that OpenBLAS chose, and the processor's vector units those
that tests/golden/made_on.json has of it; elsewhere numbers must agree within tests/golden/near.json.
"""
import argparse
import ctypes
import json
import platform
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import h5py

GOLDEN = Path(__file__).resolve().parent.parent / "tests" / "golden"
MADE_ON = GOLDEN / "made_on.json"
LIBRARIES = re.compile(r"lib(hdf5\w*|cholmod|amd|colamd|camd|ccolamd|suitesparseconfig|openblas|blas|lapack|gomp|omp|stdc\+\+|m)\b[^/]*\.so")
VECTOR_UNITS = ["sse4_1", "avx", "fma", "avx2", "avx512f", "asimd", "sve"]  # by which libraries choose their code


def describe_blas(library):
    """OpenBLAS's version and the processor it took this one for; else the file."""
    try:
        get_config = ctypes.CDLL(library).openblas_get_config
    except (AttributeError, OSError):
        return library
    get_config.restype = ctypes.c_char_p
    return re.sub(r" MAX_THREADS=\d+", "", get_config().decode().strip())


def describe_machine(argil):
    """Beside the build, what decides between bits and tolerance; `processor` is for the reader alone."""
    linked = subprocess.run(["ldd", argil], capture_output=True, text=True).stdout
    paths = re.findall(r"=> (/\S+)", linked)
    cpuinfo = Path("/proc/cpuinfo").read_text() if Path("/proc/cpuinfo").exists() else ""
    flags = re.search(r"^(?:flags|Features)\s*: (.*)$", cpuinfo, re.MULTILINE)
    model = re.search(r"^model name\s*: (.*)$", cpuinfo, re.MULTILINE)
    return {"machine": platform.machine(),
            "vector_units": [unit for unit in VECTOR_UNITS if flags and unit in flags[1].split()],
            "libc": " ".join(platform.libc_ver()),
            "libraries": sorted({Path(path).resolve().name for path in paths if LIBRARIES.match(Path(path).name)}),
            "blas": next((describe_blas(path) for path in paths if re.search(r"/lib(open)?blas[^/]*$", path)), "none"),
            "processor": model[1] if model else platform.processor()}


def is_same_machine(a, b):
    return all(a.get(key) == b.get(key) for key in {*a, *b} - {"processor"})


def run(argil, name, settings, output, threads=1):
    sets = [word for setting in settings for word in ("--set", setting)]
    done = subprocess.run([argil, "run", "ball.json", "-q", "-o", output, "--threads", str(threads), *sets], cwd=GOLDEN,
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
        if isinstance(item, h5py.Group):
            copy_below(item, name + "/")

    def copy_below(group, prefix):  # visititems would leave out the second name of an array that frames share
        for name, item in group.items():
            copy(prefix + name, item)

    for key, value in source.attrs.items():
        target.attrs.create(key, value)
    copy_below(source, "")
    target.require_group("timing")
    target["provenance/machine"] = machine


def regold(argil, name, settings):
    with tempfile.TemporaryDirectory() as folder:
        output = Path(folder) / "run.h5"
        run(argil, name, settings, output)
        with h5py.File(output) as source, h5py.File(GOLDEN / f"{name}.h5", "w", libver="latest") as target:
            copy_small(source, target, platform.machine())
    made_on = read_made_on()
    made_on[name] = describe_machine(argil)
    write_made_on(made_on)


def write_made_on(made_on):
    """Golden files that were made on like machines share an entry."""
    machines, names = [], []
    for name in made_on:
        if made_on[name] not in machines:
            machines.append(made_on[name])
            names.append([])
        names[machines.index(made_on[name])].append(name)
    MADE_ON.write_text(json.dumps([{"golden": sorted(n), **machine} for n, machine in zip(names, machines)], indent=1) + "\n")


def read_made_on():
    entries = json.loads(MADE_ON.read_text()) if MADE_ON.exists() else []
    return {name: {key: value for key, value in entry.items() if key != "golden"} for entry in entries for name in entry["golden"]}


def without_commit(text):
    return [line for line in text.splitlines() if line and not line.startswith("commit ")]


def compare(argil, a, b, rule):
    """Whether they are the same, and what the program says of it."""
    done = subprocess.run([argil, "compare", a, b, "--tolerances", GOLDEN / f"{rule}.json"], capture_output=True, text=True)
    lines = (done.stdout + done.stderr).splitlines()
    verdict = next((i for i, line in enumerate(lines) if line.startswith(("equal", "different", "argil"))), 0)
    return done.returncode == 0, "\n    ".join(lines[verdict:verdict + 4])


def check(argil, name, settings, threads, keep):
    """Line to print, and whether it is as it should be. The first run goes to the folder `keep`, if there is one."""
    golden = GOLDEN / f"{name}.h5"
    with h5py.File(golden) as file:
        build = file["provenance/build"][()].decode()
    version = subprocess.run([argil, "--version"], capture_output=True, text=True, check=True).stdout
    made_on = read_made_on().get(name, {})
    is_same_build = without_commit(build) == without_commit(version) and is_same_machine(made_on, describe_machine(argil))
    with tempfile.TemporaryDirectory() as folder:
        outputs = [Path(folder) / f"threads_{count}.h5" for count in threads]
        for count, output in zip(threads, outputs):
            run(argil, name, settings, output, count)
        is_equal, what = compare(argil, golden, outputs[0], "exact" if is_same_build else "near")
        line = f"{name} ({'bits' if is_same_build else 'within tolerance, made by another build or on another machine'}): {what}"
        for count, output in zip(threads[1:], outputs[1:]):
            same_bits, what = compare(argil, outputs[0], output, "exact")
            line += f"; {count} threads: {'the same bits' if same_bits else what}"
            is_equal = is_equal and same_bits
        if keep:
            shutil.copy(outputs[0], keep / f"{name}.h5")
    return line, is_equal


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("argil")
    parser.add_argument("names", nargs="*")
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--all", action="store_true", help="rewrite every golden file")
    parser.add_argument("--keep", type=Path, help="with --check: folder for the runs' results, NAME.h5")
    parser.add_argument("--threads", type=int, nargs="+", default=[1, 2])
    options = parser.parse_intermixed_args()
    argil = str(Path(options.argil).resolve())
    runs = json.loads((GOLDEN / "runs.json").read_text())
    unknown = [name for name in options.names if name not in runs]
    if unknown:
        raise SystemExit(f"{unknown[0]} is not in {GOLDEN / 'runs.json'}")
    if not (options.names or options.check or options.all):
        raise SystemExit("nothing is rewritten: name the golden runs whose results are meant to change, or give --all")
    if options.keep:
        options.keep.mkdir(parents=True, exist_ok=True)
    different = 0
    for name in options.names or runs:
        if options.check:
            line, is_equal = check(argil, name, runs[name], options.threads, options.keep)
            print(line, flush=True)
            different += not is_equal
        else:
            regold(argil, name, runs[name])
            print(f"wrote {name}.h5", flush=True)
    if different:
        print(f"{different} of {len(options.names or runs)} golden runs differ. If that is meant: scripts/regold.py ARGIL NAME …, and say "
              "why in the commit.")
    return different > 0


if __name__ == "__main__":
    sys.exit(main())
