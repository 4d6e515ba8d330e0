"""Gravity in accelerometers, against readings of [Paulino2015] and a rotation matrix."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from seatrial_kits.identify.gravity import acceleration_along


@pytest.mark.parametrize("axis", ["surge", "sway", "heave"])
@pytest.mark.parametrize("reads", ["specific-force", "gravity-less-acceleration", "gravity-plus-acceleration"])  # fmt: skip
def test_what_was_put_in_comes_out(axis, reads):
    random = np.random.default_rng(2)
    roll, pitch, yaw = random.uniform(-1.0, 1.0, (3, 50))
    turned = Rotation.from_euler("ZYX", np.column_stack([yaw, pitch, roll]))
    place = ("surge", "sway", "heave").index(axis)
    gravity = turned.inv().apply([0.0, 0.0, 9.81])[:, place]
    a = random.normal(size=50)
    reading = {
        "specific-force": a - gravity,
        "gravity-less-acceleration": gravity - a,
        "gravity-plus-acceleration": gravity + a,
    }[reads]
    found = acceleration_along(axis, reading, roll, pitch, reads=reads)
    np.testing.assert_allclose(found, a, atol=1e-13)
    np.testing.assert_array_equal(acceleration_along(axis, a, roll, pitch, reads="acceleration"), a)


@pytest.mark.parametrize(
    ("axis", "reading", "roll", "pitch"),
    [
        ("surge", 21.0, 36.8, -12.0),
        ("surge", 1.2, 47.4, -0.7),
        ("sway", 64.1, 36.8, -12.0),
        ("sway", 82.3, 47.4, -0.7),
    ],
)
def test_what_source_000_takes_for_offsets_is_gravity(axis, reading, roll, pitch):
    """Table 7.1, dry and in the pool: cm/s2 and tenths of degrees; within 1.5 cm/s2."""
    angles = [np.radians([angle / 10.0]) for angle in (roll, pitch)]
    left = acceleration_along(
        axis, np.array([reading / 100.0]), *angles, reads="gravity-less-acceleration"
    )
    assert abs(left[0]) < 0.015
