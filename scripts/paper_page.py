#!/usr/bin/python3
"""Writes results/paper/README.md and a page an item beside it from what scripts/reproduce has made.

Usage: paper_page.py [-o FOLDER]. What has not been made is named as missing. The index has one line an item, what the paper
shows and what was found; the item's page has its pictures, tables and limits. Each page is one screen.
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
    "eq6": ("Eq. 6 past its pole", "In clay of ν = {poissons_ratio:g} the medium leaves the Voigt bound at φ = {phi_above_voigt:.3f}. Undrained, "
            "its bulk modulus is negative past φ = {phi_not_positive_definite:.3f}. At {phi_past_the_pole:g} it is "
            "{bulk_over_dry_past_the_pole:.0f} times the dry one, while Young's modulus looks healthy: "
            "{young_over_dry_past_the_pole:.2f} of the dry one",
            "Mori–Tanaka stays within the bounds. Every result says where its medium stands. One that is not positive "
            "definite is refused before the run",
            "[schemes](../effective_medium/README.md), [in a press](../stability/dilute_pole.png)"),
    "kernel": ("Eq. 9 once a step", "The shorter the step, the more often the kernel (k₁ = {k1_per_m:g} 1/m) brakes. The peak of one press does "
               "not converge: {peak_N[per_step][2]:.2f}, {peak_N[per_step][1]:.2f}, {peak_N[per_step][0]:.2f} N at 1, 0.5, 0.25 ms",
               "The kernel to the power h/h_ref gives {peak_N[rate][2]:.2f}, {peak_N[rate][1]:.2f}, {peak_N[rate][0]:.2f} N. With long steps both "
               "forces rise alike, because the contact force is held over the step",
               "[over k₁](../stability/kernel_step.png)"),
    "locking": ("Locking of linear tets", "A press of an elastic block of ν = {poissons_ratio:g} feels {peak_N[p1]:.2f} N",
                "`p1_nodal` gives {peak_N[p1_nodal]:.2f} N on the same mesh, `p2` {peak_N[p2]:.2f} N. The water drains by default. Undrained clay needs one of "
                "these two elements, or the run says that it locks",
                "[in a bend](../verification/locking.png), [over ν](../stability/poisson.png)"),
    "hold": ("A held force", "Between physics steps of {physics_Hz:.0f} Hz the held force throws a compliant hand of {hand_kg:g} kg off the clay. This repeats, "
             "with up to {peak_N[hold]:.0f} N",
             "The contact is found anew each tick, on the last surface ({peak_N[re_evaluate]:.2f} N) or on the deflected one "
             "({peak_N[compliant]:.2f} N). Or a passivity controller damps the held force ({peak_N[passive]:.2f} N). All are options",
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


# ---- The items: each is the finding, a line of the index, and the rest of its own page ----------------------


def read_runs():
    return read_json(PAPER / "run.json")


def lengths(run):
    """Figures of a run as words, lengths in millimetres."""
    return {key: f"{1e3 * value:.2f} mm" if key.endswith("_m") else value for key, value in run.items()}


def run_words(name, words):
    """A paragraph with the figures of a run."""
    found = read_runs().get(name)
    return prose(words.format(**lengths(found))) if found else f"*Not made yet: {name} in run.json*\n\n"


def tries(*names_and_contacts):
    """What other contacts gave."""
    runs = read_runs()
    rows = [[contact, runs[name]["outcome"], f"{runs[name]['peak_N']:.1f}", f"{1e3 * runs[name]['highest_bump_m']:.1f}"]
            for name, contact in names_and_contacts if name in runs]
    return table(["contact", "run", "largest force [N]", "highest bump [mm]"], rows) if rows else ""


def push_pull():
    finding = run_words("figure", "The push dents the belly {deepest_dent_m} deep. The pull draws the chest {highest_bump_m} out.")
    return finding, (
        prose("""The paper shows a figure before a push, pushed and pulled. It colours the region of influence. Neither mesh nor clay is
              published, so the course can be compared, but not its size. Our figure is 0.2 m tall, its back against a board.""")
        + pictures(("push_pull_influence.png", "region of influence: before, push, pull, after"),
                   ("push_pull.png", "displacement along the outward normal: before, push, pull, after"),
                   ("push_pull_force.png", "force on the hand against time"))
        + run_words("figure", """Displacements are along the outward normal. The push dents the belly {deepest_dent_m} deep, of which {dent_left_m}
                    stay. The pull draws the chest {highest_bump_m} out, of which {bump_left_m} stay. "Push" and "pull" are the
                    frames nearest to the largest forces. Both motions go on after them.""")
        + prose("""Contact is a pressure. A pull grips the clay that the tool pressed until its mode ends. So the force does not depend on the
                stiffness of the contact. The paper's pairs reverse a push: the drawn clay follows the tool into contact, and the pull feeds
                itself.""")
        + tries(("figure", "pressure, as argil chooses it: 1.7·10⁹ Pa/m"), ("figure_stiff", "pressure, ten times as stiff"),
                ("figure_pairs", "pairs (eqs. 7, 8), 100 N/m a pair"))
        + prose("""**Chosen after looking**: the motion. The sizes that the scenario calls expected were read off the run, and a test guards
                them."""))


def dry_wet():
    demo = read_json(ROOT / "results/demo/run.json")
    runs = {**demo.get("runs", {}), **{name: run for name, run in read_runs().items() if name.startswith("wet_undrained_")}}
    finding, rows = "*Not made yet: results/demo/run.json*", []
    if demo:
        dry = runs["dry"]
        change = {name: [100 * (run[figure] / dry[figure] - 1) for figure in ("peak_N", "impulse_N_s")] for name, run in runs.items()}
        finding = "Dry is above wet. Wet, the peak is {:.0f} % lower and the impulse {:.0f} %.".format(*(-c for c in change["wet"]))
        rows = [[name.replace("_p1", ", p1").replace("wet_", "wet, ").replace("_only", " only"), f"{run['peak_N']:.2f}",
                 f"{run['impulse_N_s']:.2f}", *(f"{c:+.0f} %" for c in change[name])] for name, run in runs.items()]
    return finding, (
        prose("""The paper draws the hand's force against time, dry and wet. Clay, mesh and motion are not published. So the order can be
              compared, but not the size: dry is above wet.""")
        + pictures(("../demo/dinosaur.png", "dry and wet, before, during, after"),
                   ("../demo/dent.png", "displacement along the outward normal, dry and wet, during and after"),
                   ("../demo/force.png", "force dry and wet"),
                   ("../demo/give.png", "force and depth, dry and wet, of the same motion and of the same hand"),
                   ("../demo/force_split.png", "elasticity alone, yield alone"),
                   ("../demo/energy.png", "where the energy goes, dry and wet"))
        + (table(["run", "peak [N]", "impulse [N s]", "peak, to dry", "impulse, to dry"], rows) if rows else "")
        + prose("""In these runs the hand is put along its trace, as in the paper's figure. So the force differs, not the depth.""")
        + run_words("dry", """Dry, the dent under the tool is {deepest_dent_m} deep, and {dent_left_m} at the end. Beside it {bump_left_m} are squeezed up.""")
        + run_words("wet", """Wet, it is {deepest_dent_m} deep, and {dent_left_m} at the end, with {bump_left_m} beside it.""")
        + hand_words(demo)
        + locking_words(runs)
        + pictures(("locking_force.png", "wet and drained; undrained in an element that locks and in one that does not")))


