"""The earth's magnetic field against what others compute of the World Magnetic Model."""

from __future__ import annotations

import datetime
import math

import pytest

from seatrial.links.earth_field import earth_field


def unix(year, month=1, day=1):
    return datetime.datetime(year, month, day, tzinfo=datetime.UTC).timestamp()


@pytest.mark.parametrize(
    ("when", "wanted_nt"),
    [
        # MathWorks, Aerospace Toolbox, page of wrldmagm: 1000 m over Natick, Massachusetts.
        (unix(2028, 7, 4), (20139.0, -4905.0, 46532.0)),
        (unix(2020, 7, 4), (19738.0, -5014.0, 47556.0)),
    ],
)
def test_north_east_and_down(when, wanted_nt):
    found = earth_field(math.radians(42.283), math.radians(-71.35), 1000.0, when)
    assert [1e9 * each for each in found] == pytest.approx(wanted_nt, abs=1.0)


def test_a_point_of_the_models_report():
    """WMM2025's report, table of test values: 80 degrees north, 0 east, sea level, 2025.0."""
    north, east, down = earth_field(math.radians(80.0), 0.0, 0.0, unix(2025))
    assert math.degrees(math.atan2(east, north)) == pytest.approx(1.28, abs=0.005)
    assert 1e9 * math.hypot(north, east, down) == pytest.approx(55178.0, abs=1.0)


@pytest.mark.parametrize(("beyond", "end"), [(1999, 2010), (2050, 2030)])
def test_beyond_its_years_it_is_the_field_of_their_end(beyond, end):
    place = (math.radians(63.4), math.radians(10.4), 0.0)
    assert earth_field(*place, unix(beyond)) == earth_field(*place, unix(end))
    assert earth_field(*place, unix(end)) != earth_field(*place, unix(2020))
