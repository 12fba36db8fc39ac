#!/usr/bin/python3
"""Checks that the code keeps to the table of layers in src/README.md. Exit code 1 and one line a breach.

A folder includes only itself and the folders that its row allows ("all above": every lower layer), always by the
path from src/; its CMakeLists.txt names every folder it includes and none that its row forbids; and a library is
included by its folders only. The folders of the loop take nothing that locks or calls the system.

Usage: check_layers.py [--root PROJECT]
"""
import argparse
import re
import sys
from pathlib import Path

# Start of an included header's name → the folders (or files) that may include it.
LIBRARIES = {"hdf5": ["hdf5"], "cholmod": ["linear"], "umfpack": ["linear"], "nlohmann/": ["device", "scenario"],
             "boost/": ["device"], "spnav": ["device"], "dlfcn": ["device"], "CLI/": ["cli", "main.cpp"],
             "pybind11/": ["python"], "Python.h": ["python"]}
# What no folder of the loop may include: a tick neither locks nor calls the system. One file there is read by no tick.
LOOP = {"contact", "material", "linear", "water", "solid", "embed", "sim"}
NOT_OF_THE_LOOP = {"contact/queries"}
SYSTEM = re.compile(r"(mutex|shared_mutex|thread|condition_variable|future|semaphore|chrono|ctime|fstream|iostream"
                    r"|filesystem|unistd\.h|pthread\.h|sys/.*)$")
INCLUDE = re.compile(r'^\s*#\s*include\s*(["<])([^">]+)[">]', re.MULTILINE)
ROW = re.compile(r"^\| (\d+) \| `([\w.]+)` \|.*\| ([^|]+) \|$", re.MULTILINE)
MODULE = re.compile(r"argil_(?:module|extension)\((\w+)([^)]*)\)")


def read_table(readme):
    """Folder → set of folders that it may include, itself not among them."""
    rows = [(int(layer), folder, rule.split()) for layer, folder, rule in ROW.findall(readme.read_text())]
    layer_of = {folder: layer for layer, folder, _ in rows}
    if not rows:
        sys.exit(f"{readme}: has no table of layers")
    allowed = {}
    for layer, folder, rule in rows:
        if rule[0] == "all":
            allowed[folder] = {other for other in layer_of if layer_of[other] < layer}
        else:
            allowed[folder] = {other for other in rule if other in layer_of} | ({"base"} - {folder})
            for other in allowed[folder]:
                if layer_of[other] >= layer:
                    sys.exit(f"{readme}: layer {layer} `{folder}` may not include `{other}` of layer {layer_of[other]}")
    return allowed


def strip_comments(code):
    return re.sub(r"//[^\n]*|/\*.*?\*/", "", code, flags=re.DOTALL)


def find_include_breaches(source, file, allowed):
    """Breaches of one file, and the folders that it includes."""
    place = file.relative_to(source).parts[0]
    breaches, used = [], set()
    for bracket, name in INCLUDE.findall(strip_comments(file.read_text())):
        if bracket == '"':
            folder = name.split("/")[0]
            # A header that the build makes has a template beside the sources.
            if "/" not in name or not ((source / name).is_file() or (source / f"{name}.in").is_file()):
                breaches.append(f'{file}: "{name}" is no path from src/')
            elif folder != place:
                used.add(folder)
                if folder not in allowed[place]:
                    breaches.append(f'{file}: "{name}": {place} may not include {folder}')
        is_of_loop = place in LOOP and str(file.relative_to(source).with_suffix("")) not in NOT_OF_THE_LOOP
        if bracket == "<" and is_of_loop and SYSTEM.match(name):
            breaches.append(f"{file}: <{name}>: the loop neither locks nor calls the system")
        for start, owners in LIBRARIES.items():
            if bracket == "<" and name.startswith(start) and place not in owners:
                breaches.append(f"{file}: <{name}>: only {' and '.join(owners)} includes it")
    return breaches, used


def read_dependencies(cmake):
    """Folders after DEPENDS in a module's CMakeLists.txt."""
    text = re.sub(r"#[^\n]*", "", cmake.read_text())
    words = [word for _, body in MODULE.findall(text) for word in body.split()]
    if "DEPENDS" not in words:
        return set()
    after = words[words.index("DEPENDS") + 1:]
    return set(after[:next((i for i, word in enumerate(after) if word.isupper()), len(after))])


def find_breaches(source):
    allowed = read_table(source / "README.md")
    breaches = []
    used_by = {}
    for file in sorted(file for suffix in ("h", "cpp") for file in source.rglob(f"*.{suffix}")):
        place = file.relative_to(source).parts[0]
        if place not in allowed:
            breaches.append(f"{file}: {place} is not in the table of {source / 'README.md'}")
            continue
        found, used = find_include_breaches(source, file, allowed)
        breaches += found
        used_by.setdefault(place, set()).update(used)
    for folder, used in sorted(used_by.items()):
        cmake = source / folder / "CMakeLists.txt"
        if cmake.is_file():
            stated = read_dependencies(cmake)
            breaches += [f"{cmake}: DEPENDS lacks {other}" for other in sorted(used - stated)]
            breaches += [f"{cmake}: DEPENDS on {other}, which the table does not allow"
                         for other in sorted(stated - allowed[folder])]
    return breaches


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--root", type=Path, default=Path(__file__).resolve().parent.parent, metavar="PROJECT")
    breaches = find_breaches(parser.parse_args().root / "src")
    print("\n".join(breaches), end="\n" if breaches else "")
    return 1 if breaches else 0


if __name__ == "__main__":
    sys.exit(main())