def hand_words(demo):
    if "give" not in demo:
        return ""
    dry, wet = (demo["give"]["same_hand"][name] for name in ("dry", "wet"))
    return prose(f"""A hand of 0.15 kg on a spring of 500 N/m means to make the same motion, and gives way. In dry clay it comes
                {1e3 * dry["deepest_m"]:.2f} mm deep with {dry["largest_mean_N"]:.2f} N, in wet clay
                {1e3 * wet["deepest_m"]:.2f} mm with {wet["largest_mean_N"]:.2f} N.""")


def locking_words(runs):
    if not {"wet_undrained_p1", "wet_undrained_p1_nodal"} <= runs.keys():
        return "*Not made yet: wet_undrained_p1 in run.json*\n\n"
    locked, free, wet = (runs[name] for name in ("wet_undrained_p1", "wet_undrained_p1_nodal", "wet"))
    by_locking, by_water = ([100 * (one[figure] / other[figure] - 1) for figure in ("peak_N", "impulse_N_s")]
                            for one, other in ((locked, free), (free, wet)))
    return prose(f"""**Locking** plays no part in the first four runs, because their water drains. In the last two it cannot leave (2.2 GPa).
                The water itself then changes peak and impulse of the wet press by {by_water[0]:+.0f} and {by_water[1]:+.0f} %. Tets that
                lock, `p1`, add {by_locking[0]:+.0f} and {by_locking[1]:+.0f} % to those of the locking-free `p1_nodal`. That is little,
                because at a porosity of 0.28 Poisson's ratio stays [below ½](../effective_medium/moduli_nu30.png). Nearer to ½
                [locking matters](limits.md).""")


