"""nRF24L01+: radio of 2.4 GHz. Nordic Semiconductor, nRF24L01+ product specification 1.0."""

from __future__ import annotations

import math

from ..part import SpiPart

_CONFIG, _AUTO_ACK, _ENABLED, _WIDTH, _RATE, _STATUS = 0x00, 0x01, 0x02, 0x03, 0x06, 0x07
_ADDRESS_0, _TO, _SIZE_0, _FIFO, _DYNAMIC, _FEATURE = 0x0A, 0x10, 0x11, 0x17, 0x1C, 0x1D
_AT_POWER_ON = {
    _CONFIG: 0x08,
    _AUTO_ACK: 0x3F,
    _ENABLED: 0x03,
    _WIDTH: 0x03,
    0x04: 0x03,
    0x05: 0x02,
    _RATE: 0x0E,
    **{_ADDRESS_0 + pipe: 0xC1 + pipe for pipe in range(2, 6)},
}
_LONG = {_ADDRESS_0: 0xE7, _ADDRESS_0 + 1: 0xC2, _TO: 0xE7}
"""Registers of 5 bytes, and what each of these is at power-on."""
_POWER, _LISTENS = 0x02, 0x01
_RECEIVED, _SENT = 0x40, 0x20
_READ_PAYLOAD, _PAYLOAD_SIZE, _SEND, _SEND_UNANSWERED = 0x61, 0x60, 0xA0, 0xB0
_FLUSH_TX, _FLUSH_RX, _ACK_PAYLOAD = 0xE1, 0xE2, 0xA8
_DEPTH, _PIPES, _ADDRESS = 3, 6, 5
_SETTLES = 130e-6


