import math
import struct
from dataclasses import replace

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from pymavlink import mavwp

from seatrial.errors import InputError
from seatrial_kits.mavlink.missions.plan import Plans, read_items, write_items
from seatrial_kits.mavlink.missions.plan_items import NOT_GIVEN, Item, from_message

from .bench import Bench
from .ground import (
    FENCE,
    GLOBAL,
    MISSION,
    MISSION_FRAME,
    RALLY,
    RELATIVE,
    content,
    download,
    listed,
    north_of,
    one,
    save,
    upload,
)

HEAD = "QGC WPL 110\n"
LINE = "0\t1\t3\t16\t0\t0\t0\t0\t-31.78\t-52.26\t1.5\t1\n"
MISSION_ITEMS = listed(
    one(16, 2.5, z=-3.25, at=(-31.7801234, -52.2605679)),
    one(178, 1.0, 1.5, -1.0, frame=MISSION_FRAME, at=(0, 0)),
    one(at=north_of(20), frame=GLOBAL),
)

floats = st.floats(width=32, allow_infinity=False)
items = st.builds(
    Item,
    command=st.integers(0, 0xFFFF),
    frame=st.integers(0, 0xFF),
    parameters=st.tuples(floats, floats, floats, floats),
    x=st.integers(-(2**31) + 1, 2**31 - 1),
    y=st.integers(-(2**31) + 1, 2**31 - 1),
    z=floats,
    autocontinue=st.integers(0, 0xFF),
)


@pytest.fixture
def path(tmp_path):
    return tmp_path / "mission.waypoints"


def plans(folder, **bench):
    return Plans(Bench(**bench).vehicle, folder)


@given(st.lists(items, max_size=5))
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_what_is_written_is_read(path, written):
    write_items(path, written)
    assert repr(read_items(path)) == repr(tuple(written))  # not a number is none, by repr


def test_coordinates_that_are_not_given(path):
    item = Item(16, RELATIVE, (0.0, 0.0, 0.0, math.nan), NOT_GIVEN, NOT_GIVEN, math.nan)
    write_items(path, [item])
    assert repr(read_items(path)) == repr((item,))


def test_ground_stations_read_what_is_written(path):
    write_items(path, [from_message(m) for m in MISSION_ITEMS])
    loader = mavwp.MAVWPLoader()
    assert loader.load(str(path)) == len(MISSION_ITEMS)
    for sequence, sent in enumerate(MISSION_ITEMS):
        found = loader.wp(sequence)
        assert (found.seq, found.frame, found.command) == (sequence, sent.frame, sent.command)
        assert (found.param1, found.param2, found.z) == (sent.param1, sent.param2, sent.z)
        if sent.frame != MISSION_FRAME:
            assert (round(found.x * 1e7), round(found.y * 1e7)) == (sent.x, sent.y)


def test_files_of_ground_stations_are_read(path):
    save(MISSION_ITEMS, path)
    for found, message in zip(read_items(path), MISSION_ITEMS, strict=True):
        sent = from_message(message)
        assert replace(found, x=sent.x, y=sent.y) == sent
        if sent.frame != MISSION_FRAME:
            # They write six decimals.
            assert (found.x, found.y) == pytest.approx((sent.x, sent.y), abs=5)


def test_comments_and_empty_lines(path):
    path.write_text(f"{HEAD}# a comment of all\n\n{LINE}   \n#\n{LINE}")
    assert len(read_items(path)) == 2


def test_a_file_that_is_not_there_is_empty(path):
    assert read_items(path) == ()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "its first line must be 'QGC WPL 110'"),
        ("QGC WPL 100\n", "its first line must be 'QGC WPL 110'"),
        (HEAD + LINE + LINE.replace("\t1\n", "\n"), "line 3: .* is no item of 12 columns"),
        (HEAD + LINE.replace("16", "x"), "line 2"),
        (HEAD + LINE.replace("16", "-1"), "line 2"),
        (HEAD + LINE.replace("16", "65536"), "line 2"),
        (HEAD + LINE.replace("\t3\t", "\t256\t"), "line 2"),
        (HEAD + LINE.replace("1.5", "1e39"), "line 2"),
        (HEAD + LINE.replace("1.5", "1,5"), "line 2"),
    ],
)
def test_anything_else_is_refused_with_its_line(path, text, message):
    path.write_text(text)
    with pytest.raises(InputError, match=message):
        read_items(path)


def test_files_that_are_no_text(path):
    path.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(InputError, match="not UTF-8"):
        read_items(path)
    path.unlink()
    path.mkdir()
    with pytest.raises(InputError, match="plan file"):
        read_items(path)


def test_lists_outlive_the_run(tmp_path):
    lists = {
        MISSION: MISSION_ITEMS,
        FENCE: listed(one(5003, 50.0), kind=FENCE),
        RALLY: listed(one(5100, at=north_of(30)), kind=RALLY),
    }
    first = plans(tmp_path)
    for kind, messages in lists.items():
        assert first.of_kind(kind).replace([from_message(m) for m in messages]) is None
    names = sorted(path.name for path in tmp_path.iterdir())
    assert names == ["fence.waypoints", "mission.waypoints", "rally.waypoints"]
    second = plans(tmp_path)
    assert [plan.items for plan in second.all] == [plan.items for plan in first.all]


def test_a_node_uses_its_folder(tmp_path):
    bench = Bench(plans=tmp_path)
    upload(bench, MISSION_ITEMS)
    found = download(Bench(plans=tmp_path))
    assert [content(m) for m in found[1:]] == [content(m) for m in MISSION_ITEMS[1:]]


def test_a_list_that_the_vehicle_does_not_take_is_refused(tmp_path):
    save(listed(one(), one(180)), tmp_path / "mission.waypoints")
    with pytest.raises(
        InputError, match=r"mission\.waypoints: item 2, DO_SET_PARAMETER: is not supp"
    ):
        plans(tmp_path)


def test_a_folder_that_is_none(tmp_path):
    with pytest.raises(InputError, match="there is no such folder"):
        plans(tmp_path / "none")


def test_a_list_that_cannot_be_written_is_not_taken(tmp_path):
    bench = Bench(plans=tmp_path)
    upload(bench, MISSION_ITEMS)
    path = tmp_path / "mission.waypoints"
    path.unlink()
    path.mkdir()  # nothing can replace it, not even for the superuser
    (path / "full").touch()
    assert upload(bench, listed(one(at=north_of(7)))) == 1
    assert "cannot be written" in "".join(bench.texts())
    assert len(download(bench)) == len(MISSION_ITEMS)
    assert [p.name for p in tmp_path.iterdir()] == ["mission.waypoints"]


def test_floats_are_kept_as_messages_carry_them(path):
    path.write_text(HEAD + LINE.replace("1.5", "0.1"))
    (item,) = read_items(path)
    assert item.z == struct.unpack("<f", struct.pack("<f", 0.1))[0]
