"""ArduPilot's simulated instruments from a profile's sensors."""

import json
import math

import pytest
from pygeomag import GeoMag

from seatrial.errors import InputError
from seatrial.links.parameter_validation import start_us
from seatrial.links.vehicle_sensors import read_instruments
from seatrial.system.profile.profile import load_profile
from seatrial_kits.ardupilot.simulated import simulated, write_parameters

STARTS = {"period": [0.2], "delay": [0.0]}
GNSS = {
    "kind": "gnss",
    **STARTS,
    "antenna": [0.1, -0.2, -0.5],
    "velocity_n_noise": [0.02, 0.03, 0.04],
    "position_n_noise": [0.3, 0.3, 0.6],
    "position_n_instability": 0.4,
}
HOME = (math.radians(63.44), math.radians(10.4), 5.0)
UNIX_S = 1e-6 * start_us("2026-06-01")


def of(sensors, firmware="rover"):
    text = json.dumps(sensors)
    found = simulated(read_instruments(text), firmware, HOME, UNIX_S)
    assert len({one.name for one in found}) == len(found)
    return {one.name: one.value for one in found}


def test_a_receiver():
    given = of({"rtk": {**GNSS, "delay": 0.12}})
    assert (given["SIM_GPS1_HZ"], given["SIM_GPS1_LAG_MS"], given["GPS1_DELAY_MS"]) == (5, 120, 120)
    for prefix in ("SIM_GPS1", "GPS1"):
        assert [given[f"{prefix}_POS_{axis}"] for axis in "XYZ"] == [0.1, -0.2, -0.5]
    # A uniform noise in -a to a has the variance a^2 / 3.
    assert given["SIM_GPS1_VERR_Y"] ** 2 / 3 == pytest.approx(0.03**2)
    assert given["SIM_GPS1_ACC"] == pytest.approx(0.5)  # 3, 4, 5


def test_an_ideal_receiver_has_no_delay_and_some_accuracy():
    ideal = {**GNSS, "position_n_noise": 0.0, "position_n_instability": 0.0, "period": 2.0}
    given = of({"positioning": ideal})
    # A delay of 0 would be that of the receiver's type, a rate of 0 none at all.
    assert (given["SIM_GPS1_LAG_MS"], given["GPS1_DELAY_MS"], given["SIM_GPS1_HZ"]) == (0, 1, 1)
    assert given["SIM_GPS1_ACC"] == 0.01


@pytest.mark.parametrize(
    "sensor",
    [
        {"kind": "compass", "heading_noise": [0.01]},
        {"kind": "ahrs", "euler_noise": [0.5, 0.5, 0.01]},
    ],
)
def test_noise_of_a_heading_is_a_field_across_the_horizontal_one(sensor):
    given = of({"heading": {**sensor, **STARTS, "delay": 0.03}})
    field = GeoMag(base_year=2025).calculate(63.44, 10.4, 0.005, 2026.4137)
    sigma = given["SIM_MAG_RND"] / math.sqrt(3.0)
    assert sigma / (field.h * 1e-2) == pytest.approx(0.01, rel=1e-4)  # of nT, in milligauss
    assert given["SIM_MAG_DELAY"] == 30


def test_the_depth_is_that_of_submarines():
    depth = {"depth": {"kind": "depth", **STARTS, "depth_noise": 0.002, "delay": 0.02}}
    assert of(depth) == {}
    given = of(depth, "sub")
    for name in ("BARO", "BAR2", "BAR3"):
        assert given[f"SIM_{name}_RND"] ** 2 / 3 == pytest.approx(0.002**2)
        assert given[f"SIM_{name}_DELAY"] == 20


def test_biases_of_an_inertial_unit_and_the_first_of_a_kind():
    imu = {"kind": "imu", **STARTS, "gyro_bias": [0.0, 0.0, 0.01], "accelerometer_bias": 0.0}
    other = {**imu, "gyro_bias": 0.5}
    given = of({"imu": imu, "spare": other})
    assert given == {f"SIM_GYR{number}_BIAS_Z": 0.01 for number in (1, 2, 3)}


@pytest.mark.parametrize(
    "text", ["no JSON", "[1]", '{"gnss": {"period": 1}}', '{"a": {"kind": 3}}']
)
def test_other_texts_are_refused(text):
    with pytest.raises(InputError, match="instruments: a JSON object of sensors"):
        read_instruments(text)


@pytest.mark.parametrize("name", ["hydrone", "otter", "mariner", "gloria", "bluerov2", "videoray"])
def test_shipped_profiles_give_them(name, tmp_path):
    text = load_profile(name).parameters("links.ardupilot")["instruments"]
    found = simulated(read_instruments(text), "sub", HOME, UNIX_S)
    names = [one.name for one in found]
    assert {"SIM_GPS1_HZ", "SIM_MAG_RND"} <= {*names}
    lines = write_parameters(tmp_path / "run", found).read_text().splitlines()
    assert [line.split()[0] for line in lines[1:]] == names
    assert all(
        line.split()[2:4] == ["#", one.source] for line, one in zip(lines[1:], found, strict=True)
    )
