"""The heading autopilot: law, wrapping, limit, and the loop with the Mariner."""

import math

import numpy as np
import pytest

from seatrial_kits.ships.control.heading_autopilot import HeadingAutopilot
from tests.devices.running import started
from tests.kits.ships.mariner import FEET, T_D, K, L, U, machine, ship

KP, KD = K * FEET, K * FEET * T_D * L / U


def command(**values):
    return started(HeadingAutopilot, **values).get("rudder")


def test_law_of_the_source():
    inputs = {"heading": 0.3, "reference": 0.1, "yaw_rate": 0.002}
    assert command(**inputs) == pytest.approx(KP * 0.2 + KD * 0.002, rel=1e-6)
    inputs["reference_rate"] = 0.005
    assert command(**inputs) == pytest.approx(KP * 0.2 - KD * 0.003, rel=1e-6)


def test_a_ship_too_far_to_starboard_gets_rudder_to_port():
    assert command(heading=0.1) > 0 > command(heading=-0.1)


@pytest.mark.parametrize("turns", [-2, 0, 3])
@pytest.mark.parametrize(
    ("heading", "reference", "error"), [(179, -179, -2), (-179, 179, 2), (10, 350, 20)]
)
def test_error_is_the_shorter_way(heading, reference, error, turns):
    pilot = started(
        HeadingAutopilot,
        heading=math.radians(heading) + turns * math.tau,
        reference=math.radians(reference),
    )
    assert pilot.get("error") == pytest.approx(math.radians(error), abs=1e-12)


def test_command_keeps_the_limit():
    assert command(heading=2.0, rudder_limit=0.5) == 0.5
    assert command(heading=-2.0, rudder_limit=0.5) == -0.5


def test_integral_grows_with_the_error_and_stays_within_the_limit():
    pilot = started(HeadingAutopilot, heading=0.1, integral_gain=0.01)
    pilot.advance(0.0, 10.0)
    assert pilot.get("rudder") == pytest.approx(KP * 0.1 + 0.01 * 0.1 * 10.0, rel=1e-6)
    # Back-calculation: after an hour at the limit the command leaves it within seconds.
    pilot = started(HeadingAutopilot, heading=2.0, integral_gain=0.01)
    pilot.advance(0.0, 3600.0)
    pilot.set("heading", -0.1)
    pilot.advance(3600.0, 1.0)
    assert pilot.get("rudder") < 0.6


def steered(disturbance, stop, reference=0.0, **gains):
    """Return the heading every 0.1 s of the linear Mariner with machine and autopilot."""
    craft, gear = ship("linear", disturbance=disturbance), machine()
    pilot = started(HeadingAutopilot, reference=reference, **gains)
    for component in (craft, gear):
        component.initialise()
        component.begin()
    headings = []
    for k in range(round(stop / 0.1)):
        t = 0.1 * k
        headings.append(craft.get("eta")[2])
        pilot.set("heading", headings[-1])
        pilot.set("yaw_rate", craft.get("nu")[2])
        gear.set("command", pilot.get("rudder"))
        craft.set("rudder", gear.get("angle"))
        for component in (craft, gear, pilot):
            component.advance(t, 0.1)
    return np.array(headings)


DISTURBANCE = (0.01 * U**2 / L, 0.1 * (U / L) ** 2)  # dimensionless: (0.01, 0.1)


@pytest.mark.slow
def test_pd_control_leaves_the_offset_of_the_steady_equations():
    # -inv([[A1, B1], [A3, B2]]) d gives v and delta; the heading is delta / K.
    assert steered(DISTURBANCE, 900.0)[-1] == pytest.approx(0.02729786, abs=2e-8)


@pytest.mark.slow
def test_integral_action_removes_the_offset():
    heading = steered(DISTURBANCE, 1800.0, integral_gain=0.006)
    assert abs(heading[-1]) < 1e-8
    assert np.abs(heading).max() > 0.02


def test_integral_action_recovers_from_a_rudder_at_its_limit():
    heading = steered((0.0, 0.0), 900.0, reference=1.5, integral_gain=0.006, rudder_limit=0.1)
    assert heading.max() < 1.2 * 1.5
    assert heading[-1] == pytest.approx(1.5, abs=0.01)
