"""The NMEA 0183 component's parameters, inputs and outputs."""

from __future__ import annotations

from typing import ClassVar

from seatrial.links.endpoints.url import check_urls
from seatrial.links.parameter_validation import start_date
from seatrial.links.unconnected import NOT_CONNECTED
from seatrial.model.component import Input, Output, Parameter, Reachable, terminal
from seatrial.model.sampled import Sampled

from ..received.memory import preferred_sources
from ..received.outputs import ENGINE_AXES, QUANTITIES, received_outputs
from .schedule import schedule

_NED = ("north", "east", "down")


def check_preferred(text: str) -> None:
    """Raise InputError for a text that `prefer` refuses."""
    preferred_sources(text, QUANTITIES)


class Nmea0183Ports(received_outputs("received_"), Reachable, Sampled):  # type: ignore[misc]
    """Parameters, inputs and outputs of `Nmea0183`."""

    period = Parameter(0.05, "s", "time between two looks at links and clock", min=1e-6)
    links = Parameter(
        "udpout:127.0.0.1:10110", "1", "URLs of the links, separated by spaces", check=check_urls
    )
    sentences = Parameter(
        "GPRMC 1; GPGGA 1; GPVTG 1; HEHDT 0.2; HCHDG 0.2; TIROT 0.2; WIMWV-R 0.5; IIXDR 0.5",
        "1",
        "TALKER+SENTENCE PERIOD of each to send, in s; with ;",
        check=schedule,
    )
    latitude = Parameter(0.0, "rad", "of the origin, WGS 84", min=-1.5707964, max=1.5707964)
    longitude = Parameter(0.0, "rad", "of the origin, WGS 84", min=-3.1415927, max=3.1415927)
    altitude = Parameter(0.0, "m", "of the origin")
    date = start_date("2020-01-01")
    variation = Parameter(
        0.0, "rad", "magnetic variation, positive east", min=-3.1415927, max=3.1415927
    )
    transducer_offset = Parameter(
        0.0, "m", "from the depth's transducer up to the waterline, or, negative, down to the keel"
    )
    rudder_positive = Parameter(
        "starboard",
        "1",
        "the way a positive rudder on the port turns the ship",
        choices=("port", "starboard"),
    )
    cruise_speed = Parameter(1.0, "m/s", "speed that goes with orders: they name none", min=0.0)
    order_timeout = Parameter(5.0, "s", "time for which an order is valid", min=0.0)

    timeout = Parameter(
        3.0, "s", "time for which a received value is valid, at least 3 of its intervals", min=0.0
    )
    prefer = Parameter(
        "", "1", "QUANTITY TALKER of sources to use, the best first; with ;", check=check_preferred
    )

    rx = Input("1", "bytes that arrive, as text", type=str, role="bytes", optional=True)
    ais = Input(
        "1", "sentences of an AIS transponder, as text", type=str, role="bytes", optional=True
    )
    position_n = Input("m", "position, north-east-down", axes=_NED)
    velocity_n = Input("m/s", "velocity over ground, north-east-down", axes=_NED)
    position_valid = Input("1", "whether position and velocity are valid", type=bool)
    heading = Input("rad", "true heading, clockwise from north")
    heading_valid = Input("1", "whether the heading is valid", type=bool)
    rate_of_turn = Input(
        "rad/s", "rate of turn, positive to starboard", start=NOT_CONNECTED, optional=True
    )
    roll_pitch = Input(
        "rad",
        "roll and pitch, starboard side down, bow up",
        axes=("phi", "theta"),
        start=NOT_CONNECTED,
        optional=True,
    )
    imu_valid = Input(
        "1", "whether rate of turn, roll and pitch are valid", type=bool, optional=True
    )
    wind_speed = Input("m/s", "speed of the apparent wind", optional=True)
    wind_angle = Input(
        "rad", "where the apparent wind blows to from the bow, to starboard", optional=True
    )
    wind_valid = Input("1", "whether the apparent wind is valid", type=bool, optional=True)
    true_wind = Input(
        "m/s",
        "true wind over ground: where it blows to, {n}",
        axes=("north", "east"),
        optional=True,
    )
    true_wind_valid = Input("1", "whether the true wind is valid", type=bool, optional=True)
    water_speed = Input("m/s", "speed through the water along the bow", optional=True)
    water_speed_valid = Input("1", "whether it is valid", type=bool, optional=True)
    depth = Input("m", "depth of the water below the transducer", optional=True)
    depth_valid = Input("1", "whether it is valid", type=bool, optional=True)
    water_temperature = Input("K", "temperature of the water", start=273.15, optional=True)
    water_temperature_valid = Input("1", "whether it is valid", type=bool, optional=True)
    rudder = Input(
        "rad",
        "angle of the rudder, in the sense of rudder_positive",
        start=NOT_CONNECTED,
        optional=True,
    )
    rudder_valid = Input("1", "whether it is valid", type=bool, optional=True)
    engine_speed = Input(
        "rad/s", "speeds of the engines", axes=ENGINE_AXES, start=NOT_CONNECTED, optional=True
    )
    leg = Input("1", "number of the leg that is followed, 0: none", type=int, optional=True)
    leg_from = Input("m", "begin of the leg, north-east-down", axes=_NED, optional=True)
    leg_to = Input("m", "waypoint at its end, north-east-down", axes=_NED, optional=True)
    leg_radius = Input("m", "distance at which the waypoint is reached", optional=True)

    tx = Output("1", "bytes that are sent, as text", type=str, role="bytes")
    target_kind = Output("1", "heading or position", type=str, start="heading")
    target_valid = Output("1", "whether there is an order", type=bool)
    target_heading = Output("rad", "heading ordered, clockwise from north")
    target_position = Output("m", "waypoint ordered, north-east-down", axes=_NED)
    target_speed = Output("m/s", "speed that goes with it, 0 without an order")
    cross_track = Output("m", "cross-track error received, positive to starboard of the leg")
    cross_track_valid = Output("1", "whether it was", type=bool)
    waypoint = Output("1", "name of the waypoint received", type=str)
    arrived = Output("1", "whether the waypoint was reported as reached", type=bool)
    sentences_sent = Output("1", "sentences sent", type=int)
    sentences_received = Output("1", "sentences received", type=int)
    lines_refused = Output("1", "lines received that are no sentences", type=int)

    terminals: ClassVar = {
        "sensors": terminal(
            "position_n",
            "velocity_n",
            "position_valid",
            "heading",
            "heading_valid",
            "roll_pitch",
            "imu_valid",
            "wind_speed",
            "wind_angle",
            "wind_valid",
            heel="roll_pitch__phi",
            pitch="roll_pitch__theta",
            yaw_rate="rate_of_turn",
            water_depth="depth",
            water_depth_valid="depth_valid",
            rudder="rudder",
        ),
        "reading": terminal(
            position_n="received_position_n",
            velocity_n="received_velocity_n",
            position_valid="received_position_valid",
            heading="received_heading",
            heading_valid="received_heading_valid",
            wind_speed="received_wind_speed",
            wind_angle="received_wind_angle",
            wind_valid="received_wind_valid",
            heel="received_attitude__phi",
            pitch="received_attitude__theta",
            yaw_rate="received_rate_of_turn",
            imu_valid="received_rate_of_turn_valid",
            water_depth="received_depth",
            water_depth_valid="received_depth_valid",
            rudder="received_rudder",
        ),
        # A true wind is as valid as the anemometer that it is estimated from.
        "anemometer": terminal(wind_valid="true_wind_valid"),
        "estimate": terminal(wind="true_wind"),
        "orders": terminal(
            "target_kind", "target_valid", "target_position", "target_heading", "target_speed"
        ),
        "route": terminal("leg", "leg_from", "leg_to", "leg_radius"),
        "serial": terminal(down="tx", up="rx"),
    }
