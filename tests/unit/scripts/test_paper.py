#!/usr/bin/python3
"""The paper's page: its scripts on small runs, and that the committed page is what they write from the committed data.

Usage: test_paper.py ARGIL. Skipped (77) without numpy, h5py, matplotlib and scipy.
"""
import csv
import hashlib
import importlib.util
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
if any(importlib.util.find_spec(name) is None for name in ("numpy", "h5py", "matplotlib", "scipy")):
    print("skipped: needs numpy, h5py, matplotlib and scipy")
    sys.exit(77)
sys.path.insert(0, str(ROOT / "scripts"))
sys.dont_write_bytecode = True
import h5py
import numpy as np
import paper_measures
import paper_page
import paper_runs

ARGIL = str(Path(sys.argv.pop(1)).resolve())


def call(*command):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"{command}\n{done.stdout}{done.stderr}"


def simulate(scenario, result, *settings):
    call(ARGIL, "run", ROOT / scenario, "-o", result, "--quiet", *(word for s in settings for word in ("--set", s)))
    return result


class Folder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="argil_paper_")
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)


class Page(Folder):
    def test_the_committed_pages_are_what_the_script_writes_from_the_committed_data(self):
        call(ROOT / "scripts/paper_page.py", "-o", self.folder)
        pages = sorted(page.name for page in self.folder.glob("*.md"))
        self.assertEqual(pages, sorted(page.name for page in (ROOT / "results/paper").glob("*.md")))
        for page in pages:
            self.assertEqual((self.folder / page).read_text(), (ROOT / "results/paper" / page).read_text())


    def test_a_deviation_is_that_of_the_finest_mesh(self):
        # The tables are made in the order of the cells: 0.1539635 at 8 over Saint-Venant's 0.140577.
        self.assertEqual(paper_page.deviation("../verification/torsion.csv", "constant", "saint_venant", element="p1"), "+9.52 %")
        self.assertEqual(paper_page.deviation("../verification/torsion.csv", "constant", "saint_venant", element="p9"), "not made")


