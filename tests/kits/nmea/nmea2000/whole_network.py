"""A recording with all that real networks have, and what each of its messages brings to a rig.

`LOG` is text of ``candump -L``. canboat wrote its frames from the fields in `MESSAGES`, which
has them by canboat's names; fast packets of two senders overlap, devices repeat others' values,
send gaps, no fix, PGNs without a reader, and a compass has no variation.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any, NamedTuple

from seatrial.links.geodesy import Origin

LOG = Path(__file__).with_name("logs") / "whole_network.log"
BEGIN, APART, ROUND = 0.5, 0.03, 2.0
"""Times, s: of the first message, between two, and of a round of all."""
ROUNDS = 3
RPM = math.tau / 60.0
LITRES_PER_HOUR = 1e-3 / 3600.0
PILOT, DISPLAY, COMPASS, PLOTTER, ENGINES, GNSS, SECOND_GNSS, AIS, WEATHER, LOGGER = range(10, 20)


class Sent(NamedTuple):
    """A message: PGN, source, canboat's fields, and the values of outputs after it, by name."""

    pgn: int
    source: int
    fields: dict[str, Any]
    brings: dict[str, Any]


def _north_east(latitude: float, longitude: float) -> list[float]:
    return list(Origin(0.0, 0.0, 0.0).position(latitude, longitude, 0.0))[:2]


def _vessel(k: int) -> list[Sent]:
    heading = {"heading": 1.0 + 0.1 * k, "reference": "Magnetic"}
    place = {"latitude": 0.01 + 1e-4 * k, "longitude": -0.02 - 1e-4 * k}
    north, east = _north_east(**place)
    seen = {"position_n.north": north, "position_n.east": east}
    engine = {
        "oilPressure": 300000 + 100 * k, "temperature": 350.25, "alternatorPotential": 14.2,
        "fuelRate": 36.0 + k, "engineLoad": 40 + k,
    }  # fmt: skip
    return [
        Sent(127258, PLOTTER, {"source": "WMM 2020", "variation": 0.05}, {"variation": 0.05}),
        Sent(127250, COMPASS, heading,
             {"magnetic_heading": 1.0 + 0.1 * k, "heading": 1.05 + 0.1 * k}),
        Sent(127245, PILOT, {"instance": 0, "angleOrder": -0.02 * k, "position": 0.01 * k},
             {"rudder": 0.01 * k, "rudder_order": -0.02 * k}),
        Sent(127245, DISPLAY, {"instance": 252, "position": 0.3}, {"rudder": 0.01 * k}),
        Sent(127251, COMPASS, {"rate": 0.015625 * k}, {"rate_of_turn": 0.015625 * k}),
        Sent(127257, COMPASS, {"roll": 0.01 * k, "pitch": -0.02},
             {"attitude.phi": 0.01 * k, "attitude.theta": -0.02, "yaw_valid": 0}),
        Sent(127488, ENGINES, {"instance": "Dual Engine Starboard", "speed": 1200.0 + k},
             {"engine_speed.e2": (1200.0 + k) * RPM, "engine_speed_valid.e1": 0}),
        Sent(127489, ENGINES, {"instance": "Single Engine or Dual Engine Port", **engine},
             {"engine_oil_pressure.e1": 300000.0 + 100 * k, "engine_temperature.e1": 350.25,
              "engine_voltage.e1": 14.2, "engine_fuel_rate.e1": (36.0 + k) * LITRES_PER_HOUR,
              "engine_load.e1": 0.4 + 0.01 * k, "engine_load_valid.e2": 0}),
        Sent(128259, LOGGER, {"speedWaterReferenced": 2.0 + 0.1 * k},
             {"water_speed": 2.0 + 0.1 * k}),
        Sent(128267, LOGGER, {"depth": 10.0 + k, "offset": -0.5},
             {"depth": 10.0 + k, "depth_offset": -0.5}),
        Sent(129025, GNSS, place, seen),
        Sent(129026, GNSS, {"cogReference": "Magnetic", "cog": 2.0 + 0.1 * k, "sog": 3.0},
             {"course": 2.05 + 0.1 * k, "speed_over_ground": 3.0}),
        Sent(129029, GNSS, {**place, "altitude": 4.0 + k, "method": "GNSS fix"},
             {**seen, "position_n.down": -4.0 - k}),
        Sent(129029, SECOND_GNSS, {"latitude": 50.0, "longitude": 4.0, "method": "no GNSS"}, seen),
        Sent(126720, PLOTTER, {"data": "3B 9F 01"}, {}),
    ]  # fmt: skip


def _route(k: int) -> list[Sent]:
    north, east = _north_east(0.02, 0.03)
    to_waypoint = {
        "distanceToWaypoint": 900.0 - k, "courseBearingReference": "True",
        "arrivalCircleEntered": "No", "perpendicularCrossed": "No",
        "bearingOriginToDestinationWaypoint": 0.5, "waypointClosingVelocity": -1.5,
        "bearingPositionToDestinationWaypoint": 1.0 + 0.1 * k, "destinationWaypointNumber": 7,
        "destinationLatitude": 0.02, "destinationLongitude": 0.03,
    }  # fmt: skip
    return [
        Sent(129283, PLOTTER,
             {"xteMode": "Autonomous", "navigationTerminated": "No", "xte": -12.5 + k},
             {"cross_track": -12.5 + k}),
        Sent(129284, PLOTTER, to_waypoint,
             {"waypoint_distance": 900.0 - k, "waypoint_bearing": 1.0 + 0.1 * k,
              "leg_direction": 0.5, "waypoint_number": 7, "closing_speed": -1.5, "arrived": 0,
              "waypoint_n.north": north, "waypoint_n.east": east}),
    ]  # fmt: skip


