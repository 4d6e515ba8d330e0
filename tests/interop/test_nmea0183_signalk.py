"""Signal K's parser reads the sentences, into SI units of its own."""

import json
import math
import shutil
import subprocess
from pathlib import Path

import pymap3d
import pytest

from tests.kits.nmea.nmea0183.bench import DEG, VALID, Bench

NODE = Path(__file__).with_name("node")
WAIT_S = 120.0
BEARING = -math.atan2(100.0, 900.0) % math.tau

pytestmark = pytest.mark.skipif(
    shutil.which("node") is None or not (NODE / "node_modules/@signalk/nmea0183-signalk").is_dir(),
    reason="Signal K's parser is not installed: make tests/interop/node/node_modules/.installed",
)


def understood(sentences: list[bytes]) -> dict[str, dict]:
    """Return what Signal K makes of each sentence: values by path, by talker and formatter."""
    done = subprocess.run(
        ["node", str(NODE / "nmea0183.js")],
        input=b"".join(sentences),
        capture_output=True,
        timeout=WAIT_S,
        check=True,
    )
    found: dict[str, dict] = {}
    for sentence, line in zip(sentences, done.stdout.splitlines(), strict=True):
        found.setdefault(sentence[1:6].decode(), {}).update(json.loads(line))
    return found


def test_signal_k_agrees():
    bench = Bench(
        latitude=-22.862 * DEG, longitude=-43.223 * DEG, variation=-23.0 * DEG, date="2018-09-01"
    )
    bench.set(**VALID)
    found = understood(bench.run(0.1))
    latitude, longitude, _ = pymap3d.ned2geodetic(100.0, -50.0, 0.0, -22.862, -43.223, 0.0)
    for name in ("GPRMC", "GPGGA"):
        position = found[name]["navigation.position"]
        assert position["latitude"] == pytest.approx(latitude, abs=1e-7)
        assert position["longitude"] == pytest.approx(longitude, abs=1e-7)
    assert found["GPRMC"]["navigation.datetime"] == "2018-09-01T00:00:00.000Z"
    half_degree_digit = 0.0051 * DEG
    course = math.atan2(-0.5, 1.0) % math.tau
    for name, path, value, within in (
        ("GPRMC", "navigation.speedOverGround", math.hypot(1.0, 0.5), 0.003),
        ("GPRMC", "navigation.courseOverGroundTrue", course, half_degree_digit),
        ("GPRMC", "navigation.magneticVariation", -23.0 * DEG, half_degree_digit),
        ("GPGGA", "navigation.gnss.antennaAltitude", 1.5, 1e-9),
        ("GPVTG", "navigation.courseOverGroundMagnetic", course + 23.0 * DEG, half_degree_digit),
        ("HEHDT", "navigation.headingTrue", 350.0 * DEG, half_degree_digit),
        ("HCHDG", "navigation.headingMagnetic", 13.0 * DEG, half_degree_digit),
        ("HCHDG", "navigation.headingTrue", -10.0 * DEG, half_degree_digit),
        ("TIROT", "navigation.rateOfTurn", 3.0 * DEG, 1e-5),
        ("WIMWV", "environment.wind.speedApparent", 6.0, 0.003),
        ("WIMWV", "environment.wind.angleApparent", 45.0 * DEG, half_degree_digit),
        ("WIMWV", "environment.wind.speedTrue", 5.0, 0.003),
        ("VWVHW", "navigation.speedThroughWater", 1.25, 0.003),
        ("SDDBT", "environment.depth.belowTransducer", 12.34, 1e-9),
        ("SDDPT", "environment.depth.belowTransducer", 12.34, 1e-9),
        ("YXMTW", "environment.water.temperature", 295.65, 1e-9),
        ("AGRSA", "steering.rudderAngle", -7.5 * DEG, half_degree_digit),
        ("HCHDM", "navigation.headingMagnetic", 13.0 * DEG, half_degree_digit),
        ("WIMWD", "environment.wind.directionTrue", math.atan2(3.0, 4.0), half_degree_digit),
        ("WIMWD", "environment.wind.speedTrue", 5.0, 0.003),
        ("AGAPB", "navigation.courseRhumbline.crossTrackError", 100.0, 1.0),
        ("AGAPB", "steering.autopilot.target.headingTrue", BEARING, half_degree_digit),
        ("AGBWC", "navigation.courseGreatCircle.nextPoint.distance", math.hypot(900, 100), 1.0),
        ("AGBOD", "navigation.courseRhumbline.bearingTrackMagnetic", 23.0 * DEG, 1e-3),
        ("ERRPM", "propulsion.engine_2.revolutions", 100.0 / math.tau, 1e-3),
        ("GNGNS", "navigation.gnss.antennaAltitude", 1.5, 1e-9),
    ):
        assert found[name][path] == pytest.approx(value, abs=within), (name, path)


def test_what_is_not_valid_has_no_value():
    found = understood(Bench().run(0.1))
    expected = {"magneticVariation", "magneticVariationAgeOfService", "datetime"}
    expected |= {"satellites", "satellitesInView"}  # 0
    for name, values in found.items():
        for path, value in values.items():
            assert value is None or path.rpartition(".")[2] in expected, (name, path, value)
