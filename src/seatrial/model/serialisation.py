"""Serialisation: plain data for a component's state, and text that FMI can carry."""

from __future__ import annotations

from typing import Any

import numpy as np


def is_c_text(text: str) -> bool:
    """Return whether FMI can carry ``text``: no NUL, no lone surrogate."""
    return "\0" not in text and (text.isascii() or not any("\ud800" <= c <= "\udfff" for c in text))


def copied(value: Any, where: str) -> Any:
    """Return a deep copy of plain data; raise TypeError for anything else."""
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    if isinstance(value, np.generic) and not value.dtype.hasobject:
        return value.item()
    if isinstance(value, np.ndarray) and not value.dtype.hasobject:
        return value.copy()
    if type(value) in (list, tuple):
        return type(value)(copied(v, where) for v in value)
    if isinstance(value, dict):
        return {k: copied(v, where) for k, v in value.items()}
    raise TypeError(f"state attribute {where} is not plain data: {type(value).__name__}")
