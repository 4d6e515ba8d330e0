"""Routes, satellites, batteries and other ships on NMEA 2000, read with the package's decoder."""

import math

import pyais
import pymap3d
import pytest

from seatrial.links.text import Outbox
from seatrial_kits.nmea.ais.codec import sentences, to_air
from seatrial_kits.nmea.ais.station import Identity, Motion, position_report, static_reports

from .network import Network

ORIGIN = (-23.05, -43.17)
NODE = {
    "sends": "127508 129029 129038 129039 129283 129284 129285 129539 129540 129794 129809 129810",
    "latitude": math.radians(ORIGIN[0]),
    "longitude": math.radians(ORIGIN[1]),
    "date": "2026-03-01T12:00:00Z",
}
LEG = {"leg": 3, "leg_from": [0.0, 0.0, 0.0], "leg_to": [0.0, 1000.0, 0.0], "leg_radius": 30.0}
HERE = {"position_n": [-40.0, 300.0, 0.0], "velocity_n": [0.0, 2.0, 0.0]}


def at(north, east):
    return pymap3d.ned2geodetic(north, east, 0.0, *ORIGIN, 0.0)[:2]


def settled(**values):
    network = Network({"node": {**NODE, **values}})
    network.run(0.5)
    return network


def last(network, pgn):
    return network.sent(pgn)[-1]


def test_a_leg_is_on_the_bus():
    network = settled(**LEG, **HERE)
    network.run(5.5)
    error = last(network, 129283).fields
    assert (error["xte"], error["navigationTerminated"]) == (pytest.approx(40.0), 0)  # to the south
    found = last(network, 129284).fields
    assert found["distanceToWaypoint"] == pytest.approx(math.hypot(40.0, 700.0), abs=0.006)
    assert found["bearingOriginToDestinationWaypoint"] == pytest.approx(math.pi / 2, abs=1e-4)
    bearing = math.atan2(700.0, 40.0)
    assert found["bearingPositionToDestinationWaypoint"] == pytest.approx(bearing, abs=1e-4)
    closing = 2.0 * math.sin(bearing)
    assert found["waypointClosingVelocity"] == pytest.approx(closing, abs=0.006)
    assert (found["originWaypointNumber"], found["destinationWaypointNumber"]) == (2, 3)
    assert (found["perpendicularCrossed"], found["arrivalCircleEntered"]) == (0, 0)
    place = found["destinationLatitude"], found["destinationLongitude"]
    assert place == pytest.approx(at(0.0, 1000.0), abs=2e-7)
    seconds = math.hypot(40.0, 700.0) / closing
    assert found["etaTime"] == pytest.approx(12 * 3600 + network.now / 1e9 + seconds, abs=1.1)
    assert found["etaDate"] == 20513  # days since 1970
    route = last(network, 129285)
    assert [(item["wpId"], item["wpName"]) for item in route.items] == [(2, "WP2"), (3, "WP3")]
    places = [(item["wpLatitude"], item["wpLongitude"]) for item in route.items]
    assert places[0] == pytest.approx(at(0.0, 0.0), abs=2e-7)
    assert places[1] == pytest.approx(at(0.0, 1000.0), abs=2e-7)
    network.nodes["node"].set("position_n", [10.0, 1005.0, 0.0])
    network.run(1.1)
    found = last(network, 129284).fields
    assert (found["perpendicularCrossed"], found["arrivalCircleEntered"]) == (1, 1)
    assert found["etaTime"] is None  # it goes away
    assert last(network, 129283).fields["xte"] == pytest.approx(-10.0)


def test_a_plotter_goes_by_the_position_of_the_bus():
    receiver = {**NODE, **HERE, "sends": "129025 129026", "address": 11.0}
    network = Network({"plotter": {**NODE, **LEG, "sends": "129283"}, "receiver": receiver})
    network.run(3.0)
    assert last(network, 129283).fields["xte"] == pytest.approx(40.0, abs=0.03)


def test_without_a_leg_there_is_none():
    network = settled(**HERE)
    network.run(6.0)
    error = last(network, 129283).fields
    assert (error["xte"], error["navigationTerminated"]) == (None, 1)
    assert last(network, 129284).fields["distanceToWaypoint"] is None
    assert network.sent(129285) == network.sent(127508) == []


