"""Errors and what they do to nodes (ISO 11898-1, fault confinement), bit by bit at 1 bit per us."""

import pytest

from seatrial_kits.can.bits import length
from seatrial_kits.can.controller import NOISE
from seatrial_kits.can.frame import Frame
from seatrial_kits.can.operations import Error, State
from seatrial_kits.can.simulated_bus import Disturbance

from .bench import US, Bench

ZERO = Frame(0)  # 50 bits
DATA = Frame(0x555, b"\x55")
FIRST_DATA_BIT = 19
ATTEMPT = FIRST_DATA_BIT + 1 + 6 + 8 + 3
"""A frame that is broken at that bit: 20 bits, flag, delimiter, intermission: 37."""


def broken_of(node, bit=FIRST_DATA_BIT, receiver=None):
    return lambda attempt, sender, frame, bits: (
        Disturbance(bit, receiver) if sender == node else None
    )


def test_a_broken_frame_is_sent_again():
    """Bits 0 to 19, 6 of flag and 8 of delimiter end at 34; it starts again 3 later."""
    once = iter([Disturbance(19)])
    bench = Bench(2, error_injector=lambda *_: next(once, None))
    bench.request(0, 0, DATA)
    bench.run(400)
    (sent,) = bench.times
    assert bench.failed_at == [34]
    assert sent[0] == ATTEMPT
    # + 8 for the sender, + 1 for the receiver, and - 1 for each after the frame that got through.
    assert [(n.tec, n.rec) for n in bench.nodes] == [(7, 0), (0, 0)]


def test_the_last_bit_before_an_error_may_be_of_the_data_phase():
    """FD with a switch: 16 bits, then BRS and ESI at 2 Mbit/s: 17 us; + 14."""
    bench = Bench(2, error_injector=lambda attempt, *_: Disturbance(17) if attempt == 1 else None)
    # 0x555 has no stuff bit there.
    bench.request(0, 0, Frame(0x555, fd=True, bit_rate_switch=True))
    bench.run(400)
    assert bench.failed_at == [16 + 1 + 14]


def test_bus_off_and_back():
    """Every frame of a is broken: + 8 each time.

    After 16 attempts a is error passive, and lets 8 more bits go by after each: attempts start at
    37 k, then at 16 x 37 + 8 = 600 and every 45. The 32nd, at 1275, takes it to 256: bus-off at its end,
    1309. From the end of the intermission at 1312 it counts 128 x 11 bits on an idle bus: 2720.
    """
    bench = Bench(2, error_injector=broken_of(0))
    bench.request(0, 0, DATA)
    bench.request(1, 0, DATA)
    a, b = bench.nodes
    bench.run(15 * ATTEMPT + 33)
    assert (a.state, a.tec) == (State.ERROR_ACTIVE, 120)
    bench.run(15 * ATTEMPT + 34)
    assert (a.state, a.tec, b.rec) == (State.ERROR_PASSIVE, 128, 16)
    bench.run(1308)
    assert (a.state, a.tec, a.waiting) == (State.ERROR_PASSIVE, 248, 2)
    bench.run(1309)
    assert (a.state, a.tec, a.waiting, a.dropped) == (State.BUS_OFF, 256, 0, 2)
    starts = [37 * k for k in range(16)] + [600 + 45 * k for k in range(16)]
    assert bench.failed_at == [start + 34 for start in starts]
    bench.bus.error_injector = lambda *_: None
    bench.request(2719, 0, ZERO)
    bench.request(2720, 0, ZERO)
    bench.run(2719.5)
    assert a.state is State.BUS_OFF
    bench.run(3000)
    assert (a.state, a.dropped, a.tec, a.rec) == (State.ERROR_ACTIVE, 3, 0, 0)
    assert bench.times == [(2720, 2770, 0)]


def test_off_the_bus_a_busy_bus_counts_one_sequence_per_frame():
    """b sends without a pause: 128 frames later a is back, not before."""
    bench = Bench(3, queue=1000, error_injector=broken_of(0))
    bench.request(0, 0, DATA)
    bench.run(1312)
    for _ in range(140):
        bench.request(1312, 1, ZERO)
    bench.run(1312 + 128 * 53 - 4)
    assert bench.nodes[0].off
    bench.run(1312 + 128 * 53)
    assert not bench.nodes[0].off
    assert bench.nodes[0].received == 0


