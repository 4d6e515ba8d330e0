"""MPU-6050: gyroscope and accelerometer. InvenSense RM-MPU-6000A."""

from __future__ import annotations

import math
from typing import ClassVar

from seatrial.model.unit_table import STANDARD_GRAVITY

from ..part import I2CRegisters, Register

_SLEEP = 0x40


class Mpu6050(I2CRegisters):
    """Angular velocity and specific force, body axes, in ranges by 0x1B and 0x1C; asleep at first.

    131 counts per deg/s and 16384 per g in the smallest ranges, halved with each; 340 per K from
    36.53 deg C on.
    """

    ports = ("gyro", "accelerometer", "water_temperature")
    pointer_mask = 0x7F
    registers: ClassVar = {
        "GYRO_CONFIG": Register(0x1B, access="acts"),
        "ACCEL_CONFIG": Register(0x1C, access="acts"),
        **{
            name: Register(0x3B + 2 * n, 0, "s16be", "r")
            for n, name in enumerate(
                ("ACCEL_X", "ACCEL_Y", "ACCEL_Z", "TEMP", "GYRO_X", "GYRO_Y", "GYRO_Z")
            )
        },
        "PWR_MGMT_1": Register(0x6B, _SLEEP, access="acts"),
        "WHO_AM_I": Register(0x75, 0x68),
    }

    def reset(self) -> None:
        """Begin asleep, in the smallest ranges."""
        self.written("", 0)

    def written(self, name: str, value: int) -> bool:
        """Measure in the range that is set now, or awake."""
        self._asleep = bool(self.get("PWR_MGMT_1") & _SLEEP)
        per_g = 16384.0 / (1 << (self.get("ACCEL_CONFIG") >> 3 & 3))
        self._per_force = per_g / STANDARD_GRAVITY
        self._per_rate = math.degrees(131.0 / (1 << (self.get("GYRO_CONFIG") >> 3 & 3)))
        self.measure()
        return True

    def measure(self) -> None:
        """Fill the registers of data, unless asleep."""
        if self._asleep:
            return
        force = [each * self._per_force for each in self.inputs["accelerometer"]]
        rate = [each * self._per_rate for each in self.inputs["gyro"]]
        temperature = (self.inputs["water_temperature"] - 273.15 - 36.53) * 340.0
        self.put_vector("ACCEL_X", [*force, temperature, *rate])
