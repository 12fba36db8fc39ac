#!/usr/bin/python3
"""How well a live session keeps its times, on the demonstration's dinosaur, with physics of three rates; each session is
replayed and compared.

    scripts/live_table.py [--build BUILD] [--seconds 60] [--devices simulated haply spacenav …]
                          [--sessions 1000:re_evaluate 71:hold …] [--output results/live]

writes live.csv, README.md and force.md there, one line a session; other lines stay. A session is the physics' rate [Hz] and what the
hand feels between its steps. Run it on a machine with nothing
else to do. A simulated hand means to press, wet, press and dry the haunch, to and fro, for as long as the session
lasts. "haply" and "spacenav" are the stand-ins of the tests, started here; any other device must be there.
"""
import argparse
import contextlib
import csv
import math
import os
import platform
import subprocess
import tempfile
from pathlib import Path

import h5py

ROOT = Path(__file__).resolve().parent.parent
SCENARIO = ROOT / "scenarios" / "study_soft_dino.json"
# Ticks of 1 ms: a physics step, the water's, a picture.
RATES = {"1000": (1, 10, 40), "333": (3, 12, 42), "71": (14, 14, 42)}
SESSIONS = [*(f"{rate}:re_evaluate" for rate in RATES), "71:hold"]  # hold: the paper's, at its rate
KEY = ("device", "physics_Hz", "between_frames")
STAND_INS = {"haply": ("haply_stand_in.py", (-0.006, 0.074, -0.088)),
             "spacenav": ("spacenav_stand_in.py", (-0.006, -0.2364, 0.062))}
FIGURES = ["wake_late_p50", "wake_late_p99", "wake_late_p999", "wake_late_max", "tick_work_p50", "tick_work_p99",
           "tick_work_max", "step_work_p50", "step_work_p99", "step_work_max", "num_surface_age_ticks_p50",
           "num_surface_age_ticks_p99", "num_surface_age_ticks_max", "sample_age_p50", "sample_age_p99", "sample_age_max",
           "num_force_age_ticks_p50", "num_force_age_ticks_p99", "num_force_age_ticks_max", "picture_delay_p50",
           "picture_delay_p99", "picture_delay_max", "num_ticks", "num_missed_ticks", "num_repeated_samples", "num_steps",
           "num_late_steps"]


def call(argil, *arguments, environment=None):
    done = subprocess.run([argil, *map(str, arguments)], capture_output=True, text=True, check=False,
                          env={**os.environ, **(environment or {})})
    return done.returncode, done.stdout + done.stderr


def quantiles(row, name, scale, digits, wanted=("p50", "p99", "max")):
    return " / ".join(f"{scale * row[f'{name}_{q}']:.{digits}f}" for q in wanted)


def write_intent(file, seconds):
    """A hand that comes to the haunch, presses and slides for 2 s of every 3, and goes on to the next mode."""
    rows = []
    for k in range(int(50 * seconds) + 1):
        t = k / 50
        mode = ("push", "wet", "push", "dry")[int(t / 3.0) % 4]
        depth = 0.0025 * (1.0 - math.cos(math.pi * min(t % 3.0, 2.0))) / 2.0 if t % 3.0 < 2.0 else 0.0
        slide = 0.003 * math.sin(2.0 * math.pi * t / 7.0)
        rows.append(f"{t:.2f},{-0.006 + slide:.6f},{-0.0394 + depth:.6f},0.062,0,0,0,1,{mode}\n")
    file.write_text("# argil-trace: 1\n# device: intent of a simulated hand\n# units: m\n"
                    "time_s,x_m,y_m,z_m,qx,qy,qz,qw,mode\n" + "".join(rows), encoding="utf-8")


@contextlib.contextmanager
def stand_in(device):
    """Name of the device that argil is given, the environment, and where its origin lies so that it meets the haunch."""
    if device not in STAND_INS:
        yield device, {}, []
        return
    program, place = STAND_INS[device]
    process = subprocess.Popen([ROOT / "tests" / "support" / program], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                               text=True)
    try:
        said = process.stdout.readline().split()[1]
        placed = [f"/trace/device_to_world/translation_m={list(place)}"]
        yield ((f"haply:127.0.0.1:{said}", {}, placed) if device == "haply" else
               (device, {"SPNAV_SOCKET": said}, placed))
    finally:
        process.stdin.close()
        process.wait()


