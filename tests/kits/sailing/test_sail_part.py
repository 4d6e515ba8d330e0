"""The sail of a craft by data has the loads of the sailing boat's."""

import numpy as np

from seatrial_kits.sailing.sailboat import Sailboat
from tests.kits.fitted.fitting import craft, load, padded


def test_a_sail_is_that_of_the_sailing_boat():
    boat = Sailboat("boat")
    u, v, r, psi, angle = 0.9, -0.2, 0.1, 0.6, 0.5
    shared = {"sail_area": 2.0, "sail_axis": (0.3, -1.5), "sail_arm": 0.2, "sail": -angle}
    for name, value in {**shared, "wind": (4.0, -3.0), "nu_start": (u, v, 0, r)}.items():
        boat.set(name, value)
    boat.set("eta_start", (0, 0, 0, psi))
    boat.initialise()
    X, Y, K, N = boat.get("sail_load")
    part = craft(
        foils="sail",
        foil_area_1=2.0,
        foil_position_1=(0.3, 0, -1.5),
        foil_arm_1=0.2,
        foil_angle_limit_1=3.0,
    )
    found = load(part, (u, v, 0, 0, 0, r), (0, 0, psi), wind=(4.0, -3.0), foil_angle=padded(angle))
    np.testing.assert_allclose(found, [X, Y, 0, K, -1.5 * X, N], rtol=1e-12, atol=1e-12)