class Nrf24(SpiPart):
    """At its pin CSN: packets are ``tx`` and ``rx`` of the line of its number, the address first.

    An address has 5 bytes: the lowest comes first, as it is written, and shorter ones end in zeros.
    A packet lasts as long as the specification says (7.3), is acknowledged whoever is there, and
    arrives if the radio listens then at that address. CE, channels and rates are not compared.
    """

    pins = 1

    def reset(self) -> None:
        """Begin with registers as at power-on."""
        self.line = self.number
        self._registers = {at: bytes([value]) for at, value in _AT_POWER_ON.items()}
        self._registers |= {at: bytes([value]) * _ADDRESS for at, value in _LONG.items()}
        self._flags, self._command = 0, -1
        self._data = b""
        self._inbox: list[tuple[int, bytes]] = []
        self._outbox: list[tuple[bytes, bool]] = []
        self._answers: list[tuple[int, bytes]] = []
        self._sent_at = math.inf
        self._coming: list[tuple[float, bytes]] = []

    def arrived(self, time: float, data: bytes) -> None:
        """Take in a packet that is over at ``time``."""
        self._coming.append((time, data[: _ADDRESS + 32]))

    # ------------------------------------------------------------------ bytes

    def selected(self) -> None:
        """Begin with a command."""
        self._command, self._data = -1, b""
        self._settle()

    def exchange(self, sent: bytes) -> bytes:
        """Take in a command and its data; return the status, then what the command reads."""
        begins = self._command < 0 and not sent
        self._take(sent)
        return self._read_register(_STATUS) if begins else self._reply_of(self._command)

    def released(self, sent: bytes) -> None:
        """Do what was written."""
        self._take(sent)
        command, data = self._command, self._data
        if 0x20 <= command < 0x40:
            self._write_register(command & 0x1F, data)
        elif command in (_SEND, _SEND_UNANSWERED) and len(self._outbox) < _DEPTH:
            self._outbox.append((data[:32], command == _SEND))
        elif _ACK_PAYLOAD <= command < _ACK_PAYLOAD + _PIPES and len(self._answers) < _DEPTH:
            self._answers.append((command - _ACK_PAYLOAD, data[:32]))
        elif command == _FLUSH_TX:
            self._outbox, self._answers, self._sent_at = [], [], math.inf
        elif command == _FLUSH_RX:
            self._inbox = []
        elif command == _READ_PAYLOAD:
            self._inbox = self._inbox[1:]
        self._send()

    def _take(self, sent: bytes) -> None:
        if sent and self._command < 0:
            self._command, sent = sent[0], sent[1:]
        self._data += sent

    def _reply_of(self, command: int) -> bytes:
        if 0 <= command < 0x20:
            return self._read_register(command)
        if command == _READ_PAYLOAD and self._inbox:
            return self._inbox[0][1]
        if command == _PAYLOAD_SIZE:
            return bytes([len(self._inbox[0][1]) if self._inbox else 0])
        return bytes(32)

    def _read_register(self, at: int) -> bytes:
        if at == _STATUS:
            pipe = self._inbox[0][0] if self._inbox else 7
            return bytes([self._flags | pipe << 1 | (len(self._outbox) == _DEPTH)])
        if at == _FIFO:
            received, sent = len(self._inbox), len(self._outbox) or len(self._answers)
            full = (received == _DEPTH) << 1 | (sent == _DEPTH) << 5
            return bytes([full | (not received) | (not sent) << 4])
        return self._registers.get(at, b"\0")

    def _write_register(self, at: int, data: bytes) -> None:
        if at == _STATUS:
            self._flags &= ~data[0]
        elif at in _LONG:
            self._registers[at] = data[:_ADDRESS] + self._registers[at][len(data) :]
        else:
            self._registers[at] = data[:1]

    # ------------------------------------------------------------------ packets

    def _register(self, at: int) -> int:
        return self._registers.get(at, b"\0")[0]

    def _mode(self) -> int:
        return self._register(_CONFIG) & (_POWER | _LISTENS)

    def _padded(self, address: bytes) -> bytes:
        return address[: self._register(_WIDTH) + 2].ljust(_ADDRESS, b"\0")

    def _address(self, pipe: int) -> bytes:
        own = self._registers[_ADDRESS_0 + pipe]
        return self._padded(own if pipe < 2 else own + self._registers[_ADDRESS_0 + 1][1:])

    def _on_air(self, size: int) -> float:
        """Return how long a packet lasts, s: preamble, address, control, data and CRC."""
        rate = self._register(_RATE)
        bits_a_second = 250e3 if rate & 0x20 else 2e6 if rate & 0x08 else 1e6
        check = 1 + (self._register(_CONFIG) >> 2 & 1)
        bits = 8 * (1 + self._register(_WIDTH) + 2 + size + check) + 9
        return _SETTLES + bits / bits_a_second

    def _send(self) -> None:
        """Begin to send the first payload that waits, if nothing is on its way."""
        if not self._outbox or self._sent_at < math.inf or self._mode() != _POWER:
            return
        data, answered = self._outbox[0]
        over = self.time + self._on_air(len(data))
        self.packets.append((over, self._padded(self._registers[_TO]) + data))
        answered = answered and bool(self._register(_AUTO_ACK) & 1)
        self._sent_at = over + (self._on_air(0) if answered else 0.0)

    def _settle(self) -> None:
        """Let happen what has until now."""
        while self.time >= self._sent_at:
            self._sent_at = math.inf
            self._outbox.pop(0)
            self._flags |= _SENT
            self._send()
        while self._coming and self._coming[0][0] <= self.time:
            self._receive(*self._coming.pop(0))

    def _receive(self, time: float, packet: bytes) -> None:
        address, data = packet[:_ADDRESS], packet[_ADDRESS:]
        listens = self._mode() == _POWER | _LISTENS
        if not self._mode() & _POWER:
            return
        for pipe in range(_PIPES if listens else 1):  # to who sends come answers alone, on pipe 0
            if self._register(_ENABLED) >> pipe & 1 and self._address(pipe) == address:
                self._put(pipe, data)
                if listens:
                    self._answer(pipe, time)
                return

    def _put(self, pipe: int, data: bytes) -> None:
        dynamic = self._register(_FEATURE) & 0x04 and self._register(_DYNAMIC) >> pipe & 1
        size = self._register(_SIZE_0 + pipe)
        if len(self._inbox) < _DEPTH and (dynamic or len(data) == size):
            self._inbox.append((pipe, data))
            self._flags |= _RECEIVED

    def _answer(self, pipe: int, time: float) -> None:
        """Send back with the acknowledgement what waits for it."""
        waiting = next((each for each in self._answers if each[0] == pipe), None)
        if waiting is None:
            return
        self._answers.remove(waiting)
        over = max(time, self.time) + self._on_air(len(waiting[1]))
        self.packets.append((over, self._address(pipe) + waiting[1]))
        self._flags |= _SENT
