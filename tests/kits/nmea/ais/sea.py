"""Transponders on a VHF channel, stepped in process, and what each one says."""

from __future__ import annotations

from typing import Any

import pyais

from seatrial.links.text import decode
from seatrial_kits.nmea.ais.transponder import AisTransponder
from seatrial_kits.nmea.ais.vhf_channel import VhfChannel
from tests.devices.running import started

STEP_NS = 250_000_000
KNOT = 1852.0 / 3600.0


class Sea:
    """Ships by name; ``received`` and ``presented`` are pyais's messages of VDM and VDO, with times in s.

    ``bursts`` is what the first ship sends.
    """

    def __init__(self, channel: dict[str, Any] | None = None, **ships: dict[str, Any]) -> None:
        self.now = 0
        self.ships = {}
        for number, (name, values) in enumerate(ships.items(), 1):
            given = {"mmsi": f"71000000{number}", "position_valid": True, "heading_valid": True}
            self.ships[name] = started(AisTransponder, **{**given, **values})
        self.channel = started(VhfChannel, nodes=max(2, len(ships)), **(channel or {}))
        self.lines: dict[str, list[tuple[float, bytes]]] = {name: [] for name in ships}
        self.bursts: list[tuple[float, bytes]] = []
        self._burst = 0
        self._seen = dict.fromkeys(ships, 0)

    def run(self, seconds: float) -> None:
        for _ in range(round(seconds * 1e9) // STEP_NS):
            for number, ship in enumerate(self.ships.values(), 1):
                self.channel.set(f"tx.n{number}", ship.get("tx"))
                ship.set("rx", self.channel.get("rx")[number - 1])
                self.channel.set(f"position_{number}", ship.get("position_n"))
            for each in (*self.ships.values(), self.channel):
                each.advance(self.now / 1e9, STEP_NS / 1e9)
            self.now += STEP_NS
            number, chunks = decode(next(iter(self.ships.values())).get("tx"))
            if number != self._burst:
                self._burst = number
                self.bursts += [(when / 1e9, data) for when, data in chunks]
            for name, ship in self.ships.items():
                number, chunks = decode(ship.get("sentences"))
                if number != self._seen[name]:
                    self._seen[name] = number
                    self.lines[name] += [(when / 1e9, line) for when, line in chunks]

    def received(self, name: str, kind: int) -> list[tuple[float, Any]]:
        return [(t, m) for t, m in self._messages(name, b"!AIVDM") if m.msg_type == kind]

    def presented(self, name: str) -> list[tuple[float, Any]]:
        return self._messages(name, b"!AIVDO")

    def _messages(self, name: str, start: bytes) -> list[tuple[float, Any]]:
        found, parts = [], []
        for when, line in self.lines[name]:
            if not line.startswith(start):
                continue
            assert len(line) <= 82
            parts.append(line.strip())
            if len(parts) == int(line.split(b",")[1]):
                found.append((when, pyais.decode(*parts, error_if_checksum_invalid=True)))
                parts = []
        return found
