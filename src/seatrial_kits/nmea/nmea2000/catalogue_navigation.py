"""Messages about routes, satellites, batteries and other ships; as `catalogue`."""

from __future__ import annotations

from .pgn import FROM_NORTH, SID, Field, Pgn

_SHIP = (
    Field("userId", "ais", "bus_ais_mmsi", "MMSI"),
    Field("longitude", "ais", "bus_ais_east", "WGS 84, east"),
    Field("latitude", "ais", "bus_ais_north", "WGS 84, north"),
    Field("timeStamp", "ais", sense="second of UTC"),
    Field("cog", "ais", "bus_ais_velocity_north", FROM_NORTH),
    Field("sog", "ais", "bus_ais_velocity_north"),
    Field("heading", "ais", "bus_ais_heading", FROM_NORTH),
)
_HULL = (
    Field("typeOfShip", "ais"),
    Field("callsign", "ais"),
    Field("length", "ais", "bus_ais_length"),
    Field("beam", "ais", "bus_ais_beam"),
    Field("positionReferenceFromStarboard", "ais"),
    Field("positionReferenceFromBow", "ais"),
)
_RECEIVED = Field("aisTransceiverInformation", sense="0, received on channel A")

NAVIGATION = {
    each.number: each
    for each in (
        Pgn(
            127508,
            "batteryStatus",
            "Battery status",
            6,
            1.5,
            (
                Field("instance", "battery_instance"),
                Field("voltage", "battery_voltage"),
                Field("current", "battery_current", sense="positive when it charges"),
                Field("temperature", "battery_temperature"),
            ),
        ),
        Pgn(
            129038,
            "aisClassAPositionReport",
            "AIS class A position report",
            4,
            0.0,
            (
                *_SHIP,
                Field("rateOfTurn", "ais", sense="to starboard"),
                Field("navStatus", "ais"),
                _RECEIVED,
            ),
        ),
        Pgn(
            129039,
            "aisClassBPositionReport",
            "AIS class B position report",
            4,
            0.0,
            (*_SHIP, Field("unitType", "ais", sense="0 SOTDMA, 1 carrier sense"), _RECEIVED),
        ),
        Pgn(
            129283,
            "crossTrackError",
            "Cross-track error",
            3,
            1.0,
            (
                SID,
                Field("xteMode", sense="0, autonomous"),
                Field("navigationTerminated", "leg", "bus_cross_track_valid", "1 without a leg"),
                Field("xte", "position_n", "bus_cross_track", "positive to starboard of the leg"),
            ),
        ),
        Pgn(
            129284,
            "navigationData",
            "Navigation data",
            3,
            1.0,
            (
                SID,
                Field("distanceToWaypoint", "leg_to", "bus_waypoint_distance"),
                Field("courseBearingReference", sense="sent: true; read: both"),
                Field("perpendicularCrossed", "leg_to", "bus_arrived"),
                Field("arrivalCircleEntered", "leg_radius", "bus_arrived"),
                Field("calculationType", sense="1, rhumb line"),
                Field("etaTime", "leg_to", sense="UTC, at the closing velocity"),
                Field("etaDate", "leg_to", sense="UTC, at the closing velocity"),
                Field(
                    "bearingOriginToDestinationWaypoint",
                    "leg_from",
                    "bus_leg_direction",
                    FROM_NORTH,
                ),
                Field(
                    "bearingPositionToDestinationWaypoint",
                    "leg_to",
                    "bus_waypoint_bearing",
                    FROM_NORTH,
                ),
                Field("originWaypointNumber", "leg", sense="one less"),
                Field("destinationWaypointNumber", "leg", "bus_waypoint_number"),
                Field("destinationLatitude", "leg_to", "bus_waypoint_n", "WGS 84, north"),
                Field("destinationLongitude", "leg_to", "bus_waypoint_n", "WGS 84, east"),
                Field("waypointClosingVelocity", "velocity_n", "bus_closing_speed"),
            ),
        ),
        Pgn(
            129285,
            "navigationRouteWpInformation",
            "Route and waypoints",
            6,
            5.0,
            (
                Field("startRps", "leg", sense="number of the leg's first waypoint"),
                Field("nitems", sense="2: the ends of the leg"),
                Field("databaseId", sense="0"),
                Field("routeId", sense="0"),
                Field("wpId", "leg"),
                Field("wpName", "leg", sense="WP and the number"),
                Field("wpLatitude", "leg_to", sense="WGS 84, north"),
                Field("wpLongitude", "leg_to", sense="WGS 84, east"),
            ),
        ),
        Pgn(
            129539,
            "gnssDops",
            "GNSS dilutions of precision",
            6,
            1.0,
            (
                SID,
                Field("desiredMode", sense="3, automatic"),
                Field("actualMode", "position_valid", sense="2, three dimensions"),
                Field("hdop", "position_n"),
                Field("vdop", "position_n"),
                Field("tdop", "position_n"),
            ),
        ),
        Pgn(
            129540,
            "gnssSatsInView",
            "GNSS satellites in view",
            6,
            1.0,
            (
                SID,
                Field("satsInView", "position_n", sense="of a nominal GPS constellation"),
                Field("prn", "position_n", sense="1 to 24"),
                Field("elevation", "position_n"),
                Field("azimuth", "position_n", sense=FROM_NORTH),
                Field("snr", "position_n", sense="by the elevation"),
                Field("status", sense="2, used"),
            ),
        ),
        Pgn(
            129794,
            "aisClassAStaticAndVoyageRelatedData",
            "AIS class A static and voyage related data",
            6,
            0.0,
            (
                Field("userId", "ais", sense="MMSI"),
                Field("imoNumber", "ais"),
                Field("name", "ais", "bus_ais_names"),
                *_HULL,
                Field("draft", "ais"),
                Field("destination", "ais"),
                _RECEIVED,
            ),
        ),
        Pgn(
            129809,
            "aisClassBStaticDataMsg24PartA",
            "AIS class B static data, part A",
            6,
            0.0,
            (
                Field("userId", "ais", sense="MMSI"),
                Field("name", "ais", "bus_ais_names"),
                _RECEIVED,
            ),
        ),
        Pgn(
            129810,
            "aisClassBStaticDataMsg24PartB",
            "AIS class B static data, part B",
            6,
            0.0,
            (Field("userId", "ais", sense="MMSI"), *_HULL, _RECEIVED),
        ),
    )
}
"""By number."""
