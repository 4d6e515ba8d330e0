"""Names on the command line: what can be run, and what is a rig or a vehicle instead."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from ..errors import InputError
from ..reading import toml_content
from ..shipped import available

_MOST_NAMED = 8


def runnable(beginning: str) -> list[str]:
    """Return the trials and campaigns whose names begin so, for a shell's completion."""
    names = {**available("harness/trials"), **available("harness/campaigns")}
    return sorted(name for name in names if name.startswith(beginning))


def refuse_rig(name: str) -> None:
    """Raise InputError, with its trials, for the name of a rig or a vehicle that is no trial."""
    if name in available("harness/trials"):
        return
    for kind, folder in (("rig", "harness/rigs"), ("vehicle of rigs", "harness/rigs/vehicles")):
        if name in available(folder):
            found = _trials_of(name, is_vehicle="vehicle" in kind)
            said = f"{name!r} is a {kind}, not a trial"
            if not found:
                raise InputError(f"{said}; no trial here is of it")
            more = f", and {len(found) - _MOST_NAMED} more" if len(found) > _MOST_NAMED else ""
            raise InputError(f"{said}; its trials: {', '.join(found[:_MOST_NAMED])}{more}")


def _trials_of(name: str, *, is_vehicle: bool) -> list[str]:
    found = []
    for trial, path in available("harness/trials").items():
        content = _content(path)
        if not is_vehicle and Path(str(content.get("rig", ""))).stem == name:
            found.append(trial)
        if is_vehicle and _vehicle_of(content) == name:
            found.append(trial)
    return found


def _vehicle_of(trial: dict[str, Any]) -> Any:
    """Return the vehicle that a trial chooses, or that its rig has without a choice."""
    choices = trial.get("choices", {})
    rig = available("harness/rigs").get(str(trial.get("rig", "")))
    if "vehicle" in choices or rig is None:
        return choices.get("vehicle")
    return _content(rig).get("choices", {}).get("vehicle")


def _content(path: Path) -> dict[str, Any]:
    try:
        return toml_content(path.read_bytes(), str(path))
    except (InputError, OSError):
        return {}
