"""Clock: TIMESYNC and PING, answered in simulated time."""

from __future__ import annotations

from collections.abc import Mapping

from pymavlink.dialects.v20 import all as mavlink

from ..codec import Message
from ..scaling import microseconds
from ..service import Receiver, Service
from ..transport import Sender


class ClockService(Service):
    """Answers TIMESYNC (tc1 = 0) and PING (without a target) over the same link.

    Times are simulated: a run that is faster or slower than real time drifts, and an answer
    waits for the vehicle's next instant.
    """

    @property
    def receivers(self) -> Mapping[int, Receiver]:
        """Messages that it takes in."""
        return {
            mavlink.MAVLINK_MSG_ID_TIMESYNC: self._synchronise,
            mavlink.MAVLINK_MSG_ID_PING: self._ping,
        }

    def _synchronise(self, message: Message, sender: Sender, now: float) -> None:
        if message.tc1 == 0:
            answer = mavlink.MAVLink_timesync_message(round(now * 1e9), message.ts1)
            self.transport.send(sender.link, answer)

    def _ping(self, message: Message, sender: Sender, now: float) -> None:
        if message.target_system == 0 and message.target_component == 0:
            answer = mavlink.MAVLink_ping_message(
                microseconds(now), message.seq, sender.system, sender.component
            )
            self.transport.send(sender.link, answer)
