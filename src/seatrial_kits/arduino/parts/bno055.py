"""BNO055: absolute orientation. Bosch BST-BNO055-DS000 rev 1.4."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import ClassVar

from seatrial.model.unit_table import STANDARD_GRAVITY

from ..part import I2CRegisters, Register

_BOOT_S = 0.65
_ID = 0xA0
_RESET = 0x20
_FUSES = range(8, 13)
"""Modes of operation from IMU to NDOF; those below have single sensors."""
_MODES = {1: "A", 2: "M", 3: "G", 4: "AM", 5: "AG", 6: "MG", 7: "AMG", 9: "AM", 10: "AM", 8: "AG"}


def _vector(name: str, at: int, axes: str = "XYZ") -> dict[str, Register]:
    registers = enumerate(axes)
    return {f"{name}_{axis}": Register(at + 2 * n, 0, "s16le", "r") for n, axis in registers}


class Bno055(I2CRegisters):
    """Specific force, field and angular velocity, body axes, and the attitude fused of them.

    Euler angles: heading clockwise from magnetic north, roll and pitch as ``attitude`` has them;
    the quaternion (w first) turns body axes to north-east-down of it. Gravity is the specific force
    at rest, and linear acceleration the rest of it. Units by UNIT_SEL. It calibrates at once, and
    needs 0.65 s after a reset.
    """

    ports = ("accelerometer", "gyro", "field", "attitude", "declination", "temperature")
    registers: ClassVar = {
        "CHIP_ID": Register(0x00, 0, access="latches"),
        "ACC_ID": Register(0x01, 0xFB, access="r"),
        "MAG_ID": Register(0x02, 0x32, access="r"),
        "GYR_ID": Register(0x03, 0x0F, access="r"),
        "SW_REV": Register(0x04, 0x0311, "u16le", "r"),
        "BL_REV": Register(0x06, 0x15, access="r"),
        **_vector("ACC", 0x08),
        **_vector("MAG", 0x0E),
        **_vector("GYR", 0x14),
        **_vector("EUL", 0x1A, "HRP"),
        **_vector("QUA", 0x20, "WXYZ"),
        **_vector("LIA", 0x28),
        **_vector("GRV", 0x2E),
        "TEMP": Register(0x34, 0, "s8", "r"),
        "CALIB_STAT": Register(0x35, access="r"),
        "ST_RESULT": Register(0x36, 0x0F, access="r"),
        "SYS_STATUS": Register(0x39, access="r"),
        "UNIT_SEL": Register(0x3B, 0x80, access="acts"),
        "OPR_MODE": Register(0x3D, 0x10, access="acts"),
        "SYS_TRIGGER": Register(0x3F, access="acts"),
        "AXIS_MAP_CONFIG": Register(0x41, 0x24),
    }

    def reset(self) -> None:
        """Begin with registers as at power-on; it boots."""
        self._booted = self.time + _BOOT_S
        for name, register in self.registers.items():
            self.put(name, register.value)

    def reading(self, name: str) -> None:
        """Have an identity once it has booted."""
        self.put("CHIP_ID", _ID if self.time >= self._booted else 0)

    def written(self, name: str, value: int) -> bool:
        """Measure by the mode and units that are there now, or begin anew."""
        if name == "SYS_TRIGGER" and value & _RESET:
            self.reset()
        self.measure()
        return True

    def measure(self) -> None:
        """Fill the registers of the sensors that the mode has, and what it fuses."""
        mode, units = self.get("OPR_MODE") & 0x0F, self.get("UNIT_SEL")
        fuses, on = mode in _FUSES, _MODES.get(mode, "AMG" if mode in _FUSES else "")
        per_force = 1000.0 / STANDARD_GRAVITY if units & 1 else 100.0
        per_rate = 900.0 if units & 2 else math.degrees(16.0)
        force, north_east_down = self.inputs["accelerometer"], _axes(self.inputs["attitude"])
        gravity = [-STANDARD_GRAVITY * each for each in north_east_down]
        self._put_scaled("ACC_X", force, per_force * ("A" in on))
        self._put_scaled("MAG_X", self.inputs["field"], 1.6e7 * ("M" in on))
        self._put_scaled("GYR_X", self.inputs["gyro"], per_rate * ("G" in on))
        self._put_scaled("GRV_X", gravity, per_force * fuses)
        linear = [a - b for a, b in zip(force, gravity, strict=True)]
        self._put_scaled("LIA_X", linear, per_force * fuses)
        phi, theta, psi = self.inputs["attitude"]
        magnetic = (psi - self.inputs["declination"]) % math.tau
        per_angle = 900.0 if units & 4 else math.degrees(16.0)
        self._put_scaled("EUL_H", (magnetic, phi, theta), per_angle * fuses)
        self._put_scaled("QUA_W", _quaternion(phi, theta, magnetic), 16384.0 * fuses)
        celsius = self.inputs["temperature"] - 273.15
        self.put("TEMP", (celsius * 9.0 / 5.0 + 32.0) / 2.0 if units & 0x10 else celsius)
        self.put("CALIB_STAT", 0xFF if fuses else 0)
        self.put("SYS_STATUS", 5 if fuses else 6 if mode else 0)

    def _put_scaled(self, first: str, values: Iterable[float], scale: float) -> None:
        self.put_vector(first, [value * scale for value in values])


def _axes(attitude: tuple[float, float, float]) -> tuple[float, float, float]:
    """Return the unit vector down in body axes: (-s_theta, s_phi c_theta, c_phi c_theta)."""
    phi, theta, _ = attitude
    return (-math.sin(theta), math.sin(phi) * math.cos(theta), math.cos(phi) * math.cos(theta))


def _quaternion(phi: float, theta: float, psi: float) -> tuple[float, ...]:
    """Return the unit quaternion of Euler angles ZYX ([Fossen2021], 2.77)."""
    cp, sp = math.cos(phi / 2), math.sin(phi / 2)
    ct, st = math.cos(theta / 2), math.sin(theta / 2)
    cy, sy = math.cos(psi / 2), math.sin(psi / 2)
    return (
        cy * ct * cp + sy * st * sp,
        cy * ct * sp - sy * st * cp,
        cy * st * cp + sy * ct * sp,
        sy * ct * cp - cy * st * sp,
    )
