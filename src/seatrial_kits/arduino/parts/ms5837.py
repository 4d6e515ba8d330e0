"""MS5837-30BA: pressure and temperature. TE ENG_DS_MS5837-30BA, with its example of calibration."""

from __future__ import annotations

from collections.abc import Callable

from ..part import I2CStream

_PROM = (0, 34982, 36352, 20328, 22354, 26646, 26146, 0)


class Ms5837(I2CStream):
    """Absolute pressure and temperature: counts, compensated by the driver to second order."""

    ports = ("pressure", "water_temperature")

    def reset(self) -> None:
        """Begin without a conversion."""
        self._converted = 0

    def written(self, byte: int) -> bool:
        """Act on a command: words of the PROM, conversions, and reading them."""
        if 0xA0 <= byte <= 0xAC:
            word = _crc4() << 12 if byte == 0xA0 else _PROM[(byte - 0xA0) // 2]
            self.reply(word.to_bytes(2, "big"))
        elif 0x40 <= byte <= 0x5A:
            self._convert(pressure=byte < 0x50)
            self.reply(b"")
        elif byte == 0x00:
            self.reply(self._converted.to_bytes(3, "big"))
        elif byte == 0x1E:
            self.reply(b"")
        else:
            self.reply(bytes(8 * [0xFF]))  # it drives the bus for none of these
        return True

    def _convert(self, *, pressure: bool) -> None:
        celsius = self.inputs["water_temperature"] - 273.15
        d2 = _count(lambda count: _celsius(count)[1], celsius)
        pascal = self.inputs["pressure"]
        self._converted = _count(lambda count: _pascal(count, d2), pascal) if pressure else d2


def _celsius(d2: float) -> tuple[float, float]:
    """Return the temperature to first order, 0.01 deg C, and to second, deg C."""
    dt = d2 - _PROM[5] * 256.0
    temp = 2000.0 + dt * _PROM[6] / 8388608.0
    ti = 3.0 * dt * dt / 8589934592.0 if temp < 2000.0 else 2.0 * dt * dt / 137438953472.0
    return temp, (temp - ti) / 100.0


def _pascal(d1: float, d2: float) -> float:
    temp, dt = _celsius(d2)[0], d2 - _PROM[5] * 256.0
    off = _PROM[2] * 65536.0 + _PROM[4] * dt / 128.0
    sens = _PROM[1] * 32768.0 + _PROM[3] * dt / 256.0
    t, sensi = (temp - 2000.0) ** 2, 0.0
    if temp < 2000.0:
        cold = (temp + 1500.0) ** 2 if temp < -1500.0 else 0.0
        offi = 3.0 * t / 2.0 + 7.0 * cold
        sensi = 5.0 * t / 8.0 + 4.0 * cold
    else:
        offi = t / 16.0
    return (d1 * (sens - sensi) / 2097152.0 - (off - offi)) / 8192.0 * 10.0


def _count(value: Callable[[float], float], wanted: float) -> int:
    """Return the count of 24 bits for a value that rises with it, to the bit."""
    low, high = 0, (1 << 24) - 1
    while low < high:
        middle = (low + high) // 2
        if value(middle) < wanted:
            low = middle + 1
        else:
            high = middle
    return low


def _crc4() -> int:
    remainder = 0
    for number in range(16):
        word = _PROM[number >> 1]
        remainder ^= word & 0xFF if number % 2 else word >> 8
        for _ in range(8):
            remainder = (remainder << 1 ^ 0x3000 if remainder & 0x8000 else remainder << 1) & 0xFFFF
    return remainder >> 12 & 0xF
