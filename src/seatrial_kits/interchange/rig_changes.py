"""Changes of a command line in a rig that no trial runs."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from seatrial.errors import InputError, unknown
from seatrial.system.flattening import load_rig
from seatrial.system.paths import split_path
from seatrial.system.rig import Rig
from seatrial.system.system import System
from seatrial.trial.files.fault_keys import choices_in

_OF_RIG = ("step", "algorithm")


def changed_rig(name: str, changes: Mapping[str, Any]) -> Rig:
    """Return the rig ``name`` with choices, ``choices.NAME``, made, and keys of its own replaced.

    Raises InputError, also for a key without a dot that a rig does not have.
    """
    rig = load_rig(name, choices=choices_in(changes, "--choose"))
    own = {key: value for key, value in changes.items() if "." not in key}
    for key in own:
        if key not in _OF_RIG:
            raise InputError(f"--set: {unknown('key', key, _OF_RIG)}, or component.port")
    return rig.changed(own) if own else rig


def set_values(system: System, changes: Mapping[str, Any]) -> set[str]:
    """Give components what ``component.port`` sets; return their names. Raises InputError."""
    named = set()
    for key, written in changes.items():
        if "." in key and not key.startswith("choices."):
            system.set(key, written, "--set", Path.cwd())
            named.add(split_path(system.parts, key)[0])
    return named
