#!/usr/bin/python3
"""Types every command of the documentation, as a newcomer does who reads from top to bottom.

Usage: test_docs.py BUILD. Every block of ```sh in every page runs in order under `bash -euo pipefail`, a page in a
temporary folder of its own, which sees the project through links; what the commands write stays in it, and the project's
results, scenarios and traces are afterwards as they were. A command that
takes many minutes is typed in a shorter form, and every such form stands in SHORTENED. A command within the running
text is held against the program's own help: the program is there and has the options that are named; those of INLINE
are typed besides, or by the other test that stands there. The five commands of README's first page, for a person with an
own OBJ and CSV in millimetres, must besides lead to what it promises of them. Exit code 77 (skipped) where a figure
cannot be drawn because matplotlib or VTK is missing.
"""
import os
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
LINKED = ("scenarios", "scripts", "src", "traces", "viewer", "examples", "tests", "README.md",
          "CMakePresets.json")
SHORTENED = {  # as written → as typed
    "scripts/run": "scripts/run tests/golden/ball.json",  # the least of the scenes, not the demonstration's four runs
    "scripts/test": "scripts/test -N",  # builds, and names every test without running it: this is one of them
}
INLINE = {  # outside of blocks, as written → as typed, or the test that types it
    "ctest --test-dir build -L quick": "ctest --test-dir build -L quick -N",
    "cmake --preset release": "cmake --list-presets | grep --quiet release",
    "scripts/build argil viewer python": "scripts/build argil viewer python",
    "scripts/reproduce": "scripts/reproduce page",  # of its items the one without runs; scripts.paper makes them
    "argil --version": "build/bin/argil --version",
    "cmake --install build": ("install.find_package",),
    "man argil": ("install.find_package",),
    "cpack --config build/CPackConfig.cmake": ("install.package",),
    "npm install --prefix build/peers mujoco-js@0.0.7": None,  # what one figure is made with, 11 MB
    "npm install --omit-lockfile-registry-resolved": None,  # changes the lock of the viewer's packages: by hand
}
FIVE_COMMANDS = ["argil new gem.obj tap.csv",
                 "argil run gem.json",
                 "argil run gem.json -o wet.h5 --set /body/initial_saturation=1",
                 "plot_force.py gem.h5 wet.h5 --labels dry wet -o force",
                 "argil export wet.h5 --html wet.html"]
COMMAND = re.compile(r"`((?:scripts/|build/bin/argil |argil |cmake |cpack |ctest |npm |man )[^`]+)`")


def find_pages():
    listed = subprocess.run(["git", "-C", ROOT, "ls-files", "*.md"], capture_output=True, text=True)
    if listed.returncode == 0:
        return [Path(name) for name in listed.stdout.split()]
    return [page.relative_to(ROOT) for folder in (".", "src", "results", "viewer", "tests")
            for page in sorted((ROOT / folder).glob("*.md" if folder == "." else "**/*.md"))]


def find_changes():
    """What git sees changed of the files that scripts make, names and contents; nothing where there is no git."""
    return [subprocess.run(["git", "-C", ROOT, *words, "--", "results", "scenarios", "traces"], capture_output=True).stdout
            for words in (("status", "--porcelain"), ("diff", "HEAD", "--binary"))]


def split_page(page):
    """Blocks of commands, and the commands within the text between all blocks."""
    text = (ROOT / page).read_text(encoding="utf-8")
    blocks = re.findall(r"^```sh\n(.*?)^```", text, flags=re.DOTALL | re.MULTILINE)
    rest = re.sub(r"^```.*?^```", "", text, flags=re.DOTALL | re.MULTILINE)
    return blocks, COMMAND.findall(" ".join(rest.split()))


def shortened(block):
    """A line that is one of the long commands, with or without a word about it, in its shorter form."""
    lines = block.splitlines(keepends=True)
    return "".join(SHORTENED.get(line.split("#")[0].strip(), line.rstrip("\n")) + "\n" for line in lines)


def read_peak(result):
    """Largest force at the hand [N]."""
    import h5py
    import numpy as np
    with h5py.File(result) as file:
        return np.linalg.norm(file["haptic/force"][:], axis=1).max()


def find_faults_of_five_commands(tour, has_viewer):
    """What their results lack."""
    dry, wet = (read_peak(tour / name) for name in ("gem.h5", "wet.h5"))
    holds = {
        "README.md has the five commands": "\n".join(FIVE_COMMANDS) in (ROOT / "README.md").read_text(encoding="utf-8"),
        # Eq. 6 softens clay whose pores (n = 0.4) are full: E and strength fall alike.
        f"dry clay pushes back more than half as much again as wet clay: {dry:.3g} N and {wet:.3g} N": dry > 1.5 * wet,
        f"wet clay pushes back by more than 1 mN: {wet:.3g} N": wet > 1e-3,
        "force.png is a picture": (tour / "force.png").read_bytes().startswith(b"\x89PNG"),
        "wet.html has a page": not has_viewer or "<canvas" in (tour / "wet.html").read_text(encoding="utf-8")}
    return [f"README.md: it does not hold that {claim}" for claim, does in holds.items() if not does]


