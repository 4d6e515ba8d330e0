"""Properties of every device and controller."""

import random

import pytest

from seatrial.component import Component
from seatrial.control.computed_torque import ComputedTorque
from seatrial.control.course import Course
from seatrial.control.depth_hold import DepthHold
from seatrial.control.dynamic_positioning import DynamicPositioning
from seatrial.control.flat_tracking import FlatTracking
from seatrial.control.guidance import Guidance
from seatrial.control.guidance_orders import TARGETS
from seatrial.control.heading_autopilot import HeadingAutopilot
from seatrial.control.heading_hold import HeadingHold
from seatrial.control.helm import Helm
from seatrial.control.nominal_trajectory import NominalTrajectory
from seatrial.control.pulse_allocation import PulseAllocation
from seatrial.control.reference_filter import HeadingReference
from seatrial.control.rudder_helm import RudderHelm
from seatrial.control.sail_control import SailControl
from seatrial.control.sailing_guidance import SailingGuidance
from seatrial.control.sailing_heading_backstepping import SailingHeadingBackstepping
from seatrial.control.sailing_heading_pid import SailingHeadingPid
from seatrial.control.sailing_navigation import SailingNavigation
from seatrial.control.speed_hold import SpeedHold
from seatrial.control.station_keeping import StationKeeping
from seatrial.control.thruster_allocation import ThrusterAllocation
from seatrial.devices.ahrs import Ahrs
from seatrial.devices.anemometer import Anemometer
from seatrial.devices.angle_servo import AngleServo
from seatrial.devices.compass import Compass
from seatrial.devices.depth import Depth
from seatrial.devices.fault import FAULTS
from seatrial.devices.force_actuator import ForceActuator
from seatrial.devices.gnss import Gnss
from seatrial.devices.imu import Imu
from seatrial.devices.linear_thruster import LinearThruster
from seatrial.devices.propulsion import Propulsion
from seatrial.devices.rudder_machine import RudderMachine
from seatrial.devices.servo import Servo
from seatrial.devices.thruster import Thruster
from seatrial.environment.step_disturbance import StepDisturbance
from seatrial.identification.excitation import Excitation
from seatrial.units import unit
from tests.snapshot import changed, snapshot

from .running import run, started

# With settings that bring everything to life.
CLASSES = {
    Excitation: {"rest": 0.1},
    Thruster: {},
    Propulsion: {"direction_1": [1, 0, 0], "position_1": [-0.45, -0.4, 0.15]},
    LinearThruster: {"delay": 0.013, "dead_band": 0.1},
    Servo: {},
    Imu: {"delay": 0.013, "dropout": 0.2},
    Ahrs: {"delay": 0.13, "dropout": 0.2},
    Compass: {"delay": 0.03, "dropout": 0.2},
    Gnss: {"dropout": 0.2, "antenna": [0.2, 0.1, -0.3]},
    Depth: {"dropout": 0.2, "place": [0.2, 0.1, 0.3]},
    RudderMachine: {},
    AngleServo: {},
    Anemometer: {"dropout": 0.2, "place": [0.2, 0.1, -0.9]},
    SailControl: {"roll_limit": "on"},
    SailingHeadingPid: {"rudder_limit": 100.0},
    SailingHeadingBackstepping: {
        "rudder_limit": 100.0,
        "sail_area": 0.9,
        "sail_arm": 0.2,
        "keel_area": 0.07,
        "sail_start": 0.7,
        "Y_vdot": -20.0,
        "N_r": -48.0,
    },
    SailingNavigation: {},
    SailingGuidance: {
        "armed": True,
        "position_valid": True,
        "heading_valid": True,
        "target_valid": True,
        "leg_wait": 0.0,
        "leg_radius": 4.0,
        "leg_circle": 0.0,
        "lookahead": 2.0,
        "acceptance_radius": 2.0,
        "drift_limit": 3.0,
        "capture_radius": 2.0,
        "loiter_radius": 4.0,
        "steerage": 0.1,
        "turn_rate": 1e3,
        "lead": 3.0,
        "wearing_loss": 0.0,
    },
    RudderHelm: {},
    ForceActuator: {"capacity": [2.0, 2.0, 2.0]},
    HeadingAutopilot: {"rudder_limit": 100.0, "integral_gain": 0.1},
    HeadingReference: {},
    DynamicPositioning: {"capacity": [1e12, 1e12, 1e12], "thruster_time_constant": 5.0},
    NominalTrajectory: {"surge_profile": "polynomial", "duration": 1.0},
    FlatTracking: {"surge_profile": "polynomial", "duration": 1.0, "command_limit": 1e9},
    ComputedTorque: {"mass": [8.44, 12.55, 0.133], "command_limit": 1e9},
    DepthHold: {"capacity": 1e12, "rate_limit": 1e9},
    HeadingHold: {"capacity": 1e12, "rate_limit": 1e9},
    ThrusterAllocation: {},
    Guidance: {
        "armed": True,
        "position_valid": True,
        "heading_valid": True,
        "depth_valid": True,
        "depth_control": "on",
        "depth_tolerance": 1.5,
        "staying": "circle",
        "leg_wait": 0.0,
        "acceleration": 1e9,
        "turning_speed": 0.1,
        "leg_radius": 4.0,
    },
    Course: {"count": 3.0, "waypoint_1": [1.0, 2.0, 3.0]},
    SpeedHold: {"capacity": 1e12},
    Helm: {"sway_limit": 3.0, "heave_limit": 4.0},
    PulseAllocation: {},
    StepDisturbance: {"step_size": 1.0, "begin_time": 0.2, "end_time": 0.7},
    StationKeeping: {
        "enabled": True,
        "hold_radius": 2.0,
        "surge_gain": 40.0,
        "surge_limit": 200.0,
        "moment_limit": 100.0,
    },
}
TEXTS = {"fault": ("none", *FAULTS), "target_kind": TARGETS}
SELDOM = {
    SailingGuidance: {
        "wearing": {"leg", "leg_from", "leg_to", "target_heading", "target_speed", "target_valid"},
        "cross_track": {"home", "velocity_n", *(f"target_{x}" for x in ("kind", "valid"))}
        | {"target_position", "target_speed", "target_velocity"},
    },
}
"""What acts after the first instant only, or in too few situations to be met by chance."""
SITUATIONS, MOST_SITUATIONS = 40, 400
"""Random inputs that a component is given, and until all that is declared has acted."""
every = pytest.mark.parametrize("cls", CLASSES, ids=lambda cls: cls.__name__)


