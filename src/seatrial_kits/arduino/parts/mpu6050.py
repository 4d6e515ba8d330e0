"""MPU-6050: gyroscope and accelerometer. InvenSense RM-MPU-6000A."""

from __future__ import annotations

import math
from typing import ClassVar

from seatrial.model.unit_table import STANDARD_GRAVITY

from ..part import I2CRegisters, Register

_AXES = "XYZ"
_SLEEP = 0x40


class Mpu6050(I2CRegisters):
    """Angular velocity and specific force, body axes, in ranges by 0x1B and 0x1C; asleep at power-on.

    131 counts per deg/s and 16384 per g in the smallest ranges, halved with each; 340 per K from
    36.53 deg C on.
    """

    ports = ("gyro", "accelerometer", "water_temperature")
    pointer_mask = 0x7F
    registers: ClassVar = {
        "GYRO_CONFIG": Register(0x1B, access="acts"),
        "ACCEL_CONFIG": Register(0x1C, access="acts"),
        **{f"ACCEL_{axis}": Register(0x3B + 2 * n, form="s16be") for n, axis in enumerate(_AXES)},
        "TEMP": Register(0x41, form="s16be"),
        **{f"GYRO_{axis}": Register(0x43 + 2 * n, form="s16be") for n, axis in enumerate(_AXES)},
        "PWR_MGMT_1": Register(0x6B, _SLEEP, access="acts"),
        "WHO_AM_I": Register(0x75, 0x68),
    }

    def written(self, name: str, value: int) -> bool:
        """Measure in the range that is set now, or awake."""
        self.measure()
        return True

    def measure(self) -> None:
        """Fill the registers of data, unless asleep."""
        if self.get("PWR_MGMT_1") & _SLEEP:
            return
        per_g = 16384.0 / (1 << (self.get("ACCEL_CONFIG") >> 3 & 3))
        per_dps = 131.0 / (1 << (self.get("GYRO_CONFIG") >> 3 & 3))
        for axis, force, rate in zip(
            _AXES, self.inputs["accelerometer"], self.inputs["gyro"], strict=True
        ):
            self.put(f"ACCEL_{axis}", force / STANDARD_GRAVITY * per_g)
            self.put(f"GYRO_{axis}", math.degrees(rate) * per_dps)
        self.put("TEMP", (self.inputs["water_temperature"] - 273.15 - 36.53) * 340.0)