def sculpted():
    words = prose("""The paper shows a tyrannosaur before and after sculpting. Its session is not published. Ours is one generated motion of a
                ball of 6 mm. The ball wets the back and draws a horn out of it. It wets the haunch and presses a hole into it. It
                bends the tail up, and dries the horn. The clay is that of the demonstration.""")
    words += pictures(("sculpted.png", "before and after"),
                      ("sculpted_water.png", "water: wetting, at the largest forces of pull and push, drying, after"),
                      ("sculpted_volume.png", "force at the hand and change of volume against time"))
    found = read_json(PAPER / "sculpted_volume.json")
    if not found:
        missing = "*Not made yet: sculpted_volume.json*\n\n"
        return missing, words + missing
    moved = {name: f"{1e3 * value:.1f} mm" for name, value in found["moved_m"].items()}
    force = found["largest_force_N"]
    cells = found["cells_over_skin"]
    volume = f"{100 * found['largest_volume_change']:.2f} %"
    finding = f"The horn moved by {moved['horn']}, the hole by {moved['hole']}, the tail by {moved['tail']}. The skin keeps its volume to {volume}."
    return finding, words + prose(f"""In {found["seconds"]:.1f} s the horn moved by {moved["horn"]}, the bottom of the hole by
                {moved["hole"]} and the tail's end by {moved["tail"]}. The body got new cells {found["new_cells"]} times:
                {found["tets_last"]} at last, {found["tets_first"]} at first. The skin's volume was never off by more than
                {volume}. At the end it is off by {100 * found["volume_change"]:.2f} %. The tool gave
                {1e6 * found["water_given_kg"]:.0f} mg of water and took {1e6 * found["water_taken_kg"]:.0f} mg back.
                `scripts/reproduce sculpted` leaves a page to turn and replay it, build/paper/sculpted.html.""") + prose("""
                **Chosen after looking**: the places and the depths.""") + prose(f"""
                **Missed.** The horn is frayed at its tip. The ball that drew it sat there, and the skin has few triangles.
                The largest forces are {force["pull"]:.1f} N in the pull and
                {force["push"]:.0f} N in the push. A thumb gives such forces, but a desktop device renders less. They are also too large,
                because the cells are too few for a ball of 6 mm. The cells enclose
                {100 * (cells["first"] - 1.0):.1f} % more than the skin at the start and {100 * (cells["last"] - 1.0):.1f} % more at
                the end. New cells lie on the skin. The first ones were too coarse for that.""")


def find_changes(rows):
    """How far the two finest cages of each body are from each other: tets, then force and displacement [%]."""
    for body in dict.fromkeys(row["body"] for row in rows):
        coarse, fine = sorted((row for row in rows if row["body"] == body), key=lambda row: int(row["tets"]))[-2:]
        yield (body, coarse["tets"], fine["tets"],
               *(100 * (float(fine[name]) / float(coarse[name]) - 1) for name in ("peak_N", "largest_displacement_m")))