def some_value(cls, port, random):
    """Return a value that a component's port could have."""
    if port.type is str:
        return random.choice(cls.modes if port.name == "mode" else TEXTS[port.name])
    if port.type is bool:
        values = [random.random() < 0.7 for _ in range(port.size)]
    elif port.type is int:
        values = [random.randint(0, 3) for _ in range(port.size)]
    elif port.unit == "s":
        values = [random.uniform(1.1e-3, 1.9e-3) for _ in range(port.size)]
    elif random.random() < 0.1:  # some inputs say something by being 0
        values = [0.0] * port.size
    else:
        values = [random.uniform(-3, 3) for _ in range(port.size)]
    return values if port.axes else values[0]


def some_inputs(cls, seed):
    generator = random.Random(seed)
    inputs = [p for p in cls.ports.values() if p.kind == "input"]
    return {p.name: some_value(cls, p, generator) for p in inputs}


def names(cls, kind):
    return [p.name for p in cls.ports.values() if p.kind == kind]


@every
def test_every_unit_is_a_unit(cls):
    for scalar in cls.scalars:
        unit(scalar.unit)


@every
def test_every_port_says_what_it_is(cls):
    assert all(port.description for port in cls.ports.values())


@every
def test_restored_state_goes_on_identically(cls):
    component = started(cls, **CLASSES[cls])
    outputs = names(cls, "output")

    def inputs(t_ms):
        return some_inputs(cls, t_ms)

    run(component, outputs, 433, 1, inputs)
    state, saved = component.get_state(), snapshot(component, cls.transient)
    went_on = run(component, outputs, 1433, 10, inputs, first_ms=433)
    component.set_state(state)
    assert changed(saved, snapshot(component, cls.transient)) == set()
    again = run(component, outputs, 1433, 10, inputs, first_ms=433)
    other = cls(cls.__name__)
    other.set_state(state)
    elsewhere = run(other, outputs, 1433, 10, inputs, first_ms=433)
    assert went_on == again == elsewhere


@every
def test_two_runs_are_identical(cls):
    outputs = names(cls, "output")
    runs = [
        run(started(cls, **CLASSES[cls]), outputs, 1000, 10, lambda t: some_inputs(cls, t))
        for _ in range(2)
    ]
    assert runs[0] == runs[1]


@every
def test_reading_twice_changes_nothing(cls):
    component = started(cls, **CLASSES[cls])
    inputs = some_inputs(cls, 1)
    for name, value in inputs.items():
        component.set(name, value)
    state = component.get_state()
    first = [component.get(name) for name in names(cls, "output")]
    for name, value in inputs.items():
        component.set(name, value)
    assert [component.get(name) for name in names(cls, "output")] == first
    hidden = {k: v for k, v in state.items() if k not in ("values", "_stale")}
    after = component.get_state()
    assert {k: after[k] for k in hidden} == hidden


def ideal(cls):
    """Return settings without delay and dropout: feed-through is as direct as it can be."""
    none = {name: 0.0 for name in ("delay", "dropout") if name in cls.ports}
    return {**CLASSES[cls], **none}


@every
def test_only_declared_inputs_act_at_once(cls):
    declared = {output: set(inputs) for output, inputs in cls.feedthrough.items()}
    found = {output: set(inputs) for output, inputs in SELDOM.get(cls, {}).items()}
    for seed in range(MOST_SITUATIONS):
        if seed >= SITUATIONS and found == declared:
            break
        component: Component = started(cls, **ideal(cls), **some_inputs_but(cls, seed))
        generator = random.Random(1000 + seed)
        before = {name: component.get(name) for name in names(cls, "output")}
        for name in names(cls, "input"):
            old = component.get(name)
            component.set(name, some_value(cls, cls.ports[name], generator))
            for output, value in before.items():
                if component.get(output) != value:
                    found.setdefault(output, set()).add(name)
            component.set(name, old)
    for output, inputs in found.items():
        assert inputs <= declared.get(output, set()), output
    assert found == declared  # and nothing is declared that never acts


def some_inputs_but(cls, seed):
    """Return inputs, apart from those that the settings fix."""
    return {k: v for k, v in some_inputs(cls, seed).items() if k not in CLASSES[cls]}
