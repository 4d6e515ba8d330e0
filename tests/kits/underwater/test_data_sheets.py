"""Defaults of the acoustic sensors as their pages state them, angles in degrees."""

import numpy as np
import pytest

from seatrial_kits.underwater.dvl import Dvl
from seatrial_kits.underwater.echo_sounder import Altimeter, EchoSounder
from seatrial_kits.underwater.scanning_sonar import ScanningSonar
from seatrial_kits.underwater.usbl import Usbl

STATED = [
    (Usbl, "bearing_noise", 1),
    (Usbl, "depression_instability", 1),
    (EchoSounder, "beam_width", 12),
    (Altimeter, "beam_width", 25),
    (Dvl, "beam_angle", 22.5),
    (Dvl, "tilt_max", 45),
    (ScanningSonar, "width", 2),
    (ScanningSonar, "height", 25),
    (ScanningSonar, "step_angle", 1.8),
]


@pytest.mark.parametrize(("kind", "name", "degrees"), STATED)
def test_defaults_are_those_stated(kind, name, degrees):
    np.testing.assert_allclose(np.degrees(kind("sensor").get(name)), degrees)
