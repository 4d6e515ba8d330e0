"""Signs of what the sensors of every shipped vehicle say: at rest, and in a steady turn.

Body axes: x bow, y starboard, z down. The turn is to starboard, of the craft under its own
equations.
"""

import math

import numpy as np
import pytest

from seatrial.fmi.components.index import component_class
from seatrial.system.parameters import load_vehicle
from seatrial.system.profile.profile import load_profile
from tests.craft.references import in_si
from tests.kit import vehicles

from .running import started

G = 9.81
# A camera measures what there is beside the vehicle, tests/kits/sailing/test_camera.py; a log measures
# the water, tests/craft/test_through_water.py.
SECTIONS = {
    vehicle: [
        section
        for section in load_profile(vehicle).sections()
        if section.startswith("sensors.") and section not in ("sensors.camera", "sensors.log")
    ]
    for vehicle in vehicles(
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
    )
}
EACH = [(vehicle, section) for vehicle, sections in SECTIONS.items() for section in sections]
ERRORS = (
    "_noise", "_bias", "_instability", "_resolution", "_scale", "delay", "dropout", "deviation",
    "attitude_time",
)  # fmt: skip
WIND_TO = math.radians(150.0)
REST = {
    "position": [10.0, -20.0, 2.0],
    "attitude": [0.0, 0.0, math.radians(60.0)],
    "velocity": [0.0, 0.0, 0.0],
    "rates": [0.0, 0.0, 0.0],
    "acceleration": [0.0, 0.0, 0.0],
}


def read(vehicle, section, motion, **inputs):
    """Return the outputs of a sensor of the profile, without errors and lever arms."""
    profile = load_profile(vehicle)
    group, _, name = section.partition(".")
    cls = component_class(profile.tables(group)[name]["kind"])
    values = {**profile.parameters(section)}
    values |= {n: 0.0 for n in cls.ports if n.endswith(ERRORS) or n in ("place", "antenna")}
    values |= {"reception": "everywhere"} if "reception" in cls.ports else {}
    values |= {name: motion[name] for name in cls.terminals["motion"].members}
    sensor = started(cls, **values, **{n: v for n, v in inputs.items() if n in cls.ports})
    return {port.name: np.array(sensor.get(port.name)) for port in sensor.measured}


def turn(component, table, duration, part="", **values):
    """Return the motion of a vehicle's craft after ``duration`` s under these values.

    Its parameters are those of the table ``part`` of the file, else of that of its own name.
    """
    vehicle, _, variant = table.partition("/")
    craft = component_class(component)(vehicle)
    entries = load_vehicle(vehicle).parameter_set(part or component, variant or None).values
    for name, value in {**{n: in_si(e) for n, e in entries.items()}, **values}.items():
        craft.set(name, value)
    craft.initialise()
    craft.begin()
    for k in range(round(duration / 0.1)):
        craft.advance(0.1 * k, 0.1)
    return {name: craft.get(name) for name in craft.terminals["motion"].members}


HULLS = {"ship": "thruster-ship", "surface": "videoray-surface"}
TURNS = {
    "hydrone": lambda: turn(
        "marine-craft", "hydrone", 60.0, force_1=[20, 0, 0], moment_1=[0, 0, 3]
    ),
    "videoray": lambda: turn(
        "rov", "videoray", 40.0, force_1=[5, 0, 0.3], moment_1=[0, 0, 0.3], **{"eta_start.z": 2}
    ),
    "otter": lambda: turn("marine-craft", "otter", 60.0, force_1=[60, 0, 0], moment_1=[0, 0, 5]),
    "bluerov2": lambda: turn(
        "rov", "bluerov2", 10.0, force_1=[20, 0, 0], moment_1=[0, 0, 1], **{"eta_start.z": 5}
    ),
    "mariner": lambda: turn("manoeuvring-ship", "mariner", 400.0, rudder=-0.1),
    "kvlcc2": lambda: turn("mmg-ship", "kvlcc2", 400.0, rudder=-0.1, propeller_order=1.0),
    "gloria": lambda: turn("sailboat", "gloria", 1.0, rudder=-0.05, **{"eta_start.psi": 1, "nu_start.u": 1.5}),
    "remus100": lambda: turn(
        "fitted-craft", "remus100", 20.0, "hull", **{"propulsor_order.p1": 0.6, "foil_angle.f1": 0.2, "position_start.z": 5}
    ),
    "glider": lambda: turn(
        "fitted-craft", "glider", 60.0, "hull", ballast_order=[-0.3, 0.2, 0.5] + 5 * [0], **{"position_start.z": 50, "velocity_start.u": 0.3}
    ),
    "wam-v": lambda: turn(
        "fitted-craft", "wam-v", 20.0, "hull", propulsor_order=[0.4, 0.3] + 6 * [0], waterplane_area=3.2, GM_T=19, GM_L=35
    ),
    "supply-ship": lambda: turn(
        "fitted-craft", "supply-ship", 200.0, "hull", propulsor_order=[0, 0, 0.6, 0.5] + 4 * [0], propulsor_angle=[0, 0, -0.4, -0.4] + 4 * [0]
    ),
    "surface": lambda: turn("surface-vessel", "videoray-surface/physical", 60.0, command=[0.02, 0.019]),
    "ship": lambda: turn(
        "thruster-ship", "thruster-ship", 5.0, **{"nu_start.u": 5}, moment_1=1e6
    ),
}  # fmt: skip


