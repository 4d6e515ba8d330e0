"""Pilot's orders: keys and gamepad to manual control, holds, lights and camera."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

KEY_LASTS = 0.7
"""Seconds for which a key of manual control lasts: a terminal reports no release, and repeats
after less."""

TURNS = 1 / 30
"""Share of a key's thrust that turns: with the thrust that goes ahead well, a tap would turn the
vehicle round."""

HELP = (
    ("m", "arm, disarm"),
    ("w s", "ahead, astern"),
    ("a d", "turn"),
    ("r f", "up, down"),
    ("space", "let go of all"),
    ("+ -", "thrust of a key"),
    ("z", "hold depth"),
    (", .", "higher, deeper"),
    ("h", "hold heading"),
    ("[ ]", "to port, to starboard"),
    ("k l", "lights"),
    ("t g", "camera up, down"),
    ("o c x", "gripper: open, close, stop"),
    ("q", "quit"),
)
"""Keys and what they do."""

_MANUAL_AXES = {
    "w": (0, 1.0),
    "s": (0, -1.0),
    "up": (0, 1.0),
    "down": (0, -1.0),
    "d": (1, 1.0),
    "a": (1, -1.0),
    "right": (1, 1.0),
    "left": (1, -1.0),
    "f": (2, 1.0),
    "r": (2, -1.0),
    "page down": (2, 1.0),
    "page up": (2, -1.0),
}
"""Key: axis (surge, yaw, heave) and its sign."""
_YAW = 1
_DEGREE = math.radians(1.0)


@dataclass
class Pilot:
    """Orders as they stand. ``depth`` and ``heading`` are the vehicle's, to hold what it has."""

    share: float = 0.3
    """Thrust of a key of manual control; a key that turns makes `TURNS` of it."""
    armed: bool = False
    lights: float = 0.0
    camera_tilt: float = 0.0
    hold_depth: bool = False
    depth_wanted: float = 0.0
    hold_heading: bool = False
    heading_wanted: float = 0.0
    manipulator: int = 0
    depth: float = 0.0
    heading: float = 0.0
    quits: bool = False
    gamepad: list[float] = field(default_factory=lambda: [0.0, 0.0, 0.0])
    """Its manual control: surge, yaw, heave."""
    _pressed: dict[int, tuple[float, float]] = field(default_factory=dict)

    def manual(self, now: float) -> tuple[float, float, float]:
        """Return surge, yaw and heave, -1 to 1; keys that were pressed too long ago are let go."""
        axes = list(self.gamepad)
        for axis, (sign, until) in self._pressed.items():
            if now < until:
                axes[axis] += sign * self.share * (TURNS if axis == _YAW else 1.0)
        return (_within(axes[0]), _within(axes[1]), _within(axes[2]))

    def press(self, key: str, now: float) -> None:
        """Take a key; others than those of `HELP` do nothing."""
        if key in _MANUAL_AXES:
            axis, sign = _MANUAL_AXES[key]
            self._pressed[axis] = (sign, now + KEY_LASTS)
        elif key in _ACTIONS:
            _ACTIONS[key](self)

    def toggle_armed(self) -> None:
        """Arm or disarm; either way nothing is pressed or held any more."""
        self.armed = not self.armed
        self.let_go()

    def let_go(self) -> None:
        """Release manual control and holds."""
        self._pressed.clear()
        self.hold_depth = self.hold_heading = False

    def toggle_depth(self) -> None:
        """Hold the depth that the vehicle has, or hold it no longer."""
        self.hold_depth, self.depth_wanted = not self.hold_depth, self.depth

    def toggle_heading(self) -> None:
        """Hold the heading that the vehicle has, or hold it no longer."""
        self.hold_heading, self.heading_wanted = not self.hold_heading, self.heading

    def deeper(self, metres: float) -> None:
        """Change the depth to hold."""
        self.depth_wanted = max(self.depth_wanted + metres, 0.0)

    def turn(self, degrees: float) -> None:
        """Change the heading to hold."""
        self.heading_wanted = (self.heading_wanted + degrees * _DEGREE) % math.tau

    def brighten(self, share: float) -> None:
        """Change the lights."""
        self.lights = min(max(self.lights + share, 0.0), 1.0)

    def tilt(self, degrees: float) -> None:
        """Tilt the camera, upwards positive."""
        most = math.pi / 2.0
        self.camera_tilt = min(max(self.camera_tilt + degrees * _DEGREE, -most), most)

    def strengthen(self, share: float) -> None:
        """Change the thrust of a key of manual control."""
        self.share = min(max(round(self.share + share, 2), 0.1), 1.0)

    def grip(self, direction: int) -> None:
        """Open (1), close (-1) or stop (0) the gripper."""
        self.manipulator = direction

    def quit(self) -> None:
        """End."""
        self.quits = True


_ACTIONS: dict[str, Callable[[Pilot], None]] = {
    "m": Pilot.toggle_armed,
    " ": Pilot.let_go,
    "z": Pilot.toggle_depth,
    "h": Pilot.toggle_heading,
    ",": lambda pilot: pilot.deeper(-0.1),
    ".": lambda pilot: pilot.deeper(0.1),
    "[": lambda pilot: pilot.turn(-5.0),
    "]": lambda pilot: pilot.turn(5.0),
    "k": lambda pilot: pilot.brighten(-0.1),
    "l": lambda pilot: pilot.brighten(0.1),
    "t": lambda pilot: pilot.tilt(5.0),
    "g": lambda pilot: pilot.tilt(-5.0),
    "+": lambda pilot: pilot.strengthen(0.1),
    "-": lambda pilot: pilot.strengthen(-0.1),
    "o": lambda pilot: pilot.grip(1),
    "c": lambda pilot: pilot.grip(-1),
    "x": lambda pilot: pilot.grip(0),
    "q": Pilot.quit,
}


def _within(value: float) -> float:
    return min(max(value, -1.0), 1.0)
