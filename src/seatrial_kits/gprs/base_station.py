"""The base station of a boat with a modem: it sets marks and receives telemetry."""

from __future__ import annotations

import math
from typing import Any, ClassVar

from seatrial.errors import InputError
from seatrial.links.text import Inbox, Outbox
from seatrial.model.component import NS, Input, Output, Parameter, terminal
from seatrial.model.waypoints import MOST, Waypoints

from . import segments
from .sentences import LONGEST, Mark, Report, decode, encode, read_sides


class BaseStation(Waypoints):
    """A TCP server that a boat's modem connects to; it answers with marks.

    The marks are the waypoints from number ``first`` on, ``radius`` their radius (m), ``sides`` the
    side on which each is left: port, starboard or any, in their order; any where none is said. When
    a boat connects it is sent the whole list, and every ``resend`` again those that its reports do
    not say to be there. A change of ``first`` makes a new list. Positions in {n}, m.

    A connection is accepted if its port is ``port``, and its host ``host`` or that is empty; a new
    one takes the place of the one before. One on which nothing is received for ``silence`` is
    closed. What arrives is acknowledged at the step in which it does. The sentences are those of
    `seatrial_kits.gprs.sentences`; what is no sentence, or damaged, is counted in ``bad``.

    ``position``, ``heading``, ``speed`` and ``passed`` are what the boat reported last, ``age`` how
    long ago (s, -1 while nothing was). ``held`` is how many marks of the list it says it has.

    Raises InputError at the start for a number of waypoints that is not whole.
    """

    discrete = True
    exercised: ClassVar = {"count": 2.0, "waypoint_1": [1.0, 2.0, 0.0], "radius": 4.0}

    host = Parameter("", "1", "name or address that modems call it; empty for any")
    port = Parameter(5000.0, "1", "TCP port", min=1.0, max=65535.0)
    sides = Parameter(
        "", "1", "on which side each mark is left: port, starboard or any", check=read_sides
    )
    resend = Parameter(5.0, "s", "time between two attempts to send what is lacking", min=0.1)
    silence = Parameter(180.0, "s", "without a byte, after which a connection is closed", min=1.0)

    rx = Input("1", "segments from the modem, as text", type=str, role="bytes", optional=True)
    first = Input(
        "1",
        "number of the first waypoint that is sent; 0 for none",
        type=int,
        start=1,
        optional=True,
    )

    tx = Output("1", "segments to the modem, as text", type=str, role="bytes")
    connected = Output("1", "whether a boat is connected", type=bool)
    connections = Output("1", "connections accepted", type=int)
    list_number = Output("1", "number of the list of marks", type=int)
    sent = Output("1", "marks sent, repetitions included", type=int)
    held = Output("1", "marks of the list that the boat says it has", type=int)
    reports = Output("1", "reports received", type=int)
    bad = Output("1", "lines received that were no report", type=int)
    age = Output("s", "since the last report, -1 before it")
    position = Output("m", "position reported", axes=("north", "east"))
    heading = Output("rad", "heading reported, clockwise from north")
    speed = Output("m/s", "speed reported")
    passed = Output("1", "marks that the boat says it has passed", type=int)

    views: ClassVar = {"waypoints": {"count": "count", "place": "waypoint"}}
    terminals: ClassVar = {"network": terminal(up="rx", down="tx")}

    def start(self, t: float) -> None:
        """Wait for a boat; raises InputError for a broken number of waypoints."""
        self._places = self.waypoints()
        self._left_on = read_sides(self.sides)
        if len(self._left_on) > len(self._places):
            raise InputError(
                f"{self.name}.sides has {len(self._left_on)} words, "
                f"there are {len(self._places)} waypoints"
            )
        self._rx: dict[str, Any] = {}
        self._tx: dict[str, Any] = {}
        self._connection, self._line = -1, ""
        self._list, self._first, self._has, self._sent = 0, 0, 0, 0
        self._connections = self._reports = self._bad = self._bytes = 0
        self._received_ns = self._report_ns = -1
        self._next_ns = 0
        self._last: list[int] = []

    def step(self, t: float, h: float) -> None:
        """Take in what has arrived, and send what is lacking."""
        if self.first != self._first:
            self._first, self._list, self._has = self.first, self._list + 1, 0
            self._next_ns = self.now_ns
        for time_ns, data in Inbox(self._rx).take(self.rx):
            self._take(time_ns, segments.decode(data))
        if self._connection >= 0:
            if self.now_ns - self._received_ns > self.silence * NS:
                self._answer(segments.CLOSE)
                self._connection = -1
            elif self.now_ns >= self._next_ns and self._lacking():
                self._send_marks()
        Outbox(self._tx).flush()

    def outputs(self, t: float) -> None:
        """Publish segments, counters and the last report."""
        self.tx = Outbox(self._tx).text
        self.connected, self.connections = self._connection >= 0, self._connections
        self.list_number, self.sent = self._list, self._sent
        self.held = self._has.bit_count()
        self.reports, self.bad = self._reports, self._bad
        self.age = (round(t * NS) - self._report_ns) / NS if self._reports else -1.0
        if self._last:
            north, east, heading, speed, passed = self._last
            self.position = [north / 10.0, east / 10.0]
            self.heading, self.speed = math.radians(heading / 10.0), speed / 100.0
            self.passed = passed

    # ------------------------------------------------------------------ inside

    def _take(self, time_ns: int, segment: segments.Segment) -> None:
        if segment.kind == segments.OPEN:
            self._accept(segment)
        elif segment.connection != self._connection:
            return
        elif segment.kind == segments.CLOSE:
            self._connection = -1
        elif segment.kind == segments.DATA:
            self._received_ns = self.now_ns
            self._bytes += len(segment.data)
            self._answer(segments.ACKNOWLEDGE, self._bytes.to_bytes(4))
            *lines, self._line = (self._line + segment.data.decode("latin-1")).split("\n")
            self._line = self._line[-LONGEST:]
            for line in lines:
                self._read(time_ns, line)

    def _accept(self, segment: segments.Segment) -> None:
        host, _, port = segment.data.decode("latin-1").rpartition(":")
        fits = port == str(int(self.port)) and self.host in ("", host)
        if not fits:
            box, refusal = Outbox(self._tx), segments.Segment(segments.REFUSE, segment.connection)
            box.put(self.now_ns, segments.encode(refusal))
            return
        self._connection, self._line, self._bytes = segment.connection, "", 0
        self._connections += 1
        self._received_ns = self._next_ns = self.now_ns
        self._has = 0  # who has connected may have forgotten them
        self._answer(segments.ACCEPT)

    def _read(self, time_ns: int, line: str) -> None:
        report = decode(line)
        if not isinstance(report, Report):
            self._bad += bool(line.strip())
            return
        self._reports += 1
        self._report_ns = min(time_ns, self.now_ns)
        self._last = [report.north, report.east, report.heading, report.speed, report.passed]
        if report.series == self._list:
            self._has = report.held & ((1 << len(self._marks())) - 1)

    def _marks(self) -> list[Mark]:
        """Return the marks of the list."""
        if not 1 <= self._first <= len(self._places):
            return []
        places = self._places[self._first - 1 :]
        sides = [*self._left_on, *["n"] * MOST][self._first - 1 :]
        return [
            Mark(
                self._list,
                n,
                len(places),
                round(10 * north),
                round(10 * east),
                side,
                round(10 * self.radius),
            )
            for n, ((north, east, _), side) in enumerate(zip(places, sides, strict=False), 1)
        ]

    def _lacking(self) -> list[Mark]:
        return [mark for mark in self._marks() if not self._has >> (mark.number - 1) & 1]

    def _send_marks(self) -> None:
        for mark in self._lacking():
            self._sent += 1
            self._answer(segments.DATA, encode(mark))
        self._next_ns = self.now_ns + round(self.resend * NS)

    def _answer(self, kind: str, data: bytes = b"") -> None:
        segment = segments.Segment(kind, self._connection, data)
        Outbox(self._tx).put(self.now_ns, segments.encode(segment))