@pytest.mark.parametrize(("vehicle", "section"), EACH)
def test_at_rest(vehicle, section):
    air = [math.cos(WIND_TO), math.sin(WIND_TO)]  # abeam: to starboard of a bow at 60 degrees
    for name, value in read(vehicle, section, REST, wind=air).items():
        expected = {
            "position_n": [10.0, -20.0, 2.0],
            "velocity_n": [0.0, 0.0, 0.0],
            "heading": math.radians(60.0),
            "euler": [0.0, 0.0, math.radians(60.0)],
            "roll_pitch": [0.0, 0.0],
            "gyro": [0.0, 0.0, 0.0],
            "accelerometer": [0.0, 0.0, -G],
            "depth": 2.0,
            "speed": 1.0,
            "angle": math.radians(90.0),
        }[name]
        np.testing.assert_allclose(value, expected, atol=1e-12)


@pytest.mark.parametrize(("vehicle", "section"), EACH)
def test_heeled_to_starboard_with_the_bow_up(vehicle, section):
    tilted = {**REST, "attitude": [0.2, 0.1, -1.0]}
    for name, value in read(vehicle, section, tilted).items():
        if name == "accelerometer":  # the support pushes up: forwards, to port
            assert (np.sign(value) == [1, -1, -1]).all()
        elif name in ("roll_pitch", "euler"):
            np.testing.assert_allclose(value[:2], [0.2, 0.1], atol=1e-12)
        if name in ("heading", "euler"):
            assert value.ravel()[-1] == pytest.approx(math.tau - 1.0)


@pytest.mark.parametrize("vehicle", [name for name in TURNS if vehicles(HULLS.get(name, name))])
def test_the_craft_turns_to_starboard(vehicle):
    motion = TURNS[vehicle]()
    (u, v, _), r = motion["velocity"], motion["rates"][2]
    assert u > 0.0
    assert r > 0.0
    # It drifts outwards, but for one that banks and slips inwards.
    assert v < 0.0 or vehicle in ("ship", "glider")
    assert motion["acceleration"][1] > 0.0 or vehicle == "gloria"  # towards the centre


@pytest.mark.parametrize("vehicle", SECTIONS)
def test_in_a_turn_to_starboard(vehicle):
    motion = TURNS[vehicle]()
    phi, theta, psi = motion["attitude"]
    course = psi + math.atan2(motion["velocity"][1], motion["velocity"][0])
    for section in SECTIONS[vehicle]:
        found = read(vehicle, section, motion, wind=[0.0, 0.0])
        if "gyro" in found:
            assert found["gyro"][2] == motion["rates"][2] > 0.0
        if "accelerometer" in found:  # towards the centre, but for what the heel shows of gravity
            up = -G * math.sin(phi) * math.cos(theta)
            sideways = found["accelerometer"][1] - up
            assert sideways == pytest.approx(motion["acceleration"][1], abs=1e-12)
            assert found["accelerometer"][2] < -0.9 * G
        if "velocity_n" in found:
            north, east = found["velocity_n"][:2]
            assert math.cos(math.atan2(east, north) - course) > 0.999
        if "heading" in found:
            assert math.cos(found["heading"] - psi) == pytest.approx(1.0)
        if "depth" in found:
            assert found["depth"] == pytest.approx(max(0.0, motion["position"][2]))
        if "angle" in found:  # the air that it meets blows aft
            assert abs(found["angle"]) > math.pi / 2
