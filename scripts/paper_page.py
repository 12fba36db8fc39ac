#!/usr/bin/python3
"""Writes results/paper/README.md from what scripts/reproduce has made, each item beside the paper's.

Usage: paper_page.py [-o FILE.md]. What has not been made is named as missing.
"""
import argparse
import csv
import json
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PAPER = ROOT / "results/paper"
PAPER_RATES = {"dinosaur": (71.3, 792.6), "figure": (87.9, 863.7), "sphere": (85.9, 841.1),
               "cylinder": (85.9, 841.1)}
LIMITS = {  # of limits.json, and of the figure: title, what the paper's form does, what is done here, where there is more
    "eq6": ("Eq. 6 past its pole", "in clay of ν = {poissons_ratio:g} it leaves the Voigt bound at φ = {phi_above_voigt:.3f}, and undrained "
            "its bulk modulus is negative past φ = {phi_not_positive_definite:.3f}: at {phi_past_the_pole:g} it is "
            "{bulk_over_dry_past_the_pole:.0f} times the dry one, while Young's modulus, {young_over_dry_past_the_pole:.2f} of the "
            "dry one, looks healthy",
            "Mori–Tanaka, which stays within the bounds; every result says where its medium stands, and one that is not positive "
            "definite is refused before the run",
            "[schemes](../effective_medium/README.md), [in a press](../stability/dilute_pole.png)"),
    "kernel": ("Eq. 9 once a step", "k₁ = {k1_per_m:g} 1/m: the shorter the step the more often it brakes, and the force of one press does "
               "not settle: {peak_N[per_step][2]:.2f}, {peak_N[per_step][1]:.2f}, {peak_N[per_step][0]:.2f} N at 1, 0.5, 0.25 ms",
               "the kernel to the power h/h_ref: {peak_N[rate][2]:.2f}, {peak_N[rate][1]:.2f}, {peak_N[rate][0]:.2f} N. With long steps both "
               "rise alike, for the contact is held over the step",
               "[over k₁](../stability/kernel_step.png)"),
    "locking": ("Locking of linear tets", "a press of an elastic block of ν = {poissons_ratio:g} feels {peak_N[p1]:.2f} N",
                "`p1_nodal` {peak_N[p1_nodal]:.2f} N on the same mesh, `p2` {peak_N[p2]:.2f} N. The water drains by default; undrained clay needs one of "
                "these two, or says that it locks",
                "[in a bend](../verification/locking.png), [over ν](../stability/poisson.png)"),
    "hold": ("A held force", "between physics steps of {physics_Hz:.0f} Hz it throws a hand of {hand_kg:g} kg that yields off the clay, again and "
             "again, with up to {peak_N[hold]:.0f} N",
             "the contact is found anew each tick, on the surface as it was ({peak_N[re_evaluate]:.2f} N) or as it yields "
             "({peak_N[compliant]:.2f} N); or a passivity controller calms the held force ({peak_N[passive]:.2f} N). All are options",
             "[how stiff a contact may be](../contact/stability.png)"),
}


KNOWN = [  # what, table of results/verification, its columns found and known, its rows
    ("deflection of a clamped bar [Timoshenko]", "cantilever", "deflection_m", "timoshenko_m", {}),
    ("torsion constant of a square bar [Saint-Venant]", "torsion", "constant", "saint_venant", {}),
    ("tip of a twisted beam, force along its width [MacNeal & Harder]", "twisted_beam", "tip", "literature",
     {"force": "along_width"}),
    ("tip of Cook's membrane, ν = ⅓", "cook", "tip", "literature", {}),
]


def prose(text):
    """A paragraph, written here over several lines."""
    return " ".join(text.split()) + "\n\n"


def picture(name, words):
    return f"![{words}]({name})\n" if (PAPER / name).resolve().is_file() else f"*Not made yet: {name}*\n"


def pictures(*names_and_words):
    return "".join(picture(*pair) for pair in names_and_words) + "\n"