class StandIns(Folder):
    """scripts/reproduce among programs that only write down how they were called: which runs and items are made, and when."""

    PROGRAM = """#!/usr/bin/env bash
        case "$1" in
          info) printf 'outcome     %s\\n' "$(<"$2")" ;;
          run) printf '%s\\n' "$*" >>runs.log
            if [[ $* == *_m=100* ]]; then echo failed >"$4"; exit 3; fi
            echo done >"$4" ;;
        esac"""
    SCRIPT = """#!/usr/bin/env bash
        printf '%s\\n' "$(basename "$0") $*${DISPLAY:+ on a display}" >>scripts.log
        [[ -z ${FAILS:-} || $* != *"$FAILS"* ]]"""
    DEMONSTRATION = """#!/usr/bin/env bash
        [[ "$*" == "-o results/demo" ]] || exit 1
        echo run >>scripts.log; mkdir -p "$2"
        for name in dry wet wet_elasticity_only wet_yield_only hand_dry hand_wet; do echo done >"$2/$name.h5"; done"""

    def setUp(self):
        super().setUp()
        for name in ("scripts", "build/bin", "scenarios"):
            (self.folder / name).mkdir(parents=True)
        shutil.copy(ROOT / "scripts/reproduce", self.folder / "scripts")
        for name in ("demo_figure_push_pull", "demo_dino_dry", "demo_dino_wet", "demo_dino_sculpted", "study_soft_dino"):
            self.write(f"scenarios/{name}.json", "{}")
        self.write("build/bin/argil", self.PROGRAM)
        for name in ("build", "render.py", "plot_force.py", *(f"paper_{it}.py" for it in ("cages", "rates", "measures", "limits", "runs", "sculpt",
                                                                                         "page"))):
            self.write(f"scripts/{name}", self.SCRIPT)
        self.write("scripts/run", self.DEMONSTRATION)

    def write(self, name, text):
        file = self.folder / name
        file.write_text("\n".join(line.strip() for line in text.splitlines()) + "\n")
        file.chmod(0o755)
        old = time.time() - 100  # of files that are there before
        os.utime(file, (old, old))

    def reproduce(self, *items, fails=""):
        """Exit code and words, the runs and the scripts that were called."""
        for log in ("runs.log", "scripts.log"):
            (self.folder / log).unlink(missing_ok=True)
        done = subprocess.run([self.folder / "scripts/reproduce", *items], capture_output=True, text=True, check=False,
                              env={**os.environ, "FAILS": fails, "DISPLAY": ":9"})
        logs = [file.read_text().splitlines() if file.is_file() else []
                for file in (self.folder / "runs.log", self.folder / "scripts.log")]
        return done, *logs

    def test_everything_is_made_once_and_its_times_are_written(self):
        done, runs, scripts = self.reproduce()
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertEqual(len(runs), 3 + 2 + 1 + 8 + 4)
        self.assertEqual(scripts[-1].split()[0], "paper_page.py")
        self.assertNotIn("on a display", " ".join(scripts[1:]))  # the first is the build
        times = (self.folder / "results/paper/times.csv").read_text().splitlines()
        self.assertIn("With the program built before on ", times[0])
        self.assertEqual([row.split(",")[0] for row in times[1:]],
                         ["item", "build", "push_pull", "dry_wet", "sculpted", "cages", "rates", "measures", "limits"])
        (self.folder / "results/paper/times.csv").unlink()
        done, runs, scripts = self.reproduce()
        self.assertEqual(done.returncode, 0)
        self.assertEqual(len(runs), 1)  # the one that failed is tried again
        self.assertIn("_m=100", runs[0])
        self.assertNotIn("run", scripts)
        self.assertFalse((self.folder / "results/paper/times.csv").exists())  # not of all that it takes

    def test_a_run_of_another_program_scenario_or_command_is_made_anew(self):
        self.reproduce("push_pull", "measures")
        for name in ("demo_dino_dry", "study_soft_dino"):
            os.utime(self.folder / f"scenarios/{name}.json")  # now
        time.sleep(0.02)
        _, runs, scripts = self.reproduce("push_pull", "measures")
        self.assertEqual(len([words for words in runs if "study_soft_dino" in words]), 4)
        self.assertEqual(len([words for words in runs if "figure" in words and "_m=100" not in words]), 0)
        self.assertIn("run", scripts)
        (self.folder / "build/paper/figure.command").write_text("argil run with other words\n")
        self.assertEqual(len(self.reproduce("push_pull")[1]), 1 + 1)
        os.utime(self.folder / "build/bin/argil")
        time.sleep(0.02)
        self.assertEqual(len(self.reproduce("push_pull")[1]), 3)

    def test_a_failing_item_is_named_and_the_others_are_made(self):
        done, _, scripts = self.reproduce(fails="sculpted.png")
        self.assertEqual(done.returncode, 1)
        self.assertIn("not made: sculpted;", done.stderr)
        called = [words.split()[0] for words in scripts]
        for name in ("paper_cages.py", "paper_rates.py", "paper_measures.py", "paper_limits.py", "paper_page.py"):
            self.assertIn(name, called)
        self.assertFalse((self.folder / "results/paper/times.csv").exists())

    def test_an_item_alone_makes_the_runs_that_it_needs(self):
        done, _, scripts = self.reproduce("measures")
        self.assertEqual(done.returncode, 0)
        self.assertIn("run", scripts)


class Reproduce(Folder):
    def test_an_unknown_item_is_refused_with_those_that_there_are(self):
        done = subprocess.run([ROOT / "scripts/reproduce", "push_pull", "teapot"], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 2)
        self.assertIn("no item teapot; there are: push_pull dry_wet sculpted cages rates measures limits page", done.stderr)

    def test_the_rates_of_all_bodies_and_modes_are_measured(self):
        call(ROOT / "scripts/paper_rates.py", ARGIL, "--repeats", "1", "-o", self.folder / "rates.csv")
        lines = (self.folder / "rates.csv").read_text().splitlines()
        self.assertIn("one thread; ticks in a second of processor time, best of 1", lines[0])
        rows = list(csv.DictReader(lines[1:]))
        self.assertEqual([row["body"] for row in rows], ["dinosaur", "figure", "sphere", "cylinder"])
        for row in rows:
            self.assertLess(abs(int(row["tets"]) / 5000 - 1), 0.1)
            # Pushed, the free nodes are solved for: of a mesh of tets some fifth of their number.
            self.assertTrue(0.05 < int(row["nodes_solved_in_push"]) / int(row["tets"]) < 0.4)
            for mode in "push", "pull", "wet", "dry":
                self.assertGreater(float(row[f"{mode}_Hz"]), 0)
            self.assertTrue(0 < float(row["wall_share"]) <= 1.05)  # the clock's steps


