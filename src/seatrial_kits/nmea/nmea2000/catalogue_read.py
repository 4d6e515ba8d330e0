"""Messages that a node reads and does not send; as `catalogue`."""

from __future__ import annotations

from .pgn import FROM_NORTH, SID, Field, Pgn

_WATER_OR_AIR = "source 0, sea, and 1, outside, alone"
_INSTANCE = Field("instance", sense="any")
_SHIP = (
    Field("userId", received="bus_ais_mmsi", sense="MMSI"),
    Field("latitude", received="bus_ais_north", sense="WGS 84, north"),
    Field("longitude", received="bus_ais_east", sense="WGS 84, east"),
)

READ = {
    each.number: each
    for each in (
        Pgn(
            129033,
            "timeDate",
            "Time and date",
            3,
            1.0,
            (Field("date", received="bus_heading", sense="for the World Magnetic Model"),),
        ),
        Pgn(
            129040,
            "aisClassBExtendedPositionReport",
            "AIS class B extended position report",
            4,
            0.0,
            (
                *_SHIP,
                Field("cog", received="bus_ais_velocity_north", sense=FROM_NORTH),
                Field("sog", received="bus_ais_velocity_north"),
                Field("trueHeading", received="bus_ais_heading", sense=FROM_NORTH),
                Field("length", received="bus_ais_length"),
                Field("beam", received="bus_ais_beam"),
                Field("name", received="bus_ais_names"),
            ),
        ),
        Pgn(
            129041,
            "aisAidsToNavigationAtonReport",
            "AIS aid to navigation",
            4,
            0.0,
            (
                *_SHIP,
                Field("lengthDiameter", received="bus_ais_length"),
                Field("beamDiameter", received="bus_ais_beam"),
                Field("atonName", received="bus_ais_names"),
            ),
        ),
        Pgn(
            130310,
            "environmentalParametersObsolete",
            "Environmental parameters (obsolete)",
            5,
            0.5,
            (
                SID,
                Field("waterTemperature", received="bus_water_temperature"),
                Field("outsideAmbientAirTemperature", received="bus_air_temperature"),
                Field("atmosphericPressure", received="bus_air_pressure"),
            ),
        ),
        Pgn(
            130311,
            "environmentalParameters",
            "Environmental parameters",
            5,
            0.5,
            (
                SID,
                Field("temperature", received="bus_water_temperature", sense=_WATER_OR_AIR),
                Field("humidity", received="bus_humidity", sense="source 1, outside, alone"),
                Field("atmosphericPressure", received="bus_air_pressure"),
            ),
        ),
        Pgn(
            130312,
            "temperature",
            "Temperature",
            5,
            2.0,
            (
                SID,
                _INSTANCE,
                Field("actualTemperature", received="bus_water_temperature", sense=_WATER_OR_AIR),
            ),
        ),
        Pgn(
            130313,
            "humidity",
            "Humidity",
            5,
            2.0,
            (
                SID,
                _INSTANCE,
                Field("actualHumidity", received="bus_humidity", sense="source 1, outside, alone"),
            ),
        ),
        Pgn(
            130314,
            "actualPressure",
            "Actual pressure",
            5,
            2.0,
            (
                SID,
                _INSTANCE,
                Field("pressure", received="bus_air_pressure", sense="source 0, atmosphere, alone"),
            ),
        ),
        Pgn(130315, "setPressure", "Set pressure", 5, 0.0, (SID, _INSTANCE)),
        Pgn(
            130316,
            "temperatureExtendedRange",
            "Temperature, extended range",
            5,
            2.0,
            (
                SID,
                _INSTANCE,
                Field("temperature", received="bus_water_temperature", sense=_WATER_OR_AIR),
            ),
        ),
    )
}
"""By number."""
