"""Sea water and CTD, against TEOS-10's own library and published check values."""

import math

import pytest

from seatrial.devices.leak import Leak
from seatrial.errors import InputError
from seatrial_kits.underwater.ctd import Ctd
from seatrial_kits.underwater.seawater import CELSIUS, conductivity, salinity, sound_speed
from tests.devices.ideal import ideal
from tests.devices.running import started

# GSW 3.6.23 (TEOS-10): C_from_SP in mS/cm; sound_speed at 30 W, 30 N; z_from_p at 45 N.
GSW = [
    # S, t90, p in dbar, C, c, depth
    (35.0, 15.0, 0.0, 42.917539851672096, 1506.6565077962, 0.0),
    (35.0, 10.0, 1000.0, 38.52952192137374, 1506.1423112910034, 989.5000589580214),
    (35.5, 2.0, 4000.0, 32.810058718048346, 1525.3577712690947, 3930.538115567998),
    (38.0, 13.0, 200.0, 44.18170677432963, 1507.0105544698756, 198.28067409845016),
    (40.0, 40.0, 10000.0, 81.03735033311497, None, None),
    (2.0, 20.0, 50.0, 3.417806545441373, None, None),
]


@pytest.mark.parametrize(("s", "t", "p", "c", "speed", "depth"), GSW)
def test_the_salinity_scale_is_gsws(s, t, p, c, speed, depth):
    assert conductivity(s, t + CELSIUS, p * 1e4) == pytest.approx(c / 10.0, rel=1e-12)
    assert salinity(c / 10.0, t + CELSIUS, p * 1e4) == pytest.approx(s, rel=1e-12)


@pytest.mark.parametrize(("s", "t", "p", "c", "speed", "depth"), [row for row in GSW if row[4]])
def test_mackenzies_speed_is_near_that_of_teos_10(s, t, p, c, speed, depth):
    assert sound_speed(t + CELSIUS, s, depth) == pytest.approx(speed, abs=0.2)


def test_fresh_water_has_no_salinity():
    assert salinity(0.0, CELSIUS + 15.0, 0.0) == pytest.approx(0.008, abs=1e-3)
    assert conductivity(0.0, CELSIUS + 15.0, 0.0) == pytest.approx(0.0, abs=1e-12)


PROFILE = {
    "profile_points": 3.0,
    "profile_depth": [0.0, 10.0, 30.0, *[0.0] * 5],
    "profile_temperature": [290.0, 280.0, 278.0, *[0.0] * 5],
    "profile_salinity": [30.0, 34.0, 35.0, *[0.0] * 5],
}


@pytest.mark.parametrize(
    ("depth", "temperature", "salt"),
    [(0.0, 290.0, 30.0), (5.0, 285.0, 32.0), (20.0, 279.0, 34.5), (90.0, 278.0, 35.0)],
)
def test_a_ctd_reads_its_profile(depth, temperature, salt):
    ctd = ideal(Ctd, position=[0.0, 0.0, depth], **PROFILE)
    assert ctd.get("temperature") == pytest.approx(temperature)
    assert ctd.get("salinity") == pytest.approx(salt)
    assert ctd.get("depth") == pytest.approx(depth)
    assert ctd.get("pressure") == pytest.approx(1025.0 * 9.81 * depth)
    assert ctd.get("speed_of_sound") == pytest.approx(sound_speed(temperature, salt, depth))


def test_in_air_there_is_nothing_to_measure():
    assert not ideal(Ctd, position=[0.0, 0.0, -0.1]).get("valid")


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"profile_points": 2.5}, r"profile_points is 2\.5, a whole number"),
        ({"profile_points": 2.0}, r"profile_depth is \(0\.0, 0\.0\) m: depths must rise"),
    ],
)
def test_profiles_that_cannot_be(values, message):
    with pytest.raises(InputError, match=message):
        started(Ctd, **values)


def test_a_leak_is_reported_at_the_next_sample():
    leak = ideal(Leak, volume=4e-6)
    assert leak.get("leaking") == 0.0
    leak.set("volume", 6e-6)
    assert leak.get("wetness") == leak.get("leaking") == 1.0
    leak.advance(0.0, 0.1)
    leak.set("volume", 0.0)
    assert leak.get("leaking") == 1.0
    leak.advance(0.1, 0.4)
    assert math.isclose(leak.get("leaking"), 0.0)
