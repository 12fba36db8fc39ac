#!/usr/bin/python3
"""Stands in for the Haply Inverse Service on loopback: the simulation channel (WebSocket, JSON) with one Inverse3.

First an inventory, then one state for each message. A hand of mass 0.15 kg on a spring of 300 N/m circles slowly and
yields to the force. Prints "port N", then for each connection a JSON line: messages received, states sent, force
commands before the first state (all must be zero), largest and last force, the longest time for which a force was not
renewed [s]. Ends when its standard input does.

Usage: haply_stand_in.py [--mode MODE] [--good STATES] [--port PORT]
"""
import argparse
import base64
import contextlib
import hashlib
import json
import math
import os
import socket
import struct
import sys
import threading
import time

MASS, STIFFNESS, DAMPING = 0.15, 300.0, 6.0
MODES = ("normal", "no_device", "garbage", "not_websocket", "half", "late", "slow", "surplus", "zero_quaternion", "nan",
         "null", "huge", "unplugged", "vanish", "silent", "oversized", "endless")
OVERSIZE = 24 << 20  # bytes; more than WebSocket libraries take unless told, and than any real state


class Gone(Exception):
    """The client has closed."""


class Hand:
    """Circles of 1 cm radius in x and y, one in 4 s, about (0, -0.12, 0.15)."""

    def __init__(self):
        self.start = self.now = time.monotonic()
        self.x = self.intent(0.0)
        self.v = [0.0, 0.0, 0.0]

    @staticmethod
    def intent(t):
        angle = math.pi / 2.0 * t
        return [0.01 * math.cos(angle), -0.12 + 0.01 * math.sin(angle), 0.15]

    def move(self, force):
        now = time.monotonic()
        steps = max(1, math.ceil((now - self.now) / 0.001))
        h = min(now - self.now, 0.1) / steps
        target = self.intent(now - self.start)
        for _ in range(min(steps, 100)):
            for i in range(3):
                pull = STIFFNESS * (target[i] - self.x[i]) - DAMPING * self.v[i] + force[i]
                self.v[i] += h * pull / MASS
                self.x[i] += h * self.v[i]
        self.now = now


