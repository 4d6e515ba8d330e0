"""Checks of parts at the start: values that a part of its kind cannot have."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from types import SimpleNamespace
from typing import Any

from seatrial.errors import InputError

from .coefficients import Coefficients, Part, fitted
from .steering import require_steering
from .wageningen import AREA_RATIOS, BLADES, PITCH_RATIOS

_LAWS = ("thruster", "azimuth", "outboard", "tunnel", "jet")
_Refuse = Callable[[str, str], InputError]
"""Makes the error of a parameter, by its short name, and what is allowed."""


def require_parts(craft: Coefficients) -> None:
    """Raise InputError naming the parameter of a part that cannot be, with what is allowed."""
    values = SimpleNamespace(**{name: getattr(craft, name) for name in craft.ports})
    checks = {"propulsor": _propulsor, "foil": _foil, "ballast": _ballast}
    for sort, check in checks.items():
        for number, part in enumerate(fitted(values, sort), 1):
            check(part, partial(_refused, craft.name, sort, number, part), values)
    slots = [part.slot for part in fitted(values, "propulsor")]
    require_steering(craft.name, [s.turns_with for s in slots], [s.angle_limit for s in slots])


def _refused(craft: str, sort: str, number: int, part: Part, name: str, allowed: str) -> InputError:
    found = getattr(part.slot, name)
    return InputError(f"{craft}.{sort}_{name}_{number} is {found!r}, of a {part.kind}: {allowed}")


def _propulsor(part: Part, refused: _Refuse, _values: SimpleNamespace) -> None:
    kind, s = part
    _require_unit("axis", s.axis, refused)
    low, high = s.angle_limit
    if low > high:
        raise refused("angle_limit", "from may not be more than to")
    if kind in _LAWS:
        if not s.thrust[0] > 0.0:
            raise refused("thrust", "more than 0 is needed ahead")
        return
    if not s.speed[0] > 0.0:
        raise refused("speed", "more than 0 is needed ahead")
    if abs(s.hand) != 1.0:
        raise refused("hand", "1 or -1 is needed")
    if kind == "propeller" and not s.K_T[0] > 0.0:
        raise refused("K_T", "k0 of more than 0 is needed")
    if kind == "four-quadrant" and not any(s.C_T):
        raise refused("C_T", "some coefficient other than 0 is needed")
    if kind == "wageningen-b":
        if s.blades % 1.0:
            raise refused("blades", "a whole number is needed")
        _require_within("blades", s.blades, BLADES, refused)
        _require_within("pitch_ratio", s.pitch_ratio, PITCH_RATIOS, refused)
        _require_within("area_ratio", s.area_ratio, AREA_RATIOS, refused)


def _foil(part: Part, refused: _Refuse, values: SimpleNamespace) -> None:
    kind, s = part
    if kind == "linear-fin" and not s.lift > 0.0:
        raise refused("lift", "more than 0 is needed")
    if kind == "rudder":
        count = len(values.propulsors.split())
        if s.behind % 1.0 or not 0.0 <= s.behind <= count:
            raise refused("behind", f"0 for none, or the number of a propulsor, 1 to {count}")


def _ballast(part: Part, refused: _Refuse, values: SimpleNamespace) -> None:
    kind, s = part
    needed = {"buoyancy-engine": ("volume",), "tank": ("mass",), "moving-mass": ("mass", "travel")}
    for name in needed[kind]:
        if not getattr(s, name) > 0.0:
            raise refused(name, "more than 0 is needed")
    if kind == "buoyancy-engine" and values.restoring.startswith("surface"):
        raise refused(
            "volume", f"restoring is {values.restoring!r}, submerged or floating is needed"
        )
    if kind == "buoyancy-engine":
        engines = (p.slot.volume for p in fitted(values, "ballast") if p.kind == kind)
        own = values.buoyancy / (values.density * values.gravity)
        if not sum(engines) < own:
            raise refused("volume", f"with other engines less than the craft's {own:.4g} m3")
    if kind == "moving-mass":
        _require_unit("axis", s.axis, refused)


def _require_unit(name: str, axis: Any, refused: _Refuse) -> None:
    length = math.hypot(*axis)
    if abs(length - 1.0) > 1e-6:
        raise refused(name, f"a unit vector is needed, its length is {length:.6g}")


def _require_within(name: str, value: float, limits: tuple[float, float], refused: _Refuse) -> None:
    low, high = limits
    if not low <= value <= high:
        raise refused(name, f"{low:g} to {high:g} are allowed")
