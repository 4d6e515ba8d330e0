"""Values under way: lists of entries that begin with the time, ns, at which they fall due."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any


def last_due(under_way: Sequence[Any], now_ns: int) -> list[Any] | None:
    """Return the latest entry whose time has come, None if there is none; ascending times."""
    for entry in reversed(under_way):
        if entry[0] <= now_ns:
            return entry  # type: ignore[no-any-return]
    return None
