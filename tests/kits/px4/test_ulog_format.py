"""PX4's own logs: a real one, of the sample files of pyulog."""

from pathlib import Path

import numpy as np
import pytest
from pyulog import ULog
from scipy.spatial.transform import Rotation

from seatrial.errors import InputError
from seatrial.trial.logs.formats import format_of, read_log
from seatrial.trial.logs.quantities import chosen, defaults

SAMPLE = Path(__file__).parents[2] / "reference/px4_sample.ulg"


def test_a_real_log():
    """A fixed-wing aircraft on the ground at Trondheim; the file is cut after 100 kB."""
    assert format_of(SAMPLE) == "ulog"
    found = read_log(SAMPLE)
    series = chosen(found, {}, defaults(found))
    assert found.start.isoformat().startswith("2021-04-21T06:30:58")
    assert np.degrees(series["latitude"].values[0]) == pytest.approx(63.42, abs=0.01)
    assert np.degrees(series["longitude"].values[0]) == pytest.approx(10.41, abs=0.01)
    assert {"roll", "pitch", "yaw_rate", "acceleration_x"} <= series.keys()
    attitude = ULog(str(SAMPLE)).get_dataset("vehicle_attitude").data
    turns = Rotation.from_quat(np.column_stack([attitude[f"q[{k}]"] for k in (1, 2, 3, 0)]))
    yaw, pitch, roll = turns.as_euler("ZYX").T
    for what, expected in (("heading", yaw), ("pitch", pitch), ("roll", roll)):
        np.testing.assert_allclose(series[what].values, expected, atol=1e-6)
    rate = 1.0 / np.median(np.diff(series["heading"].time))
    assert rate == pytest.approx(205.0, rel=0.05)


def test_no_ulog(tmp_path):
    (tmp_path / "boat.ulg").write_bytes(SAMPLE.read_bytes()[:10])
    with pytest.raises(InputError, match="no ULog"):
        read_log(tmp_path / "boat.ulg")
