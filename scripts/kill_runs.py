#!/usr/bin/python3
"""Kills runs with SIGKILL at random moments, resumes them, and compares each with one that was left alone: the file must
open after every kill and the end must have the same bits. Prints a line a run; exit code 1 when one is different.

A tenth of the kills is of runs of many chunks with checkpoints far apart, each when its own progress bar has just said how
many ticks are done: of those all must be on disk but what is buffered by design, less than a chunk of each series and no
frame.

Usage: kill_runs.py ARGIL [--kills 200] [--seed 1] [--ticks 1200] [--long-ticks 20000]
"""
import argparse
import json
import math
import os
import pty
import random
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import h5py

SCENE = {
    "about": "a ball rubbed by a tool that presses, wets, presses and dries",
    "body": {"shape": {"kind": "sphere", "size_m": 0.04, "target_tets": 600, "skin_triangles": 300},
             "fixed": [{"kind": "half_space", "normal": [0, 0, 1], "offset_m": 0.006}]},
    "material": {"youngs_modulus_Pa": 1e5, "poissons_ratio": 0.3, "plasticity": {"yield": 0.02, "creep_per_s": 20, "max": 0.5},
                 "moisture": {"yield_law": "log_linear", "saturated_yield_ratio": 0.1},
                 "clay_kernel": {"k1_per_m": 2, "k2_per_m": 60, "radius_m": 0.03}},
    "water": {"diffusivity_m2_per_s": 1e-5, "wetting_flux_kg_per_m2_s": 50, "drying_flux_kg_per_m2_s": 50},
    "tool": {"shape": {"kind": "sphere", "radius_m": 0.006, "subdivisions": 2}},
    "contact": {"law": "pairs", "vertex_face_stiffness_N_per_m": 400, "edge_edge_stiffness_N_per_m": 400, "friction": 0.3},
    "dynamics": {"rayleigh_stiffness_s": 0.001},
    "haptics": {"frame_period_ticks": 56},
    "output": {"checkpoint_period_ticks": 40},
    "trace": {"file": "rub.csv"},
}

# What a run may carry from tick to tick in other places.
VARIANTS = {
    "as it is": [],
    "paper's rates, hold": ["/haptics/physics_period_ticks=14", "/haptics/water_period_ticks=14"],
    "compliant": ["/haptics/physics_period_ticks=14", "/haptics/water_period_ticks=14",
                  "/haptics/between_frames=compliant"],
    "re_evaluate, passivity": ["/haptics/physics_period_ticks=7", "/haptics/water_period_ticks=14",
                               "/haptics/between_frames=re_evaluate", "/haptics/passivity=time_domain"],
    "bdf2, Cholesky": ["/dynamics/integrator=bdf2", "/dynamics/solver/kind=cholesky"],
    "Newmark, Newton, neo-Hookean": ["/dynamics/integrator=newmark", "/dynamics/iteration=newton",
                                     "/dynamics/model=neo_hookean"],
    "nodal pressure, swelling": ["/dynamics/element=p1_nodal", "/water/swelling=0.02", "/water/adds_mass=true"],
    "skin, rest": ["/contact/surface=skin", "/dynamics/rest_speed_m_per_s=1e-4"],
    "a hand that yields and trembles": ["/hand/kind=simulated", "/hand/tremor_m=2e-5", "/hand/reaction_delay_s=0.05"],
    "what the hand feels, a full run beside": ["/fidelity/mode=check"],
    "implicit water, D(S)": ["/water/diffusion=implicit", "/water/diffusivity_exponent=2"],
}


# Runs that lose what is not yet on disk: rows that a series gathers before it is flushed (src/output/schema.h), and the rates.
HAPTIC_CHUNK, PHYSICS_CHUNK, PHYSICS_PERIOD, FRAME_PERIOD = 1024, 256, 7, 560
LONG = [f"/haptics/physics_period_ticks={PHYSICS_PERIOD}", f"/haptics/water_period_ticks={PHYSICS_PERIOD}",
        f"/haptics/frame_period_ticks={FRAME_PERIOD}", "/output/checkpoint_period_ticks=7000", "/trace/file=long.csv"]