def cages():
    rows = read_rows("cages.csv")
    cells = [[row["body"], row["tets"], row["skin_vertices"], f"{float(row['lowest_weight']):.2f}",
              f"{float(row['embedding_error_m']):.1e}", f"{1e3 * float(row['skin_difference_m']):.3f}",
              f"{1e3 * float(row['largest_displacement_m']):.2f}", f"{float(row['peak_N']):.2f}"]
             for row in rows]
    head = ["body", "tets", "skin vertices", "lowest weight [–]", "embedding error [m]",
            "rms distance from the finest [mm]", "largest displacement [mm]", "peak force [N]"]
    words = prose("""The paper shows both cages and gives no count of tets. Here the cells follow the skin. The skin has the same vertices
                whatever the cells. A vertex just outside is carried by the tet below it, with a weight below 0. The embedding error is
                the distance of a skin vertex from Σ wᵢ xᵢ of one tet with constant weights. The largest over all frames is rounding.""")
    words += pictures(("cage_dinosaur.png", "cages of the dinosaur"),
                      ("cage_figure.png", "cages of the figure"))
    if not rows:
        missing = "*Not made yet: cages.csv*\n"
        return missing, words + missing
    changes = list(find_changes(rows))
    force, displacement = (" and ".join(f"{change[i]:+.0f} %" for change in changes) for i in (3, 4))
    finding = (f"The skin stays on its tets to rounding. **Missed**: with about twice the tets the peak force still changes by {force}, "
               f"the largest displacement by {displacement}.")
    return finding, (words + table(head, cells) + pictures(("cages.png", "against the cage's tets"))
            + prose("**Not converged.** " + " ".join(
                f"From {coarse} to {fine} tets the {body}'s peak force changes by {force:+.0f} % and its largest displacement by {dent:+.0f} %."
                for body, coarse, fine, force, dent in changes) + """ The number of tets limits how small the cells at the tool are. A coarse
                four-node tet is too stiff. Bodies of these pages have 5000 or 10 000 tets. The finest here is no reference, but the best there is."""))


def rates():
    measured = read_rows("rates.csv")
    if not measured:
        missing = "*Not made yet: rates.csv*\n"
        return missing, missing
    rows = [[row["body"], row["tets"], f"{PAPER_RATES[row['body']][0]:g}", row["push_Hz"], row["pull_Hz"],
             f"{PAPER_RATES[row['body']][1]:g}", row["wet_Hz"], row["dry_Hz"], row["wall_share"]] for row in measured]
    head = ["body", "tets here", "paper push/pull [Hz]", "push", "pull", "paper wet/dry [Hz]", "wet", "dry", "wall clock"]

    def between(values):
        return f"{min(values):g} to {max(values):g} Hz"

    push, wet = ([float(row[f"{mode}_Hz"]) for row in measured for mode in modes] for modes in (("push", "pull"), ("wet", "dry")))
    paper_push, paper_wet = zip(*PAPER_RATES.values())
    finding = f"Push and pull: {between(push)}, the paper {between(paper_push)}. Wet and dry: {between(wet)}, the paper {between(paper_wet)}."
    first = (PAPER / "rates.csv").read_text(encoding="utf-8").splitlines()[0]
    return finding, (prose(f"""**The paper**: i7-4770K and a GTX Titan. The sizes of its meshes are not given. Sphere and cylinder share its
                row.""")
            + prose(f"""**Here**: {first.lstrip("# ")}. There is no graphics card. Contact, water and solid are computed in every tick.
                Other programs hardly lengthen processor time.""")
            + table(head, rows)
            + prose(""""Wall clock" is the share of these rates that the clock on the wall saw, at the worst of the four. It includes the writing of
                records and all else that the machine did.""")
            + prose("""Pulls are at 5 N/m a pair, the others at 15, because a pull feeds itself. The solver is the program's default,
                not the demonstration's. `scripts/reproduce rates page` measures the rates again."""))


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
            + (prose(f"""The books of the presses miss {max(ledger):.1e} of all water at most. The skin is off its tets by
                     {max(errors):.1e} m at most.""") if ledger and errors else ""))


