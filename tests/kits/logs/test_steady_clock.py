"""Clocks that were set while they recorded, late entries, and times since 1970."""

from pathlib import Path

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from seatrial.links.clock_jumps import clock_jumps
from seatrial.trial.logs.channels import Log, channel
from seatrial_kits.logs.paired.steady_clock import from_zero, steady


def log(times, values=None):
    found = channel("x", "m", times, np.arange(len(times)) if values is None else values)
    return Log(Path("boat.log"), {"x": found})


@given(
    jumps=st.lists(
        st.tuples(st.integers(5, 95), st.floats(-1e8, -3.0) | st.floats(1e5, 1e9)), max_size=4
    ),
    step=st.sampled_from([0.1, 1.0]),
)
def test_a_clock_that_was_set_goes_on(jumps, step):
    true = np.arange(101) * step
    shown = true.copy()
    places = {}
    for place, by in jumps:
        if all(abs(place - other) > 22 for other in places):  # as far as is looked at
            shown[place:] += by
            places[place] = by
    found = steady(log(shown)).channels["x"]
    np.testing.assert_allclose(found.time - found.time[0], true, atol=1e-5)
    assert found.values.tolist() == list(range(101))


@given(late=st.sets(st.integers(1, 98), max_size=20), by=st.floats(0.2, 30.0))
def test_entries_that_come_late_are_put_in_their_place(late, by):
    """Behind the entries that are in time, alone: their times are right, their places are not."""
    true = np.arange(100.0)
    times = [t - by if k in late and k - 1 not in late else t for k, t in enumerate(true)]
    at, _ = clock_jumps(np.array(times))
    assert not len(at)
    found = steady(log(times)).channels["x"]
    assert (np.diff(found.time) > 0.0).all()
    in_time = [t for t in times if t in true]
    assert set(in_time) <= set(found.time.tolist())


def test_two_devices_of_which_one_is_slow():
    """Every third entry is 5 s behind: that is no clock that was set thirty times."""
    times = np.arange(0.0, 30.0, 0.1)
    times[::3] -= 5.0
    assert not len(clock_jumps(times)[0])


def test_what_was_done_is_said_and_counted():
    found = steady(log([0.0, 1.0, 2.0, 3.0, -500.0, -499.0, -498.0, -497.0, -497.0]))
    assert found.channels["x"].time.tolist() == [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]
    assert found.notes == (
        "the clock was set once, the first before message 5, by -504 s: the record goes on without "
        "jump",
        "1 entries with the time of the next of their channel are left out",
    )


def test_times_since_1970_are_from_the_first():
    found = from_zero(log([1.7e9, 1.7e9 + 0.5]))
    assert found.channels["x"].time.tolist() == [0.0, 0.5]
    assert found.start.isoformat() == "2023-11-14T22:13:20+00:00"
    assert from_zero(log([5.0, 6.0])).channels["x"].time.tolist() == [5.0, 6.0]


def test_topics_that_come_one_after_the_other():
    """As in a ULog that pyulog has read: rows are counted topic by topic."""
    one = channel("one", "m", np.arange(100.0), np.arange(100.0), np.arange(1, 101))
    two = channel("two", "m", np.arange(100.0), np.arange(100.0), np.arange(101, 201))
    found = steady(Log(Path("boat.ulg"), {"one": one, "two": two}))
    assert found.notes == ()
    assert found.channels["two"].time.tolist() == two.time.tolist()
