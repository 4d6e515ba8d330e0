import itertools

import pytest

from seatrial.control.helm import Helm
from tests.devices.running import started

MANUAL_AXES = {"direct": [0.5, -0.25, -1.0, 2.0]}
LIMITS = {"surge_limit": 30.0, "sway_limit": 8.0, "moment_limit": 12.0, "heave_limit": 10.0}
HELD = {"surge_held": 3.0, "yaw_moment_held": 4.0, "heave_held": -5.0}


@pytest.mark.parametrize("engaged", list(itertools.product([False, True], repeat=3)))
def test_each_axis_is_the_autopilots_or_manual(engaged):
    found = started(Helm, **MANUAL_AXES, **LIMITS, **HELD, engaged=list(engaged))
    autopilots, deflections = (3.0, 4.0, -5.0), (15.0, -12.0, 10.0)
    expected = [a if on else s for on, a, s in zip(engaged, autopilots, deflections, strict=True)]
    assert [found.get(name) for name in ("surge", "yaw_moment", "heave")] == expected
    assert found.get("sway") == -2.0


def test_an_autopilot_of_sway_acts_where_nobody_is_at_the_helm():
    assert started(Helm, **LIMITS, sway_held=6.5).get("sway") == 6.5


def test_nobody_at_the_helm_asks_nothing():
    found = started(Helm, **LIMITS, **HELD)
    assert [found.get(name) for name in ("surge", "sway", "yaw_moment", "heave")] == [0.0] * 4
