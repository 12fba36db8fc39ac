#!/usr/bin/python3
"""Writes the figures of a run on dry clay beside runs on wet clay: forces, water, and which cause lowers the force.

Usage: summarise.py DRY.h5 WET.h5 [ELASTICITY_ONLY.h5 YIELD_ONLY.h5] [--hands DRY.h5 WET.h5] [--command WORDS] [-o run.json]

The parts are fractions of the dry value: how much lower a force is when both causes act, and when only one does. What
both lower beyond the sum of the two parts is their interaction: negative where each takes from what the other left.
Of hands that give way: how deep they come, and with what force.
"""
import argparse
import json
from pathlib import Path

import argil_plot as ap
from argil_plot import np
from plot_give import read_way
from argil.plot.water_figure import read_ledger, rest_volumes

NEAR_TOOL = 0.006  # [m] from the tool's centre: what counts as clay under the tool


def read_text(result, name):
    return result["provenance"][name][()].decode()


def saturation_near_tool(result, time):
    """Mean saturation of the tets near the tool, by volume, in the frame nearest to `time` [s]; None if none is."""
    frame = min(ap.frames_of(result), key=lambda frame: abs(frame.attrs["time"] - time))
    tool = result["haptic/tool_position"][np.argmin(np.abs(result["haptic/time"][:] - frame.attrs["time"]))]
    cells = ap.cells_of(result, frame)
    centres = frame["position"][:][cells["tets"][:]].mean(axis=1)
    volume = rest_volumes(cells) * (np.linalg.norm(centres - tool, axis=1) < NEAR_TOOL)
    return float(frame["saturation"][:] @ volume / volume.sum()) if volume.sum() > 0.0 else None


def summarise(file):
    """Figures of one run, each name with its unit. Impulse: the integral of the force's size over the push."""
    with ap.open_result(file) as result:
        time, force, deforming = result["haptic/time"][:], ap.force_norm(result), ap.is_deforming(result)
        push, ledger = force * deforming, read_ledger(result)
        if not push.any():
            ap.refuse(f"{file}: the tool never pushes the body, so there is no force to compare")
        build = dict(line.split(" ", 1) for line in read_text(result, "build").splitlines() if " " in line)
        return {
            "peak_N": push.max(), "impulse_N_s": push.sum() * result.attrs["haptic_period_s"],
            "peak_of_wetting_N": (force * ~deforming).max(),
            "peak_at_s": time[np.argmax(push)] - time[np.argmax(deforming)],
            "saturation_near_tool_at_first_touch": saturation_near_tool(result, time[np.argmax(push > 0.0)]),
            "saturation_near_tool_at_peak": saturation_near_tool(result, time[np.argmax(push)]),
            "water_added_kg": ledger.added[-1], "ledger_error": ledger.error().max(),
            "commit": build.get("commit", ""), "compiler": build.get("compiler", ""),
            "scenario_sha256": read_text(result, "scenario_sha256"), "trace_sha256": read_text(result, "trace_sha256"),
        }


def split(dry, wet, elasticity, yielding):
    """By which fraction of the dry value both causes, and each alone, lower a force; and how they interact."""
    both, by_elasticity, by_yield = (1.0 - value / dry for value in (wet, elasticity, yielding))
    return {"lower_by": both, "elasticity_alone": by_elasticity, "yield_alone": by_yield,
            "interaction": both - by_elasticity - by_yield}


def give(motion, hands):
    """Greatest depth of the tool [m], and force there is at most, for the same motion and for the same hand."""
    def of(file):
        _, force, depth, _ = read_way(file)
        return {"deepest_m": float(np.nanmax(depth)), "largest_mean_N": float(force.max())}

    return {way: {name: of(file) for name, file in zip(("dry", "wet"), pair)}
            for way, pair in (("same_motion", motion), ("same_hand", hands))}


def rounded(value):
    """Six digits are more than a hand feels; the ledger's error and the hashes stay as they are."""
    if isinstance(value, dict):
        return {key: rounded(item) for key, item in value.items()}
    return float(f"{value:.6g}") if isinstance(value, (float, np.floating)) else value


def without_commits(figures):
    return {**figures, "runs": {name: {key: value for key, value in run.items() if key != "commit"}
                                for name, run in figures["runs"].items()}}


def write(figures, path):
    """A file that holds these figures already stays: its commit is the one that first gave them."""
    if path.exists() and without_commits(json.loads(path.read_text())) == without_commits(figures):
        return
    path.write_text(json.dumps(figures, indent=2) + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("files", nargs="+", metavar="RESULT.h5", help="dry, wet, and both single causes or neither")
    parser.add_argument("--hands", nargs=2, metavar="HAND.h5", help="dry and wet, of a hand that gives way")
    parser.add_argument("--command", default="", help="what made the results, to be written down")
    parser.add_argument("-o", "--output", default="run.json", metavar="FILE.json", help="default: %(default)s")
    options = parser.parse_args()
    if len(options.files) not in (2, 4):
        ap.refuse(f"{len(options.files)} files: give dry and wet, or dry, wet, elasticity only and yield only")
    runs = [summarise(file) for file in options.files]
    figures = {"command": options.command, "runs": dict(zip((Path(file).stem for file in options.files), runs))}
    for name in ("peak_N", "impulse_N_s"):
        values = [run[name] for run in runs]
        figures[name.split("_")[0]] = (split(*values) if len(values) == 4
                                       else {"lower_by": 1.0 - values[1] / values[0]})
    if options.hands:
        figures["give"] = give(options.files[:2], options.hands)
    write(rounded(figures), Path(options.output))
    print(options.output)


if __name__ == "__main__":
    main()
