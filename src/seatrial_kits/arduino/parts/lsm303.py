"""LSM303DLHC: accelerometer and magnetometer, two devices on the bus. ST DocID018771 rev 2."""

from __future__ import annotations

from typing import ClassVar

from seatrial.model.unit_table import STANDARD_GRAVITY

from ..part import I2CRegisters, Register
from .hmc5883l import Hmc5883l

_MILLI_G = (1.0, 2.0, 4.0, 12.0)
"""Of a count of 12 bits, by the full scale."""
_NEW_DATA = 0x0F


class Lsm303Accelerometer(I2CRegisters):
    """Specific force, body axes: 12 bits, left-justified; off until CTRL1 has a rate.

    The pointer advances only where the highest bit of the register's byte is set.
    """

    ports = ("accelerometer",)
    pointer_mask = 0x7F
    registers: ClassVar = {
        "CTRL1": Register(0x20, 0x07, access="acts"),
        "CTRL4": Register(0x23, access="acts"),
        "STATUS": Register(0x27, access="r"),
        "X": Register(0x28, form="s16le", access="r"),
        "Y": Register(0x2A, form="s16le", access="r"),
        "Z": Register(0x2C, form="s16le", access="r"),
    }

    def advanced(self, pointer: int) -> int:
        """Return the next pointer."""
        return 0x80 | pointer + 1 if pointer & 0x80 else pointer

    def written(self, name: str, value: int) -> bool:
        """Measure by the settings that are there now."""
        self.measure()
        return True

    def measure(self) -> None:
        """Fill the registers of data of the axes that are enabled."""
        control = self.get("CTRL1")
        if not control >> 4:
            return
        milli_g = _MILLI_G[self.get("CTRL4") >> 4 & 3]
        for bit, (axis, force) in enumerate(zip("XYZ", self.inputs["accelerometer"], strict=True)):
            count = round(force / STANDARD_GRAVITY * 1000.0 / milli_g)
            self.put(axis, 16 * min(max(count, -2048), 2047) if control >> bit & 1 else 0)
        self.put("STATUS", _NEW_DATA)


_IN_PLANE = (1100, 1100, 855, 670, 450, 400, 330, 230)
_ACROSS = (980, 980, 760, 600, 400, 355, 295, 205)


class Lsm303Magnetometer(Hmc5883l):
    """The magnetic field, body axes, T: an HMC5883L with other counts, asleep at first."""

    counts: ClassVar = {"X": _IN_PLANE, "Y": _IN_PLANE, "Z": _ACROSS}
    registers: ClassVar = {
        **Hmc5883l.registers,
        "MODE": Register(0x02, 0x03, access="acts"),
        "WHO_AM_I": Register(0x0F, 0x3C, access="r"),  # not in the data sheet; drivers read it
    }
