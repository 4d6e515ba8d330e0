"""Tables that play a log: short ones as CSV, long ones binary, the same values at the steps."""

import numpy as np
import pytest

from seatrial.errors import InputError
from seatrial.fmi.components.source import find_source
from seatrial_kits.logs.paired.resampling import Trace
from seatrial_kits.logs.shadow import tables

STEP_NS = 50_000_000


def trace(name, unit, time, values, *, held=False, gap=np.inf):
    return Trace(name, unit, time, values, held, gap)


@pytest.fixture
def traces():
    """50 s at 100 Hz and an order each second; north has a gap of 2 s."""
    time = 100.0 + np.arange(5000) / 100.0
    seen = (time < 120.0) | (time > 122.0)
    orders = np.arange(100.0, 151.0)
    return {
        "north": trace("north", "m", time[seen], np.sin(time[seen]), gap=0.05),
        "heading": trace("heading", "rad", time, np.cos(time)),
        "order": trace("order", "1", orders, np.arange(51.0) % 3, held=True),
    }


def played(path):
    """Return names, and the outputs at each step of 40 s."""
    component = find_source(path.name, path.parent).component_class()("log")
    component.set("beyond", "hold")
    component.setup(0.0)
    component.initialise()
    component.begin()
    names = ["north", "north_valid", "heading", "order"]
    rows = [[component.get(name) for name in names]]
    for k in range(800):
        component.advance(k * STEP_NS / 1e9, STEP_NS / 1e9)
        rows.append([component.get(name) for name in names])
    return rows


def test_a_long_table_plays_as_a_short_one(traces, tmp_path, monkeypatch):
    short = tables.write_table(traces, (100.0, 149.0), tmp_path, STEP_NS)
    monkeypatch.setattr(tables, "LARGEST", 0)
    long = tables.write_table(traces, (100.0, 149.0), tmp_path, STEP_NS)
    assert (short.suffix, long.suffix) == (".csv", ".table")
    rows = played(long)
    assert rows == played(short)
    assert [type(each) for each in rows[0]] == [float, bool, float, float]


def test_the_table_has_the_values_of_the_log_at_the_steps(traces, tmp_path):
    path = tables.write_table(traces, (100.0, 149.0), tmp_path, STEP_NS)
    assert len(path.read_text().splitlines()) == 1 + 49 * 20 + 1  # no row between two steps
    for k, (north, known, heading, order) in enumerate(played(path)):
        t = 100.0 + k / 20
        assert heading == pytest.approx(np.cos(t), abs=1e-9)
        assert order == int(t + 1e-9) % 100 % 3
        assert known == (not 119.995 < t < 122.005)
        if known:
            assert north == pytest.approx(np.sin(t), abs=1e-9)


def test_rows_between_steps_stay_where_the_log_is_slower(traces, tmp_path):
    path = tables.write_table({"order": traces["order"]}, (100.0, 149.0), tmp_path, STEP_NS)
    assert len(path.read_text().splitlines()) == 1 + 50


def test_a_long_table_is_no_fmu(traces, tmp_path, monkeypatch):
    monkeypatch.setattr(tables, "LARGEST", 0)
    path = tables.write_table(traces, (100.0, 149.0), tmp_path, STEP_NS)
    source = find_source(path.name, tmp_path)
    with pytest.raises(InputError, match="--engine direct"):
        source.portable()
    assert str(tmp_path) not in source.script.decode()  # equal tables have equal names
    with pytest.raises(InputError, match="--engine direct"):
        source.imported("Log")


def test_another_file_of_that_name_is_refused(tmp_path):
    (tmp_path / "my.table").write_text("time,x\n0,1\n")
    with pytest.raises(InputError, match=r"my\.table: no table that seatrial shadow has written"):
        find_source("my.table", tmp_path)
