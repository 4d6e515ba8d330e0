"""CMPS12: tilt-compensated compass. Robot Electronics, CMPS12 documentation, I2C mode."""

from __future__ import annotations

import math
from typing import ClassVar

from seatrial.model.unit_table import STANDARD_GRAVITY

from ..part import I2CRegisters, Register

_VECTORS = {"MAG": 0x06, "ACC": 0x0C, "GYR": 0x12}


class Cmps12(I2CRegisters):
    """Bearing from magnetic north, pitch, roll, and raw field, specific force and rates of turn."""

    ports = ("attitude", "declination", "field", "accelerometer", "gyro", "temperature")
    registers: ClassVar = {
        "VERSION": Register(0x00, 7),
        "BEARING_8": Register(0x01, access="r"),
        "BEARING": Register(0x02, 0, "u16be", "r"),
        "PITCH": Register(0x04, 0, "s8", "r"),
        "ROLL": Register(0x05, 0, "s8", "r"),
        **{
            f"{name}_{axis}": Register(at + 2 * n, 0, "s16be", "r")
            for name, at in _VECTORS.items()
            for n, axis in enumerate("XYZ")
        },
        "TEMP": Register(0x18, 0, "s16be", "r"),
        "BEARING_16": Register(0x1A, 0, "u16be", "r"),
        "PITCH_180": Register(0x1C, 0, "s16be", "r"),
        "CALIBRATION": Register(0x1E, 0xFF, access="r"),
    }

    def measure(self) -> None:
        """Fill all registers of data."""
        phi, theta, psi = (math.degrees(each) for each in self.inputs["attitude"])
        bearing = (psi - math.degrees(self.inputs["declination"])) % 360.0
        self.put("BEARING_8", round(bearing / 360.0 * 256.0) % 256)
        self.put("BEARING", round(bearing * 10.0) % 3600)
        self.put("BEARING_16", round(bearing * 16.0) % 5760)
        self.put("PITCH", min(max(theta, -90.0), 90.0))
        self.put("PITCH_180", theta)
        self.put("ROLL", min(max(phi, -90.0), 90.0))
        self.put("TEMP", self.inputs["temperature"] - 273.15)
        # Counts of its BNO055: 16 per microtesla, 981 per g, 16 per deg/s.
        for name, port, scale in (
            ("MAG", "field", 1.6e7),
            ("ACC", "accelerometer", 981.0 / STANDARD_GRAVITY),
            ("GYR", "gyro", math.degrees(16.0)),
        ):
            self.put_vector(f"{name}_X", [value * scale for value in self.inputs[port]])
