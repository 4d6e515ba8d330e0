"""The nominal constellation, against what GPS's performance standard promises of 24 slots."""

import math

import numpy as np
import pytest

from seatrial_kits.nmea.satellites import sky

PLACES = [(latitude, longitude) for latitude in (-60, -23, 0, 45, 85) for longitude in (-43, 120)]
DAY = [1_772_323_200 + 1200 * k for k in range(72)]


def test_as_many_as_the_standard_has_and_a_good_geometry():
    """PDOP 6 or less for 98 % of places and times, above 5 degrees; four satellites always."""
    skies = [sky(t, *place) for t in DAY for place in PLACES]
    numbers = [len(each.satellites) for each in skies]
    assert min(numbers) >= 5
    assert 7.5 < np.mean(numbers) < 9.5
    assert np.mean([each.pdop <= 6.0 for each in skies]) >= 0.98
    assert 0.8 < np.median([each.hdop for each in skies]) < 1.1


def test_dilutions_are_those_of_the_directions():
    one = sky(DAY[7], -23.0, -43.0)
    rows = [
        (
            math.cos(s.elevation) * math.sin(s.azimuth),
            math.cos(s.elevation) * math.cos(s.azimuth),
            math.sin(s.elevation),
            1.0,
        )
        for s in one.satellites
    ]
    # Scatter of least-squares fixes of ranges with 1 m of noise.
    rng = np.random.default_rng(1)
    fixes = np.linalg.lstsq(np.array(rows), rng.standard_normal((len(rows), 40_000)), rcond=None)[0]
    east, north, up, clock = fixes.std(axis=1)
    assert one.hdop == pytest.approx(math.hypot(east, north), rel=0.02)
    assert (one.vdop, one.tdop) == (pytest.approx(up, rel=0.02), pytest.approx(clock, rel=0.02))


def test_orbits_repeat_after_a_sidereal_day():
    """Two revolutions and one turn of the earth: 86164 s, within some seconds."""
    first, again = sky(DAY[0], -23.0, -43.0), sky(DAY[0] + 86_164, -23.0, -43.0)
    assert [s.prn for s in first.satellites] == [s.prn for s in again.satellites]
    for a, b in zip(first.satellites, again.satellites, strict=True):
        assert a.elevation == pytest.approx(b.elevation, abs=0.01)
    assert max(s.elevation for s in first.satellites) <= math.pi / 2


def test_no_satellite_stands_above_a_pole_that_its_orbit_does_not_reach():
    """Inclined by 55 degrees: their height above a pole is of a triangle."""
    r, earth = 26_559.7, 6_371.0
    beta = math.radians(55.0)
    most = math.atan2(r * math.sin(beta) - earth, r * math.cos(beta))
    highest = max(sky(t, 90.0, 0.0).satellites[0].elevation for t in DAY)
    assert highest == pytest.approx(most, abs=0.02)
