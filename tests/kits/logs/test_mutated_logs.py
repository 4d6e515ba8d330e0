"""Bytes of logs changed, cut and doubled: an InputError, or a log whose channels are whole."""

from __future__ import annotations

import contextlib
from functools import cache

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from seatrial.errors import InputError
from seatrial.trial.logs.formats import FORMATS, read_log
from seatrial.trial.logs.quantities import Column, chosen, defaults
from seatrial_kits.logs.paired.common_time import together
from tests.kit import needs_kits
from tests.kits.logs import circle, writers

pytestmark = needs_kits("ardupilot", "logs", "mavlink", "nmea", "px4")
WRITERS = {
    "csv": writers.write_csv,
    "mcap": writers.write_mcap,
    "parquet": writers.write_parquet,
    "nmea0183": writers.write_nmea0183,
    "nmea2000": writers.write_candump,
    "tlog": writers.write_tlog,
    "ardupilot": writers.write_bin,
    "ulog": writers.write_ulog,
    "rosbag2": writers.write_bag,
}
TIME = {"csv": Column("UTC"), "parquet": Column("UTC")}


@pytest.fixture(scope="module")
def content(tmp_path_factory):
    """Return a function that gives the bytes of a log of 10 s."""

    @cache
    def written(name):
        path = tmp_path_factory.mktemp("logs") / name
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(circle, "END_S", 10.0)
            WRITERS[name](path)
        return next(path.glob("*.db3")).read_bytes() if path.is_dir() else path.read_bytes()

    return written


def mutated(data, draw):
    changed = bytearray(data)
    for _ in range(draw(st.integers(1, 4))):
        place = draw(st.integers(0, len(changed) - 1))
        match draw(st.sampled_from(("set", "cut", "insert", "double"))):
            case "set":
                changed[place] = draw(st.integers(0, 255))
            case "cut":
                del changed[place:]
            case "insert":
                changed[place:place] = draw(st.binary(min_size=1, max_size=20))
            case "double":
                changed[place:place] = changed[place : place + draw(st.integers(1, 300))]
        if not changed:
            break
    return bytes(changed)


@pytest.mark.parametrize("name", WRITERS)
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_mutated(tmp_path, content, name, data):
    path = tmp_path / "log.db3"
    path.write_bytes(mutated(content(name), data.draw))
    with contextlib.suppress(InputError):
        log = read_log(path, name, TIME.get(name))
        for channel in log.channels.values():
            assert len(channel.time) == len(channel.values) == len(channel.rows)
            assert not np.isinf(channel.values).any()
        found = chosen(log, {}, defaults(log))
        if "heading" in found:
            together(found, "heading")


@pytest.mark.parametrize("name", WRITERS)
def test_what_is_cut_is_read_up_to_there(tmp_path, content, name):
    if name in ("mcap", "parquet", "rosbag2"):  # their index stands at the end, or in pages
        return
    path = tmp_path / "log"
    path.write_bytes(content(name))
    whole = read_log(path, name, TIME.get(name))
    path.write_bytes(content(name)[:-3])
    cut = read_log(path, name, TIME.get(name))
    assert cut.channels.keys() == whole.channels.keys()
    for each, channel in cut.channels.items():
        assert len(whole.channels[each].values) - len(channel.values) in (0, 1)


@pytest.mark.parametrize("name", WRITERS)
@pytest.mark.parametrize("other", ["tlog", "csv"])
def test_another_format_is_refused(tmp_path, content, name, other):
    if name == other:
        return
    path = tmp_path / "log.db3"
    path.write_bytes(content(other))
    with pytest.raises(InputError, match=r"log\.db3|rosbags"):
        read_log(path, name)


def test_every_format_is_here():
    assert WRITERS.keys() | {"run"} == set(FORMATS.names())
