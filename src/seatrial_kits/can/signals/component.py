"""CAN node whose messages a DBC describes."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any, ClassVar

from cantools.database.can import Database, Message
from cantools.database.errors import Error

from seatrial.errors import InputError
from seatrial.model.component import NS, Component, Input, Output, Parameter, terminal

from ..frame import Frame
from ..node import CanNode
from ..operations import Transmit
from .database import identifier_of, read_database
from .mapped import Mapped, mapped_signals, message_names

SIGNALS = 16
"""Signals that a node can send, and that it can read."""

_AXES = tuple(f"s{number}" for number in range(1, SIGNALS + 1))
_MS = 1_000_000


class CanSignals(Component):
    """Ports to messages on a bus, and messages to ports, as a DBC file describes them.

    ``sends`` and ``receives`` name signals, ``MESSAGE.SIGNAL`` each, separated by ``;``: the
    first one is the port ``send.s1`` or ``received.s1``, and so on. Ports have SI units and
    radians: the DBC's unit of the signal says what that means (``us`` is s, ``deg`` is rad, ``%``
    is a share of 1). The ports declare none and connect to any. A range after a signal's name,
    ``LOW HIGH UNIT``, is refused if the signal cannot carry it.

    **Sending.** A message goes out at the start of the run + k cycle times (GenMsgCycleTime),
    with the inputs as of the communication point at or before; ``cycle_time`` is for messages
    that have none there; with 0 such a message goes out at the start and whenever its bytes change.
    A value beyond the signal's limits, or what its bits and scaling hold, is limited, and counted
    by ``limited``. A signal of the message that no port has is at its start value
    (GenSigStartValue, or physical 0).

    **Receiving.** A signal keeps its last value. Before the first, and when its message was not
    received for ``lost_after`` of its cycles, it is at its start value and not ``valid``. One
    without a cycle time is never lost. A frame of the wrong length, a remote one, or one with a
    float that is not finite changes nothing; ``frames_refused`` counts them.

    Identifiers of 11 and of 29 bits are taken as they are; CAN FD where the DBC says so. Not here:
    multiplexed messages to send, counters and checksums inside messages, J1939.

    Of a DBC the messages that are named must hold, and nothing else is read. Limits beyond a
    signal's bits are those of its bits, and a unit that is none leaves the DBC's numbers: ``notes``
    says so. Raises InputError at the start, with the file, for a DBC that cannot be read or has
    numbers beyond any bus (`bounds`), messages that are named whose signals overlap or do not fit,
    signals that are not there, and ranges that do not fit.
    """

    feedthrough: ClassVar = {}
    discrete = True
    transient = Component.transient | {"_sends", "_receives", "_sent", "_known", "_notes"}

    database = Parameter("", "1", "the DBC file; in a profile, relative to it", role="file")
    sends = Parameter("", "1", "MESSAGE.SIGNAL [LOW HIGH UNIT] of each signal to send; with ;")
    receives = Parameter("", "1", "MESSAGE.SIGNAL [LOW HIGH UNIT] of each signal to read; with ;")
    cycle_time = Parameter(
        0.0, "s", "of messages to send without one, 0: when a value changes", min=0.0
    )
    lost_after = Parameter(
        3.0, "1", "cycles without a message after which it is lost, 0: never", min=0.0
    )

    rx = Input("1", "operations from the bus", type=str, role="can")
    send = Input("", "values to send, in SI", axes=_AXES, optional=True)

    tx = Output("1", "operations to the bus", type=str, role="can")
    received = Output("", "values that were received, in SI", axes=_AXES)
    valid = Output("1", "whether they were, and are not lost", type=bool, axes=_AXES)
    frames_sent = Output("1", "frames requested", type=int)
    frames_received = Output("1", "frames received that it reads", type=int)
    frames_refused = Output("1", "frames received that are not as the DBC says", type=int)
    limited = Output("1", "values that were beyond their limits", type=int)
    notes = Output("1", "oddities of the DBC's signals that are used; with ;", type=str)

    terminals: ClassVar = {"bus": terminal("tx", "rx")}

    # ------------------------------------------------------------------ running

    def check_parameters(self) -> None:
        """Read the DBC; raises InputError if it does not fit."""
        super().check_parameters()
        self._read_database()

    def start(self, t: float) -> None:
        """Start with nothing sent and nothing received."""
        self._begun_ns = self.now_ns
        self._counts = [0] * len(self._sent)
        self._last = [""] * len(self._sent)
        self._received: dict[str, int] = {}
        self._values = [mapped.start for mapped in self._receives]
        self._frames = [0, 0, 0]
        self._limited = 0
        self._can: dict[str, Any] = {}

    def step(self, t: float, h: float) -> None:
        """Read what was received, and send what is due from ``t`` to before ``t + h``."""
        node = CanNode(self._can)
        for when, operation in node.receive(self.rx):
            if isinstance(operation, Transmit):
                self._receive(when, operation.frame)
        self._lose(self.now_ns + round(h * NS))
        due: list[tuple[int, int, Frame]] = []
        for number in range(len(self._sent)):
            due += self._due(number, self.now_ns + round(h * NS))
        for when, _, frame in sorted(due, key=lambda entry: entry[:2]):
            node.send(when, frame)
        self._frames[0] += len(due)
        node.flush()

    def outputs(self, t: float) -> None:
        """Publish."""
        self.tx = CanNode(self._can).text
        rest = SIGNALS - len(self._values)
        received = (*self._values, *(0.0,) * rest)
        valid = [mapped.message.name in self._received for mapped in self._receives]
        if self.received != received:  # mostly they are the same, and quicker read than set
            self.received = received
        if self.valid[: len(valid)] != tuple(valid):
            self.valid = (*valid, *(False,) * rest)
        self.frames_sent, self.frames_received, self.frames_refused = self._frames
        self.limited = self._limited
        self.notes = self._notes

    def set_state(self, state: Any) -> None:
        """Restore what `get_state` returned."""
        super().set_state(state)
        self._read_database()

    # ------------------------------------------------------------------ the DBC

    def _read_database(self) -> None:
        key = "database"
        try:
            wanted = message_names(self.sends) | message_names(self.receives)
            database = read_database(Path(self.database), wanted) if self.database else Database()
            key = "sends"
            self._sends = self._mapped(database, self.sends)
            key = "receives"
            self._receives = self._mapped(database, self.receives)
        except InputError as error:
            raise InputError(f"{self.name}: {key}: {error}") from None
        self._notes = "; ".join(n for each in (*self._sends, *self._receives) for n in each.notes)
        self._sent = _messages(self._sends)
        self._known = {identifier_of(m): m for m in _messages(self._receives)}
        for message in self._sent:
            where = f"{self.name}: sends: {self.database}: message {message.name}"
            if message.is_multiplexed():
                raise InputError(f"{where} is multiplexed, which can only be received")
            if identifier_of(message) in self._known:
                raise InputError(f"{where} is received too: a message has one sender")

    def _mapped(self, database: Database, written: str) -> list[Mapped]:
        if written.strip() and not self.database:
            raise InputError("there are signals, but no database")
        found = mapped_signals(Path(self.database), database, written)
        if len(found) > SIGNALS:
            raise InputError(f"{len(found)} signals, {SIGNALS} at most")
        return found

    # ------------------------------------------------------------------ sending

    def _due(self, number: int, end_ns: int) -> list[tuple[int, int, Frame]]:
        """Return (time, order, frame) of a message's frames before ``end_ns``."""
        message = self._sent[number]
        cycle_ns = round((message.cycle_time or 0) * _MS) or round(self.cycle_time * NS)
        whens = []
        if cycle_ns:
            while (when := self._begun_ns + self._counts[number] * cycle_ns) < end_ns:
                whens.append(when)
                self._counts[number] += 1
            if not whens:
                return []
        frame, limited = self._frame(message)
        if not cycle_ns and frame.data.hex() != self._last[number]:
            whens = [self.now_ns]
            self._last[number] = frame.data.hex()
        self._limited += limited * len(whens)
        return [(when, number, frame) for when in whens]

    def _frame(self, message: Message) -> tuple[Frame, int]:
        """Return a message with the inputs as they are, and how many were beyond limits."""
        limited = 0
        values = {
            signal.name: 0 if signal.raw_initial is None else signal.raw_initial
            for signal in message.signals
        }
        send = self.send
        for mapped, value in zip(self._sends, send, strict=False):
            if mapped.message is message:
                physical, beyond = mapped.to_physical(value)
                values[mapped.signal.name] = mapped.to_raw(physical)
                limited += beyond
        data = message.encode(values, scaling=False, strict=False)  # they are within the bits
        frame = Frame(message.frame_id, data, message.is_extended_frame, fd=message.is_fd)
        return frame, limited

    # ------------------------------------------------------------------ receiving

    def _receive(self, when: int, frame: Frame) -> None:
        message = self._known.get((frame.identifier, frame.extended))
        if message is None:
            return
        if frame.remote or len(frame.data) != message.length:
            self._frames[2] += 1
            return
        try:
            values: Any = message.decode(frame.data, decode_choices=False)
        except (Error, ValueError):  # a multiplexer value that has no signals
            self._frames[2] += 1
            return
        found = {
            place: mapped.to_si(float(values[mapped.signal.name]))
            for place, mapped in enumerate(self._receives)
            if mapped.message is message and mapped.signal.name in values
        }
        if not all(map(math.isfinite, found.values())):
            self._frames[2] += 1
            return
        self._frames[1] += 1
        self._received[message.name] = when
        for place, value in found.items():
            self._values[place] = value

    def _lose(self, now_ns: int) -> None:
        """Forget messages that have not come for too long."""
        for message in self._known.values():
            cycle_ns = round((message.cycle_time or 0) * _MS)
            last = self._received.get(message.name)
            limit = self.lost_after * cycle_ns
            if not limit or last is None or now_ns - last <= limit:
                continue
            del self._received[message.name]
            for place, mapped in enumerate(self._receives):
                if mapped.message is message:
                    self._values[place] = mapped.start


def _messages(signals: list[Mapped]) -> list[Message]:
    """Return the messages of signals, each once, in their order."""
    return list({mapped.message.name: mapped.message for mapped in signals}.values())
