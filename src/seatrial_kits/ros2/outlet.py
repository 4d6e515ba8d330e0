"""Outlet of messages: which are due at an instant, and their writers."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from operator import itemgetter
from typing import Any

from seatrial.model.component import NS

from .bag import Bag
from .description import urdf
from .messages.packing import packed
from .ports import Ros2Ports
from .published import BASE, MEASURED, Fields, Here, leg, measured, odometry, places, transforms
from .surroundings import Traffic
from .topics import LATCHED, PUBLISHED, Names
from .transport import Durability, Transport, Writer

_OVERDUE = 1.5
"""Periods of a sensor after which a measurement that did not change is written again."""


class Outlet:
    """Writers of one vehicle's topics.

    The clock goes out at every instant, the truth every ``truth_period``, a measurement when it
    changes, and `_OVERDUE` periods of its sensor after that: one that is stuck is seen. In an
    instant the clock comes last, and odometry before it: a node that a timer or the odometry
    wakes has been sent all else.
    """

    def __init__(self, transport: Transport, names: Names, say: Callable[[str], None]) -> None:
        self._transport, self._names, self._say = transport, names, say
        self._writers: dict[str, Writer | None] = {}
        self._last: dict[str, tuple[Fields, int]] = {}
        self._truth_ns, self._leg = -(10**18), 0
        self._traffic = Traffic()
        self._measured: dict[str, Callable[[list[Any]], Any]] = {}
        """By key, what takes the inputs of a topic out of all values of the link."""
        self._inputs: dict[str, Any] = {}
        self.bag: Bag | None = None
        """Gets all that is written, if there is one."""
        self._written: list[tuple[Writer, bytes]] = []
        """What the last instant wrote."""

    def open(self, link: Ros2Ports, here: Here) -> None:
        """Make the writers of what the vehicle has, and write what stays as it is.

        Nodes meet them before the first instant is written.
        """
        self._measured = {key: _inputs(link, key) for key in measured(link)}
        for key in ("clock", "tf", "odometry", *self._measured, *(["leg"] if link.leg else [])):
            self._writer(key)
        self.put("tf_static", places(link, here), here.now_ns)
        described = urdf(link.namespace, link.shape, here.prefix + BASE)
        self.put("description", {"data": described}, here.now_ns)

    def write(self, link: Ros2Ports, here: Here) -> None:
        """Write what is due."""
        self._written = []
        for key, fields in self._due(link, here):
            self.put(key, fields, here.now_ns)

    def put(self, key: str, fields: Fields, now_ns: int) -> None:
        """Write one message, if its topic is not off."""
        writer = self._writer(key)
        if writer is not None:
            data = packed(writer.kind, fields)
            writer.write(data)
            self._written.append((writer, data))
            if self.bag is not None:
                self.bag.write(writer.name, writer.kind, data, now_ns)

    def write_again(self) -> None:
        """Write once more what the last instant wrote."""
        for writer, data in self._written:
            writer.write(data)

    @property
    def written(self) -> dict[str, str]:
        """Types of the topics that are written, by name."""
        return {each.name: each.kind for each in self._writers.values() if each is not None}

    @property
    def latched(self) -> frozenset[str]:
        """Names of the topics that are kept for late readers."""
        return frozenset(each.name for key in LATCHED if (each := self._writers.get(key)))

    def matches(self) -> int:
        """Return the number of readers of all topics."""
        made = (each for each in self._writers.values() if each is not None)
        return sum(each.readers for each in made)

    def _due(self, link: Ros2Ports, here: Here) -> Iterator[tuple[str, Fields]]:
        now = here.now_ns
        course = leg(link, here)
        if course is not None and self._leg != link.leg:
            self._leg = link.leg
            yield "leg", course
        for key, inputs_of in self._measured.items():
            inputs = inputs_of(link.values)
            if inputs == self._inputs.get(key) and not self._is_overdue(key, here):
                continue
            self._inputs[key] = inputs
            fields = MEASURED[key].make(link, here)
            if fields is not None and self._is_new(key, fields, here):
                yield key, fields
        yield from self._traffic.messages(link.ais, here)
        if now - self._truth_ns >= round(link.truth_period * NS):
            self._truth_ns = now
            yield "tf", transforms(link, here)
            yield "odometry", odometry(link, here)
        yield "clock", {"clock": now}

    def _is_new(self, key: str, fields: Fields, here: Here) -> bool:
        measured = {name: value for name, value in fields.items() if name != "header"}
        if key in self._last and measured == self._last[key][0] and not self._is_overdue(key, here):
            return False
        self._last[key] = measured, here.now_ns
        return True

    def _is_overdue(self, key: str, here: Here) -> bool:
        at = self._last[key][1] if key in self._last else 0
        return here.now_ns - at >= _OVERDUE * here.instruments.period_ns(key)

    def _writer(self, key: str) -> Writer | None:
        if key not in self._writers:
            self._writers[key] = self._made(key)
        return self._writers[key]

    def _made(self, key: str) -> Writer | None:
        topic = PUBLISHED[key]
        name = self._names.of(key, topic)
        if name is None:
            return None
        if lacking := self._transport.lacks(topic.kind):
            self._say(f"{name} is not written: {lacking}")
            return None
        durability: Durability = "latched" if key in LATCHED else "volatile"
        return self._transport.writer(name, topic.kind, durability)


def _inputs(link: Ros2Ports, key: str) -> Callable[[list[Any]], Any]:
    ports = [link.ports[name] for name in (*MEASURED[key].ports, *MEASURED[key].beside)]
    return itemgetter(*(port.offset + i for port in ports for i in range(port.size)))