def hand_measures(press, hand):
    def milli(run, quantity):
        return f"{1e3 * run[quantity]:.1f}"

    return prose(f"""**Is force worth having?** A hand of 0.15 kg on a spring of 300 N/m (`/hand/kind` simulated) presses a dinosaur of soft clay
                ([scenario](../../scenarios/study_soft_dino.json)). With the force the contact gives the clay
                {milli(hand["on"], "contact_work_J")} mJ and dents it {milli(hand["on"], "dent_m")} mm deep. Of that work the hand feels
                {milli(hand["on"], "work_of_hand_J")} mJ. Without the force the contact gives {milli(hand["off"], "contact_work_J")} mJ and
                {milli(hand["off"], "dent_m")} mm, and the hand feels nothing.
                In the demonstration the hand is put along the trace. Its presses cost the hand {milli(press["dry"], "work_of_hand_J")} mJ
                on dry and {milli(press["wet"], "work_of_hand_J")} mJ on wet clay. On dry clay the contact gave the body {milli(press["dry"], "contact_work_J")} mJ, which should be
                no more. The force is held over a step of 2 ms, which makes the difference. These figures can be trusted that far.""")


def delay_measures(delay):
    def delays(what):
        return ", ".join(f"{name} {1e3 * value[what]['mean_s']:.1f} ms (worst {1e3 * value[what]['worst_s']:.0f} ms)"
                         for name, value in delay.items())

    live = [(float(row["picture_delay_p50"]), float(row["picture_delay_p99"])) for row in read_rows("../live/live.csv")]
    live = "{:.0f} to {:.0f} ms behind the force (median of each session). 99 % of a session were within {:.0f} ms".format(
        *(1e3 * value for value in (min(live)[0], max(live)[0], max(p99 for _, p99 in live)))) if live else "a moment later"
    return prose(f"""**Do force and picture come together?** Age of the felt force at physics of 71.4 Hz: {delays("force_age")}. Lag between the felt
                and the seen moment. If each physics step is drawn: {delays("lag_of_step")}. If only the frames of the file are, one each
                98 ms: {delays("lag_of_frame")}. `compliant` computes the force anew from the clay's last response. It is never old, but
                runs ahead of its picture. The clock on the wall adds to that: in [live sessions](../live/README.md) the picture was {live}.""")


def measures():
    found = read_json(PAPER / "measures.json")
    words = prose("The paper asked users four questions. No program can ask them again. Each has a side that can be measured:")
    if not found:
        missing = "*Not made yet: measures.json*\n"
        return missing, words + missing
    near = "; ".join(f"{name}: {value:.2f}" for name, value in found["rms_log10_distance_from_measured_clay"].items())
    sizes = found["beside_measured_clay"]
    outside = [row["factor"] for row in sizes if row["factor"] != 1.0]
    finding = (f"Strength falls with water as in measured clays. Of {len(sizes)} sizes {len(outside)} lie outside the measured ranges"
               + (f", by a factor of {max(outside):.2g} at most." if outside else "."))
    return finding, words + "".join([
        hand_measures(found["press"], found["yielding_hand"]),
        delay_measures(found["delay"]),
        prose(f"""**Is it like clay?** In how its strength falls with water, yes. The rms distance of log10 of the strength, over its value at the
                liquid limit, from measured clays: {near}. 0.3 is a factor of 2, by which the measurements differ among themselves.
                The fall was fitted to Cochin clay, so the other two are a test. In pascals, saturation 0 is clay as a potter models it
                and 1 the liquid limit (`about` of [the scenario](../../scenarios/demo_dino_wet.json)). The modulus falls less with water
                than the strength:"""),
        table(["quantity", "argil", "measured", "of", "outside by a factor of"],
              [[row["quantity"], f"{row['argil']:.3g}", f"{row['low']:.3g} to {row['high']:.3g}", row["source"],
                "within" if row["factor"] == 1.0 else f"{row['factor']:.2g}"] for row in sizes]),
        prose("""**Is it physical?** The table has the distance of the finest meshes from known answers, of [the solid](../verification/README.md)
                and of [contact](../contact/README.md). `tests/verification` and `tests/property` have those of diffusion and continuous
                collision."""),
        physics(),
        pictures(("measures.png", "strength against water beside measured clays"))])


