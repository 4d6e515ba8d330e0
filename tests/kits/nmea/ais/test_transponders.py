"""Transponders on a channel, read by pyais; intervals of Rec. ITU-R M.1371-5, tables 1 and 2."""

import math
from itertools import pairwise

import pymap3d
import pytest

from seatrial.errors import InputError
from seatrial_kits.nmea.ais.reporting import interval_s
from seatrial_kits.nmea.ais.transponder import AisTransponder
from tests.devices.running import started

from .sea import KNOT, Sea

HOME = {"latitude": math.radians(-23.05), "longitude": math.radians(-43.17)}
SHIP = {
    **HOME,
    "ship_name": "Mariner",
    "callsign": "py2x",
    "imo": 9074729.0,
    "ship_type": 70.0,
    "dimensions": [80.0, 70.0, 11.0, 12.0],
    "draught": 7.5,
    "destination": "Rio",
    "date": "2026-03-01T10:20:30Z",
}
MOVING = {"velocity_n": [4.0, -3.0, 0.0], "heading": 1.0, "position_n": [1000.0, 500.0, 0.0]}


def at(north, east):
    found = pymap3d.ned2geodetic(north, east, 0.0, -23.05, -43.17, 0.0)
    return found[0], found[1]


def test_class_a_is_received_as_it_is():
    sea = Sea(a={**SHIP, **MOVING, "rate_of_turn": 0.02, "imu_valid": True, "status": 8}, b=HOME)
    sea.run(30.0)
    when, found = sea.received("b", 1)[-1]
    latitude, longitude = at(1000.0, 500.0)
    assert (found.mmsi, int(found.status), found.second) == (
        710000001,
        8,
        int(30 + when - 0.0267) % 60,
    )
    assert found.lat == pytest.approx(latitude, abs=1e-6)
    assert found.lon == pytest.approx(longitude, abs=1e-6)
    assert found.speed == pytest.approx(5.0 / KNOT, abs=0.051)
    assert found.course == pytest.approx(360.0 - math.degrees(math.atan2(3.0, 4.0)), abs=0.051)
    assert found.heading == 57
    # 68.75 degrees per minute, of which the square root is sent.
    assert found.turn == pytest.approx(math.degrees(0.02) * 60.0, rel=0.02)
    (_, static), *_ = sea.received("b", 5)
    assert (static.shipname, static.callsign, static.imo) == ("MARINER", "PY2X", 9074729)
    assert (static.ship_type, static.draught, static.destination) == (70, 7.5, "RIO")
    sizes = (static.to_bow, static.to_stern, static.to_port, static.to_starboard)
    assert sizes == (80, 70, 11, 12)
    assert (static.month, static.day, static.hour, static.minute) == (0, 0, 24, 60)  # no ETA
    assert sea.ships["b"].get("targets") == 1
    assert sea.ships["b"].get("nearest_mmsi") == 710000001
    assert sea.ships["b"].get("nearest_distance") == pytest.approx(math.hypot(1000, 500), abs=0.3)


@pytest.mark.parametrize(("equipment", "carrier_sense"), [("B-CS", True), ("B-SO", False)])
def test_class_b(equipment, carrier_sense):
    sea = Sea(a={**SHIP, **MOVING, "equipment": equipment}, b=HOME)
    sea.run(45.0)
    _, found = sea.received("b", 18)[-1]
    assert (found.lat, found.lon) == pytest.approx(at(1000.0, 500.0), abs=1e-6)
    assert (found.speed, bool(found.cs)) == (pytest.approx(9.7), carrier_sense)
    one, two = (m for _, m in sea.received("b", 24)[:2])
    assert (one.shipname, two.callsign, two.ship_type, two.to_starboard) == (
        "MARINER",
        "PY2X",
        70,
        12,
    )
    assert sea.received("b", 1) == sea.received("b", 5) == []


def test_what_is_not_valid_is_not_available():
    sea = Sea(a={**SHIP, **MOVING, "position_valid": False, "heading_valid": False}, b=HOME)
    sea.run(200.0)
    _, found = sea.received("b", 1)[-1]
    assert (found.lat, found.lon, found.course) == (91.0, 181.0, 360.0)
    assert (found.speed, found.heading, found.second, found.turn) == (102.3, 511, 60, -128.0)
    assert sea.ships["b"].get("targets") == 0
    assert sea.ships["a"].get("nearest_distance") == -1.0


TABLES = (
    # class, knots, course changes, status, seconds
    *(("A", 0.0, False, 1, 180.0), ("A", 2.9, False, 5, 180.0), ("A", 3.1, False, 1, 10.0)),
    *(("A", 0.0, False, 0, 10.0), ("A", 14.0, False, 0, 10.0), ("A", 10.0, True, 0, 10.0 / 3.0)),
    *(("A", 14.1, False, 0, 6.0), ("A", 22.0, True, 0, 2.0), ("A", 23.1, False, 8, 2.0)),
    *(("B-SO", 2.0, False, 0, 180.0), ("B-SO", 2.1, True, 0, 30.0), ("B-SO", 14.1, False, 0, 15.0)),
    *(("B-SO", 23.1, False, 0, 5.0), ("B-CS", 1.9, False, 0, 180.0), ("B-CS", 30.0, True, 0, 30.0)),
)