def read_rows(name):
    if not (PAPER / name).is_file():
        return []
    with open(PAPER / name, encoding="utf-8") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def read_json(file):
    return json.loads(file.read_text(encoding="utf-8")) if file.is_file() else {}


def table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows]) + "\n\n"


# ---- The items ---------------------------------------------------------------------------------------------


def push_pull():
    return (prose("""The paper shows a figure before a push, pushed and pulled, with the region of
                influence coloured; neither mesh nor clay is given, so the course can be compared, not
                its size. Ours is 0.2 m tall, its back against a board.""")
            + pictures(("push_pull_influence.png", "region of influence: before, push, pull, after"),
                       ("push_pull.png", "displacement along the outward normal: before, push, pull, after"),
                       ("push_pull_force.png", "force on the hand against time"))
            + run_words("figure", """Along the outward normal the push dents the belly {deepest_dent_m} deep, of
                which {dent_left_m} stay; the pull draws the chest {highest_bump_m} out, of which
                {bump_left_m} stay. "Push" and "pull" are the frames nearest to the largest forces; both go on
                after them.""")
            + prose("""Contact is a pressure, and a pull grips the clay that it pressed until its mode ends, so the force
                does not depend on how stiff the contact is. The paper's pairs reverse a push: the drawn clay follows the tool into
                contact and the pull feeds itself. The motion was chosen after looking; the sizes that the scenario calls
                expected were read off the run, and a test guards them.""")
            + tries(("figure", "pressure, as argil chooses it: 1.7·10⁹ Pa/m"), ("figure_stiff", "pressure, ten times as stiff"),
                    ("figure_pairs", "pairs (eqs. 7, 8), 100 N/m a pair")))


def read_runs():
    return read_json(PAPER / "run.json")


def run_words(name, words):
    """A paragraph with the figures of a run, lengths in millimetres."""
    found = read_runs().get(name)
    if not found:
        return f"*Not made yet: {name} in run.json*\n\n"
    return prose(words.format(**{key: f"{1e3 * value:.2f} mm" if key.endswith("_m") else value for key, value in found.items()}))


def tries(*names_and_contacts):
    """What other contacts gave."""
    runs = read_runs()
    rows = [[contact, runs[name]["outcome"], f"{runs[name]['peak_N']:.1f}", f"{1e3 * runs[name]['highest_bump_m']:.1f}"]
            for name, contact in names_and_contacts if name in runs]
    return table(["contact", "run", "largest force [N]", "highest bump [mm]"], rows) if rows else ""


def dry_wet():
    demo = read_json(ROOT / "results/demo/run.json")
    words = (prose("""The paper draws the hand's force against time, dry and wet. Without its clay, mesh and
                motion the order can be compared, not the size: dry is above wet.""")
             + pictures(("../demo/dinosaur.png", "dry and wet, before, during, after"),
                        ("../demo/dent.png", "displacement along the outward normal, dry and wet, during and after"),
                        ("../demo/force.png", "force dry and wet"),
                        ("../demo/give.png", "force and depth, dry and wet, of the same motion and of the same hand"),
                        ("../demo/force_split.png", "elasticity alone, yield alone"),
                        ("../demo/energy.png", "where the energy goes, dry and wet")))
    runs = {**demo.get("runs", {}), **{name: run for name, run in read_runs().items() if name.startswith("wet_undrained_")}}
    if demo:
        dry = runs["dry"]
        rows = [[name.replace("_p1", ", p1").replace("wet_", "wet, ").replace("_only", " only"), f"{run['peak_N']:.2f}",
                 f"{run['impulse_N_s']:.2f}",
                 *(f"{100 * (run[figure] / dry[figure] - 1):+.0f} %" for figure in ("peak_N", "impulse_N_s"))]
                for name, run in runs.items()]
        words += table(["run", "peak [N]", "impulse [N s]", "peak, to dry", "impulse, to dry"], rows)
    return (words
            + run_words("dry", """In these four the hand is put along its trace, as in the paper's figure: what differs is the force, not
                the depth. Dry, the dent is {deepest_dent_m} deep under the tool and {dent_left_m} at the end, with {bump_left_m}
                squeezed up beside it.""")
            + run_words("wet", """Wet, it is {deepest_dent_m} and then {dent_left_m}, with {bump_left_m} beside it.""")
            + hand_words(demo)
            + locking_words(runs)
            + pictures(("locking_force.png", "wet and drained; undrained in an element that locks and in one that does not")))


