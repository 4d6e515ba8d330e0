"""Terminals of links, joined by member, against what the shipped rigs connect by hand."""

import pytest

from tests.control.test_terminals import HOLDS, SAILING
from tests.terminals import Terminals

PILOTS = {
    "hydrone": HOLDS,
    "videoray": f"{HOLDS}; guidance.wanted depth_hold.wanted; depth_hold.held helm.held",
    "gloria": SAILING,
}


def bus(nodes: str) -> str:
    return "; ".join(f"{node}.bus can.n{n}" for n, node in enumerate(nodes.split(), 1))


@pytest.mark.parametrize("vehicle", PILOTS)
def test_mavlink_commands_any_pilot(vehicle):
    autopilot = Terminals(f"{vehicle}-mavlink")
    joined = autopilot.joined(PILOTS[vehicle].replace("course.orders", "mavlink.orders"))
    reported = {pair for pair in autopilot.connected() if pair[1].startswith("mavlink.pulse.")}
    # The Hydrone's rig leaves out the depth that guidance has in any case.
    joined -= {("guidance.depth_wanted", "mavlink.nav_depth")} - autopilot.connected()
    assert joined == autopilot.connected() - reported


def test_nmea0183_commands_a_pilot_beside_its_course():
    autopilot = Terminals("gloria-nmea0183")
    others = "instruments.orders guidance.orders; navigation.estimate instruments.estimate"
    assert autopilot.joined(f"{SAILING}; {others}") == autopilot.connected()


def test_nmea2000_has_the_sensors_and_shows_what_is_wanted():
    autopilot = Terminals("hydrone-nmea2000")
    joined = autopilot.joined(
        f"{HOLDS}; pilot.reading guidance.sensors; pilot.reading heading_hold.sensors;"
        f"guidance.wanted pilot.steering;"
        f"{bus('heading_sensor gnss_receiver thrusters pilot plotter sounder')}"
    )
    assert joined == autopilot.connected()


def test_nmea2000_steers_a_ship():
    autopilot = Terminals("mariner-nmea2000")
    joined = autopilot.joined(
        "pilot.wanted reference.wanted; pilot.wanted pilot.steering;"
        "reference.reference autopilot.wanted; pilot.reading autopilot.sensors;"
        + bus("heading_sensor gnss_receiver rudder_controller pilot plotter instruments gateway")
    )
    # Its rudder has the other sign on the bus: a factor, which terminals do not have.
    assert joined == autopilot.connected() - {("autopilot.rudder", "pilot.rudder_order")}


def test_dronecan_has_the_sensors():
    autopilot = Terminals("hydrone-dronecan")
    joined = autopilot.joined(
        f"{HOLDS}; autopilot.reading guidance.sensors; autopilot.reading heading_hold.sensors;"
        f"{bus('autopilot port_esc starboard_esc gnss_node traffic')}"
    )
    # Commands are shares, by a factor of the pulses.
    commands = {pair for pair in autopilot.connected() if pair[1].startswith("autopilot.command")}
    assert joined == autopilot.connected() - commands


@pytest.mark.parametrize(
    ("rig", "terminals"),
    [
        ("videoray-stream", "topside.serial stream.serial"),
        ("videoray-stream-port", "gateway.serial stream.serial"),
        ("videoray-stream-replay", "player.serial stream.serial"),
        ("videoray-sketch", "topside.serial mega.uart0"),
    ],
)
def test_whoever_is_above_joins_the_vehicles_serial_line(rig, terminals):
    line = Terminals(rig)
    assert line.joined(terminals) == line.connected()


def test_a_ground_station_drives_through_the_topside():
    pilot = Terminals("videoray-stream-mavlink")
    joined = pilot.joined(
        "mavlink.deflections topside.deflections; topside.serial stream.serial;"
        "topside.reading mavlink.sensors"
    )
    assert joined == pilot.connected()


def test_pulses_and_failures_are_named_as_in_vehicles():
    mavlink = Terminals("hydrone-mavlink").classes["mavlink"].terminals
    assert mavlink["pulses"].members["ch3"] == "pulse.ch3"
    assert mavlink["failures"].members["motor1"] == "failure.motor1"
    assert mavlink["truth"].members["rates"] == "true_rates"
    mega = Terminals("gloria-sketch").classes["mega"].terminals
    assert mega["pulses"].members["ch3"] == "pulse.s3"
