"""All commands that the link receives, and which of them the vehicle follows."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from seatrial.links.unconnected import is_connected

from .ports import Ros2Ports
from .steering import Orders, VelocityOrders, goal_orders, unfollowed, wrench_orders
from .thrusters import Actuator, actuators
from .topics import ACTUATORS, COMMANDED, Names
from .transport import Transport
from .watched import Watched

Values = dict[str, float]


class Commands:
    """Readers of the commands of one vehicle; ``say`` is notified once of what is not followed.

    Actuators come before the pilot: while any of them has a valid command, those without one
    are neutral. To the pilot goes what came last of velocity, wrench and goal; velocity and
    wrench are valid for the link's ``timeout``, a goal until something else comes.
    """

    def __init__(
        self, transport: Transport, link: Ros2Ports, names: Names, say: Callable[[str], None]
    ) -> None:
        self._say, self._link = say, link
        self._said: set[str] = set()
        self._sways, self._dives = link.full_force[1] > 0.0, is_connected(link.depth)
        self._velocity = VelocityOrders(sways=self._sways)
        self.watched: dict[str, Watched] = {}
        wrench = (*link.full_force, link.full_moment)
        for key, topic in COMMANDED.items():
            name = names.of(key, topic)
            if name is not None and (key != "cmd_wrench" or any(wrench)):
                self.watched[key] = Watched(transport, name, topic.kind, link.timeout, say)
        self.actuators = actuators(link)
        for each in self.actuators:
            for way in each.ways:
                full = names.of_actuator(each.name, way)
                if full is not None:
                    kind = ACTUATORS[way].kind
                    key = f"{each.name}.{way}"
                    self.watched[key] = Watched(transport, full, kind, link.timeout, say)
        self.arrived = transport.arrivals([each.reader for each in self.watched.values()])
        """Whether messages have come that were not taken in yet."""

    @property
    def read(self) -> dict[str, str]:
        """Types of the topics that are read, by name."""
        return {each.name: each.kind for each in self.watched.values()}

    @property
    def refused(self) -> int:
        """Messages that were refused, of all topics."""
        return sum(each.refused for each in self.watched.values())

    @property
    def late(self) -> int:
        """Commands that were too old."""
        return sum(each.late for each in self.watched.values())

    def take_newest(self, now: float, now_ns: int, but: Sequence[Watched] = ()) -> None:
        """Take in the newest command of every topic, but of those that lockstep waits for."""
        for each in self.watched.values():
            if each not in but:
                each.take_newest(now, now_ns)

    def direct(self, now: float) -> Values | None:
        """Return the values of all actuators by member; None while none has a valid command."""
        found = {each.member: self._value(each, now) for each in self.actuators}
        if all(value is None for value in found.values()):
            return None
        return {
            each.member: each.neutral if (value := found[each.member]) is None else value
            for each in self.actuators
        }

    def measured(self, heading: float, depth: float) -> None:
        """Take the vehicle's heading, rad, and depth, m, of an instant, for the velocities."""
        self._velocity.measured(heading, depth)

    def orders(self, now: float) -> tuple[str, Orders]:
        """Return what commands the pilot, and its orders; at rest ``none``."""
        link = self._link
        valid = {
            key: self.watched[key]
            for key in COMMANDED
            if key in self.watched
            and (
                self.watched[key].is_valid(now)
                or (key == "goal_pose" and self.watched[key].message)
            )
        }
        key = max(valid, key=lambda each: valid[each].at, default="none")
        if not key.startswith("cmd_vel"):
            self._velocity.stop()
        if key == "none":
            return key, Orders()
        message = valid[key].message
        if key == "goal_pose":
            goal = goal_orders(message, link.frame_prefix)
            if isinstance(goal, Orders):
                return key, goal
            self._once(goal)
            return "none", Orders()
        if key == "cmd_wrench":
            return key, wrench_orders(message.wrench, (*link.full_force, link.full_moment))
        twist = message.twist if key == "cmd_vel_stamped" else message
        for why in unfollowed(twist, sways=self._sways, dives=self._dives):
            self._once(f"{valid[key].name}: {why}")
        return "cmd_vel", self._velocity.orders(twist, link.period)

    def _value(self, actuator: Actuator, now: float) -> float | None:
        ways = [
            (self.watched[key], way)
            for way in actuator.ways
            if (key := f"{actuator.name}.{way}") in self.watched and self.watched[key].is_valid(now)
        ]
        if not ways:
            return None
        watched, way = max(ways, key=lambda each: each[0].at)
        return actuator.value(way, float(watched.message.data))

    def _once(self, what: str) -> None:
        if what not in self._said:
            self._said.add(what)
            self._say(what)
