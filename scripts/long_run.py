#!/usr/bin/python3
"""Runs an hour of ticks on a small ball, with frames, checkpoints and a hand that comes and goes, and prints what memory the
process has at several times and at its very end. Exit code 1 when memory grows by more than what the library keeps of a file's structure,
--growth kB a second of ticks in the second half (and 2 MB, for the heap grows in steps), or by more than --end MB
after the last tick.

Usage: long_run.py ARGIL [--seconds 3600] [--growth 6] [--end 4]
"""
import argparse
import json
import math
import os
import pty
import re
import subprocess
import sys
import tempfile
from pathlib import Path

SCENE = Path(__file__).resolve().parent.parent / "tests" / "golden" / "ball.json"
SETTINGS = ["/haptics/physics_period_ticks=10", "/haptics/water_period_ticks=10", "/haptics/frame_period_ticks=100",
            "/output/checkpoint_period_ticks=1000", "/tool/mode=trace", "/contact/friction=0.3"]
SHARES = [0.0025, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.99]
SAMPLES_PER_S = 20
HEAP_STEP_MB = 2.0


def write_motion(file, seconds):
    """Presses of 1.5 mm every two seconds, ten seconds each of pressing, wetting, pressing and drying."""
    with open(file, "w", encoding="ascii") as out:
        out.write("t,x,y,z,mode\n")
        for k in range(int(seconds * SAMPLES_PER_S) + 1):
            t = k / SAMPLES_PER_S
            mode = ["push", "wet", "push", "dry"][int(t / 10) % 4]
            out.write(f"{t:.2f},{0.002 * math.sin(0.7 * t):.6f},0.0007,{0.0535 - 0.0035 * math.sin(math.pi * t / 2) ** 2:.6f},{mode}\n")


def read_memory(pid):
    """Resident set and its largest so far [MB]."""
    text = Path(f"/proc/{pid}/status").read_text(encoding="ascii")
    return [int(re.search(rf"{key}:\s+(\d+) kB", text)[1]) / 1024 for key in ("VmRSS", "VmHWM")]


def watch(command, folder, seconds):
    """Prints a line when each share of the run is over, by the program's own progress bar. Returns the largest memory that it had each
    time and at the end."""
    try:
        screen, terminal = pty.openpty()
    except OSError as missing:
        print(f"skipped: the progress bar wants a terminal, and there is none to be had ({missing})")
        sys.exit(77)
    seen, shares = [], list(SHARES)
    with subprocess.Popen(command, cwd=folder, stdout=terminal, stderr=terminal) as run:
        os.close(terminal)
        while True:
            try:
                text = os.read(screen, 4096).decode(errors="replace")
            except OSError:  # the other end is closed
                break
            done = re.findall(r"([\d.]+) %", text)
            while done and shares and float(done[-1]) >= 100 * shares[0]:
                now, most = read_memory(run.pid)
                size = (folder / "long.h5").stat().st_size / 1e6
                print(f"{shares.pop(0) * seconds:8.0f} s of ticks   {now:6.1f} MB resident, {most:6.1f} MB at most, file {size:8.1f} MB",
                      flush=True)
                seen.append(most)
        _, status, used = os.wait4(run.pid, 0)
        run.returncode = os.waitstatus_to_exitcode(status)
        if run.returncode != 0:
            raise SystemExit(f"argil run ended with {run.returncode}: {text}")
    return seen, used.ru_maxrss / 1024


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("argil")
    parser.add_argument("--seconds", type=float, default=3600.0)
    parser.add_argument("--growth", type=float, default=6.0)
    parser.add_argument("--end", type=float, default=4.0)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as temp:
        folder = Path(temp)
        write_motion(folder / "long.csv", options.seconds)
        sets = [word for setting in SETTINGS for word in ("--set", setting)]
        seen, end = watch([str(Path(options.argil).resolve()), "run", SCENE, "--trace", "long.csv", "-o", "long.h5", *sets], folder,
                     options.seconds)
    half = options.seconds * (SHARES[-1] - 0.5)
    growth = seen[-1] - seen[SHARES.index(0.5)]
    print(f"{options.seconds * 1000:.0f} ticks; {growth:.1f} MB more in the second half, {1024 * growth / half:.1f} kB a second of ticks; "
          f"{end:.1f} MB at most with the end, when the XDMF is written")
    return not (growth <= options.growth * half / 1024 + HEAP_STEP_MB and end - seen[-1] <= options.end)


if __name__ == "__main__":
    sys.exit(main())
