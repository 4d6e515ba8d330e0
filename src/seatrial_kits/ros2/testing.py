"""A node of the test's own, in the domain of a simulated vehicle."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from seatrial.errors import InputError, unknown
from seatrial.testing.waiting import Queue

from .joining import join
from .messages.packing import packed
from .topics import ACTUATORS, COMMANDED, PUBLISHED
from .transport import Writer

if TYPE_CHECKING:
    from seatrial.api.simulation import Simulation

_DEPTH = 1000


class Ros2Node:
    """Reads and writes the topics of the vehicle whose link is the component ``name``.

    Topics are below the vehicle's name, unless they are absolute; the type of one that the link
    names otherwise is given as ``kind``.
    """

    def __init__(self, bench: Simulation, name: str) -> None:
        domain, _, namespace = bench.get(f"{name}.reached_at").partition("://")[2].partition("/")
        self._bench, self._namespace = bench, f"/{namespace}" if namespace else ""
        self._transport = join(int(domain), "/seatrial_test")
        self._queues: dict[str, Queue[Any]] = {}
        self._writers: dict[str, Writer] = {}

    def listen(self, topic: str, kind: str = "") -> Queue[Any]:
        """Return what arrives on a topic from now on."""
        if topic not in self._queues:
            made = self._transport.reader(self._full(topic), kind or _kind(topic), _DEPTH)
            queue: Queue[Any] = Queue(self._bench, lambda each: type(each).__name__)
            self._queues[topic] = queue

            def take(_: object) -> None:
                queue.items += [each.message for each in made.take(_DEPTH)]

            self._bench.observe(take)
        return self._queues[topic]

    def expect(
        self,
        topic: str,
        within: float | str = "2 s",
        where: Callable[[Any], bool] = lambda _: True,
        kind: str = "",
    ) -> Any:
        """Step until a message comes for which ``where`` holds; return it.

        Raises AssertionError with what came instead if none does within a simulated time.
        """
        __tracebackhide__ = True
        queue = self.listen(topic, kind)
        return queue.expect(lambda each: each if where(each) else None, topic, within)

    def publish(self, topic: str, kind: str = "", **fields: Any) -> None:
        """Write a message; fields that are not given are 0, empty or False."""
        if topic not in self._writers:
            self._writers[topic] = self._transport.writer(self._full(topic), kind or _kind(topic))
        writer = self._writers[topic]
        writer.write(packed(writer.kind, fields))

    def _full(self, topic: str) -> str:
        return topic if topic.startswith("/") else f"{self._namespace}/{topic}"


def _kind(topic: str) -> str:
    kinds = {each.name: each.kind for each in (*PUBLISHED.values(), *COMMANDED.values())}
    way = topic.rpartition("/")[2]
    if topic.startswith("thrusters/") and way in ACTUATORS:
        return ACTUATORS[way].kind
    if topic not in kinds:
        raise InputError(f"{unknown('topic', topic, kinds)}; give its kind")
    return kinds[topic]
