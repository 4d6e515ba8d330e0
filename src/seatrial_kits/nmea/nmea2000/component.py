"""NMEA 2000 node as a component."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import lru_cache, partial
from typing import Any, ClassVar

from seatrial.errors import InputError
from seatrial.links.geodesy import Ned, Origin
from seatrial.links.parameter_validation import serial_number, start_us, whole_number
from seatrial.links.text import Inbox
from seatrial.model.component import NS, Component
from seatrial_kits.can.node import CanNode
from seatrial_kits.can.operations import Transmit

from ..ais.codec import Assembly
from .address_claim import AddressClaim
from .catalogue import DATA, intervals, sends
from .codec import GLOBAL, Decoder, Encoder, Message, header
from .group_functions import serve
from .measurements import messages
from .name import Identity, name_of
from .ports import ENGINES, Nmea2000Ports
from .received import Received
from .services import HEARTBEAT_S, answer, heartbeat
from .traffic import traffic

_SIDS = 253
"""Sequence identifiers run from 0 to 252."""
_NETWORK = (59904, 60928, 126208)
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

    **Reads** the PGNs of `catalogue.RECEIVED` from all other nodes: the outputs ``bus_...``, with
    whether they are valid (`Received`). A magnetic heading is, if its message has the variation.

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
        for when, operation in node.receive(self.rx):
            if isinstance(operation, Transmit):
                source = header(operation.frame)[1]
                self._claim.receive_source(source)
                message = self._decoder.decode(operation.frame)
                if message is not None:
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
        for name in names:
            self._publish(name, end)
        if names or expired or queue:
            self._publish_network()
            self._changes = min(self._readings.expires(end), self._claim.changes_ns)
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

    def _publish(self, name: str, now: int) -> None:
        """Set the outputs of a quantity to what is valid at ``now``."""
        values, valid = self._readings.get(name, now)
        assert values is not None
        if name in _PUBLISHED:
            turned = name in _RUDDERS and self.rudder_positive == "port"
            setattr(self, f"bus_{name}", -values[0] if turned else values[0])
            setattr(self, f"bus_{name}_valid", valid)
        elif name in ("place", "altitude"):
            self._publish_position(now)
        elif name == "velocity":
            self.bus_velocity_n, self.bus_velocity_valid = (*values, 0.0), valid
        elif name == "wind":
            self.bus_wind_speed, self.bus_wind_angle = values
            self.bus_wind_valid = valid
        elif name == "attitude":
            self.bus_attitude, self.bus_attitude_valid = values, valid
        elif name == "steering_mode":
            self.bus_steering_mode = int(values[0]) if valid else -1
        elif name == "rudder_direction":
            self.bus_rudder_direction = int(values[0]) if valid else 0
        else:
            self._publish_engines(now)

    def _publish_position(self, now: int) -> None:
        place, self.bus_position_valid = self._readings.get("place", now)
        altitude, _ = self._readings.get("altitude", now)
        if place is not None:
            height = self.altitude if altitude is None else altitude[0]
            self.bus_position_n = _position(self._origin(), place[0], place[1], height)

    def _publish_engines(self, now: int) -> None:
        engines = [self._readings.get(f"engine {number}", now) for number in range(ENGINES)]
        self.bus_engine_speed = [
            values[0] if values is not None and valid else 0.0 for values, valid in engines
        ]

    # ------------------------------------------------------------------ inside

    def _build(self) -> None:
        """Make the views of the state."""
        self._identity = self._made_identity()
        arbitrary = self._identity.arbitrary_address
        first = whole_number("address", self.address)
        self._claim = AddressClaim(self._claiming, self._name, first, arbitrary, self._delay)
        self._encoder, self._decoder = Encoder(self._sequences), Decoder(self._unfinished)
        rudder = whole_number("rudder_instance", self.rudder_instance)
        self._readings = Received(self._values, round(self.timeout * NS), rudder)

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
            self._news += self._readings.take(when, message)
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

    def _obey(
        self, when: int, order: Message, wanted: Sequence[str]
    ) -> tuple[list[str], list[str]]:
        changed, held = self._readings.command(when, order, wanted)
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


_PUBLISHED = (
    "heading",
    "rate_of_turn",
    "rudder",
    "rudder_order",
    "water_speed",
    "depth",
    "heading_to_steer",
    "track",
    "commanded_rudder",
)
"""Quantities of one value that go to outputs of their name."""
_RUDDERS = ("rudder", "rudder_order", "commanded_rudder")
"""Those with the sign of rudders."""


@lru_cache(64)  # nodes of one profile have one origin
def _position(origin: Origin, latitude: float, longitude: float, altitude: float) -> Ned:
    return origin.position(latitude, longitude, altitude)