class Limits(Folder):
    """Expected: results/stability and results/verification say the same of other runs; eq. 6's ends are closed forms."""

    def test_each_of_the_papers_forms_fails_and_what_is_done_instead_does_not(self):
        call(ROOT / "scripts/paper_limits.py", ARGIL, "-o", self.folder / "limits")
        for name in "eq6", "kernel", "locking", "hold":
            for suffix in "png", "pdf":
                self.assertTrue((self.folder / f"limits_{name}.{suffix}").is_file())
        found = json.loads((self.folder / "limits.json").read_text())
        nu, water, clay = 0.3, 2.2e9, 1e5 / (3 * (1 - 2 * 0.3))  # bulk moduli [Pa]
        shear_share = 2 * (4 - 5 * nu) / (15 * (1 - nu))
        bulk_pole = (1 + nu) / (3 * (1 - nu)) + clay / (water - clay)
        self.assertAlmostEqual(found["eq6"]["phi_above_voigt"], shear_share, delta=1e-5)
        self.assertAlmostEqual(found["eq6"]["phi_not_positive_definite"], bulk_pole, delta=1e-5)
        self.assertLess(found["eq6"]["bulk_over_dry_past_the_pole"], 0.0)
        self.assertTrue(0.0 < found["eq6"]["young_over_dry_past_the_pole"] < 1.0)
        paper, ours = (np.array(found["kernel"]["peak_N"][form][:3]) for form in ("per_step", "rate"))  # shortest first
        self.assertGreater(paper[1] - paper[2], 0.0)
        self.assertGreater(paper[0] - paper[1], paper[1] - paper[2])  # halving the step moves it ever more
        self.assertLess(np.ptp(ours), 0.02 * ours[0])
        self.assertAlmostEqual(found["kernel"]["peak_N"]["per_step"][-1], found["kernel"]["peak_N"]["rate"][-1], places=5)
        locked = found["locking"]["peak_N"]
        self.assertGreater(locked["p1"], 1.7 * locked["p2"])
        self.assertLess(locked["p1_nodal"], 1.2 * locked["p2"])
        held = found["hold"]["peak_N"]
        self.assertGreater(held["hold"], 10 * max(held[form] for form in ("passive", "re_evaluate", "compliant")))


