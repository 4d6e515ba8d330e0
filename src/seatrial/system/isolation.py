"""Settings that say which components run in processes of their own: ``component.isolated``."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ..errors import InputError, unknown
from .rig import Isolated, Rig

KEY_END = ".isolated"
"""What the key of such a setting ends with."""
_WORDS: dict[str, Isolated] = {"true": True, "false": False, "sandboxed": "sandboxed"}


def isolated_in(settings: Mapping[str, Any], origin: str) -> dict[str, Isolated]:
    """Return what settings say of processes, by component.

    Raises InputError, with ``origin``, for a value that is neither a Boolean, nor such a word,
    nor "sandboxed".
    """
    return {
        key.removesuffix(KEY_END): _isolated(value, f"{origin}: {key}")
        for key, value in settings.items()
        if key.endswith(KEY_END)
    }


def isolating(rig: Rig, chosen: Mapping[str, Isolated], origin: str) -> Rig:
    """Return a rig with its components ``chosen``, by path, in processes of their own or not.

    Raises InputError, with ``origin``, for one that is not there, or that cannot be.
    """
    for name in chosen:
        if name not in rig.components:
            raise InputError(
                f"{origin}: {name}{KEY_END}: {unknown('component', name, rig.components)}"
            )
    return rig.isolating(chosen) if chosen else rig


def _isolated(value: Any, where: str) -> Isolated:
    if isinstance(value, bool):
        return value
    if isinstance(value, str) and value in _WORDS:
        return _WORDS[value]
    raise InputError(f"{where}: true, false or 'sandboxed' is needed, found {value!r}")
