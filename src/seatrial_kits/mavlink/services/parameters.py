"""Parameters: listed, read and set one by one."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Mapping
from dataclasses import dataclass

from pymavlink.dialects.v20 import all as mavlink

from ..codec import Message
from ..parameters.definition import INT8, INT16, INT32, REAL32
from ..parameters.table import ParameterTable
from ..service import WARNING, Service, on_message
from ..transport import Sender, Transport
from ..vehicle import Vehicle

RATE = 100.0
"""Parameters of a list that a link gets per second: 4 kB/s, enough for a slow radio link."""

_LAYOUTS: Mapping[int, str] = {INT8: "<b3x", INT16: "<h2x", INT32: "<i", REAL32: "<f"}
_BY_NAME = -1
_HASH = "_HASH_CHECK"
_UINT32: int = mavlink.MAV_PARAM_TYPE_UINT32
_NO_INDEX = 0xFFFF
_SLACK_S = 1e-9  # what two doubles for one instant may differ by


@dataclass
class _Listing:
    """A list on its way to a link: the next index, how many are left, when the next is due."""

    index: int
    left: int
    due: float


class ParameterService(Service):
    """PARAM_REQUEST_LIST, PARAM_REQUEST_READ and PARAM_SET in; PARAM_VALUE, PARAM_ERROR out.

    **Lists** go to the requesting link, `RATE` parameters a second of link time. A request
    meanwhile lets the list go round once more from where it is, so a station that
    repeats itself, or a second one on the same link, gets all of it. What was lost is read by
    index. Links have lists of their own.

    **Reads** are answered at once, over the same link. **Setting** is answered to all links by
    the new value; where it is refused, to the sender by PARAM_ERROR and, for those that do not
    know it, by the old value, as an ArduPilot does it; a status text gives the reason. An
    unknown name or index gets PARAM_ERROR alone: a station that does not know it gets no other, as
    with other vehicles.

    **Integers** travel as numbers (ArduPilot; rounded, and exact up to 2^24) or as the four
    bytes of their type (PX4, which refuses a value of another type than the parameter's).

    **The hash** of all parameters goes before a PX4's list, as `_HASH_CHECK`: a station that has a
    list with that hash sends it back, and the list ends.

    Not here: the extended protocol.
    """

    def __init__(self, vehicle: Vehicle, transport: Transport, table: ParameterTable) -> None:
        super().__init__(vehicle, transport)
        self.table = table
        self._listings: dict[int, _Listing] = {}
        self._bytewise = vehicle.dialect.bytewise_parameters
        vehicle.capabilities |= (
            mavlink.MAV_PROTOCOL_CAPABILITY_PARAM_ENCODE_BYTEWISE
            if self._bytewise
            else mavlink.MAV_PROTOCOL_CAPABILITY_PARAM_ENCODE_C_CAST
        )

    @on_message(mavlink.MAVLINK_MSG_ID_PARAM_REQUEST_LIST)
    def _begin_list(self, message: Message, sender: Sender, now: float) -> None:
        running = self._listings.get(sender.link)
        begun = self.vehicle.link_time(now)
        index, due = (running.index, running.due) if running else (0, begun)
        self._listings[sender.link] = _Listing(index, len(self.table.names), due)
        if self._bytewise:
            self.transport.send(sender.link, self._hash())

    def tick(self, now: float) -> None:
        """Send what is due of the lists, and forget those of links that are gone."""
        links, now = set(self.transport.links()), self.vehicle.link_time(now)
        self._listings = {k: v for k, v in self._listings.items() if v.left and k in links}
        for link, listing in self._listings.items():
            while listing.left and now >= listing.due - _SLACK_S:
                self.transport.send(link, self._value(self.table.names[listing.index]))
                listing.index = (listing.index + 1) % len(self.table.names)
                listing.left -= 1
                listing.due += 1.0 / RATE

    @on_message(mavlink.MAVLINK_MSG_ID_PARAM_REQUEST_READ)
    def _read(self, message: Message, sender: Sender, now: float) -> None:
        name, index = message.param_id, message.param_index
        if index != _BY_NAME:
            known = 0 <= index < len(self.table.names)
            name = self.table.names[index] if known else ""
        if name in self.table:
            self.transport.send(sender.link, self._value(name))
        elif self._bytewise and name == _HASH:
            self.transport.send(sender.link, self._hash())
        else:
            self._refuse(name, index, mavlink.MAV_PARAM_ERROR_DOES_NOT_EXIST, sender)

    @on_message(mavlink.MAVLINK_MSG_ID_PARAM_SET)
    def _set(self, message: Message, sender: Sender, now: float) -> None:
        name = message.param_id
        if self._bytewise and name == _HASH:
            if _bits(message.param_value) == self._hash_of_all():
                self._listings.pop(sender.link, None)  # it knows all of them
            return
        if name not in self.table:
            self._refuse(name, _BY_NAME, mavlink.MAV_PARAM_ERROR_DOES_NOT_EXIST, sender)
            return
        kind = self.table.kind(name)
        if self._bytewise and message.param_type != kind:
            error, reason = mavlink.MAV_PARAM_ERROR_VALUE_OUT_OF_RANGE, "it is of another type"
        else:
            refusal = self.table.put(name, self._decoded(message.param_value, kind))
            if refusal is None:
                self.vehicle.ordered(f"PARAM_SET {name}", f"{self.table[name]:g}")
                self.transport.broadcast(self._value(name))
                return
            error, reason = refusal.error, refusal.reason
        # The error first: a station that knows it does not take the old value for a lost message.
        self._refuse(name, self.table.index(name), error, sender)
        self.transport.send(sender.link, self._value(name))
        self.vehicle.report(WARNING, f"{name} stays {self.table[name]:g}: {reason}")

    def _refuse(self, name: str, index: int, error: int, sender: Sender) -> None:
        answer = mavlink.MAVLink_param_error_message(
            sender.system, sender.component, _identifier(name), index, error
        )
        self.transport.send(sender.link, answer)

    def _value(self, name: str) -> Message:
        kind = self.table.kind(name)
        return mavlink.MAVLink_param_value_message(
            _identifier(name),
            self._encoded(self.table[name], kind),
            kind,
            len(self.table.names),
            self.table.index(name),
        )

    def _hash(self) -> Message:
        value = struct.unpack("<f", struct.pack("<I", self._hash_of_all()))[0]
        return mavlink.MAVLink_param_value_message(
            _identifier(_HASH), value, _UINT32, len(self.table.names), _NO_INDEX
        )

    def _hash_of_all(self) -> int:
        """Return PX4's CRC-32 of names and values: it begins with 0, and is not inverted."""
        crc = 0xFFFFFFFF
        for name in sorted(self.table.names):
            layout = _LAYOUTS[self.table.kind(name)].replace("3x", "").replace("2x", "")
            value = self.table[name]
            data = struct.pack(layout, value if layout == "<f" else round(value))
            crc = zlib.crc32(name.encode() + data, crc)
        return crc ^ 0xFFFFFFFF

    def _encoded(self, value: float, kind: int) -> float:
        if not self._bytewise or kind == REAL32:
            return value
        packed = struct.pack(_LAYOUTS[kind], round(value))
        return float(struct.unpack("<f", packed)[0])

    def _decoded(self, value: float, kind: int) -> float:
        if not self._bytewise or kind == REAL32:
            return value
        return float(struct.unpack(_LAYOUTS[kind], struct.pack("<f", value))[0])


def _bits(value: float) -> int:
    return int(struct.unpack("<I", struct.pack("<f", value))[0])


def _identifier(name: str) -> bytes:
    return name.encode("ascii", "replace")[:16]
