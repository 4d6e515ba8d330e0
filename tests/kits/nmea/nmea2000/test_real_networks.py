"""Networks as boats have them: magnetic compasses, several sources, messages with gaps."""

import math
import re
from pathlib import Path

import pytest

from seatrial.links.earth_field import earth_field
from seatrial_kits.can.frame import Frame
from seatrial_kits.nmea.nmea2000.codec import Message

from .network import Network

LOGS = Path(__file__).with_name("logs")
LINE = re.compile(r"\(([\d.]+)\) \S+ ([0-9A-F]{8})#([0-9A-F]*)")
GYRO, COMPASS, GNSS, PILOT = 11, 12, 13, 14


def played(name, lasts, **settings):
    """Return the node that has received a log for some seconds, each frame at its time."""
    network = Network({"node": settings})
    network.run(1.0)
    lines = [LINE.match(line).groups() for line in (LOGS / name).read_text().splitlines()]
    begun = float(lines[0][0]) - network.now / 1e9
    for time, identifier, data in lines:
        if float(time) > float(lines[0][0]) + lasts:
            break
        network.run(max(0.0, float(time) - begun - network.now / 1e9))
        network.send(Frame(int(identifier, 16), bytes.fromhex(data), extended=True))
    network.run(0.05)
    return network.nodes["node"]


@pytest.fixture
def network():
    made = Network({"node": {}})
    made.run(1.0)
    return made


def send(network, pgn, address, seconds=0.05, **fields):
    network.send_message(Message(pgn, fields, address))
    network.run(seconds)
    return network.nodes["node"]


def test_a_compass_without_variation_has_that_of_another_node():
    """EV-1: magnetic, no deviation, no variation; 127258 of another node has 0.1 rad east."""
    node = played("magnetic_heading.log", 9.0)
    assert node.get("bus_heading_valid")
    assert node.get("bus_heading") == pytest.approx(2.4, abs=1e-4)
    assert node.get("bus_magnetic_heading") == pytest.approx(2.3, abs=1e-4)
    said = node.get("bus_heading_from")
    assert said == "magnetic 127250 from 204, variation of 127258 from 10"
    counts = dict(each.split() for each in node.get("bus_messages").split("; "))
    for pgn in ("127250", "127258"):
        used, received = counts[pgn].split("/")
        assert used == received != "0"


def test_the_rest_of_that_log_has_an_attitude_without_yaw_and_a_compass_with_variation():
    node = played("magnetic_heading.log", 12.0)
    assert node.get("bus_roll_valid")
    assert node.get("bus_pitch_valid")
    assert not node.get("bus_yaw_valid")
    assert node.get("bus_attitude")[:2] == pytest.approx([-0.02, 0.01], abs=1e-9)
    node = played("magnetic_heading.log", 20.0)
    assert node.get("bus_heading") == pytest.approx(2.4, abs=1e-4)
    assert node.get("bus_heading_from") == "magnetic 127250 from 204, its own variation"


def test_magnetic_orders_are_steered_by_the_variation_of_the_network(network):
    node = played("magnetic_order.log", 1.5, variation=0.05)
    assert node.get("bus_heading_to_steer_valid")
    assert node.get("bus_heading_to_steer") == pytest.approx(1.05, abs=1e-4)
    assert played("magnetic_order.log", 9.0).get("bus_heading_to_steer") == 2.0  # a true one
    # Nothing says what the variation is: there is no heading to steer.
    assert not played("magnetic_order.log", 1.5).get("bus_heading_to_steer_valid")


