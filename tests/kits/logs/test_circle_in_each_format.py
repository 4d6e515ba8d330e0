"""The KVLCC2's circle in every format: figures within what the format's numbers resolve."""

import math

import numpy as np
import pytest

from seatrial.trial.logs.formats import format_of
from seatrial.trial.logs.quantities import read_columns
from seatrial_kits.sea_trials.figures.record import Record
from seatrial_kits.sea_trials.figures.turning import turning_circle
from seatrial_kits.sea_trials.log_record import read_record
from tests.kit import needs_kits
from tests.kits.logs import writers
from tests.kits.logs.circle import APPROACH_S, RATE, SPEED, circle

pytestmark = needs_kits("ardupilot", "logs", "mavlink", "nmea", "px4")

E7 = 1e-7 * 111_320.0
"""Metres of 1e-7 deg."""
TENTH = math.radians(0.1)
TABLE = "time=UTC,latitude=Lat,longitude=Lon,heading=HDG,helm=RUD"
FORMATS = {
    # name: file, writer, columns, then half the steps of position, m, heading, rad, and time, s
    "csv": ("boat.csv", writers.write_csv, TABLE, 1e-9 * 111_320.0, 1e-9, 0.5e-3),
    "parquet": ("boat.parquet", writers.write_parquet, TABLE, 1e-6, 1e-9, 0.5e-3),
    "nmea0183": ("boat.nmea", writers.write_nmea0183, "", 0.5e-4 * 1852.0, TENTH / 2, 0.5e-3),
    "nmea2000": ("boat.log", writers.write_candump, "", E7 / 2, 0.5e-4, 0.5e-6),
    "tlog": ("boat.tlog", writers.write_tlog, "", E7 / 2, 1e-6, 0.5e-3),
    "ardupilot": ("boat.bin", writers.write_bin, "", E7 / 2, TENTH / 20, 0.5e-6),
    "ulog": ("boat.ulg", writers.write_ulog, "", 1e-4, 1e-6, 0.5e-6),
    "rosbag2": ("bag", writers.write_bag, "helm=/rudder.data:rad", 1e-6, 1e-6, 0.5e-6),
}
DELAY = {"tlog": 0.05}
"""The shortest delay of the link, by which all times of a telemetry log are late, s."""
CHORD = SPEED**2 / (8.0 * 480.0)
"""Of a second on the circle: the most that an interpolated position is off, m."""


@pytest.fixture(scope="module")
def expected():
    motion = circle(0.5)
    return turning_circle(
        Record(motion.time, motion.north, motion.east, motion.heading, motion.helm)
    )


@pytest.mark.parametrize("name", FORMATS)
def test_figures(tmp_path, name, expected):
    file, write, columns, place, heading, time = FORMATS[name]
    write(tmp_path / file)
    assert format_of(tmp_path / file) == name
    record, _ = read_record(tmp_path / file, read_columns([columns] if columns else []))
    found = turning_circle(record, APPROACH_S + DELAY.get(name, 0.0))
    # A heading off by q is reached q / r earlier or later; half of RATE is the least after 30 deg.
    tolerance = 2.0 * place + CHORD + SPEED * (time + heading / (RATE / 2.0))
    for figure in ("advance", "transfer", "tactical_diameter"):
        assert found[figure] == pytest.approx(expected[figure], abs=tolerance), figure
    # The order is found from the helm, which is sampled each second.
    assert turning_circle(record)["advance"] == pytest.approx(
        expected["advance"], abs=tolerance + SPEED
    )
    full = writers.RUDDER_MOST if name not in ("tlog", "ardupilot", "ulog") else 1.0
    assert record.helm[-1] == pytest.approx(-full, abs=TENTH / 2)
    assert np.abs(record.helm[:APPROACH_S]).max() < 1e-9


def test_the_text_of_a_bin_is_the_same_log(tmp_path):
    writers.write_bin(tmp_path / "boat.bin")
    writers.write_text_log(tmp_path / "boat.log")
    assert format_of(tmp_path / "boat.log") == "ardupilot"
    binary, text = (read_record(tmp_path / f"boat.{end}", {})[0] for end in ("bin", "log"))
    for name, values in binary.columns().items():
        np.testing.assert_allclose(text.columns()[name], values, atol=1e-6, err_msg=name)
