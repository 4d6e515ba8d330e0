"""Marks that C leaves in memory for whoever watches a run: the call that it is in."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar


@dataclass(frozen=True)
class Marks:
    """Cells in memory, and what stands in the second of them while one component is in a call.

    The first cell asks for a stop unless it is 0; the third has the time of a step, s, as a double.
    """

    CALLS: ClassVar = ("write", "step", "read")

    address: int
    codes: Mapping[str, int]
    """By call, of `CALLS`."""
