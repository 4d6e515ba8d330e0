"""Player of a recorded bus onto a simulated one."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import Any, ClassVar

from seatrial.errors import InputError
from seatrial.model.component import Input, Output, Parameter, terminal
from seatrial.plugins import offered

from .frame import Frame
from .node import CanNode
from .operations import Confirm
from .playing import Player, Recording
from .recorded import recorded_frames


class CanPlayer(Player):
    """A node that sends the frames of a recording at their times; see `Player`.

    Formats are those of `recorded_frames`: candump, .blf, .asc, .trc, and the text of gateways and
    of canboat for NMEA 2000. ``bus`` takes those of one bus of the recording, ``leave_out`` leaves
    out identifiers, and those of NMEA 2000 by source, ``source:3``: what a simulated node sends in
    the place of the real one. A frame is requested when the recording has it; where the bus is
    busy then, it waits as any other. Frames of CAN FD need a bus whose nodes all take them.
    """

    bus = Parameter("", "1", "name of the bus in the recording; empty: all")
    leave_out = Parameter(
        "", "1", "identifiers as 0x09F11217, and sources as source:3, separated by spaces"
    )

    rx = Input("1", "operations from the bus", type=str, role="can")

    tx = Output("1", "operations to the bus", type=str, role="can")
    confirmed = Output("1", "frames sent", type=int)

    terminals: ClassVar = {"bus": terminal("tx", "rx")}

    def start(self, t: float) -> None:
        """Read the file."""
        self._can: dict[str, Any] = {}
        self._confirmed = 0
        super().start(t)

    def step(self, t: float, h: float) -> None:
        """Send what is due, and count what was sent."""
        received = CanNode(self._can).receive(self.rx)
        self._confirmed += sum(isinstance(operation, Confirm) for _, operation in received)
        super().step(t, h)

    def outputs(self, t: float) -> None:
        """Publish what is sent, and the counts."""
        super().outputs(t)
        self.tx, self.confirmed = CanNode(self._can).text, self._confirmed

    def put(self, time_ns: int, entry: Frame) -> None:
        """Request a frame."""
        CanNode(self._can).send(time_ns, entry)

    def flush(self) -> None:
        """Publish the requests."""
        CanNode(self._can).flush()

    def recording(self, path: Path) -> Recording:
        """Return the frames of a file. Raises InputError for a bus that it does not have."""
        skipped: Counter[str] = Counter()
        identifiers, sources = _left_out(self.leave_out)
        times: list[float | None] = []
        frames, buses = [], set()
        for each in recorded_frames(path, skipped, offered("nmea.is_fast")):
            buses.add(each.bus)
            identifier = each.frame.identifier
            of_source = each.frame.extended and identifier & 0xFF in sources
            if self.bus not in ("", each.bus) or identifier in identifiers or of_source:
                continue
            times.append(each.time)
            frames.append(each.frame)
        if self.bus and self.bus not in buses:
            raise InputError(f"{path}: has no bus {self.bus!r}, but {', '.join(sorted(buses))}")
        known = [time for time in times if time is not None]
        return Recording(known if len(known) == len(times) else None, frames, skipped)


def _left_out(text: str) -> tuple[set[int], set[int]]:
    """Return identifiers and sources. Raises InputError for a word that is neither."""
    identifiers, sources = set[int](), set[int]()
    for word in text.split():
        of_source = word.startswith("source:")
        try:
            number = int(word.removeprefix("source:"), 0)
        except ValueError:
            raise InputError(
                f"leave_out: {word!r} is neither an identifier, such as 0x09F11217, nor a source, "
                "such as source:3"
            ) from None
        (sources if of_source else identifiers).add(number)
    return identifiers, sources
