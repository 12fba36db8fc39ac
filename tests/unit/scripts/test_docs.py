#!/usr/bin/python3
"""Types every command of the documentation in a temporary folder, as a newcomer does who reads from top to bottom.

Usage: test_docs.py BUILD. Blocks of ```sh in the pages below run in order under `bash -euo pipefail`. Only commands that
build or run for many minutes are left out, by name. The commands see the project through links; what they write stays in
the folder. Exit code 77 (skipped) where a figure cannot be drawn because matplotlib or VTK is missing.
"""
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
PAGES = ("README.md",)
LONG = ("scripts/run", "scripts/test")  # have tests of their own: the demonstration's figures, this very suite
LINKED = ("scenarios", "scripts", "src", "traces", "viewer", "examples")


def blocks_of(page):
    text = (ROOT / page).read_text(encoding="utf-8")
    return re.findall(r"^```sh\n(.*?)^```", text, flags=re.DOTALL | re.MULTILINE)


def without_long_commands(block):
    return "".join(line for line in block.splitlines(keepends=True) if line.split("#")[0].strip() not in LONG)


def main(build):
    try:
        import matplotlib  # noqa: F401
        import vtkmodules  # noqa: F401
    except ImportError as missing:
        print(f"skipped: {missing}")
        return 77
    viewer = Path(build, "share/argil/viewer.html").exists()
    with tempfile.TemporaryDirectory(prefix="argil_docs_") as folder:
        for name in LINKED:
            os.symlink(ROOT / name, Path(folder, name))
        os.symlink(build, Path(folder, "build"))
        count = 0
        for page in PAGES:
            for block in blocks_of(page):
                text = without_long_commands(block)
                if not viewer:  # built without npm: the page cannot be made, the series can
                    text = re.sub(r"--html \S+ ", "", text)
                done = subprocess.run(["bash", "-euo", "pipefail", "-c", text], cwd=folder, capture_output=True, text=True)
                if done.returncode != 0:
                    print(f"{page}: exit code {done.returncode} of\n{text}\n{done.stdout}\n{done.stderr}")
                    return 1
                count += 1
        print(f"{count} blocks of {', '.join(PAGES)} were typed")
        return 0 if count > 4 else 1


if __name__ == "__main__":
    sys.exit(main(os.path.abspath(sys.argv[1])))