def run_session(argil, folder, device, session, seconds):
    with stand_in(device) as (name, environment, placed):
        return record(argil, folder, (device, name, environment), placed, session, seconds)


def record(argil, folder, devices, placed, session, seconds):
    device, name, environment = devices
    rate, way = session.split(":")
    write_intent(folder / "intent.csv", seconds)
    physics, water, frame = RATES[rate]
    settings = [f"/haptics/physics_period_ticks={physics}", f"/haptics/water_period_ticks={water}",
                f"/haptics/frame_period_ticks={frame}", f"/haptics/between_frames={way}",
                f"/trace/file={folder / 'intent.csv'}"]
    sets = [word for setting in settings + placed for word in ("--set", setting)]
    live, again = folder / "live.h5", folder / "again.h5"
    code, said = call(argil, "live", SCENARIO, "--device", name, "--duration", seconds, "-o", live, "-q",
                      "--watch", folder / "watch.h5", *sets, environment=environment)
    if code != 0:
        raise SystemExit(f"{device}, {session}: code {code}: {said}")
    granted = "no: " + said.strip().split("warning: ")[-1] if "warning" in said else "yes"
    sets = [word for setting in settings[:-1] for word in ("--set", setting)]
    code, said = call(argil, "run", SCENARIO, "--trace", live, "-o", again, "-q", *sets)
    if code != 0:
        raise SystemExit(f"replay of {device}, {session}: code {code}: {said}")
    code, said = call(argil, "compare", live, again)
    row = {"device": device, "physics_Hz": rate, "between_frames": way, "replay": "equal" if code == 0 else said.splitlines()[0],
           "granted": granted}
    with h5py.File(live) as file:
        row["commit"] = file["provenance/build"][()].decode().splitlines()[1].removeprefix("commit ")
        row["end_hash"] = bytes(file["session"].attrs["end_hash"]).decode()[:16]
        for name in FIGURES:
            row[name] = float(file["timing"][name][-1])
        row["largest_force_N"] = float(abs(file["haptic/device_force"][:]).max())
    return row


def read_others(table, measured):
    """Rows of sessions that are not measured now."""
    with open(table, encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if tuple(row[key] for key in KEY) not in measured]
    for row in rows:
        row.update({name: float(row[name]) for name in FIGURES})
    return rows


def name_session(row):
    return f"{row['device']} | {row['physics_Hz']} Hz, `{row['between_frames']}`"


def share(row, what, of):
    return 100 * row[f"num_{what}"] / row[f"num_{of}"]


def between(values, digits):
    return f"{min(values):.{digits}f} to {max(values):.{digits}f} %"


def conclude(rows):
    """What holds of all sessions, and what was wanted and missed."""
    equal = sum(r["replay"] == "equal" for r in rows)
    late = {rate: [share(r, "late_steps", "steps") for r in rows if r["physics_Hz"] == rate] for rate in RATES}
    return [f"- **Conclude.** {equal} of {len(rows)} sessions are replayed to the same bits. The median [picture](force.md) is"
            f" {1e3 * min(r['picture_delay_p50'] for r in rows):.0f} to {1e3 * max(r['picture_delay_p50'] for r in rows):.0f} ms behind its force.",
            f"- **Missed.** A hand at 1 kHz loses {between([share(r, 'missed_ticks', 'ticks') for r in rows], 1)} of its ticks.",
            f"  Late steps: {', '.join(f'{between(shares, 1)} at {rate} Hz' for rate, shares in late.items() if shares)}."]