def hand_words(demo):
    if "give" not in demo:
        return ""
    dry, wet = (demo["give"]["same_hand"][name] for name in ("dry", "wet"))
    return prose(f"""A hand that means to make the same motion, 0.15 kg on a spring of 500 N/m, gives way: it comes
                {1e3 * dry["deepest_m"]:.2f} mm deep with {dry["largest_mean_N"]:.2f} N where the clay is dry, and
                {1e3 * wet["deepest_m"]:.2f} mm with {wet["largest_mean_N"]:.2f} N where it is wet.""")


def locking_words(runs):
    if not {"wet_undrained_p1", "wet_undrained_p1_nodal"} <= runs.keys():
        return "*Not made yet: wet_undrained_p1 in run.json*\n\n"
    locked, free, wet = (runs[name] for name in ("wet_undrained_p1", "wet_undrained_p1_nodal", "wet"))
    by_locking, by_water = ([100 * (one[figure] / other[figure] - 1) for figure in ("peak_N", "impulse_N_s")]
                            for one, other in ((locked, free), (free, wet)))
    return prose(f"""Locking plays no part in the first four, for their water drains. Where it cannot leave (the last two,
                2.2 GPa) the water itself changes peak and impulse of the wet press by {by_water[0]:+.0f} and
                {by_water[1]:+.0f} %, and tets that lock, `p1`, by {by_locking[0]:+.0f} and {by_locking[1]:+.0f} % more than
                the locking-free `p1_nodal`: little, for at a porosity of 0.28 Poisson's ratio stays
                [short of ½](../effective_medium/moduli_nu30.png). What locking does nearer to it is under
                [7](#7-where-the-formulas-fail).""")


def sculpted():
    words = prose("""The paper shows a tyrannosaur before and after sculpting; its session is not published. Ours is one motion, generated: a ball
                of 6 mm wets the back and draws a horn out of it, wets the haunch and presses a hole into it, bends the tail
                up, and dries the horn. The clay is that of the demonstration.""")
    words += pictures(("sculpted.png", "before and after"),
                      ("sculpted_water.png", "water: wetting, at the largest forces of pull and push, drying, after"),
                      ("sculpted_volume.png", "force at the hand and change of volume against time"))
    found = read_json(PAPER / "sculpted_volume.json")
    if not found:
        return words + "*Not made yet: sculpted_volume.json*\n\n"
    moved = {name: f"{1e3 * value:.1f} mm" for name, value in found["moved_m"].items()}
    force = found["largest_force_N"]
    cells = found["cells_over_skin"]
    return words + prose(f"""In {found["seconds"]:.1f} s the horn moved by {moved["horn"]}, the bottom of the hole by
                {moved["hole"]} and the tail's end by {moved["tail"]}. The body got new cells {found["new_cells"]} times,
                {found["tets_last"]} at last for {found["tets_first"]}. The skin's volume was never off by more than
                {100 * found["largest_volume_change"]:.2f} %, and is by {100 * found["volume_change"]:.2f} % at the end. The tool gave
                {1e6 * found["water_given_kg"]:.0f} mg of water and took {1e6 * found["water_taken_kg"]:.0f} mg back.
                `scripts/reproduce sculpted` leaves a page to turn and replay it, build/paper/sculpted.html.""") + prose(f"""
                **Chosen after looking**: the places and the depths. The horn is frayed at its tip, where the ball that drew
                it sat and the triangles of the skin are few. The largest forces are {force["pull"]:.1f} N in the pull and
                {force["push"]:.0f} N in the push: a thumb's, more than a desktop device renders, and too large besides, as the
                cells are too few for a ball of 6 mm. The cells enclose
                {100 * (cells["first"] - 1.0):.1f} % more than the skin at the start and {100 * (cells["last"] - 1.0):.1f} % more at
                the end: new cells lie on the skin, where the first ones were too coarse to.""")


