"""Inputs of links that nothing is connected to: what they start with is no measurement."""

from __future__ import annotations

NOT_CONNECTED = 1e30
"""Start value of such an input: nothing measures this, and it goes out as not available."""


def is_connected(*values: float) -> bool:
    """Return whether something feeds the inputs that have these values."""
    return NOT_CONNECTED not in values
