"""Gateway to any bus of python-can: its virtual one, or hardware."""

from __future__ import annotations

import contextlib
import select
from typing import Any

import can
from can.interfaces.slcan import slcanBus

from seatrial.errors import InputError
from seatrial.links.endpoints.budget import Budget
from seatrial.links.safe_state import Held, hold_bus

from ..frame import Frame
from ..messages import error_message, frame_of, message
from ..operations import Error
from .gateway import FRAME_BYTES, LEAST, RATE, Gateway

_LONGEST_LINE = 1024
"""Bytes of a line of slcan; a frame has 31, one of CAN FD 139."""


class PythonCanGateway(Gateway):
    """A bus of python-can's; its nodes are one client.

    Times of what is sent are simulated, as far as the interface carries them: ``virtual`` does.

    Raises InputError for a bus that cannot be opened.
    """

    def __init__(self, url: str, interface: str, channel: str, bitrate: int | None) -> None:
        options: dict[str, Any] = {} if bitrate is None else {"bitrate": bitrate}
        if interface == "virtual":
            options["preserve_timestamps"] = True
        self._opened_by = {"channel": channel, "interface": interface, **options}
        self._held: Held | None = None
        try:
            self._bus = can.Bus(**self._opened_by, ignore_config=True)
        except (can.CanError, NotImplementedError, OSError, TypeError, ValueError) as error:
            raise InputError(f"cannot open the gateway {url!r}: {error}") from None
        self._is_simulated = interface == "virtual"
        self.reached_at = url
        self.budget = Budget(RATE, LEAST)

    @property
    def clients(self) -> int:
        """Return 1: other nodes of the bus are not known."""
        return 1

    def poll(self) -> list[tuple[int, Frame]]:
        """Return frames that have arrived; what is no frame of ISO 11898-1 is counted."""
        found: list[tuple[int, Frame]] = []
        self.is_lost = self.is_lost or self._has_gone()
        self.budget.renew([self])
        while not self.is_lost and self.budget.take(self, FRAME_BYTES):
            try:
                received = self._bus.recv(0.0)
                if received is None:
                    self._bound_line()
                    break
                frame = frame_of(received)
            except (can.CanError, OSError):
                self.is_lost = True
                break
            except Exception:  # drivers let pass what their parsers meet in a garbled line
                self._refuse()
                continue
            if frame is not None:
                found.append((0, frame))
        return found

    def send(self, time_ns: int, frame: Frame, sender: int | None = None) -> None:
        """Send a frame, unless it came from there."""
        if sender is None:
            self._put(message(frame, time_ns / 1e9))

    def send_error(self, time_ns: int, error: Error) -> None:
        """Send an error frame to a simulated bus; a real one makes its own."""
        if self._is_simulated:
            self._put(error_message(error, time_ns / 1e9))

    def keep(self, name: str, frames: str) -> None:
        """Hold frames for a bus that is not of this process alone."""
        if self._held is None and not self._is_simulated:
            self._held = hold_bus(name, self.reached_at, self._opened_by, frames)

    def close(self) -> None:
        """Leave the bus."""
        if self._held is not None:
            self._held.release()
        with contextlib.suppress(can.CanError, OSError):
            self._bus.shutdown()

    def _has_gone(self) -> bool:
        """Return whether the adapter is unplugged, or its server gone: nothing may come then."""
        with contextlib.suppress(can.CanError, NotImplementedError, OSError, ValueError):
            waiting = select.poll()
            waiting.register(self._bus.fileno(), 0)
            return bool(waiting.poll(0))
        return False

    def _bound_line(self) -> None:
        """Refuse a line that does not end: python-can's slcan driver would keep it for ever."""
        if isinstance(self._bus, slcanBus) and len(self._bus._buffer) > _LONGEST_LINE:
            self._refuse()

    def _refuse(self) -> None:
        """Count what was no frame, and let a driver forget the rest of it."""
        self.refused += 1
        if isinstance(self._bus, slcanBus):  # it keeps a line that is no text, and all after it
            with contextlib.suppress(can.CanError, OSError):
                self._bus.flush()

    def _put(self, sent: can.Message) -> None:
        with contextlib.suppress(can.CanError, OSError):  # full, or no receiver: it is lost
            self._bus.send(sent, timeout=0)