def test_without_any_variation_the_world_magnetic_model_has_it():
    place = math.radians(63.4), math.radians(10.4)
    network = Network({"node": {"date": "2024-06-01"}})
    network.run(1.0)
    node = send(network, 127250, COMPASS, heading=1.0, reference=1)
    assert not node.get("bus_heading_valid")  # neither a place nor an origin
    assert node.get("bus_magnetic_heading_valid")
    send(network, 129025, GNSS, latitude=63.4, longitude=10.4)
    north, east, _ = earth_field(*place, 0.0, 1717200000.0)
    assert node.get("bus_heading") == pytest.approx(1.0 + math.atan2(east, north), abs=1e-3)
    assert node.get("bus_heading_from").endswith("World Magnetic Model at the position received")
    # The date of the network counts, whatever the run's is.
    send(network, 126992, GNSS, date=16000, time=0.0)
    north, east, _ = earth_field(*place, 0.0, 16000 * 86400.0)
    send(network, 127250, COMPASS, heading=1.0, reference=1)
    assert node.get("bus_heading") == pytest.approx(1.0 + math.atan2(east, north), abs=1e-3)


def test_an_origin_stands_in_for_a_place():
    settings = {"latitude": math.radians(63.4), "longitude": math.radians(10.4)}
    network = Network({"node": settings})
    network.run(1.0)
    node = send(network, 127250, COMPASS, heading=1.0, reference=1)
    assert node.get("bus_heading_valid")
    assert node.get("bus_heading_from").endswith("World Magnetic Model at the origin")


def test_its_own_variation_counts_first(network):
    send(network, 127258, GNSS, variation=0.3)
    node = send(network, 127250, COMPASS, heading=1.0, deviation=0.02, variation=0.1, reference=1)
    assert node.get("bus_heading") == pytest.approx(1.12, abs=1e-4)
    assert node.get("bus_variation") == pytest.approx(0.3, abs=1e-4)


def test_each_angle_of_an_attitude_is_valid_by_itself(network):
    node = send(network, 127257, COMPASS, roll=0.1, pitch=-0.05)
    assert [node.get(f"bus_{name}_valid") for name in ("roll", "pitch", "yaw")] == [1, 1, 0]
    assert node.get("bus_attitude")[:2] == pytest.approx([0.1, -0.05], abs=1e-4)
    assert not node.get("bus_attitude_valid")
    send(network, 127257, COMPASS, yaw=1.0)
    assert not node.get("bus_roll_valid")
    assert node.get("bus_yaw_valid")


def test_speed_without_a_course_and_course_without_a_speed(network):
    node = send(network, 129026, GNSS, sog=2.5)
    assert node.get("bus_speed_over_ground") == pytest.approx(2.5)
    assert not node.get("bus_course_valid")
    assert not node.get("bus_velocity_valid")
    send(network, 129026, GNSS, sog=0.0)  # at rest there is no course
    assert node.get("bus_velocity_valid")
    assert node.get("bus_velocity_n") == pytest.approx([0.0, 0.0, 0.0])
    send(network, 129026, GNSS, cog=1.0, cogReference=0)
    assert node.get("bus_course_valid")
    assert not node.get("bus_speed_over_ground_valid")


def test_a_true_heading_counts_before_a_magnetic_one_unless_the_user_prefers_that():
    for prefer, heading in (("", 2.0), (f"heading {COMPASS} {GYRO}", 1.1)):
        network = Network({"node": {"prefer": prefer}})
        network.run(1.0)
        send(network, 127250, COMPASS, heading=1.0, variation=0.1, reference=1)
        node = send(network, 127250, GYRO, heading=2.0, reference=0)
        assert node.get("bus_heading") == pytest.approx(heading, abs=1e-4)
        assert node.get("bus_magnetic_heading") == pytest.approx(1.0, abs=1e-4)


def test_sources_hand_over_and_the_better_one_takes_over():
    """Without an order the first; with one the better, while it sends."""
    network = Network({"node": {"prefer": f"depth {GYRO} {GNSS}", "timeout": 0.5}})
    network.run(1.0)
    node = send(network, 128267, COMPASS, depth=1.0)
    for source, depth, shown in (
        (GNSS, 2.0, 2.0),  # better than one that is not named
        (COMPASS, 1.5, 2.0),
        (GYRO, 3.0, 3.0),
        (GNSS, 2.5, 3.0),
    ):
        send(network, 128267, source, depth=depth)
        assert node.get("bus_depth") == pytest.approx(shown)
    assert "depth 11" in node.get("bus_sources")
    network.run(3.2)  # three standard intervals of 128267
    assert not node.get("bus_depth_valid")
    send(network, 128267, COMPASS, depth=1.0)
    assert node.get("bus_depth") == pytest.approx(1.0)
    send(network, 128267, GYRO, depth=3.0)
    send(network, 128267, GYRO)  # not available: the next one that sends
    assert not node.get("bus_depth_valid")
    send(network, 128267, GNSS, depth=2.0)
    assert node.get("bus_depth") == pytest.approx(2.0)


