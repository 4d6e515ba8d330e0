"""Gains that change during a run: they act from then on, and what an integral holds stays."""

import math

import pytest

from seatrial.control.depth_hold import DepthHold
from seatrial.control.heading_hold import HeadingHold
from seatrial.control.rudder_helm import RudderHelm
from seatrial.control.speed_hold import SpeedHold
from seatrial_kits.ships.control.heading_autopilot import HeadingAutopilot
from seatrial_kits.ships.control.reference_filter import HeadingReference
from tests.devices.running import started

LOOPS = {
    HeadingHold: ("heading_wanted", "heading", "yaw_moment", {"capacity": 1e6}, 0.02),
    DepthHold: ("depth_wanted", "depth", "heave", {"capacity": 1e6}, 0.02),
    SpeedHold: ("speed_wanted", "speed", "surge", {"enabled": True, "capacity": 1e6}, 0.02),
    HeadingAutopilot: ("reference", "heading", "rudder", {"integral_gain": 0.01}, -0.02),
}
GAINS = [
    *((HeadingHold, name) for name in ("natural_frequency", "damping_ratio", "integral_pole")),
    *((DepthHold, name) for name in ("natural_frequency", "damping_ratio", "integral_pole")),
    *((SpeedHold, name) for name in ("natural_frequency", "damping_ratio")),
    *((HeadingAutopilot, name) for name in ("proportional_gain", "integral_gain")),
]


def held(cls, loop, seconds=20.0):
    """Return a loop whose integral has grown on a steady error, the error gone since."""
    wanted, _, output, settings, error = loop
    loop = started(cls, **settings)
    for value in (error, 0.0):
        loop.set(wanted, value)
        for _ in range(round(seconds / loop.period)):
            loop.advance(loop.now, loop.period)
    return loop, output


@pytest.mark.parametrize(("cls", "gain"), GAINS)
def test_without_an_error_a_new_gain_changes_nothing(cls, gain):
    unchanged_without_an_error(cls, gain, LOOPS[cls])


def unchanged_without_an_error(cls, gain, settings):
    loop, output = held(cls, settings)
    before = loop.get(output)
    assert abs(before) > 1e-6  # the integral holds something
    loop.set(gain, 2.0 * loop.get(gain))
    assert loop.get(output) == pytest.approx(before, rel=1e-9)
    loop.advance(loop.now, loop.period)
    assert loop.get(output) == pytest.approx(before, rel=1e-9)


@pytest.mark.parametrize(
    ("cls", "gain", "new", "jump"),
    [
        # Kp of each law, its error 0.02: the same for new and old, as the docstrings have it.
        (
            HeadingAutopilot,
            "proportional_gain",
            2.0,
            lambda old: (2.0 - old["proportional_gain"]) * 0.02,
        ),
        (
            SpeedHold,
            "natural_frequency",
            0.8,
            lambda old: (
                2.0 * old["damping_ratio"] * (0.8 - old["natural_frequency"]) * old["mass"] * 0.02
            ),
        ),
        (SpeedHold, "linear_drag", 5.0, lambda old: (5.0 - old["linear_drag"]) * 0.02),
    ],
)
def test_with_an_error_the_output_moves_by_what_the_gain_means(cls, gain, new, jump):
    moves_as_the_gain_means(cls, gain, new, jump, LOOPS[cls])


def moves_as_the_gain_means(cls, gain, new, jump, settings):
    loop, output = held(cls, settings)
    wanted, _, _, _, error = settings
    loop.set(wanted, error)
    before = loop.get(output)
    expected = jump(
        {name: loop.get(name) for name, port in cls.ports.items() if port.kind == "parameter"}
    )
    loop.set(gain, new)
    assert loop.get(output) - before == pytest.approx(expected, rel=1e-6, abs=0.03 * abs(expected))


def test_a_lower_capacity_limits_at_once():
    loop = started(SpeedHold, enabled=True, speed_wanted=10.0)
    loop.set("capacity", 3.0)
    assert loop.get("surge") == 3.0


def test_a_new_reference_frequency_leaves_no_step():
    reference = started(HeadingReference, target=1.0)
    for _ in range(100):
        reference.advance(reference.now, reference.period)
    before = reference.get("heading"), reference.get("rate")
    reference.set("natural_frequency", 0.2)
    assert (reference.get("heading"), reference.get("rate")) == before
    reference.advance(reference.now, reference.period)
    assert abs(reference.get("heading") - before[0]) <= reference.rate_limit * reference.period


def test_engaged_the_reference_begins_where_the_craft_is():
    reference = started(
        HeadingReference, engaged=False, measured_heading=1.0, measured_rate=0.01, target=2.0
    )
    reference.advance(0.0, 0.1)
    assert (reference.get("heading"), reference.get("rate")) == (1.0, 0.01)
    reference.set("engaged", True)
    reference.advance(0.1, 0.1)
    assert reference.get("heading") == pytest.approx(1.002, abs=1e-4)


def test_the_rudder_is_the_autopilots_or_the_persons():
    helm = started(RudderHelm, rudder_limit=0.5, manual=1.0, rudder_held=0.1, engaged=True)
    assert helm.get("rudder") == 0.1
    helm.set("engaged", False)
    assert helm.get("rudder") == -0.5  # to starboard
    helm.set("manual", 3.0)
    assert helm.get("rudder") == -0.5
    helm.set("manual", 0.0)
    assert math.copysign(1.0, helm.get("rudder")) * helm.get("rudder") == 0.0