def still_changes(rows):
    """How far the two finest cages of each body are from each other, in words."""
    said = []
    for body in dict.fromkeys(row["body"] for row in rows):
        mine = sorted((row for row in rows if row["body"] == body), key=lambda row: int(row["tets"]))
        coarse, fine = mine[-2:]
        force, dent = (100 * (float(fine[name]) / float(coarse[name]) - 1)
                       for name in ("peak_N", "largest_displacement_m"))
        said.append(f"from {coarse['tets']} to {fine['tets']} tets the {body}'s peak force changes by {force:+.0f} % "
                    f"and its largest displacement by {dent:+.0f} %")
    return "; ".join(said)


def cages():
    rows = read_rows("cages.csv")
    cells = [[row["body"], row["tets"], row["skin_vertices"], f"{float(row['lowest_weight']):.2f}",
              f"{float(row['embedding_error_m']):.1e}", f"{1e3 * float(row['skin_difference_m']):.3f}",
              f"{1e3 * float(row['largest_displacement_m']):.2f}", f"{float(row['peak_N']):.2f}"]
             for row in rows]
    head = ["body", "tets", "skin vertices", "lowest weight [–]", "embedding error [m]",
            "rms distance from the finest [mm]", "largest displacement [mm]", "peak force [N]"]
    words = prose("""The paper shows both cages and gives no count of tets. Here the cells follow the skin, which has
                the same vertices whatever the cells. A vertex just outside is carried by the tet below it, with a
                weight below 0. Embedding error: distance of a skin vertex from Σ wᵢ xᵢ of one tet with constant weights,
                the largest over all frames: rounding.""")
    words += pictures(("cage_dinosaur.png", "cages of the dinosaur"),
                      ("cage_figure.png", "cages of the figure"))
    if not rows:
        return words + "*Not made yet: cages.csv*\n"
    return (words + table(head, cells) + pictures(("cages.png", "against the cage's tets"))
            + prose(f"""**Not converged**: {still_changes(rows)}. Cells at the tool are as small as the
                number of tets lets them be, and a coarse four-node tet is too stiff. Bodies on this page have
                5000 or 10 000 tets; the finest here is no reference but the best there is."""))


def rates():
    rows = []
    for row in read_rows("rates.csv"):
        paper = PAPER_RATES[row["body"]]
        rows.append([row["body"], row["tets"], f"{paper[0]:g}", row["push_Hz"], row["pull_Hz"],
                     f"{paper[1]:g}", row["wet_Hz"], row["dry_Hz"], row["wall_share"]])
    if not rows:
        return "*Not made yet: rates.csv*\n"
    head = ["body", "tets here", "paper push/pull [Hz]", "push", "pull", "paper wet/dry [Hz]", "wet", "dry", "wall clock"]
    first = (PAPER / "rates.csv").read_text(encoding="utf-8").splitlines()[0]
    return (prose(f"""The paper: i7-4770K and a GTX Titan, sizes of the meshes not given; sphere and
                cylinder share its row. Here: no graphics card; contact, water and solid in every tick: {first.lstrip("# ")}.
                Processor time is hardly lengthened by other programs. "Wall clock": what share of these rates the clock on
                the wall saw, with the writing of records and all else that
                the machine did, at the worst of the four. Pulls are at
                5 N/m a pair, the others at 15, for a
                pull feeds itself; the solver is the program's default, not the demonstration's.
                `scripts/reproduce rates page` measures them again.""")
            + table(head, rows))


def deviation(name, found, exact, **where):
    """Of the finest mesh from the known answer, in words."""
    rows = [row for row in read_rows(name) if all(row[key] == value for key, value in where.items())]
    return f"{100 * (float(rows[-1][found]) / float(rows[-1][exact] if exact else 1.0) - 1):+.2f} %" if rows else "not made"


