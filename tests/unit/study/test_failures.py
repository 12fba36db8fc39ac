#!/usr/bin/python3
"""Every scenario in scenarios/failures ends as its `about` says: "Ends as OUTCOME by design of STUDY: tick T, stage: quantity …",
and one that is wrong by how much, beside itself with other settings: "…: the hand force is off by E from that of the same with …".

Usage: test_failures.py ARGIL        the program
"""
import json
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import h5py
import numpy as np

ARGIL = str(Path(sys.argv.pop(1)).resolve())
FOLDER = Path(__file__).resolve().parents[3] / "scenarios" / "failures"
ENDS_EARLY = ("growing_energy", "inverted", "not_converged", "failed")


def read_force(result):
    with h5py.File(result) as data:
        return data["haptic/time"][()], data["haptic/force"][()]


def share_above_50_hz(result):
    """Rms of the hand force above 50 Hz over its rms, by Parseval's theorem of the series under a Hann window."""
    time, force = read_force(result)
    spectrum = np.abs(np.fft.rfft(force * np.hanning(len(force))[:, None], axis=0))**2
    spectrum[1:] *= 2  # what stands for both signs of the frequency
    frequency = np.fft.rfftfreq(len(force), time[1] - time[0])
    return np.sqrt(spectrum[frequency > 50].sum() / spectrum.sum())


class Failures(unittest.TestCase):
    def assert_force_is_off(self, file, result, error, settings):
        truth = result.with_name("truth.h5")
        sets = [word for setting in settings.split() for word in ("--set", setting)]
        run = subprocess.run([ARGIL, "run", file, "-q", "-o", truth, *sets], capture_output=True, text=True)
        self.assertEqual(run.returncode, 0, run.stderr)
        time, force = read_force(result)
        true_time, true_force = read_force(truth)
        place = np.searchsorted(true_time, time - 1e-6)  # the truth may have finer ticks
        np.testing.assert_allclose(true_time[place], time, atol=1e-9)
        found = np.linalg.norm(force - true_force[place]) / np.linalg.norm(true_force[place])
        self.assertGreater(found, 0.1)
        self.assertAlmostEqual(found / float(error), 1.0, delta=0.05)

    def test_each_ends_as_it_says(self):
        files = sorted(FOLDER.glob("*.json"))
        self.assertTrue(files)
        for file in files:
            with self.subTest(file.name), tempfile.TemporaryDirectory() as folder:
                about = json.loads(file.read_text())["about"]
                outcome = about.split()[2]
                self.assertTrue(about.startswith("Ends as ") and file.stem.endswith(outcome), about)
                result = Path(folder, "out.h5")
                run = subprocess.run([ARGIL, "run", file, "-q", "-o", result], capture_output=True, text=True)
                ends_early = outcome in ENDS_EARLY or ": tick " in about  # so do hands that chatter hard
                self.assertEqual(run.returncode, 3 if ends_early else 2 if outcome == "refused" else 0, run.stderr)
                if outcome == "refused":
                    self.assertFalse(result.exists())
                    continue
                if ends_early:
                    said = about.split(": ", 2)[2].split(" is ")[0]  # stage and quantity, without tick and digits
                    self.assertIn(said, run.stderr)
                if outcome == "chatter":
                    self.assertGreater(share_above_50_hz(result), 0.1)
                if outcome == "wrong":
                    self.assert_force_is_off(file, result, *about.split(" off by ")[1].split(" from that of the same with "))
                with h5py.File(result) as data:  # nothing in the file is no number
                    def check(name, item):
                        if isinstance(item, h5py.Dataset) and item.dtype.kind == "f":
                            self.assertTrue(np.isfinite(item[()]).all(), name)
                    data.visititems(check)


if __name__ == "__main__":
    unittest.main()
