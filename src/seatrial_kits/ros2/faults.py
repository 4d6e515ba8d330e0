"""Faults that nodes inject: the service ``inject_fault``, typed as the one for parameters."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from seatrial.errors import unknown
from seatrial.links.vehicle_sensors import Sensors
from seatrial.model.faults.catalogue import FAILURES

from .thrusters import Actuator
from .transport import Call

KIND = "rcl_interfaces/srv/SetParameters"
_STRING = 4
NONE = "none"
_BY_SENSOR = {
    "gnss": "gps", "compass": "mag", "ahrs": "mag", "imu": "gyro", "depth": "baro",
    "anemometer": "airspeed",
}  # fmt: skip
"""Units by the kind of sensor that fails."""


class Faults:
    """The fault of each unit: a parameter's name is the unit, its text the fault, or none."""

    def __init__(self, sensors: Sensors, actuators: Sequence[Actuator]) -> None:
        kinds = {each["kind"] for each in sensors.values()}
        units = [unit for kind, unit in _BY_SENSOR.items() if kind in kinds]
        motors = [each for each in actuators if "pos" not in each.ways]
        units += [f"motor{number}" for number in range(1, min(len(motors), 8) + 1)]
        self.acting = dict.fromkeys(units, NONE)

    def inject(self, call: Call) -> None:
        """Answer each parameter for itself, as SetParameters does."""
        results = [self._set(each) for each in call.request.parameters]
        call.answer({"results": results})

    def _set(self, parameter: Any) -> Mapping[str, Any]:
        unit, value = parameter.name, parameter.value
        why = ""
        if unit not in self.acting:
            why = unknown("unit", unit, self.acting)
        elif value.type != _STRING:
            why = f"a text is needed: {NONE}, {', '.join(FAILURES)}"
        elif value.string_value not in (NONE, *FAILURES):
            why = unknown("fault", value.string_value, (NONE, *FAILURES))
        else:
            self.acting[unit] = value.string_value
        return {"successful": not why, "reason": why}
