"""The NMEA 2000 node's parameters, inputs and outputs."""

from __future__ import annotations

from typing import Any, ClassVar

from seatrial.links.parameter_validation import start_date
from seatrial.links.unconnected import NOT_CONNECTED
from seatrial.model.component import Component, Input, Noise, Output, Parameter, terminal

from ..received.memory import preferred_sources
from ..received.outputs import ENGINES, QUANTITIES, received_outputs
from . import catalogue
from .address_claim import HIGHEST

_NED = ("north", "east", "down")
_EULER = ("phi", "theta", "psi")
_ENGINES = tuple(f"e{number}" for number in range(1, ENGINES + 1))
_PI, _HALF_PI = 3.1415927, 1.5707964


def _measured(unit: str, description: str, **options: Any) -> Input:
    return Input(unit, description, start=NOT_CONNECTED, optional=True, **options)


def _valid(what: str) -> Input:
    return Input("1", f"whether {what} is valid", type=bool, start=True, optional=True)


def check_preferred(text: str) -> None:
    """Raise InputError for a text that `prefer` refuses."""
    preferred_sources(text, QUANTITIES)


class Nmea2000Ports(received_outputs("bus_"), Noise, Component):  # type: ignore[misc]
    """Parameters, inputs and outputs of `Nmea2000`."""

    sends = Parameter("", "1", "PGNs that it sends, separated by spaces", check=catalogue.sends)
    intervals = Parameter(
        "",
        "1",
        "PGN SECONDS of intervals that are not the standard's; with ;",
        check=catalogue.intervals,
    )
    address = Parameter(35.0, "1", "address that it claims first", min=0.0, max=float(HIGHEST))
    arbitrary_address = Parameter(
        "on", "1", "whether it takes another address if it must", choices=("on", "off")
    )
    uid = Parameter("1", "1", "serial number, a whole number up to 2^64 - 1")
    manufacturer_code = Parameter(2046.0, "1", "manufacturer", min=0.0, max=2046.0)
    device_function = Parameter(130.0, "1", "function within its class", min=0.0, max=254.0)
    device_class = Parameter(25.0, "1", "class of device", min=0.0, max=126.0)
    device_instance = Parameter(0.0, "1", "which of several alike", min=0.0, max=253.0)
    system_instance = Parameter(0.0, "1", "which of several networks", min=0.0, max=14.0)
    product_code = Parameter(1.0, "1", "product", min=0.0, max=65532.0)
    model = Parameter("seatrial", "1", "model, up to 32 characters")
    model_version = Parameter("1", "1", "version of the model")
    software_version = Parameter("0.1.0", "1", "version of its software")
    load_equivalency = Parameter(1.0, "1", "current from the bus, in 50 mA", min=0.0, max=252.0)
    description = Parameter("", "1", "where it is installed")
    latitude = Parameter(0.0, "rad", "of the origin, WGS 84", min=-_HALF_PI, max=_HALF_PI)
    longitude = Parameter(0.0, "rad", "of the origin, WGS 84", min=-_PI, max=_PI)
    altitude = Parameter(0.0, "m", "of the origin")
    date = start_date()
    heading_reference = Parameter(
        "true", "1", "north that the heading is counted from", choices=("true", "magnetic")
    )
    transducer_offset = Parameter(
        0.0, "m", "from the transducer up to the waterline; negative: down to the keel"
    )
    battery_instance = Parameter(0.0, "1", "which battery it sends", min=0.0, max=252.0)
    rudder_instance = Parameter(0.0, "1", "which rudder it sends and reads", min=0.0, max=252.0)
    rudder_positive = Parameter(
        "starboard",
        "1",
        "the way a positive rudder on the ports turns the ship",
        choices=("port", "starboard"),
    )
    timeout = Parameter(
        1.0, "s", "time for which a received value is valid, at least 3 of its intervals", min=0.0
    )

    prefer = Parameter(
        "", "1", "QUANTITY ADDRESS of sources to use, the best first; with ;", check=check_preferred
    )

    rx = Input("1", "operations from the bus", type=str, role="can")
    heading = _measured("rad", "heading, clockwise from north, as a compass shows it")
    heading_valid = _valid("the heading")
    deviation = _measured("rad", "deviation of the heading, positive east")
    variation = _measured("rad", "magnetic variation here, positive east")
    rate_of_turn = _measured("rad/s", "rate of turn, to starboard")
    rate_valid = _valid("the rate of turn")
    attitude = _measured("rad", "Euler angles, ZYX", axes=_EULER)
    attitude_valid = _valid("the attitude")
    rudder = _measured("rad", "angle of the rudder, in the sense of rudder_positive")
    rudder_order = _measured("rad", "rudder angle ordered, in the same sense")
    water_speed = _measured("m/s", "speed through the water, ahead")
    depth = _measured("m", "depth of the water below the transducer")
    position_n = _measured("m", "position, north-east-down", axes=_NED)
    velocity_n = _measured("m/s", "velocity over ground, north-east-down", axes=_NED)
    position_valid = _valid("position and velocity")
    wind_speed = _measured("m/s", "speed of the apparent wind")
    wind_angle = _measured("rad", "where the apparent wind blows to from the bow, to starboard")
    wind_valid = _valid("the apparent wind")
    true_wind = _measured(
        "m/s", "velocity of the air over ground: where it blows to", axes=("north", "east")
    )
    engine_speed = _measured("rad/s", "speeds of the engines", axes=_ENGINES)
    engine_voltage = _measured("V", "voltages of the engines", axes=_ENGINES)
    engine_temperature = _measured("K", "temperatures of the engines", axes=_ENGINES)
    engine_load = _measured("1", "loads of the engines, as shares of the largest", axes=_ENGINES)
    steering_mode = Input(
        "1",
        "0 main steering, 1 non-follow-up, 2 follow-up, 3 heading alone, 4 heading, 5 track",
        type=int,
        start=-1,
        optional=True,
    )
    heading_to_steer = _measured("rad", "heading to steer, clockwise from north")
    track = _measured("rad", "track to keep, clockwise from north")
    commanded_rudder = _measured("rad", "rudder commanded, in the same sense")
    rudder_limit = _measured("rad", "largest rudder, to either side")
    battery_voltage = _measured("V", "voltage of the battery")
    battery_current = _measured("A", "current out of the battery")
    battery_temperature = _measured("K", "temperature of the battery")
    leg = Input("1", "number of the leg that is followed, 0: none", type=int, optional=True)
    leg_from = _measured("m", "begin of the leg, north-east-down", axes=_NED)
    leg_to = _measured("m", "waypoint at its end, north-east-down", axes=_NED)
    leg_radius = _measured("m", "distance at which the waypoint is reached")
    ais = Input(
        "1", "sentences of an AIS transponder, as text", type=str, role="bytes", optional=True
    )
    silent = Input(
        "1", "whether it sends no data; the network's messages go on", type=bool, optional=True
    )

    tx = Output("1", "operations to the bus", type=str, role="can")
    claimed_address = Output("1", "its address, 254 while it has none", type=int, start=254)
    contests = Output("1", "claims of its address by others", type=int)
    twins = Output("1", "claims by others under its own NAME", type=int)
    sent = Output("1", "messages sent", type=int)
    received = Output("1", "messages understood", type=int)

    terminals: ClassVar = {
        "bus": terminal("tx", "rx"),
        "sensors": terminal(
            "position_n",
            "velocity_n",
            "position_valid",
            "heading",
            "heading_valid",
            "wind_speed",
            "wind_angle",
            "wind_valid",
            heel="attitude__phi",
            pitch="attitude__theta",
            yaw_rate="rate_of_turn",
            imu_valid="rate_valid",
            rudder="rudder",
            water_depth="depth",
        ),
        # What PGN 127257 has beside them, from a compass and an IMU.
        "ahrs": terminal(
            heading="attitude__psi",
            heel="attitude__phi",
            pitch="attitude__theta",
            imu_valid="attitude_valid",
        ),
        "reading": terminal(
            position_n="bus_position_n",
            velocity_n="bus_velocity_n",
            position_valid="bus_position_valid",
            heading="bus_heading",
            heading_valid="bus_heading_valid",
            wind_speed="bus_wind_speed",
            wind_angle="bus_wind_angle",
            wind_valid="bus_wind_valid",
            heel="bus_attitude__phi",
            pitch="bus_attitude__theta",
            yaw_rate="bus_rate_of_turn",
            imu_valid="bus_rate_of_turn_valid",
            water_depth="bus_depth",
            water_depth_valid="bus_depth_valid",
            rudder="bus_rudder",
        ),
        "battery": terminal(voltage="battery_voltage", current="battery_current"),
        "route": terminal("leg", "leg_from", "leg_to", "leg_radius"),
        "steering": terminal(heading_wanted="heading_to_steer"),
        "wanted": terminal(heading_wanted="bus_heading_to_steer"),
    }
