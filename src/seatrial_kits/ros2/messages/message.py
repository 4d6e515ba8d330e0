"""Questions to messages of rosbags' classes: whether their numbers are finite, their stamps."""

from __future__ import annotations

import math
from typing import Any

import numpy as np


def is_finite(part: Any) -> bool:
    """Return whether all numbers of a message are finite."""
    if isinstance(part, float):
        return math.isfinite(part)
    if isinstance(part, np.ndarray):
        return part.dtype.kind != "f" or bool(np.isfinite(part).all())
    if isinstance(part, list):
        return all(map(is_finite, part))
    if hasattr(part, "__dataclass_fields__"):
        return all(is_finite(getattr(part, name)) for name in part.__dataclass_fields__)
    return True


def stamp_ns(header: Any) -> int:
    """Return the stamp of a header, ns."""
    return int(header.stamp.sec) * 1_000_000_000 + int(header.stamp.nanosec)
