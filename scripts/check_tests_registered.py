#!/usr/bin/python3
"""Checks that every source of src/ and tests/ is compiled, so that no test sits in a file that nobody builds, and
that a CMakeLists.txt names every test in Python, and the sources in folders "peers", which need other programs that may
be missing. Exit code 1 and one line a forgotten file.

Usage: check_tests_registered.py BUILD [--root PROJECT]        BUILD holds compile_commands.json
"""
import argparse
import json
import sys
from pathlib import Path


def find_forgotten(root, build):
    commands = json.loads((build / "compile_commands.json").read_text())
    compiled = {(Path(entry["directory"]) / entry["file"]).resolve() for entry in commands}
    sources = sorted(file for folder in ("src", "tests") for file in (root / folder).rglob("*.cpp"))
    forgotten = [f"{file}: is not compiled" for file in sources
                 if file.resolve() not in compiled and file.parent.name != "peers"]
    named = " ".join(file.read_text() for file in (root / "tests").rglob("CMakeLists.txt"))
    to_name = sorted((root / "tests").rglob("test_*.py")) + [file for file in sources if file.parent.name == "peers"]
    return forgotten + [f"{file}: no CMakeLists.txt names it" for file in to_name if file.name not in named]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("build", type=Path, metavar="BUILD")
    parser.add_argument("--root", type=Path, default=Path(__file__).resolve().parent.parent, metavar="PROJECT")
    options = parser.parse_args()
    forgotten = find_forgotten(options.root, options.build)
    print("\n".join(forgotten), end="\n" if forgotten else "")
    return 1 if forgotten else 0


if __name__ == "__main__":
    sys.exit(main())