def _stations(k: int) -> list[Sent]:
    """A buoy and other ships, the nearest to the own place first, as the targets are."""
    moving = {"longitude": -0.02, "cog": 1.0, "sog": 5.0 + k}
    return [
        Sent(129041, AIS, {"userId": 992440004, "latitude": 0.015, "longitude": -0.02,
                           "lengthDiameter": 2.0, "beamDiameter": 2.5, "atonName": "BUOY"},
             {"ais_mmsi.t1": 992440004, "ais_length.t1": 2.0, "ais_beam.t1": 2.5,
              "ais_north.t1": _north_east(0.015, -0.02)[0], "ais_velocity_valid.t1": 0,
              "ais_names": "992440004 BUOY"}),
        Sent(129040, AIS, {"userId": 244000003, "latitude": 0.02, "trueHeading": 2.0,
                           "length": 20.0, "beam": 6.0, "name": "KETCH", **moving},
             {"ais_mmsi.t2": 244000003, "ais_heading.t2": 2.0, "ais_length.t2": 20.0,
              "ais_beam.t2": 6.0, "ais_names": "244000003 KETCH"}),
        Sent(129039, AIS, {"userId": 244000002, "latitude": 0.025, **moving},
             {"ais_mmsi.t3": 244000002, "ais_heading_valid.t3": 0,
              "ais_velocity_east.t3": (5.0 + k) * math.sin(1.0)}),
        Sent(129809, AIS, {"userId": 244000002, "name": "SLOOP"}, {"ais_names": "244000002 SLOOP"}),
        Sent(129810, AIS, {"userId": 244000002, "length": 11.0, "beam": 3.5},
             {"ais_length.t3": 11.0, "ais_beam.t3": 3.5}),
        Sent(129038, AIS, {"userId": 244000001, "latitude": 0.03, "heading": 1.1, **moving},
             {"ais_mmsi.t4": 244000001, "ais_heading.t4": 1.1,
              "ais_east.t4": _north_east(0.03, -0.02)[1],
              "ais_velocity_north.t4": (5.0 + k) * math.cos(1.0)}),
    ]  # fmt: skip


def _surroundings(k: int) -> list[Sent]:
    apparent = {"windSpeed": 8.0 + k, "windAngle": 0.5, "reference": "Apparent"}
    over_ground = {"windSpeed": 6.0, "windAngle": 1.0}
    over_water = {"windSpeed": 7.0, "windAngle": 0.75, "reference": "True (water referenced)"}
    blows_to = 1.0 + math.pi
    wind = {"true_wind.north": 6.0 * math.cos(blows_to), "true_wind.east": 6.0 * math.sin(blows_to)}
    return [
        Sent(130306, WEATHER, apparent, {"wind_speed": 8.0 + k, "wind_angle": 0.5 - math.pi}),
        Sent(130306, WEATHER,
             {**over_ground, "reference": "True (ground referenced to North)"}, wind),
        Sent(130306, WEATHER, over_water,
             {"water_wind_speed": 7.0, "water_wind_angle": 0.75 - math.pi}),
        Sent(130310, WEATHER, {"waterTemperature": 285.0 + k,
             "outsideAmbientAirTemperature": 291.0, "atmosphericPressure": 101300},
             {"water_temperature": 285.0 + k, "air_temperature": 291.0, "air_pressure": 101300.0}),
        Sent(130311, WEATHER,
             {"temperatureSource": "Outside Temperature", "humiditySource": "Outside",
              "temperature": 292.0 + k, "humidity": 50.0, "atmosphericPressure": 101400},
             {"air_temperature": 292.0 + k, "humidity": 0.5, "air_pressure": 101400.0}),
        Sent(130312, WEATHER,
             {"instance": 0, "source": "Sea Temperature", "actualTemperature": 286.0 + k},
             {"water_temperature": 286.0 + k}),
        Sent(130312, WEATHER,
             {"instance": 1, "source": "Engine Room Temperature", "actualTemperature": 320.0},
             {"water_temperature": 286.0 + k, "air_temperature": 292.0 + k}),
        Sent(130313, WEATHER, {"instance": 0, "source": "Outside", "actualHumidity": 55.0},
             {"humidity": 0.55}),
        Sent(130314, WEATHER, {"instance": 0, "source": "Atmospheric", "pressure": 101200.5},
             {"air_pressure": 101200.5}),
        Sent(130315, WEATHER, {"instance": 0, "source": "Hydraulic", "pressure": 7e5 + k},
             {"set_pressure": 7e5 + k}),
        Sent(130316, WEATHER,
             {"instance": 0, "source": "Outside Temperature", "temperature": 293.125 + k},
             {"air_temperature": 293.125 + k}),
        Sent(127508, WEATHER, {"instance": 0, "voltage": 12.5}, {}),
    ]  # fmt: skip


MESSAGES = [
    (BEGIN + ROUND * k + APART * n, sent)
    for k in range(ROUNDS)
    for n, sent in enumerate([*_vessel(k), *_route(k), *_stations(k), *_surroundings(k)])
]
"""All messages with the times of their last frames, s."""
