"""Yacht Devices gateway in RAW mode, which most marine programs can read.

Lines of text (YDWG-02 user manual, appendix E): time of day, direction, identifier and data in
hexadecimal, as ``17:33:21.107 R 19F51323 01 2F 30 70 00 2F 30 70``; a program sends the same
without time and direction. Extended data frames only: NMEA 2000 has no others.
"""

from __future__ import annotations

from seatrial.links.endpoints.endpoint import Endpoint

from ..frame import Frame
from .clients import Client, ClientsGateway

_DAY_MS = 86_400_000


class YdRawGateway(ClientsGateway):
    """The gateway at one endpoint: a server, or one address that everything is sent to."""

    def __init__(self, endpoint: Endpoint) -> None:
        super().__init__(endpoint, _Client)
        self.reached_at = endpoint.url.replace("tcpin:", "yd-raw-tcp:", 1).replace(
            "udpout:", "yd-raw-udp:", 1
        )

    def send(self, time_ns: int, frame: Frame, sender: int | None = None) -> None:
        """Send to all but ``sender``; also to a peer that has never sent anything."""
        self._greet(self._endpoint.channels())
        super().send(time_ns, frame, sender)


class _Client(Client):
    end = b"\n"

    def read(self, line: str) -> Frame | None:
        return read_line(line)

    def refuse(self) -> None:
        """Send nothing: the protocol has no such line."""

    def send(self, time_ns: int, frame: Frame) -> None:
        if frame.extended and not frame.remote and not frame.fd:
            self._channel.send(written_line(time_ns, frame).encode("ascii"))


def written_line(time_ns: int, frame: Frame) -> str:
    """Return the line of a frame that was on the bus at a simulated time; the day begins at 0."""
    seconds, milliseconds = divmod(time_ns // 10**6 % _DAY_MS, 1000)
    clock = f"{seconds // 3600:02d}:{seconds // 60 % 60:02d}:{seconds % 60:02d}.{milliseconds:03d}"
    return f"{clock} R {frame.identifier:08X} {frame.data.hex(' ').upper()}\r\n"


def read_line(line: str) -> Frame | None:
    """Return the frame of a line, with or without time and direction; None for an empty one.

    Raises ValueError or InputError for a line that is none.
    """
    words = line.split()
    if not words:
        return None
    if len(words) > 2 and words[1] in ("R", "T"):
        words = words[2:]
    return Frame(int(words[0], 16), bytes(int(word, 16) for word in words[1:]), extended=True)
