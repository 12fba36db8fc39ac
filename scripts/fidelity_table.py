#!/usr/bin/python3
"""Runs scenes in full and with `fidelity: auto`, the same motion on one thread, and writes how far the force at the hand
is off, what that was estimated to be, and what each cost: results/fidelity/fidelity.csv, .png and .pdf.

    scripts/fidelity_table.py [--build BUILD] [--scenes NAME ...] [--keep FOLDER]
"""
import argparse
import csv
import subprocess
import tempfile
from pathlib import Path
from typing import NamedTuple

import argil_plot as ap
import h5py
import numpy as np
import provenance
from argil_plot import COLOURS, GREY, MILLIMETRES, plt

ROOT = Path(__file__).resolve().parent.parent
RESULTS = ROOT / "results" / "fidelity"
REPEATS = 2  # of each run, for the least processor time
LONG = 60  # [s] of a run that is made once
SMALL_TOOL = '/tool/shape={"kind": "sphere", "radius_m": 0.008, "subdivisions": 3}'
UNDRAINED = ["/dynamics/element=p1_nodal", "/dynamics/allow_locking=false"]


class Scene(NamedTuple):
    """A scenario of scenarios/, changed by settings."""

    scenario: str
    settings: list
    breaks: str = ""  # the indicator that the scene is made to break


def with_trace(name, *settings):
    return [f"/trace/file={ROOT / 'traces' / name}", *settings]


SCENES = {
    "light touch": Scene("study_light_press", []),
    "deep press": Scene("study_light_press", with_trace("block_deep.csv")),
    "slide": Scene("study_slide", []),
    "pull": Scene("study_light_press", with_trace("block_draw.csv", "/contact/vertex_face_stiffness_N_per_m=8",
                                                  "/contact/edge_edge_stiffness_N_per_m=8")),
    "wet half": Scene("study_wet_undrained", with_trace("block_wet.csv", "/body/initial_saturation=0", *UNDRAINED)),
    "wet undrained": Scene("study_wet_undrained", UNDRAINED),
    # The post folds at its foot, all at once: at 1e-3 the solver's own error there is two bounds, that of auto one.
    "bend by 90°": Scene("study_deep_bend", with_trace("post_fold.csv", "/dynamics/solver/tolerance=1e-4")),
    "two-second rest": Scene("study_light_press", with_trace("block_rest.csv")),
    "dinosaur": Scene("study_soft_dino", []),
    # Bodies so large that only the region which the hand feels is solved for.
    "slide, fine": Scene("study_slide", ["/body/shape/target_tets=20000", "/contact/friction=0"]),
    "dinosaur, fine": Scene("study_soft_dino", ["/body/shape/target_tets=42000"]),
    "bend by 90°, fine": Scene("study_deep_bend", with_trace("post_fold.csv", "/dynamics/solver/tolerance=1e-4",
                                                              "/body/shape/target_tets=20000"), "region"),
    # Leaving, contacts rattle from tick to tick and enlarge what a step leaves: full at 1e-2 is 5.7 bounds off that at 1e-7.
    "light touch, fine": Scene("study_light_press", ["/body/shape/target_tets=30000"], "region"),
    "slide, fine, with friction": Scene("study_slide", ["/body/shape/target_tets=20000"], "region"),
    "rest with tremor": Scene("study_light_press", with_trace("block_rest_tremor.csv"), "sleep"),
    "slow creep": Scene("study_light_press", with_trace("block_rest.csv", "/material/plasticity/creep_per_s=0.5"), "sleep"),
    "stabs": Scene("study_soft_dino", with_trace("poke.csv"), "slack"),
    "undamped": Scene("study_light_press", ["/dynamics/rayleigh_stiffness_s=0", "/material/clay_kernel/form=off",
                                            "/material/plasticity/enabled=false"], "sleep"),
    # A post bent to 90 degrees and back in 0.3 s, held by the rod all the time, of clay that resists fast strain: the matrix
    # that brakes it is turned by frames that lag. Contacts are soft, so that theirs is not the error.
    "sway": Scene("study_deep_bend", with_trace("post_sway.csv", "/dynamics/solver/tolerance=1e-4",
                                                "/dynamics/rayleigh_stiffness_s=0.1",
                                                "/contact/vertex_face_stiffness_N_per_m=20",
                                                "/contact/edge_edge_stiffness_N_per_m=20"), "frames"),
    # Slow clay goes on by itself in an even press; then the hand turns round within a tick.
    "drive and reversal": Scene("study_light_press", with_trace("block_reversal.csv", "/dynamics/rayleigh_stiffness_s=0.05",
                                                                "/material/plasticity/creep_per_s=0.5",
                                                                "/material/clay_kernel/form=off"), "coasting"),
    # Bent ever faster and evenly let go: contacts rattle as the post follows the rod.
    "let go": Scene("study_deep_bend", with_trace("post_let_go.csv", "/dynamics/solver/tolerance=1e-4",
                                                  "/dynamics/rayleigh_stiffness_s=0.03"), "solve"),
    # A dent sleeps until the water from beside it arrives, which softens and swells it under the hand at rest.
    "seep": Scene("study_light_press", with_trace("block_seep.csv", SMALL_TOOL,
                                                  '/material/effective_medium={"scheme": "mori_tanaka", "aspect": 0.2}',
                                                  '/material/moisture={"yield_law": "log_linear", '
                                                  '"saturated_yield_ratio": 0.0286}',
                                                  '/water={"porosity": 0.4, "diffusivity_m2_per_s": 7e-6, '
                                                  '"wetting_flux_kg_per_m2_s": 40, "drying_flux_kg_per_m2_s": 40, "swelling": 0.05}'),
                  "waking"),
    # Else auto's run would end where its force has trembled for 0.3 s, and full's would not.
    "unstable pull": Scene("study_light_press", with_trace("block_draw.csv", "/contact/vertex_face_stiffness_N_per_m=60",
                                                           "/contact/edge_edge_stiffness_N_per_m=60", "/haptics/chatter_limit=1"),
                           "estimate"),
}


