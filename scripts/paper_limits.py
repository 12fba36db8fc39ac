#!/usr/bin/python3
"""Where the paper's own forms fail or mislead, one figure each: the paper's in orange, what is done instead in blue.

Usage: paper_limits.py ARGIL [-o STEM]       → STEM_{eq6,kernel,locking,hold}.{png,pdf} and STEM.json with their figures

Eq. 6 past its pole; eq. 9 applied once a step, whatever the step; four-node tets near ν = ½; a contact force that is held
between slow physics steps. The runs are short, of scenarios/study_light_press.json, and are not kept.
"""
import argparse
import json
import subprocess
import tempfile
from pathlib import Path

import argil_plot as ap
import plot_effective_medium as medium
from argil_plot import COLOURS, DASHES, GREY, np, plt

SCENARIO = Path(__file__).resolve().parent.parent / "scenarios/study_light_press.json"
TRACE = Path(__file__).resolve().parent.parent / "traces/approach.csv"
PAPERS, OURS = COLOURS[:2]
POISSON = 0.3  # of the clay of eq. 6's figure
NEARLY_INCOMPRESSIBLE = 0.4995  # Poisson's ratio of the locking block
PERIOD = 0.25e-3  # [s] a tick of the kernel's runs
STEPS = (1, 2, 4, 8, 16, 28, 56)  # ticks of PERIOD; the last is the step to which the rate form refers
COARSE = {"/body/shape/target_tets": 300}
SELDOM = 560  # ticks between updates of water, which there is none of, and between frames
KERNEL = {**COARSE, "/material/clay_kernel/k1_per_m": 100, "/haptics/period_s": PERIOD, "/haptics/water_period_ticks": SELDOM,
          "/haptics/frame_period_ticks": SELDOM}
LOCKING = {"/body/shape/target_tets": 1200, "/material/plasticity/enabled": False, "/dynamics/allow_locking": True,
           "/material/poissons_ratio": NEARLY_INCOMPRESSIBLE, "/haptics/physics_period_ticks": 2}
HAND = {**COARSE, "/tool/shape/subdivisions": 3, "/contact/law": "pairs", "/contact/vertex_face_stiffness_N_per_m": 100,
        "/contact/edge_edge_stiffness_N_per_m": 0, "/hand/kind": "simulated", "/hand/mass_kg": 0.1,
        "/hand/stiffness_N_per_m": 100, "/hand/damping_N_s_per_m": 1, "/haptics/device/max_force_N": 100,
        "/haptics/device/max_force_rate_N_per_s": 1e6, "/haptics/physics_period_ticks": 14,
        "/haptics/water_period_ticks": 140, "/haptics/frame_period_ticks": 140, "/trace/file": str(TRACE),
        "/trace/default_rate_hz": 100}
HAND_FORMS = {  # what the hand feels between physics steps → legend, settings
    "hold": ("force held (the paper)", {}),
    "passive": ("held, with the passivity controller", {"/haptics/passivity": "time_domain"}),
    "re_evaluate": ("contact found anew each tick", {"/haptics/between_frames": "re_evaluate"}),
    "compliant": ("on a surface that yields each tick", {"/haptics/between_frames": "compliant"})}


def press(argil, settings):
    """Time [s] and size of the force at the hand [N] of one run."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "run.h5")
        sets = [word for pointer, value in settings.items() for word in ("--set", f"{pointer}={json.dumps(value)}")]
        subprocess.run([argil, "run", SCENARIO, "-o", file, "--quiet", *sets], check=True, stderr=subprocess.DEVNULL)
        with ap.open_result(file) as result:
            return result["haptic/time"][:], ap.force_norm(result)


def make_panels(columns, width=160):
    return plt.subplots(1, columns, figsize=(width * ap.MILLIMETRES, 72 * ap.MILLIMETRES), squeeze=False)


def put_legend(axes, entries=slice(None)):
    """Above the axes, over no curve; of the entries those."""
    handles, labels = axes.get_legend_handles_labels()
    axes.legend(handles[entries], labels[entries], loc="lower left", bbox_to_anchor=(0.0, 1.0), borderaxespad=0.3)


def draw_eq6(argil):
    """Moduli of undrained clay over those of dry clay: bulk, where the pole is, and Young's, which does not show it."""
    forms = {name: medium.curve(argil, POISSON, medium.WATER, name) for name in ("dilute", "mori_tanaka", "voigt", "reuss")}
    papers, ours, voigt, reuss = forms.values()
    figure, ((left, right),) = make_panels(2)
    for axes, key, words in ((left, "K", "bulk modulus"), (right, "E", "Young's modulus")):
        dry = voigt[key][0]
        axes.fill_between(medium.PHI, reuss[key] / dry, voigt[key] / dry, color="#DDE6EE", linewidth=0,
                          label="Reuss to Voigt, eq. 5")
        axes.axvspan(papers["not_positive_definite"], medium.PHI[-1], color="#C00000", alpha=0.2, linewidth=0,
                     label="eq. 6 is no stiffness")
        axes.plot(medium.PHI, medium.break_at_pole(papers[key] / dry), color=PAPERS, label="eq. 6 (the paper)")
        axes.plot(medium.PHI, ours[key] / dry, color=OURS, label="Mori–Tanaka")
        axes.set_xlabel("volume fraction of water φ [–]")
        axes.set_ylabel(f"{words} over dry [–]")
        axes.set_xlim(0.0, medium.PHI[-1])
    left.set_yscale("symlog", linthresh=1.0)
    left.set_ylim(-300, 300)
    right.set_ylim(0, 1.3)
    put_legend(left, slice(2, 4))
    put_legend(right, slice(2))
    past = np.searchsorted(medium.PHI, papers["not_positive_definite"]) + 4
    return figure, {"poissons_ratio": POISSON, "phi_above_voigt": papers["above_voigt"],
                    "phi_not_positive_definite": papers["not_positive_definite"], "phi_past_the_pole": medium.PHI[past],
                    "bulk_over_dry_past_the_pole": papers["K"][past] / papers["K"][0],
                    "young_over_dry_past_the_pole": papers["E"][past] / papers["E"][0]}


