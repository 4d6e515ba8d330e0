"""Failure injection: MAV_CMD_INJECT_FAILURE."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from pymavlink.dialects.v20 import all as mavlink

from seatrial.errors import InputError, unknown

from ..parameters.simulated_faults import simulated_faults
from ..service import (
    ACCEPTED,
    DENIED,
    INFO,
    UNSUPPORTED,
    WARNING,
    Command,
    Service,
    on_command,
    whole,
)
from ..settings import Settings
from ..transport import Sender, Transport
from ..vehicle import Vehicle

_MOST = 8
"""Motors, and servos, with an instance each."""
_COUNTED = {mavlink.FAILURE_UNIT_SYSTEM_MOTOR: "motor", mavlink.FAILURE_UNIT_SYSTEM_SERVO: "servo"}
_SINGLE = {
    mavlink.FAILURE_UNIT_SENSOR_GYRO: "gyro",
    mavlink.FAILURE_UNIT_SENSOR_ACCEL: "accel",
    mavlink.FAILURE_UNIT_SENSOR_MAG: "mag",
    mavlink.FAILURE_UNIT_SENSOR_BARO: "baro",
    mavlink.FAILURE_UNIT_SENSOR_GPS: "gps",
    mavlink.FAILURE_UNIT_SENSOR_OPTICAL_FLOW: "optical_flow",
    mavlink.FAILURE_UNIT_SENSOR_VIO: "vio",
    mavlink.FAILURE_UNIT_SENSOR_DISTANCE_SENSOR: "distance_sensor",
    mavlink.FAILURE_UNIT_SENSOR_AIRSPEED: "airspeed",
    mavlink.FAILURE_UNIT_SYSTEM_BATTERY: "battery",
}
_INSTANCES = {
    **{unit: (name,) for unit, name in _SINGLE.items()},
    **{
        unit: tuple(f"{name}{number}" for number in range(1, _MOST + 1))
        for unit, name in _COUNTED.items()
    },
}

UNITS = tuple(name for names in _INSTANCES.values() for name in names)
"""Units that can fail, by the names of PX4's command ``failure``; motors and servos by number."""

_TYPES = {
    mavlink.FAILURE_TYPE_OK: "none",
    mavlink.FAILURE_TYPE_OFF: "off",
    mavlink.FAILURE_TYPE_STUCK: "stuck",
    mavlink.FAILURE_TYPE_GARBAGE: "garbage",
    mavlink.FAILURE_TYPE_WRONG: "wrong",
    mavlink.FAILURE_TYPE_SLOW: "slow",
    mavlink.FAILURE_TYPE_DELAYED: "delayed",
    mavlink.FAILURE_TYPE_INTERMITTENT: "intermittent",
}


def failing_units(text: str) -> list[str]:
    """Return the units of a list separated by spaces. Raises InputError for one that is none."""
    names = text.split()
    for name in names:
        if name not in UNITS:
            raise InputError(unknown("unit of failures", name, UNITS))
    return names


class FailureService(Service):
    """INJECT_FAILURE: parameter 1 FAILURE_UNIT, 2 FAILURE_TYPE, 3 the instance, 0 for all.

    ``units`` are those whose failures lead somewhere; ``failing`` has the failure of each,
    ``none`` without. Whatever is not among them is UNSUPPORTED, and everything is DENIED while
    the settings do not allow it. Failed and cleared units are reported in a status text.
    """

    def __init__(
        self, vehicle: Vehicle, transport: Transport, settings: Settings, units: Sequence[str] = ()
    ) -> None:
        super().__init__(vehicle, transport)
        self._settings = settings
        self.failing = dict.fromkeys(units, "none")

    def texts(self, latitude: float) -> Mapping[str, str]:
        """Return the fault of each unit, as its input ``fault`` takes it.

        A command goes before what the SIM_ parameters say. ``latitude`` is that of the origin.
        """
        simulated = self._settings.simulated
        if not simulated:
            return self.failing
        submerged = self.vehicle.identity.submerged
        faults = simulated_faults(simulated, latitude, submerged=submerged)
        return {
            unit: faults.get(unit, "none") if failure == "none" else failure
            for unit, failure in self.failing.items()
        }

    @on_command(mavlink.MAV_CMD_INJECT_FAILURE)
    def _inject(self, command: Command, sender: Sender, now: float) -> int:
        unit, kind, instance = (whole(value) for value in command.parameters[:3])
        if not self._settings.failures_allowed:
            self.vehicle.report(WARNING, "No failure injected: SYS_FAILURE_EN is 0")
            return DENIED
        if kind not in _TYPES:
            return DENIED
        names = _INSTANCES.get(unit, ()) if unit is not None else ()
        if instance:  # not given, or 0: all of them
            names = names[instance - 1 : instance] if instance > 0 else ()
        found = [name for name in names if name in self.failing]
        if not found:
            self.vehicle.report(
                WARNING, "No failure injected: this vehicle has no such unit to fail"
            )
            return UNSUPPORTED
        self._fail(found, _TYPES[kind])
        return ACCEPTED

    def _fail(self, names: Sequence[str], failure: str) -> None:
        changed = [name for name in names if self.failing[name] != failure]
        self.failing.update(dict.fromkeys(names, failure))
        if changed:
            listed = ", ".join(changed)
            news = f"Cleared: {listed}" if failure == "none" else f"Failure: {listed} {failure}"
            self.vehicle.report(INFO if failure == "none" else WARNING, news)
