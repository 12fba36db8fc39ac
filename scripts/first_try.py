#!/usr/bin/python3
"""What happens to a stranger's files at first try. Every recording of a folder is played over a cube, and a ball is pressed into every mesh of
it: `argil new`, `argil validate` and 50 ticks of `argil run`. Where one is refused, the remedy of the message is followed to the letter, once
and again while it names something to do. Nothing is fetched.

Usage: first_try.py ARGIL FOLDER … [-o TABLE.csv] [--known KEYS.json] [--leave-out PATTERN]

KEYS.json has, by the name of a file, keys of a scenario that its source tells of it, such as what the columns of a table without
names are; they are given where the message asks for such a key. Writes results/first_hour/first_try.csv.

Columns: file, whether it is a motion or a mesh, its source (the folder), how it went (at first try, by the remedy, as its source tells, refused,
failed), what was set, the last message, seconds.
"""
import argparse
import fnmatch
import json
import re
import shlex
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

import numpy as np

from table_file import write_table

ROOT = Path(__file__).resolve().parent.parent
MOTIONS = (".csv", ".tsv", ".txt", ".npy", ".h5", ".hdf5")
MESHES = (".obj", ".off", ".stl", ".ply", ".msh", ".mesh", ".vtk", ".vtu", ".veg", ".node")
TICKS, PATIENCE, MOST_REMEDIES = 50, 300, 5  # patience in seconds a command
HOW = ("at first try", "by the remedy", "as its source tells", "refused", "failed")
CUBE = [(x, y, z) for z in (0, 0.06) for y in (0, 0.06) for x in (0, 0.06)]
FACES = [(1, 3, 4), (1, 4, 2), (5, 6, 8), (5, 8, 7), (1, 2, 6), (1, 6, 5), (3, 7, 8), (3, 8, 4), (1, 5, 7), (1, 7, 3), (2, 4, 8), (2, 8, 6)]


def write_stock(folder):
    """A cube of 6 cm, and a press of 2 mm in 50 ms."""
    lines = ["v %g %g %g" % place for place in CUBE] + ["f %d %d %d" % face for face in FACES]
    (folder / "cube.obj").write_text("\n".join(lines) + "\n")
    rows = [f"{k / 1000},0.03,0.03,{0.07 - 0.002 * np.sin(np.pi * k / TICKS) ** 2:.9f}" for k in range(TICKS + 1)]
    (folder / "press.csv").write_text("t,x,y,z\n" + "\n".join(rows) + "\n")


def find_remedies(message, known):
    """What a message says to do, as words for `argil new`, and whether the source of the file had to tell it."""
    if any(key in message for key in known):
        return [["--set", f"{key}={json.dumps(value)}"] for key, value in known.items()], True
    if literal := re.search(r"(--set \S+=\S+|--up [xyz]\b|--force\b)", message):
        return [shlex.split(literal[1])], False
    if key := re.search(r"(?:by|set|give) (/[a-z_/]+)(?:: ([^;]*)| to ([^\s;,]+))", message):
        words = key[2] or key[3]
        likely = re.search(r"perhaps (\S+)", words)
        value = likely[1] if likely else re.split(r",| or ", words)[0].strip()
        return [["--set", f"{key[1]}={value}"]], False
    if key := re.search(r"by (/[a-z_/]+), for instance (\[[^\]]*\]|\S+)", message):
        return [["--set", f"{key[1]}={key[2]}"]], False
    if pair := re.search(r": (/[a-z_/]+): .*; (?:.* )?(?:set|give) \"?([a-z_]+)\"?(?:$|[:;,])", message):
        return [["--set", f"{pair[1]}={pair[2]}"]], False
    return [], False


