"""A disturbance acts from its beginning to just before its end."""

import pytest

from seatrial.errors import InputError
from seatrial_kits.videoray.vessel.step_disturbance import StepDisturbance
from tests.devices.running import run, started

SIZE = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]


def test_it_acts_between_its_times():
    step = started(StepDisturbance, step_size=SIZE, begin_time=0.3, end_time=0.7)
    rows = run(step, ["force", "moment", "nu_bias"], 1000, 100)
    acts = [row == [[1.0, 2.0], 3.0, [4.0, 5.0, 6.0]] for row in rows]
    rests = [row == [[0.0, 0.0], 0.0, [0.0, 0.0, 0.0]] for row in rows]
    assert [k for k, found in enumerate(acts) if found] == [3, 4, 5, 6]
    assert [k for k, found in enumerate(rests) if found] == [0, 1, 2, 7, 8, 9, 10]


def test_it_must_end_after_it_began():
    with pytest.raises(
        InputError, match=r"end_time \(5\.0 s\) must be after begin_time \(5\.0 s\)"
    ):
        started(StepDisturbance, begin_time=5.0, end_time=5.0)
