"""slcan gateway: an adapter as serial CAN adapters are.

Commands of LAWICEL's CAN232 and, for CAN FD, of the CANable 2: one letter, then digits, ended by
a carriage return. Every one is answered, by a carriage return if it was understood and by BEL if
not: some programs wait for that. Bit rates, S0 to S8, are accepted and not used: the bus has its
own.
"""

from __future__ import annotations

from seatrial.links.endpoints.endpoint import Channel, Endpoint

from ..frame import FD_LENGTHS, Frame
from .clients import Client, ClientsGateway

_ANSWERS = {"V": "V1010", "v": "vSTDC", "N": "NSIMU", "F": "F00"}
_SETTINGS = "SsYMmWXUQ"
"""Bit rate, filters, polling: accepted, and without effect."""
_BIT_RATES = tuple("012345678")
"""LAWICEL's, 10 kbit/s to 1 Mbit/s."""
_TIMESTAMP_MS = 60_000
"""Times of frames are counted in ms, and begin again at 0 after a minute."""


class SlcanGateway(ClientsGateway):
    """Adapters at one endpoint, one per peer; see `ClientsGateway`."""

    def __init__(self, endpoint: Endpoint) -> None:
        super().__init__(endpoint, _Adapter)
        # pyserial's URL, or the device.
        self.reached_at = endpoint.url.replace("tcpin:", "socket://", 1)


class _Adapter(Client):
    end = b"\r"

    def __init__(self, channel: Channel) -> None:
        super().__init__(channel)
        self._open = self._listens = self._stamps = False

    def read(self, line: str) -> Frame | None:
        line = line.strip("\n\0 ")
        letter = line[:1]
        frame = None
        if letter in ("t", "T", "r", "R", "d", "D", "b", "B") and letter:
            frame = _read_frame(letter, line[1:])
            if not self._open or self._listens:
                raise ValueError("the channel is not open")
        elif letter in ("O", "L", "C"):
            self._open, self._listens = letter != "C", letter == "L"
        elif letter == "Z":
            self._stamps = line[1:2] == "1"
        elif letter in _ANSWERS:
            self.write(_ANSWERS[letter])
        elif letter == "S" and line[1:] not in _BIT_RATES:
            raise ValueError("no such bit rate")
        elif letter and letter not in _SETTINGS:
            raise ValueError("unknown command")
        self.write("\r")
        return frame

    def refuse(self) -> None:
        self.write("\a")

    def send(self, time_ns: int, frame: Frame) -> None:
        if self._open:
            stamp = f"{time_ns // 10**6 % _TIMESTAMP_MS:04X}" if self._stamps else ""
            self.write(f"{_written(frame)}{stamp}\r")


def _written(frame: Frame) -> str:
    if frame.remote:
        letter = "r"
    elif frame.fd:
        letter = "b" if frame.bit_rate_switch else "d"
    else:
        letter = "t"
    digits = f"{frame.identifier:08X}" if frame.extended else f"{frame.identifier:03X}"
    letter = letter.upper() if frame.extended else letter
    return f"{letter}{digits}{frame.dlc:X}{frame.data.hex().upper()}"


def _read_frame(letter: str, rest: str) -> Frame:
    """Return the frame of a line; raises ValueError, IndexError or InputError."""
    extended, kind = letter.isupper(), letter.lower()
    digits = 8 if extended else 3
    identifier, dlc = int(rest[:digits], 16), int(rest[digits], 16)
    data = bytes.fromhex(rest[digits + 1 :])
    fd = kind in ("d", "b")
    if kind == "r":
        return Frame(identifier, b"", extended, True, requested=dlc)
    if len(data) != FD_LENGTHS[dlc] or (dlc > 8 and not fd):
        raise ValueError("the length does not fit the data")
    return Frame(identifier, data, extended, fd=fd, bit_rate_switch=kind == "b")
