"""A node of rclpy: topics as bytes, services as the workspace's classes."""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import Any, ClassVar

from seatrial.errors import InputError

from ..messages.definitions import type_store
from ..reach import confined
from ..topics import CLOCK
from ..transport import Durability, Endpoint, Handler, Sample
from .services import RclpyService
from .types import lacks, message_type


class RclpyNode:
    """The node ``node``, over the middleware of RMW_IMPLEMENTATION; a `Transport`.

    Nothing spins: readers and services take from their queues as the link asks. rclpy does not
    tell who wrote a message: of two publishers of one topic the newest message counts.

    Raises InputError for a middleware that does not start.
    """

    of_this_process: ClassVar[Counter[tuple[int, str]]] = Counter()
    """Writers of this process, by domain and topic."""

    def __init__(self, domain: int, node: str) -> None:
        import rclpy
        from rclpy.context import Context
        from rclpy.node import Node

        self.domain, self._context = domain, Context()
        self._written: Counter[tuple[int, str]] = Counter()
        namespace, _, name = node.rpartition("/")
        try:
            middleware = str(rclpy.get_rmw_implementation_identifier())
            self.title = f"rclpy ({middleware})"
            with confined(cyclone="cyclone" in middleware):
                rclpy.init(args=[], context=self._context, domain_id=domain)
                self.node: Any = Node(
                    name,
                    namespace=namespace or None,
                    context=self._context,
                    use_global_arguments=False,
                    enable_rosout=False,
                    start_parameter_services=False,
                )
        except RuntimeError as error:  # RCLError is one
            self._context.try_shutdown()
            raise InputError(f"rclpy cannot join the ROS domain {domain}: {error}") from None

    def lacks(self, kind: str) -> str:
        """Return why the workspace has no such type, empty if it has."""
        return lacks(kind)

    def writer(self, topic: str, kind: str, durability: Durability = "volatile") -> RclpyWriter:
        """Return a writer of messages."""
        self.of_this_process[self.domain, topic] += 1
        self._written[self.domain, topic] += 1
        return RclpyWriter(self.node, topic, kind, durability)

    def reader(self, topic: str, kind: str, depth: int = 10) -> RclpyReader:
        """Return a reliable reader that keeps the newest ``depth`` messages."""
        return RclpyReader(self.node, topic, kind, depth)

    def arrivals(self, readers: Sequence[RclpyReader]) -> Callable[[], bool]:
        """Return what says whether any of the readers has messages that were not taken yet."""
        return lambda: any(reader.look() for reader in readers)

    def service(self, name: str, kind: str, handler: Handler) -> RclpyService:
        """Return a service; ``handler`` answers each call."""
        return RclpyService(self.node, name, kind, handler)

    def announce(self) -> None:
        """Leave it to the middleware, which announces all nodes itself."""

    def endpoints(
        self, read: Iterable[str], written: Iterable[str]
    ) -> tuple[Iterator[Endpoint], Iterator[Endpoint]]:
        """Return all publishers of topics that are read, and subscribers of the written ones."""
        publishers, subscribers = (
            self.node.get_publishers_info_by_topic,
            self.node.get_subscriptions_info_by_topic,
        )
        return (
            (each for topic in {*read, CLOCK} for each in self._found(topic, publishers(topic))),
            (each for topic in written for each in self._found(topic, subscribers(topic))),
        )

    def close(self) -> None:
        """Leave the domain, and take all topics along: others are notified at once."""
        self.of_this_process.subtract(self._written)
        self.node.destroy_node()
        self._context.try_shutdown()

    def _found(self, topic: str, found: Sequence[Any]) -> Iterator[Endpoint]:
        from rclpy.qos import DurabilityPolicy, ReliabilityPolicy

        ours = self.of_this_process[self.domain, topic]
        for count, each in enumerate(found):
            quality = each.qos_profile
            yield Endpoint(
                topic,
                each.topic_type,
                quality.reliability == ReliabilityPolicy.BEST_EFFORT,
                quality.durability == DurabilityPolicy.TRANSIENT_LOCAL,
                count < ours,  # which of them is not told
            )


class RclpyWriter:
    """Writes messages of one kind: a `Writer`."""

    def __init__(self, node: Any, topic: str, kind: str, durability: Durability) -> None:
        self.name, self.kind, self.dropped = topic, kind, 0
        depth = 1 if durability == "latched" else 10
        quality = _quality(durability, depth)
        self._publisher = node.create_publisher(message_type(kind), topic, quality)

    def write(self, data: bytes) -> None:
        """Write a message of the kind, as bytes (`packing`)."""
        try:
            self._publisher.publish(data)
        except RuntimeError:  # RCLError is one
            self.dropped += 1

    @property
    def readers(self) -> int:
        """Number of readers that match."""
        return int(self._publisher.get_subscription_count())


class RclpyReader:
    """Reads one topic: a `Reader`."""

    def __init__(self, node: Any, topic: str, kind: str, depth: int) -> None:
        self._node, self._topic, self._kind = node, topic, kind
        self._type = message_type(kind)
        self._subscription = node.create_subscription(
            self._type, topic, lambda _: None, _quality("volatile", depth), raw=True
        )
        self._come: deque[bytes] = deque(maxlen=depth)

    def look(self) -> bool:
        """Take in what has come; return whether anything waits to be taken."""
        handle = self._subscription.handle
        with handle:
            for _ in range(self._come.maxlen or 1):
                taken = handle.take_message(self._type, True)
                if taken is None:
                    break
                self._come.append(taken[0])
        return bool(self._come)

    def take(self, most: int) -> list[Sample]:
        """Return messages that have come since; nobody tells whose they are."""
        self.look()
        count = min(most, len(self._come))
        return [Sample(self._read(self._come.popleft()), 0) for _ in range(count)]

    @property
    def publishers(self) -> int:
        """Number of publishers of the topic."""
        return int(self._node.count_publishers(self._topic))

    def _read(self, data: bytes) -> Any:
        try:
            return type_store().deserialize_cdr(data, self._kind)
        except Exception:  # whatever rosbags makes of bytes that are no message: counted
            return None


def _quality(durability: Durability, depth: int) -> Any:
    from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

    kept = {"volatile": DurabilityPolicy.VOLATILE, "latched": DurabilityPolicy.TRANSIENT_LOCAL}
    return QoSProfile(
        depth=depth, reliability=ReliabilityPolicy.RELIABLE, durability=kept[durability]
    )