def physics():
    """The table of verification: known answers with both elements, then what must be zero."""
    rows = [[words, *(deviation(f"../verification/{name}.csv", found, exact, element=element, **where) for element in ("p1", "p2"))]
            for words, name, found, exact, where in KNOWN]
    rows.append(["force of a sphere pressed in [Hertz]",
                 *(deviation("../contact/hertz.csv", "force_over_closed_form", None, tool="sphere", element=element,
                             pair_stiffness_over_Ea="1") for element in ("p1", "p2"))])
    ledger = [run["ledger_error"] for run in read_json(ROOT / "results/demo/run.json").get("runs", {}).values()]
    errors = [float(row["embedding_error_m"]) for row in read_rows("cages.csv")]
    return (table(["deviation of", "p1, finest mesh", "p2, finest mesh"], rows)
            + (prose(f"""Water that the books of the presses miss: {max(ledger):.1e} of all at most. Skin off its tets:
                     {max(errors):.1e} m at most.""") if ledger and errors else ""))


def measures():
    found = read_json(PAPER / "measures.json")
    words = prose("""The paper asked users four questions, which no program can ask again. What can be
                measured of each:""")
    if not found:
        return words + "*Not made yet: measures.json*\n"
    press, hand = found["press"], found["yielding_hand"]

    def delays(what):
        return ", ".join(f"{name} {1e3 * value[what]['mean_s']:.1f} ms (worst {1e3 * value[what]['worst_s']:.0f} ms)"
                         for name, value in found["delay"].items())

    live = [(float(row["picture_delay_p50"]), float(row["picture_delay_p99"])) for row in read_rows("../live/live.csv")]
    live = "{:.0f} to {:.0f} ms (median of each session; 99 % within {:.0f} ms)".format(
        *(1e3 * value for value in (min(live)[0], max(live)[0], max(p99 for _, p99 in live)))) if live else "a moment"
    distances = found["rms_log10_distance_from_measured_clay"]
    near = "; ".join(f"{name}: {value:.2f}" for name, value in distances.items())

    def milli(run, quantity):
        return f"{1e3 * run[quantity]:.1f}"

    return words + "".join([
        "- ", prose(f"""**Is force worth having?** A hand that yields (`/hand/kind` simulated: 0.15 kg
                on a spring of 300 N/m) presses a dinosaur of soft clay ([scenario](../../scenarios/study_soft_dino.json)) with the force and without it: with it the
                contact gives the clay {milli(hand["on"], "contact_work_J")} mJ and dents it
                {milli(hand["on"], "dent_m")} mm deep, of which the hand feels
                {milli(hand["on"], "work_of_hand_J")} mJ; without it
                {milli(hand["off"], "contact_work_J")} mJ and {milli(hand["off"], "dent_m")} mm, of
                which it feels nothing. In the clay of the demonstration, where the hand is put along the trace and does not yield, the
                presses cost it {milli(press["dry"], "work_of_hand_J")} mJ on the dry and
                {milli(press["wet"], "work_of_hand_J")} mJ on the wet clay: minus the sum of the
                device's force times the tool's step, over the ticks that push. On the dry clay the
                contact gave the body {milli(press["dry"], "contact_work_J")} mJ, which should be no
                more: a force that is held over a step of 2 ms makes the difference, and it is how far
                these figures can be trusted."""),
        "- ", prose(f"""**Do force and picture come together?** Age of the felt force at physics of 71.4 Hz:
                {delays("force_age")}. How far the felt moment lies from the seen one, if each physics
                step is drawn: {delays("lag_of_step")}; if only the frames of the file are, one each 98 ms:
                {delays("lag_of_frame")}. A force that is computed anew from the clay's last response
                (`compliant`) is never old, but runs ahead of its picture. That is the time that is computed; what the clock on
                the wall adds is measured in [live sessions](../live/README.md): their picture was written {live} after its
                force."""),
        "- ", prose(f"""**Is it like clay?** In how its strength falls, yes: rms distance of log10 of the strength, over its
                value at the liquid limit, from measured clays: {near}; 0.3 is a factor of 2, which the measurements
                differ by among themselves. The fall was chosen by Cochin clay, so the other two are a test. In pascals too: saturation 0
                is clay as a potter models it, 1 the liquid limit (`about` of [the scenario](../../scenarios/demo_dino_wet.json)).
                Its modulus falls less with water than its strength:"""),
        table(["quantity", "argil", "measured", "of", "outside by a factor of"],
              [[row["quantity"], f"{row['argil']:.3g}", f"{row['low']:.3g} to {row['high']:.3g}", row["source"],
                "within" if row["factor"] == 1.0 else f"{row['factor']:.2g}"] for row in found["beside_measured_clay"]]),
        "- ", prose("""**Is it physical?** How far the finest meshes of the [verification of the solid](../verification/README.md)
                and of [contact](../contact/README.md) are from known answers, and the books. Diffusion and continuous collision
                have their known answers in `tests/verification` and `tests/property`."""),
        physics(),
        pictures(("measures.png", "strength against water beside measured clays"))])