class Connection:
    def __init__(self, stream, mode, good):
        self.stream, self.mode, self.good = stream, mode, good
        self.buffer = b""
        self.hand = Hand()
        self.report = {"messages": 0, "states": 0, "largest_force": 0.0, "last_force": [0.0] * 3, "forced_too_early": 0,
                       "unreadable": 0, "closed_well": False, "longest_hold": 0.0}
        self.forced_at = 0.0  # of the force that is held; 0: none is

    def take(self, count):
        while len(self.buffer) < count:
            more = self.stream.recv(65536)
            if not more:
                raise Gone
            self.buffer += more
        piece, self.buffer = self.buffer[:count], self.buffer[count:]
        return piece

    def shake_hands(self):
        head = b""
        while not head.endswith(b"\r\n\r\n"):
            head += self.take(1)
        lines = head.decode("latin-1").split("\r\n")[1:]
        fields = {name.strip().lower(): value.strip() for name, _, value in (line.partition(":") for line in lines)}
        accept = hashlib.sha1((fields["sec-websocket-key"] + "258EAFA5-E914-47DA-95CA-C5AB0DC85B11").encode()).digest()
        self.stream.sendall(b"HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                            b"Sec-WebSocket-Accept: " + base64.b64encode(accept) + b"\r\n\r\n")

    def read_message(self):
        first, second = self.take(2)
        size = second & 127
        if size == 126:
            size, = struct.unpack(">H", self.take(2))
        elif size == 127:
            size, = struct.unpack(">Q", self.take(8))
        assert second & 128, "a client masks its frames"
        mask = self.take(4)
        body = bytes(byte ^ mask[i % 4] for i, byte in enumerate(self.take(size)))
        if first & 15 == 8:
            self.report["closed_well"] = True
            raise Gone
        return body.decode()

    @staticmethod
    def frame(text):
        body = text.encode()
        size = struct.pack("B", len(body)) if len(body) < 126 else struct.pack(">BH", 126, len(body))
        return b"\x81" + size + body

    def send(self, text):
        self.stream.sendall(self.frame(text))

    def send_oversized(self, text):
        """The text after so many blanks, which JSON ignores, in one frame."""
        self.stream.sendall(struct.pack(">BBQ", 0x81, 127, OVERSIZE + len(text)) + b" " * OVERSIZE + text.encode())

    def send_endless(self, _):
        """A message whose every fragment is small and the last never comes."""
        fragment = struct.pack(">BBH", 0, 126, 0xffff) + b" " * 0xffff
        self.stream.sendall(b"\x01" + fragment[1:])
        while True:
            self.stream.sendall(fragment)

    def send_beside(self, send, text):
        """In a thread, so that what the client says meanwhile is read."""
        def run():
            with contextlib.suppress(OSError):  # the client has closed
                send(text)
        threading.Thread(target=run, daemon=True).start()

    def state(self):
        x, y, z = self.hand.x
        grip = {"orientation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}, "buttons": {"a": False, "b": False, "c": False}}
        device = {"cursor_position": {"x": x, "y": y, "z": z}, "cursor_velocity": dict(zip("xyz", self.hand.v))}
        return {"inverse3": [{"device_id": "04BA", "state": device, "status": {"ready": True}}],
                "wireless_verse_grip": [{"device_id": "61548", "state": grip}]}

    def inventory(self):
        full = self.state()
        full["session_id"] = 7
        full["inverse3"][0]["config"] = {"type": "inverse3", "handedness": "right", "preset": "defaults"}
        if self.mode == "no_device":
            full["inverse3"] = []
        return full

    def take_force(self, text):
        try:
            device, = json.loads(text)["inverse3"]
            assert device["device_id"] == "04BA"
            vector = device["commands"]["set_cursor_force"]["vector"]
            force = [float(vector[axis]) for axis in "xyz"]
        except (ValueError, KeyError, AssertionError):
            self.report["unreadable"] += 1
            return
        size = math.sqrt(sum(f * f for f in force))
        self.report["forced_too_early"] += self.report["states"] == 0 and size > 0.0
        self.report["largest_force"] = max(self.report["largest_force"], size)
        self.report["last_force"] = force
        now = time.monotonic()
        if self.forced_at:
            self.report["longest_hold"] = max(self.report["longest_hold"], now - self.forced_at)
        self.forced_at = now if size > 0.0 else 0.0

    def answer(self):
        """One state, or what the mode makes of it after so many good ones."""
        self.hand.move(self.report["last_force"])
        state, mode = self.state(), self.mode
        cursor = state["inverse3"][0]["state"]["cursor_position"]
        orientation = state["wireless_verse_grip"][0]["state"]["orientation"]
        if self.report["states"] < self.good or mode == "normal":
            self.send(json.dumps(state))
        elif mode == "garbage":
            self.send('}{"inverse3": [[[[[' + "\x00\x7f" * 20)
        elif mode == "not_websocket":
            self.stream.sendall(bytes(range(256)))
        elif mode == "half":
            whole = self.frame(json.dumps(state))
            self.stream.sendall(whole[:len(whole) // 2])
            self.mode = "silent"
        elif mode == "late":
            if self.report["states"] % 20 == 0:
                time.sleep(0.15)
            self.send(json.dumps(state))
        elif mode == "slow":
            time.sleep(0.05)
            self.send(json.dumps(state))
        elif mode == "surplus":
            self.send(json.dumps(state))
            self.send(json.dumps(state))
        elif mode == "oversized":
            self.send_beside(self.send_oversized, json.dumps(state))
        elif mode == "endless":
            self.send_beside(self.send_endless, "")
        elif mode == "unplugged":
            state["inverse3"] = []
            self.send(json.dumps(state))
        elif mode == "vanish":
            self.stream.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))  # reset, no farewell
            raise Gone
        elif mode != "silent":
            if mode == "zero_quaternion":
                orientation["w"] = 0.0
            else:
                cursor["y"] = {"nan": math.nan, "null": None, "huge": 1e300}[mode]
            self.send(json.dumps(state))
        self.report["states"] += 1

    def serve(self):
        self.shake_hands()
        self.send(json.dumps(self.inventory()))
        while True:
            text = self.read_message()
            self.report["messages"] += 1
            self.take_force(text)
            self.answer()


def end_with_standard_input():
    sys.stdin.read()
    os._exit(0)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--mode", choices=MODES, default="normal")
    parser.add_argument("--good", type=int, default=50, metavar="STATES", help="good ones before the mode begins")
    parser.add_argument("--port", type=int, default=0)
    arguments = parser.parse_args()
    threading.Thread(target=end_with_standard_input, daemon=True).start()
    listener = socket.create_server(("127.0.0.1", arguments.port))
    print("port", listener.getsockname()[1], flush=True)
    while True:
        stream, _ = listener.accept()
        stream.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        connection = Connection(stream, arguments.mode, arguments.good)
        try:
            connection.serve()
        except (Gone, OSError):
            pass
        stream.close()
        print(json.dumps(connection.report), flush=True)


if __name__ == "__main__":
    main()
