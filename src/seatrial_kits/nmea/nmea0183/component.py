"""NMEA 0183 as a component: readings out, steering commands of chart plotters in."""

from __future__ import annotations

import datetime
import math
from collections.abc import Mapping
from typing import Any
from weakref import WeakKeyDictionary

from seatrial.errors import InputError
from seatrial.links.endpoints.endpoint import Channel, Endpoint, report
from seatrial.links.endpoints.url import open_endpoints, other_end
from seatrial.links.geodesy import Origin
from seatrial.links.parameter_validation import start_us
from seatrial.links.text import Inbox, Outbox
from seatrial.links.unconnected import is_connected
from seatrial.model.component import NS
from seatrial.model.sampled import Sampled

from ..ais.codec import Assembly
from ..ais.reports import report as ais_report
from ..leg import LegStatus, leg_status
from ..received.directions import Variation
from ..received.memory import Received, count, preferred_sources
from ..received.outputs import QUANTITIES
from ..received.publishing import Publisher, position
from ..received.targets import Targets
from ..satellites import sky
from .codec import decode, encode
from .orders import Order, heading_ordered, last_reported, read_order
from .ports import Nmea0183Ports
from .quantities import LATE, READERS, quantities_of
from .readings import Readings
from .schedule import schedule
from .sentences import SENTENCES

_EPOCH = datetime.datetime(1970, 1, 1, tzinfo=datetime.UTC)
SENTENCE_COST = 100
"""Bytes that a sentence takes of its link's budget beside its own: reading one takes some 40 us."""


