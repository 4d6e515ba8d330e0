"""Devices of an ESP32 whose other end is outside of the board: flash, CAN controller, WiFi."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from seatrial.model.component import NS

from ..board import MESSAGE, Event, Inputs
from ..mcus import CLOCK
from ..part import Part
from ..parts import espnow
from ..ports import ArduinoPorts
from . import can_port, network
from .flash import Flash


class Peripherals:
    """They of the component ``board``; ``data`` is a folder that the flash begins with besides.

    ``parts`` are the board's; those of ESP-NOW have its frames.

    Raises InputError for a folder that cannot be read and a network that is not allowed.
    """

    def __init__(self, board: ArduinoPorts, data: Path | None, parts: Sequence[Part]) -> None:
        self._board = board
        self._memory: dict[str, Any] = {}
        self._can = can_port.CanPort(self._memory)
        self._network = network.Network(board.name, board.network)
        self._flash = Flash(board.flash, data)
        self._radios = [part for part in parts if isinstance(part, espnow.EspNow)]
        self._told = False
        self._message: tuple[int, int, int] | None = None
        self._bytes = bytearray()
        self.can_tx = ""

    @property
    def folder(self) -> str:
        """The flash's."""
        return self._flash.folder

    def receive(self, inputs: Inputs) -> None:
        """Put before the board what has come for it."""
        if not self._told:
            self._network.connect(inputs)
            self._told = True
        self._can.receive(self._board.can_rx, inputs)
        self._network.receive(inputs)

    def take(self, event: Event, begun_ns: int) -> None:
        """Take in a piece of a message of the board, which had power at ``begun_ns``."""
        kind, channel, value, cycle = event
        if kind == MESSAGE:
            self._message = channel, value, begun_ns + cycle * 1000 // (CLOCK // 1_000_000)
            self._bytes = bytearray()
        else:
            self._bytes += value.to_bytes(2, "little")
        if self._message is None or len(self._bytes) < self._message[1]:
            return
        channel, size, time_ns = self._message
        whole, self._message = bytes(self._bytes[:size]), None
        if channel == can_port.CHANNEL:
            self._can.send(time_ns, whole)
        elif channel == network.CHANNEL:
            self._network.send(whole)
        else:
            for radio in self._radios:
                radio.sent((time_ns - begun_ns) / NS, whole)

    def flush(self) -> None:
        """Publish at the end of a step."""
        self.can_tx = self._can.flush()

    def restart(self) -> None:
        """Close what the program had open: it begins anew."""
        self._network.close()
        self._message, self._told = None, False

    def end(self) -> None:
        """Close everything, and keep the flash where the component says."""
        self._network.close()
        self._flash.end(self._board.flash_after)
