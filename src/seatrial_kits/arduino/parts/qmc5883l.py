"""QMC5883L: magnetometer. QST 13-52-04 rev A."""

from __future__ import annotations

from typing import ClassVar

from ..part import I2CRegisters, Register

_PER_GAUSS = (12000.0, 3000.0, 12000.0, 12000.0)
_READY, _OVERFLOW = 0x01, 0x02
_RESET = 0x80


class Qmc5883l(I2CRegisters):
    """The magnetic field, body axes, T, in ranges of 2 and 8 G; in standby at first."""

    ports = ("field",)
    registers: ClassVar = {
        "X": Register(0x00, form="s16le", access="r"),
        "Y": Register(0x02, form="s16le", access="r"),
        "Z": Register(0x04, form="s16le", access="r"),
        "STATUS": Register(0x06, access="r"),
        "CONTROL_1": Register(0x09, access="acts"),
        "CONTROL_2": Register(0x0A, access="acts"),
        "CHIP_ID": Register(0x0D, 0xFF, access="r"),
    }

    def written(self, name: str, value: int) -> bool:
        """Measure by the settings that are there now; begin anew with the bit of the reset."""
        if name == "CONTROL_2" and value & _RESET:
            for register in ("X", "Y", "Z", "STATUS", "CONTROL_1", "CONTROL_2"):
                self.put(register, 0)
        self.measure()
        return True

    def measure(self) -> None:
        """Fill the registers of data, unless in standby; beyond the range they hold its end."""
        control = self.get("CONTROL_1")
        if not control & 1:
            return
        counts = [tesla * 1e4 * _PER_GAUSS[control >> 4 & 3] for tesla in self.inputs["field"]]
        self.put_vector("X", counts)
        over = any(abs(count) > 32767 for count in counts)
        self.put("STATUS", _READY | (_OVERFLOW if over else 0))
