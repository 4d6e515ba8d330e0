"""Shapes: where rays enter, against closed forms and the distance to the faces."""

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from seatrial.errors import InputError
from seatrial_kits.underwater.seabed.obstacles import read_obstacles
from seatrial_kits.underwater.seabed.plane import Plane
from seatrial_kits.underwater.seabed.scene import Scene
from seatrial_kits.underwater.seabed.shapes import Box, Capsule, Cylinder, Sphere

number = st.floats(-8.0, 8.0)
point = st.tuples(number, number, number)
SHAPES = [
    Sphere((1.0, -2.0, 3.0), 2.0),
    Cylinder((0.0, 0.0, 0.0), (2.0, 3.0, -1.0), 1.5),
    Capsule((0.0, 0.0, 0.0), (2.0, 3.0, -1.0), 1.5),
    Box((1.0, 1.0, -1.0), (4.0, 2.0, 1.0), 0.6),
]
AHEAD = (1.0, 0.0, 0.0)


@pytest.mark.parametrize(
    ("shape", "origin", "distance", "normal"),
    [
        (Sphere((10.0, 0.0, 0.0), 3.0), (0.0, 0.0, 0.0), 7.0, (-1.0, 0.0, 0.0)),
        (Sphere((10.0, 0.0, 0.0), 5.0), (0.0, 3.0, 0.0), 6.0, (-0.8, 0.6, 0.0)),
        (Cylinder((10.0, 0.0, -5.0), (10.0, 0.0, 5.0), 1.0), (0.0, 0.0, 0.0), 9.0, (-1.0, 0.0, 0.0)),
        (Cylinder((10.0, 0.0, 0.0), (14.0, 0.0, 0.0), 1.0), (0.0, 0.5, 0.0), 10.0, (-1.0, 0.0, 0.0)),
        (Capsule((10.0, 0.0, 0.0), (14.0, 0.0, 0.0), 1.0), (0.0, 0.6, 0.0), 9.2, (-0.8, 0.6, 0.0)),
        (Capsule((10.0, 0.0, -5.0), (10.0, 0.0, 5.0), 1.0), (0.0, 0.6, 2.0), 9.2, (-0.8, 0.6, 0.0)),
        (Box((10.0, 0.0, 0.0), (4.0, 2.0, 2.0)), (0.0, 0.9, 0.9), 8.0, (-1.0, 0.0, 0.0)),
        (Box((10.0, 0.0, 0.0), (4.0, 4.0, 2.0), math.pi / 4), (0.0, 0.0, 0.0), 10 - math.sqrt(8), None),
    ],
)  # fmt: skip
def test_closed_forms(shape, origin, distance, normal):
    hit = shape.ray(origin, AHEAD)
    assert hit.distance == pytest.approx(distance)
    assert normal is None or hit.normal == pytest.approx(normal, abs=1e-12)
    assert hit.target == shape.kind


@pytest.mark.parametrize("shape", SHAPES, ids=lambda shape: shape.kind)
@given(origin=point, aim=point)
def test_a_ray_enters_where_the_face_is_and_not_before(shape, origin, aim):
    reach = math.dist(origin, aim)
    assume(reach > 0.1)
    ray = (np.array(aim) - origin) / reach
    distances = [shape.nearest(origin + ray * s).distance for s in np.linspace(0.0, 30.0, 301)]
    hit = shape.ray(origin, tuple(ray))
    if distances[0] <= 0.0:
        assert hit.distance == 0.0
        return
    inside = next((k for k, distance in enumerate(distances) if distance <= 0.0), None)
    if hit is None:
        assert inside is None
        return
    face = shape.nearest(origin + ray * hit.distance)
    assert face.distance == pytest.approx(0.0, abs=1e-7)
    assert np.dot(hit.normal, ray) <= 1e-9
    assert all(distance > -1e-9 for k, distance in enumerate(distances) if 0.1 * k < hit.distance)
    if inside is not None:
        assert hit.distance <= 0.1 * inside + 1e-9


@pytest.mark.parametrize("shape", SHAPES, ids=lambda shape: shape.kind)
@given(place=point)
def test_the_normal_is_the_gradient_of_the_distance(shape, place):
    found, h = shape.nearest(place), 1e-6
    slope = [
        (shape.nearest(np.add(place, h * e)).distance - shape.nearest(np.subtract(place, h * e)).distance)
        / (2 * h)
        for e in np.eye(3)
    ]  # fmt: skip
    assume(math.hypot(*slope) == pytest.approx(1.0, abs=1e-3))  # but where two faces are as near
    assert found.normal == pytest.approx(slope, abs=2e-3)


@given(point, st.floats(-4.0, 4.0))
def test_a_box_turned_by_scipy(place, heading):
    turned = Rotation.from_euler("z", heading).apply(place)
    level, turned_box = (
        Box((0.0, 0.0, 0.0), (4.0, 2.0, 1.0)),
        Box((0.0, 0.0, 0.0), (4.0, 2.0, 1.0), heading),
    )
    assert turned_box.nearest(turned).distance == pytest.approx(
        level.nearest(place).distance, abs=1e-12
    )


def test_obstacles_as_text():
    text = "sphere 10 0 5 1; box 20 5 8 2 3 4 30 ;cylinder 0 0 0 0 0 9 .5; capsule 1 2 3 4 5 6 7;"
    assert read_obstacles(text) == (
        Sphere((10.0, 0.0, 5.0), 1.0),
        Box((20.0, 5.0, 8.0), (2.0, 3.0, 4.0), math.radians(30.0)),
        Cylinder((0.0, 0.0, 0.0), (0.0, 0.0, 9.0), 0.5),
        Capsule((1.0, 2.0, 3.0), (4.0, 5.0, 6.0), 7.0),
    )
    assert read_obstacles("") == ()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("ball 1 2 3 4", "unknown obstacle 'ball'.*known: box, capsule, cylinder, sphere"),
        ("sphere 1 2 3", "'sphere 1 2 3' is not of the form 'sphere NORTH EAST DOWN RADIUS'"),
        ("sphere 1 2 x 3", "is not of the form"),
        ("sphere 1 2 nan 3", "is not of the form"),
        ("sphere 1 2 3 0", "sizes must be above 0 m"),
        ("box 1 2 3 4 -5 6 0", "sizes must be above 0 m"),
        ("capsule 1 2 3 1 2 3 1", "ends of its axis are one point"),
    ],
)
def test_what_is_no_obstacle_is_refused(text, message):
    with pytest.raises(InputError, match=message):
        read_obstacles(text)


def test_the_nearest_of_all_is_met():
    scene = Scene(Plane(10.0), read_obstacles("sphere 0 0 6 1; box 0 0 8 2 2 2 0"))
    assert scene.ray((0.0, 0.0, 0.0), (0.0, 0.0, 1.0)).target == "sphere"
    assert scene.ray((0.9, 0.9, 0.0), (0.0, 0.0, 1.0)).distance == 7.0
    assert scene.ray((5.0, 0.0, 0.0), (0.0, 0.0, 1.0)).target == "bottom"
    assert scene.nearest((0.0, 0.0, 4.5)).target == "sphere"
    assert scene.nearest((5.0, 0.0, 9.5)).distance == 0.5
