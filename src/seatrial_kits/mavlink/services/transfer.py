"""Transfer of missions, fences and rally points from and to ground stations."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial

from pymavlink.dialects.v20 import all as mavlink

from ..codec import Message
from ..missions.plan import MOST_ITEMS, Plan, Plans
from ..missions.plan_items import Item, from_message, to_message
from ..service import WARNING, Receiver, Service
from ..transport import Sender, Transport
from ..vehicle import Vehicle

RETRY_S = 1.0
"""Silence after which an item is requested again."""
GIVE_UP_S = 8.0
"""Silence after which an upload is over."""
_PATIENCE = 3
"""Unanswered requests after which a station might be one that knows no integers."""
_OFFER_S = 30.0
_MOST_OFFERS = 32
_CURRENT_ITEM = 1
"""`current` of the item that a vehicle is at; above it, an item belongs to no list."""


@dataclass
class _Upload:
    """A list on its way to the vehicle."""

    sender: Sender
    plan: Plan
    count: int
    progress: float
    """When it last went on, s."""
    requested: float = 0.0
    """When the next item was last requested, s."""
    unanswered: int = 0
    """How often the next item was requested without an answer."""
    knows_integers: bool = False
    """Whether the station has sent a MISSION_ITEM_INT."""
    items: list[Item] = field(default_factory=list)
    rest: tuple[Item, ...] = ()
    """Items of the list after those that are sent, where a part of it is written."""


@dataclass
class _Offer:
    """A list that a station reads: as it was when its length was requested."""

    items: tuple[Item, ...]
    expires: float


class TransferService(Service):
    """MISSION_COUNT, MISSION_REQUEST_LIST, MISSION_CLEAR_ALL and what follows them.

    **Upload.** Items are requested one by one; the list is replaced, and that is acknowledged,
    when all of them are there and good. Until then the vehicle keeps the one it has. An item
    that does not come is requested again every `RETRY_S`; of a station that never answers
    MISSION_REQUEST_INT, by MISSION_REQUEST, whose answer is exact to half a metre only. After
    `GIVE_UP_S` of silence the upload is over, which is reported. An item after the
    requested one is answered by INVALID_SEQUENCE, one before it ignored: its frame was doubled, or
    late. Who repeats the last one missed the acknowledgement, and gets it again. While one station
    uploads a list, others are denied to upload or clear it; each kind of list has its own upload. A
    list is refused with the reason in a status text too; by an ArduPilot at the first bad item.
    A part of a list is written as the whole is, up to one item after the last.

    **Download.** A station that requests a list gets the items of that moment, whatever is uploaded
    meanwhile, until it acknowledges it or requests nothing during 30 s.

    An ArduPilot does not send a list that is being uploaded. Times are those of the link
    (`Vehicle.link_time`).
    """

    capabilities = (
        mavlink.MAV_PROTOCOL_CAPABILITY_MISSION_INT
        | mavlink.MAV_PROTOCOL_CAPABILITY_MISSION_FENCE
        | mavlink.MAV_PROTOCOL_CAPABILITY_MISSION_RALLY
    )

    def __init__(self, vehicle: Vehicle, transport: Transport, plans: Plans) -> None:
        super().__init__(vehicle, transport)
        self._plans = plans
        self._uploads: dict[int, _Upload] = {}
        """By MAV_MISSION_TYPE."""
        self._is_ardupilot = vehicle.dialect.is_ardupilot
        self._ended: tuple[tuple[Sender, int, int], int] | None = None
        self._offers: dict[tuple[Sender, int], _Offer] = {}

    @property
    def receivers(self) -> Mapping[int, Receiver]:
        """Messages that it takes in; link time stands for simulated time in all of them."""
        takers: dict[int, Receiver] = {
            mavlink.MAVLINK_MSG_ID_MISSION_COUNT: self._begin,
            mavlink.MAVLINK_MSG_ID_MISSION_ITEM: self._receive,
            mavlink.MAVLINK_MSG_ID_MISSION_ITEM_INT: self._receive,
            mavlink.MAVLINK_MSG_ID_MISSION_REQUEST_LIST: self._offer,
            mavlink.MAVLINK_MSG_ID_MISSION_REQUEST: partial(self._send_item, integers=False),
            mavlink.MAVLINK_MSG_ID_MISSION_REQUEST_INT: partial(self._send_item, integers=True),
            mavlink.MAVLINK_MSG_ID_MISSION_ACK: self._end,
            mavlink.MAVLINK_MSG_ID_MISSION_CLEAR_ALL: self._clear,
            mavlink.MAVLINK_MSG_ID_MISSION_WRITE_PARTIAL_LIST: self._begin_part,
        }
        return {number: partial(self._in_link_time, taker) for number, taker in takers.items()}

    def _in_link_time(self, taker: Receiver, message: Message, sender: Sender, now: float) -> None:
        taker(message, sender, self.vehicle.link_time(now))

    def tick(self, now: float) -> None:
        """Request again what has not come, and give up in time."""
        now = self.vehicle.link_time(now)
        self._offers = {who: offer for who, offer in self._offers.items() if now < offer.expires}
        for upload in list(self._uploads.values()):
            if now - upload.progress >= GIVE_UP_S:
                del self._uploads[upload.plan.kind]
                self.vehicle.report(
                    WARNING, f"{upload.plan.name}: upload timed out, nothing is changed"
                )
                cancelled = mavlink.MAV_MISSION_OPERATION_CANCELLED
                self._answer(upload.sender, upload.plan.kind, cancelled)
            elif now - upload.requested >= RETRY_S:
                upload.unanswered += 1
                self._request_next(upload, now)

    # ------------------------------------------------------------------ upload

    def _begin(self, message: Message, sender: Sender, now: float) -> None:
        plan = self._plan(message, sender)
        if plan is None or self._is_denied(plan, sender):
            return
        self._uploads.pop(plan.kind, None)
        self._ended = None
        if message.count > MOST_ITEMS:
            self._report_refusal(plan, f"{message.count} items, at most {MOST_ITEMS} fit")
            self._answer(sender, plan.kind, mavlink.MAV_MISSION_NO_SPACE)
        elif message.count == 0:
            self._replace(_Upload(sender, plan, 0, now), [])
        else:
            self._request(_Upload(sender, plan, message.count, now), now)

    def _begin_part(self, message: Message, sender: Sender, now: float) -> None:
        plan = self._plan(message, sender)
        if plan is None:
            return
        first, last, items = message.start_index, message.end_index, plan.items
        if plan.kind in self._uploads:
            self._answer(sender, plan.kind, mavlink.MAV_MISSION_DENIED)
        elif not 0 <= first <= last <= len(items):
            self._report_refusal(plan, f"items {first} to {last} of {len(items)} are no part of it")
            self._answer(sender, plan.kind, mavlink.MAV_MISSION_ERROR)
        else:
            self._ended = None
            before, rest = list(items[:first]), items[last + 1 :]
            self._request(_Upload(sender, plan, last + 1, now, items=before, rest=rest), now)

    def _request(self, upload: _Upload, now: float) -> None:
        """Begin an upload."""
        self._uploads[upload.plan.kind] = upload
        self._request_next(upload, now)

    def _receive(self, message: Message, sender: Sender, now: float) -> None:
        if message.current > _CURRENT_ITEM:
            return  # not of a list: a place to go to in guided mode
        kind, upload = message.mission_type, self._uploads.get(message.mission_type)
        if self._ended and self._ended[0] == (sender, kind, message.seq):
            self._answer(sender, kind, self._ended[1])
        elif upload is None:
            if self._is_ardupilot and self._plans.of_kind(kind) is not None:
                self._answer(sender, kind, mavlink.MAV_MISSION_ERROR)
        elif sender != upload.sender:
            self._answer(sender, kind, mavlink.MAV_MISSION_DENIED)
        elif message.seq > len(upload.items):
            self._answer(sender, kind, mavlink.MAV_MISSION_INVALID_SEQUENCE)
            self._request_next(upload, now)
        elif message.seq == len(upload.items):
            upload.knows_integers |= message.get_type() == "MISSION_ITEM_INT"
            self._take(upload, from_message(message), now)

    def _take(self, upload: _Upload, item: Item, now: float) -> None:
        """Take the item that was requested; a list that is whole, or wrong, is at its end."""
        upload.items.append(item)
        upload.progress, upload.unanswered = now, 0
        wrong = self._is_ardupilot and upload.plan.is_wrong(len(upload.items) - 1, item)
        if len(upload.items) < upload.count and not wrong:
            self._request_next(upload, now)
        else:
            del self._uploads[upload.plan.kind]
            self._replace(upload, [*upload.items, *upload.rest])

    def _request_next(self, upload: _Upload, now: float) -> None:
        upload.requested = now
        patience = 1 if upload.items else _PATIENCE
        request = mavlink.MAVLink_mission_request_int_message
        if upload.unanswered >= patience and not upload.knows_integers:
            request = mavlink.MAVLink_mission_request_message
        target = (upload.sender.system, upload.sender.component)
        message = request(*target, len(upload.items), upload.plan.kind)
        self.transport.send(upload.sender.link, message)

    def _replace(self, upload: _Upload, items: list[Item]) -> None:
        plan, sender = upload.plan, upload.sender
        self._offers.pop((sender, plan.kind), None)  # it asks for what it has sent
        result = self._replaced(plan, items)
        self._ended = ((sender, plan.kind, len(upload.items) - 1), result)
        self._answer(sender, plan.kind, result)

    def _replaced(self, plan: Plan, items: list[Item]) -> int:
        """Replace a list if it is good, else report why not; return MAV_MISSION_RESULT."""
        refusal = plan.replace(items)
        if refusal is None:
            return int(mavlink.MAV_MISSION_ACCEPTED)
        self._report_refusal(plan, refusal.text)
        return refusal.result

    def _clear(self, message: Message, sender: Sender, now: float) -> None:
        plans: Sequence[Plan] = self._plans.all
        if message.mission_type != mavlink.MAV_MISSION_TYPE_ALL:
            plan = self._plan(message, sender)
            if plan is None:
                return
            plans = (plan,)
        if any(self._is_denied(plan, sender) for plan in plans):
            return
        for plan in plans:
            self._uploads.pop(plan.kind, None)
            self._offers.pop((sender, plan.kind), None)
        self._ended = None
        results = [self._replaced(plan, []) for plan in plans]
        self._answer(sender, message.mission_type, max(results))

    def _is_denied(self, plan: Plan, sender: Sender) -> bool:
        """Deny an upload while another station has one going."""
        upload = self._uploads.get(plan.kind)
        if upload is None or upload.sender == sender:
            return False
        self._report_refusal(plan, "another ground station is uploading")
        self._answer(sender, plan.kind, mavlink.MAV_MISSION_DENIED)
        return True

    # ------------------------------------------------------------------ download

    def _offer(self, message: Message, sender: Sender, now: float) -> None:
        plan = self._plan(message, sender)
        if plan is None or self._is_uploading(plan, sender):
            return
        self._offers.pop((sender, plan.kind), None)
        if len(self._offers) >= _MOST_OFFERS:
            del self._offers[next(iter(self._offers))]
        items = plan.as_sent()
        self._offers[sender, plan.kind] = _Offer(items, now + _OFFER_S)
        self._count(plan, sender, len(items))

    def _count(self, plan: Plan, sender: Sender, count: int) -> None:
        target = (sender.system, sender.component)
        message = mavlink.MAVLink_mission_count_message(*target, count, plan.kind)
        self.transport.send(sender.link, message)

    def _is_uploading(self, plan: Plan, sender: Sender) -> bool:
        """Deny to send a list, as an ArduPilot does, while it is uploaded."""
        denied = self._is_ardupilot and plan.kind in self._uploads
        if denied:
            self._answer(sender, plan.kind, mavlink.MAV_MISSION_DENIED)
        return denied

    def _send_item(self, message: Message, sender: Sender, now: float, *, integers: bool) -> None:
        plan = self._plan(message, sender)
        if plan is None or self._is_uploading(plan, sender):
            return
        offer = self._offers.get((sender, plan.kind))
        items = plan.as_sent()
        if offer is not None:
            items, offer.expires = offer.items, now + _OFFER_S
        if message.seq >= len(items):
            if integers and self._is_ardupilot:
                self._count(plan, sender, len(items))
            self._answer(sender, plan.kind, mavlink.MAV_MISSION_INVALID_SEQUENCE)
            return
        self.transport.send(
            sender.link,
            to_message(items[message.seq], plan.kind, message.seq, sender, integers=integers),
        )

    def _end(self, message: Message, sender: Sender, now: float) -> None:
        """Forget what was offered; an error, or a cancellation, ends an upload too."""
        self._offers.pop((sender, message.mission_type), None)
        upload = self._uploads.get(message.mission_type)
        ends = message.type != mavlink.MAV_MISSION_ACCEPTED
        if upload is not None and sender == upload.sender and ends:
            del self._uploads[upload.plan.kind]
            self.vehicle.report(
                WARNING, f"{upload.plan.name}: upload cancelled, nothing is changed"
            )

    # ------------------------------------------------------------------ answers

    def _plan(self, message: Message, sender: Sender) -> Plan | None:
        """Return the list that a message is about; answer if there is none such."""
        plan = self._plans.of_kind(message.mission_type)
        if plan is None:
            self._answer(sender, message.mission_type, mavlink.MAV_MISSION_UNSUPPORTED)
        return plan

    def _answer(self, sender: Sender, kind: int, result: int) -> None:
        target = (sender.system, sender.component)
        self.transport.send(sender.link, mavlink.MAVLink_mission_ack_message(*target, result, kind))

    def _report_refusal(self, plan: Plan, why: str) -> None:
        self.vehicle.report(WARNING, f"{plan.name} refused: {why}")