def limits():
    found = read_json(PAPER / "limits.json")
    if not found:
        return "*Not made yet: limits.json*\n"
    rows = [[f"**{title}**: {what.format(**found[name]).replace(' -', ' −')}", remedy.format(**found[name]), more]
            for name, (title, what, remedy, more) in LIMITS.items()]
    return (prose("""Orange is the paper's form, the other lines what is done instead. What is linked was made by the scripts of its
                own folder, among it that [linear strain](../stability/rotation.png) grows under rotation.""")
            + table(["what fails or misleads", "what is done here", "more"], rows)
            + pictures(*((f"limits_{name}.png", f"{title}, and what is done instead") for name, (title, *_) in LIMITS.items())))


def times():
    rows = read_rows("times.csv")
    if not rows:
        return "*Not measured yet: times.csv, which a run of everything from a clean clone writes*\n"
    first = (PAPER / "times.csv").read_text(encoding="utf-8").splitlines()[0].lstrip("# ")
    total = [sum(float(row[name]) for row in rows) for name in ("wall_s", "cpu_s")]
    cells = [[row["item"], f"{float(row['wall_s']):.0f}", f"{float(row['cpu_s']):.0f}"] for row in rows]
    return (prose(f"{first}. CPU seconds are those of all processes together.")
            + table(["item", "wall clock [s]", "CPU [s]"], [*cells, ["all", *(f"{t:.0f}" for t in total)]]))


ITEMS = [("Push and pull", push_pull), ("Dry and wet", dry_wet), ("Sculpted", sculpted),
         ("Cage and skin", cages), ("Rates", rates), ("The user study's measurable side", measures),
         ("Where the formulas fail", limits), ("What this page costs", times)]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("-o", "--output", type=Path, default=PAPER / "README.md", help="default: results/paper/README.md")
    options = parser.parse_args()
    page = "# The paper beside argil\n\n" + prose(
        """`scripts/reproduce` makes this page and all that is on it from a clean clone;
                `scripts/reproduce ITEM` one item. The paper: [arXiv
                2112.04362](https://arxiv.org/abs/2112.04362). Its meshes, clays and motions are not
                published, so pictures and courses are compared, not numbers, except the rates.""")
    made = {run["commit"] for run in read_runs().values()}
    page += prose(f"""The runs, their outcomes and what made them: [run.json](run.json){
        f"; they are of {len(made)} different builds" if len(made) > 1 else ""}.""") if made else ""
    page += "\n".join(f"## {number}. {title}\n\n{write().rstrip()}\n"
                      for number, (title, write) in enumerate(ITEMS, start=1))
    options.output.parent.mkdir(parents=True, exist_ok=True)
    if not options.output.is_file() or options.output.read_text(encoding="utf-8") != page:  # others may read it
        options.output.write_text(page, encoding="utf-8")
    print(options.output)


if __name__ == "__main__":
    main()
