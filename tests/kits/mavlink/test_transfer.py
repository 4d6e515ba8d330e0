import math

import pytest
from pymavlink.dialects.v20 import all as mavlink

from seatrial_kits.mavlink.missions.plan import MOST_ITEMS

from .bench import ORIGIN, OTHER_STATION, STATION, Bench
from .ground import (
    ALL,
    DELAY,
    FENCE,
    GLOBAL,
    JUMP,
    LATITUDE,
    LOCAL,
    LONGITUDE,
    MISSION,
    MISSION_FRAME,
    RALLY,
    SPEED,
    TERRAIN,
    WAYPOINT,
    Client,
    LossyTransport,
    as_float,
    content,
    download,
    item,
    listed,
    north_of,
    one,
    upload,
)

ACCEPTED, ERROR, BAD_FRAME, UNSUPPORTED, NO_SPACE, INVALID = range(6)
BAD_P1, BAD_P2, BAD_P3, BAD_P4, BAD_X, BAD_Y, BAD_Z = range(6, 13)
BAD_SEQUENCE, DENIED, CANCELLED = 13, 14, 15
NAN, INFINITE = math.nan, math.inf
TRIANGLE = [north_of(-100, -100), north_of(100, -100), north_of(0, 100)]

MISSION_ITEMS = listed(
    one(WAYPOINT, 2.5, 4.0, 0.0, NAN, at=(-31.7801234, -52.2605679), z=-3.25),
    one(SPEED, 1.0, 1.5, -1.0, frame=MISSION_FRAME, at=(0, 0)),
    one(WAYPOINT, at=north_of(20), frame=GLOBAL),
    one(112, 5.0, at=(1e-7, 2e-7), frame=MISSION_FRAME),
    one(JUMP, 1.0, 2.0, frame=MISSION_FRAME, at=(0, 0)),
)
FENCE_ITEMS = listed(*(one(5001, 3.0, at=place) for place in TRIANGLE), one(5004, 12.5), kind=FENCE)
RALLY_ITEMS = listed(one(5100, z=7.0), one(5100, at=north_of(80)), kind=RALLY)
LISTS = {MISSION: MISSION_ITEMS, FENCE: FENCE_ITEMS, RALLY: RALLY_ITEMS}
kinds = pytest.mark.parametrize("kind", LISTS)


@pytest.fixture
def bench():
    return Bench()


def same(found, sent, first=0):
    """Return whether items are the same; what is not a number is the same as itself."""
    return repr([content(m) for m in found[first:]]) == repr([content(m) for m in sent[first:]])


def count(items, kind=MISSION):
    return mavlink.MAVLink_mission_count_message(7, 1, items, kind)


def acks(bench, sender=STATION):
    return [m.type for m in bench.transport.take("MISSION_ACK", sender.link)]


def texts(bench):
    """Return the status texts: pieces of a sentence joined, and all sentences too."""
    return "".join(bench.texts())


def requested(bench, sender=STATION):
    """Return the items that are requested, and by which message."""
    expected = bench.transport.take(link=sender.link)
    return [(m.get_type(), m.seq) for m in expected if m.get_type().startswith("MISSION_REQUEST")]


# ---------------------------------------------------------------------- whole lists


@kinds
def test_what_is_uploaded_comes_back(bench, kind):
    assert upload(bench, LISTS[kind], kind) == ACCEPTED
    assert same(download(bench, kind), LISTS[kind], first=kind == MISSION)
    assert all(download(bench, other) == [] for other in LISTS if other != kind)


@kinds
def test_what_is_uploaded_comes_back_from_a_px4(kind):
    bench = Bench(autopilot="px4")
    assert upload(bench, LISTS[kind], kind) == ACCEPTED
    assert same(download(bench, kind), LISTS[kind])


@kinds
def test_old_clients_send_and_get_floats(bench, kind):
    floats = [as_float(m) for m in LISTS[kind]]
    assert upload(bench, LISTS[kind], kind, sends=floats) == ACCEPTED
    request = mavlink.MAVLink_mission_request_message
    for found, sent in zip(download(bench, kind, request=request), floats, strict=True):
        assert found.get_type() == "MISSION_ITEM"
        if kind != MISSION or found.seq:
            assert found.x == pytest.approx(sent.x, abs=1e-12)
            assert found.y == pytest.approx(sent.y, abs=1e-12)


