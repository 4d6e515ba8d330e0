"""VHF channel of AIS between vehicles, with ships of a file."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from seatrial.errors import InputError
from seatrial.links.geodesy import Origin
from seatrial.links.packets.channel import RadioChannel
from seatrial.links.packets.medium import Medium
from seatrial.links.parameter_validation import start_date, start_us
from seatrial.model.component import NS, Component, Parameter

from .codec import to_air
from .reporting import Schedule
from .station import Motion, position_report, static_reports
from .traffic import Moved, Ship, read_traffic

_BITS = 88
"""Bits of a burst beside the message's: ramp-up 8, training 24, flags 16, CRC 16, buffer 24."""
_BIT_RATE = 9600.0
_HORIZON = math.sqrt(2.0 * 4.0 / 3.0 * 6_371_000.0)
"""Distance of the radio horizon over the root of an antenna's height: 4/3 of the earth's radius."""
_NODES = tuple(f"n{number}" for number in range(1, 9))
_STREAM = 1 << 33


class VhfChannel(RadioChannel):
    """The two AIS channels as one, between transponders; see `PacketChannel`.

    A burst takes its message's bits and 88 more at 9600 bit/s: 26.67 ms, a slot, for a position
    report. It reaches stations up to ``range_max``, and not beyond the radio horizon

        4.12 km (sqrt(h_1) + sqrt(h_2))

    of antennas h m above the water, ``mount`` below the body origin (negative: above it). An
    antenna under water neither sends nor receives.

    **Ships** of the file ``traffic`` (`read_traffic`) report as transponders do, to all nodes in
    reach. Their tracks are in {n}, which has its origin at ``latitude`` and
    ``longitude``, as the positions of the nodes.

    Slots are not counted. Who finds the channel busy waits, as carrier sense does and as reserved
    slots have it. Lost are messages of two stations that do not receive each other, as at sea, and
    of two that waited for one burst: some 3 in 100 with fifty ships, at 5 messages a second. Not
    modelled beside what `PacketChannel` leaves out: two channels, power.

    Defaults: 74 km (40 miles; assumed), antennas 4 m above the body origin (assumed).

    Raises InputError at the start for a file that cannot be.
    """

    transient = Component.transient | {"_ships", "_schedules"}

    bit_rate = Parameter(_BIT_RATE, "1/s", "bit rate", min=1e-3)
    overhead = Parameter(_BITS / _BIT_RATE, "s", "time of a burst beside its message", min=0.0)
    packet_size = Parameter(64.0, "1", "most bytes of a message", min=53.0, max=65536.0)
    range_max = Parameter(74_000.0, "m", "greatest distance", min=1e-3)
    mount = Parameter(-4.0, "m", "antenna below the body origin", axes=_NODES)
    traffic = Parameter("", "1", "TOML file with ships and their tracks", role="file")
    latitude = Parameter(0.0, "rad", "of the origin, WGS 84", min=-1.5707964, max=1.5707964)
    longitude = Parameter(0.0, "rad", "of the origin, WGS 84", min=-3.1415927, max=3.1415927)
    date = start_date()

    def start(self, t: float) -> None:
        """Start with nothing on the way, and the ships at their places."""
        super().start(t)
        try:
            self._start_us = start_us(self.date)
            self._begun_ns = self.now_ns
            self._times: list[dict[str, Any]] = []
            self._build()
        except InputError as error:
            raise InputError(f"{self.name}: {error}") from None

    def set_state(self, state: Mapping[str, Any]) -> None:
        """Restore what `get_state` returned."""
        super().set_state(state)
        self._build()

    def others(self) -> int:
        """Return the number of ships."""
        return len(self._ships)

    def other_places(self) -> list[tuple[float, ...]]:
        """Return where the ships' antennas are; nowhere if a ship is not there."""
        found: list[tuple[float, ...]] = []
        for ship in self._ships:
            moved = ship.at(self._passed(self.now_ns))
            place = (math.inf, math.inf) if moved is None else moved[0]
            found.append((*place, -ship.antenna))
        return found

    def send_others(self, medium: Medium, end_ns: int) -> None:
        """Let the ships report what is due."""
        for number, (ship, schedule) in enumerate(zip(self._ships, self._schedules, strict=True)):
            moved = ship.at(self._passed(self.now_ns))
            if moved is None:
                continue
            if not schedule.started:
                schedule.start(self.now_ns)
            schedule.look(self.now_ns, moved[1], moved[2], ship.status)
            node = self._count + number
            while (due := schedule.position_due(end_ns)) is not None:
                moved = ship.at(self._passed(due)) or moved
                report = position_report(ship.identity, self._motion(due, ship, moved))
                medium.put(node, due, to_air(report))
            while (due := schedule.static_due(end_ns)) is not None:
                for report in static_reports(ship.identity):
                    medium.put(node, due, to_air(report))

    def within(self, begin: tuple[float, ...], end: tuple[float, ...]) -> float:
        """Return the distance up to which two antennas reach each other."""
        horizon = _HORIZON * (math.sqrt(max(-begin[2], 0.0)) + math.sqrt(max(-end[2], 0.0)))
        return max(min(float(self.range_max), horizon), 1e-9)

    def _build(self) -> None:
        """Make the views of the state."""
        self._ships = read_traffic(Path(self.traffic)) if self.traffic else []
        if not self._times:
            self._times = [{} for _ in self._ships]
        self._schedules = [
            Schedule(times, ship.identity.equipment, self._drawn(ship))
            for times, ship in zip(self._times, self._ships, strict=True)
        ]

    def _drawn(self, ship: Ship) -> Any:
        stream = _STREAM + ship.identity.mmsi
        return lambda number: float(self.generator(number, stream).random())

    def _passed(self, now_ns: int) -> float:
        return (now_ns - self._begun_ns) / NS

    def _motion(self, now_ns: int, ship: Ship, moved: Moved) -> Motion:
        (north, east), speed, course = moved
        origin = Origin(self.latitude, self.longitude)
        second = (self._start_us + (now_ns - self._begun_ns) // 1000) // 1_000_000 % 60
        place = origin.geodetic((north, east, 0.0))[:2]
        return Motion(second, place, speed, course, course, None, ship.status)
