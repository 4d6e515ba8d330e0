"""The optimum of a smooth surface against a brute-force one over SciPy's, and what it gives."""

import math

import numpy as np
import pytest
from scipy.interpolate import RectBivariateSpline

from seatrial.errors import InputError
from seatrial.physics.foils import sail_naca0015
from seatrial_kits.sailing.control.sail_control import SailControl
from seatrial_kits.sailing.control.sail_search import best_setting
from seatrial_kits.sailing.control.sail_surface import smooth_setting

TABLE = sail_naca0015("patched", "physical")
WINDS = [-10, -30, -50, -70, -90, -104]


@pytest.mark.parametrize("beta", WINDS)
def test_no_point_of_a_fine_grid_gives_more(beta):
    beta = math.radians(beta)
    alphas, flaps = np.radians(np.arange(0, 181, 5)), np.radians(np.arange(0, 31, 5))
    lift, drag = (
        RectBivariateSpline(alphas, flaps, np.array(t).T) for t in (TABLE.lift, TABLE.drag)
    )

    def drive(angle, flap):
        alpha = np.remainder(beta - angle + 2 * math.pi, 2 * math.pi) - math.pi
        c_l = lift.ev(np.abs(alpha), flap) * np.sign(alpha)
        return -c_l * math.sin(beta) + drag.ev(np.abs(alpha), flap) * math.cos(beta)

    found = smooth_setting(TABLE, beta, 0.0, math.pi / 2)
    angle, flap = np.meshgrid(
        np.radians(np.arange(0, 90.1, 0.2)), np.radians(np.arange(0, 30.1, 0.2))
    )
    assert drive(found.angle, found.flap) > drive(angle, flap).max() - 1e-4


@pytest.mark.parametrize("beta", WINDS)
def test_on_a_sail_that_is_linear_between_its_points_the_search_is_not_beaten(beta):
    beta = math.radians(beta)
    points = best_setting(TABLE, beta, 0.0, math.pi / 2)
    smooth = smooth_setting(TABLE, beta, 0.0, math.pi / 2)
    assert smooth.drive <= points.drive + 1e-12
    assert smooth.drive > 0.95 * points.drive


def test_it_knows_no_limit_on_heel():
    control = SailControl("trimmer")
    control.set("optimum", "smooth")
    control.set("roll_limit", "on")
    control.setup(0.0)
    with pytest.raises(InputError, match="one of them must be 'table' or 'off'"):
        control.initialise()
        control.begin()