def test_degrees_are_rounded():
    bench = Bench(autopilot="px4")
    sent = item(0, at=(0, 0), frame=GLOBAL)
    as_sent = as_float(sent)
    as_sent.x, as_sent.y = -31.7812347, -52.2600005
    assert int(as_sent.y * 1e7) == -522600004  # cut off
    assert upload(bench, [sent], sends=[as_sent]) == ACCEPTED
    (found,) = download(bench)
    assert (found.x, found.y) == (-317812347, -522600005)


def test_item_0_of_an_ardupilot_is_home_whatever_was_sent(bench):
    bench.vehicle.home_n = (0.0, 0.0, -4.0)
    mission = listed(one(at=north_of(10)))
    mission[0] = item(0, 4711, INFINITE, at=(12, 13), frame=TERRAIN)
    assert upload(bench, mission) == ACCEPTED
    home, waypoint = download(bench)
    assert (home.command, home.frame) == (WAYPOINT, GLOBAL)
    assert (home.x, home.y) == (round(LATITUDE * 1e7), round(LONGITUDE * 1e7))
    assert home.z == ORIGIN.altitude + 4.0
    assert content(waypoint) == content(mission[1])


def test_a_px4_has_no_home_item():
    bench = Bench(autopilot="px4")
    assert upload(bench, listed(one(4711), home=False)) == UNSUPPORTED


@kinds
def test_an_empty_upload_clears(bench, kind):
    upload(bench, LISTS[kind], kind)
    assert upload(bench, [], kind) == ACCEPTED
    assert download(bench, kind) == []


@pytest.mark.parametrize("cleared", [MISSION, FENCE, RALLY, ALL])
def test_clear(bench, cleared):
    for kind, items in LISTS.items():
        upload(bench, items, kind)
    bench.receive(mavlink.MAVLink_mission_clear_all_message(7, 1, cleared))
    assert acks(bench) == [ACCEPTED]
    left = [kind for kind in LISTS if download(bench, kind)]
    assert left == [kind for kind in LISTS if cleared not in (kind, ALL)]


# ---------------------------------------------------------------------- time and order


def test_items_that_do_not_come_are_requested_again(bench):
    bench.receive(count(3))
    bench.receive(MISSION_ITEMS[0])
    bench.transport.take()
    bench.wait(0.99)
    assert requested(bench) == []
    for _ in range(6):
        bench.wait(0.01)
        assert requested(bench) == [("MISSION_REQUEST_INT", 1)]
        bench.wait(0.99)


def test_a_station_that_knows_no_integers_is_sent_float_requests(bench):
    bench.receive(count(3))
    bench.wait(3.0)
    assert requested(bench) == [("MISSION_REQUEST_INT", 0)] * 3 + [("MISSION_REQUEST", 0)]
    for sequence in (1, 2):
        bench.receive(as_float(MISSION_ITEMS[sequence - 1]))
        bench.wait(1.0)
        expected = [("MISSION_REQUEST_INT", sequence), ("MISSION_REQUEST", sequence)]
        assert requested(bench) == expected
    bench.receive(as_float(MISSION_ITEMS[2]))
    assert acks(bench) == [ACCEPTED]


def test_an_upload_without_items_ends_and_nothing_is_changed(bench):
    upload(bench, MISSION_ITEMS)
    bench.receive(count(2))
    bench.wait(5.0)
    bench.receive(MISSION_ITEMS[0])
    bench.wait(7.99)
    assert acks(bench) == []
    bench.wait(0.01)
    assert acks(bench) == [CANCELLED]
    assert "Mission: upload timed out, nothing is changed" in texts(bench)
    bench.transport.take()
    bench.receive(MISSION_ITEMS[1])
    bench.wait(20.0)
    assert requested(bench) == []
    assert same(download(bench), MISSION_ITEMS, first=1)


def test_duplicates_are_ignored(bench):
    bench.receive(count(3))
    for message in MISSION_ITEMS[:3]:
        bench.receive(message)
        bench.receive(message)
    # A duplicate of the last one: its sender missed the answer.
    assert requested(bench) == [("MISSION_REQUEST_INT", n) for n in range(3)]
    bench = Bench()
    bench.receive(count(3))
    for message in MISSION_ITEMS[:3]:
        bench.receive(message)
    bench.receive(MISSION_ITEMS[1])
    bench.receive(MISSION_ITEMS[2])
    assert acks(bench) == [ACCEPTED, ERROR, ACCEPTED]


