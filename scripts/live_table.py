#!/usr/bin/python3
"""How well a live session keeps its times, on the demonstration's dinosaur, with physics of three rates; each session is
replayed and compared.

    scripts/live_table.py [--build BUILD] [--seconds 60] [--devices simulated haply …] [--output results/live]

writes live.csv and README.md there. One line a session. Run it on a machine with nothing else to do. A simulated
hand follows traces/long_session.csv and rests at its end. "haply" is the
stand-in of the tests, started here; any other device must be there.
"""
import argparse
import contextlib
import csv
import os
import platform
import subprocess
import tempfile
from pathlib import Path

import h5py

ROOT = Path(__file__).resolve().parent.parent
SCENARIO = ROOT / "scenarios" / "demo_dino_dry.json"
# Ticks of 1 ms: a physics step, the water's, a picture.
RATES = {"1000": (1, 10, 40), "333": (3, 12, 42), "71": (14, 14, 42)}
FIGURES = ["wake_late_p50", "wake_late_p99", "wake_late_p999", "wake_late_max", "tick_work_p50", "tick_work_p99",
           "tick_work_max", "step_work_p50", "step_work_p99", "step_work_max", "num_surface_age_ticks_p50",
           "num_surface_age_ticks_p99", "num_surface_age_ticks_max", "num_ticks", "num_missed_ticks", "num_steps",
           "num_late_steps"]


def call(argil, *arguments):
    done = subprocess.run([argil, *map(str, arguments)], capture_output=True, text=True, check=False)
    return done.returncode, done.stdout + done.stderr


@contextlib.contextmanager
def stand_in(device):
    """Name of the device that argil is given, and the settings that bring its motion to the dinosaur's flank."""
    if device != "haply":
        yield device, []
        return
    process = subprocess.Popen([ROOT / "tests" / "support" / "haply_stand_in.py"], stdin=subprocess.PIPE,
                               stdout=subprocess.PIPE, text=True)
    try:
        port = process.stdout.readline().split()[1]
        yield f"haply:127.0.0.1:{port}", ["/trace/device_to_world/translation_m=[-0.006, 0.074, -0.088]"]
    finally:
        process.stdin.close()
        process.wait()


def run_session(argil, folder, device, rate, seconds):
    with stand_in(device) as (name, placed):
        return record(argil, folder, (device, name), placed, rate, seconds)


def record(argil, folder, devices, placed, rate, seconds):
    device, name = devices
    physics, water, frame = RATES[rate]
    settings = [f"/haptics/physics_period_ticks={physics}", f"/haptics/water_period_ticks={water}",
                f"/haptics/frame_period_ticks={frame}", "/haptics/between_frames=re_evaluate",
                f"/trace/file={ROOT / 'traces' / 'long_session.csv'}"]
    sets = [word for setting in settings + placed for word in ("--set", setting)]
    live, again = folder / "live.h5", folder / "again.h5"
    code, said = call(argil, "live", SCENARIO, "--device", name, "--duration", seconds, "-o", live, "-q", *sets)
    if code != 0:
        raise SystemExit(f"{device} at {rate} Hz: code {code}: {said}")
    sets = [word for setting in settings[:-1] for word in ("--set", setting)]
    code, said = call(argil, "run", SCENARIO, "--trace", live, "-o", again, "-q", *sets)
    if code != 0:
        raise SystemExit(f"replay of {device} at {rate} Hz: code {code}: {said}")
    code, said = call(argil, "compare", live, again)
    row = {"device": device, "physics_Hz": rate, "replay": "equal" if code == 0 else said.splitlines()[0]}
    with h5py.File(live) as file:
        row["end_hash"] = bytes(file["session"].attrs["end_hash"]).decode()[:16]
        for name in FIGURES:
            row[name] = float(file["timing"][name][-1])
        row["largest_force_N"] = float(abs(file["haptic/device_force"][:]).max())
    return row


def write_readme(file, rows, seconds):
    us, ms = 1e6, 1e3
    lines = [
        "# How well a live session keeps its times", "",
        f"The dinosaur of `demo_dino_dry`, {seconds:g} s a session, hand at 1 kHz, `re_evaluate`; {os.cpu_count()} processors,"
        f" {platform.machine()}, Linux {platform.release()}. Each session is replayed in one thread; \"equal\": `argil compare` finds no"
        " difference, forces and hashes included. `scripts/live_table.py` writes this.", "",
        "| device | physics | woken late, p50 / p99 / p99.9 / max [µs] | a tick's work, p50 / p99 / max [µs] |"
        " a step's work, p50 / p99 / max [ms] | age of the surface, p50 / p99 / max [ticks] | missed ticks | late steps | replay |",
        "|---|---|---|---|---|---|---|---|---|"]
    for r in rows:
        late = " / ".join(f"{us * r['wake_late_' + q]:.0f}" for q in ("p50", "p99", "p999", "max"))
        work = " / ".join(f"{us * r['tick_work_' + q]:.0f}" for q in ("p50", "p99", "max"))
        step = " / ".join(f"{ms * r['step_work_' + q]:.2f}" for q in ("p50", "p99", "max"))
        age = " / ".join(f"{r['num_surface_age_ticks_' + q]:.0f}" for q in ("p50", "p99", "max"))
        lines.append(f"| {r['device']} | {r['physics_Hz']} Hz | {late} | {work} | {step} | {age} |"
                     f" {r['num_missed_ticks']:.0f} of {r['num_ticks']:.0f} | {r['num_late_steps']:.0f} of {r['num_steps']:.0f}"
                     f" | {r['replay']} |")
    file.write_text("\n".join(lines) + "\n", encoding="utf-8")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--build", type=Path, default=ROOT / "build")
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--devices", nargs="+", default=["simulated", "haply"])
    parser.add_argument("--output", type=Path, default=ROOT / "results" / "live")
    options = parser.parse_args()
    rows = []
    for device in options.devices:
        for rate in RATES:
            with tempfile.TemporaryDirectory() as folder:
                rows.append(run_session(options.build / "bin" / "argil", Path(folder), device, rate, options.seconds))
            print(rows[-1])
    options.output.mkdir(parents=True, exist_ok=True)
    with open(options.output / "live.csv", "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, rows[0].keys())
        writer.writeheader()
        writer.writerows(rows)
    write_readme(options.output / "README.md", rows, options.seconds)


if __name__ == "__main__":
    main()