class Newcomer:
    def __init__(self, build):
        self.build = build
        self.has_viewer = Path(build, "share/argil/viewer.html").exists()
        self.helps = {}
        self.failures = []
        self.seconds = float("nan")  # of the five commands
        tests = subprocess.run(["ctest", "--test-dir", build, "-N"], capture_output=True, text=True, check=True)
        self.tests = set(re.findall(r"Test +#\d+: (\S+)", tests.stdout))

    def type(self, page, text, folder):
        """Runs commands in the folder; a word about what went wrong, if anything did."""
        if not self.has_viewer:  # built without npm: the page cannot be made, the series can
            text = re.sub(r"--html \S+ ", "", text)
        done = subprocess.run(["bash", "-euo", "pipefail", "-c", text], cwd=folder, capture_output=True, text=True)
        if done.returncode != 0:
            self.failures.append(f"{page}: exit code {done.returncode} of\n{text}\n{done.stdout}\n{done.stderr}")

    def help_of(self, program):
        """What a program says of its options; a shell script says it in itself."""
        if program not in self.helps:
            words = program.split()
            if words[0] == "argil":
                words[0] = f"{self.build}/bin/argil"
            elif not words[0].endswith(".py") or not os.access(ROOT / words[0], os.X_OK):
                file = ROOT / words[0]
                self.helps[program] = file.read_text(encoding="utf-8") if file.is_file() else None
                return self.helps[program]
            done = subprocess.run([*words, "--help"], cwd=ROOT, capture_output=True, text=True)
            is_there = done.returncode == 0 and (words[0].endswith(".py") or f"Usage: {program} " in done.stdout)
            self.helps[program] = done.stdout if is_there else None
        return self.helps[program]

    def look_up(self, page, command):
        """Is there such a program, with such options?"""
        words = re.sub(r"^build/bin/", "", command).split()
        program = words[0]
        if program == "argil":
            below = [word for word in words[1:3] if re.fullmatch("[a-z]+", word)]
            program = " ".join(["argil", *(below if words[1:2] == ["sweep"] else below[:1])])
        text = self.help_of(program)
        if text is None:
            self.failures.append(f"{page}: `{command}`: there is no {program}")
            return
        for option in (word for word in words[1:] if re.match("--?[a-zA-Z]", word)):
            if not re.search(rf"(?<![\w-]){re.escape(option)}(?![\w-])", text):
                self.failures.append(f"{page}: `{command}`: {program} has no {option}")

    def read(self, page):
        """Everything that is said on one page; how many blocks and commands there were."""
        blocks, commands = split_page(page)
        with tempfile.TemporaryDirectory(prefix="argil_docs_") as folder:
            for name in LINKED:
                os.symlink(ROOT / name, Path(folder, name))
            os.symlink(self.build, Path(folder, "build"))
            for block in blocks:
                start = time.monotonic()
                self.type(page, shortened(block), folder)
                if "\n".join(FIVE_COMMANDS) in block:
                    self.seconds = time.monotonic() - start
            if page == Path("README.md"):
                self.failures += find_faults_of_five_commands(Path(folder, "tour"), self.has_viewer)
            for command in dict.fromkeys(commands):
                way = INLINE.get(command, ())
                if isinstance(way, str):
                    self.type(page, way, folder)
                elif way:
                    self.failures += [f"{page}: `{command}`: no test {name}" for name in way if name not in self.tests]
                elif way is not None:
                    self.look_up(page, command)
        return len(blocks), len(commands)


def main(build):
    try:
        import h5py  # noqa: F401
        import matplotlib  # noqa: F401
        import vtkmodules  # noqa: F401
    except ImportError as missing:
        print(f"skipped: {missing}")
        return 77
    newcomer = Newcomer(build)
    pages, changes = find_pages(), find_changes()
    counts = [newcomer.read(page) for page in pages]
    blocks, commands = (sum(count) for count in zip(*counts))
    if find_changes() != changes:
        newcomer.failures.append("the commands of the pages changed results, scenarios or traces of the project")
    print("\n".join(newcomer.failures))
    print(f"the five commands took {newcomer.seconds:.0f} s")
    print(f"{len(pages)} pages: {blocks} blocks were typed, {commands} commands in the text held against their help")
    return 1 if newcomer.failures or blocks < 7 or commands < 50 else 0


if __name__ == "__main__":
    sys.exit(main(os.path.abspath(sys.argv[1])))