def test_a_refusal_that_was_missed_is_repeated_too(bench):
    wrong = listed(one(180))
    assert upload(bench, wrong) == UNSUPPORTED
    bench.receive(wrong[-1])
    assert acks(bench) == [UNSUPPORTED]


def test_an_item_too_far_ahead_is_not_taken(bench):
    bench.receive(count(3))
    bench.receive(MISSION_ITEMS[2])
    assert requested(bench) == [("MISSION_REQUEST_INT", 0), ("MISSION_REQUEST_INT", 0)]
    for message in MISSION_ITEMS[:3]:
        bench.receive(message)
    assert acks(bench) == [ACCEPTED]
    assert same(download(bench), MISSION_ITEMS[:3], first=1)


def test_items_that_nobody_requested_are_errors(bench):
    for message in MISSION_ITEMS:
        bench.receive(message)
    assert acks(bench) == [ERROR] * len(MISSION_ITEMS)
    assert download(bench) == []


def test_items_of_another_kind_are_ignored(bench):
    bench.receive(count(2, RALLY))
    bench.receive(MISSION_ITEMS[0])
    bench.receive(RALLY_ITEMS[0])
    assert requested(bench) == [("MISSION_REQUEST_INT", 0), ("MISSION_REQUEST_INT", 1)]


def test_a_repeated_count_begins_again(bench):
    bench.receive(count(3))
    bench.receive(MISSION_ITEMS[0])
    bench.transport.take()
    assert upload(bench, MISSION_ITEMS) == ACCEPTED
    assert same(download(bench), MISSION_ITEMS, first=1)


def test_an_upload_is_cancelled_by_its_sender(bench):
    upload(bench, MISSION_ITEMS)
    bench.receive(count(2))
    bench.receive(MISSION_ITEMS[0])
    bench.receive(mavlink.MAVLink_mission_ack_message(7, 1, CANCELLED, MISSION), OTHER_STATION)
    bench.receive(mavlink.MAVLink_mission_ack_message(7, 1, CANCELLED, FENCE))
    bench.transport.take()
    bench.wait(1.0)
    assert requested(bench) == [("MISSION_REQUEST_INT", 1)]
    bench.receive(mavlink.MAVLink_mission_ack_message(7, 1, CANCELLED, MISSION))
    bench.wait(20.0)
    assert requested(bench) == []
    assert "Mission: upload cancelled, nothing is changed" in texts(bench)
    assert same(download(bench), MISSION_ITEMS, first=1)


# ---------------------------------------------------------------------- several stations


@pytest.mark.parametrize(
    "attempt",
    [
        count(2),
        count(0),
        mavlink.MAVLink_mission_write_partial_list_message(7, 1, 0, 0, MISSION),
        *(mavlink.MAVLink_mission_clear_all_message(7, 1, kind) for kind in (MISSION, ALL)),
    ],
)
def test_a_second_station_is_denied_while_one_uploads(bench, attempt):
    bench.receive(count(len(MISSION_ITEMS)))
    bench.receive(MISSION_ITEMS[0])
    bench.receive(attempt, OTHER_STATION)
    assert acks(bench, OTHER_STATION) == [DENIED]
    bench.receive(MISSION_ITEMS[1], OTHER_STATION)
    for message in MISSION_ITEMS[1:]:
        bench.receive(message)
    assert acks(bench) == [ACCEPTED]
    assert upload(bench, RALLY_ITEMS, RALLY, OTHER_STATION) == ACCEPTED


def test_a_download_is_of_one_list_whatever_is_uploaded_meanwhile(bench):
    upload(bench, MISSION_ITEMS)
    ask = mavlink.MAVLink_mission_request_int_message
    bench.receive(mavlink.MAVLink_mission_request_list_message(7, 1, MISSION), OTHER_STATION)
    bench.receive(ask(7, 1, 1, MISSION), OTHER_STATION)
    first = bench.transport.take("MISSION_ITEM_INT")
    other = listed(one(at=north_of(99)), one(at=north_of(98)))
    assert upload(bench, other) == ACCEPTED
    bench.receive(ask(7, 1, 3, MISSION), OTHER_STATION)
    assert same(
        [*first, *bench.transport.take("MISSION_ITEM_INT")], [MISSION_ITEMS[1], MISSION_ITEMS[3]]
    )
    bench.receive(mavlink.MAVLink_mission_ack_message(7, 1, ACCEPTED, MISSION), OTHER_STATION)
    bench.receive(ask(7, 1, 1, MISSION), OTHER_STATION)
    assert same(bench.transport.take("MISSION_ITEM_INT"), other[1:2])