class Nmea0183(Nmea0183Ports):
    """A talker and a listener on NMEA 0183: over UDP, TCP, serial lines, and as text on ports.

    **Talking.** ``sentences`` are what is sent, as ``GPRMC 1; WIMWV-R 0.5``: talker and
    sentence (`SENTENCES`) and the period in s. Sentence k of one goes out at the first multiple
    of ``period`` that is not before the start of the run + k times its own period, in the order
    of the text, with the readings of that instant; to all ``links`` (`endpoints.url`), and to
    ``tx``, as `links.text` has it. A datagram is one sentence. UTC is ``date`` at the start of
    the run; the wall clock plays no part.

    A reading whose input ``..._valid`` is false, which it is if nothing feeds it, leaves its
    fields empty and has status V, mode N or quality 0. Headings are true: HDG is heading -
    ``variation``. True wind (MWV-T) is the wind over ground, as its direction from the bow; it
    needs the heading.

    **Listening** to all links and ``rx``: HSC, APB and RMB (`read_order`) become the ``target_``
    outputs, which are named after the inputs of guidance: a heading, from HSC or, if there is
    none, APB; or else the waypoint of RMB, whose depth is 0; with ``cruise_speed``. They apply for
    ``order_timeout``, and so do cross-track error, arrival and the waypoint's name, from whichever
    came last. Lines with a wrong checksum or none are refused.

    **Sensors.** Sentences of `quantities.READERS`, and AIS, become the outputs ``received_...``,
    each quantity with whether it is valid (`Received`), of talkers as ``prefer`` has them. Magnetic
    directions become true ones by the variation of their sentence, of other sentences (RMC, HDG),
    ``variation`` if that is not 0, or the World Magnetic Model at the position received or an
    origin that is not 0, 0; ``received_heading_from`` says which. ``received_messages`` counts, by
    formatter, the sentences that had a value, ``received_others`` those that are not read.

    Serial lines have the baud rate of their URL: at 4800, some 480 characters a second pass; what
    does not, waits, and is lost when too much waits. Sentences of an `ais-transponder`, on ``ais``,
    go out as they come. XTE and RMB are of the leg that is followed (``leg``, 0: none). GGA, GSA
    and GSV have the satellites of a nominal GPS constellation. Not here: queries, DSC, tag blocks.

    It cannot be rolled back: what was sent has been sent. Raises InputError at the start for a
    link, date or sentence that cannot be.
    """

    rolls_back = False
    transient = Sampled.transient | {"_endpoints", "_collected", "_schedule", "_received_values"}
    transient |= {"_targets", "_publisher"}

    def __init__(self, name: str = "component") -> None:
        super().__init__(name)
        self._endpoints: list[Endpoint] = []
        self._collected: WeakKeyDictionary[Channel, Lines] = WeakKeyDictionary()

    # ------------------------------------------------------------------ running

    def reset(self, t: float) -> None:
        """Open the links."""
        self.close()
        try:
            self._start_us = start_us(self.date)
            self._endpoints = open_endpoints("links", self.links)
        except InputError as error:
            raise InputError(f"{self.name}: {error}") from None
        self._begun_ns = self.now_ns
        self._schedule = schedule(self.sentences)
        self._counts = [0] * len(self._schedule)
        self._in: dict[str, Any] = {}
        self._ais_in: dict[str, Any] = {}
        self._out: dict[str, Any] = {}
        self._half = ""
        self._sent = self._received = self._refused = 0
        self._orders: dict[str, tuple[int, Order]] = {}
        self._values: dict[str, Any] = {}
        self._stations: dict[str, Any] = {}
        self._ais_parts: dict[str, list[str]] = {}
        self._used: dict[str, list[int]] = {}
        self._unread: dict[str, int] = {}
        self._news: list[str] = []
        self._expires = self.now_ns
        self._distance = 0.0
        self._build()

    def set_state(self, state: Mapping[str, Any]) -> None:
        """Restore what `get_state` returned."""
        super().set_state(state)
        self._build()

    def step(self, t: float, h: float) -> None:
        """Take in what came by the ports, and run the instants of the step."""
        lines = Lines(self._half)
        for _, data in Inbox(self._in).take(self.rx):
            self._read(lines.take(data), self.now_ns)
        self._half = lines.waiting
        for when, sentence in Inbox(self._ais_in).take(self.ais):
            self._send(when, sentence)
        super().step(t, h)
        Outbox(self._out).flush()

    def sample(self, t: float, k: int) -> None:
        """Publish what was ordered until now."""
        orders = self._fresh(round(t * NS))
        heading = heading_ordered(orders)
        place = orders["RMB"].place if "RMB" in orders else None
        self.target_valid = heading is not None or place is not None
        self.target_kind = "position" if heading is None and place is not None else "heading"
        self.target_heading = 0.0 if heading is None else heading
        self.target_position = (0.0, 0.0, 0.0) if place is None else self._position(*place)
        self.target_speed = self.cruise_speed if self.target_valid else 0.0
        reported = last_reported(orders)
        self.cross_track_valid = reported.cross_track is not None
        self.cross_track = reported.cross_track or 0.0
        self.waypoint, self.arrived = reported.waypoint or "", bool(reported.arrived)
        self.reached_at = " ".join(other_end(each.url) for each in self._endpoints)
        report(self, self._endpoints)

    def update(self, t: float, k: int) -> None:
        """Take in what has arrived and publish it, and send what is due."""
        now_ns = round(t * NS)
        if self.water_speed_valid:
            self._distance += self.water_speed * self.period
        for endpoint in self._endpoints:
            for channel, data in endpoint.poll():
                lines = self._collected.setdefault(channel, Lines())
                end = b"\n" if endpoint.url.startswith("udp") else b""
                whole = lines.take(data + end)
                endpoint.budget.charge(channel, len(whole), SENTENCE_COST)
                self._read(whole, now_ns)
        self._publish_received(now_ns)
        readings: Readings | None = None
        for number, each in enumerate(self._schedule):
            if now_ns < self._begun_ns + self._counts[number] * each.period_ns:
                continue
            passed = now_ns - self._begun_ns
            self._counts[number] = passed // each.period_ns + 1
            readings = readings or self._readings(passed)
            for fields in SENTENCES[each.name](readings):
                self._send(now_ns, encode(each.talker, each.name[:3], fields))

    def hold(self, t: float) -> None:
        """Publish what was sent, and the counters."""
        self.tx = Outbox(self._out).text
        self.sentences_sent, self.sentences_received = self._sent, self._received
        self.lines_refused = self._refused

    def close(self) -> None:
        """Close the links."""
        for endpoint in self._endpoints:
            endpoint.close()
        self._endpoints = []

    @property
    def urls(self) -> list[str]:
        """URLs of the links as they are bound: with a port's number where 0 was given."""
        return [endpoint.url for endpoint in self._endpoints]

    # ------------------------------------------------------------------ talking

    def _send(self, now_ns: int, sentence: bytes) -> None:
        self._sent += 1
        Outbox(self._out).put(now_ns, sentence)
        for endpoint in self._endpoints:
            for channel in endpoint.channels():
                channel.send(sentence)

    def _readings(self, passed_ns: int) -> Readings:
        time = _EPOCH + datetime.timedelta(microseconds=self._start_us + passed_ns // 1000)
        there, steered, moved = self.position_valid, self.heading_valid, self.imu_valid
        north, east, _ = self.velocity_n
        place = self._origin.geodetic(self.position_n) if there else None
        leg = self._leg() if there and self.leg > 0 else None
        return Readings(
            time,
            self.variation,
            self.transducer_offset,
            place,
            (north, east) if there else None,
            self.heading if steered else None,
            self.rate_of_turn if moved and is_connected(self.rate_of_turn) else None,
            self.roll_pitch if moved and is_connected(*self.roll_pitch) else None,
            (self.wind_speed, self.wind_angle + math.pi) if self.wind_valid else None,
            self._true_wind() if steered and self.true_wind_valid else None,
            self.water_speed if self.water_speed_valid else None,
            self.depth if self.depth_valid else None,
            self.water_temperature if self.water_temperature_valid else None,
            self._rudder() if self.rudder_valid and is_connected(self.rudder) else None,
            None if place is None else sky(time.timestamp(), *place[:2]),
            leg,
            None if leg is None else (self._waypoint(leg.begin), self._waypoint(leg.end)),
            self._distance if self.water_speed_valid else None,
            tuple(speed if is_connected(speed) else None for speed in self.engine_speed),
        )

    def _leg(self) -> LegStatus:
        """Return where the vessel is on the leg that is followed."""
        ends = self.leg_from, self.leg_to, self.leg_radius
        return leg_status(self.leg, *ends, self.position_n, self.velocity_n)

    def _waypoint(self, place: tuple[float, float]) -> tuple[float, float]:
        latitude, longitude, _ = self._origin.geodetic((*place, 0.0))
        return latitude, longitude

    def _true_wind(self) -> tuple[float, float]:
        """Return its speed, and where it comes from, clockwise from the bow."""
        north, east = self.true_wind
        return math.hypot(north, east), math.atan2(-east, -north) - self.heading

    def _rudder(self) -> float:
        """Return its angle, positive to turn to starboard, as RSA has it."""
        angle: float = self.rudder
        return -angle if self.rudder_positive == "port" else angle

    @property
    def _origin(self) -> Origin:
        return Origin(self.latitude, self.longitude, self.altitude)

    # ------------------------------------------------------------------ listening

    def _read(self, lines: list[bytes], now_ns: int) -> None:
        for line in lines:
            if line.startswith(b"!"):
                self._read_ais(line, now_ns)
                continue
            message = decode(line)
            if message is None:
                self._refused += 1
                continue
            self._received += 1
            self._take(message, now_ns)
            known = self._publisher.variation(now_ns)
            order = read_order(message, self.variation if known is None else known.value)
            if order is not None:
                self._orders.pop(message.msgID, None)  # so that the newest is the last one
                self._orders[message.msgID] = (now_ns, order)

    def _take(self, message: Any, now_ns: int) -> None:
        """Take in the quantities of a sentence."""
        kind = message.msgID
        if kind not in READERS:
            count(self._unread, kind)
            return
        read = quantities_of(message)
        self._count(kind, any(values is not None for values in read.values()))
        late = LATE.get(kind, ())
        received = self._received_values.take(now_ns, message.talker, kind, read, late=late)
        self._news += received

    def _read_ais(self, line: bytes, now_ns: int) -> None:
        """Take in a sentence of AIS; the own ship's (VDO) is no target."""
        found = Assembly(self._ais_parts).take(line)
        if found is None or found[1]:
            return
        station = ais_report(found[0])
        self._count(line[3:6].decode("latin-1"), station is not None)
        if station is not None:
            there = None
            if "latitude" in station:
                there = position(self._origin, station["latitude"], station["longitude"], 0.0)
            self._targets.take(now_ns, station, there)
            self._news.append("ais")

    def _count(self, kind: str, used: bool) -> None:
        counts = self._used.setdefault(kind, [0, 0])
        counts[0] += used
        counts[1] += 1

    def _publish_received(self, now_ns: int) -> None:
        expired = self._expires <= now_ns
        self._publisher.publish(self._received_values.names() if expired else self._news, now_ns)
        if expired or "ais" in self._news:
            self._publisher.publish_targets(now_ns)
        self.received_sources = self._received_values.sources(now_ns)
        used = sorted(self._used.items())
        self.received_messages = "; ".join(f"{kind} {some}/{all_}" for kind, (some, all_) in used)
        unread = sorted(self._unread.items())
        self.received_others = "; ".join(f"{kind} {count}" for kind, count in unread)
        self._news = []
        self._expires = min(self._received_values.expires(now_ns), self._targets.expires(now_ns))

    def _build(self) -> None:
        """Make the views of the state."""
        preferred = preferred_sources(self.prefer, QUANTITIES)
        self._received_values = Received(self._values, round(self.timeout * NS), preferred)
        self._targets = Targets(self._stations)
        self._publisher = Publisher(
            self,
            "received_",
            self._received_values,
            self._targets,
            self._origin,
            self._given_variation,
            lambda: self._start_us / 1e6 / 86400.0,
        )

    def _given_variation(self) -> Variation | None:
        value: float = self.variation
        return Variation(value, "the parameter variation") if value else None

    def _fresh(self, now_ns: int) -> dict[str, Order]:
        oldest = now_ns - round(self.order_timeout * NS)
        return {name: order for name, (when, order) in self._orders.items() if when >= oldest}

    def _position(self, latitude: float, longitude: float) -> tuple[float, float, float]:
        north, east, _ = self._origin.position(latitude, longitude, self.altitude)
        return north, east, 0.0


_LONGEST = 1024
"""Bytes without an end of line after which they are none."""


class Lines:
    """Collects what one sender sends until there is a whole sentence.

    What stands before the ``$`` or ``!`` of a line (half a sentence, a tag block) is dropped.
    """

    def __init__(self, waiting: str = "") -> None:
        self.waiting = waiting
        """What has no end of line yet; text, so that it can be part of a component's state."""

    def take(self, data: bytes) -> list[bytes]:
        """Return the sentences that are whole now, without their ends of line."""
        *whole, self.waiting = (
            (self.waiting + data.decode("latin-1")).replace("\r", "\n").split("\n")
        )
        if len(self.waiting) > _LONGEST:
            self.waiting = ""
        return [found for line in whole if (found := _sentence(line))]


def _sentence(line: str) -> bytes:
    start = max(line.rfind("$"), line.rfind("!"))
    return line[start:].strip().encode("latin-1") if start >= 0 else line.strip().encode("latin-1")
