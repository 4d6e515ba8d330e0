"""`seatrial drive` in a terminal: pyte renders what it draws, keys go in as a person's would."""

import math
import os
import pty
import re
import struct
import subprocess
import sys
import threading
import time
from fcntl import ioctl
from termios import TIOCSWINSZ

import pytest

from seatrial.errors import InputError
from seatrial_kits.videoray.driving.keys import Gamepad, split_keys
from seatrial_kits.videoray.driving.pilot import HELP, KEY_LASTS, TURNS, Pilot

from .live import LiveRov

pyte = pytest.importorskip("pyte")
WAIT_S = 60.0


class Terminal:
    """A terminal of 80 columns and 24 rows with a command in it."""

    def __init__(self, *command):
        self.screen = pyte.Screen(80, 24)
        self._stream = pyte.ByteStream(self.screen)
        self.own, other = pty.openpty()
        ioctl(other, TIOCSWINSZ, struct.pack("HHHH", 24, 80, 0, 0))
        environment = {**os.environ, "TERM": "xterm-256color", "COLUMNS": "80", "LINES": "24"}
        self.process = subprocess.Popen(
            command,
            stdin=other,
            stdout=other,
            stderr=other,
            env=environment,
            start_new_session=True,
        )
        os.close(other)
        # Always read, as terminals are: a command stops that nobody reads.
        self._lock = threading.Lock()
        self._reader = threading.Thread(target=self._read)
        self._reader.start()

    def _read(self):
        try:
            while data := os.read(self.own, 65536):
                with self._lock:
                    self._stream.feed(data)
        except OSError:
            pass  # the other end is closed

    def until(self, pattern):
        """Wait until the screen shows a pattern; return the screen."""
        deadline = time.monotonic() + WAIT_S
        while True:
            with self._lock:
                text = "\n".join(self.screen.display)
            if re.search(pattern, text):
                return text
            assert time.monotonic() < deadline, text
            time.sleep(0.02)

    def press(self, keys):
        os.write(self.own, keys.encode())

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self.process.poll() is None:
            self.process.kill()
        self.process.wait(WAIT_S)
        self._reader.join(WAIT_S)
        os.close(self.own)


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="terminals")
def test_a_pilot_sees_the_vehicle_and_drives_it(tmp_path):
    with LiveRov(f"pty:{tmp_path}/rov", watchdog=30.0) as live:
        command = [sys.executable, "-c", "from seatrial.cli import main; main()", "drive"]
        with Terminal(*command, f"serial:{live.at}:115200") as terminal:
            shown = terminal.until(r"vehicle J14461\s+disarmed")
            assert re.search(r"057\.3°", shown)
            assert re.search(r"depth\s+3\.0[01] m", shown)
            assert re.search(r"roll, pitch \+2\.9°\s+-1\.7°", shown)
            terminal.press("w")  # disarmed: nothing
            terminal.press("ml")
            terminal.until("ARMED")
            terminal.until(r"lights\s+10%")
            assert live.rov.get("duty")[0] == 0.0
            terminal.press("]zh")
            terminal.until(r"hold 3\.0[01] m")
            terminal.until(r"hold 57°")
            live.wait(lambda: live.rov.get("auto_depth") and live.rov.get("auto_heading"))
            live.wait(lambda: live.rov.get("lights") == pytest.approx(0.1))
            terminal.press(" ")
            live.wait(lambda: not live.rov.get("auto_depth"))
            deadline = time.monotonic() + WAIT_S
            while live.rov.get("duty")[0] <= 0.38:  # held down, as a terminal repeats it
                assert time.monotonic() < deadline
                terminal.press("w")
                time.sleep(0.05)
            live.wait(lambda: live.rov.get("duty")[0] == 0.0)  # let go: it expires
            terminal.press("q")
            assert terminal.process.wait(WAIT_S) == 0


def test_a_key_expires_and_deflections_keep_within_their_ends():
    pilot = Pilot(share=1.0)
    pilot.press("w", 10.0)
    pilot.press("right", 10.0)
    pilot.gamepad[0] = 0.5
    assert pilot.manual(10.0 + 0.9 * KEY_LASTS) == (1.0, TURNS, 0.0)
    assert pilot.manual(10.0 + 1.1 * KEY_LASTS) == (0.5, 0.0, 0.0)


def test_a_key_that_turns_makes_a_thirtieth_of_the_thrust():
    pilot = Pilot()
    pilot.press("w", 0.0)
    pilot.press("a", 0.0)
    assert pilot.manual(0.1) == pytest.approx((0.3, -0.01, 0.0))


def test_disarming_lets_go_of_all():
    pilot = Pilot(depth=2.0)
    for key in ("m", "z", "h", "s"):
        pilot.press(key, 0.0)
    assert (pilot.armed, pilot.hold_depth, pilot.depth_wanted) == (True, True, 2.0)
    pilot.press("m", 0.0)
    assert (pilot.armed, pilot.hold_depth, pilot.hold_heading) == (False, False, False)
    assert pilot.manual(0.0) == (0.0, 0.0, 0.0)


def test_a_heading_that_is_held_is_turned_across_north():
    pilot = Pilot(heading=0.1)
    pilot.toggle_heading()
    for degrees, wanted in ((-20.0, 0.1 - math.radians(20.0) + math.tau), (20.0, 0.1)):
        pilot.turn(degrees)
        assert pilot.heading_wanted == pytest.approx(wanted)


def test_every_key_of_the_help_does_something():
    for keys, _ in HELP:
        for key in keys.replace("space", " ").split() or [" "]:
            pilot, other = (
                Pilot(share=0.5, lights=0.5, depth=1.0),
                Pilot(share=0.5, lights=0.5, depth=1.0),
            )
            pilot.manipulator = other.manipulator = 2
            pilot.hold_depth = other.hold_depth = True
            pilot.depth_wanted = other.depth_wanted = 5.0
            pilot.press(key, 0.0)
            assert pilot != other, key


def test_arrows_and_letters_are_distinguished():
    keys = split_keys(b"w\x1b[A\x1bOB\x1b[5~\x1b[Dq\x1b")
    assert keys == ["w", "up", "down", "page up", "left", "q", "\x1b"]


@pytest.mark.skipif(sys.platform == "win32", reason="FIFOs")
def test_a_gamepad_drives_and_disarms_when_it_is_gone(tmp_path):
    os.mkfifo(tmp_path / "js0")
    reader = os.open(tmp_path / "js0", os.O_RDONLY | os.O_NONBLOCK)
    writer = os.open(tmp_path / "js0", os.O_WRONLY)
    pad, pilot = Gamepad(tmp_path / "js0"), Pilot(depth=4.0)
    os.close(reader)

    def event(value, kind, number):
        os.write(writer, struct.pack("IhBB", 0, value, kind, number))
        pad.poll(pilot)

    pad.poll(pilot)
    event(-32767, 2, 1)
    event(16384, 2 | 0x80, 0)
    event(1000, 2, 4)  # near its middle
    event(1, 1, 0)
    event(1, 1, 2)
    assert pilot.manual(0.0) == pytest.approx((1.0, 0.5, 0.0), abs=1e-4)
    assert (pilot.armed, pilot.hold_depth, pilot.depth_wanted) == (True, True, 4.0)
    os.close(writer)
    pad.poll(pilot)
    assert (pilot.armed, pilot.hold_depth, pilot.manual(0.0)) == (False, False, (0.0, 0.0, 0.0))
    pad.poll(pilot)
    with pytest.raises(InputError, match="--gamepad"):
        Gamepad(tmp_path / "js1")
