"""Clock: TIMESYNC and PING, answered in simulated time."""

from __future__ import annotations

from pymavlink.dialects.v20 import all as mavlink

from ..codec import Message
from ..scaling import microseconds
from ..service import Service, on_message
from ..transport import Sender


class ClockService(Service):
    """Answers TIMESYNC (tc1 = 0) and PING (without a target) over the same link.

    Times are simulated: a run that is faster or slower than real time drifts, and an answer
    waits for the vehicle's next instant.
    """

    @on_message(mavlink.MAVLINK_MSG_ID_TIMESYNC)
    def _synchronise(self, message: Message, sender: Sender, now: float) -> None:
        if message.tc1 == 0:
            answer = mavlink.MAVLink_timesync_message(round(now * 1e9), message.ts1)
            self.transport.send(sender.link, answer)

    @on_message(mavlink.MAVLINK_MSG_ID_PING)
    def _ping(self, message: Message, sender: Sender, now: float) -> None:
        if message.target_system == 0 and message.target_component == 0:
            answer = mavlink.MAVLink_ping_message(
                microseconds(now), message.seq, sender.system, sender.component
            )
            self.transport.send(sender.link, answer)
