"""Arbitration and timing of frames, worked out bit by bit at 1 bit per us."""

from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from seatrial_kits.can.bits import INTERMISSION, length
from seatrial_kits.can.frame import Frame

from .bench import US, Bench

# Lengths worked out by hand in test_bits.
ZERO = Frame(0)  # 50 bits
ZERO_REMOTE = Frame(0, remote=True)  # 47
ZERO_EXTENDED = Frame(0, extended=True)  # 71


def test_an_idle_bus_is_taken_at_once_and_kept_for_the_intermission():
    bench = Bench(2)
    bench.request(10, 0, ZERO)
    bench.request(20, 0, ZERO)
    bench.request(200, 0, ZERO)
    bench.run(300)
    assert bench.times == [(10, 60, 0), (63, 113, 0), (200, 250, 0)]
    assert [s.requested_ps // US for s in bench.sent] == [10, 20, 200]
    assert bench.bus.busy_ps == 3 * 53 * US
    assert [(n.sent, n.received, n.tec, n.rec) for n in bench.nodes] == [(3, 0, 0, 0), (0, 3, 0, 0)]


def test_fractions_of_a_bit_are_kept():
    """At 800 kbit/s a bit lasts 1.25 us: 50 of them 62.5."""
    bench = Bench(2, rate=800_000)
    bench.request(0.25, 0, ZERO)
    bench.request(1, 0, ZERO)
    bench.run(300)
    assert bench.times == [(0.25, 62.75, 0), (66.5, 129, 0)]


def test_the_data_phase_of_fd_has_its_own_rate():
    """28 bits at 1 Mbit/s and 33 at 2 Mbit/s: 44.5 us."""
    bench = Bench(2)
    bench.request(0, 0, Frame(0, fd=True, bit_rate_switch=True))
    bench.request(0, 0, ZERO)
    bench.run(200)
    assert bench.times == [(0, 44.5, 0), (47.5, 97.5, 0)]


def test_the_lowest_arbitration_field_goes_first():
    """Data before remote, base before extended with the same first 11 bits: 50 + 3, 47 + 3, 71."""
    bench = Bench(4)
    bench.request(0, 0, Frame(0x001))
    bench.request(0, 1, ZERO_EXTENDED)
    bench.request(0, 2, ZERO_REMOTE)
    bench.request(0, 3, ZERO)
    bench.run(1000)
    assert [s.senders for s in bench.sent] == [[3], [2], [1], [0]]
    assert bench.times[:3] == [(0, 50, 0), (53, 100, 0), (103, 174, 0)]


def test_a_frame_requested_in_the_last_bit_of_the_intermission_takes_part():
    bench = Bench(3)
    bench.request(0, 0, ZERO)
    bench.request(1, 1, Frame(0x400))
    bench.request(53, 2, ZERO)
    bench.run(110)
    assert bench.times == [(0, 50, 0), (53, 103, 0)]
    assert bench.sent[1].senders == [2]


def test_with_one_mailbox_an_urgent_frame_waits_behind_others():
    """Priority inversion: 0x010 of a waits for its 0x700, and that for all of b's 0x100.

    With two mailboxes a sends 0x010 as soon as the bus is free.
    """
    waited = {}
    for mailboxes in (1, 2):
        bench = Bench(2, mailboxes=mailboxes)
        bench.request(0, 1, Frame(0x100))
        bench.request(1, 0, Frame(0x700))
        bench.request(2, 0, Frame(0x010))
        bench.request(3, 1, Frame(0x100))
        bench.request(4, 1, Frame(0x100))
        bench.run(1000)
        waited[mailboxes] = [identifier for _, _, identifier in bench.times]
    assert waited == {
        1: [0x100, 0x100, 0x100, 0x700, 0x010],
        2: [0x100, 0x010, 0x100, 0x100, 0x700],
    }


def test_a_full_queue_drops_and_a_mailbox_is_free_when_its_frame_has_ended():
    """One mailbox, a queue of two: three have a place. The first ends at 50 and leaves its place."""
    bench = Bench(2, mailboxes=1, queue=2)
    for _ in range(5):
        bench.request(0, 0, ZERO)
    bench.run(49)
    assert (bench.nodes[0].waiting, bench.nodes[0].dropped) == (3, 2)
    bench.request(49.5, 0, ZERO)
    bench.request(50.5, 0, ZERO)
    bench.run(1000)
    assert bench.nodes[0].dropped == 3
    assert [start for start, _, _ in bench.times] == [0, 53, 106, 159]


def test_equal_identifiers_of_a_node_stay_in_order():
    bench = Bench(2)
    frames = [Frame(0x321, bytes([number])) for number in range(20)]
    for number, frame in enumerate(frames):
        bench.request(number, 0, frame)
    bench.run(10_000)
    assert [s.frame for s in bench.sent] == frames


def test_a_node_that_does_not_wait_is_notified_of_a_lost_arbitration():
    """The frame is given up when the one that won has ended; alone, it goes through."""
    bench = Bench(2)
    bench.nodes[1].waits = False
    bench.request(0, 0, ZERO)
    bench.request(0, 1, Frame(0x100))
    bench.request(100, 1, Frame(0x200))
    bench.run(1000)
    assert [(g.when_ps / US, g.node, g.frame.identifier) for g in bench.given_up] == [
        (50, 1, 0x100)
    ]
    assert [identifier for _, _, identifier in bench.times] == [0, 0x200]
    node = bench.nodes[1]
    assert (node.asked, node.sent, node.dropped) == (2, 1, 1)


@pytest.mark.parametrize("seed", range(5))
def test_a_saturated_bus_carries_its_bit_rate(seed):
    """Bits of frames and intermissions over time: all of it, to 0.1 %."""
    bench, frames = Bench(3), 400
    for number in range(frames):
        bench.request(0, number % 3, Frame(0x100 + (37 * number + seed) % 512, bytes([seed]) * 8))
    bench.run(60_000)
    bits = sum(sum(length(s.frame)) + INTERMISSION for s in bench.sent)
    assert bench.sent[-1].end_ps / US + INTERMISSION == pytest.approx(bits, rel=1e-3)
    assert (
        len(bench.sent)
        == sum(n.sent for n in bench.nodes)
        == frames - sum(n.dropped for n in bench.nodes)
    )


requests = st.lists(
    st.tuples(
        st.integers(0, 20_000),
        st.integers(0, 3),
        st.integers(0, 15),
        st.booleans(),
        st.binary(max_size=8),
    ),
    max_size=60,
)


@settings(max_examples=60, deadline=None)
@given(requests, st.integers(1, 3), st.integers(0, 4), st.floats(0, 0.02))
def test_what_is_requested_is_sent_dropped_or_waits(requested, mailboxes, queue, rate):
    """Conservation, causality and an exclusive bus, with errors at every 1/rate-th bit."""

    def error_injector(attempt, node, frame, bits):
        from seatrial_kits.can.simulated_bus import Disturbance

        hit = int(attempt * bits * rate) - int((attempt - 1) * bits * rate)
        return Disturbance(attempt * 7919 % bits) if hit else None

    bench = Bench(4, mailboxes=mailboxes, queue=queue, error_injector=error_injector)
    for when, node, identifier, extended, data in requested:
        bench.request(when, node, Frame(identifier, data, extended))
    for until in (5_000, 12_000, 15_000, 40_000):
        bench.run(until)
        busy = sum(s.end_ps - s.start_ps for s in bench.sent) / US
        assert busy <= bench.bus.busy_ps / US <= until
        for node, controller in enumerate(bench.nodes):
            due = sum(1 for when, n, *_ in requested if n == node and when < until)
            assert controller.asked == due
            assert controller.asked == controller.sent + controller.dropped + controller.waiting
    for sent in bench.sent:
        assert sent.requested_ps <= sent.start_ps
        bits = length(sent.frame)
        assert sent.end_ps - sent.start_ps == bits.nominal * US
    for one, next_one in pairwise(bench.sent):
        assert next_one.start_ps >= one.end_ps + INTERMISSION * US


@settings(max_examples=40, deadline=None)
@given(requests, st.lists(st.integers(1, 40_000), max_size=30))
def test_how_often_it_is_stepped_changes_nothing(requested, stops):
    whole, parts = Bench(4, queue=3), Bench(4, queue=3)
    for bench in (whole, parts):
        for when, node, identifier, extended, data in requested:
            bench.request(when, node, Frame(identifier, data, extended))
    for stop in sorted(stops):
        parts.run(stop)
    for bench in (whole, parts):
        bench.run(50_000)
    assert whole.sent == parts.sent
    assert whole.broken == parts.broken
    assert whole.nodes == parts.nodes
    assert whole.bus.busy_ps == parts.bus.busy_ps
