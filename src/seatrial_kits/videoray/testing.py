"""A device that speaks VideoRay's Pro 4 protocol, from the topside of the test's."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from seatrial.testing.line import Line
from seatrial.testing.waiting import Queue

from .frame import READ_BIT, ROV, Frame, encode
from .parser import Parser

if TYPE_CHECKING:
    from seatrial.api.simulation import Simulation

_TIMEOUT_NS = 100_000_000


class Pro4:
    """Requests to the device at a serial line, and its responses."""

    def __init__(self, bench: Simulation, name: str) -> None:
        self.line = Line(bench, f"{name}.rx", f"{name}.tx")
        self.responses: Queue[Frame] = Queue(bench, _shown)
        self._parser = Parser(_TIMEOUT_NS)
        self.line.listeners.append(self._take)

    def write(self, address: int, data: bytes, *, answer: int = 0, id: int = ROV) -> None:
        """Write registers from an address on; ask for ``answer`` bytes of a response, now."""
        self.line.send(encode(Frame(False, id, answer, address, data)))

    def read(self, address: int, length: int, *, id: int = ROV) -> None:
        """Ask for ``length`` registers from an address on, now."""
        self.line.send(encode(Frame(False, id, READ_BIT | length, address)))

    def expect(self, within: float | str = "1 s", **fields: Any) -> Frame:
        """Step until a response with these fields of `Frame` comes; return it.

        Raises AssertionError with what came instead if none does within a simulated time.
        """
        __tracebackhide__ = True

        def wanted(frame: Frame) -> Frame | None:
            is_so = all(getattr(frame, name) == value for name, value in fields.items())
            return frame if is_so else None

        what = "a response" + "".join(f", {name}={value!r}" for name, value in fields.items())
        found: Frame = self.responses.expect(wanted, what, within)
        return found

    def _take(self, time_ns: int, data: bytes) -> None:
        self.responses.items += [f for _, f in self._parser.feed(data, time_ns) if f.is_response]


def _shown(frame: Frame) -> str:
    return f"id {frame.id} address 0x{frame.address:X}: {frame.payload.hex(' ')}"
