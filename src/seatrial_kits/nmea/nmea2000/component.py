"""NMEA 2000 node as a component."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any, ClassVar

from seatrial.errors import InputError
from seatrial.links.geodesy import Origin
from seatrial.links.parameter_validation import serial_number, start_us, whole_number
from seatrial.links.text import Inbox
from seatrial.links.unconnected import is_connected
from seatrial.model.component import NS, Component
from seatrial_kits.can.node import CanNode
from seatrial_kits.can.operations import Transmit

from ..ais.codec import Assembly
from ..received.directions import Variation
from ..received.memory import Received, Values, count, preferred_sources
from ..received.outputs import ORDERED, QUANTITIES
from ..received.publishing import Publisher, position
from ..received.targets import Targets
from .address_claim import AddressClaim, Identity, name_of
from .catalogue import ALL, DATA, READABLE, intervals, sends
from .codec import GLOBAL, Decoder, Encoder, Message, header
from .group_functions import serve
from .measurements import messages
from .ports import Nmea2000Ports
from .quantities import LATE, READERS
from .services import HEARTBEAT_S, answer, heartbeat
from .traffic import AIS_PGNS, report, traffic

_SIDS = 253
"""Sequence identifiers run from 0 to 252."""
_NETWORK = (59904, 60928, 126208)
_DAY_S = 86400.0
_ANY_RUDDER = 252
"""Instance of 127245 that names no rudder, as networks of Raymarine have it."""
_INTERVALS = 3
"""Standard intervals of a PGN for which its values are valid at least."""
_STREAMS = 1 << 62
"""Streams of random numbers: that of the delays is the NAME's, so that nodes of one seed differ."""


