#!/usr/bin/python3
"""What can be measured of the questions that the paper asked its users.

Usage: paper_measures.py ARGIL --works DRY.h5 WET.h5 --hands ON.h5 OFF.h5 --delays HOLD.h5 … [-o STEM]
       → STEM.json, STEM.png, STEM.pdf

Force on or off: what a hand that gives way gives the clay with the force and without; and the work that a hand
which is put along its trace does against it: minus the sum of the device's force times the tool's step, over the ticks that
push. Delay: age of the force that the hand feels while it touches, and its lag behind the picture. Realism:
strength of the clay against its water, beside measured clays, each over its strength at the liquid limit, and what the
clay has in pascals beside what was measured. Saturation 0 is the water with which clay is modelled, 1 that of the liquid limit.
"""
import argparse
import json
import subprocess
from pathlib import Path

import argil_plot as ap
from argil_plot import np, plt

SCENARIO = Path(__file__).resolve().parent.parent / "scenarios/demo_dino_wet.json"
PLASTIC_OVER_LIQUID_LIMIT = 0.5  # of water contents; Cochin clay's law is given in w/w_L, the others' in the liquidity index
MODELLED = 0.6  # water content over that at the liquid limit, where the saturation is 0
DAMP_WATER = 0.21  # water of a pottery body when it is modelled, of the damp weight: 19.5 to 22.5 % measured


def cochin_strength(water):
    """Of Cochin clay [kPa], at a water content over that at the liquid limit: log10 c_u = 2.720 − 2.585 w/w_L."""
    return 10.0 ** (2.720 - 2.585 * water)


def share_of(saturation):
    """Water content over that at the liquid limit."""
    return MODELLED + (1.0 - MODELLED) * saturation


def index_of(share):
    """Liquidity index."""
    return (share - PLASTIC_OVER_LIQUID_LIMIT) / (1.0 - PLASTIC_OVER_LIQUID_LIMIT)


SOFTER_OR_STIFFER = "clays, at half strength 2 to 0.5 % of strain"
MEASURED = (  # lowest, highest, of what: for the rows of compare_sizes
    (cochin_strength(MODELLED), 2.3 * (180.0 / 2.3) ** (1.0 - index_of(MODELLED)), "Cochin clay; Kayabali & Tufenkci 2010"),
    (cochin_strength(1.0), 2.3, "Cochin clay; Kayabali & Tufenkci 2010"),
    (50.0, 200.0, SOFTER_OR_STIFFER), (50.0, 200.0, SOFTER_OR_STIFFER),
    (0.5, 3.8, "plastic clay"), (0.5, 3.8, "plastic clay"), (0.549, 0.665, "Cochin clay of 20 to 10 kPa"))


def touch(file):
    """Of the pressing ticks: what the hand gave against the force that the device gave it, what the contact gave
    the body [J], and how deep the body is dented at the end [m]."""
    with ap.open_result(file) as result:
        frames = ap.frames_of(result)
        name = "skin_position" if "skin_position" in frames[0] else "position"
        moved = np.linalg.norm(frames[-1][name][:] - frames[0][name][:], axis=1)
        given = np.diff(result["haptic/port_energy"][:], prepend=0.0)  # by the device to the hand
        return {"work_of_hand_J": float(-given[ap.is_deforming(result)].sum()),
                "contact_work_J": float(result["physics/contact_work"][-1]), "dent_m": float(moved.max())}


def delay(file):
    """Mean and worst [s], while the tool touches: age of the force, and how far the moment that it is of lies from that
    of the last picture there is, when each physics step is drawn and when each frame of the file is."""
    with ap.open_result(file) as result:
        touching = result["haptic/num_contacts"][:] > 0
        tick, age = (result[f"haptic/{name}"][:][touching] for name in ("tick", "force_age"))
        frames = np.array([frame.attrs["tick"] for frame in ap.frames_of(result)])
        lags = {"force_age": age, "lag_of_step": lag(tick - age, tick, result["physics/tick"][:]),
                "lag_of_frame": lag(tick - age, tick, frames)}
        period = result.attrs["haptic_period_s"]
        return {name: {"mean_s": float(period * ticks.mean()), "worst_s": float(period * ticks.max())}
                for name, ticks in lags.items()}


def lag(felt, now, pictures):
    """Ticks between the moments that are felt and those seen: of the last picture by `now`; the start's before any."""
    seen = np.concatenate([[0], pictures])[np.searchsorted(pictures, now, side="right")]
    return np.abs(felt - seen)


def read_scene(argil):
    """The demonstration's clay with every default."""
    show = subprocess.run([argil, "show", SCENARIO], capture_output=True, text=True, check=True).stdout
    return json.loads(show)


def moduli(argil, scene, saturation):
    """Bulk and shear modulus [Pa] of the scene's clay when so wet, as its effective medium has them."""
    material, porosity = scene["material"], scene["water"]["porosity"]
    medium = material["effective_medium"]
    cases = [{"youngs_modulus_Pa": material["youngs_modulus_Pa"],
              "poissons_ratio": material["poissons_ratio"],
              "fluid_bulk_modulus_Pa": 0.0, "fluid_shear_modulus_Pa": 0.0, "phi": porosity * float(s),
              "scheme": medium["scheme"], "aspect": medium["aspect"]} for s in saturation]
    answer = subprocess.run([argil, "probe", "effective_medium"], input=json.dumps({"cases": cases}),
                            capture_output=True, text=True, check=True).stdout
    return (np.array([row[f"{name}_modulus_Pa"] for row in json.loads(answer)["results"]]) for name in ("bulk", "shear"))


