"""HMC5883L: magnetometer. Honeywell 900405 rev E."""

from __future__ import annotations

from typing import ClassVar

from ..part import I2CRegisters, Register

_PER_GAUSS = (1370, 1090, 820, 660, 440, 390, 330, 230)
_BIAS = (1.16, 1.16, 1.08)
"""Gauss: a coil's in the self test, from which the field is taken."""
_OVERFLOW = -4096


class Hmc5883l(I2CRegisters):
    """The magnetic field in body axes, T, in ranges by the gain; single measurements, self test."""

    ports = ("field",)
    pointer_mask = 0x7F
    counts: ClassVar = {"X": _PER_GAUSS, "Y": _PER_GAUSS, "Z": _PER_GAUSS}
    """Counts per gauss of each axis, by the gain."""
    registers: ClassVar = {
        "CONFIG_A": Register(0x00, 0x10, access="acts"),
        "CONFIG_B": Register(0x01, 0x20, access="acts"),
        "MODE": Register(0x02, 0x01, access="acts"),
        "X": Register(0x03, form="s16be"),
        "Z": Register(0x05, form="s16be"),
        "Y": Register(0x07, form="s16be"),
        "STATUS": Register(0x09, access="r"),
        "ID": Register(0x0A, 0x48),
        "ID_B": Register(0x0B, 0x34),
        "ID_C": Register(0x0C, 0x33),
    }

    def advanced(self, pointer: int) -> int:
        """Return the next pointer: registers of data come round."""
        return 3 if pointer == 8 else pointer + 1

    def written(self, name: str, value: int) -> bool:
        """Measure by the settings that are there now."""
        self.measure()
        return True

    def measure(self) -> None:
        """Fill the registers of data, unless idle: after a single measurement it is."""
        mode = self.get("MODE")
        if mode & 3 > 1:
            return
        self.put("MODE", mode << 1 | mode if mode & 3 == 1 else mode)
        test = self.get("CONFIG_A") & 3
        gain = self.get("CONFIG_B") >> 5
        for axis, tesla, bias in zip("XYZ", self.inputs["field"], _BIAS, strict=True):
            gauss = {1: bias, 2: -bias}.get(test, tesla * 1e4)
            raw = gauss * self.counts[axis][gain]
            self.put(axis, _OVERFLOW if abs(raw) > 2047.5 else raw)
        self.put("STATUS", 1)
