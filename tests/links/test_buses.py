"""Shipped buses and feeds: for which vehicles, and what crosses them."""

import pytest

from seatrial.shipped import provided_folders
from seatrial.system.assembling.assembly import assemble
from seatrial.system.files import read_toml
from seatrial.system.flattening import load_rig
from tests.kit import needs_kits

pytestmark = needs_kits("can", "fitted", "nmea", "sailing", "ships", "videoray")

RIGS = [p for folder in provided_folders("harness/rigs") for p in sorted(folder.rglob("*.toml"))]


def feeders(rig, **choices):
    """Return by input the output that feeds it."""
    system = assemble(load_rig(rig, None, choices), "direct")
    pairs = {".".join(each.target): ".".join(each.source) for each in system.connections}
    system.free()
    return pairs


@pytest.mark.parametrize(
    "vehicle",
    [
        "hydrone",
        "videoray",
        "gloria",
        "mariner",
        "kvlcc2",
        "otter",
        "bluerov2",
        "remus100",
        "glider",
        "wam-v",
        "supply-ship",
    ],
)
def test_a_plotter_follows_and_commands_every_vehicle(vehicle):
    fed = feeders("sil", vehicle=vehicle, autopilot="nmea0183", step="100 ms")
    feed, guidance = "autopilot.instruments", "autopilot.pilot.guidance"
    assert fed[f"{feed}.heading"] == fed[f"{guidance}.heading"]
    assert fed[f"{feed}.position_n.north"] == "vehicle.{}.position_n.north".format(
        "positioning" if vehicle in ("videoray", "bluerov2", "remus100", "glider") else "gnss"
    )
    assert fed[f"{guidance}.target_heading"] == f"{feed}.target_heading"
    assert fed[f"{guidance}.leg"] == "autopilot.course.leg"
    rudders = {
        "gloria": "vehicle.servos.rudder.angle",
        **dict.fromkeys(("mariner", "kvlcc2"), "vehicle.machine.angle"),
    }
    assert fed.get(f"{feed}.rudder") == rudders.get(vehicle)


def test_the_true_wind_of_a_feed_is_the_pilots_and_valid_with_the_anemometer():
    fed = feeders("sil", vehicle="gloria", autopilot="nmea0183", step="20 ms")
    feed = "autopilot.instruments"
    assert fed[f"{feed}.true_wind.north"] == "autopilot.pilot.navigation.wind.north"
    assert fed[f"{feed}.true_wind_valid"] == fed[f"{feed}.wind_valid"] == "vehicle.anemometer.valid"


@pytest.mark.parametrize(
    ("vehicle", "step"), [("hydrone", "10 ms"), ("mariner", "100 ms"), ("otter", "10 ms")]
)
def test_a_pilot_on_nmea2000_knows_what_its_node_has_received(vehicle, step):
    bus_step = step if vehicle == "mariner" else "20 ms"
    choices = {"vehicle": vehicle, "autopilot": "nmea2000", "step": step, "bus_step": bus_step}
    fed = feeders("sil", **choices)
    node, guidance = "autopilot.node", "autopilot.pilot.guidance"
    for name in ("heading", "heading_valid", "position_n.north", "velocity_n.east"):
        assert fed[f"{guidance}.{name}"] == f"{node}.bus_{name}"
    assert fed[f"{node}.heading_to_steer"] == f"{guidance}.heading_wanted"
    sensor = "autopilot.heading_sensor"
    assert fed[f"{sensor}.heading"] == fed[f"{sensor}.attitude.psi"] == "vehicle.compass.heading"
    assert fed[f"{sensor}.attitude.theta"] == "vehicle.imu.roll_pitch.theta"
    assert fed["autopilot.gnss_receiver.position_n.east"] == "vehicle.gnss.position_n.east"


def test_actuators_on_a_bus_answer_what_they_do():
    fed = feeders("sil", autopilot="hydrone-can")
    assert fed["vehicle.port_thruster.pulse"] == "autopilot.port_node.received.s1"
    assert fed["autopilot.starboard_node.send.s1"] == "vehicle.starboard_thruster.current"
    fed = feeders("sil", vehicle="gloria", servos="can", step="20 ms")
    assert fed["vehicle.servos.servos.sail.command"] == "vehicle.servos.board.received.s2"
    assert fed["vehicle.servos.board.send.s3"] == "vehicle.servos.servos.flap.angle"
    fed = feeders("hydrone-dronecan")
    assert fed["bus.port_esc.speed.c1"] == "vehicle.port_thruster.speed"
    assert fed["node.command.c2"] == "starboard.share"
    assert fed["bus.gnss_node.acceleration.z"] == "vehicle.imu.accelerometer.z"
    assert fed["bus.gnss_node.rates.r"] == "vehicle.imu.gyro.z"


@pytest.mark.parametrize("path", RIGS, ids=lambda path: path.stem)
def test_no_shipped_rig_changes_values_on_connections(path):
    """Signs and units are the components' own."""
    content, _ = read_toml(path)
    for written in content.get("connections", {}).values():
        for end in written if isinstance(written, list) else [written]:
            assert isinstance(end, str)