def test_satellites_go_with_the_position():
    network = settled(**HERE)
    network.run(1.6)
    view, dops, fix = (last(network, pgn) for pgn in (129540, 129539, 129029))
    assert 6 <= view.fields["satsInView"] == len(view.items) == fix.fields["numberOfSvs"] <= 12
    assert all(
        0.08 < item["elevation"] < 1.58 and 0.0 <= item["azimuth"] < 6.2832 for item in view.items
    )
    assert fix.fields["hdop"] == dops.fields["hdop"]
    assert fix.fields["pdop"] == pytest.approx(
        math.hypot(fix.fields["hdop"], dops.fields["vdop"]), abs=0.011
    )
    assert dops.fields["actualMode"] == 2  # canboat: 3D
    network.nodes["node"].set("position_valid", False)  # under water
    network.run(1.1)
    view, dops, fix = (last(network, pgn) for pgn in (129540, 129539, 129029))
    assert view.fields["satsInView"] == fix.fields["numberOfSvs"] == 0
    assert (dops.fields["hdop"], dops.fields["actualMode"]) == (None, 7)  # all ones


def test_a_battery():
    network = settled(battery_voltage=15.2, battery_current=3.4, battery_instance=2.0)
    network.run(1.6)
    found = last(network, 127508).fields
    assert (found["instance"], found["temperature"]) == (2, None)
    assert found["voltage"] == pytest.approx(15.2)
    assert found["current"] == pytest.approx(-3.4)  # it discharges


A = Identity(235009802, "A", "EVER LATE", "MABC", 9074729, 71, 120.0, 80.0, 16.0, 15.0, 11.2, "RIO")
B = Identity(235009803, "B-CS", "LITTLE", "MZ1", 0, 36, 5.0, 6.0, 2.0, 2.0)
MOTION = Motion(17, (-23.1, -43.2), 6.1, 2.0, 2.1, -0.01, 0)


def received(network, *reports):
    box = Outbox({})
    for number, (kind, report) in enumerate(reports):
        for line in sentences(to_air(report), kind, number):
            box.put(network.now, line)
    network.nodes["node"].set("ais", box.flush())
    network.run(0.5)


def test_ships_that_are_received_are_on_the_bus():
    network = settled()
    one, two = static_reports(B)
    reports = [position_report(A, MOTION), *static_reports(A), position_report(B, MOTION), one, two]
    received(network, *(("VDM", report) for report in reports), ("VDO", position_report(A, MOTION)))
    moving, small = last(network, 129038).fields, last(network, 129039).fields
    assert len(network.sent(129038)) == 1  # not the own one
    for found, mmsi in ((moving, A.mmsi), (small, B.mmsi)):
        assert (found["userId"], found["timeStamp"]) == (mmsi, 17)
        place = found["latitude"], found["longitude"]
        assert place == pytest.approx((-23.1, -43.2), abs=1e-6)
        assert found["sog"] == pytest.approx(6.1, abs=0.03)
        assert found["cog"] == pytest.approx(2.0, abs=1e-3)
        assert found["heading"] == pytest.approx(2.1, abs=0.009)
    assert moving["rateOfTurn"] == pytest.approx(-0.01, rel=0.03)
    assert (moving["navStatus"], small["unitType"]) == (0, 1)
    static = last(network, 129794).fields
    assert (static["name"].strip(), static["callsign"].strip()) == ("EVER LATE", "MABC")
    assert (static["imoNumber"], static["typeOfShip"]) == (9074729, 71)
    assert (static["length"], static["beam"], static["draft"]) == pytest.approx((200.0, 31.0, 11.2))
    assert static["positionReferenceFromBow"] == pytest.approx(120.0)
    assert static["destination"].strip() == "RIO"
    assert last(network, 129809).fields["name"].strip() == "LITTLE"
    hull = last(network, 129810).fields
    assert (hull["callsign"].strip(), hull["typeOfShip"]) == ("MZ1", 36)
    assert hull["length"] == pytest.approx(11.0)


def test_what_a_ship_does_not_say_is_not_available():
    network = settled()
    received(
        network, ("VDM", position_report(A, Motion(5))), ("VDM", position_report(B, Motion(5)))
    )
    for pgn in (129038, 129039):
        found = last(network, pgn).fields
        for name in ("latitude", "longitude", "cog", "sog", "heading"):
            assert found[name] is None, name
    assert last(network, 129038).fields["rateOfTurn"] is None


def test_broken_sentences_are_passed_over():
    network = settled()
    line = pyais.encode_dict(position_report(A, MOTION), sentence_type="VDM")[0].encode()
    parts = sentences(to_air(static_reports(A)[0]), "VDM", 3)
    box = Outbox({})
    for data in (
        line[:-1] + b"0",
        b"!AIVDM,1,1,,A,\xff,0*00",
        b"$GPRMC,,*00",
        b"",
        *parts[1:],
        parts[0],
    ):
        box.put(network.now, data)
    network.nodes["node"].set("ais", box.flush())
    network.run(0.3)
    assert network.sent(129038) == network.sent(129794) == []
