"""The ending of a process, in words."""

from __future__ import annotations

import contextlib
import signal


def how_ended(status: int) -> str:
    """Return in words how a process ended, from its status: that of a signal is negative."""
    if status >= 0:
        return f"exited with status {status}"
    name = f"signal {-status}"
    with contextlib.suppress(ValueError):
        name = signal.Signals(-status).name
    return f"was ended by {name}" + (" (perhaps for lack of memory)" if name == "SIGKILL" else "")
