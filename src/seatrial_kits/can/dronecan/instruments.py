"""Battery, magnetometer, barometer and arming status on the bus, from values and back."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from seatrial.links.unconnected import NOT_CONNECTED

from .codec import equipment

BatteryInfo: Any = equipment.power.BatteryInfo
MagneticField: Any = equipment.ahrs.MagneticFieldStrength
MagneticField2: Any = equipment.ahrs.MagneticFieldStrength2
StaticPressure: Any = equipment.air_data.StaticPressure
StaticTemperature: Any = equipment.air_data.StaticTemperature
ArmingStatus: Any = equipment.safety.ArmingStatus

BATTERY = ("voltage", "current", "temperature", "charge")
"""Quantities of a battery: V, A out of the battery, K, and the share of the capacity."""
_GAUSS = 1e-4
"""T."""
_FULL = 100
"""Percent; above, the charge is not known."""


def battery(values: Sequence[float], number: int) -> Any:
    """Return a BatteryInfo of the values of `BATTERY`; what is not connected is NaN.

    The message has no word for an unknown charge: it is 127 %, beyond what there is.
    """
    voltage, current, temperature, charge = map(_or_nan, values)
    share = 127 if math.isnan(charge) else round(100.0 * min(max(charge, 0.0), 1.0))
    message = BatteryInfo(
        temperature=temperature,
        voltage=voltage,
        current=current,
        average_power_10sec=math.nan,
        remaining_capacity_wh=math.nan,
        full_charge_capacity_wh=math.nan,
        hours_to_full_charge=math.nan,
        state_of_charge_pct=share,
        battery_id=number,
    )
    message.state_of_health_pct = message.STATE_OF_HEALTH_UNKNOWN
    message.status_flags = message.STATUS_FLAG_IN_USE
    return message


def battery_of(message: Any) -> dict[str, float]:
    """Return the values of a BatteryInfo by quantity, without what is unknown."""
    found = {
        "voltage": message.voltage,
        "current": message.current,
        "temperature": message.temperature,
        "charge": message.state_of_charge_pct / 100.0,
    }
    if message.state_of_charge_pct > _FULL:
        del found["charge"]
    return {name: value for name, value in found.items() if math.isfinite(value)}


def magnetic(field: Sequence[float]) -> Any:
    """Return a MagneticFieldStrength2 of a field in body axes, T."""
    return MagneticField2(sensor_id=0, magnetic_field_ga=[value / _GAUSS for value in field])


def magnetic_of(message: Any) -> tuple[float, ...] | None:
    """Return the field of a message of a magnetometer, T, None for one that is not finite."""
    field = tuple(float(value) * _GAUSS for value in message.magnetic_field_ga)
    return field if all(map(math.isfinite, field)) else None


def pressure(value: float) -> Any:
    """Return a StaticPressure, Pa; its variance is not known."""
    return StaticPressure(static_pressure=value, static_pressure_variance=math.nan)


def temperature(value: float) -> Any:
    """Return a StaticTemperature, K; its variance is not known."""
    return StaticTemperature(static_temperature=value, static_temperature_variance=math.nan)


def arming(armed: bool) -> Any:
    """Return an ArmingStatus."""
    message = ArmingStatus()
    message.status = message.STATUS_FULLY_ARMED if armed else message.STATUS_DISARMED
    return message


def is_armed(message: Any) -> bool:
    """Return whether an ArmingStatus says that the vehicle is fully armed."""
    return bool(message.status == message.STATUS_FULLY_ARMED)


def _or_nan(value: float) -> float:
    return value if value < NOT_CONNECTED else math.nan
