"""A hull with a pair of side hulls in waves: sums of hulls that are known, and long waves."""

import math

import numpy as np
import pytest

from seatrial.errors import InputError
from seatrial.physics.craft.wave_hull import HullCoefficients, WaveHull

DENSITY, GRAVITY = 1025.0, 9.81
W = np.array([0.05, 0.8, 2.0, 4.0])
K = W**2 / GRAVITY
BEAM = np.interp(np.linspace(0, 1, 11), [0, 0.3, 0.7, 1], [0.2, 0.4, 0.4, 0.05])
HULL = {
    "hull_length": 4.0,
    "hull_middle": 0.3,
    "hull_waterline": 0.1,
    "section_beam": BEAM,
    "section_draught": 0.2,
    "section_area": 0.2 * BEAM,
}
SIDE = {
    "side_spacing": 2.4,
    "side_length": 1.6,
    "side_middle": -0.5,
    "side_beam": 0.5 * BEAM,
    "side_draught": 0.1,
    "side_area": 0.05 * BEAM,
}


def forces(chi, own=None, waterplane=None, **values):
    made = WaveHull("hull")
    for name, value in values.items():
        made.set(name, value)
    own = own or HullCoefficients()
    return made.hull_loads(own, DENSITY, GRAVITY, waterplane).forces(W, K, chi)


@pytest.mark.parametrize("chi", [0.0, 0.7, math.pi / 2, 2.5])
def test_by_pressure_alone_side_hulls_are_hulls_beside_it(chi):
    names = {"beam": "section", "draught": "section", "area": "section"}
    kinds = [name.removeprefix("side_") for name in SIDE]
    pair = {f"{names.get(k, 'hull')}_{k}": SIDE[f"side_{k}"] for k in kinds}
    apart = forces(chi, **HULL) + forces(chi, **pair, hull_waterline=0.1)
    np.testing.assert_allclose(forces(chi, **HULL, **SIDE), apart, rtol=1e-12, atol=1e-9)


def test_two_hulls_alike_are_a_pair_of_side_hulls_of_one_that_vanishes():
    own = HullCoefficients((80.0, 300.0), (60.0, 40.0), (20.0, 50.0), (30.0, 90.0), 5.0)
    twins = {**HULL, "hull_spacing": 2.4}
    beside = {
        "side_spacing": 2.4,
        "side_length": 4.0,
        "side_middle": 0.3,
        "side_beam": BEAM,
        "side_draught": 0.2,
        "side_area": 0.2 * BEAM,
    }
    tiny = {**HULL, "hull_length": 1e-9, "section_area": 1e-12}
    found = forces(0.7, own, **{**tiny, "section_beam": 1e-6}, **beside)
    np.testing.assert_allclose(found, forces(0.7, own, **twins), rtol=1e-6, atol=1e-5)


def test_in_long_waves_heave_is_that_of_the_waterplane():
    lift = abs(forces(math.pi / 2, **HULL, **SIDE)[2, 0]) / (DENSITY * GRAVITY)
    assert lift == pytest.approx(_area(), rel=2e-3)


def _area():
    """Return the waterplane by the trapezoidal rule over the stations, m2."""
    return np.trapezoid(BEAM, dx=0.4) + 2 * np.trapezoid(0.5 * BEAM, dx=0.16)


def test_a_waterplane_that_forgets_the_side_hulls_is_refused():
    forces(0.0, waterplane=_area(), **HULL, **SIDE)
    with pytest.raises(InputError, match="the sections have a waterplane of"):
        forces(0.0, waterplane=float(np.trapezoid(BEAM, dx=0.4)), **HULL, **SIDE)


def test_side_hulls_without_a_length_are_refused():
    with pytest.raises(InputError, match="side_spacing is given, and side_length is 0"):
        forces(0.0, **HULL, side_spacing=1.0)
