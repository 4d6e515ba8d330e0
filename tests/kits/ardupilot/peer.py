"""A stand-in for ArduPilot's simulated firmware, after its documented packets.

It sends servo packets and reads answers as the firmware does: it finds a name in the text, and its
value two characters further on. As a program it takes the firmware's options.
"""

from __future__ import annotations

import os
import re
import socket
import struct
import sys
import time

MAGIC = {16: 18458, 32: 29569}
RESEND_S = 1.0
_NUMBER = re.compile(rb"-?\d+(\.\d+)?([eE][-+]?\d+)?")


def read_number(text: bytes) -> float:
    match = _NUMBER.match(text)
    assert match, f"no number at {text[:20]!r}"
    return float(match[0])


class Answer:
    """One line, and what the firmware's way of reading finds in it."""

    def __init__(self, data: bytes) -> None:
        assert data[:1] == b"\n", "no line feed before it"
        assert data[-1:] == b"\n", "no line feed after it"
        self.line = data.strip()

    def has(self, name: str, section: str = "") -> bool:
        return b'"%s"' % (section or name).encode() in self.line

    def number(self, name: str, section: str = "") -> float:
        return read_number(self._at(name, section))

    def vector(self, name: str, section: str = "") -> tuple[float, ...]:
        inside = self._at(name, section)
        assert inside[:1] == b"["
        return tuple(read_number(part) for part in inside[1 : inside.index(b"]")].split(b","))

    def _at(self, name: str, section: str) -> bytes:
        start = self.line.index(section.encode()) + len(section) + 1 if section else 0
        return self.line[self.line.index(name.encode(), start) + len(name) + 2 :]


class Peer:
    """The firmware's end of the exchange."""

    def __init__(self, port: int, channels: int = 16, rate: int = 100) -> None:
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.connect(("127.0.0.1", port))
        self.channels, self.rate, self.count = channels, rate, 0
        self.resent = 0

    def send(self, *pwm: int) -> None:
        """Send the frame that is due, without the next number."""
        widths = (*pwm, *(0,) * (self.channels - len(pwm)))
        head = struct.pack("<HHI", MAGIC[self.channels], self.rate, self.count)
        self.socket.send(head + struct.pack(f"<{self.channels}H", *widths))

    def receive(self, timeout: float = 5.0) -> Answer | None:
        """Return the answer, None if there is none in time."""
        self.socket.settimeout(timeout)
        try:
            return Answer(self.socket.recv(65536))
        except TimeoutError:
            return None

    def exchange(self, *pwm: int, deadline_s: float = 20.0) -> Answer:
        """Send a frame until it is answered."""
        deadline = time.monotonic() + deadline_s
        while time.monotonic() < deadline:
            try:
                self.send(*pwm)
                answer = self.receive(RESEND_S)
            except ConnectionRefusedError:
                time.sleep(0.01)  # nobody is there yet
                continue
            if answer is not None:
                self.count += 1
                return answer
            self.resent += 1
        raise TimeoutError("no answer")

    def close(self) -> None:
        self.socket.close()


def main() -> None:
    """Send no pulses for a second of simulated time, then drive ahead; keep all answers."""
    options = dict(zip(sys.argv[1::2], sys.argv[2::2], strict=True))
    print("pid", os.getpid())
    print("options:", *sys.argv[1:], flush=True)
    if options["--model"] != "JSON:127.0.0.1":
        sys.exit("there is no such model")
    peer = Peer(int(options["--sim-port-out"]), 16, int(options["--rate"]))
    with open("eeprom.bin", "wb") as memory:
        memory.write(b"kept")
    t = 0.0
    with open("answers.jsonl", "wb", buffering=0) as answers:
        while True:
            widths = (1700, 0, 1700) if t > 1.0 else ()
            answer = peer.exchange(*widths)
            answers.write(answer.line + b"\n")
            t = answer.number("timestamp")


if __name__ == "__main__":
    main()
