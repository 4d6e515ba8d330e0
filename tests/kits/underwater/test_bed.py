"""Planes and grids: depths, normals and ranges, against closed forms and SciPy."""

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy.interpolate import RegularGridInterpolator
from scipy.optimize import brentq

from seatrial_kits.underwater.seabed.grid import Grid
from seatrial_kits.underwater.seabed.plane import Plane
from seatrial_kits.underwater.seabed.scene import Scene

angle = st.floats(-7.0, 7.0)
DOWN = (0.0, 0.0, 1.0)


def direction(bearing, dive):
    return (
        math.cos(dive) * math.cos(bearing),
        math.cos(dive) * math.sin(bearing),
        math.sin(dive),
    )


def rough_grid(seed=0):
    random = np.random.default_rng(seed)
    north, east = np.array([-30.0, -12.0, 0.0, 7.0, 31.0]), np.linspace(-20.0, 40.0, 9)
    return Grid(north, east, 20.0 + 3.0 * random.standard_normal((5, 9)))


def test_level_plane_below():
    assert Plane(20.0).ray((3.0, -4.0, 5.0), DOWN, 100.0) == 15.0
    assert Plane(20.0).normal_at(0.0, 0.0) == (0.0, 0.0, -1.0)


@given(st.floats(0.0, 1.2), angle, angle, st.floats(0.05, 1.5))
def test_slant_range_to_a_slope(slope, falls_to, bearing, dive):
    # In the vertical plane of the ray the bed is a line: h + x tan(apparent) = x tan(dive).
    apparent = math.atan(math.tan(slope) * math.cos(bearing - falls_to))
    found = Plane(10.0, slope, falls_to).ray((0.0, 0.0, 0.0), direction(bearing, dive), math.inf)
    if dive - apparent < 1e-6:
        assert found > 1e5
    else:
        expected = 10.0 * math.cos(apparent) / math.sin(dive - apparent)
        assert found == pytest.approx(expected, rel=1e-9)


def test_a_plane_falls_away_to_its_direction():
    east = Plane(10.0, math.radians(45.0), math.pi / 2)
    assert east.depth_at(100.0, 3.0) == pytest.approx(13.0)
    assert east.normal_at(0.0, 0.0) == pytest.approx((0.0, math.sqrt(0.5), -math.sqrt(0.5)))


def test_below_the_bed_the_range_is_none_at_all():
    assert Plane(10.0).ray((0.0, 0.0, 11.0), (1.0, 0.0, 0.0), 50.0) == 0.0
    assert rough_grid().ray((0.0, 0.0, 60.0), (1.0, 0.0, 0.0), 50.0) == 0.0


@given(st.floats(-29.0, 30.0), st.floats(-19.0, 39.0))
def test_grid_is_bilinear_as_scipys(north, east):
    grid = rough_grid()
    reference = RegularGridInterpolator((grid.north, grid.east), grid.depth)
    assert grid.depth_at(north, east) == pytest.approx(float(reference((north, east))), abs=1e-12)


@given(st.floats(-29.0, 30.0), st.floats(-19.0, 39.0))
def test_grid_normal_is_across_the_surface(north, east):
    grid, h = rough_grid(), 1e-7
    lines = [abs(grid.north - north).min(), abs(grid.east - east).min()]
    assume(min(lines) > 2 * h)  # on a line there are two
    normal = grid.normal_at(north, east)
    assert math.hypot(*normal) == pytest.approx(1.0)
    slopes = [
        (grid.depth_at(north + h, east) - grid.depth_at(north, east)) / h,
        (grid.depth_at(north, east + h) - grid.depth_at(north, east)) / h,
    ]
    assert normal[0] / -normal[2] == pytest.approx(slopes[0], abs=1e-5)
    assert normal[1] / -normal[2] == pytest.approx(slopes[1], abs=1e-5)