def limits():
    found = read_json(PAPER / "limits.json")
    if not found:
        missing = "*Not made yet: limits.json*\n"
        return missing, missing
    rows = [[f"**{title}**. {what.format(**found[name]).replace(' -', ' −')}", remedy.format(**found[name]), more]
            for name, (title, what, remedy, more) in LIMITS.items()]
    finding = "Four forms fail or mislead: " + ", ".join(title[0].lower() + title[1:] for title, *_ in LIMITS.values()) + "."
    return finding, (
        prose("""Orange lines are the paper's form, the other lines what is done instead. The scripts of their own folders made the linked
                figures. One more form fails: [linear strain](../stability/rotation.png) grows under rotation.""")
        + table(["what fails or misleads", "what is done here", "more"], rows)
        + pictures(*((f"limits_{name}.png", f"{title}, and what is done instead") for name, (title, *_) in LIMITS.items())))


ITEMS = {  # name of the page: title, what the paper shows, what writes the finding and the page
    "push_pull": ("Push and pull", "a figure before, pushed and pulled", push_pull),
    "dry_wet": ("Dry and wet", "the hand's force against time", dry_wet),
    "sculpted": ("Sculpted", "a tyrannosaur before and after", sculpted),
    "cages": ("Cage and skin", "two cages, no count of tets", cages),
    "rates": ("Rates", "rates on four bodies, their sizes not given", rates),
    "measures": ("The user study's measurable side", "four questions to users", measures),
    "limits": ("Where the formulas fail", "eqs. 6 and 9, linear tets, a held force", limits)}


def times():
    rows = read_rows("times.csv")
    if not rows:
        return "*Not measured yet: times.csv, which a run of everything from a clean clone writes*\n"
    first = (PAPER / "times.csv").read_text(encoding="utf-8").splitlines()[0].lstrip("# ")
    total = [sum(float(row[name]) for row in rows) for name in ("wall_s", "cpu_s")]
    cells = [[row["item"], f"{float(row['wall_s']):.0f}", f"{float(row['cpu_s']):.0f}"] for row in rows]
    return (prose(f"{first}. CPU seconds are those of all processes together.")
            + table(["item", "wall clock [s]", "CPU [s]"], [*cells, ["all", *(f"{t:.0f}" for t in total)]]))


def index(findings):
    """The page that links the others."""
    page = "# The paper beside argil\n\n" + prose("""`scripts/reproduce` makes these pages and all that is on them from a clean clone, `scripts/reproduce ITEM`
                one item. The paper: [arXiv 2112.04362](https://arxiv.org/abs/2112.04362). Its meshes, clays and motions are not published. So pictures
                and courses are compared, but not numbers, except the rates.""")
    made = {run["commit"] for run in read_runs().values()}
    page += prose(f"""[run.json](run.json) has the runs, their outcomes and what made them.{
        f" They are of {len(made)} different builds." if len(made) > 1 else ""}""") if made else ""
    page += pictures(("sculpted.png", "the sculpted tyrannosaur, before and after"))
    page += table(["item", "the paper shows", "found here"],
                  [[f"[{title}]({name}.md)", shown, findings[name].strip()] for name, (title, shown, _) in ITEMS.items()])
    return page + "## What these pages cost\n\n" + times()


def write(file, page):
    """A page that is as it was is left alone, because others may read it."""
    page = page.rstrip() + "\n"
    if not file.is_file() or file.read_text(encoding="utf-8") != page:
        file.write_text(page, encoding="utf-8")
    print(file)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("-o", "--output", type=Path, default=PAPER, metavar="FOLDER", help="default: results/paper")
    options = parser.parse_args()
    options.output.mkdir(parents=True, exist_ok=True)
    findings = {}
    for name, (title, _, make) in ITEMS.items():
        findings[name], words = make()
        write(options.output / f"{name}.md", f"# {title} ([all items](README.md))\n\n{words}")
    write(options.output / "README.md", index(findings))


if __name__ == "__main__":
    main()
