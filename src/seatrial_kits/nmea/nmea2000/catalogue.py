"""Messages that a node sends and reads: names, priorities and intervals of the standard.

Numbers from canboat's table of PGNs (canboat.json 6.2.0). Layouts and resolutions are the package
nmea2000's, which has the same table.
"""

from __future__ import annotations

from seatrial.errors import InputError, unknown

from .catalogue_navigation import NAVIGATION
from .catalogue_read import READ
from .pgn import FROM_NORTH, SID, Field, Pgn

_DATA = {
    each.number: each
    for each in (
        Pgn(
            126992,
            "systemTime",
            "System time",
            3,
            1.0,
            (
                SID,
                Field("source", sense="0, GPS"),
                Field(
                    "date",
                    "date",
                    "bus_heading",
                    "UTC: `date` at the start of the run; read: for the World Magnetic Model",
                ),
                Field("time", "date", sense="UTC, from midnight"),
            ),
        ),
        Pgn(
            127237,
            "headingTrackControl",
            "Heading/track control",
            2,
            0.25,
            (
                Field("steeringMode", "steering_mode", "bus_steering_mode"),
                Field("headingReference", sense="sent: true; read: both"),
                Field("commandedRudderDirection", "commanded_rudder", sense="as the angle's sign"),
                Field(
                    "commandedRudderAngle",
                    "commanded_rudder",
                    "bus_commanded_rudder",
                    "positive to turn to starboard",
                ),
                Field(
                    "headingToSteerCourse", "heading_to_steer", "bus_heading_to_steer", FROM_NORTH
                ),
                Field("track", "track", "bus_track", FROM_NORTH),
                Field("rudderLimit", "rudder_limit"),
                Field(
                    "vesselHeading",
                    "heading",
                    "bus_heading",
                    FROM_NORTH + "; read: where no compass is",
                ),
            ),
        ),
        Pgn(
            127245,
            "rudder",
            "Rudder",
            2,
            0.1,
            (
                Field("instance", "rudder_instance", sense="read: this instance, else 252"),
                Field(
                    "directionOrder",
                    "rudder_order",
                    "bus_rudder_direction",
                    "sent: as the angle's sign, 0 amidships",
                ),
                Field(
                    "angleOrder",
                    "rudder_order",
                    "bus_rudder_order",
                    "positive to turn to starboard",
                ),
                Field("position", "rudder", "bus_rudder", "positive to turn to starboard"),
            ),
        ),
        Pgn(
            127250,
            "vesselHeading",
            "Vessel heading",
            2,
            0.1,
            (
                SID,
                Field(
                    "heading",
                    "heading",
                    "bus_heading",
                    FROM_NORTH + "; true or magnetic by `reference`",
                ),
                Field(
                    "deviation",
                    "deviation",
                    "bus_magnetic_heading",
                    "positive east; read: added if magnetic",
                ),
                Field(
                    "variation",
                    "variation",
                    "bus_variation",
                    "positive east; read: added if magnetic",
                ),
                Field("reference", "heading_reference"),
            ),
        ),
        Pgn(
            127251,
            "rateOfTurn",
            "Rate of turn",
            2,
            0.1,
            (SID, Field("rate", "rate_of_turn", "bus_rate_of_turn", "positive to starboard")),
        ),
        Pgn(
            127257,
            "attitude",
            "Attitude",
            3,
            1.0,
            (
                SID,
                Field("yaw", "attitude.psi", "bus_attitude.psi", FROM_NORTH + ", -π to π"),
                Field("pitch", "attitude.theta", "bus_attitude.theta", "positive bow up"),
                Field("roll", "attitude.phi", "bus_attitude.phi", "positive to starboard"),
            ),
        ),
        Pgn(
            127258,
            "magneticVariation",
            "Magnetic variation",
            6,
            1.0,
            (
                SID,
                Field("source", sense="0, manual"),
                Field("ageOfService", "date", sense="days since 1970, UTC"),
                Field("variation", "variation", "bus_variation", "positive east"),
            ),
        ),
        Pgn(
            127488,
            "engineParametersRapidUpdate",
            "Engine parameters, rapid update",
            2,
            0.1,
            (
                Field("instance", sense="0 for `e1`, and so on: one message each"),
                Field(
                    "speed", "engine_speed", "bus_engine_speed", "the magnitude: there is no sign"
                ),
            ),
        ),
        Pgn(
            127489,
            "engineParametersDynamic",
            "Engine parameters, dynamic",
            2,
            0.5,
            (
                Field("instance", sense="0 for `e1`, and so on: one message each"),
                Field("temperature", "engine_temperature", "bus_engine_temperature"),
                Field("oilPressure", "", "bus_engine_oil_pressure"),
                Field("fuelRate", "", "bus_engine_fuel_rate"),
                Field(
                    "alternatorPotential",
                    "engine_voltage",
                    "bus_engine_voltage",
                    "the engine's supply",
                ),
                Field("discreteStatus1", sense="0, no warnings"),
                Field("discreteStatus2", sense="0, no warnings"),
                Field("engineLoad", "engine_load", "bus_engine_load", "the magnitude"),
            ),
        ),
        Pgn(
            128259,
            "speed",
            "Speed, water referenced",
            2,
            1.0,
            (
                SID,
                Field(
                    "speedWaterReferenced",
                    "water_speed",
                    "bus_water_speed",
                    "ahead; astern is not available",
                ),
                Field(
                    "speedGroundReferenced",
                    "velocity_n",
                    "bus_speed_over_ground",
                    "the magnitude; read: where 129026 has none",
                ),
            ),
        ),
        Pgn(
            128267,
            "waterDepth",
            "Water depth",
            3,
            1.0,
            (
                SID,
                Field("depth", "depth", "bus_depth", "below the transducer"),
                Field(
                    "offset",
                    "transducer_offset",
                    "bus_depth_offset",
                    "positive up to the waterline, negative down to the keel",
                ),
            ),
        ),
        Pgn(
            129025,
            "positionRapidUpdate",
            "Position, rapid update",
            2,
            0.1,
            (
                Field("latitude", "position_n", "bus_position_n", "WGS 84, north"),
                Field("longitude", "position_n", "bus_position_n", "WGS 84, east"),
            ),
        ),
        Pgn(
            129026,
            "cogSogRapidUpdate",
            "COG and SOG, rapid update",
            2,
            0.25,
            (
                SID,
                Field("cogReference", sense="sent: true; read: both"),
                Field("cog", "velocity_n", "bus_course", FROM_NORTH),
                Field("sog", "velocity_n", "bus_speed_over_ground", "the magnitude"),
            ),
        ),
        Pgn(
            129029,
            "gnssPositionData",
            "GNSS position data",
            3,
            1.0,
            (
                SID,
                Field(
                    "date",
                    "date",
                    "bus_heading",
                    "UTC: `date` at the start of the run; read: for the World Magnetic Model",
                ),
                Field("time", "date", sense="UTC, from midnight"),
                Field("latitude", "position_n", "bus_position_n", "WGS 84, north"),
                Field("longitude", "position_n", "bus_position_n", "WGS 84, east"),
                Field("altitude", "position_n", "bus_position_n", "WGS 84, as the origin's"),
                Field("gnssType", sense="0, GPS"),
                Field("method", "position_valid", "bus_position_valid", "1 GNSS fix, 0 none"),
                Field("integrity", sense="0, not checked"),
                Field("numberOfSvs", sense="of a nominal GPS constellation"),
                Field("hdop", sense="of that constellation"),
                Field("pdop", sense="of that constellation"),
                Field("referenceStations", sense="0"),
            ),
        ),
        Pgn(
            130306,
            "windData",
            "Wind data",
            2,
            0.1,
            (
                SID,
                Field("windSpeed", "wind_speed", "bus_wind_speed"),
                Field(
                    "windAngle",
                    "wind_angle",
                    "bus_wind_angle",
                    "where it comes from, from the bow to starboard; the ports: where it blows to",
                ),
                Field(
                    "reference",
                    "",
                    "bus_true_wind",
                    "2, apparent; for `true_wind` 0, ground and north; read: 1, ground and "
                    "magnetic north, 3, ground and bow, 4, water and bow too",
                ),
            ),
        ),
    )
}
DATA = dict(sorted((_DATA | NAVIGATION).items()))
"""Messages about the vessel and what is round it, by number."""