@pytest.mark.parametrize(("equipment", "knots", "turning", "status", "seconds"), TABLES)
def test_intervals_are_those_of_the_recommendation(equipment, knots, turning, status, seconds):
    assert interval_s(equipment, knots * KNOT, turning, status) == pytest.approx(seconds)


def between(found):
    times = [t for t, _ in found]
    return [b - a for a, b in pairwise(times)]


@pytest.mark.slow
def test_reports_come_at_their_intervals_within_a_tenth():
    sea = Sea(a={**SHIP, "velocity_n": [8.0, 0.0, 0.0]}, b={**HOME, "equipment": "B-CS"})
    sea.run(900.0)
    gaps = between(sea.received("b", 1))
    assert len(gaps) == pytest.approx(900.0 / 6.0, abs=2)
    assert 0.8 * 6.0 - 0.01 < min(gaps) < max(gaps) < 1.2 * 6.0 + 0.01
    assert len({round(gap, 3) for gap in gaps}) > 100  # and not in step with others'
    assert between(sea.received("b", 5)) == [pytest.approx(360.0)] * 2
    assert len(sea.received("a", 18)) == pytest.approx(5, abs=1)  # at rest: every 3 minutes
    own = [t for t, m in sea.presented("a") if m.msg_type == 1]
    assert len(own) == pytest.approx(900 + 150, abs=3)


def test_a_turn_shortens_the_interval_until_20_s_after_it():
    sea = Sea(a={**SHIP, "velocity_n": [5.0, 0.0, 0.0]}, b=HOME)
    sea.run(100.0)
    for k in range(80):  # 60 degrees in 20 s
        sea.ships["a"].set("heading", math.radians(0.75 * k))
        sea.run(0.25)
    sea.run(180.0)
    found = sea.received("b", 1)
    turning = between([each for each in found if 104.0 < each[0] < 140.0])
    assert max(turning) < 1.2 * 10.0 / 3.0 + 0.01
    # The mean of 30 s has come within 5 degrees at some 150 s; 20 s more.
    assert min(between([each for each in found if each[0] > 180.0])) > 7.9
    assert min(between([each for each in found if each[0] < 100.0])) > 7.9


@pytest.mark.slow
def test_a_lower_speed_counts_after_three_minutes_a_higher_one_at_once():
    sea = Sea(a={**SHIP, "velocity_n": [5.0, 0.0, 0.0]}, b=HOME)
    sea.run(60.0)
    sea.ships["a"].set("velocity_n", [13.0, 0.0, 0.0])  # above 23 knots: every 2 s
    sea.run(60.0)
    sea.ships["a"].set("velocity_n", [5.0, 0.0, 0.0])
    sea.run(300.0)
    found = sea.received("b", 1)
    assert max(between([each for each in found if 60.0 < each[0] < 298.0])) < 2.41
    assert min(between([each for each in found if each[0] > 304.0])) > 7.9


def test_a_silent_transponder_receives_and_is_not_received():
    sea = Sea(a={**SHIP, "silent": True}, b=HOME)
    sea.run(30.0)
    assert not sea.lines["b"] or all(line.startswith(b"!AIVDO") for _, line in sea.lines["b"])
    assert sea.received("a", 1)
    sea.ships["a"].set("silent", False)
    sea.run(30.0)
    assert sea.received("b", 1)


@pytest.mark.slow
def test_a_ship_that_is_not_received_any_more_is_no_target():
    sea = Sea(a={**SHIP}, b=HOME)
    sea.run(30.0)
    sea.ships["a"].set("silent", True)
    sea.run(380.0)
    assert sea.ships["b"].get("targets") == 1
    sea.run(60.0)
    assert sea.ships["b"].get("targets") == 0


def test_a_restored_transponder_goes_on_identically():
    def tail(sea, restored):
        ship = sea.ships["a"]
        if restored:
            state = ship.get_state()
            sea.ships["a"] = started(AisTransponder, **SHIP, mmsi="710000001", position_valid=True)
            sea.ships["a"].set_state(state)
        sea.run(60.0)
        return sea.lines

    seas = [Sea(a=SHIP, b=HOME), Sea(a=SHIP, b=HOME)]
    for sea in seas:
        sea.run(33.0)
    assert tail(seas[0], False) == tail(seas[1], True)


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("mmsi", "12x", "mmsi is '12x'"),
        ("mmsi", "1234567890", "1 to 999999999"),
        ("ship_name", "a" * 21, "name is .*at most 20"),
        ("callsign", "é", "callsign is 'é'"),
        ("dimensions", [600.0, 0.0, 0.0, 0.0], "to_bow is 600.0, 0.0 to 511.0"),
        ("draught", 30.0, "draught is 30.0"),
        ("imo", 1.5, "whole number"),
    ],
)
def test_identities_that_cannot_be(name, value, message):
    with pytest.raises(InputError, match=message):
        started(AisTransponder, **{name: value})
