"""Floods, in a bounded number of polls: bytes that one poll takes in, and that others are served."""

import contextlib
import functools
import os
import socket
import time
from contextlib import ExitStack

import pytest

from seatrial.links.endpoints.budget import ALL_RATE, MOST, RATE, SMALLEST_SHARE, Budget
from seatrial.links.endpoints.udp import MOST_NEW
from seatrial.links.endpoints.url import open_endpoint, open_endpoints

WAIT_S = 10.0
LEAST = 1024
PIECE = b"x" * 64
HONEST = b"honest"


@pytest.fixture
def opened():
    """Return a function that opens an endpoint whose budget is the least, closed after the test."""
    endpoints = []

    def open_(url):
        endpoint = open_endpoint(url)
        endpoint.budget = Budget(0.0, LEAST)
        endpoints.append(endpoint)
        return endpoint

    yield open_
    for endpoint in endpoints:
        endpoint.close()


def place(endpoint):
    return ("127.0.0.1", int(endpoint.url.rpartition(":")[2]))


def until(endpoint, wanted):
    """Poll until the bytes of some peer are ``wanted``; return what each poll took in."""
    polls, deadline = [], time.monotonic() + WAIT_S
    while wanted not in {data for poll in polls for _, data in poll}:
        assert time.monotonic() < deadline
        polls.append(endpoint.poll())
    return polls


def brought(polls, channel=None):
    """Return the bytes of a peer, or of all, in some polls."""
    return sum(len(d) for poll in polls for c, d in poll if channel in (None, c))


def test_the_budget_follows_wall_time_between_its_bounds():
    now = [0.0]
    budget = Budget(1e5, clock=lambda: now[0])
    found = []
    for now[0] in (0.0001, 0.0201, 0.0401, 9.0):
        budget.renew(["peer"])
        found.append(budget.left("peer"))
        budget.take("peer", found[-1])
    assert found == [64, 2000, 2000, MOST]
    assert not budget.take("peer", 1)
    now[0] += 0.02
    budget.renew([1, 2, 3, 4])
    assert budget.left(1) == 500


def test_what_a_peer_does_not_use_it_has_later_and_a_datagram_comes_whole():
    budget = Budget(0.0, 100)
    for _ in range(3):
        budget.renew(["peer"])
    assert budget.left("peer") == 300
    assert budget.take("peer", 350)
    for _ in range(2):
        assert not budget.take("peer", 1)
    assert budget.exceeded == 1  # polls
    budget.renew(["peer"])
    assert budget.left("peer") == 50
    for _ in range(1000):
        budget.renew(["peer"])
    assert budget.left("peer") == MOST
    budget.renew(range(100))
    assert budget.left(1) == SMALLEST_SHARE