class Nmea2000(Nmea2000Ports):
    """A node of an NMEA 2000 network: sensor, rudder controller, autopilot or plotter.

    **Address.** It claims ``address`` (`AddressClaim`), and sends data once it has one; it is on
    ``claimed_address``. Its NAME is made of ``uid`` (remainder of 2^21), ``manufacturer_code``,
    ``device_function``, ``device_class`` and instances: of two nodes that want one address the
    lower keeps it. Nodes of one profile have one ``uid``: functions or instances must differ.

    **Sends** the PGNs of ``sends`` at the standard's intervals, or those of ``intervals``, counted
    from the start of the run and exact whatever the communication step; values are those of the
    beginning of the step. What is not connected or not valid goes out as not available, and so
    does a value that its field cannot hold. Messages of one instant have one SID. Engines that are
    not connected send nothing. ``silent`` stops the data.

    **Routes.** ``leg`` ... is what guidance follows; where the vessel is on it goes by the own
    position or, without one, the one received. **Satellites** and dilutions of precision are those
    of a nominal GPS constellation above the position. **AIS**: sentences of an `ais-transponder` on
    ``ais`` go out as their PGNs when they come, if ``sends`` has those.

    **Reads** the PGNs of `catalogue.RECEIVED` from all other nodes: the outputs ``bus_...``, each
    quantity with whether it is valid (`Received`), of sources as ``prefer`` has them. Magnetic
    directions become true ones by the variation of their message, of the network (127258), of the
    input ``variation``, or of the World Magnetic Model at the position received or an origin that
    is not 0, 0; ``bus_heading_from`` says which. ``bus_messages`` counts, by PGN, the messages that
    had a value; ``bus_others`` messages that are not read, and frames of PGNs that are not known.

    **Answers** ISO requests (`services.answer`) and group functions (`group_functions.serve`):
    other nodes may change its intervals, and command fields of 127237 and 127245 if it sends those.
    Of orders to the helm the newest counts (`Received`).

    **Signs.** All headings, courses and the yaw are clockwise from north; roll is positive to
    starboard, pitch bow up, rate of turn to starboard. Rudders are positive to turn to starboard on
    the bus, and to the side of ``rudder_positive`` on the ports. Wind is
    on ports where it blows to, as an anemometer here has it, and on the bus where it comes from.
    Position in {n} from the origin (``latitude``, ``longitude``, ``altitude``). UTC is ``date`` at
    the start of the run.

    **Time.** What ended on the bus by t is received in the step from t, and on the outputs at its
    end; replies begin at t.

    Not here: commanded addresses (65240), ISO transport protocol, alerts, proprietary messages.

    Raises InputError at the start for PGNs, intervals, a serial number or a date that cannot be.
    """

    feedthrough: ClassVar = {}
    discrete = True
    transient = Component.transient | {"_identity", "_claim", "_encoder", "_decoder", "_readings"}
    transient |= {"_targets", "_publisher", "_rudder"}

    # ------------------------------------------------------------------ running

    def start(self, t: float) -> None:
        """Switch it on."""
        try:
            self._sends = sends(self.sends)
            given = {pgn: DATA[pgn].interval_s for pgn in self._sends} | intervals(self.intervals)
            self._name = self._made_identity().name()
            started_us = start_us(self.date)
        except InputError as error:
            raise InputError(f"{self.name}: {error}") from None
        self._intervals = {str(pgn): round(given[pgn] * NS) for pgn in self._sends}
        self._begun_ns = self.now_ns
        self._epoch_ns = started_us * 1000 - self.now_ns
        self._due = dict.fromkeys(self._intervals, self.now_ns)
        self._beats, self._beat_due = 0, -1
        self._sid, self._sid_at = _SIDS - 1, -1
        self._can: dict[str, Any] = {}
        self._claiming: dict[str, Any] = {}
        self._sequences: dict[str, int] = {}
        self._unfinished: dict[str, dict[str, list[list[Any]]]] = {}
        self._values: dict[str, Any] = {}
        self._stations: dict[str, Any] = {}
        self._used: dict[str, list[int]] = {}
        self._unread: dict[str, int] = {}
        self._ais_in: dict[str, Any] = {}
        self._ais_parts: dict[str, list[str]] = {}
        self._sent = self._received = 0
        self._build()
        self._claim.start(self.now_ns)
        self.tx = ""
        self._news: list[str] = []
        self._publish_network()
        self._changes = 0

    def step(self, t: float, h: float) -> None:
        """Read what has come, and send what is due from ``t`` to before ``t + h``."""
        now, end = self.now_ns, self.now_ns + round(h * NS)
        node, queue = CanNode(self._can), []
        frames = node.receive(self.rx)
        for when, operation in frames:
            if isinstance(operation, Transmit):
                source = header(operation.frame)[1]
                self._claim.receive_source(source)
                message = self._decoder.decode(operation.frame)
                if message is None:
                    self._count_unread(header(operation.frame)[0])
                else:
                    self._received += 1
                    queue += [(now, each) for each in self._receive(when, message)]
        queue += self._received_messages(now)
        self._claim.tick(end)
        for when, source in self._claim.take():
            queue.append((max(when, now), Message(60928, self._identity.claim(), source)))
        queue += self._due_messages(end)
        for when, message in sorted(queue, key=lambda entry: entry[0]):
            for frame in self._encoder.encode(message):
                node.send(when, frame)
        self._sent += len(queue)
        self.tx = node.flush()
        # Mostly little is new, and all of it is requested often.
        expired = self._changes <= end
        names = self._readings.names() if expired else dict.fromkeys(self._news)
        self._publisher.publish(names, end)
        if expired or "ais" in names:
            self._publisher.publish_targets(end)
        if frames or expired or queue:
            self._publish_network()
            ends = self._readings.expires(end), self._targets.expires(end)
            self._changes = min(*ends, self._claim.changes_ns)
        self._news = []

    def set_state(self, state: Mapping[str, Any]) -> None:
        """Restore what `get_state` returned."""
        super().set_state(state)
        self._build()

    # ------------------------------------------------------------------ outputs

    def _publish_network(self) -> None:
        """Set the outputs about the node itself."""
        address = self._claim.address
        self.claimed_address = 254 if address is None else address
        self.contests, self.twins = self._claim.contests, self._claim.twins
        self.sent, self.received = self._sent, self._received
        self.bus_sources = self._readings.sources(self.now_ns)
        used = sorted(self._used.items())
        self.bus_messages = "; ".join(f"{pgn} {some}/{all_}" for pgn, (some, all_) in used)
        unread = sorted(self._unread.items())
        self.bus_others = "; ".join(f"{pgn} {count}" for pgn, count in unread)

    # ------------------------------------------------------------------ inside

    def _build(self) -> None:
        """Make the views of the state."""
        self._identity = self._made_identity()
        arbitrary = self._identity.arbitrary_address
        first = whole_number("address", self.address)
        self._claim = AddressClaim(self._claiming, self._name, first, arbitrary, self._delay)
        self._encoder, self._decoder = Encoder(self._sequences), Decoder(self._unfinished)
        self._rudder = whole_number("rudder_instance", self.rudder_instance)
        preferred = preferred_sources(self.prefer, QUANTITIES)
        self._readings = Received(self._values, round(self.timeout * NS), preferred)
        self._targets = Targets(self._stations)
        self._publisher = Publisher(
            self,
            "bus_",
            self._readings,
            self._targets,
            self._origin(),
            self._given_variation,
            lambda: (self._epoch_ns + self.now_ns) / NS / _DAY_S,
        )

    def _delay(self, number: int) -> float:
        return float(self.generator(number, self._name % _STREAMS).random())

    def _receive(self, when: int, message: Message) -> list[Message]:
        """Take in a message; return answers."""
        if message.pgn == 60928:
            self._decoder.forget(message.source)
            self._claim.receive_claim(self.now_ns, message.source, name_of(message.fields))
            return []
        own = self._claim.address
        if message.destination not in (GLOBAL, own):
            return []
        if message.pgn not in _NETWORK:
            self._news += self._take(when, message)
            return []
        if message.pgn == 59904 and message.fields.get("pgn") == 60928:
            self._claim.receive_request(self.now_ns)
            return []
        if own is None:
            return []
        if message.pgn == 59904:
            found = answer(message, self._identity, self._sends, self._beats, self._now)
        else:
            found, due = serve(message, self._sends, self._change, partial(self._obey, when))
            found += [each for pgn in due for each in self._now(pgn)]
        return [self._from(own, each) for each in found]

    def _take(self, when: int, message: Message) -> list[str]:
        """Take in a message about the vessel or other ships; return what it changed."""
        pgn = message.pgn
        if pgn in AIS_PGNS:
            return self._take_ais(when, message)
        if pgn not in READERS:
            self._count_unread(pgn)
            return []
        read = self._read(message)
        self._count(pgn, any(values is not None for values in read.values()))
        least = round(_INTERVALS * READABLE[pgn].interval_s * NS)
        late, kind = LATE.get(pgn, ()), str(pgn)
        if pgn == 127245 and message.fields.get("instance") not in (self._rudder, None):
            late, kind = tuple(read), f"{kind} of any rudder"  # displays repeat those of others
        return self._readings.take(when, str(message.source), kind, read, least, late)

    def _take_ais(self, when: int, message: Message) -> list[str]:
        found = report(message.pgn, message.fields)
        self._count(message.pgn, found is not None)
        if found is None:
            return []
        place = None
        if "latitude" in found and "longitude" in found:
            place = position(self._origin(), found["latitude"], found["longitude"], 0.0)
        self._targets.take(when, found, place)
        return ["ais"]

    def _read(self, message: Message) -> Values:
        """Return what a message says of quantities that are read here."""
        instance = message.fields.get("instance")
        if message.pgn == 127245 and instance not in (self._rudder, None, _ANY_RUDDER):
            return {}
        return READERS[message.pgn](message.fields)

    def _count(self, pgn: int, used: bool) -> None:
        counts = self._used.setdefault(str(pgn), [0, 0])
        counts[0] += used
        counts[1] += 1

    def _count_unread(self, pgn: int) -> None:
        """Count a message that is not read, or a frame of a PGN that is not known."""
        if pgn not in ALL or (pgn in DATA and pgn not in READERS and pgn not in AIS_PGNS):
            count(self._unread, str(pgn))

    def _given_variation(self) -> Variation | None:
        value: float = self.variation
        return Variation(value, "the input variation") if is_connected(value) else None

    def _obey(
        self, when: int, order: Message, wanted: Sequence[str]
    ) -> tuple[list[str], list[str]]:
        read, pgn = self._read(order), order.pgn
        least = round(_INTERVALS * DATA[pgn].interval_s * NS)
        source = str(order.source)
        if self._publisher.variation(self.now_ns) is None:  # a magnetic order has no true sense
            read = {k: None if k in ORDERED and v and v[1] else v for k, v in read.items()}
        changed, held = self._readings.command(when, source, str(pgn), read, wanted, least)
        self._news += changed
        return changed, held

    def _now(self, pgn: int) -> list[Message]:
        return messages(self, pgn, self._next_sid(self.now_ns), self._origin(), self._epoch_ns)

    def _change(self, pgn: int, interval_s: float) -> None:
        self._intervals[str(pgn)] = round(interval_s * NS)
        self._due[str(pgn)] = self.now_ns + round(interval_s * NS)

    def _due_messages(self, end: int) -> list[tuple[int, Message]]:
        """Return what is due before ``end``; what fell due without an address is passed over."""
        own, since = self._claim.address, self._claim.since_ns
        due: list[tuple[int, int]] = []
        for key, interval in self._intervals.items():
            while interval and self._due[key] < end:
                due.append((self._due[key], int(key)))
                self._due[key] += interval
        if own is None:
            return []
        found = []
        if self._beat_due < since:
            self._beat_due = since
        while self._beat_due < end:
            found.append((self._beat_due, heartbeat(self._beats)))
            self._beats += 1
            self._beat_due += round(HEARTBEAT_S * NS)
        origin = self._origin()
        for when, pgn in sorted(due):
            if when >= since and not self.silent:
                sid = self._next_sid(when)
                made = messages(self, pgn, sid, origin, self._epoch_ns)
                found += [(when, each) for each in made]
        return [(when, self._from(own, each)) for when, each in found]

    def _received_messages(self, now: int) -> list[tuple[int, Message]]:
        """Return the PGNs of what the AIS transponder has received; its own ship is no target."""
        assembly, own, found = Assembly(self._ais_parts), self._claim.address, []
        for when, line in Inbox(self._ais_in).take(self.ais):
            received = assembly.take(line)
            made = None if received is None or received[1] else traffic(received[0])
            if made is not None and own is not None and made.pgn in self._sends:
                found.append((max(when, now), self._from(own, made)))
        return [] if self.silent else found

    def _from(self, source: int, made: Message) -> Message:
        return Message(made.pgn, made.fields, source, made.destination, made.items, made.id)

    def _next_sid(self, when: int) -> int:
        if when != self._sid_at:
            self._sid, self._sid_at = (self._sid + 1) % _SIDS, when
        return self._sid

    def _origin(self) -> Origin:
        return Origin(self.latitude, self.longitude, self.altitude)

    def _made_identity(self) -> Identity:
        return Identity(
            uid=serial_number(self.uid),
            manufacturer_code=whole_number("manufacturer_code", self.manufacturer_code),
            device_function=whole_number("device_function", self.device_function),
            device_class=whole_number("device_class", self.device_class),
            device_instance=whole_number("device_instance", self.device_instance),
            system_instance=whole_number("system_instance", self.system_instance),
            arbitrary_address=self.arbitrary_address == "on",
            product_code=whole_number("product_code", self.product_code),
            model=self.model,
            software_version=self.software_version,
            model_version=self.model_version,
            load_equivalency=whole_number("load_equivalency", self.load_equivalency),
            description=self.description,
        )
