#!/usr/bin/python3
"""Stands in for a 6-DoF controller: a Magellan (serial protocol) on a pseudo-terminal, read by a spacenavd started here.

The cap is pushed along its second axis to the end of the device's reach, then moved to and fro along the first, and
drawn back, again and again. Prints "socket FILE" for SPNAV_SOCKET; ends, with the daemon, when its standard input does.

Usage: spacenav_stand_in.py [--counts 120] [--stroke SECONDS]
"""
import argparse
import math
import os
import pty
import select
import signal
import subprocess
import sys
import tempfile
import threading
import time
import tty
from pathlib import Path

ZERO = 0x8000
PERIOD = 0.02  # [s] between two lines


def encode(axes):
    """One line: "d" and four nibbles an axis, each 0x40 and its bits."""
    nibbles = [chr(0x40 | (axis + ZERO) >> shift & 15) for axis in axes for shift in (12, 8, 4, 0)]
    return "d" + "".join(nibbles) + "\r"


def move_cap(seconds, counts, stroke):
    """Three parts of a period: towards the body, along it and still pushed, away by a twelfth of the first part."""
    phase = seconds / stroke % 3.0
    if phase < 1.0:
        return [0, 3 * counts, 0, 0, 0, 0]
    if phase < 2.0:
        return [round(counts * math.sin(4.0 * math.pi * phase) / 4.0), counts // 4, 0, 0, 0, 0]
    return [0, -counts // 4, 0, 0, 0, 0]


class Controller:
    def __init__(self, counts, stroke):
        self.master, self.slave = pty.openpty()
        tty.setraw(self.slave)
        self.name = os.ttyname(self.slave)
        self.is_known = threading.Event()
        self.counts, self.stroke = counts, stroke

    def say(self, text):
        os.write(self.master, text.encode("ascii"))

    def play(self):
        heard, start = b"", None
        while True:
            if select.select([self.master], [], [], PERIOD)[0]:
                heard += os.read(self.master, 256)
            if b"vQ\r" in heard:
                heard = heard.replace(b"vQ\r", b"", 1)
                self.say("vMAGELLAN  Version 6.60  3D-Mouse\r")
            if b"m3\r" in heard and start is None:
                start = time.monotonic()
                self.is_known.set()
            if start is not None:
                self.say(encode(move_cap(time.monotonic() - start, self.counts, self.stroke)))
                time.sleep(PERIOD)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--counts", type=int, default=120)
    parser.add_argument("--stroke", type=float, default=2.0)
    options = parser.parse_args()
    controller = Controller(options.counts, options.stroke)
    threading.Thread(target=controller.play, daemon=True).start()
    with tempfile.TemporaryDirectory() as folder:
        # Debian's daemon makes its socket as run/spnav.sock where it is started.
        (Path(folder) / "run").mkdir()
        socket = Path(folder) / "run" / "spnav.sock"
        config = Path(folder) / "spnavrc"
        config.write_text(f"serial = {controller.name}\nled = 0\n", encoding="ascii")
        daemon = subprocess.Popen(["spacenavd", "-d", "-c", config, "-l", Path(folder) / "log"], cwd=folder,
                                  stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            deadline = time.monotonic() + 30.0
            while not (controller.is_known.is_set() and socket.exists()):
                if time.monotonic() > deadline:
                    sys.exit("spacenav_stand_in.py: spacenavd does not see the controller")
                time.sleep(0.01)
            print("socket", socket, flush=True)
            sys.stdin.read()
        finally:
            daemon.send_signal(signal.SIGTERM)
            daemon.wait()


if __name__ == "__main__":
    main()