def run(argil, scene, mode, file):
    sets = [word for setting in [*scene.settings, f"/fidelity/mode={mode}"] for word in ("--set", setting)]
    subprocess.run([argil, "run", ROOT / "scenarios" / f"{scene.scenario}.json", "-q", "-o", file, "--threads", "1", *sets],
                   check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def read(file):
    with h5py.File(file) as result:
        steps = {name: data[:] for name, data in result["fidelity"].items()} if "fidelity" in result else None
        return (result["haptic/force"][:], result["timing/cpu"][-1], len(result["mesh/tets"]),
                result["physics/iterations"][:], result["physics/active_nodes"][:], steps)


def measure(argil, name, scene, folder):
    """A row of the table, and what the picture takes of it."""
    stem = name.replace(" ", "_").replace("°", "")
    files = {mode: folder / f"{stem}_{mode}.h5" for mode in ("full", "auto")}
    cpu = {mode: np.inf for mode in files}
    for _ in range(REPEATS):  # other programs only make it longer
        for mode, file in files.items():
            run(argil, scene, mode, file)
            cpu[mode] = min(cpu[mode], read(file)[1])
        if cpu["full"] > LONG:
            break
    full_cpu, lean_cpu = cpu.values()
    force, _, tets, full_iterations, _, _ = read(files["full"])
    lean_force, _, _, iterations, nodes, steps = read(files["auto"])
    off = np.linalg.norm(lean_force - force, axis=1)
    size = np.linalg.norm(force, axis=1)
    bound = np.maximum(0.02, 0.01 * size)
    period = len(force) // len(steps["tick"])
    at_step = off[period - 1::period]
    awake = steps["rung"] > 0
    asleep = steps["rung"] == 0
    counts = size[period - 1::period] > 0.0  # the hand feels something
    switches = np.diff(steps["rung"].astype(int)) != 0
    resized = ~switches & (np.diff(nodes) != 0)  # the region
    jumps = np.linalg.norm(np.diff(lean_force - force, axis=0), axis=1)  # of the error, from tick to tick
    kick = jumps[(np.flatnonzero(switches | resized) + 1) * period - 1].max(initial=0.0)
    row = {"scene": name, "breaks": scene.breaks, "tets": tets, "steps": len(steps["tick"]), "peak_N": f"{size.max():.3f}",
           "error_N": f"{off.max():.4f}", "error_over_bound": f"{(off / bound).max():.3f}",
           "error_over_peak": f"{off.max() / size.max():.2e}", "within": f"{(off <= bound).mean():.4f}",
           "estimate_missed": f"{(at_step > steps['estimate'])[counts].mean() if counts.any() else 0:.3f}",
           "asleep": f"{asleep.mean():.3f}", "coasting": f"{(steps['rung'] == 1).mean():.3f}", "switches": switches.sum(),
           "resized": resized.sum(), "kick_N": f"{kick:.4f}", "large_strain": f"{steps['large_strain'].max():.3f}",
           "iterations_full": int(full_iterations[awake].sum()), "iterations_auto": int(iterations[awake].sum()),
           "cpu_full_s": f"{full_cpu:.3f}", "cpu_auto_s": f"{lean_cpu:.3f}", "cost_ratio": f"{lean_cpu / full_cpu:.3f}"}
    return row, (name, size, off, bound, asleep, steps["estimate"], period)


def draw(pictures, rows):
    columns = 3
    lines = len(pictures) // columns + 1  # with a place for the legend
    figure, axes = plt.subplots(lines, columns, figsize=(210 * MILLIMETRES, 48 * lines * MILLIMETRES), squeeze=False)
    for at, (name, size, off, bound, asleep, estimate, period), row in zip(axes.flat, pictures, rows):
        time = np.arange(1, len(size) + 1) * 1e-3
        at.semilogy(time, np.maximum(size, 1e-6), color=GREY, label="force, full")
        at.semilogy(time, bound, color=COLOURS[2], dashes=(5, 1.5), label="bound of the error")
        step = time[period - 1::period][:len(estimate)]
        at.semilogy(step, np.maximum(estimate, 1e-6), color=COLOURS[1], linewidth=0.8, label="estimate")
        at.semilogy(time, np.maximum(off, 1e-6), color=COLOURS[0], linewidth=0.9, label="true error")
        at.fill_between(step, 1e-6, 1e-5, where=asleep, color=COLOURS[5], step="mid", label="asleep")
        at.set_ylim(1e-6, 30)
        at.set_title(f"{name}: {float(row['cost_ratio']):.2f} of full's cost")
        at.set_xlabel("time [s]")
        at.set_ylabel("[N]")
    for at in axes.flat[len(pictures):]:
        at.axis("off")
    axes.flat[-1].legend(*axes.flat[0].get_legend_handles_labels(), loc="center")
    ap.save(figure, RESULTS / "fidelity")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", default=ROOT / "build", type=Path)
    parser.add_argument("--scenes", nargs="+", default=list(SCENES), choices=list(SCENES), metavar="NAME")
    parser.add_argument("--keep", type=Path, help="folder for the result files, which are thrown away otherwise")
    options = parser.parse_args()
    argil = options.build / "bin" / "argil"
    about = provenance.describe()
    rows, pictures = [], []
    with tempfile.TemporaryDirectory() as name:
        folder = options.keep or Path(name)
        folder.mkdir(parents=True, exist_ok=True)
        for scene in options.scenes:
            row, picture = measure(argil, scene, SCENES[scene], folder)
            rows.append(row)
            pictures.append(picture)
            print(", ".join(f"{key} {value}" for key, value in row.items()), flush=True)
    if options.scenes != list(SCENES):
        return
    RESULTS.mkdir(parents=True, exist_ok=True)
    with open(RESULTS / "fidelity.csv", "w", encoding="utf-8", newline="") as out:
        out.write(f"# {about}, one thread\n")
        writer = csv.DictWriter(out, rows[0], lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    draw(pictures, rows)


if __name__ == "__main__":
    main()
