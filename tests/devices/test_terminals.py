"""Terminals of craft, devices and environment: members that meet have the same unit and axes."""

import itertools

import pytest

from seatrial.devices.actuators.force_actuator import ForceActuator
from seatrial.devices.actuators.propulsion import Propulsion
from seatrial.devices.ahrs import Ahrs
from seatrial.devices.anemometer import Anemometer
from seatrial.devices.compass import Compass
from seatrial.devices.ctd import Ctd
from seatrial.devices.depth import Depth
from seatrial.devices.dvl import Dvl
from seatrial.devices.echo_sounder import Altimeter, EchoSounder
from seatrial.devices.gnss import Gnss
from seatrial.devices.imu import Imu
from seatrial.devices.lbl import Lbl
from seatrial.devices.usbl import Usbl
from seatrial.model.component import Component
from seatrial.physics.cable.tether import Tether
from seatrial.physics.craft.manoeuvring_ship import ManoeuvringShip
from seatrial.physics.craft.marine_craft import MarineCraft
from seatrial.physics.craft.rov import Rov
from seatrial.physics.craft.sailboat import Sailboat
from seatrial.physics.craft.surface_vessel import SurfaceVessel
from seatrial.physics.craft.thruster_ship import ThrusterShip
from seatrial.physics.environment.downwash import Downwash
from seatrial.physics.environment.step_disturbance import StepDisturbance
from seatrial.physics.parts.mmg_ship import MmgShip

CRAFT = (MarineCraft, Rov, Sailboat, ManoeuvringShip, MmgShip, ThrusterShip, SurfaceVessel)
SENSORS = (Ahrs, Altimeter, Anemometer, Compass, Ctd, Depth, Dvl, EchoSounder, Gnss, Imu, Lbl, Usbl)


def port_of(cls: type[Component], terminal: str, member: str):
    """Return the port of a member, the first term of one that sums."""
    name = cls.terminals[terminal].members[member].partition(".")[0]
    return cls.ports[name if name in cls.ports else f"{name}_1"]


def meet(giver: type[Component], gives: str, taker: type[Component], takes: str) -> None:
    """Assert that every member of the taker's terminal joins an output to an input."""
    for member in taker.terminals[takes].members:
        a, b = port_of(giver, gives, member), port_of(taker, takes, member)
        assert {a.kind, b.kind} == {"input", "output"}, member
        assert (a.unit, a.axes) == (b.unit, b.axes), member


@pytest.mark.parametrize(("craft", "sensor"), [*itertools.product(CRAFT, (*SENSORS, Downwash))])
def test_every_craft_gives_the_motion_that_sensors_take(craft, sensor):
    meet(craft, "motion", sensor, "motion")


@pytest.mark.parametrize("sensor", SENSORS)
def test_readings_are_outputs_and_say_whether_they_are_valid(sensor):
    members = sensor.terminals["reading"].members
    assert all(port_of(sensor, "reading", member).kind == "output" for member in members)
    assert any(member.endswith("_valid") for member in members)


@pytest.mark.parametrize(
    ("source", "craft"),
    [
        *itertools.product((Propulsion, Downwash), (MarineCraft, Rov)),
        *itertools.product((ForceActuator, StepDisturbance), (ThrusterShip, SurfaceVessel)),
    ],
)
def test_wrenches_meet(source, craft):
    assert craft.terminals["wrench"].rule == "plug"
    meet(source, "wrench", craft, "wrench")


@pytest.mark.parametrize("end", ["top", "bottom"])
@pytest.mark.parametrize("craft", [MarineCraft, Rov])
def test_either_end_of_a_tether_meets_an_attachment(craft, end):
    meet(craft, "attachment", Tether, end)
