#!/usr/bin/python3
"""Is `argil run --accuracy` kept, and what does it cost? The force of scenes that ask for 5 and 2 %, with all passes counted, against
that on cells that are 1.8 times as small; and beside it four-node tets of one size.

Usage: accuracy_table.py ARGIL [-o FILE.csv] [--scenes NAME …]      writes results/accuracy/accuracy.csv
"""
import argparse
import json
import os
import subprocess
import tempfile
from pathlib import Path

import h5py
import numpy as np

from table_file import write_table

ROOT = Path(__file__).resolve().parent.parent
WANTED = (0.05, 0.02)
FLOOR = 0.01  # [N] of the error that never counts
FINER = 1.8  # cells of the reference
EVEN = (2500, 10000, 40000)  # tets of one size
PRESSED = ["/contact/law=pressure"]
FIRM = ["/material/plasticity/enabled=false", "/material/clay_kernel/form=off"]


def press(shape, tool, path, friction=0.0, **material):
    """A scene of its own: `path` is t, x, y, z [s, m] of the tool."""
    firm = {"youngs_modulus_Pa": 1e5, "poissons_ratio": 0.3, "plasticity": {"enabled": False}, "clay_kernel": {"form": "off"}}
    floor = {"kind": "half_space", "normal": [0, 0, 1], "offset_m": 0.002}
    return {"about": "A press.", "body": {"shape": {"skin_triangles": 0, **shape}, "fixed": [floor]}, "material": {**firm, **material},
            "tool": {"shape": tool}, "contact": {"law": "pressure", "friction": friction}, "dynamics": {"rayleigh_stiffness_s": 0.001},
            "trace": {"file": "path.csv"}, "path": path}


def go_down(top, depth, x=0.0012, y=0.0007, seconds=0.15):
    return [(0, x, y, top + 0.0003), (seconds, x, y, top - depth), (seconds + 0.03, x, y, top - depth)]


BALL = {"kind": "sphere", "radius_m": 0.006}
LED = [(0, -0.004, 0.001, 0.0463), (0.1, -0.004, 0.001, 0.0452), (0.3, 0.004, 0.001, 0.0452)]  # over a block of 40 mm
SCENES = {
    "light press": ("study_light_press.json", PRESSED),
    "slide": ("study_slide.json", PRESSED),
    "bend": ("study_deep_bend.json", PRESSED),
    "wet press": ("study_wet_press.json", [*PRESSED, "/body/shape/skin_triangles=0", "/contact/surface=cage"]),
    "dinosaur": ("study_soft_dino.json", ["/dynamics/model=hencky", *FIRM, "/trace/duration_s=0.9"]),
    "ball on a block": press({"kind": "box", "size_m": 0.04}, BALL, go_down(0.046, 0.0006)),
    "ball on a ball": press({"kind": "sphere", "size_m": 0.04}, BALL, go_down(0.046, 0.001)),
    "tip on a block": press({"kind": "box", "size_m": 0.03}, {"kind": "sphere", "radius_m": 0.002}, go_down(0.032, 0.0005)),
    "block of ν = 0.49": press({"kind": "box", "size_m": 0.04}, BALL, go_down(0.046, 0.0006), poissons_ratio=0.49),
    "clay of 15 kPa": press({"kind": "box", "size_m": 0.03}, {"kind": "sphere", "radius_m": 0.004}, go_down(0.034, 0.001),
                            youngs_modulus_Pa=1e6, plasticity={"strength_Pa": 15e3}, clay_kernel={"form": "off"}),
    # None of these was looked at while the choice was made.
    "demonstration, dry": ("demo_dino_dry.json", ["/trace/duration_s=0.9"]),
    "demonstration, soft": ("study_soft_dino.json", ["/trace/duration_s=0.9"]),
    "figure": ("demo_figure_push_pull.json", ["/trace/duration_s=1.2"]),
    "stylus on a block": press({"kind": "box", "size_m": 0.03}, {"kind": "stylus", "radius_m": 0.004, "tip_radius_m": 0.0015, "length_m": 0.06},
                               go_down(0.0315, 0.0006)),
    "capsule across a cylinder": press({"kind": "cylinder", "size_m": 0.04}, {"kind": "capsule", "radius_m": 0.005, "length_m": 0.02},
                                       go_down(0.045, 0.0008), friction=0.3),
    "ball led over a block": press({"kind": "box", "size_m": 0.04}, BALL, LED),
    "the same with friction": press({"kind": "box", "size_m": 0.04}, BALL, LED, friction=0.4),
    "edge of a block": press({"kind": "box", "size_m": 0.03}, BALL, go_down(0.036, 0.001, x=0.0148, y=0.0007)),
    "stiff clay, deep": press({"kind": "box", "size_m": 0.03}, {"kind": "sphere", "radius_m": 0.004}, go_down(0.034, 0.002, seconds=0.4),
                              youngs_modulus_Pa=5e6, plasticity={"strength_Pa": 25e3}, clay_kernel={"form": "off"}),
    "clay that stiffens with speed": press({"kind": "box", "size_m": 0.03}, {"kind": "sphere", "radius_m": 0.004}, go_down(0.034, 0.001),
                                           youngs_modulus_Pa=1e6, clay_kernel={"form": "off"},
                                           plasticity={"strength_Pa": 15e3, "rate_growth_per_decade": 0.1}),
}


