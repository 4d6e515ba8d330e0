"""Log download: the run's own telemetry log, by LOG_REQUEST_LIST and LOG_REQUEST_DATA."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from pymavlink.dialects.v20 import all as mavlink

from ..codec import Message
from ..service import WARNING, Service, on_message
from ..transport import Sender, Transport
from ..vehicle import Vehicle

BLOCK = 90
"""Bytes of the log in one LOG_DATA."""
RATE = 400.0
"""LOG_DATA that a link gets per second: 36 kB/s of the log."""

_SLACK_S = 1e-9  # what two doubles for one instant may differ by


@dataclass
class _Download:
    """What a link still gets: from ``offset`` to ``end``, the next one when ``due``, s."""

    offset: int
    end: int
    due: float


class LogService(Service):
    """The log that ``file`` names: None while there is none.

    It grows as it is downloaded, so its length is that when it was last listed. A block shorter
    than 90 bytes, at the end an empty one, is the last. LOG_REQUEST_END stops a download; the log
    cannot be erased.
    """

    def __init__(
        self, vehicle: Vehicle, transport: Transport, file: Callable[[], Path | None]
    ) -> None:
        super().__init__(vehicle, transport)
        self._file = file
        self._size = 0
        self._number = int(vehicle.dialect.home_is_item_0)  # ArduPilots count from 1
        self._downloads: dict[int, _Download] = {}

    def tick(self, now: float) -> None:
        """Send what is due, and forget the links that are gone."""
        links, now = set(self.transport.links()), self.vehicle.link_time(now)
        self._downloads = {k: v for k, v in self._downloads.items() if k in links}
        for link, download in list(self._downloads.items()):
            while link in self._downloads and now >= download.due - _SLACK_S:
                self._send(link, download)
                download.due += 1.0 / RATE

    @on_message(mavlink.MAVLINK_MSG_ID_LOG_REQUEST_LIST)
    def _list(self, message: Message, sender: Sender, now: float) -> None:
        path = self._file()
        self._size = 0 if path is None else path.stat().st_size
        begun = self.vehicle.identity.boot_unix_us // 1_000_000
        there = (self._number, 1, self._number, begun, self._size)
        entry = (0, 0, 0, 0, 0) if path is None else there
        self.transport.send(sender.link, mavlink.MAVLink_log_entry_message(*entry))

    @on_message(mavlink.MAVLINK_MSG_ID_LOG_REQUEST_DATA)
    def _begin(self, message: Message, sender: Sender, now: float) -> None:
        path = self._file()
        if path is None or message.id != self._number:
            self.vehicle.report(WARNING, f"There is no log {message.id}")
            return
        self._size = self._size or path.stat().st_size
        end = min(message.ofs + message.count, self._size)
        due = self.vehicle.link_time(now)
        self._downloads[sender.link] = _Download(message.ofs, end, due)

    def _send(self, link: int, download: _Download) -> None:
        path = self._file()
        wanted = min(BLOCK, max(download.end - download.offset, 0))
        data = b""
        if path is not None and wanted:
            with path.open("rb") as file:
                file.seek(download.offset)
                data = file.read(wanted)
        block = list(data.ljust(BLOCK, b"\0"))
        self.transport.send(
            link, mavlink.MAVLink_log_data_message(self._number, download.offset, len(data), block)
        )
        download.offset += len(data)
        all_sent = download.offset >= download.end and download.end < self._size
        if len(data) < BLOCK or all_sent:
            del self._downloads[link]

    @on_message(mavlink.MAVLINK_MSG_ID_LOG_REQUEST_END)
    def _end(self, message: Message, sender: Sender, now: float) -> None:
        self._downloads.pop(sender.link, None)

    @on_message(mavlink.MAVLINK_MSG_ID_LOG_ERASE)
    def _refuse(self, message: Message, sender: Sender, now: float) -> None:
        self.vehicle.report(WARNING, "The log belongs to the run: it is not erased")