def test_without_recovery_it_stays_off():
    bench = Bench(2, error_injector=broken_of(0), recovers=False)
    bench.request(0, 0, DATA)
    bench.run(1_000_000)
    assert bench.nodes[0].state is State.BUS_OFF


def test_alone_on_the_bus_it_stops_at_error_passive():
    """No acknowledgement: the bit of it, the 42nd of 50, then flag and delimiter: 56; + 3.

    + 8 until 128, at the 16th attempt; from then on the counter stays and it never goes off.
    """
    bench = Bench(1)
    bench.request(0, 0, ZERO)
    bench.run(16 * 59)
    (alone,) = bench.nodes
    assert bench.failed_at == [59 * k + 56 for k in range(16)]
    assert (alone.tec, alone.state) == (128, State.ERROR_PASSIVE)
    assert {broken.error for broken in bench.broken} == {Error.ACK}
    bench.run(100_000)
    assert (alone.tec, alone.state, alone.waiting) == (128, State.ERROR_PASSIVE, 1)
    assert bench.failed_at[16:18] == [16 * 59 + 8 + 56, 16 * 59 + 8 + 67 + 56]


def test_a_second_node_acknowledges_at_last():
    bench = Bench(2)
    bench.bus.unplug(1)
    bench.request(0, 0, ZERO)
    bench.run(2000)
    assert (bench.sent, bench.nodes[0].tec) == ([], 128)
    bench.bus.plug(1)
    bench.run(3000)
    assert len(bench.sent) == 1
    assert (bench.nodes[0].tec, bench.nodes[0].state) == (127, State.ERROR_ACTIVE)


def test_listeners_do_not_acknowledge():
    bench = Bench(2)
    bench.nodes[1].listens_only = True
    bench.request(0, 0, ZERO)
    bench.request(0, 1, ZERO)
    bench.run(2000)
    assert bench.sent == []
    assert bench.nodes[1].dropped == 1
    assert bench.nodes[1].rec == 0


def test_an_error_passive_node_lets_others_go_first():
    """a is passive and has two frames: after the first it waits 3 + 8 bits, and b is quicker."""
    bench = Bench(3)
    bench.nodes[0].tec = 140
    bench.request(0, 0, ZERO)
    bench.request(0, 0, ZERO)
    bench.request(55, 1, Frame(0x7F0))
    bench.request(300, 0, ZERO)
    bench.run(1000)
    last = 55 + length(Frame(0x7F0)).nominal + 3
    assert bench.times[:2] == [(0, 50, 0), (55, last - 3, 0x7F0)]
    assert bench.times[2][0] == last
    # Alone, it starts 8 bits later than an active node would.
    bench = Bench(2)
    bench.nodes[0].tec = 140
    bench.request(0, 0, ZERO)
    bench.request(0, 0, ZERO)
    bench.run(1000)
    assert bench.times == [(0, 50, 0), (61, 111, 0)]


def test_two_senders_of_one_identifier_break_each_other():
    """Their first data bit differs, bit 20: RTR, IDE, r0 and DLC 0001 have one stuff bit.

    21 bits, 12 of flag, 8 of delimiter: 41, + 3. + 8 for each, until both are passive after 16
    attempts and wait 8 bits; then the one that sends a one gives way: 17 x 8 = 136 against 127,
    and gets its turn afterwards.
    """
    zero, one = Frame(0x555, b"\x2a"), Frame(0x555, b"\xaa")
    bench = Bench(3)
    bench.request(0, 0, one)
    bench.request(0, 1, zero)
    bench.run(16 * 44)
    assert bench.failed_at == [44 * k + 41 for k in range(16)]
    assert [(n.tec, n.rec) for n in bench.nodes] == [(128, 0), (128, 0), (0, 16)]
    bench.run(16 * 44 + 8 + length(zero).nominal)
    assert [s.frame for s in bench.sent] == [zero]
    assert [n.tec for n in bench.nodes] == [136, 127, 0]
    bench.run(2000)
    assert [s.frame for s in bench.sent] == [zero, one]
    assert bench.sent[1].receivers == [1, 2]


def test_two_senders_of_the_same_frame_send_it_once():
    bench = Bench(3)
    bench.request(0, 0, ZERO)
    bench.request(0, 1, ZERO)
    bench.run(200)
    assert bench.times == [(0, 50, 0)]
    assert (bench.sent[0].senders, bench.sent[0].receivers) == ([0, 1], [2])


