"""Transfer of missions, fences and rally points from and to ground stations."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial

from pymavlink.dialects.v20 import all as mavlink

from .codec import Message
from .plan import MOST_ITEMS, Plan, Plans
from .plan_items import Item, from_message, to_message
from .service import WARNING, Receiver, Service
from .transport import Sender, Transport
from .vehicle import Vehicle

RETRY_S = 1.0
"""Silence after which an item is requested again."""
GIVE_UP_S = 10.0
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
    `GIVE_UP_S` of silence the upload is over. Items that were not requested are ignored, but for a
    repeated last one: its sender missed the acknowledgement, and gets it again. While one station
    uploads, others are denied to upload or clear. A list is refused with the reason in a status
    text too.

    **Download.** A station that requests a list gets the items of that moment, whatever is uploaded
    meanwhile, until it acknowledges it or requests nothing during 30 s.

    Lists in part are not supported. Times are those of the link (`Vehicle.link_time`).
    """

    capabilities = (
        mavlink.MAV_PROTOCOL_CAPABILITY_MISSION_INT
        | mavlink.MAV_PROTOCOL_CAPABILITY_MISSION_FENCE
        | mavlink.MAV_PROTOCOL_CAPABILITY_MISSION_RALLY
    )

    def __init__(self, vehicle: Vehicle, transport: Transport, plans: Plans) -> None:
        super().__init__(vehicle, transport)
        self._plans = plans
        self._upload: _Upload | None = None
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
            mavlink.MAVLINK_MSG_ID_MISSION_WRITE_PARTIAL_LIST: self._refuse_part,
            mavlink.MAVLINK_MSG_ID_MISSION_REQUEST_PARTIAL_LIST: self._refuse_part,
        }
        return {number: partial(self._in_link_time, taker) for number, taker in takers.items()}

    def _in_link_time(self, taker: Receiver, message: Message, sender: Sender, now: float) -> None:
        taker(message, sender, self.vehicle.link_time(now))

    def tick(self, now: float) -> None:
        """Request again what has not come, and give up in time."""
        now = self.vehicle.link_time(now)
        self._offers = {who: offer for who, offer in self._offers.items() if now < offer.expires}
        upload = self._upload
        if upload is None:
            return
        if now - upload.progress >= GIVE_UP_S:
            self._upload = None
            self.vehicle.report(
                WARNING, f"{upload.plan.name}: upload timed out, nothing is changed"
            )
            self._answer(upload.sender, upload.plan.kind, mavlink.MAV_MISSION_OPERATION_CANCELLED)
        elif now - upload.requested >= RETRY_S:
            upload.unanswered += 1
            self._request_next(upload, now)

    # ------------------------------------------------------------------ upload

    def _begin(self, message: Message, sender: Sender, now: float) -> None:
        plan = self._plan(message, sender)
        if plan is None or self._is_denied(plan, sender):
            return
        self._upload = self._ended = None
        if message.count > MOST_ITEMS:
            self._report_refusal(plan, f"{message.count} items, at most {MOST_ITEMS} fit")
            self._answer(sender, plan.kind, mavlink.MAV_MISSION_NO_SPACE)
        elif message.count == 0:
            self._replace(plan, [], sender)
        else:
            self._upload = _Upload(sender, plan, message.count, now)
            self._request_next(self._upload, now)

    def _receive(self, message: Message, sender: Sender, now: float) -> None:
        if message.current > _CURRENT_ITEM:
            return  # not of a list: a place to go to in guided mode
        upload = self._upload
        if self._ended and self._ended[0] == (sender, message.mission_type, message.seq):
            self._answer(sender, message.mission_type, self._ended[1])
        if upload is None or (sender, message.mission_type) != (upload.sender, upload.plan.kind):
            return
        if message.seq > len(upload.items):
            self._request_next(upload, now)
        elif message.seq == len(upload.items):
            upload.items.append(from_message(message))
            upload.progress, upload.unanswered = now, 0
            upload.knows_integers |= message.get_type() == "MISSION_ITEM_INT"
            if len(upload.items) < upload.count:
                self._request_next(upload, now)
            else:
                self._upload = None
                self._replace(upload.plan, upload.items, sender)

    def _request_next(self, upload: _Upload, now: float) -> None:
        upload.requested = now
        patience = 1 if upload.items else _PATIENCE
        request = mavlink.MAVLink_mission_request_int_message
        if upload.unanswered >= patience and not upload.knows_integers:
            request = mavlink.MAVLink_mission_request_message
        target = (upload.sender.system, upload.sender.component)
        message = request(*target, len(upload.items), upload.plan.kind)
        self.transport.send(upload.sender.link, message)

    def _replace(self, plan: Plan, items: list[Item], sender: Sender) -> None:
        self._offers.pop((sender, plan.kind), None)  # it asks for what it has sent
        result = self._replaced(plan, items)
        self._ended = ((sender, plan.kind, len(items) - 1), result)
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
        if self._is_denied(plans[0], sender):
            return
        self._upload = self._ended = None
        results = [self._replaced(plan, []) for plan in plans]
        self._answer(sender, message.mission_type, max(results))

    def _is_denied(self, plan: Plan, sender: Sender) -> bool:
        """Deny an upload while another station has one going."""
        if self._upload is None or self._upload.sender == sender:
            return False
        self._report_refusal(plan, "another ground station is uploading")
        self._answer(sender, plan.kind, mavlink.MAV_MISSION_DENIED)
        return True

    # ------------------------------------------------------------------ download

    def _offer(self, message: Message, sender: Sender, now: float) -> None:
        plan = self._plan(message, sender)
        if plan is None:
            return
        self._offers.pop((sender, plan.kind), None)
        if len(self._offers) >= _MOST_OFFERS:
            del self._offers[next(iter(self._offers))]
        items = plan.as_sent()
        self._offers[sender, plan.kind] = _Offer(items, now + _OFFER_S)
        target = (sender.system, sender.component)
        self.transport.send(
            sender.link, mavlink.MAVLink_mission_count_message(*target, len(items), plan.kind)
        )

    def _send_item(self, message: Message, sender: Sender, now: float, *, integers: bool) -> None:
        plan = self._plan(message, sender)
        if plan is None:
            return
        offer = self._offers.get((sender, plan.kind))
        items = plan.as_sent()
        if offer is not None:
            items, offer.expires = offer.items, now + _OFFER_S
        if message.seq >= len(items):
            self._answer(sender, plan.kind, mavlink.MAV_MISSION_INVALID_SEQUENCE)
            return
        self.transport.send(
            sender.link,
            to_message(items[message.seq], plan.kind, message.seq, sender, integers=integers),
        )

    def _end(self, message: Message, sender: Sender, now: float) -> None:
        """Forget what was offered; an error, or a cancellation, ends an upload too."""
        self._offers.pop((sender, message.mission_type), None)
        upload = self._upload
        if (
            upload is not None
            and (sender, message.mission_type) == (upload.sender, upload.plan.kind)
            and message.type != mavlink.MAV_MISSION_ACCEPTED
        ):
            self._upload = None
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

    def _refuse_part(self, message: Message, sender: Sender, now: float) -> None:
        plan = self._plan(message, sender)
        if plan is not None:
            self._report_refusal(plan, "lists in part are not supported, send the whole")
            self._answer(sender, plan.kind, mavlink.MAV_MISSION_UNSUPPORTED)

    def _answer(self, sender: Sender, kind: int, result: int) -> None:
        target = (sender.system, sender.component)
        self.transport.send(sender.link, mavlink.MAVLink_mission_ack_message(*target, result, kind))

    def _report_refusal(self, plan: Plan, why: str) -> None:
        self.vehicle.report(WARNING, f"{plan.name} refused: {why}")