def write_readme(file, rows, options):
    us, ms = 1e6, 1e3
    ticks = sorted({int(r["num_ticks"]) for r in rows})
    lines = [
        "# How well a live session keeps its times", "",
        f"The dinosaur of `study_soft_dino`, {options.seconds:g} s a session, hand at 1 kHz. {os.cpu_count()} processors,"
        f" {platform.machine()}, Linux {platform.release()}.",
        "`scripts/live_table.py` writes this page, [live.csv](live.csv) has p99.9 besides. Each session is replayed in one thread.",
        "\"Equal\": `argil compare` finds no difference, forces and hashes included. Real-time priority of the hand's thread and",
        f"locked memory were granted: {', '.join(sorted({r['granted'] for r in rows}))}."
        f" Commit {', '.join(sorted({r['commit'] for r in rows}))}.",
        *([options.note] if options.note else []), "",
        *conclude(rows), "",
        "\"Woken late\": by the system, after the time that the hand asked for. A tick is missed when that is more than a period.",
        "\"Late steps\": the body was not ready when the hand had its next load. The hand went on against the last surface.",
        "The column before has the age of that surface. Times are p50 / p99 / max.", "",
        "| device | physics, between its steps | woken late [µs] | a tick's work [µs] | a step's work [ms] |"
        f" age of the surface [ticks] | missed of {' or '.join(map(str, ticks))} ticks | late steps | replay |",
        "|---|---|---|---|---|---|---|---|---|"]
    for r in rows:
        times = [quantiles(r, "wake_late", us, 0), quantiles(r, "tick_work", us, 0), quantiles(r, "step_work", ms, 2),
                 quantiles(r, "num_surface_age_ticks", 1, 0)]
        lines.append(f"| {name_session(r)} | {' | '.join(times)} |"
                     f" {r['num_missed_ticks']:.0f} | {r['num_late_steps']:.0f} of {r['num_steps']:.0f} | {r['replay']} |")
    file.write_text("\n".join(lines) + "\n", encoding="utf-8")


def write_force_page(file, rows):
    ms = 1e3
    lines = [
        "# What the hand's force rests on in a live session", "",
        "The sessions of [the page](README.md), by `scripts/live_table.py`. Times are p50 / p99 / max.",
        "- *Age of the sample*: by the device's clock, when the hand takes it.",
        "- *Age of the force*: since it was last found anew from contacts.",
        "- *Force to picture*: until the picture was in the file that others watch (`--watch`, a picture each 40 or 42 ticks).", "",
        "| device | physics, between its steps | age of the sample [ms] | ticks without a new sample |"
        " age of the force [ticks] | force to picture [ms] |", "|---|---|---|---|---|---|"]
    for r in rows:
        lines.append(f"| {name_session(r)} | {quantiles(r, 'sample_age', ms, 2)} | {r['num_repeated_samples']:.0f}"
                     f" | {quantiles(r, 'num_force_age_ticks', 1, 0)} | {quantiles(r, 'picture_delay', ms, 1)} |")
    file.write_text("\n".join(lines) + "\n", encoding="utf-8")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--build", type=Path, default=ROOT / "build")
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--devices", nargs="+", default=["simulated", *STAND_INS])
    parser.add_argument("--sessions", nargs="+", default=SESSIONS, choices=SESSIONS, metavar="RATE:WAY")
    parser.add_argument("--note", default="", help="a sentence about the machine for the page")
    parser.add_argument("--output", type=Path, default=ROOT / "results" / "live")
    options = parser.parse_args()
    table = options.output / "live.csv"
    measured = {(device, *session.split(":")) for device in options.devices for session in options.sessions}
    rows = read_others(table, measured) if table.is_file() else []
    for device in options.devices:
        for session in options.sessions:
            with tempfile.TemporaryDirectory() as folder:
                rows.append(run_session(options.build / "bin" / "argil", Path(folder), device, session, options.seconds))
            print(rows[-1])
    devices = list(dict.fromkeys(row["device"] for row in rows))
    rows.sort(key=lambda row: (devices.index(row["device"]), SESSIONS.index(f"{row['physics_Hz']}:{row['between_frames']}")))
    options.output.mkdir(parents=True, exist_ok=True)
    with open(table, "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, rows[0].keys())
        writer.writeheader()
        writer.writerows(rows)
    write_readme(options.output / "README.md", rows, options)
    write_force_page(options.output / "force.md", rows)


if __name__ == "__main__":
    main()
