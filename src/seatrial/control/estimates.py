"""Timeout of estimates."""

from __future__ import annotations


def is_lost(valid: bool, missed: float, period: float, timeout: float) -> bool:
    """Return whether a signal, not valid at ``missed`` instants before this one, is lost.

    ``missed`` is infinite before the first valid one; ``period`` and ``timeout`` in s.
    """
    # A sum of periods is not exact: a share of 1e-9 separates "longer than" from "as long as".
    return not valid and (missed + 1.0) * period > timeout * (1.0 + 1e-9)
