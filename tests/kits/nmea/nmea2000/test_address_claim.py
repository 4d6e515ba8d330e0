"""Address claiming in simulated time, without a bus, with canboat's own claimer as another node."""

import copy
import heapq
import itertools

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from nmea2000._canboat import AddressClaimer

from seatrial_kits.nmea.nmea2000.address_claim import AddressClaim

MS = 1_000_000
FRAME_NS = 600_000
"""A claim arrives everywhere after about this."""
SETTLED_MS = 5_000


class Ours:
    def __init__(self, name, preferred, arbitrary=True, delays=(0.5,)):
        draws = itertools.cycle(delays)
        self.name = name
        self.memory = {}
        self.claim = AddressClaim(self.memory, name, preferred, arbitrary, lambda _: next(draws))

    def start(self, now):
        self.claim.start(now)
        return []

    def receive(self, now, source, name):
        self.claim.receive_claim(now, source, name)

    def advance(self, now):
        self.claim.tick(now + 1)
        return self.claim.take()

    @property
    def due(self):
        return self.claim.changes_ns

    @property
    def address(self):
        return self.claim.address


class Canboat:
    """The claimer of the package nmea2000, in whole milliseconds."""

    def __init__(self, name, preferred, arbitrary=True):
        self.name = name
        self.claimer = AddressClaimer(name, preferred, arbitrary)
        self.waiting = []

    def start(self, now):
        self._keep(self.claimer.start(now // MS))

    def receive(self, now, source, name):
        self._keep(self.claimer.on_address_claim(now // MS, source, name))

    def advance(self, now):
        self._keep(self.claimer.tick(now // MS))
        found, self.waiting = self.waiting, []
        return [(now, source) for source in found]

    def _keep(self, frames):
        self.waiting += [source for _, pgn, source, _, _ in frames if pgn == 60928]

    @property
    def due(self):
        return self.claimer.deadline * MS if self.claimer.is_timing else SETTLED_MS * MS

    @property
    def address(self):
        return self.claimer.send_address


def settle(nodes, until_ms=SETTLED_MS, start_ms=None):
    """Run nodes on a bus that delivers to all others; return [(time in ns, name, source)]."""
    starts = [((start_ms or {}).get(k, 0)) * MS for k in range(len(nodes))]
    sent, on_the_way, now = [], [], 0
    while now < until_ms * MS:
        for node, start in zip(nodes, starts, strict=True):
            if now == start:
                node.start(now)
        while on_the_way and on_the_way[0][0] <= now:
            _, sender, source = heapq.heappop(on_the_way)
            for other, start in zip(nodes, starts, strict=True):
                if other is not nodes[sender] and now >= start:
                    other.receive(now, source, nodes[sender].name)
        for k, node in enumerate(nodes):
            if now >= starts[k]:
                for when, source in node.advance(now):
                    sent.append((when, node.name, source))
                    heapq.heappush(on_the_way, (max(when, now) + FRAME_NS, k, source))
        coming = [*starts, *(when for when, *_ in on_the_way)]
        coming += [node.due for node, start in zip(nodes, starts, strict=True) if now >= start]
        # To the next whole millisecond in which something happens.
        now = -(-min((when for when in coming if when > now), default=until_ms * MS) // MS) * MS
    return sent


def test_alone_it_waits_at_random_claims_and_uses_the_address_250_ms_later():
    node = Ours(100, 35, delays=(0.4,))
    node.start(7 * MS)
    first = 7 * MS + round(0.4 * 153 * MS)
    node.claim.tick(first)
    assert node.claim.take() == []
    node.claim.tick(first + 1)
    assert node.claim.take() == [(first, 35)]
    node.claim.tick(first + 250 * MS)
    assert node.address is None
    node.claim.tick(first + 250 * MS + 1)
    assert node.address == 35
    assert node.claim.since_ns == first + 250 * MS


def test_of_two_the_lower_name_keeps_the_address_and_the_other_takes_the_next():
    low, high = Ours(100, 35, delays=(0.9,)), Ours(200, 35, delays=(0.1,))
    sent = settle([low, high])
    assert (low.address, high.address) == (35, 36)
    assert [(name, source) for _, name, source in sent] == [(200, 35), (100, 35), (200, 36)]
    assert high.claim.contests == 1


def test_the_lower_name_defends_what_it_has():
    low, high = Ours(100, 35), Ours(200, 35)
    sent = settle([low, high], start_ms={1: 1000})
    assert (low.address, high.address) == (35, 36)
    # The newcomer has received nothing before it claims; it receives the claim, and moves.
    assert [(name, source) for _, name, source in sent] == [
        (100, 35),
        (200, 35),
        (100, 35),
        (200, 36),
    ]


@pytest.mark.parametrize(("until_ms", "address"), [(2300, None), (2400, 36)])
def test_a_late_lower_name_takes_an_address_in_use(until_ms, address):
    """Its holder moves on, and is silent for 250 ms: from 2077 ms on here."""
    low, high = Ours(100, 35), Ours(200, 35)
    settle([low, high], start_ms={0: 2000}, until_ms=until_ms)
    assert high.address == address
    assert low.address == (35 if address else None)


def test_three_settle_in_the_order_of_their_names():
    nodes = [
        Ours(name, 35, delays=(delay,)) for name, delay in ((300, 0.1), (100, 0.5), (200, 0.9))
    ]
    settle(nodes)
    assert {node.name: node.address for node in nodes}[100] == 35
    assert sorted(node.address for node in nodes) == [35, 36, 37]


@given(
    names=st.lists(st.integers(1, 2**63), min_size=2, max_size=6, unique=True),
    delays=st.lists(st.floats(0, 1), min_size=6, max_size=6),
    preferred=st.lists(st.sampled_from((0, 35, 36, 250, 251)), min_size=6, max_size=6),
)
@settings(max_examples=30, deadline=None)
def test_whoever_comes_when_all_have_addresses_of_their_own(names, delays, preferred):
    nodes = [
        Ours(name, first, delays=(delay, 0.3))
        for name, first, delay in zip(names, preferred, delays, strict=False)
    ]
    settle(nodes, until_ms=2500)
    addresses = [node.address for node in nodes]
    assert None not in addresses
    assert len(set(addresses)) == len(nodes)
    lowest = min(nodes, key=lambda node: node.name)
    assert lowest.address == preferred[nodes.index(lowest)]


@given(
    ours=st.integers(1, 2**62),
    theirs=st.integers(1, 2**62),
    arbitrary=st.tuples(st.booleans(), st.booleans()),
    late=st.integers(0, 2500),
)
@settings(max_examples=30, deadline=None)
def test_it_settles_with_canboats_claimer(ours, theirs, arbitrary, late):
    if ours == theirs:
        theirs += 1
    one, other = Ours(ours, 35, arbitrary[0]), Canboat(theirs, 35, arbitrary[1])
    settle([one, other], start_ms={0: late})
    if arbitrary[1]:  # else it may have to go, and one that goes is not always without
        assert other.address is not None
    assert one.address is None or one.address != other.address
    if ours < theirs:
        assert one.address == 35
    elif late > 1250:  # it has its address; before, it gives way to claims in its scan
        assert other.address == 35
        assert one.address == (36 if arbitrary[0] else None)


def test_one_that_cannot_move_says_so_and_is_silent():
    low, fixed = Ours(100, 35, delays=(0.0,)), Ours(200, 35, arbitrary=False, delays=(0.5, 1.0))
    sent = settle([low, fixed], start_ms={1: 1000})
    assert fixed.address is None
    assert fixed.claim.state == "without"
    (refusal,) = [when for when, name, source in sent if (name, source) == (200, 254)]
    defended = max(when for when, name, source in sent if (name, source) == (100, 35))
    assert 153 * MS <= refusal - defended <= 155 * MS  # the whole random delay, drawn as 1
    fixed.claim.receive_request(9_000 * MS)
    fixed.claim.tick(9_154 * MS)
    ((when, source),) = fixed.claim.take()
    assert source == 254
    assert 9_000 * MS <= when <= 9_153 * MS


def test_a_node_with_no_free_address_cannot_claim():
    node = Ours(1000, 35)
    node.start(0)
    for address in range(252):
        node.receive(0, address, address)
    node.claim.tick(400 * MS)
    assert [source for _, source in node.claim.take()] == [254]
    assert node.address is None
    # One address less in use, and it would have been taken.
    other = Ours(1000, 35)
    other.start(0)
    for address in set(range(252)) - {34}:
        other.receive(0, address, address)
    other.claim.tick(400 * MS)
    assert [source for _, source in other.claim.take()] == [34]


def test_addresses_that_were_only_received_sending_are_left_alone():
    node = Ours(1000, 35)
    node.start(0)
    node.claim.receive_source(36)
    node.receive(0, 35, 1)
    node.claim.tick(400 * MS)
    assert node.claim.take()[0][1] == 37


def test_a_request_is_answered_with_the_claim():
    node = Ours(100, 35)
    settle([node])
    node.claim.receive_request(6_000 * MS)
    assert node.claim.take() == [(6_000 * MS, 35)]


def test_a_twin_is_counted_and_not_fought():
    one, other = Ours(100, 35, delays=(0.1,)), Ours(100, 35, delays=(0.9,))
    sent = settle([one, other])
    assert len(sent) == 2
    assert (one.claim.twins, other.claim.twins) == (1, 1)


@pytest.mark.parametrize("at_ms", [0, 80, 200, 500])
def test_a_copy_of_its_memory_goes_on_in_the_same_way(at_ms):
    one = Ours(200, 35)
    one.start(0)
    one.receive(0, 40, 5)
    one.claim.tick(at_ms * MS)
    other = Ours(200, 35)
    other.memory.update(copy.deepcopy(one.memory))
    for each in (one, other):
        each.receive(at_ms * MS, 35, 100)
        each.claim.tick(3_000 * MS)
    assert one.claim.take() == other.claim.take()
    assert one.address == other.address == 36
