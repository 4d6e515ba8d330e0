"""Outputs that show what was received, the same ones for every receiver under its own prefix."""

from __future__ import annotations

from typing import Any

from seatrial.model.component import Output

ENGINES = 4
"""Most engines of a boat."""
TARGETS = 8
"""Most other ships that are shown, the nearest ones."""

_NED = ("north", "east", "down")
_EULER = ("phi", "theta", "psi")
ENGINE_AXES = tuple(f"e{number}" for number in range(1, ENGINES + 1))
_TARGETS = tuple(f"t{number}" for number in range(1, TARGETS + 1))

SINGLE: dict[str, tuple[str, str]] = {
    "rate_of_turn": ("rad/s", "rate of turn, to starboard"),
    "rudder": ("rad", "angle of the rudder, in the sense of rudder_positive"),
    "rudder_order": ("rad", "rudder angle ordered, in the same sense"),
    "commanded_rudder": ("rad", "rudder commanded, in the same sense"),
    "water_speed": ("m/s", "speed through the water, ahead"),
    "speed_over_ground": ("m/s", "speed over ground"),
    "depth": ("m", "depth of the water below the transducer"),
    "depth_offset": (
        "m",
        "distance from the transducer up to the waterline; negative: down to the keel",
    ),
    "variation": ("rad", "magnetic variation, positive east"),
    "water_wind_speed": ("m/s", "speed of the wind over the water"),
    "water_wind_angle": ("rad", "direction that this wind blows to from the bow, to starboard"),
    "current_speed": ("m/s", "speed of the current"),
    "cross_track": ("m", "cross-track error, positive to starboard of the leg"),
    "waypoint_distance": ("m", "distance to the waypoint"),
    "closing_speed": ("m/s", "speed towards the waypoint"),
    "water_temperature": ("K", "temperature of the water"),
    "air_temperature": ("K", "temperature of the air outside"),
    "air_pressure": ("Pa", "pressure of the air"),
    "set_pressure": ("Pa", "pressure that a device is set to"),
    "humidity": ("1", "relative humidity of the air outside"),
}
"""Quantities of one value that go to outputs of their name as they are: unit and description."""

DIRECTIONS = {
    "heading": "true heading, clockwise from north",
    "course": "true course over ground, clockwise from north",
    "current_direction": "direction that the current sets to, clockwise from north",
    "waypoint_bearing": "true bearing of the waypoint, clockwise from north",
    "leg_direction": "true direction of the leg, clockwise from north",
    "heading_to_steer": "heading to steer, clockwise from north",
    "track": "track to keep, clockwise from north",
}
"""Directions that may be received as magnetic ones, and go to outputs as true ones."""
ORDERED = ("heading_to_steer", "track")
"""Those that are orders: one quantity, an angle and 1 if it is magnetic."""

ENGINE = {
    "speed": ("rad/s", "speeds of the engines, 0 if not received"),
    "fuel_rate": ("m3/s", "fuel that the engines burn"),
    "temperature": ("K", "temperatures of the engines"),
    "oil_pressure": ("Pa", "oil pressures of the engines"),
    "voltage": ("V", "voltages of the engines' alternators"),
    "load": ("1", "loads of the engines, as shares of the largest"),
}
"""Quantities of each engine: unit and description."""

WHOLE = ("place", "altitude", "date", "roll", "pitch", "yaw", "steering_mode", "rudder_direction")
WIND = ("wind_speed", "wind_angle", "ground_wind_speed", "ground_wind_angle", "wind_direction")
WAYPOINT = ("waypoint_place", "waypoint_number", "arrived")
QUANTITIES = (
    *SINGLE,
    *DIRECTIONS,
    *(f"engine_{name}" for name in ENGINE),
    *WHOLE,
    *WIND,
    *WAYPOINT,
)
"""Names of all quantities, those of engines without their number."""


