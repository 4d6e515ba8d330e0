"""First return in a cone, against closed forms."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from seatrial_kits.underwater.seabed.plane import Plane
from seatrial_kits.underwater.seabed.scene import Scene, first_return
from seatrial_kits.underwater.seabed.shapes import Sphere

DOWN = (0.0, 0.0, 1.0)


LEAN = st.floats(-0.4, 0.4)


@given(st.floats(0.0, 0.6), st.floats(0.01, 0.5), st.floats(-3.0, 3.0), LEAN, LEAN)
def test_on_a_slope_it_is_the_edge_or_the_perpendicular(slope, half_angle, falls_to, roll, pitch):
    axis = Rotation.from_euler("yx", [pitch, roll]).apply(DOWN)
    scene = Scene(Plane(20.0, slope, falls_to))
    hit = first_return(scene, (0.0, 0.0, 0.0), tuple(axis.tolist()), half_angle, 99.0)
    fall = -math.sin(slope)
    normal = (fall * math.cos(falls_to), fall * math.sin(falls_to), math.cos(slope))
    between = math.acos(min(1.0, axis @ normal))
    expected = 20.0 * math.cos(slope) / math.cos(max(0.0, between - half_angle))
    assert hit.distance == pytest.approx(expected, rel=1e-5)
    assert hit.distance >= expected * (1.0 - 1e-9)


@given(st.floats(0.1, 0.5), st.floats(0.0, 6.0), st.floats(0.0, 1.0))
def test_a_sphere_within_the_cone_is_met_where_it_is_nearest(half_angle, bearing, share):
    radius, off = 2.0, share * half_angle
    centre = (
        10.0 * math.sin(off) * math.cos(bearing),
        10.0 * math.sin(off) * math.sin(bearing),
        10.0 * math.cos(off),
    )
    hit = first_return(
        Scene(None, (Sphere(centre, radius),)), (0.0, 0.0, 0.0), DOWN, half_angle, 99.0
    )
    assert hit.distance == pytest.approx(8.0, abs=1e-6)
    assert hit.target == "sphere"


def test_a_beam_without_width_is_its_axis():
    scene = Scene(Plane(20.0, 0.3))
    ray = (0.6, 0.0, 0.8)
    assert first_return(scene, (0.0, 0.0, 0.0), ray, 0.0, 99.0) == scene.ray((0.0, 0.0, 0.0), ray)
    assert first_return(scene, (0.0, 0.0, 0.0), DOWN, 0.0, 19.0) is None
    assert first_return(scene, (0.0, 0.0, 0.0), (0.0, 0.0, -1.0), 0.2, 99.0).target == "surface"
