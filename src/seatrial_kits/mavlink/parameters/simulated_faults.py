"""ArduPilot's SIM_ parameters that are faults, as faults of the catalogue."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping

from seatrial.model.faults.text import fault_text

from ..settings import Settings
from .definition import INT8, INT32, REAL32, Definition, fixed

_METRES_PER_DEGREE = math.radians(1.0) * 6_378_137.0
"""Of latitude, on a sphere with the equator's radius; of longitude at the equator."""
_GLITCH = tuple(f"SIM_GPS1_GLTCH_{axis}" for axis in "XYZ")
_GYRO = tuple(f"SIM_GYR1_BIAS_{axis}" for axis in "XYZ")
_SWITCHES = {
    "SIM_GPS1_ENABLE": ("gps", 0, "off"),
    "SIM_GPS1_JAM": ("gps", 1, "intermittent"),
    "SIM_MAG1_FAIL": ("mag", 1, "off"),
    "SIM_BARO_DISABLE": ("baro", 1, "off"),
    "SIM_BARO_FREEZE": ("baro", 1, "stuck"),
}
"""Parameters that are 0 or 1: unit, value with which it fails, how."""
_NUMBERS = {
    **dict.fromkeys(_GLITCH[:2], ("gps", -1.0, 1.0, REAL32)),
    _GLITCH[2]: ("gps", -1e4, 1e4, REAL32),
    "SIM_BARO_GLITCH": ("baro", -1e4, 1e4, REAL32),
    **dict.fromkeys(_GYRO, ("gyro", -35.0, 35.0, REAL32)),
    "SIM_ENGINE_FAIL": ("motor1", 0.0, 255.0, INT32),
}
"""Parameters that are numbers: unit, least, most, type. Gyros measure up to 2000 deg/s."""
_FACTOR = "a thruster fails wholly: seatrial's faults can leave it a share"


def fault_parameters(settings: Settings, units: Collection[str]) -> list[Definition]:
    """Return the SIM_ parameters of the units that can fail. They end with the run."""
    found = [
        _definition(name, 1.0 - value, settings, INT8, (0, 1))
        for name, (unit, value, _) in _SWITCHES.items()
        if unit in units
    ]
    for name, (unit, least, most, kind) in _NUMBERS.items():
        if unit in units:
            found.append(_definition(name, 0.0, settings, kind, between=(least, most)))
    if "motor1" in units:
        found.append(fixed("SIM_ENGINE_MUL", REAL32, 0.0, _FACTOR))
    return found


def simulated_faults(
    simulated: Mapping[str, float], latitude: float, *, submerged: bool
) -> dict[str, str]:
    """Return the faults that the parameters mean, as texts by unit.

    A glitch of the GNSS is in degrees of latitude and of longitude, and in m upwards; of a
    submarine there is none: its position is not measured by satellites.
    """
    faults = {
        unit: how for name, (unit, value, how) in _SWITCHES.items() if simulated.get(name) == value
    }
    north, east, up = (simulated.get(name, 0.0) for name in _GLITCH)
    if (north or east or up) and not submerged:
        moved = (north * _METRES_PER_DEGREE, east * _METRES_PER_DEGREE * math.cos(latitude), -up)
        faults.setdefault("gps", _bias("position_n", *moved))
    if raised := simulated.get("SIM_BARO_GLITCH"):
        faults.setdefault("baro", _bias("depth", -raised))
    turned = [simulated.get(name, 0.0) for name in _GYRO]
    if any(turned):
        faults.setdefault("gyro", _bias("gyro", *turned))
    mask = round(simulated.get("SIM_ENGINE_FAIL", 0.0))
    faults.update({f"motor{n + 1}": "off" for n in range(8) if mask >> n & 1})
    return faults


def _bias(of: str, *values: float) -> str:
    return fault_text("bias", of, {"value": values}, 0.0)


def _definition(
    name: str,
    default: float,
    settings: Settings,
    kind: int = REAL32,
    numbers: tuple[int, ...] = (),
    between: tuple[float, float] = (0.0, 1.0),
) -> Definition:
    def apply(kept: Settings, value: float) -> None:
        kept.simulated[name] = value

    why = "it ends with the run"
    return Definition(name, kind, default, *between, numbers, apply, passing=why)