def received_outputs(prefix: str) -> Any:
    """Return a mix-in with the outputs of a receiver, whose names begin with ``prefix``."""
    found: dict[str, Output] = {}

    def add(name: str, unit: str, description: str, **options: Any) -> None:
        found[prefix + name] = Output(unit, description, **options)

    def valid(name: str, quantity: str, **options: Any) -> None:
        text = f"whether {quantity} has been received lately"
        found[f"{prefix}{name}_valid"] = Output("1", text, type=bool, **options)

    for name, text in DIRECTIONS.items():
        add(name, "rad", text)
        valid(name, f"the {text.partition(',')[0]}")
    add("magnetic_heading", "rad", "magnetic heading, clockwise from magnetic north")
    valid("magnetic_heading", "the magnetic heading")
    add("heading_from", "1", "origin of the true heading: source, and that of the variation",
        type=str)  # fmt: skip
    for name, (unit, text) in SINGLE.items():
        add(name, unit, text)
        valid(name, f"the {text.partition(',')[0].partition(';')[0]}")
    add("attitude", "rad", "Euler angles, ZYX", axes=_EULER)
    valid("attitude", "the whole attitude")
    for name in ("roll", "pitch", "yaw"):
        valid(name, f"the {name}")
    add("position_n", "m", "position, north-east-down", axes=_NED)
    valid("position", "a position")
    add("velocity_n", "m/s", "velocity over ground, north-east-down", axes=_NED)
    valid("velocity", "a velocity over ground")
    add("wind_speed", "m/s", "speed of the apparent wind")
    add("wind_angle", "rad", "where the apparent wind blows to from the bow, to starboard")
    valid("wind", "the apparent wind, speed and angle,")
    valid("wind_speed", "the speed of the apparent wind")
    valid("wind_angle", "the angle of the apparent wind")
    add("true_wind", "m/s", "velocity of the air over ground: where it blows to",
        axes=("north", "east"))  # fmt: skip
    valid("true_wind", "the wind over ground")
    for name, (unit, text) in ENGINE.items():
        add(f"engine_{name}", unit, text, axes=ENGINE_AXES)
        valid(f"engine_{name}", "each of them", axes=ENGINE_AXES)
    add("steering_mode", "1", "0 main steering, 1 non-follow-up, 2 follow-up, 3 heading alone, "
        "4 heading, 5 track; -1 for none", type=int, start=-1)  # fmt: skip
    add("rudder_direction", "1", "way the rudder is to move: 1 starboard, -1 port", type=int)
    add("waypoint_n", "m", "waypoint, north-east-down", axes=_NED)
    valid("waypoint", "a waypoint")
    add("waypoint_number", "1", "number of the waypoint, -1 for none", type=int, start=-1)
    add("arrived", "1", "whether the waypoint is reported as reached", type=bool)
    _add_targets(add)
    add("sources", "1", "QUANTITY SOURCE of all that is valid; with ;", type=str)
    add("messages", "1", "KIND USED/RECEIVED of all messages that are read; with ;", type=str)
    add("others", "1", "KIND COUNT of those that are not read; with ;", type=str)
    return type("ReceivedOutputs", (), found)


def _add_targets(add: Any) -> None:
    """Add the outputs of other ships, the nearest first."""
    add("ais_targets", "1", "ships, stations and marks received over AIS in 7 minutes", type=int)
    add("ais_mmsi", "1", "numbers of the nearest ones, 0 for none", type=int, axes=_TARGETS)
    for axis in ("north", "east"):
        add(f"ais_{axis}", "m", f"their places, {axis} of the origin", axes=_TARGETS)
    for axis in ("north", "east"):
        add(f"ais_velocity_{axis}", "m/s", f"their velocities over ground, {axis}", axes=_TARGETS)
    add("ais_velocity_valid", "1", "whether they report a velocity", type=bool, axes=_TARGETS)
    add("ais_heading", "rad", "their true headings", axes=_TARGETS)
    add("ais_heading_valid", "1", "whether they report a heading", type=bool, axes=_TARGETS)
    add("ais_length", "m", "their lengths, 0 if not received", axes=_TARGETS)
    add("ais_beam", "m", "their beams, 0 if not received", axes=_TARGETS)
    add("ais_names", "1", "MMSI NAME of those with a name; with ;", type=str)
