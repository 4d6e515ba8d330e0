"""Craft of a record in axes of other tools: world east-north-up, body ahead-left-up (REP 103)."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...links.geodesy import Origin
from ...physics.craft.kinematics import specific_force
from . import quaternions
from .run_folder import Run, viewed

WORLD = "map"
"""The frame of the world: the origin of {n} of the first craft, x east, y north, z up."""
GRAVITY = 9.80665

_ENU = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])
_FLU = np.diag([1.0, -1.0, -1.0])
_NED_IN_ENU = np.array([0.0, math.sqrt(0.5), math.sqrt(0.5), 0.0])
_FRD_IN_FLU = np.array([0.0, 1.0, 0.0, 0.0])
_MOTION = {
    "position": "xyz",
    "attitude": ("phi", "theta", "psi"),
    "velocity": "uvw",
    "rates": "pqr",
    "acceleration": "xyz",
}

Array = np.ndarray[Any, np.dtype[np.float64]]


@dataclass(frozen=True)
class Craft:
    """A craft's recorded truth, a row per point: m, m/s, rad/s, m/s2.

    ``position`` in the world; ``orientation`` is the quaternion (x, y, z, w) that takes body axes
    to those of the world, without jumps of sign; ``velocity``, ``rates`` and
    ``specific_force`` in body axes, each None if it is not recorded. ``geodetic`` is latitude and
    longitude, degrees, and altitude, m; None without a home. ``size`` is length and beam.
    """

    name: str
    position: Array
    orientation: Array
    velocity: Array | None
    rates: Array | None
    specific_force: Array | None
    geodetic: Array | None
    size: tuple[float, float] | None
    component: str
    """Path of the component whose motion it is."""


def crafts(run: Run, *, geodetic: bool = True) -> list[Craft]:
    """Return the craft whose position and attitude are recorded, in the order of the rig.

    Latitudes and longitudes take most of the time; without ``geodetic`` few craft have them.
    """
    components = run.manifest["components"]
    names = [c for c in components if _columns(run, c, "position") is not None]
    names = [c for c in names if _columns(run, c, "attitude") is not None]
    homes = [Origin(*home) for c in names if (home := components[c].get("home"))]
    short = [name.rpartition(".")[0] or name for name in names]
    return [
        _craft(
            run,
            name,
            brief if short.count(brief) == 1 else name,
            homes[0] if homes else None,
            geodetic=geodetic,
        )
        for name, brief in zip(names, short, strict=True)
    ]


def waypoints(run: Run) -> Iterator[tuple[str, list[tuple[float, float, float]]]]:
    """Yield each list of waypoints in the rig, with its component, in the world."""
    for name, component, ports in viewed(run.manifest, "waypoints"):
        parameters = component["parameters"]
        count = int(parameters[ports["count"]]["value"])
        places = [f"{ports['place']}_{number}" for number in range(1, count + 1)]
        yield name, [_place(parameters, place) for place in places]


def _place(parameters: Any, name: str) -> tuple[float, float, float]:
    east, north, down = (
        float(parameters.get(f"{name}.{axis}", {"value": 0.0})["value"])
        for axis in ("east", "north", "down")
    )
    return east, north, -down


def _columns(run: Run, component: str, port: str) -> Array | None:
    """Return the three columns of a port of the craft's motion; None if one is not recorded."""
    names = [f"{component}.{port}.{axis}" for axis in _MOTION[port]]
    if not all(name in run.signals for name in names):
        return None
    return np.column_stack([np.asarray(run.signals[name], dtype=float) for name in names])


def _craft(run: Run, component: str, name: str, world: Origin | None, *, geodetic: bool) -> Craft:
    described = run.manifest["components"][component]
    position, attitude = _needed(run, component, "position"), _needed(run, component, "attitude")
    home = Origin(*described["home"]) if described.get("home") else None
    places = None
    if home is not None and world is not None and (geodetic or home != world):
        places = np.array([home.geodetic(tuple(row)) for row in position])
        if home != world:
            position = np.array([world.position(*row) for row in places])
    velocity, rates = _columns(run, component, "velocity"), _columns(run, component, "rates")
    acceleration = _columns(run, component, "acceleration")
    force = None
    if acceleration is not None:
        rows = zip(attitude.tolist(), acceleration.tolist(), strict=True)
        force = np.array([specific_force(a, b, GRAVITY) for a, b in rows]) @ _FLU
    outline = described.get("outline")
    return Craft(
        name,
        position @ _ENU.T,
        _orientation(attitude),
        None if velocity is None else velocity @ _FLU,
        None if rates is None else rates @ _FLU,
        force,
        places,
        None if outline is None else (float(outline["length"]), float(outline["beam"])),
        component,
    )


def _needed(run: Run, component: str, port: str) -> Array:
    found = _columns(run, component, port)
    assert found is not None
    return found


def _orientation(attitude: Array) -> Array:
    """Return quaternions (x, y, z, w) of Euler angles, the first one with w not below 0."""
    turned = quaternions.product(
        quaternions.product(_NED_IN_ENU, quaternions.of_euler(attitude)), _FRD_IN_FLU
    )
    signed = quaternions.continuous(turned)
    if len(signed):
        signed = signed * math.copysign(1.0, signed[0, 0])
    return np.roll(signed, -1, axis=1)


def rows(columns: Array | None) -> Sequence[Sequence[float]]:
    """Return the rows as Python's own numbers; none of what is not recorded."""
    found: list[list[float]] = [] if columns is None else columns.tolist()
    return found
