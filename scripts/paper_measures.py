#!/usr/bin/python3
"""What can be measured of the questions that the paper asked its users.

Usage: paper_measures.py ARGIL --works DRY.h5 WET.h5 --delays HOLD.h5 … [-o STEM]   → STEM.json, STEM.png, STEM.pdf

Force on or off: the work that the hand does against the force; with the force off it is nothing. Delay: age of the force
that the hand feels while it touches. Realism: strength of the clay against its water, beside measured clays, each over
its strength at the liquid limit; the water's axis is the liquidity index, which the law takes for the saturation.
"""
import argparse
import json
import subprocess
from pathlib import Path

import argil_plot as ap
from argil_plot import np, plt

SCENARIO = Path(__file__).resolve().parent.parent / "scenarios/demo_dino_wet.json"
PLASTIC_OVER_LIQUID_LIMIT = 0.5  # of water contents; Cochin clay's law is given in w/w_L, and needs it


def work_of_hand(file):
    """∫ −F·dx [J] over the pressing part: what the hand gives."""
    with ap.open_result(file) as result:
        steps = np.diff(result["haptic/tool_position"][:], axis=0)
        force = result["haptic/force"][:]
        mean = 0.5 * (force[1:] + force[:-1])
        return float(-(np.einsum("ij,ij->i", mean, steps) * ap.is_deforming(result)[1:]).sum())


def delay(file):
    """Mean and worst age [s] of the force while the tool touches."""
    with ap.open_result(file) as result:
        touching = result["haptic/num_contacts"][:] > 0
        age = result["haptic/force_age"][:][touching] * result.attrs["haptic_period_s"]
        return {"mean_s": float(age.mean()), "worst_s": float(age.max())}


def strength(argil, saturation):
    """Undrained shear strength [Pa] = yield strain · 2G/√2, both as the scenario's clay has them at this water."""
    show = subprocess.run([argil, "show", SCENARIO], capture_output=True, text=True, check=True).stdout
    scene = json.loads(show)
    material, porosity = scene["material"], scene["water"]["porosity"]
    medium = material["effective_medium"]
    cases = [{"youngs_modulus_Pa": material["youngs_modulus_Pa"], "poissons_ratio": material["poissons_ratio"],
              "fluid_bulk_modulus_Pa": 0.0, "fluid_shear_modulus_Pa": 0.0, "phi": porosity * float(s),
              "scheme": medium["scheme"], "aspect": medium["aspect"]} for s in saturation]
    answer = subprocess.run([argil, "probe", "effective_medium"], input=json.dumps({"cases": cases}),
                            capture_output=True, text=True, check=True).stdout
    shear = np.array([row["shear_modulus_Pa"] for row in json.loads(answer)["results"]])
    yielding = material["plasticity"]["yield"] * material["moisture"]["saturated_yield_ratio"] ** saturation
    return yielding * 2.0 * shear / np.sqrt(2.0)


def draw_strength(argil):
    """The figure, and the rms distance of log10 of the strength from each measured clay."""
    index = np.linspace(0.0, 1.0, 41)
    ours = strength(argil, index)
    share = PLASTIC_OVER_LIQUID_LIMIT + (1.0 - PLASTIC_OVER_LIQUID_LIMIT) * index
    measured = {"641 tests on 101 soils (Vardanega & Haigh 2014)": 35.0 ** (1.0 - index),
                "remoulded (Kayabali & Tufenkci 2010)": (180.0 / 2.3) ** (1.0 - index),
                f"Cochin clay, w_P/w_L = {PLASTIC_OVER_LIQUID_LIMIT:g}": 10.0 ** (2.585 * (1.0 - share))}
    figure, axes = plt.subplots(figsize=(120 * ap.MILLIMETRES, 75 * ap.MILLIMETRES))
    axes.semilogy(index, ours / ours[-1], color=ap.COLOURS[0], label="argil, the demonstration's clay")
    distances = {}
    for number, (name, values) in enumerate(measured.items(), start=1):
        axes.semilogy(index, values, color=ap.COLOURS[number], linestyle=ap.DASHES[number], label=name)
        distances[name] = float(np.sqrt(np.mean(np.log10(ours / ours[-1] / values) ** 2)))
    axes.set_xlabel("water: liquidity index, for argil saturation [–]")
    axes.set_ylabel("strength over that at the liquid limit [–]")
    axes.legend()
    return figure, distances


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("argil")
    parser.add_argument("--works", nargs=2, required=True, metavar=("DRY.h5", "WET.h5"))
    parser.add_argument("--delays", nargs="+", required=True, metavar="RESULT.h5")
    parser.add_argument("-o", "--output", default="measures", metavar="STEM")
    options = parser.parse_args()
    figure, distances = draw_strength(options.argil)
    figures = {"work_of_hand_J": {Path(file).stem: work_of_hand(file) for file in options.works},
               "force_age": {Path(file).stem: delay(file) for file in options.delays},
               "rms_log10_distance_from_measured_clay": distances}
    Path(f"{options.output}.json").write_text(json.dumps(figures, indent=2) + "\n", encoding="utf-8")
    print(f"{options.output}.json")
    ap.save(figure, options.output)


if __name__ == "__main__":
    main()
