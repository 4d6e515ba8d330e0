"""Keys of a terminal and events of a gamepad, polled and never waited for."""

from __future__ import annotations

import os
import struct
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from seatrial.errors import InputError

from .pilot import Pilot

_SEQUENCES = {
    b"[A": "up",
    b"[B": "down",
    b"[C": "right",
    b"[D": "left",
    b"OA": "up",
    b"OB": "down",
    b"OC": "right",
    b"OD": "left",
    b"[5~": "page up",
    b"[6~": "page down",
}
_ESCAPE = 0x1B
_OWN_SCREEN_ENDS = b"\x1b[?1049l\x1b[?25h"
"""Back to the screen of before (xterm's control sequences), with its cursor."""

_EVENT = struct.Struct("IhBB")
"""Linux's joystick interface (js_event): time ms, value, type, number."""
_BUTTON, _AXIS, _INITIAL = 1, 2, 0x80
_FULL = 32767.0
_DEAD = 0.08
"""Share of a stick's way that is regarded as its middle."""
_AXES = {1: (0, -1.0), 0: (1, 1.0), 4: (2, 1.0)}
"""Left stick ahead and to the side, right stick down: axis of manual control, and sign."""


@contextmanager
def raw_terminal() -> Iterator[None]:
    """Give keys as they are pressed, without echo. Raises InputError if there is no terminal."""
    if not sys.stdin.isatty() or not sys.stdout.isatty():
        raise InputError("drive needs a terminal for its keys and its picture")
    import termios
    import tty

    descriptor = sys.stdin.fileno()
    before = termios.tcgetattr(descriptor)
    tty.setcbreak(descriptor)
    os.set_blocking(descriptor, False)
    try:
        yield
    finally:
        os.set_blocking(descriptor, True)
        termios.tcsetattr(descriptor, termios.TCSADRAIN, before)


@contextmanager
def restored_terminal() -> Iterator[None]:
    """Leave the terminal as it was, whatever became of the process that had it."""
    if not sys.stdin.isatty() or not sys.stdout.isatty():
        yield
        return
    import termios

    descriptor = sys.stdin.fileno()
    before, blocking = termios.tcgetattr(descriptor), os.get_blocking(descriptor)
    try:
        yield
    finally:
        os.set_blocking(descriptor, blocking)
        if termios.tcgetattr(descriptor) != before:
            termios.tcsetattr(descriptor, termios.TCSADRAIN, before)
            os.write(sys.stdout.fileno(), _OWN_SCREEN_ENDS)


def pressed_keys() -> list[str]:
    """Return the keys that were pressed since the last call, arrows by name."""
    try:
        data = os.read(sys.stdin.fileno(), 1024)
    except BlockingIOError:
        return []
    return split_keys(data)


def split_keys(data: bytes) -> list[str]:
    """Return the keys in what a terminal sent."""
    keys = []
    place = 0
    while place < len(data):
        rest = data[place + 1 :]
        name = next((s for s in _SEQUENCES if data[place] == _ESCAPE and rest.startswith(s)), None)
        keys.append(_SEQUENCES[name] if name else chr(data[place]))
        place += 1 + len(name or b"")
    return keys


class Gamepad:
    """A gamepad at Linux's joystick interface, such as /dev/input/js0.

    Left stick: ahead and turn; right stick: down and up. Buttons: 0 arms and disarms, 2 holds
    the depth, 3 the heading. One that is gone lets go of all and disarms. Raises InputError for a
    device that cannot be opened.
    """

    def __init__(self, device: Path) -> None:
        try:
            self._descriptor: int | None = os.open(device, os.O_RDONLY | os.O_NONBLOCK)
        except OSError as error:
            raise InputError(f"--gamepad: cannot open {device}: {error.strerror}") from None
        self._part = b""

    def poll(self, pilot: Pilot) -> None:
        """Apply to the pilot what has happened since the last call."""
        if self._descriptor is None:
            return
        try:
            data = os.read(self._descriptor, 64 * _EVENT.size)
        except BlockingIOError:
            return
        except OSError:
            data = b""
        if not data:
            self.close()
            pilot.gamepad[:] = [0.0, 0.0, 0.0]
            if pilot.armed:
                pilot.toggle_armed()
            return
        data = self._part + data
        whole = len(data) - len(data) % _EVENT.size
        self._part = data[whole:]
        for _, value, kind, number in _EVENT.iter_unpack(data[:whole]):
            _apply(pilot, value, kind, number)

    def close(self) -> None:
        """Let go of the device."""
        if self._descriptor is not None:
            os.close(self._descriptor)
        self._descriptor = None


def _apply(pilot: Pilot, value: int, kind: int, number: int) -> None:
    if kind & ~_INITIAL == _AXIS and number in _AXES:
        axis, sign = _AXES[number]
        share = value / _FULL
        pilot.gamepad[axis] = 0.0 if abs(share) < _DEAD else sign * min(max(share, -1.0), 1.0)
    elif kind == _BUTTON and value:
        pressed = {0: pilot.toggle_armed, 2: pilot.toggle_depth, 3: pilot.toggle_heading}
        pressed.get(number, lambda: None)()
