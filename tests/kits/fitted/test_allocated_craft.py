"""Allocation and craft agree: parts at what is allocated give the load that was asked for."""

import math

import numpy as np
import pytest

from seatrial.errors import InputError
from seatrial_kits.fitted.allocation.part_allocation import PartAllocation
from tests.devices.running import started
from tests.kits.fitted.fitting import DENSITY, craft, load

HEAVE, PITCH, YAW = 2, 4, 5
SPEED = 1.8
ROLLS = {"rudder": 0.0, "planes": math.pi / 2}
LINEAR = {"area": 0.0133, "lift": 0.7}
FINNED = {"area": 0.0133, "aspect_ratio": 2.5, "crossflow_drag": 0.0, "profile_drag": 0.0}


def tail(kind, **slot):
    """Return parameters of a rudder and stern planes at the tail."""
    values = {"foils": f"{kind} {kind}"}
    for number, roll in enumerate(ROLLS.values(), 1):
        own = {"position": (-0.8, 0.0, 0.0), "roll": roll, "angle_limit": 0.26, **slot}
        values |= {f"foil_{name}_{number}": value for name, value in own.items()}
    return values


def allocated(values, **demand):
    """Return the angles of rudder and planes for moments, at `SPEED`."""
    ports = {name: value for name, value in values.items() if name in PartAllocation.ports}
    found = started(PartAllocation, **ports, axes="pitch yaw", density=DENSITY, **demand)
    return found.get("foil_angle")


@pytest.mark.parametrize(("kind", "slot"), [("linear-fin", LINEAR), ("fin", FINNED)])
@pytest.mark.parametrize(("pitch", "yaw"), [(0.3, 0.0), (0.0, 0.3), (-0.2, -0.3)])
def test_fins_give_the_moments_that_were_asked_for(kind, slot, pitch, yaw):
    values = tail(kind, **slot)
    angles = allocated(values, pitch_moment=pitch, yaw_moment=yaw, speed=SPEED)
    found = load(craft(**values), (SPEED, 0, 0, 0, 0, 0), foil_angle=angles)
    # A fin lifts across the flow, with a drag of second order and no more to its moments.
    np.testing.assert_allclose(found[[PITCH, YAW]], [pitch, yaw], rtol=1e-5, atol=1e-9)


@pytest.mark.parametrize(("kind", "slot"), [("linear-fin", LINEAR), ("fin", FINNED)])
def test_a_positive_rudder_turns_to_starboard_and_positive_planes_dive(kind, slot):
    found = load(
        craft(**tail(kind, **slot)), (SPEED, 0, 0, 0, 0, 0), foil_angle=[0.1, 0.1] + 6 * [0.0]
    )
    assert found[YAW] > 0.0
    assert found[PITCH] < 0.0
    assert found[HEAVE] < 0.0  # the tail is lifted


def test_a_linear_fin_without_a_lift_gives_nothing():
    with pytest.raises(InputError, match=r"foil_lift_1 is 0.0, of a linear-fin: more than 0"):
        allocated(tail("linear-fin"), yaw_moment=0.1, speed=SPEED)