def test_an_error_that_one_receiver_sees_is_signalled_by_it_and_then_by_all():
    """Bit 30, then 12 bits of flag and 8 of delimiter: 51. The first has + 8 for a flag of its own."""
    bench = Bench(
        4, error_injector=lambda attempt, *_: Disturbance(30, 2) if attempt == 1 else None
    )
    bench.request(0, 0, ZERO)
    bench.run(53)
    assert bench.failed_at == [51]
    assert bench.broken[0].first == 2
    assert [(n.tec, n.rec) for n in bench.nodes] == [(8, 0), (0, 1), (0, 9), (0, 1)]
    bench.run(200)
    assert bench.times == [(54, 104, 0)]


def test_a_passive_receiver_only_loses_the_frame():
    bench = Bench(
        3, error_injector=lambda attempt, *_: Disturbance(30, 2) if attempt == 1 else None
    )
    bench.nodes[2].rec = 130
    bench.request(0, 0, ZERO)
    bench.run(200)
    assert bench.times == [(0, 50, 0)]
    assert bench.sent[0].receivers == [1]
    assert (bench.nodes[2].lost, bench.nodes[2].rec) == (1, 131)


def test_a_receiver_comes_back_to_error_active_with_the_next_good_frame():
    """Above 127 a success sets the counter to 127 (the standard allows 119 to 127)."""
    bench = Bench(2)
    bench.nodes[1].rec = 200
    bench.request(0, 0, ZERO)
    bench.run(60)
    assert bench.nodes[1].rec == 127


def test_a_babbling_node_keeps_the_bus_to_itself():
    bench = Bench(3)
    bench.nodes[2].babbles = True
    bench.request(0, 0, ZERO)
    each = length(NOISE).nominal + 3
    bench.run(100 * each)
    assert len(bench.sent) == 100
    assert {s.senders[0] for s in bench.sent} == {2}
    assert bench.bus.busy_ps == 100 * each * US
    bench.nodes[2].babbles = False
    bench.run(102 * each)
    assert bench.sent[-1].frame == ZERO
    assert bench.sent[-1].start_ps == 100 * each * US
    assert (bench.nodes[0].waiting, bench.nodes[2].waiting) == (0, 0)


def test_a_babbling_node_comes_back_from_bus_off_by_itself():
    """Off with its 32nd error frame, as above; the next one comes 3 + 128 x 11 bits later."""
    one, other = Bench(2, error_injector=broken_of(0)), Bench(2, error_injector=broken_of(0))
    for bench in (one, other):
        bench.nodes[0].babbles = True
    one.run(10_000)
    for until in range(0, 10_001, 7):
        other.run(until)
    other.run(10_000)
    assert one.failed_at == other.failed_at
    gaps = [b - a for a, b in zip(one.failed_at, one.failed_at[1:], strict=False)]
    assert max(gaps) == 3 + 128 * 11 + 34
    assert gaps.index(max(gaps)) == 31


def test_a_node_that_is_unplugged_in_its_frame():
    """Recessive from 20 on: the sixth such bit is the others' error, flag and delimiter: 40."""
    bench = Bench(3)
    bench.request(0, 0, ZERO)
    bench.request(0, 1, Frame(0x700))
    bench.run(20)
    bench.bus.unplug(0)
    bench.run(200)
    assert bench.failed_at == [40]
    assert bench.broken[0].senders == []
    assert [identifier for _, _, identifier in bench.times] == [0x700]
    assert bench.times[0][0] == 43
    assert (bench.nodes[0].dropped, bench.nodes[0].tec) == (1, 0)
    assert bench.bus.busy_ps == (43 + length(Frame(0x700)).nominal + 3) * US


def test_off_and_back_again():
    bench = Bench(3)
    bench.bus.unplug(2)
    bench.request(0, 2, ZERO)
    bench.request(0, 0, ZERO)
    bench.run(60)
    assert bench.sent[0].receivers == [1]
    assert bench.nodes[2].dropped == 1
    bench.request(70, 0, ZERO)
    bench.run(80)
    bench.bus.plug(2)  # in the middle of a frame: too late for that one
    bench.request(90, 0, ZERO)
    bench.run(300)
    assert [s.receivers for s in bench.sent] == [[1], [1], [1, 2]]


@pytest.mark.parametrize(
    ("tec", "rec", "state"), [(127, 127, 1), (128, 0, 2), (0, 128, 2), (255, 0, 2)]
)
def test_states_of_fault_confinement(tec, rec, state):
    bench = Bench(1)
    bench.nodes[0].tec, bench.nodes[0].rec = tec, rec
    assert bench.nodes[0].state == state