def test_what_was_offered_is_forgotten_after_a_while(bench):
    upload(bench, MISSION_ITEMS)
    bench.receive(mavlink.MAVLink_mission_request_list_message(7, 1, MISSION), OTHER_STATION)
    upload(bench, MISSION_ITEMS[:2])
    bench.wait(31.0)
    bench.transport.take()
    bench.receive(mavlink.MAVLink_mission_request_int_message(7, 1, 3, MISSION), OTHER_STATION)
    assert acks(bench, OTHER_STATION) == [BAD_SEQUENCE]


# ---------------------------------------------------------------------- refusals


def test_an_item_that_is_not_there(bench):
    upload(bench, MISSION_ITEMS)
    bench.receive(mavlink.MAVLink_mission_request_int_message(7, 1, len(MISSION_ITEMS), MISSION))
    assert acks(bench) == [BAD_SEQUENCE]


@pytest.mark.parametrize(
    "message",
    [
        count(2, 3),
        mavlink.MAVLink_mission_request_list_message(7, 1, 4),
        mavlink.MAVLink_mission_request_list_message(7, 1, ALL),
        mavlink.MAVLink_mission_clear_all_message(7, 1, 9),
        mavlink.MAVLink_mission_request_int_message(7, 1, 0, 77),
        mavlink.MAVLink_mission_write_partial_list_message(7, 1, 0, 1, 3),
    ],
)
def test_kinds_that_are_not_supported(bench, message):
    bench.receive(message)
    (answer,) = bench.transport.take("MISSION_ACK", STATION.link)
    assert (answer.type, answer.mission_type) == (UNSUPPORTED, message.mission_type)


def test_each_kind_of_list_has_its_own_upload(bench):
    bench.receive(count(2))
    bench.receive(MISSION_ITEMS[0])
    assert upload(bench, RALLY_ITEMS, RALLY, OTHER_STATION) == ACCEPTED
    bench.receive(MISSION_ITEMS[1])
    assert acks(bench) == [ACCEPTED]


@pytest.mark.parametrize(("first", "last"), [(1, 1), (1, 2), (2, 4)])
def test_a_part_is_written(bench, first, last):
    upload(bench, MISSION_ITEMS[:4])
    part = [item(n, at=north_of(70 + n)) for n in range(first, last + 1)]
    bench.receive(mavlink.MAVLink_mission_write_partial_list_message(7, 1, first, last, MISSION))
    for message in part:
        bench.receive(message)
    assert acks(bench) == [ACCEPTED]
    wanted = [*MISSION_ITEMS[:first], *part, *MISSION_ITEMS[last + 1 : 4]]
    assert same(download(bench), wanted, first=1)


@pytest.mark.parametrize(("first", "last"), [(2, 1), (-1, -1), (1, 5), (5, 6)])
def test_what_is_no_part_is_refused(bench, first, last):
    upload(bench, MISSION_ITEMS[:4])
    bench.receive(mavlink.MAVLink_mission_write_partial_list_message(7, 1, first, last, MISSION))
    assert acks(bench) == [ERROR]


def test_too_many_items(bench):
    bench.receive(count(MOST_ITEMS + 1))
    assert acks(bench) == [NO_SPACE]
    many = [item(n, at=north_of(n / 10)) for n in range(MOST_ITEMS)]
    assert upload(bench, many) == ACCEPTED
    assert len(download(bench)) == MOST_ITEMS