def draw_kernel(argil):
    """Largest force of one press against the step."""
    steps = [PERIOD * ticks for ticks in STEPS]
    peaks = {form: [press(argil, {**KERNEL, "/material/clay_kernel/form": form, "/haptics/physics_period_ticks": ticks})[1].max()
                    for ticks in STEPS] for form in ("per_step", "rate")}
    figure, ((axes,),) = make_panels(1, 110)
    for form, words, colour, marker in (("per_step", "eq. 9 once a step (the paper)", PAPERS, "o"),
                                        ("rate", "the kernel at a rate", OURS, "s")):
        axes.semilogx([1e3 * step for step in steps], peaks[form], color=colour, marker=marker, markersize=4, label=words)
    axes.set_xticks([1e3 * step for step in steps], [f"{1e3 * step:g}" for step in steps])
    axes.minorticks_off()
    axes.set_xlabel("physics step [ms]")
    axes.set_ylabel("largest force at the hand [N]")
    axes.set_ylim(0.0, 1.08 * max(max(values) for values in peaks.values()))
    put_legend(axes)
    return figure, {"steps_s": steps, "k1_per_m": KERNEL["/material/clay_kernel/k1_per_m"], "peak_N": peaks}


def draw_locking(argil):
    """Force of one press of an elastic block that hardly changes its volume."""
    figure, ((axes,),) = make_panels(1, 110)
    peaks = {}
    for element, words, colour, dash in (("p1", "p1, four-node tets (the paper's)", PAPERS, "-"),
                                         ("p1_nodal", "p1_nodal, on the same mesh", OURS, "-"),
                                         ("p2", "p2, ten-node tets", GREY, DASHES[2])):
        time, force = press(argil, {**LOCKING, "/dynamics/element": element})
        axes.plot(time, force, color=colour, linestyle=dash, label=words)
        peaks[element] = force.max()
    axes.set_xlabel("time [s]")
    axes.set_ylabel("force at the hand [N]")
    axes.set_ylim(bottom=0.0)
    put_legend(axes)
    return figure, {"poissons_ratio": NEARLY_INCOMPRESSIBLE, "peak_N": peaks}


def draw_hold(argil):
    """Force of a hand that is led against the clay and yields, with physics at 71 Hz: each panel has its own height."""
    figure, ((left, right),) = make_panels(2)
    peaks = {}
    for number, (form, (words, settings)) in enumerate(HAND_FORMS.items()):
        time, force = press(argil, {**HAND, **settings})
        colour, dash = ((PAPERS, "-"), (GREY, "-"), (COLOURS[2], DASHES[2]), (OURS, "-"))[number]
        (left if form == "hold" else right).plot(time, force, color=colour, linestyle=dash, label=words)
        peaks[form] = force.max()
    for axes in (left, right):
        axes.set_xlabel("time [s]")
        axes.set_ylim(bottom=0.0)
        axes.set_ylabel("force at the hand [N]")
        put_legend(axes)
    return figure, {"hand_kg": HAND["/hand/mass_kg"], "physics_Hz": 1000 / HAND["/haptics/physics_period_ticks"], "peak_N": peaks}


def rounded(value):
    """Six digits of every number."""
    if isinstance(value, dict):
        return {key: rounded(item) for key, item in value.items()}
    return [rounded(item) for item in value] if isinstance(value, list) else float(f"{value:.6g}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("argil")
    parser.add_argument("-o", "--output", default="limits", metavar="STEM")
    options = parser.parse_args()
    figures = {}
    for name, draw in (("eq6", draw_eq6), ("kernel", draw_kernel), ("locking", draw_locking), ("hold", draw_hold)):
        figure, figures[name] = draw(options.argil)
        ap.save(figure, f"{options.output}_{name}")
    Path(f"{options.output}.json").write_text(json.dumps(rounded(figures), indent=2) + "\n", encoding="utf-8")
    print(f"{options.output}.json")


if __name__ == "__main__":
    main()