def write_scene(folder, scene):
    if isinstance(scene, tuple):
        return ROOT / "scenarios" / scene[0], scene[1]
    scene = dict(scene)
    t, *places = np.array(scene.pop("path")).T
    ticks = np.arange(0, t[-1], 0.001)
    way = np.column_stack([ticks, *(np.interp(ticks, t, place) for place in places)])
    np.savetxt(folder / "path.csv", way, delimiter=",", header="t,x,y,z", comments="")
    (folder / "scene.json").write_text(json.dumps(scene), encoding="utf-8")
    return folder / "scene.json", []


class Runner:
    def __init__(self, argil, folder, scenario, settings):
        self.command = [argil, "run", scenario, "-q", "-o", folder / "run.h5"]
        self.settings, self.result = settings, folder / "run.h5"

    def run(self, *settings, accuracy=None):
        """Force, number of tets, resolved scenario, seconds of processor."""
        self.result.unlink(missing_ok=True)
        words = [word for setting in [*self.settings, *settings] for word in ("--set", setting)]
        before = os.times()
        subprocess.run([*self.command, *words, *(["--accuracy", str(accuracy)] if accuracy else [])], check=True)
        after = os.times()
        with h5py.File(self.result) as file:
            estimate = file["accuracy"].attrs["estimated"] if accuracy else np.nan
            return (file["haptic/force"][:], len(file["mesh/tets"]), json.loads(file["provenance/scenario"][()]),
                    after.children_user + after.children_system - before.children_user - before.children_system, estimate)


def find_error(force, reference):
    touching = (np.linalg.norm(force, axis=1) > 0) | (np.linalg.norm(reference, axis=1) > 0)
    off = np.sqrt(((force - reference)**2).sum(axis=1)[touching].mean())
    size = np.sqrt((reference**2).sum(axis=1)[touching].mean())
    return off / size, FLOOR / size


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", maxsplit=1)[0])
    parser.add_argument("argil", type=Path)
    parser.add_argument("-o", "--output", type=Path, default=ROOT / "results/accuracy/accuracy.csv", metavar="FILE")
    parser.add_argument("--scenes", nargs="+", choices=SCENES, default=list(SCENES), metavar="NAME")
    options = parser.parse_args()
    rows = []
    for name in options.scenes:
        with tempfile.TemporaryDirectory() as folder:
            runner = Runner(options.argil.resolve(), Path(folder), *write_scene(Path(folder), SCENES[name]))
            asked = [(wanted, *runner.run(accuracy=wanted)) for wanted in WANTED]
            body = asked[-1][3]["body"]
            reference = runner.run("/dynamics/element=p2", "/body/cells/kind=graded",
                                   f"/body/cells/near_tool_m={body['cells']['near_tool_m'] / FINER}",
                                   f"/body/shape/target_tets={int(FINER * body['shape']['target_tets'])}")
            for wanted, force, tets, _, seconds, estimate in asked:
                error, floor = find_error(force, reference[0])
                rows.append([name, f"{wanted:g}", tets, f"{error:.4f}", f"{estimate:.4f}", f"{floor:.4f}", f"{seconds:.1f}"])
                print(*rows[-1], flush=True)
            for number in EVEN:
                force, tets, _, seconds, _ = runner.run("/body/cells/kind=even", "/dynamics/element=p1", "/dynamics/allow_locking=true",
                                                        f"/body/shape/target_tets={number}")
                rows.append([name, "even", tets, f"{find_error(force, reference[0])[0]:.4f}", "", "", f"{seconds:.1f}"])
                print(*rows[-1], flush=True)
            rows.append([name, "reference", reference[1], "", "", "", f"{reference[3]:.1f}"])
            print(*rows[-1], flush=True)
    write_table(options.output, ["scene", "wanted", "tets", "error", "estimate", "floor", "processor_s"], rows)


if __name__ == "__main__":
    main()
