"""Channels of packets between vehicles: under water by sound, above it by radio."""

from __future__ import annotations

import math
from typing import Any, ClassVar

from ...errors import InputError
from ...model.component import NS, Component, Input, Noise, Output, Parameter, terminal
from ..text import Inbox, Outbox
from .medium import Medium

NODES = 8
"""Most nodes of a channel."""
SPEED_OF_LIGHT = 299_792_458.0
_NODES = tuple(f"n{number}" for number in range(1, NODES + 1))


class _Positions:
    """Positions of the nodes, as inputs position_1 ... position_8; reading gives all of them."""

    def __set_name__(self, owner: type, name: str) -> None:
        self._name = name
        for number in range(1, NODES + 1):
            port = Input(
                "m", f"body origin of node {number}, {{n}}", axes="xyz", frame="n", optional=True
            )
            port.__set_name__(owner, f"{name}_{number}")
            setattr(owner, port.name, port)

    def __get__(self, component: Any, owner: type | None = None) -> Any:
        if component is None:
            return self
        return [getattr(component, f"{self._name}_{n}") for n in range(1, NODES + 1)]


class PacketChannel(Noise, Component):
    """Base of the channels: packets from each node to all others in reach.

    Bytes that a node sends (``tx.n1`` ..., the chunks of a String port) are cut into packets of
    at most ``packet_size`` bytes, wait at their sender, and take

        overhead + 8 bytes / bit_rate

    each. A packet begins to arrive |distance| / speed later, at all nodes up to ``range_max``, and
    its bytes appear on their ``rx`` when its end has arrived. It is lost with probability

        loss + (1 - loss) (distance / range_max)^falloff

    drawn for each receiver. Nodes are half duplex: a node sends when nothing arrives, receives
    nothing while it sends, and packets that overlap where they arrive are lost. Who waits behind
    ``queue_length`` others is dropped. Distances are those at the beginning of a step, between
    the ends of ``mount``, m below each body origin.

    Not modelled: bits that are wrong, acknowledgements, capture of the stronger packet, echoes,
    Doppler shift, motion while a packet travels.
    """

    discrete = True

    nodes = Parameter(2.0, "1", "number of nodes", min=2.0, max=NODES)
    bit_rate = Parameter(1000.0, "1/s", "bit rate", min=1e-3)
    overhead = Parameter(0.0, "s", "time of preamble and header of a packet", min=0.0)
    packet_size = Parameter(64.0, "1", "most bytes of a packet", min=1.0, max=65536.0)
    queue_length = Parameter(100.0, "1", "most packets that wait at a node", min=1.0, max=1e6)
    range_max = Parameter(1000.0, "m", "greatest distance", min=1e-3)
    loss = Parameter(0.0, "1", "probability that a packet is lost nearby", min=0.0, max=1.0)
    falloff = Parameter(8.0, "1", "exponent of the loss over the distance", min=0.1)
    mount = Parameter(0.0, "m", "antenna or transducer below the body origin", axes=_NODES)

    position = _Positions()
    tx = Input(
        "1", "bytes from the nodes, as text", type=str, role="bytes", axes=_NODES, optional=True
    )

    rx = Output("1", "bytes to the nodes, as text", type=str, role="bytes", axes=_NODES)
    queued = Output("1", "packets that wait", type=int, axes=_NODES)
    sent = Output("1", "packets sent", type=int, axes=_NODES)
    received = Output("1", "packets received", type=int, axes=_NODES)
    lost = Output("1", "packets that arrived and were lost", type=int, axes=_NODES)
    dropped = Output("1", "packets that found no place in the queue", type=int, axes=_NODES)

    terminals: ClassVar = {
        **{n: terminal(tx=f"tx.{n}", rx=f"rx.{n}") for n in _NODES},
        **{f"motion_{k}": terminal(position=f"position_{k}") for k in range(1, NODES + 1)},
    }

    def speed(self) -> float:
        """Return the speed of propagation, m/s."""
        raise TypeError(f"{type(self).__name__} does not say how fast packets travel")

    def reaches(self, down: float) -> bool:
        """Return whether an antenna or transducer at this depth, m, is where it works."""
        raise TypeError(f"{type(self).__name__} does not say where it works")

    def within(self, begin: tuple[float, ...], end: tuple[float, ...]) -> float:
        """Return the greatest distance, m, between two antennas or transducers in {n}."""
        return float(self.range_max)

    def others(self) -> int:
        """Return the number of stations that are no nodes: they send, and listen before that."""
        return 0

    def other_places(self) -> list[tuple[float, ...]]:
        """Return the places of their antennas or transducers in {n}, m."""
        return []

    def send_others(self, medium: Medium, end_ns: int) -> None:
        """Put what they send before ``end_ns`` in their queues, which follow those of the nodes."""

    def start(self, t: float) -> None:
        """Start with nothing on the way; raises InputError for numbers that are not whole."""
        for name in ("nodes", "packet_size", "queue_length"):
            if getattr(self, name) % 1.0:
                raise InputError(
                    f"{self.name}.{name} is {getattr(self, name)!r}, a whole number is needed"
                )
        self._count = int(self.nodes)
        self._memory: dict[str, Any] = {}
        self._in: list[dict[str, Any]] = [{} for _ in range(self._count)]
        self._out: list[dict[str, Any]] = [{} for _ in range(self._count)]
        self._sent, self._received, self._lost, self._dropped = ([0] * NODES for _ in range(4))

    def step(self, t: float, h: float) -> None:
        """Take what the nodes send, and deliver what has arrived by the end of the step."""
        medium = Medium(self._memory, self._count + self.others())
        end_ns = self.now_ns + round(h * NS)
        for node in range(self._count):
            self._take(medium, node)
        self.send_others(medium, end_ns)
        at = zip(self.position, self.mount, strict=True)
        places = [(*p[:2], p[2] + m) for p, m in at][: self._count] + self.other_places()

        def path(sender: int, receiver: int, number: int) -> tuple[int, bool] | None:
            return self._path(places[sender], places[receiver], sender, receiver, number)

        for node in medium.send_until(end_ns, self._duration_ns, path):
            if node < self._count:
                self._sent[node] += 1
        for node in range(self._count, self._count + self.others()):
            medium.take_until(end_ns, node)  # nobody reads it
        for node in range(self._count):
            box = Outbox(self._out[node])
            for at_ns, data in medium.take_until(end_ns, node):
                if data is None:
                    self._lost[node] += 1
                else:
                    self._received[node] += 1
                    box.put(at_ns, data)
            box.flush()

    def outputs(self, t: float) -> None:
        """Publish what was received, and the counters."""
        none = [""] * (NODES - self._count)
        self.rx = [*(Outbox(memory).text for memory in self._out), *none]
        medium = Medium(self._memory, self._count + self.others())
        waiting = [medium.waiting(node) for node in range(self._count)]
        self.queued = [*waiting, *[0] * (NODES - self._count)]
        self.sent, self.received = self._sent, self._received
        self.lost, self.dropped = self._lost, self._dropped

    def _take(self, medium: Medium, node: int) -> None:
        """Put the bytes that a node sends in its queue, as packets."""
        size = int(self.packet_size)
        for time_ns, data in Inbox(self._in[node]).take(self.tx[node]):
            for begin in range(0, len(data), size):
                if medium.waiting(node) >= self.queue_length:
                    self._dropped[node] += 1
                else:
                    medium.put(node, max(time_ns, self.now_ns), data[begin : begin + size])

    def _duration_ns(self, count: int) -> int:
        """Return the time that a packet of ``count`` bytes takes, ns."""
        taken: int = round(NS * (self.overhead + 8.0 * count / self.bit_rate))
        return taken

    def _path(
        self,
        begin: tuple[float, ...],
        end: tuple[float, ...],
        sender: int,
        receiver: int,
        number: int,
    ) -> tuple[int, bool] | None:
        away, most = math.dist(begin, end), self.within(begin, end)
        if not (away <= most and self.reaches(begin[2]) and self.reaches(end[2])):
            return None
        taken = round(NS * away / self.speed())
        if receiver >= self._count:
            return taken, False
        share = self.loss + (1.0 - self.loss) * (away / most) ** self.falloff
        drawn = self.generator(number, 1 + NODES * sender + receiver).random()
        return taken, bool(drawn < share)