class Measures(Folder):
    def test_the_scripts_of_the_page_measure_small_runs(self):
        ball = simulate("tests/golden/ball.json", self.folder / "cage_ball_1.h5", "/haptics/frame_period_ticks=7")
        call(ROOT / "scripts/paper_cages.py", ball, "-o", self.folder / "cages")
        call(ROOT / "scripts/paper_runs.py", ball, "-o", self.folder / "run.json")
        call(ROOT / "scripts/paper_measures.py", ARGIL, "--works", ball, ball, "--hands", ball, ball, "--delays", ball,
             "-o", self.folder / "measures")
        figures = json.loads((self.folder / "measures.json").read_text())
        with h5py.File(ball) as result:
            self.assertEqual(figures["press"]["cage_ball_1"]["contact_work_J"], result["physics/contact_work"][-1])
            pressed = np.linalg.norm(result["haptic/force"][:], axis=1).max()
        self.assertIn(f"{pressed:.4g}", (self.folder / "cages.csv").read_text())
        run = json.loads((self.folder / "run.json").read_text())["cage_ball_1"]
        self.assertGreater(run["deepest_dent_m"], 0.0)
        self.assertEqual((run["outcome"], run["peak_N"]), ("done", float(f"{pressed:.4g}")))
        trace = json.loads((ROOT / "tests/golden/ball.json").read_text())["trace"]["file"]
        self.assertEqual(run["trace_sha256"], hashlib.sha256((ROOT / "tests/golden" / trace).read_bytes()).hexdigest())

    def test_a_run_that_failed_says_so_and_what_is_known_of_others_stays(self):
        ball = simulate("tests/golden/ball.json", self.folder / "ball.h5", "/haptics/frame_period_ticks=7")
        with h5py.File(ball, "r+") as result:
            result.attrs["outcome"], result.attrs["complete"] = b"failed", 0
        (self.folder / "run.json").write_text('{"other": {"outcome": "done"}}')
        call(ROOT / "scripts/paper_runs.py", ball, "-o", self.folder / "run.json")
        runs = json.loads((self.folder / "run.json").read_text())
        self.assertEqual({name: run["outcome"] for name, run in runs.items()}, {"ball": "failed", "other": "done"})

    def test_the_clay_beside_measured_ones_is_as_formulas_have_it(self):
        rows = {row["quantity"]: row for row in paper_measures.compare_sizes(ARGIL)}
        modelled = rows["strength as modelled [kPa]"]
        self.assertAlmostEqual(modelled["argil"], 15.0, places=9)  # of the scenario's clay, before it is wetted
        self.assertAlmostEqual(modelled["low"], 10 ** (2.720 - 2.585 * 0.6))
        self.assertAlmostEqual(modelled["high"], 180.0 ** 0.8 * 2.3 ** 0.2)
        self.assertAlmostEqual(rows["one-dimensional modulus, as modelled [MPa]"]["argil"], 1.2 * 0.7 / (1.3 * 0.4), places=9)
        share = rows["water as modelled over that at the liquid limit [–]"]
        self.assertAlmostEqual(share["argil"], 0.21 * 1960 / (0.21 * 1960 + 280))
        self.assertEqual(share["factor"], 1.0)
        ratio = rows["modulus over strength, as modelled [–]"]
        self.assertAlmostEqual(ratio["argil"], 1.2e6 / 15e3)
        self.assertEqual(ratio["factor"], 1.0)
        liquid = rows["strength at the liquid limit [kPa]"]
        self.assertAlmostEqual(liquid["low"], 10 ** (2.720 - 2.585))
        self.assertEqual(liquid["factor"], 1.0)

    def test_the_lag_is_between_the_felt_moment_and_the_last_picture(self):
        felt, now = np.array([1, 10, 14, 29]), np.array([1, 10, 20, 29])
        np.testing.assert_array_equal(paper_measures.lag(felt, now, np.array([10, 20])), [1, 0, 6, 9])

    def test_the_ages_of_a_made_up_run(self):
        file = self.folder / "run.h5"
        with h5py.File(file, "w") as result:  # 20 ticks of 1 ms, a step each 4, a frame each 8, the force of the step
            tick = np.arange(20)
            result.attrs.update(format="argil-result", complete=1, haptic_period_s=1e-3)
            for name, data in {"haptic/tick": tick, "haptic/num_contacts": np.ones(20, int), "haptic/force_age": tick % 4,
                               "physics/tick": np.arange(4, 20, 4)}.items():
                result[name] = data
            for number in range(3):
                result.create_group(f"frames/{number:06d}").attrs.update(tick=8 * number)
        found = paper_measures.delay(file)
        for name, (mean, worst) in {"force_age": (1.5, 3), "lag_of_step": (0, 0), "lag_of_frame": (1.6, 4)}.items():
            self.assertAlmostEqual(found[name]["mean_s"], 1e-3 * mean)
            self.assertAlmostEqual(found[name]["worst_s"], 1e-3 * worst)


class Figure(Folder):
    def test_the_pushed_and_pulled_figure_has_the_dent_and_the_bump_that_its_scenario_tells(self):
        result = simulate("scenarios/demo_figure_push_pull.json", self.folder / "figure.h5")
        with h5py.File(result) as run:
            skin = paper_runs.measure_skin(run)
        self.assertAlmostEqual(skin["deepest_dent_m"], 4.1e-3, delta=0.1e-3)  # the digits that `about` gives
        self.assertAlmostEqual(skin["highest_bump_m"], 5.7e-3, delta=0.1e-3)
        self.assertGreater(skin["dent_left_m"], 0.5 * skin["deepest_dent_m"])
        self.assertGreater(skin["bump_left_m"], 0.5 * skin["highest_bump_m"])
        with h5py.File(result) as run:
            force, pull = run["haptic/force"][:], run["haptic/mode"][:] == 1
            strongest = force[pull][np.linalg.norm(force[pull], axis=1).argmax()]
        self.assertLess(strongest[0], -0.7)  # [N]; the chest looks along +x
        self.assertLess(np.linalg.norm(force, axis=1).max(), 3.3)  # of a desktop device


if __name__ == "__main__":
    unittest.main()
