"""Folders shipped with the library: fmus, harness, hil_profiles, vehicles."""

from __future__ import annotations

from pathlib import Path

_PACKAGE = Path(__file__).parent
_CHECKOUT = _PACKAGE.parents[1]


def shipped_folder(name: str) -> Path:
    """Return the shipped folder ``name``: in the wheel, or at the top of a checkout."""
    installed = _PACKAGE / "_shipped" / name
    if installed.is_dir():
        return installed
    if name == "vehicles":
        return _PACKAGE / name
    return _CHECKOUT / name