class AcousticChannel(PacketChannel):
    """Acoustic modems under water; see `PacketChannel`.

    A transducer out of the water neither sends nor receives. Defaults, all assumed: small
    modems of 1 km at 463 bit/s, with 0.2 s of preamble, 8 bytes a packet.
    """

    bit_rate = Parameter(463.0, "1/s", "bit rate", min=1e-3)
    overhead = Parameter(0.2, "s", "time of preamble and header of a packet", min=0.0)
    packet_size = Parameter(8.0, "1", "most bytes of a packet", min=1.0, max=65536.0)
    sound_speed = Parameter(1500.0, "m/s", "mean speed of sound", min=1.0)

    def speed(self) -> float:
        """Return the speed of sound, m/s."""
        return float(self.sound_speed)

    def reaches(self, down: float) -> bool:
        """Return whether a transducer is in the water."""
        return down >= 0.0


class RadioChannel(PacketChannel):
    """Radios above the water; see `PacketChannel`.

    An antenna below the surface neither sends nor receives. Defaults, all assumed: telemetry
    radios of 2 km at 64 kbit/s, 5 ms a packet, 252 bytes; antennas 0.5 m above the body origin.
    """

    bit_rate = Parameter(64000.0, "1/s", "bit rate", min=1e-3)
    overhead = Parameter(0.005, "s", "time of preamble and header of a packet", min=0.0)
    packet_size = Parameter(252.0, "1", "most bytes of a packet", min=1.0, max=65536.0)
    range_max = Parameter(2000.0, "m", "greatest distance", min=1e-3)
    mount = Parameter(-0.5, "m", "antenna or transducer below the body origin", axes=_NODES)

    def speed(self) -> float:
        """Return the speed of light, m/s."""
        return SPEED_OF_LIGHT

    def reaches(self, down: float) -> bool:
        """Return whether an antenna is in the air."""
        return down <= 0.0
