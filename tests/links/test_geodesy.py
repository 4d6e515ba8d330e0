import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from seatrial.links.geodesy import Origin

# WGS 84: semi-major axis, m, and first eccentricity squared.
A, E2 = 6378137.0, 6.69437999014e-3
latitudes = st.floats(-1.4, 1.4)
longitudes = st.floats(-3.1, 3.1)
distances = st.floats(-10e3, 10e3)


@given(latitudes, longitudes)
def test_short_distances_follow_the_radii_of_curvature(latitude, longitude):
    origin = Origin(latitude, longitude, 0.0)
    w = math.sqrt(1.0 - E2 * math.sin(latitude) ** 2)
    meridian, prime_vertical = A * (1.0 - E2) / w**3, A / w
    north, east = origin.geodetic((1.0, 0.0, 0.0)), origin.geodetic((0.0, 1.0, 0.0))
    # A double of degrees resolves 1e-9 m or so; 1 m of north or east is bent by 1e-7.
    assert math.radians(north[0]) - latitude == pytest.approx(1.0 / meridian, rel=1e-5)
    turned = math.remainder(math.radians(east[1]) - longitude, math.tau)
    assert turned == pytest.approx(1.0 / (prime_vertical * math.cos(latitude)), rel=1e-5)


@given(latitudes, longitudes, distances, distances, st.floats(-50, 500))
def test_there_and_back(latitude, longitude, north, east, down):
    origin = Origin(latitude, longitude, 30.0)
    back = origin.position(*origin.geodetic((north, east, down)))
    far = 1e-6 * math.hypot(north, east)
    assert back == pytest.approx((north, east, down), abs=max(1e-6, 3 * far))


@given(distances, distances)
def test_depth_is_negative_altitude_wherever_it_is(north, east):
    origin = Origin(0.5, 0.5, 0.0)
    assert origin.geodetic((north, east, 12.5))[2] == -12.5
    assert origin.position(*origin.geodetic((north, east, 12.5)))[2] == 12.5


def test_altitude_counts_from_the_origins():
    assert Origin(0.1, 0.1, 700.0).geodetic((0.0, 0.0, -3.0))[2] == 703.0