def strength(scene, shear, saturation):
    """Undrained shear strength [Pa] = yield strain · 2G/√2 of the scene's clay when so wet; of saturation 0 it is the scene's strength_Pa."""
    material = scene["material"]
    dry_shear = material["youngs_modulus_Pa"] / (2.0 * (1.0 + material["poissons_ratio"]))
    yielding = material["plasticity"]["strength_Pa"] / (np.sqrt(2.0) * dry_shear) * material["moisture"]["saturated_yield_ratio"] ** saturation
    return yielding * 2.0 * shear / np.sqrt(2.0)


def outside(value, low, high):
    """By what factor a value lies outside a range; 1 within it."""
    return max(1.0, low / value, value / high)


def compare_sizes(argil):
    """Rows of what the clay has, as it is modelled (saturation 0) and at the liquid limit (1), and what was measured."""
    scene, ends = read_scene(argil), np.array([0.0, 1.0])
    bulk, shear = moduli(argil, scene, ends)
    young, strengths = 9.0 * bulk * shear / (3.0 * bulk + shear), strength(scene, shear, ends)
    one_dimensional = bulk + 4.0 / 3.0 * shear
    solid = (1.0 - DAMP_WATER) * scene["material"]["density_kg_per_m3"]  # [kg/m³]
    modelled = DAMP_WATER / (1.0 - DAMP_WATER)  # water content, of the solid's weight
    liquid = modelled + scene["water"]["density_kg_per_m3"] * scene["water"]["porosity"] / solid
    values = {"strength as modelled [kPa]": 1e-3 * strengths[0], "strength at the liquid limit [kPa]": 1e-3 * strengths[1],
              "modulus over strength, as modelled [–]": young[0] / strengths[0],
              "modulus over strength, liquid limit [–]": young[1] / strengths[1],
              "one-dimensional modulus, as modelled [MPa]": 1e-6 * one_dimensional[0],
              "one-dimensional modulus, liquid limit [MPa]": 1e-6 * one_dimensional[1],
              "water as modelled over that at the liquid limit [–]": modelled / liquid}
    return [{"quantity": name, "argil": float(value), "low": low, "high": high, "source": source,
             "factor": float(outside(value, low, high))}
            for (name, value), (low, high, source) in zip(values.items(), MEASURED)]


def draw_strength(argil):
    """The figure, and the rms distance of log10 of the strength from each measured clay."""
    saturation = np.linspace(0.0, 1.0, 41)
    scene = read_scene(argil)
    ours = strength(scene, list(moduli(argil, scene, saturation))[1], saturation)
    share = share_of(saturation)
    drier = 1.0 - index_of(share)  # than at the liquid limit
    measured = {"641 tests on 101 soils (Vardanega & Haigh 2014)": 35.0 ** drier,
                "remoulded (Kayabali & Tufenkci 2010)": (180.0 / 2.3) ** drier,
                "Cochin clay": cochin_strength(share) / cochin_strength(1.0)}
    figure, axes = plt.subplots(figsize=(120 * ap.MILLIMETRES, 75 * ap.MILLIMETRES))
    axes.semilogy(share, ours / ours[-1], color=ap.COLOURS[0], label="argil, the demonstration's clay")
    distances = {}
    for number, (name, values) in enumerate(measured.items(), start=1):
        axes.semilogy(share, values, color=ap.COLOURS[number], linestyle=ap.DASHES[number], label=name)
        distances[name] = float(np.sqrt(np.mean(np.log10(ours / ours[-1] / values) ** 2)))
    axes.set_xlabel("water content over that at the liquid limit [–]")
    axes.set_ylabel("strength over that at the liquid limit [–]")
    axes.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0))
    return figure, distances


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("argil")
    parser.add_argument("--works", nargs=2, required=True, metavar=("DRY.h5", "WET.h5"))
    parser.add_argument("--hands", nargs=2, required=True, metavar=("ON.h5", "OFF.h5"))
    parser.add_argument("--delays", nargs="+", required=True, metavar="RESULT.h5")
    parser.add_argument("-o", "--output", default="measures", metavar="STEM")
    options = parser.parse_args()
    figure, distances = draw_strength(options.argil)
    figures = {"press": {Path(file).stem: touch(file) for file in options.works},
               "yielding_hand": {name: touch(file) for name, file in zip(("on", "off"), options.hands)},
               "delay": {Path(file).stem.replace("delay_", ""): delay(file) for file in options.delays},
               "rms_log10_distance_from_measured_clay": distances, "beside_measured_clay": compare_sizes(options.argil)}
    Path(f"{options.output}.json").write_text(json.dumps(figures, indent=2) + "\n", encoding="utf-8")
    print(f"{options.output}.json")
    ap.save(figure, options.output)


if __name__ == "__main__":
    main()
