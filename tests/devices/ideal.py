"""Sensors without the errors of their data sheets."""

from __future__ import annotations

from typing import Any

from seatrial.devices.sensor import Measured, Sensor

from .running import started


def ideal(cls: type[Sensor], **values: Any) -> Any:
    """Return a sensor with every error of its data sheet at zero."""
    errors = [f"{m.name}_{e}" for m in cls.measured for e in Measured.ERRORS]
    errors += [f"{m.name}_range" for m in cls.measured if m.largest is not None]
    return started(cls, **{**dict.fromkeys(errors, 0.0), "delay": 0.0, **values})
