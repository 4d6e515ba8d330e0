"""The bus as a component: ports, faults, losses, load, states, and that steps change nothing."""

import json
import random

import pytest

from seatrial.errors import InputError, SimulationError
from seatrial.fmi.dependencies.found import feedthrough_of
from seatrial.links.text import Outbox
from seatrial_kits.can.bits import length
from seatrial_kits.can.component import CanBus
from seatrial_kits.can.frame import Frame
from seatrial_kits.can.operations import (
    ArbitrationLost,
    BitRate,
    Buffering,
    BusError,
    Confirm,
    Error,
    FormatError,
    Transmit,
    Wakeup,
    encode,
)
from seatrial_kits.can.traffic import CanTraffic

from .scripted import MS, Scripted, bus

ZERO = Frame(0)  # 50 bits: 200 us at 250 kbit/s
URGENT, LATER = Frame(0x100, b"\x01"), Frame(0x200, b"\x02")


def busy(seed=3, count=300):
    """Requests of three nodes, 90 % load for 140 ms, several at once now and then."""
    rng, requested = random.Random(seed), []
    for number in range(count):
        frame = Frame(
            rng.randrange(0x100, 0x110), rng.randbytes(rng.randrange(9)), rng.random() < 0.5
        )
        requested.append((number // 3 * 1_450_000, rng.randrange(3), frame))
    return requested


def test_what_ended_by_t_is_reported_one_step_later_with_its_time():
    """Requested at 0.5 ms, 200 us long: ended at 0.7 ms; on rx from 2 ms on in steps of 1 ms."""
    scripted = Scripted(bus(), [(500_000, 0, ZERO)])
    scripted.run(5 * MS, MS)
    assert scripted.received(1) == scripted.received(2) == [(700_000, ZERO)]
    assert scripted.confirmed(0) == [(700_000, 0)]
    assert scripted.received_at[1] == [2 * MS]


@pytest.mark.parametrize("step", [100_000, MS, 10 * MS])
def test_the_step_does_not_change_what_is_on_the_bus(step, tmp_path):
    """Errors, losses, a node off and back, a babbling one: the same log to the last byte."""
    logs = []
    for number, h in enumerate((step, 2 * MS)):
        folder = tmp_path / str(number)
        folder.mkdir()
        made = bus(bit_error_rate=1e-4, loss=0.01, queue_length=5.0, seed=9.0)
        made.set("run_folder", str(folder))
        events = {
            20 * MS: {"fault.n1": "off"},
            40 * MS: {"fault.n1": "none", "fault.n2": "defective"},
            100 * MS: {"fault.n2": "none", "receive_error_rate.n3": 1e-3},
            120 * MS: {"fault.n3": "babbling"},
            130 * MS: {"fault.n3": "none", "bit_error_rate": 0.0},
        }
        scripted = Scripted(made, busy(), events)
        scripted.run(200 * MS, h)
        made.close()
        files = sorted(folder.iterdir())
        logs.append(([each.read_bytes() for each in files], scripted.received(0)))
        assert [each.name for each in files] == ["can.blf", "can.json", "can.log"]
    (first, received), (second, other) = logs
    assert first[0] == second[0]
    assert first[2] == second[2]
    assert len(first[2].splitlines()) > 200
    shorter = min(len(received), len(other))
    assert shorter > 100
    assert received[:shorter] == other[:shorter]


def test_a_fault_acts_from_its_time_on():
    """Off from 10 ms: the frame that begins at 9.9 ms is cut; back at 20 ms."""
    requested = [(9_900_000, 0, ZERO), (12 * MS, 0, ZERO), (20 * MS, 0, ZERO)]
    made = bus()
    scripted = Scripted(
        made, requested, {10 * MS: {"fault.n1": "off"}, 20 * MS: {"fault.n1": "none"}}
    )
    scripted.run(30 * MS, MS)
    assert [t for t, _ in scripted.received(1)] == [20_200_000]
    # Cut at 10 ms = bit 25: six recessive bits, flag, delimiter: 20 x 4 us.
    assert [(t, e.error) for t, e in scripted.operations[1] if isinstance(e, BusError)] == [
        (10_080_000, Error.STUFF)
    ]
    assert made.get("dropped")[0] == 2


def test_losses_are_of_software_and_not_of_the_bus():
    """Of 2000 frames 10 % reach no node and 30 % more of the rest not c: within 4 sigma."""
    count = 2000
    requested = [(n * 500_000, 0, Frame(n % 0x7FF)) for n in range(count)]
    made = bus(loss=0.1, receive_loss=[0.0, 0.0, 0.3, *[0.0] * 9], seed=4.0)
    scripted = Scripted(made, requested)
    scripted.run(1_040 * MS, 10 * MS)
    assert made.get("sent")[0] == made.get("frames") == count
    got = [made.get("received")[n] - made.get("lost")[n] for n in range(3)]
    assert got[1:] == [len(scripted.received(1)), len(scripted.received(2))]
    assert got[1] == pytest.approx(0.9 * count, abs=4 * (0.09 * count) ** 0.5)
    assert got[2] == pytest.approx(0.63 * count, abs=4 * (0.2331 * count) ** 0.5)
    assert made.get("error_frames") == 0


def test_bit_errors_come_as_often_as_their_rate_says():
    """Frames of n bits are hit with probability 1 - (1 - p)^n."""
    made = bus(bit_error_rate=1e-3, seed=5.0)
    requested = [(n * 500_000, 0, ZERO) for n in range(2000)]
    Scripted(made, requested).run(1_010 * MS, 10 * MS)
    hit = 1 - (1 - 1e-3) ** 50
    attempts = made.get("frames") + made.get("error_frames")
    assert made.get("frames") == 2000
    expected = hit * attempts
    assert made.get("error_frames") == pytest.approx(
        expected, abs=4 * (expected * (1 - hit)) ** 0.5
    )


def test_seeds_decide():
    def run(seed):
        made = bus(bit_error_rate=1e-3, seed=seed)
        scripted = Scripted(made, busy())
        scripted.run(200 * MS, MS)
        return scripted.operations

    assert run(1.0) == run(1.0)
    assert run(1.0) != run(2.0)


@pytest.mark.parametrize("stop", [33, 71, 110])
def test_a_saved_state_continues_as_if_nothing_had_been(stop):
    """In the middle of traffic, faults and errors, through JSON."""
    made = bus(bit_error_rate=5e-4, loss=0.02, queue_length=4.0, load_window=0.05)
    events = {
        20 * MS: {"fault.n2": "defective"},
        60 * MS: {"fault.n2": "none", "fault.n3": "babbling"},
        80 * MS: {"fault.n3": "none"},
    }
    scripted = Scripted(made, busy(), events)
    scripted.run(stop * MS, MS)
    state = json.loads(json.dumps(made.get_state()))
    memories, place = json.loads(json.dumps(scripted.memories)), scripted.next
    scripted.run(150 * MS, MS)
    whole, ended = [list(each) for each in scripted.operations], made.get_state()

    other = bus(bit_error_rate=5e-4, loss=0.02, queue_length=4.0, load_window=0.05)
    other.set_state(state)
    again = Scripted(other, busy(), events)
    again.now, again.next, again.memories = stop * MS, place, memories
    again.run(150 * MS, MS)
    for before, after in zip(whole, again.operations, strict=True):
        assert after == before[len(before) - len(after) :]
    assert sum(map(len, again.operations)) > 50
    assert json.dumps(other.get_state()) == json.dumps(ended)


def test_a_repeated_step_enters_its_frames_once(tmp_path):
    """As when a master rolls back."""
    made = bus()
    made.set("run_folder", str(tmp_path))
    scripted = Scripted(made, busy())
    for end in range(10, 200, 10):
        state, memories = made.get_state(), json.loads(json.dumps(scripted.memories))
        place = scripted.next
        scripted.run(end * MS, 10 * MS)
        made.set_state(state)
        scripted.now, scripted.memories, scripted.next = (end - 10) * MS, memories, place
        scripted.run(end * MS, 10 * MS)
    made.close()
    entered = len((tmp_path / "can.log").read_text().splitlines())
    assert made.get("frames") == 300
    assert entered == 300 + made.get("error_frames") > 300  # equal identifiers now and then


@pytest.mark.parametrize("offered", [0.1, 0.3, 0.5, 0.7, 0.9, 1.0, 1.2])
def test_load_is_what_is_offered_until_the_bus_is_full(offered):
    """Half of the load from each of two nodes; the output counts bits over time."""
    made = bus(queue_length=50.0, load_window=1.0)
    nodes = []
    for number in range(2):
        node = CanTraffic(f"t{number}")
        node.set("load", offered / 2)
        node.set("background", f"0x70{number}")
        node.set("seed", float(number))
        node.initialise()
        node.begin()
        nodes.append(node)
    loads = []
    for k in range(150):
        texts = [*(node.get("tx") for node in nodes), *[""] * 10]
        received = made.get("rx")
        made.set("tx", texts)
        for number, node in enumerate(nodes):
            node.set("rx", received[number])
        for each in (made, *nodes):
            each.advance(k / 100, 0.01)
        loads.append(made.get("load"))
    assert loads[-1] == pytest.approx(min(offered, 1.0), abs=0.01 if offered != 1.0 else 0.02)
    dropped = sum(made.get("dropped"))
    assert (dropped > 0) == (offered > 1.0)
    assert max(loads) <= 1.0


def test_latency_is_the_longest_of_a_step_and_held():
    """Two of 0x100 at once: the second waits for the first. 0x7FF, 11 bits; 0x18FF0000, 29."""
    made = bus(watched="0x100 0x18FF0000")
    first = sum(length(URGENT)) * 4e-6
    Scripted(made, [(0, 0, URGENT), (0, 1, Frame(0x18FF0000, extended=True)), (0, 0, URGENT)]).run(
        3 * MS, MS
    )
    assert made.get("latency")[0] == pytest.approx(2 * first + 12e-6, abs=1e-12)
    assert made.get("latency")[1] > made.get("latency")[0]
    assert made.get("latency")[2] == 0.0


def reported(made, *operations, node=0):
    """Return what node 0 and 1 receive after a node has sent operations at 1 ms."""
    memory: dict = {}
    for operation in operations:
        data = operation if isinstance(operation, bytes) else encode(operation)
        Outbox(memory).put(MS, data)
    made.set(f"tx.n{node + 1}", Outbox(memory).flush())
    scripted = Scripted(made, [])
    made.advance(0.0, 0.002)
    made.advance(0.002, 0.002)
    scripted.now = 4 * MS
    scripted.run(5 * MS, MS)
    return [each for _, each in scripted.operations[0]], [
        each for _, each in scripted.operations[1]
    ]


def test_what_is_no_operation_is_answered():
    own, others = reported(bus(), b"\x12\x00\x00\x00\x08\x00\x00\x00")
    assert own == [FormatError(b"\x12\x00\x00\x00\x08\x00\x00\x00")]
    assert others == []


def test_a_wake_up_goes_to_the_others():
    assert reported(bus(), Wakeup()) == ([], [Wakeup()])


def test_a_node_that_does_not_wait_is_notified_of_a_lost_arbitration():
    made = bus()
    memory: dict = {}
    Outbox(memory).put(0, encode(Transmit(URGENT)))
    made.set("tx.n2", Outbox(memory).flush())
    own, _ = reported(made, Buffering(False), Transmit(LATER))
    assert own == [Transmit(URGENT), Confirm(0x200)]  # at 1 ms the bus is free again
    made = bus()
    memory = {}
    Outbox(memory).put(MS, encode(Transmit(URGENT)))
    made.set("tx.n2", Outbox(memory).flush())
    own, _ = reported(made, Buffering(False), Transmit(LATER))
    assert own == [Transmit(URGENT), ArbitrationLost(0x200)]


def test_a_node_with_another_bit_rate_is_refused():
    reported(bus(), BitRate(250_000), BitRate(2_000_000, fd=True))
    with pytest.raises(
        SimulationError, match="node 'a' has 500000 bit/s, the bus's bit_rate is 250000"
    ):
        reported(bus(), BitRate(500_000))
    with pytest.raises(SimulationError, match="data_bit_rate"):
        reported(bus(), BitRate(500_000, fd=True))


def test_a_missed_text_is_an_error():
    made = bus()
    made.set("tx.n1", "3;0:AAAA")
    with pytest.raises(SimulationError, match="number 3 came after number 0"):
        made.advance(0.0, 0.001)


@pytest.mark.parametrize(
    ("values", "what"),
    [
        ({"nodes": ""}, "1 to 12 different names"),
        ({"nodes": "a a"}, "different names"),
        ({"nodes": " ".join(f"n{k}" for k in range(13))}, "1 to 12"),
        ({"listen_only": "bb"}, "unknown node in listen_only 'bb'"),
        ({"watched": "0x1FFFFFFFF"}, "0x1FFFFFFFF"),
        ({"watched": "0xF00"}, "allowed 0 to 0x7FF"),
        ({"watched": "heading"}, "'heading' is no identifier"),
        ({"watched": " ".join(f"0x{k}" for k in range(100, 109))}, "8 at most"),
        ({"bit_rate": 250_000.5}, "whole number"),
        ({"mailboxes": 1.5}, "whole number"),
        ({"mailboxes": 0.0}, "at least|allowed"),
        ({"recovery": "maybe"}, "'maybe'"),
    ],
)
def test_mistakes_are_named(values, what):
    with pytest.raises(InputError, match=what):
        bus(**values)


def test_an_unknown_fault_is_named():
    made = bus()
    made.set("fault.n2", "babling")
    with pytest.raises(InputError, match=r"fault.n2 'babling'; did you mean 'babbling'"):
        made.advance(0.0, 0.001)


def test_it_is_a_component_like_others():
    assert CanBus.rolls_back
    assert not any(feedthrough_of(CanBus).values())