def write_rub(file, ticks):
    lines = ["t,x,y,z,mode"]
    for k in range(ticks + 1):
        share = 0.5 - 0.5 * math.cos(6 * math.pi * k / ticks)
        mode = ["push", "wet", "push", "dry"][min(3, 4 * k // ticks)]
        lines.append(f"{k / 1000},{0.001 + 0.004 * k / ticks},0.0007,{0.048 - share * 0.0045},{mode}")
    file.write_text("\n".join(lines) + "\n")


class Killer:
    def __init__(self, argil, folder, seed):
        self.argil, self.folder, self.random = argil, folder, random.Random(seed)

    def command(self, name, settings):
        sets = [word for setting in settings for word in ("--set", setting)]
        return [self.argil, "run", "scene.json", "-q", "-o", name, *sets]

    def run(self, arguments):
        done = subprocess.run(arguments, cwd=self.folder, capture_output=True, text=True)
        return done.returncode, done.stdout + done.stderr

    def kill(self, command, longest):
        """Starts a run and kills it after a random time. True when it was still running."""
        with subprocess.Popen(command, cwd=self.folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as run:
            time.sleep(self.random.uniform(0.0, longest))
            run.kill()
            return run.wait() != 0

    def kill_when_told(self, command, told_times):
        """Starts a run on a terminal and kills it when its progress bar was drawn so often. Returns how many ticks, as a share,
        it had then said to be done, None when it had ended."""
        screen, terminal = pty.openpty()
        said = 0.0
        with subprocess.Popen(command, cwd=self.folder, stdout=terminal, stderr=terminal) as run:
            os.close(terminal)
            while told_times > 0:
                try:
                    drawn = re.findall(r"([\d.]+) %", os.read(screen, 4096).decode(errors="replace"))
                except OSError:  # the other end is closed
                    break
                told_times -= len(drawn)
                said = max([said, *(float(share) - 0.05 for share in drawn)])  # its digits are rounded
            run.kill()
            has_ended = run.wait() == 0
        os.close(screen)
        return None if has_ended else said / 100

    def try_loss(self, kills, ticks):
        """Kills long runs, one time each. Returns how many lost more than a chunk or ended with other bits."""
        begin = time.monotonic()
        code, text = self.run(self.command("long.h5", LONG))
        if code != 0:
            raise RuntimeError(f"long run: {text}")
        told = max(1, int((time.monotonic() - begin) / 0.2))
        num_bad = 0
        while kills > 0:
            (self.folder / "lost.h5").unlink(missing_ok=True)
            command = [word for word in self.command("lost.h5", LONG) if word != "-q"]
            share = self.kill_when_told(command, self.random.randint(1, told))
            if share is None:
                continue
            kills -= 1
            done = int(share * ticks)
            self.look("lost.h5")
            with h5py.File(self.folder / "lost.h5") as file:
                rows, steps, frames = len(file["haptic/tick"]), len(file["physics/tick"]), len(file["frames"])
            wanted = [done - (HAPTIC_CHUNK - 1), done // PHYSICS_PERIOD - (PHYSICS_CHUNK - 1), 1 + done // FRAME_PERIOD]
            is_lost = any(found < least for found, least in zip([rows, steps, frames], wanted))
            code, text = self.run([*self.command("lost.h5", LONG), "--resume"])
            is_same = code == 0 and self.run([self.argil, "compare", "long.h5", "lost.h5"])[0] == 0
            num_bad += is_lost or not is_same
            print(f"{'same bits' if is_same else 'DIFFERENT'}, {'LOST MORE THAN A CHUNK' if is_lost else 'at most a chunk lost'}  "
                  f"many chunks: killed after {done} ticks; on disk {rows} ticks, {steps} steps, {frames} frames {text.strip()}",
                  flush=True)
        return num_bad

    def look(self, name):
        """(opens without argil, last tick); a kill before the first flush leaves no file."""
        if not (self.folder / name).exists():
            return True, None
        journal = self.folder / f"{name}.journal"
        needs_argil = journal.exists() and journal.stat().st_size > 0
        code, text = self.run([self.argil, "info", name])
        if code != 0:
            raise RuntimeError(f"argil info {name}: {text}")
        with h5py.File(self.folder / name) as file:
            ticks = file["haptic/tick"][()]
            state = file["checkpoint/tick"][()] if "checkpoint" in file else [[0]]
            if len(ticks) and not (ticks == range(1, len(ticks) + 1)).all():
                raise RuntimeError(f"{name}: ticks have gaps")
            if len(ticks) < state[0][0]:
                raise RuntimeError(f"{name}: {len(ticks)} ticks, but a checkpoint of tick {state[0][0]}")
            return not needs_argil, int(len(ticks))

    def try_variant(self, variant, kills):
        """Runs with one to three kills each until there were `kills`. Returns how many runs differed."""
        settings, num_different = VARIANTS[variant], 0
        begin = time.monotonic()
        code, text = self.run(self.command("whole.h5", settings))
        if code != 0:
            raise RuntimeError(f"{variant}: {text}")
        longest = time.monotonic() - begin
        while kills > 0:
            (self.folder / "killed.h5").unlink(missing_ok=True)
            left = []
            for _ in range(min(kills, self.random.randint(1, 3))):
                if self.kill([*self.command("killed.h5", settings), "--resume"], longest):
                    left.append(self.look("killed.h5"))
                    kills -= 1
            if not left:
                continue
            code, text = self.run([*self.command("killed.h5", settings), "--resume"])
            same = code == 0 and self.run([self.argil, "compare", "whole.h5", "killed.h5"])[0] == 0
            num_different += not same
            places = ", ".join("no file yet" if tick is None else f"{tick}{'' if opens else ' (journal)'}"
                               for opens, tick in left)
            print(f"{'same bits' if same else 'DIFFERENT'}  {variant}: killed with ticks on disk: {places} {text.strip()}",
                  flush=True)
        return num_different


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("argil")
    parser.add_argument("--kills", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--ticks", type=int, default=1200)
    parser.add_argument("--long-ticks", type=int, default=20000)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as temp:
        folder = Path(temp)
        write_rub(folder / "rub.csv", options.ticks)
        write_rub(folder / "long.csv", options.long_ticks)
        (folder / "scene.json").write_text(json.dumps(SCENE))
        killer = Killer(str(Path(options.argil).resolve()), folder, options.seed)
        long_kills = -(-options.kills // 10)
        different = killer.try_loss(long_kills, options.long_ticks)
        share, more = divmod(options.kills - long_kills, len(VARIANTS))
        different += sum(killer.try_variant(variant, share + (i < more)) for i, variant in enumerate(VARIANTS))
    print(f"{options.kills} kills, {different} runs with other bits or more than a chunk lost")
    return different > 0


if __name__ == "__main__":
    sys.exit(main())
