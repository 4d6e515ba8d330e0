"""Packets between vehicles: delays, half duplex, collisions, loss, against closed forms."""

import math

import pytest

from seatrial.errors import InputError
from seatrial.links.packets.channel import AcousticChannel, RadioChannel
from seatrial.links.text import Inbox, Outbox
from tests.devices.running import started

STEP = 0.05
UNDER = {"position_1": [0.0, 0.0, 5.0], "position_2": [300.0, 0.0, 5.0]}
SURE = {"falloff": 1e6}


class Net:
    """A channel with what its nodes send and receive."""

    def __init__(self, cls=AcousticChannel, **values):
        self.channel = started(cls, **values)
        self.boxes = [Outbox({}) for _ in range(8)]
        self.memories = [{} for _ in range(8)]
        self.received = [[] for _ in range(8)]
        self.steps = 0

    def send(self, node, data):
        self.boxes[node - 1].put(round(1e9 * STEP * self.steps), data)
        self.channel.set(f"tx.n{node}", self.boxes[node - 1].flush())

    def go(self, seconds):
        for _ in range(round(seconds / STEP)):
            self.channel.advance(STEP * self.steps, STEP)
            self.steps += 1
            for node, text in enumerate(self.channel.get("rx")):
                new = Inbox(self.memories[node]).take(text)
                self.received[node] += [(time / 1e9, data) for time, data in new]

    def count(self, name, node):
        return self.channel.get(name)[node - 1]


def test_a_packet_takes_its_length_and_the_way():
    net = Net(bit_rate=400.0, overhead=0.1, **UNDER, **SURE)
    net.send(1, b"12345678")
    net.go(1.0)
    late = 0.1 + 64.0 / 400.0 + 300.0 / 1500.0
    assert net.received[1] == [(pytest.approx(late, abs=1e-9), b"12345678")]
    assert net.received[0] == []
    assert (net.count("sent", 1), net.count("received", 2), net.count("lost", 2)) == (1, 1, 0)


def test_a_long_chunk_is_cut_and_waits_in_line():
    net = Net(bit_rate=400.0, overhead=0.1, **UNDER, **SURE)
    net.send(1, bytes(range(20)))
    net.go(STEP)
    assert net.count("queued", 1) == 2
    net.go(1.5)
    way, full, rest = 0.2, 0.1 + 64.0 / 400.0, 0.1 + 32.0 / 400.0
    expected = [full + way, 2 * full + way, 2 * full + rest + way]
    assert [time for time, _ in net.received[1]] == pytest.approx(expected)
    assert b"".join(data for _, data in net.received[1]) == bytes(range(20))


def test_a_queue_that_is_full_drops():
    net = Net(queue_length=3.0, **UNDER, **SURE)
    net.send(1, bytes(8 * 10))
    net.go(STEP)
    assert net.count("dropped", 1) == 7
    net.go(5.0)
    assert net.count("received", 2) == 3


def test_both_at_once_receive_nothing_of_each_other():
    net = Net(bit_rate=400.0, overhead=0.1, **UNDER, **SURE)
    net.send(1, b"12345678")
    net.send(2, b"87654321")
    net.go(2.0)
    # 0.26 s to send and 0.2 s on the way: the ends cross while both still send.
    assert net.received == [[] for _ in range(8)]
    assert (net.count("lost", 1), net.count("lost", 2)) == (1, 1)


def test_whoever_receives_waits_with_his_own():
    net = Net(bit_rate=400.0, overhead=0.1, **UNDER, **SURE)
    net.send(1, b"12345678")
    net.go(0.25)  # it has begun to arrive at 0.2 s
    net.send(2, b"87654321")
    net.go(2.0)
    assert [time for time, _ in net.received[1]] == pytest.approx([0.46])
    assert [time for time, _ in net.received[0]] == pytest.approx([0.46 + 0.26 + 0.2])


def test_two_packets_that_overlap_where_they_arrive_collide():
    places = {**UNDER, "position_3": [150.0, 0.0, 5.0], "nodes": 3.0}
    net = Net(bit_rate=400.0, overhead=0.1, **places, **SURE)
    net.send(1, b"12345678")
    net.send(2, b"87654321")
    net.go(2.0)
    assert net.count("lost", 3) == 2
    assert net.received[2] == []
    later = Net(bit_rate=400.0, overhead=0.1, **places, **SURE)
    later.send(1, b"12345678")
    later.go(0.5)
    later.send(2, b"87654321")
    later.go(2.0)
    assert [data for _, data in later.received[2]] == [b"12345678", b"87654321"]


@pytest.mark.parametrize(
    ("cls", "down", "arrives"),
    [
        (AcousticChannel, 0.0, True),
        (AcousticChannel, -0.1, False),
        (RadioChannel, 0.0, True),
        (RadioChannel, 0.6, False),
    ],
)
def test_sound_is_for_below_and_radio_for_above_the_surface(cls, down, arrives):
    net = Net(cls, position_1=[0.0, 0.0, down], position_2=[30.0, 0.0, 0.0], **SURE)
    net.send(1, b"x")
    net.go(1.0)
    assert bool(net.received[1]) == arrives


def test_radio_travels_at_the_speed_of_light():
    net = Net(RadioChannel, position_2=[1500.0, 0.0, 0.0], **SURE)
    net.send(1, bytes(100))
    net.go(0.1)
    assert net.received[1][0][0] == pytest.approx(
        0.005 + 800.0 / 64000.0 + 1500.0 / 299_792_458.0, abs=1e-9
    )


@pytest.mark.parametrize(
    ("away", "share"), [(100.0, 0.1), (900.0, 0.1 + 0.9 * 0.9**4), (1001.0, 1.0)]
)
def test_loss_grows_with_the_distance(away, share):
    n = 600
    net = Net(
        RadioChannel, position_2=[away, 0.0, 0.0], range_max=1000.0, loss=0.1, falloff=4.0,
        bit_rate=1e6, overhead=0.0, packet_size=1.0, queue_length=1e4,
    )  # fmt: skip
    net.send(1, bytes(n))
    net.go(0.1)
    arrived = net.count("received", 2)
    assert 1.0 - arrived / n == pytest.approx(share, abs=4.0 * math.sqrt(share * (1 - share) / n))
    assert arrived + net.count("lost", 2) == (n if away <= 1000.0 else 0)


def test_draws_are_keyed_and_a_restored_state_goes_on():
    def run():
        net = Net(loss=0.5, **UNDER)
        net.send(1, bytes(80))
        net.go(1.0)
        return net

    one, other = run(), run()
    state = one.channel.get_state()
    one.go(4.0)
    other.channel.set_state(state)
    other.go(4.0)
    assert one.received == other.received
    assert 0 < one.count("received", 2) < 10


def test_numbers_are_whole():
    with pytest.raises(InputError, match=r"nodes is 2\.5, a whole number"):
        started(AcousticChannel, nodes=2.5)
