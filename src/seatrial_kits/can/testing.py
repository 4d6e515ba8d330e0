"""A simulated CAN bus, from a node of the test's."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from seatrial.errors import InputError
from seatrial.testing.waiting import Queue

from .component import NODES
from .frame import Frame
from .node import CanNode
from .operations import Transmit
from .signals.database import find_signal, identifier_of, read_database

if TYPE_CHECKING:
    from seatrial.api.simulation import Simulation


class Bus:
    """Frames on a `can-bus`; with a DBC file, signals by name."""

    def __init__(self, bench: Simulation, name: str, database: str | Path | None = None) -> None:
        self.simulation, self.name = bench, name
        self.frames: Queue[Frame] = Queue(bench, _shown)
        self._path = None if database is None else Path(database)
        if self._path is not None:
            read_database(self._path, ())  # a mistake is one of the call that names the file
        count = min(len(str(bench.get(f"{name}.nodes")).split()), NODES)
        self._nodes = {number: CanNode({}) for number in range(1, count + 1)}
        self._sender = CanNode({})
        self._listen()
        bench.observe(self._listen)

    def send(self, identifier: int, data: bytes, *, extended: bool | None = None) -> None:
        """Request a frame, now, from a node of the bus that nothing is connected to.

        Identifiers above 0x7FF are extended. Raises InputError if every node is connected.
        """
        if extended is None:
            extended = identifier > 0x7FF
        free = next((n for n in self._nodes if not self._feeder(n)), None)
        if free is None:
            raise InputError(f"{self.name}: every node is connected; give `nodes` one more")
        self._sender.send(round(self.simulation.time * 1e9), Frame(identifier, data, extended))
        self._sender.flush()
        self.simulation.set(f"{self.name}.tx.n{free}", self._sender.text)

    def expect(
        self,
        wanted: int | str,
        within: float | str = "1 s",
        *,
        where: Callable[[Any], object] = lambda _: True,
    ) -> Any:
        """Step until a frame with an identifier, or a signal MESSAGE.SIGNAL of the DBC, comes.

        Returns the frame, or the signal's value in the DBC's unit; ``where`` says which is good
        enough. Raises AssertionError with what came instead, InputError for an unknown signal.
        """
        __tracebackhide__ = True
        read = self._reader(wanted)

        def good(frame: Frame) -> Any:
            value = read(frame)
            return value if value is not None and where(value) else None

        what = f"0x{wanted:X}" if isinstance(wanted, int) else wanted
        return self.frames.expect(good, what, within)

    def _reader(self, wanted: int | str) -> Callable[[Frame], Any]:
        if isinstance(wanted, int):
            return lambda frame: frame if frame.identifier == wanted else None
        if self._path is None:
            raise InputError(f"{self.name}: {wanted!r} needs a DBC: bus(NAME, database=FILE)")
        database = read_database(self._path, {wanted.partition(".")[0]})
        message, signal = find_signal(self._path, database, wanted)
        identifier = identifier_of(message)

        def read(frame: Frame) -> Any:
            if (frame.identifier, frame.extended) != identifier:
                return None
            return message.decode(frame.data, decode_choices=False)[signal.name]  # type: ignore[call-overload]

        return read

    def _feeder(self, number: int) -> str:
        return self.simulation.inputs[f"{self.name}.tx.n{number}"].feeder

    def _listen(self, _simulation: object = None) -> None:
        """Take what all nodes receive: each frame reaches all but its sender, at one time."""
        came: dict[tuple[int, Frame], None] = {}
        for number, node in self._nodes.items():
            for time_ns, operation in node.receive(
                str(self.simulation.get(f"{self.name}.rx.n{number}"))
            ):
                if isinstance(operation, Transmit):
                    came[time_ns, operation.frame] = None
        self.frames.items += [frame for _, frame in sorted(came, key=lambda each: each[0])]


def _shown(frame: Frame) -> str:
    return f"0x{frame.identifier:X} {frame.data.hex(' ')}".rstrip()