def test_senders_that_are_slower_than_the_standard_stay_valid_between_their_messages(network):
    """A position once in 2 s, where the standard has 0.1 s: valid from the third one on."""
    node = network.nodes["node"]
    for _ in range(3):
        send(network, 129025, GNSS, 2.0, latitude=1.0, longitude=2.0)
    for _ in range(4):
        send(network, 129025, GNSS, 1.9, latitude=1.0, longitude=2.0)
        assert node.get("bus_position_valid")
        network.run(0.1)
    network.run(6.5)
    assert not node.get("bus_position_valid")


def test_a_message_that_repeats_what_another_is_about_comes_last(network):
    send(network, 127237, PILOT, vesselHeading=2.0, headingReference=0)
    node = send(network, 128259, PILOT, speedGroundReferenced=3.0)
    assert node.get("bus_heading") == pytest.approx(2.0, abs=1e-4)
    assert node.get("bus_speed_over_ground") == pytest.approx(3.0)
    send(network, 127250, COMPASS, heading=1.0, reference=0)
    send(network, 129026, GNSS, sog=2.0, cog=0.0, cogReference=0)
    send(network, 127237, PILOT, vesselHeading=2.0, headingReference=0)
    send(network, 128259, PILOT, speedGroundReferenced=3.0)
    assert node.get("bus_heading") == pytest.approx(1.0, abs=1e-4)
    assert node.get("bus_speed_over_ground") == pytest.approx(2.0)


@pytest.mark.parametrize("reference", range(5))
def test_winds_by_their_references(network, reference):
    """130306: 5 m/s from 1 rad, by what 1 rad is counted from."""
    send(network, 127250, GYRO, heading=0.5, reference=0)
    send(network, 127258, GYRO, variation=0.2)
    node = send(network, 130306, COMPASS, windSpeed=5.0, windAngle=1.0, reference=reference)
    blows_to = {0: 1.0, 1: 1.2, 3: 1.5}.get(reference)
    assert bool(node.get("bus_true_wind_valid")) == (blows_to is not None)
    if blows_to is not None:
        wind = [-5.0 * math.cos(blows_to), -5.0 * math.sin(blows_to)]
        assert node.get("bus_true_wind") == pytest.approx(wind, abs=2e-3)
    assert bool(node.get("bus_wind_valid")) == (reference == 2)
    assert bool(node.get("bus_water_wind_speed_valid")) == (reference == 4)
    if reference == 4:
        assert node.get("bus_water_wind_angle") == pytest.approx(1.0 - math.pi, abs=1e-4)


def test_a_rudder_that_is_not_named_stands_in_for_the_one_that_is(network):
    """As in recordings of Raymarine: 0 has the angle, 252 of the same node has none."""
    node = send(network, 127245, PILOT, instance=252, position=0.2)
    assert node.get("bus_rudder") == pytest.approx(0.2, abs=1e-4)
    send(network, 127245, COMPASS, instance=0, position=0.1)
    send(network, 127245, COMPASS, instance=252, directionOrder=0)
    send(network, 127245, PILOT, instance=252, position=0.2)
    send(network, 127245, COMPASS, instance=1, position=0.3)
    assert node.get("bus_rudder") == pytest.approx(0.1, abs=1e-4)
    assert node.get("bus_rudder_valid")


