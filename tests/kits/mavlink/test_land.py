"""NAV_LAND: a submarine comes up, a boat has nowhere to land."""

import pytest
from pymavlink.dialects.v20 import all as mavlink

from .bench import Bench


@pytest.mark.parametrize("autopilot", ["ardupilotmega", "px4"])
def test_what_is_to_land_surfaces(autopilot):
    submarine, boat = (Bench(submerged=under, autopilot=autopilot) for under in (True, False))
    assert submarine.command(mavlink.MAV_CMD_NAV_LAND) == mavlink.MAV_RESULT_ACCEPTED
    assert submarine.vehicle.mode.name == "surface"
    assert boat.command(mavlink.MAV_CMD_NAV_LAND) == mavlink.MAV_RESULT_UNSUPPORTED
    assert boat.vehicle.mode.name == "hold"
