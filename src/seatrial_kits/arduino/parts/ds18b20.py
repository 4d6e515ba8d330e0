"""DS18B20: thermometer on a 1-Wire bus of its own. Maxim 19-7487 rev 6."""

from __future__ import annotations

from collections.abc import Callable

from ..part import PinPart

_RESET_S, _SAMPLE_S, _HOLD_S = 400e-6, 25e-6, 30e-6
"""Low time of a reset; low time of a slot from which on a zero is written; hold of a zero read."""
_PRESENCE_S = (30e-6, 150e-6)
_CONVERSION_S = 0.75
_FAMILY = 0x28
_SEARCH, _READ_ROM, _MATCH, _SKIP = 0xF0, 0x33, 0x55, 0xCC
_CONVERT, _READ, _WRITE, _POWER = 0x44, 0xBE, 0x4E, 0xB4
_AT_POWER_ON = 85.0


class Ds18b20(PinPart):
    """A ``temperature``, in 1/16 K at 12 bits: 0.75 s to convert, halved with each bit less.

    Its serial number is the number in ``wires``; powered from outside.
    """

    ports = ("temperature",)

    _in: list[bool]
    _out: list[bool]
    _search: int
    """Which bit of its number a search is at; -1: none goes on."""
    _then: Callable[[int], None] | None

    def reset(self) -> None:
        """Begin with 85 deg C, as it has without a conversion."""
        serial = bytes([_FAMILY, self.number, 0, 0, 0, 0, 0])
        self._rom = serial + bytes([crc8(serial)])
        self._scratch = bytearray([0, 0, 0x4B, 0x46, 0x7F, 0xFF, 0x0C, 0x10])
        self._store(_AT_POWER_ON)
        self._fallen = self._ready = 0.0
        self._pending: float | None = None
        self._listen(None)
        self.drive(self.places[0], [(0.0, 1)])

    # ------------------------------------------------------------------ the bus

    def edge(self, level: int) -> None:
        """Follow a reset, a bit that is written, or a slot in which one is read."""
        if not level:
            self._fallen = self.time
            self._was_read = bool(self._out)
            if self._out and not self._take_out():
                self.drive(self.places[0], [(self.time, 0), (self.time + _HOLD_S, 1)])
            return
        low = self.time - self._fallen
        if low >= _RESET_S:
            self._listen(self._rom_command)
            begin, end = (self.time + each for each in _PRESENCE_S)
            self.drive(self.places[0], [(begin, 0), (end, 1)])
        elif not self._was_read:
            self._take_in(low < _SAMPLE_S)

    def _take_out(self) -> bool:
        """Return the bit that is read next; True leaves the bus alone."""
        if self._status:
            return self.time >= self._ready
        return self._out.pop(0)

    def _take_in(self, bit: bool) -> None:
        if self._search >= 0:
            self._direct(bit)
            return
        self._in.append(bit)
        if len(self._in) == 8 and self._then is not None:
            byte = sum(each << n for n, each in enumerate(self._in))
            self._in = []
            self._then(byte)

    def _listen(self, then: Callable[[int], None] | None) -> None:
        """Let ``then`` have the next byte, and send nothing."""
        self._then, self._in, self._out = then, [], []
        self._search, self._status, self._was_read = -1, False, False

    def _send(self, data: bytes, then: Callable[[int], None] | None) -> None:
        self._listen(then)
        self._out = [bool(byte >> bit & 1) for byte in data for bit in range(8)]

    # ------------------------------------------------------------------ commands

    def _rom_command(self, byte: int) -> None:
        if byte == _SKIP:
            self._listen(self._function)
        elif byte == _READ_ROM:
            self._send(self._rom, self._function)
        elif byte == _MATCH:
            self._listen(self._matching(list(self._rom)))
        elif byte == _SEARCH:
            self._listen(None)
            self._search = 0
            self._offer()
        else:
            self._listen(None)

    def _matching(self, left: list[int]) -> Callable[[int], None]:
        def take(byte: int) -> None:
            if byte != left.pop(0):
                self._listen(None)
            elif not left:
                self._listen(self._function)

        return take

    def _offer(self) -> None:
        bit = self._rom_bit()
        self._out = [bit, not bit]

    def _rom_bit(self) -> bool:
        return bool(self._rom[self._search // 8] >> self._search % 8 & 1)

    def _direct(self, bit: bool) -> None:
        """Go on with a search in the direction that the master has taken, if it is this one's."""
        if bit != self._rom_bit():
            self._listen(None)
            return
        self._search += 1
        if self._search == 64:
            self._listen(self._function)
        else:
            self._offer()

    def _function(self, byte: int) -> None:
        self._settle()
        if byte == _CONVERT:
            self._pending = self.inputs["temperature"] - 273.15
            bits = self._scratch[4] >> 5 & 3
            self._ready = self.time + _CONVERSION_S / (1 << 3 - bits)
            self._listen(None)
            self._status, self._out = True, [True]
        elif byte == _READ:
            self._send(bytes(self._scratch) + bytes([crc8(bytes(self._scratch))]), None)
        elif byte == _WRITE:
            self._listen(self._writing([2, 3, 4]))
        elif byte == _POWER:
            self._listen(None)
            self._out = [True]
        else:
            self._listen(None)

    def _writing(self, places: list[int]) -> Callable[[int], None]:
        def take(byte: int) -> None:
            if places:
                at = places.pop(0)
                self._scratch[at] = byte & 0x60 | 0x1F if at == 4 else byte

        return take

    def _settle(self) -> None:
        """Have what a conversion that is over has measured."""
        if self._pending is not None and self.time >= self._ready:
            self._store(self._pending)
            self._pending = None

    def _store(self, celsius: float) -> None:
        unused = 3 - (self._scratch[4] >> 5 & 3)
        count = round(min(max(celsius, -55.0), 125.0) * 16.0) >> unused << unused
        self._scratch[0:2] = count.to_bytes(2, "little", signed=True)


def crc8(data: bytes) -> int:
    """Return the cyclic redundancy check of 1-Wire: x8 + x5 + x4 + 1, lowest bit first."""
    crc = 0
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = crc >> 1 ^ 0x8C if crc & 1 else crc >> 1
    return crc