def test_messages_count_beside_their_bytes_and_are_made_up_for():
    budget = Budget(0.0, 100)
    budget.renew(["peer"])
    assert budget.take("peer", 100)
    budget.charge("peer", 5, 30)
    for _ in range(1 + 150 // 100):
        budget.renew(["peer"])
    assert budget.left("peer") == 50
    budget.charge("gone", 5, 30)
    assert budget.left("gone") == 100


@pytest.mark.parametrize("number", [1, 2, 3, 4])
def test_the_links_of_a_component_share_what_it_takes_in(number):
    endpoints = open_endpoints("links", " ".join(["udpin:127.0.0.1:0"] * number))
    now, together = [0.0], 0
    for endpoint in endpoints:
        endpoint.close()
        endpoint.budget._clock = lambda: now[0]
        now[0] = endpoint.budget._last
        now[0] += 0.1
        endpoint.budget.renew(["peer"])
        together += endpoint.budget.left("peer")
    assert together == pytest.approx(0.1 * min(number * RATE, ALL_RATE), rel=1e-3)


def test_peers_with_nothing_to_say_leave_their_share_to_the_others():
    budget = Budget(0.0, 1000)
    for _ in range(2 * MOST // 1000 + 2):
        budget.renew(["talks", "silent"])
        budget.take("talks", budget.left("talks"))
    budget.renew(["talks", "silent"])
    assert (budget.left("talks"), budget.left("silent")) == (1000, MOST)


@pytest.mark.parametrize("kind", ["tcpin", "tcpout", "pty"])
def test_a_peer_that_has_nothing_left_is_neither_read_nor_cut_off(opened, kind):
    with contextlib.ExitStack() as stack:
        if kind == "tcpout":
            server = stack.enter_context(socket.create_server(("127.0.0.1", 0)))
            endpoint = opened(f"tcpout:127.0.0.1:{server.getsockname()[1]}")
            endpoint.poll()
            peer = stack.enter_context(server.accept()[0])
            send = peer.sendall
        elif kind == "tcpin":
            endpoint = opened("tcpin:127.0.0.1:0")
            peer = stack.enter_context(socket.create_connection(place(endpoint)))
            send = peer.sendall
        else:
            endpoint = opened("pty")
            peer = os.open(endpoint.url, os.O_RDWR | os.O_NOCTTY)
            stack.callback(os.close, peer)
            send = functools.partial(os.write, peer)
        send(b"first")
        until(endpoint, b"first")
        (channel,) = endpoint.channels()
        endpoint.budget.charge(channel, 1, endpoint.budget.left(channel) + 2 * LEAST)
        send(HONEST)
        assert [endpoint.poll() for _ in range(2)] == [[], []]
        assert endpoint.budget.exceeded == 0
        until(endpoint, HONEST)
        assert list(endpoint.channels()) == [channel]


def test_a_tcp_client_that_floods_is_read_by_and_by_and_others_are_served(opened):
    endpoint = opened("tcpin:127.0.0.1:0")
    flood, other = (socket.create_connection(place(endpoint)) for _ in range(2))
    with flood, other:
        flood.setblocking(False)
        sent = flood.send(b"f" * (1 << 20))
        other.sendall(HONEST)
        polls = until(endpoint, HONEST)
        assert len(polls) <= 4
        while brought(polls) < sent + len(HONEST):  # nothing is lost
            polls.append(endpoint.poll())
        assert brought(polls) == sent + len(HONEST)
        assert len(polls) > (sent - MOST) // LEAST
        assert endpoint.budget.exceeded > sent // LEAST - 10


def test_a_tcp_server_that_floods_is_read_by_and_by(opened):
    with socket.create_server(("127.0.0.1", 0)) as server:
        endpoint = opened(f"tcpout:127.0.0.1:{server.getsockname()[1]}")
        endpoint.poll()
        connection, _ = server.accept()
        with connection:
            connection.sendall(b"f" * 20_000)
            polls, deadline = [], time.monotonic() + WAIT_S
            while brought(polls) < 20_000:
                assert time.monotonic() < deadline
                polls.append(endpoint.poll())
            assert len(polls) > (20_000 - MOST) // LEAST


def test_a_udp_sender_that_floods_loses_its_own_datagrams_alone(opened):
    endpoint = opened("udpin:127.0.0.1:0")
    flood, other = (socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in range(2))
    with flood, other:
        for each in (flood, other):
            each.sendto(HONEST, place(endpoint))
        until(endpoint, HONEST)
        endpoint.poll()
        channels = set(endpoint.channels())
        for _ in range(5000):  # more than the system keeps for a socket
            flood.sendto(PIECE, place(endpoint))
        other.sendto(b"now", place(endpoint))
        polls = [endpoint.poll()]
        assert [d for poll in polls for _, d in poll if d != PIECE] == [b"now"]
        assert set(endpoint.channels()) == channels
        polls += [endpoint.poll() for _ in range(10)]
        assert len(PIECE) < brought(polls) <= MOST + 11 * LEAST + len(PIECE)
        assert endpoint.budget.exceeded > 0


def test_a_udp_peer_that_floods_a_sender_is_bounded(opened):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as peer:
        peer.bind(("127.0.0.1", 0))
        endpoint = opened(f"udpout:127.0.0.1:{peer.getsockname()[1]}")
        endpoint.channels()[0].send(b"hello")
        _, address = peer.recvfrom(100)
        for _ in range(1000):
            peer.sendto(PIECE, address)
        endpoint.budget = Budget(0.0, LEAST // 16)
        polls = [endpoint.poll() for _ in range(10)]
        assert LEAST // 2 <= brought(polls) <= LEAST
        assert endpoint.budget.exceeded > 0


def test_senders_that_are_new_each_time_are_bounded(opened):
    endpoint = opened("udpin:127.0.0.1:0")
    with ExitStack() as open_ones:  # a port that is free again could be a sender known already
        for _ in range(200):
            flood = open_ones.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
            flood.sendto(PIECE, place(endpoint))
    polls = [endpoint.poll() for _ in range(10)]
    assert 0 < max(map(len, polls)) <= MOST_NEW


def test_the_port_is_still_nobody_elses(opened):
    endpoint = opened("udpin:127.0.0.1:0")
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as peer:
        peer.sendto(HONEST, place(endpoint))
        until(endpoint, HONEST)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as thief:
        thief.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        with pytest.raises(OSError, match="in use"):
            thief.bind(place(endpoint))


@pytest.mark.parametrize("kind", ["pty", "serial"])
def test_a_serial_line_that_floods_waits(opened, kind):
    endpoint, other = opened("pty"), None
    if kind == "serial":
        other, endpoint = endpoint, opened(f"serial:{endpoint.url}:57600")
        descriptor = other._own
    else:
        descriptor = os.open(endpoint.url, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
    sent = os.write(descriptor, b"f" * 3000)
    polls, deadline = [], time.monotonic() + WAIT_S
    while brought(polls) < sent:
        assert time.monotonic() < deadline
        polls.append(endpoint.poll())
    assert len(polls) >= sent // LEAST
    assert endpoint.budget.exceeded > 0
    if other is None:
        os.close(descriptor)
