"""Figures of curves of righting arms, and seatrial stability."""

import json
import math

import numpy as np
import pytest

from seatrial_kits.sea_trials.stability import ANGLES, Stability
from tests.command import seatrial


def test_a_sine_has_the_figures_of_a_sine():
    found = Stability(0.6 * np.sin(ANGLES), 0.6)
    assert found.vanishing == pytest.approx(math.pi, abs=0.02)
    assert found.largest == (pytest.approx(0.6), pytest.approx(math.pi / 2))
    for end in (30.0, 40.0):
        area = 0.6 * (1 - math.cos(math.radians(end)))
        assert found.area(0.0, math.radians(end)) == pytest.approx(area, rel=1e-3)
    assert all(criterion.holds for criterion in found.criteria())


def test_a_curve_that_vanishes_has_no_area_beyond():
    # GZ = 0.1 sin(4.5 phi) to 40 degrees, negative after.
    found = Stability(np.where(ANGLES < 1.3, 0.1 * np.sin(4.5 * ANGLES), -0.1), 0.45)
    assert math.degrees(found.vanishing) == pytest.approx(40.0, abs=0.01)
    assert found.largest == (pytest.approx(0.1, rel=1e-3), pytest.approx(math.radians(20)))
    whole = 0.2 / 4.5  # of half a wave of the sine
    assert found.area(0.0, math.pi) == pytest.approx(whole, rel=1e-3)
    failed = {criterion.name for criterion in found.criteria() if not criterion.holds}
    assert failed == {
        "area to 30 deg",
        "area to 40 deg",
        "area from 30 to 40 deg",
        "largest arm from 30 deg on",
        "angle of the largest arm",
    }


def test_a_craft_without_initial_stability_has_no_range():
    assert Stability(-0.1 * np.sin(ANGLES), -0.1).vanishing == 0.0


def test_the_command_has_the_curve_of_the_vehicle_and_names_what_lacks(tmp_path):
    done = seatrial("stability", "supply-ship", "--json", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)["result"]
    arms = np.array(found["righting_arm_m"])
    # Near rest GM_T phi, that of the vehicle's file.
    GM = next(c["found"] for c in found["criteria"] if c["name"] == "GM")
    assert arms[1] == pytest.approx(GM * math.sin(ANGLES[1]), rel=5e-3)
    assert arms[0] == pytest.approx(0.0, abs=1e-9)
    assert math.degrees(found["vanishing_rad"]) == pytest.approx(46.3, abs=0.1)
    refused = seatrial("stability", "mariner", cwd=tmp_path)
    assert refused.returncode == 2
    assert "no craft in six degrees of freedom" in refused.stderr
