"""PCA9685: sixteen channels of PWM. NXP PCA9685 rev 4."""

from __future__ import annotations

from typing import ClassVar

from ..part import I2CRegisters, Register

CHANNELS = 16
MOST = 12
"""Pulses that a board has as outputs."""
_OSCILLATOR_HZ = 25e6
_SLEEP, _ADVANCE, _FULL = 0x10, 0x20, 0x1000
_ALL = CHANNELS


class Pca9685(I2CRegisters):
    """Channel k is the ``pulse`` of the number in ``wires`` + k: 0 while off, or on for ever."""

    registers: ClassVar = {
        "MODE1": Register(0x00, 0x11, access="acts"),
        "MODE2": Register(0x01, 0x04),
        **{
            f"{end}{n}": Register(0x06 + 4 * n + more, 0x1000 * (end == "OFF"), "u16le", "acts")
            for n in range(CHANNELS)
            for end, more in (("ON", 0), ("OFF", 2))
        },
        f"ON{_ALL}": Register(0xFA, 0, "u16le", "acts"),
        f"OFF{_ALL}": Register(0xFC, 0x1000, "u16le", "acts"),
        "PRESCALE": Register(0xFE, 0x1E, access="acts"),
    }

    def advanced(self, pointer: int) -> int:
        """Return the next pointer: it advances by a bit of MODE1; behind the channels is 0."""
        if not self.get("MODE1") & _ADVANCE:
            return pointer
        return 0 if pointer == 0x45 else pointer + 1

    def written(self, name: str, value: int) -> bool:
        """Drive the channels by the registers that are there now."""
        if name in (f"ON{_ALL}", f"OFF{_ALL}"):
            for channel in range(CHANNELS):
                self.put(f"{name[:-2]}{channel}", self.get(name))
        period = 4096 * (self.get("PRESCALE") + 1) / _OSCILLATOR_HZ
        for channel in range(min(CHANNELS, MOST + 1 - self.number)):
            on, off = self.get(f"ON{channel}"), self.get(f"OFF{channel}")
            still = (on | off) & _FULL or self.get("MODE1") & _SLEEP
            self.pulses[self.number + channel] = 0.0 if still else (off - on) % 4096 / 4096 * period
        return True
