"""Fuzzing of mission messages: no crash, and a list is never half replaced."""

import math
import random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pymavlink.dialects.v20 import all as mavlink

from seatrial_kits.mavlink.transport import Sender

from .bench import OTHER_STATION, STATION, Bench
from .ground import ALL, FENCE, MISSION, RALLY, content, download, item, north_of, upload

CASES = 40

kinds = st.sampled_from([MISSION, MISSION, MISSION, FENCE, RALLY, ALL, 3])
counts = st.sampled_from([0, 1, 2, 3, 4, 1001, 0xFFFF])
sequences = st.sampled_from([0, 0, 1, 1, 2, 2, 3, 4, 0xFFFF])
commands = st.sampled_from(
    [16, 17, 18, 19, 20, 93, 112, 177, 177, 178, 179, 206, 22, 5000, 5001, 5002, 5003, 5004, 5100]
) | st.integers(0, 0xFFFF)
floats = st.sampled_from([0.0, 1.0, 2.0, 3.0, -1.0, math.nan, math.inf, 3e38]) | st.floats(width=32)
angles = st.sampled_from([0, -317800000, -522600000, 2**31 - 1, -(2**31)]) | st.integers(
    -(2**31), 2**31 - 1
)
frames = st.sampled_from([0, 2, 3, 3, 5, 6]) | st.integers(0, 255)


@st.composite
def items(draw):
    head = (
        7,
        1,
        draw(sequences),
        draw(frames),
        draw(commands),
        draw(st.sampled_from([0, 0, 1, 2])),
    )
    parameters = [draw(floats) for _ in range(4)]
    place = [draw(angles), draw(angles)]
    build = mavlink.MAVLink_mission_item_int_message
    if draw(st.booleans()):
        build = mavlink.MAVLink_mission_item_message
        place = [draw(floats), draw(floats)]
    return build(*head, 1, *parameters, *place, draw(floats), draw(kinds))


def of(build, *fields):
    return st.builds(lambda *values: build(7, 1, *values), *fields)


messages = st.one_of(
    items(),
    items(),
    of(mavlink.MAVLink_mission_count_message, counts, kinds),
    of(mavlink.MAVLink_mission_request_list_message, kinds),
    of(mavlink.MAVLink_mission_request_int_message, sequences, kinds),
    of(mavlink.MAVLink_mission_request_message, sequences, kinds),
    of(mavlink.MAVLink_mission_ack_message, st.integers(0, 255), kinds),
    of(mavlink.MAVLink_mission_clear_all_message, kinds),
    of(mavlink.MAVLink_mission_set_current_message, sequences),
    of(mavlink.MAVLink_mission_write_partial_list_message, st.integers(-9, 9), st.just(3), kinds),
    st.builds(
        lambda number, p: mavlink.MAVLink_command_long_message(7, 1, number, 0, *p, 0, 0, 0, 0),
        st.sampled_from([300, 193, 224, 178, 207, 400, 176, 20]),
        st.lists(floats, min_size=3, max_size=3),
    ),
)
steps = st.lists(st.tuples(messages, st.booleans(), st.floats(0.0, 12.0)), max_size=30)


@pytest.mark.slow
@settings(max_examples=CASES, deadline=None)
@given(steps, st.booleans(), st.sampled_from(["ardupilotmega", "px4"]))
def test_no_message_is_too_much(sent, submerged, autopilot):
    bench = Bench(submerged=submerged, autopilot=autopilot)
    bench.vehicle.armed = True
    for message, other, pause in sent:
        bench.receive(message, OTHER_STATION if other else STATION)
        bench.ticks += round(100 * pause)
        bench.tick()
        leg = bench.node.missions.leg
        bench.node.missions.reached = leg.number
        assert all(map(math.isfinite, (*leg.start, *leg.end, leg.speed, leg.radius, leg.wait)))
        assert math.isfinite(leg.circle)
        assert leg.radius > 0.0 or leg.number == 0


@settings(max_examples=CASES, deadline=None)
@given(st.randoms(use_true_random=False), st.lists(messages, max_size=20))
def test_a_list_is_the_old_one_or_the_new_one(order, noise):
    bench = Bench()
    old = [item(n, at=north_of(n)) for n in range(3)]
    new = [item(n, at=north_of(10 + n)) for n in range(5)]
    assert upload(bench, old) == 0
    # An upload with losses, repetitions and neighbours that change places, and a station that
    # sends anything in between but has no items.
    sent = [mavlink.MAVLink_mission_count_message(7, 1, len(new), MISSION), *new]
    sent = [(m, STATION) for m in sent for _ in range(order.choice([0, 1, 1, 1, 1, 2]))]
    for k in range(len(sent) - 1):
        if order.random() < 0.2:
            sent[k : k + 2] = sent[k + 1], sent[k]
    for message in noise:
        if not message.get_type().startswith("MISSION_ITEM"):
            sent.insert(order.randint(0, len(sent)), (message, OTHER_STATION))
    for message, sender in sent:
        bench.receive(message, sender)
        found = download(bench, sender=Sender(240, 190, 0))  # none while it is uploaded
        whole = [content(m) for m in found[1:]]
        assert whole in ([content(m) for m in old[1:]], [content(m) for m in new[1:]], [])


def test_lists_of_every_length_survive_an_upload_that_breaks_off():
    generator = random.Random(5)
    for _ in range(5):
        bench = Bench()
        old = [item(n, at=north_of(n)) for n in range(generator.randint(1, 6))]
        new = [item(n, at=north_of(50 + n)) for n in range(generator.randint(2, 6))]
        for m in (mavlink.MAVLink_mission_count_message(7, 1, len(old), MISSION), *old):
            bench.receive(m)
        bench.receive(mavlink.MAVLink_mission_count_message(7, 1, len(new), MISSION))
        for m in new[: generator.randint(0, len(new) - 1)]:
            bench.receive(m)
        bench.wait(11.0)
        assert [content(m) for m in download(bench)[1:]] == [content(m) for m in old[1:]]