class Trial:
    def __init__(self, argil, folder, file, known):
        self.argil, self.folder, self.file, self.known = argil, folder, file, known
        self.settings, self.told, self.message = [], False, ""

    def call(self, *words):
        try:
            done = subprocess.run([self.argil, *words], cwd=self.folder, capture_output=True, text=True, timeout=PATIENCE)
        except subprocess.TimeoutExpired:
            self.message = f"not done in {PATIENCE} s"
            return -1, ""
        errors = [line for line in done.stderr.splitlines() if not line.startswith(("argil: note:", "argil: warning:"))]
        self.message = " ".join(errors) if done.returncode else ""
        return done.returncode, done.stdout

    def go(self, is_motion):
        pair = ("cube.obj", self.file) if is_motion else (self.file, "press.csv")
        words = [word for setting in self.settings for word in setting]
        code, _ = self.call("new", *pair, "-o", "try.json", "--force", *words)
        if code == 0:
            code, _ = self.call("validate", "try.json")
        if code == 0:
            code, _ = self.call("run", "try.json", "-o", "try.h5", "--quiet", *self.cut())
        return code

    def cut(self):
        """The first ticks, of a motion that has as many."""
        code, said = self.call("run", "try.json", "--dry-run")
        ticks = re.search(r", (\d+) ticks: ready", said)
        return ["--set", f"/trace/duration_s={TICKS / 1000}"] if code == 0 and ticks and int(ticks[1]) > TICKS else []

    def follow(self):
        """Does what the message says; is there something that was not done yet?"""
        if "numpy.save(file, a[0])" in self.message:
            np.save(self.folder / "one.npy", np.load(self.file)[0])
            self.file = self.folder / "one.npy"
            self.settings.append([])  # a step, without a key
            return True
        remedies, told = find_remedies(self.message, self.known)
        new = [remedy for remedy in remedies if remedy not in self.settings]
        self.settings += new
        self.told = self.told or (told and bool(new))
        return bool(new)


def attempt(argil, file, known):
    is_motion = file.suffix.lower() in MOTIONS
    start = time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        write_stock(Path(folder))
        trial = Trial(argil, Path(folder), file, known)
        code = trial.go(is_motion)
        for _ in range(MOST_REMEDIES):
            if code != 2 or not trial.follow():
                break
            code = trial.go(is_motion)
    how = "failed" if code not in (0, 2) else "refused" if code == 2 else \
        "as its source tells" if trial.told else "by the remedy" if trial.settings else "at first try"
    said = "; ".join(" ".join(setting) or "numpy.save(file, a[0])" for setting in trial.settings)
    return "motion" if is_motion else "mesh", how, said, trial.message.replace(str(file), file.name), time.monotonic() - start


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", maxsplit=1)[0])
    parser.add_argument("argil", type=lambda name: str(Path(name).resolve()))
    parser.add_argument("folders", type=Path, nargs="+", metavar="FOLDER")
    parser.add_argument("-o", "--output", type=Path, default=ROOT / "results/first_hour/first_try.csv", metavar="TABLE.csv")
    parser.add_argument("--known", type=Path, default=ROOT / "results/first_hour/known.json", metavar="KEYS.json")
    parser.add_argument("--leave-out", action="append", default=[], metavar="PATTERN", help="of paths below a folder; may be repeated")
    options = parser.parse_args()
    known = json.loads(options.known.read_text(encoding="utf-8")) if options.known.exists() else {}
    rows, counts = [], Counter()
    for top in options.folders:
        for file in sorted(top.resolve().rglob("*")):
            name = str(file.relative_to(top.resolve()))
            if file.suffix.lower() not in MOTIONS + MESHES or any(fnmatch.fnmatch(name, pattern) for pattern in options.leave_out):
                continue
            kind, how, said, message, seconds = attempt(options.argil, file, known.get(file.name, {}))
            rows.append((name, kind, file.parent.name, how, said, message, f"{seconds:.1f}"))
            counts[kind, how] += 1
            print(f"{name}: {how} {said} {message}", flush=True)
    write_table(options.output, ("file", "kind", "source", "how", "set", "message", "s"), rows)
    for kind in ("motion", "mesh"):
        print(f"{kind}: " + ", ".join(f"{counts[kind, how]} {how}" for how in HOW if counts[kind, how]))
    return 1 if any(how == "failed" for _, how in counts) else 0


if __name__ == "__main__":
    sys.exit(main())