@given(
    st.integers(0, 5), st.floats(-60.0, 60.0), st.floats(-40.0, 70.0), angle, st.floats(-1.57, 1.57)
)
def test_first_hit_on_a_grid_is_that_of_a_fine_march(seed, north, east, bearing, dive):
    grid, origin = rough_grid(seed), (north, east, 2.0)
    ray, reach = direction(bearing, dive), 150.0

    def below(s):
        return origin[2] + ray[2] * s - grid.depth_at(north + ray[0] * s, east + ray[1] * s)

    places = np.linspace(0.0, reach, 601)
    heights = [below(s) for s in places]
    first = next((k for k, height in enumerate(heights) if height >= 0.0), None)
    found = grid.ray(origin, ray, reach)
    if first is None:
        # A crest between two places of the march may be met all the same.
        assert found == math.inf or abs(below(found)) < 1e-9
    elif first == 0:
        assert found == 0.0
    else:
        expected = brentq(below, places[first - 1], places[first], xtol=1e-12)
        assert found <= expected + 1e-9
        assert abs(below(found)) < 1e-9
        assert found > places[first - 1] - 1e-9 or max(heights[:first]) > -0.1


def test_a_grid_of_a_plane_is_the_plane():
    plane = Plane(30.0, 0.3, 0.8)
    north, east = np.linspace(-50.0, 50.0, 11), np.linspace(-40.0, 60.0, 6)
    depth = np.array([[plane.depth_at(n, e) for e in east] for n in north])
    grid = Grid(north, east, depth)
    for bearing in np.linspace(0.0, 6.0, 9):
        for dive in (1.0, 1.2, math.pi / 2):
            ray = direction(bearing, dive)
            place = plane.ray((1.0, 2.0, 3.0), ray, 60.0)
            assert place < 60.0
            assert grid.ray((1.0, 2.0, 3.0), ray, 60.0) == pytest.approx(place, rel=1e-12)
    assert grid.normal_at(3.0, 3.0) == pytest.approx(plane.normal_at(3.0, 3.0))


def test_beyond_the_edge_a_grid_goes_on_level():
    grid = rough_grid()
    assert grid.depth_at(1e4, 5.0) == grid.depth_at(31.0, 5.0)
    assert grid.ray((1e4, -1e4, 0.0), DOWN, 100.0) == pytest.approx(float(grid.depth[-1, 0]))
    assert grid.normal_at(1e4, -1e4) == (0.0, 0.0, -1.0)


def test_a_level_ray_without_end():
    grid = rough_grid()
    top = float(grid.depth.min())
    assert Scene(grid).ray((0.0, 0.0, top - 0.1), (1.0, 0.0, 0.0), surface=False) is None
    i, j = (int(k) for k in np.argwhere(grid.depth == top)[0])
    west = (float(grid.north[i]), float(grid.east[0]) - 50.0, top + 1e-6)
    hit = Scene(grid).ray(west, (0.0, 1.0, 0.0))
    assert hit.distance == pytest.approx(grid.east[j] - west[1], abs=1e-4)


def test_the_surface_is_met_from_below():
    up = Scene(Plane(20.0)).ray((0.0, 0.0, 4.0), (0.6, 0.0, -0.8))
    assert (up.distance, up.normal, up.target) == (5.0, (0.0, 0.0, 1.0), "surface")
    assert Scene(None).ray((0.0, 0.0, 4.0), DOWN) is None
    assert Scene(Plane(20.0)).ray((0.0, 0.0, 4.0), (0.6, 0.0, -0.8), 4.9) is None
    assert Scene(Plane(20.0)).ray((0.0, 0.0, 4.0), (0.6, 0.0, -0.8), surface=False) is None


def test_height_above_a_slope_is_along_its_normal():
    slope = Scene(Plane(10.0, math.radians(60.0)))
    nearest = slope.nearest((0.0, 0.0, 8.0))
    assert nearest.distance == pytest.approx(1.0)
    assert slope.nearest((0.0, 0.0, 12.0)).distance == pytest.approx(-1.0)
    assert Scene(None).nearest((0.0, 0.0, 8.0)) is None
