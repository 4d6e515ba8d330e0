"""Other ships, the route and satellites as canboat and Signal K's parser read them."""

import math

import pytest

from seatrial_kits.nmea.ais.codec import sentences, to_air
from seatrial_kits.nmea.ais.station import position_report, static_reports
from tests.interop import canboat
from tests.interop.test_nmea0183_signalk import understood
from tests.kits.nmea.nmea0183.bench import DEG, VALID, Bench
from tests.kits.nmea.nmea2000.network import Network
from tests.kits.nmea.nmea2000.test_navigation import HERE, LEG, MOTION, NODE, A, B, at, received

pytestmark = canboat.needed


@pytest.fixture(scope="module")
def found():
    """Canboat's messages of a node with a leg, a battery and two ships, by PGN: the last of each."""
    battery = {"battery_voltage": 15.2, "battery_current": 3.4}
    network = Network({"node": {**NODE, **LEG, **HERE, **battery}})
    network.run(0.5)
    reports = [position_report(A, MOTION), *static_reports(A)]
    reports += [position_report(B, MOTION), *static_reports(B)]
    received(network, *(("VDM", report) for report in reports))
    network.run(5.0)
    messages = canboat.decoded(network.frames)
    assert not any("error" in message for message in messages)
    return {message["pgn"]: message["fields"] for message in messages}


@pytest.mark.parametrize(("pgn", "ship"), [(129038, A), (129039, B)])
def test_canboat_reads_where_ships_are(found, pgn, ship):
    fields = found[pgn]
    assert fields["userId"] == ship.mmsi
    assert (fields["latitude"], fields["longitude"]) == pytest.approx((-23.1, -43.2), abs=1e-6)
    assert fields["sog"] == pytest.approx(6.1, abs=0.03)
    assert fields["cog"] == pytest.approx(2.0, abs=1e-3)
    assert fields["heading"] == pytest.approx(2.1, abs=0.009)
    if pgn == 129038:
        assert fields["navStatus"] == "Under way using engine"
        assert fields["rateOfTurn"] == pytest.approx(-0.01, rel=0.03)
    else:
        assert fields["unitType"] == "CS"


def test_canboat_reads_what_ships_are(found):
    large, name, hull = found[129794], found[129809], found[129810]
    assert (large["name"].strip(), large["callsign"].strip()) == ("EVER LATE", "MABC")
    assert (large["length"], large["beam"], large["draft"]) == pytest.approx((200.0, 31.0, 11.2))
    assert (large["imoNumber"], large["destination"].strip()) == (9074729, "RIO")
    assert name["name"].strip() == "LITTLE"
    assert (hull["callsign"].strip(), hull["typeOfShip"]) == ("MZ1", "Sailing")
    assert hull["length"] == pytest.approx(11.0)


def test_canboat_reads_the_leg(found):
    assert found[129283]["xte"] == pytest.approx(40.0)
    fields = found[129284]
    assert fields["distanceToWaypoint"] == pytest.approx(math.hypot(40.0, 700.0), abs=0.006)
    assert fields["courseBearingReference"] == "True"
    place = fields["destinationLatitude"], fields["destinationLongitude"]
    assert place == pytest.approx(at(0.0, 1000.0), abs=2e-7)
    listed = [(each["wpId"], each["wpName"]) for each in found[129285]["list"]]
    assert listed == [(2, "WP2"), (3, "WP3")]


def test_canboat_reads_satellites_and_the_battery(found):
    view, dops, battery = found[129540], found[129539], found[127508]
    assert view["satsInView"] == len(view["list"]) == found[129029]["numberOfSvs"]
    assert all(5.0 * DEG < each["elevation"] < 90.0 * DEG for each in view["list"])
    assert (dops["desiredMode"], dops["actualMode"]) == ("Auto", "3D")
    assert dops["hdop"] == found[129029]["hdop"]
    assert (battery["voltage"], battery["current"]) == pytest.approx((15.2, -3.4))


def test_signal_k_reads_ships_of_sentences():
    lines = []
    for report in (position_report(A, MOTION), *static_reports(A), position_report(B, MOTION)):
        lines += sentences(to_air(report), "VDM", 4)
    values = understood(lines)["AIVDM"]
    assert values["navigation.position"]["latitude"] == pytest.approx(-23.1, abs=1e-6)
    assert values["navigation.position"]["longitude"] == pytest.approx(-43.2, abs=1e-6)
    assert values["navigation.speedOverGround"] == pytest.approx(6.1, abs=0.03)
    assert values["navigation.courseOverGroundTrue"] == pytest.approx(2.0, abs=1e-3)
    assert values["design.length"]["overall"] == 200
    assert values["navigation.destination.commonName"].strip() == "RIO"


def test_signal_k_reads_the_leg_and_satellites_of_sentences():
    bench = Bench(latitude=-22.862 * DEG, longitude=-43.223 * DEG, date="2018-09-01")
    bench.set(**VALID)
    values = understood(bench.run(0.1))
    assert values["GPGGA"]["navigation.gnss.satellites"] >= 6
    views = values["GPGSV"]["navigation.gnss.satellitesInView"]
    assert views["count"] == values["GPGGA"]["navigation.gnss.satellites"]
    (error,) = (v for path, v in values["AGXTE"].items() if path.endswith("crossTrackError"))
    assert abs(error) == pytest.approx(100.0, abs=1.0)
