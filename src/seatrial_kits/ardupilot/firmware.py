"""Start of ArduPilot's simulated firmware: its options, and the command as a person types it."""

from __future__ import annotations

import shlex
from collections.abc import Sequence


def arguments(
    port: int,
    home: tuple[float, float, float, float],
    step: float,
    speedup: float,
    *,
    defaults: str = "",
    serial0: str = "",
) -> list[str]:
    """Return the firmware's options.

    ``home`` is latitude, longitude and heading in degrees, with the altitude in m before the
    heading; ``step`` the communication step in s; ``defaults`` a parameter file, ``serial0`` the
    device of its first serial port, each empty for its own.
    """
    latitude, longitude, altitude, heading = home
    options = [
        "--model", "JSON:127.0.0.1", "--sim-port-out", str(port),
        "--home", f"{latitude:.9f},{longitude:.9f},{altitude:g},{heading:.3f}",
        "--rate", f"{round(1.0 / step)}", "--speedup", f"{speedup:g}",
    ]  # fmt: skip
    given = {"--defaults": defaults, "--serial0": serial0}
    return [*options, *(word for key, text in given.items() if text for word in (key, text))]


def by_hand(program: str, options: Sequence[str]) -> str:
    """Return the command as a person types it."""
    return shlex.join([program, *options])
