"""Sets the outputs of a receiver by what it has received."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from functools import lru_cache
from typing import Any

from seatrial.links.geodesy import Ned, Origin

from .directions import Variation, magnetic_direction, modelled, true_direction, variation_of
from .memory import Received
from .outputs import DIRECTIONS, ENGINE, ENGINES, ORDERED, SINGLE, TARGETS, WAYPOINT, WIND
from .targets import Targets

RUDDERS = ("rudder", "rudder_order", "commanded_rudder")
"""Quantities with the sign of rudders."""
_STILL_M_S = 0.005
"""Below half the resolution of speeds a boat without a course is at rest."""


class Publisher:
    """Outputs of a component with `outputs.received_outputs` of a ``prefix``.

    ``given`` returns a variation that the component has without the network, or None; ``day`` the
    date by its own clock, days since 1970.
    """

    def __init__(
        self,
        component: Any,
        prefix: str,
        received: Received,
        targets: Targets,
        origin: Origin,
        given: Callable[[], Variation | None],
        day: Callable[[], float],
    ) -> None:
        self._component, self._prefix = component, prefix
        self._received, self._targets, self._origin = received, targets, origin
        self._given, self._day = given, day

    def publish(self, names: Iterable[str], now_ns: int) -> None:
        """Set the outputs that follow from quantities, by their names."""
        given = {name.removeprefix("magnetic_") for name in names}
        groups = set(map(_group, given))
        for name in SINGLE:
            if name in given:
                self._single(name, now_ns)
        if "place" in groups:
            self._position(now_ns)
        if not groups.isdisjoint(("north", "place")):
            variation = self.variation(now_ns)
            self._directions(now_ns, variation)
            self._velocity(now_ns, variation)
            self._wind(now_ns, variation)
        for group, method in (
            ("attitude", self._attitude),
            ("engines", self._engines),
            ("helm", self._helm),
            ("waypoint", self._waypoint),
        ):
            if group in groups:
                method(now_ns)

    def publish_targets(self, now_ns: int) -> None:
        """Set the outputs of other ships."""
        here = self._get("position_n") if self._get("position_valid") else (0.0, 0.0, 0.0)
        nearest = self._targets.nearest(now_ns, here, TARGETS)
        empty = [(0, {"place": [0.0, 0.0]})] * (TARGETS - len(nearest))
        shown: list[tuple[int, Any]] = [*nearest, *empty]
        entries = [entry for _, entry in shown]
        velocities = [entry.get("velocity") for entry in entries]
        headings = [entry.get("heading") for entry in entries]
        self._set("ais_targets", len(self._targets.lately(now_ns)))
        self._set("ais_mmsi", [mmsi for mmsi, _ in shown])
        for k, axis in enumerate(("north", "east")):
            self._set(f"ais_{axis}", [entry["place"][k] for entry in entries])
            self._set(f"ais_velocity_{axis}", [v[k] if v is not None else 0.0 for v in velocities])
        self._set("ais_velocity_valid", [each is not None for each in velocities])
        self._set("ais_heading", [0.0 if each is None else each for each in headings])
        self._set("ais_heading_valid", [each is not None for each in headings])
        for name in ("length", "beam"):
            self._set(f"ais_{name}", [entry.get(name, 0.0) for entry in entries])
        named = (f"{mmsi} {entry['name']}" for mmsi, entry in nearest if "name" in entry)
        self._set("ais_names", "; ".join(named))

    def variation(self, now_ns: int) -> Variation | None:
        """Return the variation received, given or modelled; None if none is known."""
        return variation_of(self._received, now_ns, lambda: self._given() or self._modelled(now_ns))

    # ------------------------------------------------------------------ quantities

    def _single(self, name: str, now_ns: int) -> None:
        values, valid = self._received.get(name, now_ns)
        if values is not None:
            turned = name in RUDDERS and self._component.rudder_positive == "port"
            self._show(name, -values[0] if turned else values[0], valid)
        self._set(f"{name}_valid", valid)

    def _directions(self, now_ns: int, variation: Variation | None) -> None:
        for name in DIRECTIONS:
            if name in ORDERED:
                ordered, valid = self._received.get(name, now_ns)
                known = variation.value if variation is not None else None
                if ordered is not None and (ordered[1] == 0.0 or known is not None):
                    true = ordered[0] + (ordered[1] * (known or 0.0))
                    self._show(name, true % math.tau if ordered[1] else true, valid)
                else:
                    self._set(f"{name}_valid", False)
                continue
            found = true_direction(self._received, name, now_ns, variation)
            self._show(name, None if found is None else found.value, found is not None)
            if name == "heading":
                self._set("heading_from", "" if found is None else found.origin)
        magnetic = magnetic_direction(self._received, "heading", now_ns, variation)
        self._show("magnetic_heading", magnetic, magnetic is not None)

    def _velocity(self, now_ns: int, variation: Variation | None) -> None:
        speed = self._received.valid("speed_over_ground", now_ns)
        course = true_direction(self._received, "course", now_ns, variation)
        valid = speed is not None and (course is not None or speed[0] < _STILL_M_S)
        if speed is not None and valid:
            angle = 0.0 if course is None else course.value
            velocity = (speed[0] * math.cos(angle), speed[0] * math.sin(angle), 0.0)
            self._set("velocity_n", velocity)
        self._set("velocity_valid", valid)

    def _wind(self, now_ns: int, variation: Variation | None) -> None:
        both = True
        for name in ("wind_speed", "wind_angle"):
            values, valid = self._received.get(name, now_ns)
            self._show(name, None if values is None else values[0], valid)
            both = both and valid
        self._set("wind_valid", both)
        speed = self._received.valid("ground_wind_speed", now_ns)
        angle = self._received.valid("ground_wind_angle", now_ns)
        found = true_direction(self._received, "wind_direction", now_ns, variation)
        direction = None if found is None else found.value
        heading = true_direction(self._received, "heading", now_ns, variation)
        if direction is None and angle is not None and heading is not None:
            direction = heading.value + angle[0]
        valid = speed is not None and direction is not None
        if speed is not None and direction is not None:
            wind = (-speed[0] * math.cos(direction), -speed[0] * math.sin(direction))
            self._set("true_wind", wind)
        self._set("true_wind_valid", valid)

    def _attitude(self, now_ns: int) -> None:
        shown, whole = list(self._get("attitude")), True
        for k, name in enumerate(("roll", "pitch", "yaw")):
            values, valid = self._received.get(name, now_ns)
            shown[k] = shown[k] if values is None else values[0]
            whole = whole and valid
            self._set(f"{name}_valid", valid)
        self._set("attitude", shown)
        self._set("attitude_valid", whole)

    def _position(self, now_ns: int) -> None:
        place, valid = self._received.get("place", now_ns)
        if place is not None:
            altitude, _ = self._received.get("altitude", now_ns)
            height = self._origin.altitude if altitude is None else altitude[0]
            self._set("position_n", position(self._origin, place[0], place[1], height))
        self._set("position_valid", valid)

    def _engines(self, now_ns: int) -> None:
        for name in ENGINE:
            found = [
                self._received.valid(f"engine_{name} {number}", now_ns) for number in range(ENGINES)
            ]
            values = [0.0 if each is None else each[0] for each in found]
            self._show(f"engine_{name}", values, [each is not None for each in found])

    def _helm(self, now_ns: int) -> None:
        mode = self._received.valid("steering_mode", now_ns)
        self._set("steering_mode", -1 if mode is None else int(mode[0]))
        way = self._received.valid("rudder_direction", now_ns)
        self._set("rudder_direction", 0 if way is None else int(way[0]))

    def _waypoint(self, now_ns: int) -> None:
        place, valid = self._received.get("waypoint_place", now_ns)
        if place is not None:
            there = position(self._origin, place[0], place[1], self._origin.altitude)
            self._set("waypoint_n", there)
        self._set("waypoint_valid", valid)
        number = self._received.valid("waypoint_number", now_ns)
        self._set("waypoint_number", -1 if number is None else int(number[0]))
        arrived = self._received.valid("arrived", now_ns)
        self._set("arrived", arrived is not None and arrived[0] > 0.0)

    # ------------------------------------------------------------------ inside

    def _modelled(self, now_ns: int) -> Variation | None:
        """Return that of the model at the last place received, or else at an origin that is set."""
        date, _ = self._received.get("date", now_ns)
        day = self._day() if date is None else date[0]
        place, _ = self._received.get("place", now_ns)
        if place is not None:
            return modelled(place[0], place[1], day, "the position received")
        here = math.degrees(self._origin.latitude), math.degrees(self._origin.longitude)
        return modelled(*here, day, "the origin") if any(here) else None

    def _show(self, name: str, value: Any, valid: Any) -> None:
        """Set an output and its validity; one without a value keeps its last."""
        if value is not None:
            self._set(name, value)
        self._set(f"{name}_valid", valid)

    def _set(self, name: str, value: Any) -> None:
        setattr(self._component, self._prefix + name, value)

    def _get(self, name: str) -> Any:
        return getattr(self._component, self._prefix + name)


_NORTH = ("variation", "speed_over_ground", *WIND, *DIRECTIONS)
"""Quantities on which directions, the velocity or the winds depend."""


def _group(name: str) -> str:
    """Return the group of outputs that a quantity acts on beside one of its own name."""
    if name in _NORTH:
        return "north"
    if name in ("roll", "pitch", "yaw"):
        return "attitude"
    if name in ("place", "altitude", "date"):
        return "place"
    if name in ("steering_mode", "rudder_direction"):
        return "helm"
    if name in WAYPOINT:
        return "waypoint"
    return "engines" if name.startswith("engine_") else name


@lru_cache(64)  # nodes of one profile have one origin
def position(origin: Origin, latitude: float, longitude: float, altitude: float) -> Ned:
    """Return the position in {n} of latitude and longitude, deg, and altitude, m."""
    return origin.position(latitude, longitude, altitude)
