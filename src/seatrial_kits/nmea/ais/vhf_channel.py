"""VHF channel of AIS between vehicles, with ships of a file."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from seatrial.errors import InputError, unknown
from seatrial.files.reading import toml_content
from seatrial.links.geodesy import Origin
from seatrial.links.packets.channel import RadioChannel
from seatrial.links.packets.medium import Medium
from seatrial.links.parameter_validation import start_date, start_us
from seatrial.model.component import NS, Component, Parameter
from seatrial.model.units import quantity

from .codec import to_air
from .reporting import Schedule
from .station import STATUSES, UNDEFINED, Identity, Motion, position_report, static_reports

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


_TEXTS = ("equipment", "name", "callsign", "destination")
_NUMBERS = ("imo", "ship_type", "status")
_LENGTHS = ("length", "beam", "draught", "antenna")
_KEYS = ("mmsi", "track", *_TEXTS, *_NUMBERS, *_LENGTHS)
_POINT = (("time", "s"), ("north", "m"), ("east", "m"))
MOST_SHIPS, _MOST_POINTS = 200, 10_000
_ANTENNA_M = 10.0

Moved = tuple[tuple[float, float], float, float | None]
"""North and east, m; speed, m/s; course, rad, None for a ship that lies still."""


@dataclass(frozen=True)
class Ship:
    """A ship on a track, which it follows from point to point, straight and at constant speed.

    It is there from the time of the first point to that of the last.
    """

    identity: Identity
    track: tuple[tuple[float, float, float], ...]
    """Time, s; north and east of the origin, m."""
    status: int = UNDEFINED
    antenna: float = _ANTENNA_M
    """Above the water, m."""

    def at(self, time: float) -> Moved | None:
        """Return where it is and how it moves; None before its track and after."""
        last, now = self.track[-1][0], round(time, 9)
        if not self.track[0][0] <= now <= last:
            return None
        legs = list(zip(self.track, self.track[1:], strict=False))
        (t0, n0, e0), (t1, n1, e1) = next(leg for leg in legs if now < leg[1][0] or leg is legs[-1])
        share, duration = (now - t0) / (t1 - t0), t1 - t0
        north, east = n1 - n0, e1 - e0
        course = math.atan2(east, north) if north or east else None
        speed = math.hypot(north, east) / duration
        return (n0 + share * north, e0 + share * east), speed, course


def read_traffic(path: Path) -> list[Ship]:
    """Return the ships of a TOML file, tables ``[[ships]]``.

    Raises InputError, with file, ship and key, for what cannot be.
    """
    try:
        content = toml_content(path.read_bytes(), str(path))
    except OSError as error:
        raise InputError(f"{path}: {error.strerror or error}") from None
    _known(f"{path}", content, ("ships",))
    listed = content.get("ships")
    if not isinstance(listed, list) or not all(isinstance(each, dict) for each in listed):
        raise InputError(f"{path}: tables [[ships]] are needed")
    if len(listed) > MOST_SHIPS:
        raise InputError(f"{path}: {len(listed)} ships, at most {MOST_SHIPS} are allowed")
    ships = [_ship(f"{path}: ships[{k}]", each) for k, each in enumerate(listed)]
    numbers = [ship.identity.mmsi for ship in ships]
    for k, number in enumerate(numbers):
        if number in numbers[:k]:
            raise InputError(f"{path}: ships[{k}].mmsi: {number} is another's")
    return ships


def _ship(called: str, found: Mapping[str, Any]) -> Ship:
    _known(called, found, _KEYS)
    given: dict[str, Any] = {key: _text(called, key, found[key]) for key in _TEXTS if key in found}
    given |= {key: _whole(called, key, found[key]) for key in _NUMBERS if key in found}
    lengths = {
        key: _quantity(f"{called}.{key}", found[key], "m") for key in _LENGTHS if key in found
    }
    if "mmsi" not in found or "track" not in found:
        missing = "mmsi" if "mmsi" not in found else "track"
        raise InputError(f"{called}: {missing} is missing")
    status = given.pop("status", 0)
    if status not in STATUSES:
        raise InputError(f"{called}.status is {status}, 0 to 15 are allowed")
    length, beam = 0.5 * lengths.get("length", 0.0), 0.5 * lengths.get("beam", 0.0)
    antenna = lengths.get("antenna", _ANTENNA_M)
    if antenna < 0.0:
        raise InputError(f"{called}.antenna is {antenna:g} m, it is above the water")
    identity = Identity(
        mmsi=_whole(called, "mmsi", found["mmsi"]),
        **given,
        to_bow=length,
        to_stern=length,
        to_port=beam,
        to_starboard=beam,
        draught=lengths.get("draught", 0.0),
    ).checked(f"{called}.")
    return Ship(identity, _track(f"{called}.track", found["track"]), status, antenna)


def _track(called: str, found: Any) -> tuple[tuple[float, float, float], ...]:
    if not isinstance(found, list) or not 2 <= len(found) <= _MOST_POINTS:
        raise InputError(
            f"{called}: two points at least are needed, ['0 s', '100 m', '0 m'] each: time, "
            f"north, east; at most {_MOST_POINTS}"
        )
    points: list[tuple[float, float, float]] = []
    for k, point in enumerate(found):
        if not isinstance(point, list) or len(point) != len(_POINT):
            raise InputError(f"{called}[{k}] is {point!r}, time, north and east are needed")
        pairs = zip(point, _POINT, strict=True)
        t, n, e = (_quantity(f"{called}[{k}], {name}", value, u) for value, (name, u) in pairs)
        if points and t <= points[-1][0]:
            raise InputError(f"{called}[{k}]: {t:g} s is not after the point before")
        points.append((t, n, e))
    return tuple(points)


def _known(called: str, found: Mapping[str, Any], keys: tuple[str, ...]) -> None:
    for key in found:
        if key not in keys:
            raise InputError(f"{called}: {unknown('key', key, keys)}")


def _text(called: str, key: str, value: Any) -> str:
    if not isinstance(value, str):
        raise InputError(f"{called}.{key} is {value!r}, a text is needed")
    return value


def _whole(called: str, key: str, value: Any) -> int:
    if type(value) is not int:
        raise InputError(f"{called}.{key} is {value!r}, a whole number is needed")
    return value


def _quantity(called: str, value: Any, unit: str) -> float:
    if isinstance(value, bool) or not isinstance(value, (str, int, float)):
        raise InputError(f"{called} is {value!r}, something like '10 {unit}' is needed")
    try:
        found = quantity(value, unit)
    except InputError as error:
        raise InputError(f"{called}: {error}") from None
    if not math.isfinite(found):
        raise InputError(f"{called} is {value!r}, a finite number is needed")
    return found
