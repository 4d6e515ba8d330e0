"""Names on the command line: trials, and vehicles, each of which a trial is for."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from ..errors import InputError, unknown
from ..reading import toml_content
from ..shipped import available
from ..system.packages import is_package
from ..vehicle_folders import FOLDERS, place_in

_MOST_NAMED = 8
_AUTOPILOT, _VEHICLE = "choices.autopilot", "choices.vehicle"
_FOR_EVERY = "under-"
"""Beginning of the names of trials for every vehicle."""
_SETTING_OUT = "under-way"


def runnable(beginning: str) -> list[str]:
    """Return what can be run whose name begins so, for a shell's completion."""
    names = {**available("harness/trials"), **available("harness/campaigns"), **_vehicles()}
    return sorted(name for name in names if name.startswith(beginning))


def with_vehicle(name: str, changes: dict[str, Any]) -> tuple[str, dict[str, Any]]:
    """Return the trial that a name means, and the settings with the vehicle if it is one's.

    A vehicle's name means the trial for every vehicle under the autopilot that is chosen, else
    the one in which it sets out. A trial of that name comes first. Raises InputError for a rig's
    name, with its trials, for a vehicle's file that cannot be read, and for a name that is none,
    with those like it.
    """
    trials = available("harness/trials")
    if name in trials or name.endswith(".toml") or is_package(name):
        return name, changes
    here = place_in(Path.cwd() / FOLDERS, "harness/rigs", f"vehicles/{name}")
    if here is not None or name in _vehicles():
        trial = _trial_under(str(changes.get(_AUTOPILOT, "")))
        return trial, {_VEHICLE: name, **changes}
    if name in available("harness/rigs"):
        found = _trials_of(name)
        said = f"{name!r} is a rig, not a trial"
        if not found:
            raise InputError(f"{said}; no trial here is of it")
        more = f", and {len(found) - _MOST_NAMED} more" if len(found) > _MOST_NAMED else ""
        raise InputError(f"{said}; its trials: {', '.join(found[:_MOST_NAMED])}{more}")
    known = [*trials, *available("harness/campaigns"), *_vehicles()]
    more = "; or give a path ending in .toml"
    raise InputError(f"{unknown('trial, campaign or vehicle', name, known)}{more}")


def _trial_under(autopilot: str) -> str:
    """Return the trial for every vehicle that has an autopilot, else the one of its pilot."""
    trials = available("harness/trials").items()
    for_every = [(name, path) for name, path in trials if name.startswith(_FOR_EVERY)]
    for name, path in for_every if autopilot else ():
        if _content(path).get("choices", {}).get("autopilot") == autopilot:
            return name
    return _SETTING_OUT


def _vehicles() -> dict[str, Path]:
    return available("harness/rigs/vehicles")


def _trials_of(rig: str) -> list[str]:
    trials = available("harness/trials").items()
    return [name for name, path in trials if Path(str(_content(path).get("rig", ""))).stem == rig]


def _content(path: Path) -> dict[str, Any]:
    try:
        return toml_content(path.read_bytes(), str(path))
    except (InputError, OSError):
        return {}
