"""ArduPilot's SIM_ parameters that are faults, as faults of the catalogue."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping

from ...faults.text import fault_text
from .parameter_definition import INT8, INT32, REAL32, Definition, fixed
from .settings import Settings

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
_FACTOR = "a thruster fails wholly: seatrial's faults can leave it a share"


def fault_parameters(settings: Settings, units: Collection[str]) -> list[Definition]:
    """Return the SIM_ parameters of the units that can fail. They end with the run."""
    found = [
        _definition(name, 1.0 - value, settings, INT8, (0, 1))
        for name, (unit, value, _) in _SWITCHES.items()
        if unit in units
    ]
    if "gps" in units:
        found += [_definition(name, 0.0, settings) for name in _GLITCH]
    if "baro" in units:
        found.append(_definition("SIM_BARO_GLITCH", 0.0, settings))
    if "gyro" in units:
        found += [_definition(name, 0.0, settings) for name in _GYRO]
    if "motor1" in units:
        found.append(_definition("SIM_ENGINE_FAIL", 0.0, settings, INT32))
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
        moved = (
            north * _METRES_PER_DEGREE,
            east * _METRES_PER_DEGREE * math.cos(latitude),
            -up,
        )
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
) -> Definition:
    def apply(kept: Settings, value: float) -> None:
        kept.simulated[name] = value

    why = "it ends with the run"
    if name == "SIM_ENGINE_FAIL":
        return Definition(name, kind, default, 0, 255, apply=apply, passing=why)
    return Definition(name, kind, default, numbers=numbers, apply=apply, passing=why)
