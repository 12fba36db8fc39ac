#!/usr/bin/python3
"""scripts/peers.py presses the ball with every program that is there, says what is not, and argil's force is CalculiX's.

Usage: test_peers.py ARGIL        the program
"""
import csv
import importlib.util
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
ARGIL = Path(sys.argv.pop(1)).resolve()
if any(importlib.util.find_spec(name) is None for name in ("numpy", "h5py", "matplotlib")):
    print("skipped: needs numpy, h5py and matplotlib")
    sys.exit(77)
sys.path.insert(0, str(ROOT / "scripts"))
sys.dont_write_bytecode = True
from peer_programs import with_argil


def read_table(file):
    return list(csv.DictReader(file.read_text(encoding="utf-8").splitlines()[1:]))


class Peers(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="argil_peers_")
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def run_script(self, **environment):
        """What it prints, and the rows of its table."""
        done = subprocess.run([ROOT / "scripts/peers.py", "--quick", "--argil", ARGIL, "-o", self.folder], text=True,
                              capture_output=True, check=False, env={**os.environ, **environment})
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertTrue((self.folder / "peers.png").is_file())
        return done.stdout, read_table(self.folder / "peers.csv")

    def test_a_program_that_is_not_there_is_left_out_with_a_word(self):
        (self.folder / "git").symlink_to("/usr/bin/git")  # the table says of which commit it is
        printed, rows = self.run_script(PATH=str(self.folder))
        self.assertEqual({row["program"] for row in rows}, {"argil"})
        for word in ("Bullet is left out: needs g++", "MuJoCo is left out: needs node", "CalculiX is left out: needs ccx"):
            self.assertIn(word, printed)

    def test_what_is_there_bears_the_ball(self):
        """Coarse meshes are too stiff, by less than once the limit of the law."""
        printed, rows = self.run_script()
        programs = {row["program"] for row in rows}
        self.assertEqual(len(programs), 4 - printed.count("is left out"))
        for row in rows:
            with self.subTest(program=row["program"], element=row["element"]):
                self.assertTrue(0 < float(row["error_percent"]) < 100, row)
                self.assertGreater(float(row["cpu_s"]), 0)

    def test_argil_bears_what_calculix_does(self):
        """With the one law that both have, linear in the displacement, within the error of CalculiX's limit and that of argil's mesh,
        which its other law shows."""
        table = [row for row in read_table(ROOT / "results/peers/reference.csv") if row["is_limit"] == "yes"]
        limit = {row["law"]: (float(row["force_N"]), float(row["error_N"])) for row in table}
        force = {law: with_argil.press(self.folder, ARGIL, 6, 0.05, law=law, element="p2")["force_N"]
                 for law in ("linear", "corotational")}
        known, error = limit["linear"]
        mesh = abs(force["corotational"] / limit["corotational"][0] - 1)
        self.assertLess(mesh, 0.01)
        self.assertLess(abs(force["linear"] - known), error + mesh * known, force)


if __name__ == "__main__":
    unittest.main()