@pytest.mark.parametrize(
    ("kind", "items", "result"),
    [
        (MISSION, [one(23)], UNSUPPORTED),  # landing, in local coordinates
        (MISSION, [one(180)], UNSUPPORTED),  # parameters
        (MISSION, [one(4711)], UNSUPPORTED),  # nothing
        (MISSION, [one(frame=TERRAIN)], BAD_FRAME),
        (MISSION, [one(frame=LOCAL)], BAD_FRAME),
        (MISSION, [one(frame=MISSION_FRAME)], BAD_FRAME),
        (MISSION, [one(frame=99)], BAD_FRAME),
        (MISSION, [one(at=(91, 0))], BAD_X),
        (MISSION, [one(at=(0, 181))], BAD_Y),
        (MISSION, [one(WAYPOINT, NAN)], BAD_P1),
        (MISSION, [one(WAYPOINT, 0.0, NAN)], BAD_P2),
        (MISSION, [one(WAYPOINT, 0.0, 0.0, NAN)], BAD_P3),
        (MISSION, [one(z=NAN)], BAD_Z),
        (MISSION, [one(z=83_000.0)], BAD_Z),
        (MISSION, [one(at=(30, 60))], BAD_X),  # another ocean
        (MISSION, [one(WAYPOINT, INFINITE)], BAD_P1),
        (MISSION, [one(WAYPOINT, 0.0, -INFINITE)], BAD_P2),
        (MISSION, [one(SPEED, 0.0, 0.0, INFINITE)], BAD_P3),
        (MISSION, [one(112, 0.0, 0.0, 0.0, INFINITE)], BAD_P4),
        (MISSION, [one(SPEED, z=INFINITE)], BAD_Z),
        (MISSION, [one(DELAY, -1.0)], BAD_P1),
        (MISSION, [one(DELAY, NAN)], BAD_P1),
        (MISSION, [one(), one(JUMP, 0.0)], ERROR),
        (MISSION, [one(), one(JUMP, 3.0)], ERROR),
        (MISSION, [one(), one(JUMP, 1.5)], ERROR),
        (MISSION, [one(), one(JUMP, NAN)], BAD_P1),
        (FENCE, [one()], UNSUPPORTED),
        (FENCE, [one(5003, 0.0)], ERROR),
        (FENCE, [one(5004, NAN)], ERROR),
        (FENCE, [one(5003, 5.0, frame=LOCAL)], BAD_FRAME),
        (FENCE, [one(5001, 3.0)] * 2, ERROR),
        (FENCE, [one(5001, 2.0)] * 2, ERROR),
        (FENCE, [one(5001, 3.0)] * 4, ERROR),
        (FENCE, [one(5001, 3.0), one(5001, 3.0), one(5002, 3.0)], ERROR),
        (FENCE, [one(5001, 3.0), one(5001, 4.0), one(5001, 3.0)], ERROR),
        (FENCE, [one(5001, 3.0, 1.0), one(5001, 3.0, 1.0), one(5001, 3.0, 2.0)], ERROR),
        (FENCE, [one(5001, 3.5)] * 4, ERROR),
        (RALLY, [one()], UNSUPPORTED),
        (RALLY, [one(5100, at=(95, 0))], BAD_X),
        (RALLY, [one(5100, frame=TERRAIN)], BAD_FRAME),
    ],
)
def test_bad_lists_are_refused_with_the_item_and_the_old_one_stays(bench, kind, items, result):
    upload(bench, LISTS[kind], kind)
    assert upload(bench, listed(*items, kind=kind), kind) == result
    assert "refused: item " in texts(bench)
    assert same(download(bench, kind), LISTS[kind], first=kind == MISSION)


def test_frames_of_submarines():
    bench = Bench(submerged=True)
    deep = listed(one(z=-20.0), one(z=-20.0, frame=GLOBAL), one(z=-20.0, frame=5))
    assert upload(bench, deep) == ACCEPTED
    assert upload(bench, listed(one(z=-2e6))) == BAD_Z


# ---------------------------------------------------------------------- bad transport


@pytest.mark.parametrize("seed", range(5))
@kinds
def test_transfers_survive_losses(kind, seed):
    bench = Bench(autopilot="px4")
    up, down = LossyTransport(seed), LossyTransport(seed + 1000)
    client = Client(lambda message: up.put(message, bench.now))
    sent = LISTS[kind] * 4 if kind != MISSION else MISSION_ITEMS
    sent = [item_renumbered(m, n) for n, m in enumerate(sent)]

    def until(done):
        for _ in range(12_000):
            bench.tick()
            for link, message in bench.transport.sent:
                if link in (None, STATION.link):
                    down.put(message, bench.now)
            bench.transport.sent.clear()
            for message in up.take(bench.now):
                bench.receive(message)
            for message in down.take(bench.now):
                client.receive(message, bench.now)
            client.tick(bench.now)
            if done():
                return True
        return False

    client.upload(sent, kind, bench.now)
    assert until(lambda: client.result is not None)
    assert client.result == ACCEPTED
    client.download(kind, bench.now)
    assert until(lambda: client.has_all)
    assert same(client.items, sent)
    assert up.lost + down.lost > 0


def item_renumbered(m, sequence):
    fields = {name: getattr(m, name) for name in m.fieldnames}
    return mavlink.MAVLink_mission_item_int_message(**{**fields, "seq": sequence})
