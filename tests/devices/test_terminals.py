"""Terminals of craft, devices and environment: members that meet have the same unit and axes."""

import itertools

import pytest

from seatrial.model.component import Component
from tests.kit import classes

SIX_DOF = classes("marine-craft", "rov")
PLANAR = classes("thruster-ship", "surface-vessel")
CRAFT = (*SIX_DOF, *PLANAR, *classes("sailboat", "manoeuvring-ship", "mmg-ship"))
SENSORS = classes(
    "ahrs", "altimeter", "anemometer", "compass", "ctd", "depth", "dvl", "echo-sounder", "gnss",
    "imu", "lbl", "usbl",
)  # fmt: skip


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


@pytest.mark.parametrize(
    ("craft", "sensor"), [*itertools.product(CRAFT, (*SENSORS, *classes("downwash")))]
)
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
        *itertools.product(classes("propulsion", "downwash"), SIX_DOF),
        *itertools.product(classes("force-actuator", "step-disturbance"), PLANAR),
    ],
)
def test_wrenches_meet(source, craft):
    assert craft.terminals["wrench"].rule == "plug"
    meet(source, "wrench", craft, "wrench")


@pytest.mark.parametrize("end", ["top", "bottom"])
@pytest.mark.parametrize("craft", SIX_DOF)
@pytest.mark.parametrize("tether", classes("tether"))
def test_either_end_of_a_tether_meets_an_attachment(craft, tether, end):
    meet(craft, "attachment", tether, end)
