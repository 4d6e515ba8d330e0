"""RFM95 (SX1276): LoRa radio. Semtech SX1276/77/78/79 data sheet rev 7."""

from __future__ import annotations

import math

from ..part import SpiPart

_FIFO, _MODE, _POINTER, _TX_BASE, _RX_BASE, _CURRENT, _FLAGS = (
    0x00,
    0x01,
    0x0D,
    0x0E,
    0x0F,
    0x10,
    0x12,
)
_RECEIVED, _SNR, _RSSI, _CONFIG_1, _CONFIG_2, _LENGTH, _CONFIG_3 = (
    0x13,
    0x19,
    0x1A,
    0x1D,
    0x1E,
    0x22,
    0x26,
)
_PREAMBLE, _MAPPING, _VERSION = 0x20, 0x40, 0x42
_AT_POWER_ON = {
    _MODE: 0x09,
    _TX_BASE: 0x80,
    _CONFIG_1: 0x72,
    _CONFIG_2: 0x70,
    _PREAMBLE + 1: 0x08,
    _LENGTH: 0x01,
    _VERSION: 0x12,
}
_LONG_RANGE, _STANDBY, _TRANSMIT, _CONTINUOUS, _SINGLE = 0x80, 0x01, 0x03, 0x05, 0x06
_TX_DONE, _RX_DONE = 0x08, 0x40
_BANDWIDTHS = (7.8e3, 10.4e3, 15.6e3, 20.8e3, 31.25e3, 41.7e3, 62.5e3, 125e3, 250e3, 500e3)
_STRONG, _CLEAR = 107, 40
"""Strength, -50 dBm over -157, and ratio to noise, 10 dB in quarters, of what is received."""


class Rfm95(SpiPart):
    """At the pins of selection and DIO0: packets are ``tx`` and ``rx`` of the line of its number.

    A packet lasts as long as the data sheet says (4.1.1.6), and arrives if the radio receives then.
    Frequencies, sync words and the strength of signals are not compared.
    """

    pins = 2

    def reset(self) -> None:
        """Begin with registers as at power-on."""
        self.line = self.number
        self._registers = bytearray(128)
        for at, value in _AT_POWER_ON.items():
            self._registers[at] = value
        self._buffer = bytearray(256)
        self._at, self._writes = -1, False
        self._sent_at = math.inf
        self._coming: list[tuple[float, bytes]] = []
        self.drive(self.places[1], [(0.0, 0)])

    def arrived(self, time: float, data: bytes) -> None:
        """Take in a packet that is over at ``time``."""
        self._coming.append((time, data[:255]))
        self._plan()

    # ------------------------------------------------------------------ bytes

    def selected(self) -> None:
        """Begin with an address."""
        self._at = -1

    def exchange(self, sent: bytes) -> bytes:
        """Take in an address and what is written from there on; return what is read."""
        self.released(sent)
        if self._at < 0 or self._writes:
            return b"\0"
        self._settle()
        at = self._next()
        if at != _FIFO:
            return bytes([self._registers[at]])
        return bytes([self._buffer[self._advance()]])

    def released(self, sent: bytes) -> None:
        """Take in the last bytes."""
        for byte in sent:
            if self._at < 0:
                self._at, self._writes = byte & 0x7F, bool(byte & 0x80)
            elif self._writes:
                self._write(self._next(), byte)

    def _next(self) -> int:
        at = self._at
        self._at = at if at == _FIFO else (at + 1) & 0x7F
        return at

    def _advance(self) -> int:
        at = self._registers[_POINTER]
        self._registers[_POINTER] = (at + 1) & 0xFF
        return at

    def _write(self, at: int, value: int) -> None:
        self._settle()
        if at == _FIFO:
            self._buffer[self._advance()] = value
        elif at == _FLAGS:
            self._registers[at] &= ~value & 0xFF
        elif at not in (_VERSION, _RECEIVED, _CURRENT):
            self._registers[at] = value
        if at == _MODE and value & _LONG_RANGE and value & 7 == _TRANSMIT:
            self._transmit()
        if at in (_MODE, _FLAGS, _MAPPING):
            self._plan()

    # ------------------------------------------------------------------ packets

    def _transmit(self) -> None:
        length, base = self._registers[_LENGTH], self._registers[_TX_BASE]
        data = bytes(self._buffer[(base + each) & 0xFF] for each in range(length))
        self._sent_at = self.time + self.on_air(length)
        self.packets.append((self._sent_at, data))

    def on_air(self, length: int) -> float:
        """Return how long a packet of ``length`` bytes lasts, s: preamble, header and payload."""
        registers = self._registers
        spreading = max(registers[_CONFIG_2] >> 4, 6)
        symbol = float(1 << spreading) / _BANDWIDTHS[min(registers[_CONFIG_1] >> 4, 9)]
        implicit, check = registers[_CONFIG_1] & 1, registers[_CONFIG_2] >> 2 & 1
        slow = registers[_CONFIG_3] >> 3 & 1
        bits = 8 * length - 4 * spreading + 28 + 16 * check - 20 * implicit
        coding = (registers[_CONFIG_1] >> 1 & 7) + 4
        payload = 8 + max(math.ceil(bits / (4 * (spreading - 2 * slow))) * coding, 0)
        preamble = registers[_PREAMBLE] << 8 | registers[_PREAMBLE + 1]
        return (preamble + 4.25 + payload) * symbol

    def _receives(self) -> bool:
        return self._registers[_MODE] & 7 in (_CONTINUOUS, _SINGLE)

    def _settle(self) -> None:
        """Let happen what has until now."""
        if self.time >= self._sent_at:
            self._sent_at = math.inf
            self._registers[_FLAGS] |= _TX_DONE
            self._registers[_MODE] = _LONG_RANGE | _STANDBY
        while self._coming and self._coming[0][0] <= self.time:
            _, data = self._coming.pop(0)
            if self._receives():
                self._receive(data)

    def _receive(self, data: bytes) -> None:
        begin = self._registers[_RX_BASE]
        for each, byte in enumerate(data):
            self._buffer[(begin + each) & 0xFF] = byte
        for at, value in (
            (_CURRENT, begin),
            (_RECEIVED, len(data)),
            (_SNR, _CLEAR),
            (_RSSI, _STRONG),
        ):
            self._registers[at] = value
        self._registers[_FLAGS] |= _RX_DONE
        if self._registers[_MODE] & 7 == _SINGLE:
            self._registers[_MODE] = _LONG_RANGE | _STANDBY

    def _plan(self) -> None:
        """Drive DIO0, high while its flag is set, from when that will be."""
        sends = self._registers[_MAPPING] >> 6 == 1
        flag, next_at = (_TX_DONE, self._sent_at) if sends else (_RX_DONE, math.inf)
        if not sends and self._receives() and self._coming:
            next_at = self._coming[0][0]
        levels = [(self.time, int(bool(self._registers[_FLAGS] & flag)))]
        self.drive(self.places[1], [*levels, *([(next_at, 1)] if next_at < math.inf else [])])