def test_engines_navigation_and_surroundings(network):
    send(network, 127488, GNSS, instance=1, speed=1200.0)
    send(network, 127489, GNSS, instance=1, fuelRate=36.0, temperature=350.0, engineLoad=40)
    send(network, 129283, GNSS, xte=-12.5, navigationTerminated=0)
    send(network, 129284, GNSS, distanceToWaypoint=900.0, courseBearingReference=0,
         bearingPositionToDestinationWaypoint=1.0, destinationWaypointNumber=7,
         destinationLatitude=0.001, destinationLongitude=0.002, arrivalCircleEntered=1)  # fmt: skip
    send(network, 130312, GNSS, instance=0, source=0, actualTemperature=290.0)
    send(network, 130316, GNSS, instance=0, source=1, temperature=280.0)
    send(network, 130312, GNSS, instance=0, source=2, actualTemperature=295.0)  # inside
    send(network, 130314, GNSS, instance=0, source=0, pressure=101300.0)
    node = send(network, 130313, GNSS, instance=0, source=1, actualHumidity=55.0)
    assert node.get("bus_engine_speed") == pytest.approx([0, 1200 * math.tau / 60, 0, 0], abs=0.03)
    assert node.get("bus_engine_fuel_rate")[1] == pytest.approx(1e-5, rel=1e-6)  # 36 l/h
    assert list(node.get("bus_engine_load_valid")) == [0, 1, 0, 0]
    assert not any(node.get("bus_engine_voltage_valid"))
    assert node.get("bus_cross_track") == pytest.approx(-12.5)
    assert node.get("bus_waypoint_distance") == pytest.approx(900.0)
    assert node.get("bus_waypoint_bearing") == pytest.approx(1.0, abs=1e-4)
    assert node.get("bus_waypoint_number") == 7
    assert node.get("bus_arrived")
    assert node.get("bus_waypoint_n")[:2] == pytest.approx([110.574, 222.639], rel=1e-4)
    assert node.get("bus_water_temperature") == pytest.approx(290.0)
    assert node.get("bus_air_temperature") == pytest.approx(280.0)
    assert node.get("bus_air_pressure") == pytest.approx(101300.0)
    assert node.get("bus_humidity") == pytest.approx(0.55)
    send(network, 129283, GNSS, xte=-12.5, navigationTerminated=1)
    assert not node.get("bus_cross_track_valid")


@pytest.mark.slow
def test_other_ships(network):
    """Degrees north of the origin: 110574 m each at the equator (WGS 84)."""
    send(network, 129039, GNSS, userId=710000103, latitude=0.02, longitude=0.0, sog=3.0,
         cog=math.pi / 2)  # fmt: skip
    send(network, 129041, GNSS, userId=997100001, latitude=0.01, longitude=0.0, atonName="BUOY")
    send(network, 129809, GNSS, userId=710000103, name="SLOOP")
    send(network, 129810, GNSS, userId=710000103, length=11.0, beam=3.5)
    node = send(network, 129038, GNSS, userId=710000104)  # without a place
    assert node.get("bus_ais_targets") == 2
    assert node.get("bus_ais_mmsi")[:3] == [997100001, 710000103, 0]
    assert node.get("bus_ais_north")[:2] == pytest.approx([1105.74, 2211.49], rel=1e-4)
    assert list(node.get("bus_ais_velocity_valid"))[:2] == [0, 1]
    assert node.get("bus_ais_velocity_east")[1] == pytest.approx(3.0)
    assert node.get("bus_ais_length")[1] == 11.0
    assert node.get("bus_ais_names") == "997100001 BUOY; 710000103 SLOOP"
    network.run(430.0)
    assert node.get("bus_ais_targets") == 0


def test_what_is_not_read_is_counted(network):
    send(network, 127508, GNSS, instance=0, voltage=12.0)
    for _ in range(3):
        network.send(Frame(0x1DEF0A0B, bytes(8), extended=True))  # 126720, proprietary
        network.run(0.05)
    node = send(network, 127251, GNSS)
    assert node.get("bus_others") == "126720 3; 127508 1"
    assert node.get("bus_messages") == "127251 0/1"
