"""A MAVLink vehicle of a simulation, from a ground station of the test's on the loopback."""

from __future__ import annotations

import contextlib
import socket
from typing import TYPE_CHECKING, Any

from seatrial.testing.waiting import Queue

if TYPE_CHECKING:
    from seatrial.api.simulation import Simulation

_LARGEST = 65535


class Station:
    """A UDP port of this machine to which a vehicle sends: made before the simulation is."""

    def __init__(self) -> None:
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.bind(("127.0.0.1", 0))
        self.socket.setblocking(False)
        self.peer: tuple[str, int] | None = None

    @property
    def url(self) -> str:
        """Where the vehicle sends, as its parameter ``links`` has it."""
        return f"udpout:127.0.0.1:{self.socket.getsockname()[1]}"

    def write(self, data: bytes) -> None:
        """Send a message to the vehicle; pymavlink calls it."""
        if self.peer is None:
            raise AssertionError("the vehicle has not sent anything yet: expect a HEARTBEAT first")
        self.socket.sendto(data, self.peer)


class MavlinkVehicle:
    """What a vehicle sends, and ``mav`` of pymavlink to send to it."""

    def __init__(self, bench: Simulation, station: Station) -> None:
        from pymavlink.dialects.v20 import ardupilotmega

        self.simulation = bench
        self.messages: Queue[Any] = Queue(bench, lambda message: str(message.get_type()))
        self.mav = ardupilotmega.MAVLink(station, srcSystem=255, srcComponent=190)
        """To send with: ``vehicle.mav.command_long_send(...)``."""
        self._station = station
        self._parser = ardupilotmega.MAVLink(None)
        self._parser.robust_parsing = True
        bench.observe(self._listen)

    def expect(self, kind: str, within: float | str = "2 s", **fields: Any) -> Any:
        """Step until a message of a kind comes with these fields; return it.

        Raises AssertionError with what came instead if none does within a simulated time.
        """
        __tracebackhide__ = True

        def wanted(message: Any) -> Any:
            if message.get_type() != kind:
                return None
            is_so = all(getattr(message, name) == value for name, value in fields.items())
            return message if is_so else None

        what = kind + "".join(f", {name}={value!r}" for name, value in fields.items())
        return self.messages.expect(wanted, what, within)

    def _listen(self, _simulation: object) -> None:
        with contextlib.suppress(BlockingIOError):
            while True:
                data, self._station.peer = self._station.socket.recvfrom(_LARGEST)
                self.messages.items += self._parser.parse_buffer(data) or []
