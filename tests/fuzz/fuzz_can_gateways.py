"""Lines of programs to the CAN gateways: slcan, socketcand, Yacht Devices RAW."""

from __future__ import annotations

from typing import Any

from seatrial_kits.can.gateways import slcan, socketcand, yd_raw
from seatrial_kits.can.operations import Transmit, decode, encode

CLIENTS = (
    slcan._Adapter,
    lambda channel: socketcand._Client(channel, socketcand._Traffic()),
    yd_raw._Client,
)


class _Channel:
    """Takes what a client is sent."""

    is_open = True

    def __init__(self) -> None:
        self.sent = 0

    def send(self, data: bytes) -> None:
        self.sent += len(data)

    def close(self) -> None:
        pass


def one(data: bytes) -> None:
    """Let a client of each kind receive the bytes; its frames go on the bus and back."""
    for kind in CLIENTS:
        channel: Any = _Channel()
        client = kind(channel)
        for begin in range(0, len(data), 37):
            for frame in client.receive(data[begin : begin + 37]):
                assert list(decode(encode(Transmit(frame)))) == [Transmit(frame)]
                client.send(0, frame)
        assert channel.sent <= 100 + 60 * len(data)