NETWORK = {
    each.number: each
    for each in (
        Pgn(59392, "isoAcknowledgement", "ISO acknowledgement", 6),
        Pgn(59904, "isoRequest", "ISO request", 6),
        Pgn(60928, "isoAddressClaim", "ISO address claim", 6),
        Pgn(126208, "nmeaAcknowledgeGroupFunction", "NMEA group function", 3),
        Pgn(126464, "pgnListTransmitAndReceive", "PGN lists", 6),
        Pgn(126993, "heartbeat", "Heartbeat", 7, 60.0),
        Pgn(126996, "productInformation", "Product information", 6),
        Pgn(126998, "configurationInformation", "Configuration information", 6),
    )
}
"""Messages about the network, which every node sends and reads, by number."""

ALL = {**DATA, **READ, **NETWORK}

READABLE = dict(sorted((DATA | READ).items()))
"""Messages about the vessel and what is round it, those that a node only reads too."""

RECEIVED = (
    *(number for number, pgn in READABLE.items() if any(f.received for f in pgn.fields)),
    130315,
)
"""Messages about the vessel that a node reads."""


def check_sends(text: str) -> None:
    """Raise InputError for a text that `sends` refuses."""
    sends(text)


def sends(text: str) -> list[int]:
    """Return the PGNs of ``sends``, separated by spaces.

    Raises InputError, with near misses, for one that a node cannot send, and for doubles.
    """
    found = []
    for word in text.split():
        if word not in map(str, DATA):
            raise InputError(f"sends: {unknown('PGN', word, map(str, DATA))}")
        if int(word) in found:
            raise InputError(f"sends: {word} is there twice")
        found.append(int(word))
    return found


def check_intervals(text: str) -> None:
    """Raise InputError for a text that `intervals` refuses."""
    intervals(text)


def intervals(text: str) -> dict[int, float]:
    """Return the intervals (s) of ``PGN SECONDS; PGN SECONDS``; 0: only on request.

    Raises InputError for one that cannot be.
    """
    found = {}
    for part in filter(None, map(str.strip, text.split(";"))):
        number, _, written = part.partition(" ")
        (pgn,) = sends(number)
        try:
            seconds = float(written)
        except ValueError:
            seconds = -1.0
        if seconds != 0.0 and not 0.01 <= seconds <= 3600.0:
            raise InputError(
                f"intervals: {part!r} is not PGN SECONDS, such as '127250 0.2'; allowed 0.01 to "
                "3600 s, and 0 for only on request"
            )
        found[pgn] = seconds
    return found
