"""Turning the world turns the answer: no controller or sensor prefers a heading.

North, east and all headings are turned by an angle and headings wrapped again. Outputs must turn
alike, or stay if they are in body axes, over samples whose inputs jump across north and south.
"""

import math

import pytest

from tests.kit import needs_kits

from .test_every_component import CLASSES, some_inputs

HEADINGS = {
    *("heading", "psi", "course", "reference", "target"),
    *("heading_wanted", "measured_heading", "station_heading", "target_heading", "heading_start"),
    "seabed_direction",
}
ERRORS = (
    *("_noise", "_instability", "_resolution", "_bias", "variation", "deviation"),
    *("dropout", "delay", "multipath"),
)
"""Ends of the names of sensors' errors, which do prefer a heading or keep what was before."""
KNOWN = {"fault": "none", "target_valid": True, "leg": 1}
"""A craft that is sent to where it is has no direction: it is always sent somewhere."""
HALF_CIRCLES = {"course", "heading_wanted"}
"""Headings that are published from -pi to pi."""
PLACES = {
    *("position", "deck_position", "station_position", "first_position", "second_position"),
}
SAMPLES = 40


def headings(port):
    """Return the places of the headings among a port's values."""
    if port.type is not float or port.unit != "rad":
        return []
    return [i for i, axis in enumerate(port.axes or (port.name,)) if axis in HEADINGS]


def is_horizontal(port):
    """Say if a port's first two values are north and east."""
    axes = tuple((port.axes or ())[:2])
    return axes == ("north", "east") or (port.name in PLACES and axes == ("x", "y"))


def turned(port, value, angle):
    values = list(value) if port.axes else [value]
    if is_horizontal(port):
        c, s = math.cos(angle), math.sin(angle)
        values[:2] = c * values[0] - s * values[1], s * values[0] + c * values[1]
    for i in headings(port):
        values[i] = math.remainder(values[i] + angle, math.tau)
    return values if port.axes else values[0]


def ports(cls, kind):
    return [port for port in cls.ports.values() if port.kind == kind]


WITH_HEADING = [cls for cls in CLASSES if any(map(headings, ports(cls, "input")))]


def answers(cls, angle, seed):
    """Return the outputs of each sample in a world turned by ``angle``."""
    settings = dict(cls.exercised)
    for port in ports(cls, "parameter"):
        if port.name.endswith(ERRORS) and not (port.limit("min", 0) or 0.0) > 0.0:
            settings[port.name] = [0.0] * port.size if port.axes else 0.0
        elif headings(port):
            settings[port.name] = turned(port, 1.0, angle)
        elif port.name.startswith("transponder_"):
            settings[port.name] = turned(port, settings.get(port.name, port.start), angle)
    component, rows = cls(cls.__name__), []
    for name, value in {**settings, **some_turned(cls, angle, 1000 * seed)}.items():
        component.set(name, value)
    component.initialise()
    component.begin()
    period = getattr(component, "period", 0.1)
    for k in range(SAMPLES):
        for name, value in some_turned(cls, angle, 1000 * seed + k // 3).items():
            component.set(name, value)
        rows.append([component.get(port.name) for port in ports(cls, "output")])
        component.advance(k * period, period)
    return rows


def some_turned(cls, angle, seed):
    """Return inputs as they are in a world turned by ``angle``."""
    values = {**some_inputs(cls, seed), **cls.exercised}
    values |= {name: value for name, value in KNOWN.items() if name in values}
    if values.get("mode") in ("hold", "loiter", "surface"):
        values["mode"] = "return"
    for port in ports(cls, "input"):
        value = values[port.name]
        if is_horizontal(port) and not any(value):  # no direction at all is none to turn
            value = [1.0 + port.offset, 2.0, 3.0][: port.size]
        values[port.name] = turned(port, value, angle)
    return {port.name: values[port.name] for port in ports(cls, "input")}


def difference(port, one, other):
    """Return how far two values of a port are apart, headings by the shorter way."""
    if port.type is not float:
        return 0.0 if one == other else math.inf
    pairs = list(zip(one, other, strict=True)) if port.axes else [(one, other)]
    off = [abs(a - b) / max(1.0, abs(a), abs(b)) for a, b in pairs]
    for i in headings(port):
        off[i] = abs(math.remainder(pairs[i][0] - pairs[i][1], math.tau))
    return max(off)


@needs_kits("sailing", "ships", "underwater")
def test_all_with_a_heading_are_here():
    names = {cls.__name__ for cls in WITH_HEADING}
    assert names >= {
        *("Ahrs", "Anemometer", "Compass", "Gnss", "SailControl", "SailingGuidance"),
        *("SailingHeadingPid", "SailingHeadingBackstepping", "SailingNavigation", "Guidance"),
        *("DynamicPositioning", "HeadingAutopilot", "HeadingReference", "HeadingHold"),
        *("StationKeeping", "Dvl", "Usbl"),
    }


@pytest.mark.sampled(3)
@pytest.mark.parametrize("cls", WITH_HEADING, ids=lambda cls: cls.__name__)
@pytest.mark.parametrize("angle", [0.7, math.pi / 2, -2.5])
def test_turning_the_world_turns_the_answer(cls, angle):
    outputs = ports(cls, "output")
    for seed in range(3):
        here, there = answers(cls, 0.0, seed), answers(cls, angle, seed)
        assert any(row != here[0] for row in here)
        for k, (row, other) in enumerate(zip(here, there, strict=True)):
            for port, value, found in zip(outputs, row, other, strict=True):
                expected = turned(port, value, angle)
                assert difference(port, expected, found) < 1e-9, (port.name, k, expected, found)
                if port.name in HALF_CIRCLES:
                    assert -math.pi <= found <= math.pi, (port.name, k, found)
