"""AIS transponder as a component."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, ClassVar

from seatrial.errors import InputError
from seatrial.links.geodesy import Origin
from seatrial.links.parameter_validation import start_date, start_us, whole_number
from seatrial.links.text import Inbox, Outbox
from seatrial.links.unconnected import NOT_CONNECTED, is_connected
from seatrial.model.component import NS, Component, Input, Noise, Output, Parameter, terminal

from .codec import VDM, VDO, read, sentences, to_air
from .reporting import Schedule
from .station import (
    EQUIPMENT,
    STATUSES,
    UNDEFINED,
    Fields,
    Identity,
    Motion,
    position_report,
    static_reports,
)

FORGOTTEN_S = 420.0
"""A ship that has not been received for so long is no target: two intervals at rest and more."""
_OWN_S = 1.0
"""Interval of the own report at the presentation interface."""
_NED = ("north", "east", "down")
_STREAMS = 1 << 32
"""Random numbers are those of the MMSI, so that stations of one seed differ."""


class AisTransponder(Noise, Component):
    """Transponder of class A or B: reports its ship, and receives those of others.

    ``tx`` and ``rx`` go to a `VhfChannel`: a chunk is a message's bits. It sends position reports
    (1; class B 18) at the intervals of Rec. ITU-R M.1371 (`reporting`): by speed, of class A by
    changes of course and ``status`` too; static reports (5; class B both parts of 24) every 6
    minutes. The first report goes out within 10 s. Each is sent up to a tenth of its interval
    before or after its time, at random, as slots are taken.

    ``sentences`` is the presentation interface: VDM of what it receives, VDO of its own position
    every second and of what it sends of its own. An `nmea0183` passes them on (``ais``), an
    `nmea2000-node` makes PGNs of them.

    Position and motion are those of its GNSS receiver, here inputs; what is not valid is sent as
    not available. ``silent`` switches the transmitter off.

    **Targets** are stations whose position was received in the last 7 minutes; of the nearest there
    are MMSI and distance, -1 without one, or without an own position.

    Not here: slot reservation (`VhfChannel`), channel management, text and binary messages,
    assigned mode, long-range reports, aids to navigation, the increased intervals of class B in
    crowded waters.

    Raises InputError at the start for an identity or a date that cannot be.
    """

    discrete = True
    transient = Component.transient | {"_identity", "_schedule"}

    equipment = Parameter("A", "1", "class of the transponder", choices=EQUIPMENT)
    mmsi = Parameter("111111111", "1", "number of the station, nine digits")
    ship_name = Parameter("", "1", "name, up to 20 characters")
    callsign = Parameter("", "1", "call sign, up to 7 characters")
    imo = Parameter(0.0, "1", "IMO number, 0: none", min=0.0)
    ship_type = Parameter(0.0, "1", "type of ship: 36 sailing, 70 cargo ...", min=0.0, max=255.0)
    dimensions = Parameter(
        0.0,
        "m",
        "distance of the GNSS antenna from the ship's ends",
        axes=("bow", "stern", "port", "starboard"),
        min=0.0,
    )
    draught = Parameter(0.0, "m", "draught", min=0.0)
    destination = Parameter("", "1", "destination, up to 20 characters")
    latitude = Parameter(0.0, "rad", "of the origin, WGS 84", min=-1.5707964, max=1.5707964)
    longitude = Parameter(0.0, "rad", "of the origin, WGS 84", min=-3.1415927, max=3.1415927)
    altitude = Parameter(0.0, "m", "of the origin")
    date = start_date()

    rx = Input("1", "messages received, as text", type=str, role="bytes", optional=True)
    position_n = Input("m", "position, north-east-down", axes=_NED)
    velocity_n = Input("m/s", "velocity over ground, north-east-down", axes=_NED)
    position_valid = Input("1", "whether position and velocity are valid", type=bool)
    heading = Input("rad", "true heading, clockwise from north", optional=True)
    heading_valid = Input("1", "whether the heading is valid", type=bool, optional=True)
    rate_of_turn = Input(
        "rad/s", "rate of turn, positive to starboard", start=NOT_CONNECTED, optional=True
    )
    imu_valid = Input("1", "whether the rate of turn is valid", type=bool, optional=True)
    status = Input(
        "1",
        "navigational status: 0 under way, 1 at anchor, 5 moored, 8 sailing, 15 undefined",
        type=int,
        optional=True,
    )
    silent = Input("1", "whether the transmitter is off", type=bool, optional=True)

    tx = Output("1", "messages sent, as text", type=str, role="bytes")
    sentences = Output("1", "VDM and VDO, as text", type=str, role="bytes")
    targets = Output("1", "stations received lately", type=int)
    nearest_mmsi = Output("1", "the nearest one's number, -1 without one", type=int, start=-1)
    nearest_distance = Output("m", "distance to it, -1 without one", start=-1.0)
    sent = Output("1", "messages sent", type=int)
    received = Output("1", "messages received", type=int)

    terminals: ClassVar = {
        "sensors": terminal(
            "position_n",
            "velocity_n",
            "position_valid",
            "heading",
            "heading_valid",
            "imu_valid",
            yaw_rate="rate_of_turn",
        ),
        "vhf": terminal("tx", "rx"),
    }

    # ------------------------------------------------------------------ running

    def start(self, t: float) -> None:
        """Switch it on."""
        try:
            self._start_us = start_us(self.date)
            self._build({})
        except InputError as error:
            raise InputError(f"{self.name}: {error}") from None
        self._begun_ns = self._own_ns = self.now_ns
        self._schedule.start(self.now_ns)
        self._in: dict[str, Any] = {}
        self._air: dict[str, Any] = {}
        self._plug: dict[str, Any] = {}
        self._known: dict[str, list[float]] = {}
        self._sent = self._received = self._numbers = 0
        self._publish()

    def step(self, t: float, h: float) -> None:
        """Take in what was received, and send what is due in the next step.

        A step ahead, so that it reaches the channel before it is due: else all of a step would
        begin at once there, and be lost.
        """
        end = self.now_ns + round(h * NS)
        ahead = end + round(h * NS)
        for when, data in Inbox(self._in).take(self.rx):
            self._receive(when, data)
        speed = math.hypot(*self.velocity_n[:2]) if self.position_valid else None
        heading = self.heading if self.heading_valid else None
        self._schedule.look(self.now_ns, speed, heading, self.status)
        while (due := self._schedule.position_due(ahead)) is not None:
            report = position_report(self._identity, self._motion(due))
            if not self.silent:
                self._send(due, end, report)
        while (due := self._schedule.static_due(ahead)) is not None:
            if not self.silent:
                for report in static_reports(self._identity):
                    self._send(due, end, report)
        while self._own_ns < end:
            own = position_report(self._identity, self._motion(self._own_ns))
            self._present(max(self._own_ns, self.now_ns), to_air(own), VDO)
            self._own_ns += round(_OWN_S * NS)
        Outbox(self._air).flush()
        Outbox(self._plug).flush()
        oldest = end / NS - FORGOTTEN_S
        self._known = {name: seen for name, seen in self._known.items() if seen[0] >= oldest}
        self._publish()

    def set_state(self, state: Mapping[str, Any]) -> None:
        """Restore what `get_state` returned."""
        super().set_state(state)
        self._build(self._times)

    # ------------------------------------------------------------------ inside

    def _build(self, times: dict[str, Any]) -> None:
        """Make the views of the state."""
        if not self.mmsi.isdecimal():
            raise InputError(f"mmsi is {self.mmsi!r}, up to nine digits are needed")
        bow, stern, port, starboard = self.dimensions
        self._identity = Identity(
            int(self.mmsi),
            self.equipment,
            self.ship_name,
            self.callsign,
            whole_number("imo", self.imo),
            whole_number("ship_type", self.ship_type),
            bow,
            stern,
            port,
            starboard,
            self.draught,
            self.destination,
        ).checked("")
        self._times = times
        self._schedule = Schedule(times, self.equipment, self._drawn)

    def _drawn(self, number: int) -> float:
        return float(self.generator(number, self._identity.mmsi % _STREAMS).random())

    def _motion(self, now_ns: int) -> Motion:
        passed_s = (self._start_us + (now_ns - self._begun_ns) // 1000) // 1_000_000
        north, east, _ = self.velocity_n
        there = self.position_valid
        status = self.status if self.status in STATUSES else UNDEFINED
        return Motion(
            passed_s % 60,
            self._origin().geodetic(self.position_n)[:2] if there else None,
            math.hypot(north, east) if there else None,
            math.atan2(east, north) if there else None,
            self.heading if self.heading_valid else None,
            self.rate_of_turn if self.imu_valid and is_connected(self.rate_of_turn) else None,
            status,
        )

    def _send(self, due_ns: int, end_ns: int, report: Fields) -> None:
        data = to_air(report)
        Outbox(self._air).put(due_ns, data)
        self._sent += 1
        self._present(min(due_ns, end_ns), data, VDO)

    def _receive(self, when_ns: int, data: bytes) -> None:
        self._received += 1
        found = read(*self._present(when_ns, data, VDM)) or {}
        lat, lon = found.get("lat"), found.get("lon")  # None: the message is shorter than its kind
        if lat is not None and lon is not None and abs(lat) <= 90.0 and abs(lon) <= 180.0:
            north, east, _ = self._origin().position(lat, lon, self.altitude)
            self._known[str(found["mmsi"])] = [when_ns / NS, north, east]

    def _present(self, when_ns: int, data: bytes, kind: str) -> list[bytes]:
        made = sentences(data, kind, self._numbers)
        self._numbers = (self._numbers + (len(made) > 1)) % 10
        for each in made:
            Outbox(self._plug).put(when_ns, each)
        return made

    def _publish(self) -> None:
        self.tx, self.sentences = Outbox(self._air).text, Outbox(self._plug).text
        self.sent, self.received = self._sent, self._received
        self.targets = len(self._known)
        nearest = (-1.0, -1)
        if self.position_valid and self._known:
            nearest = min((self._away(seen), int(name)) for name, seen in self._known.items())
        self.nearest_distance, self.nearest_mmsi = nearest

    def _away(self, seen: list[float]) -> float:
        _, north, east = seen
        return math.hypot(north - self.position_n[0], east - self.position_n[1])

    def _origin(self) -> Origin:
        return Origin(self.latitude, self.longitude, self.altitude)
