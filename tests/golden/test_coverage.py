#!/usr/bin/python3
"""Every word that a scenario may choose from is used by a golden run, but for those named here.

Usage: test_coverage.py ARGIL
"""
import itertools
import json
import subprocess
import sys
from pathlib import Path

GOLDEN = Path(__file__).resolve().parent
ELSEWHERE = {  # point by point in unit tests
    "/preset": {"none"},
    "/body/surface/fit": {"surface", "enclose"},  # what /body/shape/fit does
    "/output/frame_precision": {"picture"},  # tests/unit/output/test_frame_writer.cpp, test_pack.cpp
    "/body/cells/remesh": {"never"},  # tests/unit/run/test_new_cells.py
    "/body/shape/kind": {"cylinder", "box", "dinosaur", "figure"},
    "/material/effective_medium/scheme": {"dilute_strain", "voigt", "reuss", "hs_lower", "hs_upper"},
    "/tool/shape/kind": {"mesh"},
    "/trace/default_mode": {"pull", "wet", "dry"},
    # How a recording is read: tests/unit/device/test_recording_units.cpp.
    "/trace/time_unit": {"s", "ms", "us", "ns"},
    "/trace/length_unit": {"m", "cm", "mm", "um"},
    "/trace/quaternion_order": {"wxyz", "xyzw"},
    "/trace/angle_order": {"vector", *map("".join, itertools.permutations("xyz")), *map("".join, itertools.permutations("XYZ"))},
    "/trace/angle_unit": {"rad", "deg"},
    "/trace/button/mode": {"push", "pull", "wet", "dry"},
}


def list_choices(schema, pointer=""):
    if "enum" in schema:
        yield pointer, set(schema["enum"])
    for key, below in schema.get("properties", {}).items():
        yield from list_choices(below, f"{pointer}/{key}")


def look_up(scenario, pointer):
    for key in pointer.strip("/").split("/"):
        scenario = scenario.get(key, {})
    return scenario if isinstance(scenario, str) else None


def main():
    def ask(*command):
        return json.loads(subprocess.run([sys.argv[1], *command], capture_output=True, text=True, check=True).stdout)

    plain = ask("show", GOLDEN / "ball.json")
    settings = [setting.split("=", 1) for run in json.loads((GOLDEN / "runs.json").read_text()).values() for setting in run]
    missing = 0
    for pointer, words in list_choices(ask("schema")):
        used = {look_up(plain, pointer)} | {value for key, value in settings if key == pointer}
        left = words - used - ELSEWHERE.get(pointer, set())
        if left:
            print(f"no golden run has {pointer} {', '.join(sorted(left))}")
            missing += len(left)
    return missing > 0


if __name__ == "__main__":
    sys.exit(main())
