"""Transfers of one node: out of received frames, and into frames to send."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from dronecan.transport import Transfer

from seatrial.model.component import NS

from ..frame import Frame
from ..node import CanNode
from ..operations import Transmit
from .codec import MOST_FRAMES, frames, transfer_of

TIMEOUT_NS = 2 * NS
"""After so long a transfer ID may come again, and an unfinished transfer is given up."""

HIGH, MEDIUM, LOW = 8, 16, 24
"""Priorities of transfers, the lower the sooner, as ArduPilot's nodes have them."""

Kind = tuple[int, bool]
"""Number of a data type, and whether it is a service."""

_START, _END, _TOGGLE, _ID = 0x80, 0x40, 0x20, 0x1F


class Transfers:
    """A view of a `CanNode` and of ``memory``, a dict that belongs to the component's state.

    Transfers of each data type and source are put together apart. A frame that is there twice,
    out of order or of another transfer is passed over, and with it the transfer; so is a
    transfer whose ID is that of the one before, within 2 s: its last frame was repeated.
    Anonymous transfers have one frame. CAN FD is not supported.

    Source: DroneCAN specification, CAN bus transport layer.
    """

    def __init__(self, memory: dict[str, Any], can: CanNode) -> None:
        self._can = can
        self._memory = memory
        self._sessions: dict[int, list[Any]] = memory.setdefault("sessions", {})
        self._next: dict[int, int] = memory.setdefault("next", {})
        memory.setdefault("malformed", 0)

    @property
    def malformed(self) -> int:
        """Transfers received that could not be understood."""
        count: int = self._memory["malformed"]
        return count

    def receive(
        self, rx: str, wanted: frozenset[Kind], node: int
    ) -> Iterator[tuple[int, Transfer]]:
        """Give what is new on ``rx`` of the kinds wanted: simulated time (ns) and transfer.

        Of services, what goes to ``node``.
        """
        for when, operation in self._can.receive(rx):
            if isinstance(operation, Transmit) and _is_for(node, operation.frame, wanted):
                found = self._take(when, operation.frame)
                if found is not None:
                    yield when, found

    def broadcast(self, time_ns: int, node: int, payload: Any, priority: int) -> None:
        """Send a message at ``time_ns`` as ``node``."""
        transfer = Transfer(payload=payload, source_node_id=node, transfer_priority=priority)
        key = transfer.data_type_id
        transfer.transfer_id = self._next.get(key, 0)
        self._next[key] = (transfer.transfer_id + 1) % 32
        self._send(time_ns, transfer)

    def broadcast_anonymously(self, time_ns: int, payload: Any, discriminator: int) -> None:
        """Send a message of one frame as a node that has no ID yet; 14 bits tell it from others."""
        transfer = Transfer(payload=payload, discriminator=discriminator, transfer_priority=LOW)
        self._send(time_ns, transfer)

    def respond(self, time_ns: int, node: int, request: Transfer, payload: Any) -> None:
        """Answer a request."""
        self._send(
            time_ns,
            Transfer(
                payload=payload,
                source_node_id=node,
                dest_node_id=request.source_node_id,
                transfer_id=request.transfer_id,
                transfer_priority=request.transfer_priority,
                service_not_message=True,
            ),
        )

    def _send(self, time_ns: int, transfer: Transfer) -> None:
        for frame in frames(transfer):
            self._can.send(time_ns, frame)

    def _take(self, when: int, frame: Frame) -> Transfer | None:
        tail = frame.data[-1]
        starts, ends, number = bool(tail & _START), bool(tail & _END), tail & _ID
        if frame.identifier & 0x7F == 0:
            whole = starts and ends and not tail & _TOGGLE
            return self._understood(frame.identifier, [frame.data]) if whole else None
        key = frame.identifier & 0xFFFFFF  # without the priority
        session = self._sessions.get(key)
        if session is not None and when - session[0] > TIMEOUT_NS:
            session = None
        if starts:
            is_again = session is not None and session[1] == number and not session[2]
            if is_again or tail & _TOGGLE:
                return None
            session = self._sessions[key] = [when, number, []]
        elif session is None or not _follows(session, number, bool(tail & _TOGGLE)):
            return None
        session[2].append(frame.data.hex())
        if not ends:
            return None
        datas = [bytes.fromhex(each) for each in session[2]]
        session[0], session[2] = when, []
        return self._understood(frame.identifier, datas)

    def _understood(self, identifier: int, datas: list[bytes]) -> Transfer | None:
        found = transfer_of(identifier, datas)
        if found is None:
            self._memory["malformed"] += 1
        return found


def _follows(session: list[Any], number: int, toggle: bool) -> bool:
    """Return whether a frame with this transfer ID is the next one of a session."""
    known = len(session[2])
    return 0 < known < MOST_FRAMES and session[1] == number and toggle == bool(known % 2)


def _is_for(node: int, frame: Frame, wanted: frozenset[Kind]) -> bool:
    """Return whether a frame is of a kind wanted, and a service's for ``node``."""
    identifier = frame.identifier
    if not frame.extended or not frame.data or frame.fd:
        return False
    if identifier & 0x80:
        if not identifier & 0x7F:  # of nobody, to whom no answer can go
            return False
        return identifier >> 8 & 0x7F == node and (identifier >> 16 & 0xFF, True) in wanted
    if identifier & 0x7F:
        return (identifier >> 8 & 0xFFFF, False) in wanted
    return (identifier >> 8 & 0x3, False) in wanted  # anonymous: the rest is the discriminator
