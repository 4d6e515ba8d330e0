"""Properties of every device and controller."""

import random

import pytest

from seatrial.control.guidance_orders import TARGETS
from seatrial.fmi.components.source import shipped_sources
from seatrial.fmi.dependencies.found import feedthrough_of
from seatrial.model.component import Component
from seatrial.model.faults.catalogue import FAILURES as FAULTS
from seatrial.model.units import unit
from tests.snapshot import changed, snapshot

from .running import run, started

PLACES = (
    *("seatrial.control.", "seatrial.devices."),
    *(f"seatrial_kits.fitted.{name}." for name in ("allocation", "control")),
    *(f"seatrial_kits.sailing.{name}" for name in ("camera", "control.", "stepper")),
    *(f"seatrial_kits.ships.{name}." for name in ("control", "devices")),
    *(f"seatrial_kits.underwater.{name}" for name in ("ctd", "dvl", "echo_sounder", "lbl")),
    *(f"seatrial_kits.underwater.{name}" for name in ("scanning_sonar", "usbl")),
    *(f"seatrial_kits.videoray.{name}" for name in ("tracking.", "vessel.linear_thruster")),
    "seatrial_kits.videoray.vessel.thruster_allocation",
)
"""Where control and devices are, in the core and in kits."""
CLASSES = [
    source.component_class()
    for source in shipped_sources().values()
    if source.module.startswith(PLACES)
]
"""Those of the index; each declares the values that bring everything in it to life."""
TEXTS = {"fault": ("none", *FAULTS), "target_kind": TARGETS}
SELDOM = {
    "Mooring": {"force": {"point", "velocity"}},  # from its first step on
    "SailingGuidance": {
        "wearing": {"leg", "leg_from", "leg_speed", "leg_to"}
        | {"target_heading", "target_speed", "target_valid"},
        "cross_track": {"home", "velocity_n", *(f"target_{x}" for x in ("kind", "valid"))}
        | {"target_position", "target_speed", "target_velocity", "leg_speed"},
        "state": {"leg_speed"},
    },
    "VelocityFilter": {
        "nu": {"depth", "depth_valid"},
        "deviation": {"imu_valid", "depth", "depth_valid"},
        "heading": {"imu_valid", "depth", "depth_valid"},
    },
}
"""What acts after the first instant only, or in too few situations to be met by chance."""
SITUATIONS, MOST_SITUATIONS = 40, 400
"""Random inputs that a component is given, and until all that is known to act has acted."""
every = pytest.mark.parametrize("cls", CLASSES, ids=lambda cls: cls.__name__)


def texts(port):
    if port == "telegraph":
        from seatrial_kits.ships.devices.marine_engine import ORDERS

        return ORDERS
    return TEXTS[port]


def some_value(cls, port, random):
    """Return a value that a component's port could have."""
    if port.type is str:
        return random.choice(cls.modes if port.name == "mode" else texts(port.name))
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
    component = started(cls, **cls.exercised)
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
        run(started(cls, **cls.exercised), outputs, 1000, 10, lambda t: some_inputs(cls, t))
        for _ in range(2)
    ]
    assert runs[0] == runs[1]


@every
def test_reading_twice_changes_nothing(cls):
    component = started(cls, **cls.exercised)
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
    return {**cls.exercised, **none}


@pytest.mark.sampled(9)
@every
def test_what_acts_at_once_is_known(cls):
    through = feedthrough_of(cls)
    known = {output: set(inputs) for output, inputs in through.items() if inputs}
    found = {output: set(inputs) for output, inputs in SELDOM.get(cls.__name__, {}).items()}
    for seed in range(MOST_SITUATIONS):
        if seed >= SITUATIONS and found == known:
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
        assert inputs <= known.get(output, set()), output
    assert found == known  # and nothing is taken to act that never does


def some_inputs_but(cls, seed):
    """Return inputs, apart from those that the settings fix."""
    return {k: v for k, v in some_inputs(cls, seed).items() if k not in cls.exercised}
