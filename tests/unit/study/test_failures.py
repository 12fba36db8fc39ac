#!/usr/bin/python3
"""Every scenario in scenarios/failures ends as its `about` says: "Ends as OUTCOME by design of STUDY: tick T, stage: quantity …".

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


def share_above_50_hz(result):
    """Rms of the hand force above 50 Hz over its rms, by Parseval's theorem of the series under a Hann window."""
    with h5py.File(result) as data:
        time, force = data["haptic/time"][()], data["haptic/force"][()]
    spectrum = np.abs(np.fft.rfft(force * np.hanning(len(force))[:, None], axis=0))**2
    spectrum[1:] *= 2  # what stands for both signs of the frequency
    frequency = np.fft.rfftfreq(len(force), time[1] - time[0])
    return np.sqrt(spectrum[frequency > 50].sum() / spectrum.sum())


class Failures(unittest.TestCase):
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
                self.assertEqual(run.returncode, 3 if outcome in ENDS_EARLY else 2 if outcome == "refused" else 0, run.stderr)
                if outcome == "refused":
                    self.assertFalse(result.exists())
                    continue
                if outcome in ENDS_EARLY:
                    said = about.split(": ", 2)[2].split(" is ")[0]  # stage and quantity, without tick and digits
                    self.assertIn(said, run.stderr)
                if outcome == "chatter":
                    self.assertGreater(share_above_50_hz(result), 0.1)
                with h5py.File(result) as data:  # nothing in the file is no number
                    def check(name, item):
                        if isinstance(item, h5py.Dataset) and item.dtype.kind == "f":
                            self.assertTrue(np.isfinite(item[()]).all(), name)
                    data.visititems(check)


if __name__ == "__main__":
    unittest.main()
