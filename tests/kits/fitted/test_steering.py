"""Two outboards on one steering angle: wrench in closed form, lag and rate, and what is refused."""

import math

import numpy as np
import pytest

from seatrial.errors import InputError
from tests.kits.fitted.fitting import craft, padded

PAIR = {
    "propulsors": "outboard outboard",
    "propulsor_position_1": (-2.0, -0.8, 0.1),
    "propulsor_position_2": (-2.0, 0.8, 0.1),
    "propulsor_thrust_1": (200.0, 100.0),
    "propulsor_thrust_2": (200.0, 100.0),
    "propulsor_angle_limit_1": (-0.6, 0.6),
    "propulsor_angle_rate_1": 0.2,
    "propulsor_turns_with_2": 1,
}


def test_both_push_at_the_angle_of_the_first():
    part, bare = craft(**PAIR), craft()
    state = np.zeros(44)
    state[2], state[20] = 5.0, 0.35  # lagged_angle.p1
    part.set("propulsor_order", padded(0.5, 0.25))
    part.set("propulsor_angle", padded(0.35, -0.6))  # the order of the second is not read
    ways = part.derivatives(state)[6:12] - bare.derivatives(state)[6:12]
    found = part.mass_matrix() @ ways
    c, s = math.cos(0.35), math.sin(0.35)
    yaw = -2.0 * s * (100 + 50) + 0.8 * c * (100 - 50)
    np.testing.assert_allclose(found[[0, 1, 5]], [150 * c, 150 * s, yaw], rtol=1e-9)


def test_rate_and_range_are_those_of_the_first():
    part = craft(**PAIR)
    part.set("propulsor_angle", padded(2.0, 0.1))
    part.initialise()
    part.begin()
    for k in range(50):
        assert part.get("propulsor_turned")[:2] == pytest.approx(2 * [min(0.02 * k, 0.6)], abs=2e-3)
        part.advance(0.1 * k, 0.1)
    one, two = part.get("propulsor_turned")[:2]
    assert one == two == pytest.approx(0.6, abs=1e-6)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"propulsor_turns_with_2": 3}, r"turns_with_2 is 3.0: 0 for none, or .* 1 to 2"),
        ({"propulsor_turns_with_2": 0.5}, r"turns_with_2 is 0.5: 0 for none, or .* 1 to 2"),
        ({"propulsor_turns_with_2": 2}, "no angle of its own"),
        ({"propulsor_turns_with_1": 2}, "no angle of its own"),
        ({"propulsor_angle_limit_1": (0, 0)}, "no angle of its own"),
        ({"propulsor_angle_limit_2": (-0.5, 0.5)}, "angle_limit_2 of -0.5 to 0.5 rad is not read"),
    ],
)
def test_a_steering_that_cannot_be_is_refused(changes, message):
    with pytest.raises(InputError, match=f"craft.propulsor_.*{message}"):
        craft(**{**PAIR, **changes}).initialise()
