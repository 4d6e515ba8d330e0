"""A tether at the vehicle at constant depth: the acceleration that it gives."""

import numpy as np

from seatrial_kits.videoray.vessel.surface_vessel import SurfaceVessel
from tests.craft.test_attachment import PLACE, PULL, built


def test_the_vessel_of_two_thrusters_is_pulled_by_its_own_masses():
    vessel = built(SurfaceVessel, mass=(10.0, 15.0, 2.0))
    state = np.zeros(6)
    vessel.set("attachment_force", PULL)
    north, east, _ = PULL
    moment = PLACE[0] * east - PLACE[1] * north
    np.testing.assert_allclose(
        vessel.derivatives(state)[3:], [north / 10, east / 15, moment / 2], rtol=1e-12
    )
