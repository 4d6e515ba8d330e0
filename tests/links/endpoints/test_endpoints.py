import os
import pty
import re
import socket
import time
import tty

import pytest

from seatrial.errors import InputError
from seatrial.links.endpoints import tcp
from seatrial.links.endpoints.udp import MOST_PEERS
from seatrial.links.endpoints.url import open_endpoint, other_end
from seatrial.links.hardware import ALLOWED

WAIT_S = 5.0


@pytest.fixture
def opened():
    """Return a function that opens an endpoint, closed after the test."""
    endpoints = []

    def open_(url):
        endpoints.append(open_endpoint(url))
        return endpoints[-1]

    yield open_
    for endpoint in endpoints:
        endpoint.close()


@pytest.fixture
def udp():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as peer:
        peer.bind(("127.0.0.1", 0))
        peer.settimeout(WAIT_S)
        yield peer


def port_of(endpoint):
    return int(endpoint.url.rpartition(":")[2])


def polled(endpoint, until=lambda arrived: arrived):
    """Poll until something, or what is wanted, has arrived; return all of it."""
    arrived, deadline = [], time.monotonic() + WAIT_S
    while time.monotonic() < deadline:
        arrived += endpoint.poll()
        if until(arrived):
            return arrived
        time.sleep(0.001)
    raise AssertionError(f"only {arrived}")


def test_udp_out_sends_to_its_address_and_receives_it_alone(opened, udp):
    endpoint = opened(f"udpout:127.0.0.1:{udp.getsockname()[1]}")
    (channel,) = endpoint.channels()
    channel.send(b"hello")
    data, address = udp.recvfrom(100)
    assert data == b"hello"
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as stranger:
        stranger.sendto(b"stranger", address)
        udp.sendto(b"friend", address)
        assert polled(endpoint) == [(channel, b"friend")]


def test_udp_out_to_nobody_is_no_error(opened, udp):
    port = udp.getsockname()[1]
    udp.close()
    endpoint = opened(f"udpout:127.0.0.1:{port}")
    for _ in range(3):
        endpoint.channels()[0].send(b"anybody?")
        assert endpoint.poll() == []


def test_udp_in_answers_all_who_have_sent(opened, udp):
    endpoint = opened("udpin:127.0.0.1:0")
    assert endpoint.channels() == []
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
        other.settimeout(WAIT_S)
        for peer, word in ((udp, b"one"), (other, b"two")):
            peer.sendto(word, ("127.0.0.1", port_of(endpoint)))
        arrived = polled(endpoint, lambda arrived: len(arrived) == 2)
        assert {data for _, data in arrived} == {b"one", b"two"}
        for channel, word in arrived:
            channel.send(word * 2)
        assert (udp.recv(100), other.recv(100)) == (b"oneone", b"twotwo")
        # And a peer stays the same one.
        udp.sendto(b"again", ("127.0.0.1", port_of(endpoint)))
        assert polled(endpoint)[0][0] is next(c for c, data in arrived if data == b"one")


def test_udp_in_replaces_the_longest_silent_peers(opened):
    endpoint = opened("udpin:127.0.0.1:0")
    peers = [socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in range(MOST_PEERS + 3)]
    for number, peer in enumerate(peers):
        peer.sendto(bytes([number]), ("127.0.0.1", port_of(endpoint)))
    arrived = polled(endpoint, lambda arrived: len(arrived) == len(peers))
    for peer in peers:
        peer.close()
    assert list(endpoint.channels()) == [channel for channel, _ in arrived[3:]]


def test_tcp_server_serves_several_clients(opened):
    endpoint = opened("tcpin:127.0.0.1:0")
    address = ("127.0.0.1", port_of(endpoint))
    with socket.create_connection(address) as a, socket.create_connection(address) as b:
        a.sendall(b"from a")
        b.sendall(b"from b")
        arrived = polled(endpoint, lambda arrived: len(arrived) == 2)
        for channel, data in arrived:
            channel.send(data)
        assert (a.recv(100), b.recv(100)) == (b"from a", b"from b")
        a.close()
        deadline = time.monotonic() + WAIT_S
        while len(endpoint.channels()) == 2 and time.monotonic() < deadline:
            endpoint.poll()
        assert list(endpoint.channels()) == [c for c, data in arrived if data == b"from b"]


def test_a_client_that_does_not_read_loses_frames_and_stops_nobody(opened):
    endpoint = opened("tcpin:127.0.0.1:0")
    with socket.create_connection(("127.0.0.1", port_of(endpoint))) as client:
        client.settimeout(WAIT_S)
        client.sendall(b"x")
        ((channel, _),) = polled(endpoint)
        frames = [b"%08d" % k + b"." * 992 for k in range(20_000)]
        for frame in frames:
            channel.send(frame)
        received = b""
        while len(received) < 1000 * 1000:
            endpoint.poll()
            received += client.recv(1 << 16)
        sent = len(frames) * 1000
        assert len(received) < sent  # else this test shows nothing
        # Whole frames alone are lost.
        whole = [received[i : i + 1000] for i in range(0, len(received) - 999, 1000)]
        assert all(frame in frames for frame in whole[:100] + whole[-100:])


def test_tcp_client_connects_again(opened, monkeypatch):
    monkeypatch.setattr(tcp, "RETRY_S", 0.01)
    with socket.create_server(("127.0.0.1", 0)) as server:
        server.settimeout(WAIT_S)
        port = server.getsockname()[1]
        endpoint = opened(f"tcpout:127.0.0.1:{port}")
        assert endpoint.channels() == []
        for word in (b"first", b"second"):
            endpoint.poll()
            accepted = None
            deadline = time.monotonic() + WAIT_S
            while not endpoint.channels() and time.monotonic() < deadline:
                endpoint.poll()
            accepted, _ = server.accept()
            accepted.settimeout(WAIT_S)
            endpoint.channels()[0].send(word)
            assert accepted.recv(100) == word
            accepted.sendall(word)
            assert polled(endpoint)[0][1] == word
            accepted.close()
            while endpoint.channels() and time.monotonic() < deadline:
                endpoint.poll()


def test_tcp_client_without_a_server_is_no_error(opened):
    with socket.create_server(("127.0.0.1", 0)) as server:
        port = server.getsockname()[1]
    endpoint = opened(f"tcpout:127.0.0.1:{port}")
    for _ in range(5):
        assert endpoint.poll() == []
        assert endpoint.channels() == []


@pytest.fixture
def line(monkeypatch):
    """Yield the two ends of a pseudo-terminal: a file descriptor and a device."""
    monkeypatch.setenv(ALLOWED, "1")
    ours, theirs = pty.openpty()
    tty.setraw(theirs)
    yield ours, os.ttyname(theirs)
    os.close(ours)
    os.close(theirs)


def test_serial_over_a_pseudo_terminal(opened, line):
    ours, device = line
    endpoint = opened(f"serial:{device}:57600")
    os.write(ours, b"ping")
    assert [data for _, data in polled(endpoint)] == [b"ping"]
    endpoint.channels()[0].send(b"pong")
    assert os.read(ours, 100) == b"pong"


def test_a_serial_line_that_takes_nothing_stops_nobody(opened, line):
    ours, device = line
    endpoint = opened(f"serial:{device}:57600")
    begun = time.monotonic()
    for _ in range(2000):
        endpoint.channels()[0].send(bytes(280))
    assert time.monotonic() - begun < WAIT_S
    assert os.read(ours, 280) == bytes(280)


def test_a_pseudo_terminal_is_a_serial_port_at_its_place(opened, tmp_path):
    place = tmp_path / "vehicle"
    endpoint = opened(f"pty:{place}")
    assert endpoint.url == f"pty:{place}"
    other = opened(f"serial:{place}:115200")
    other.channels()[0].send(b"ping")
    assert [data for _, data in polled(endpoint)] == [b"ping"]
    endpoint.channels()[0].send(b"pong")
    assert [data for _, data in polled(other)] == [b"pong"]


def test_without_a_place_the_system_finds_one(opened):
    endpoint = opened("pty")
    other = opened(f"serial:{other_end(endpoint.url)}:115200")
    other.channels()[0].send(b"ping")
    assert [data for _, data in polled(endpoint)] == [b"ping"]


def test_a_pseudo_terminals_place_is_free_again_afterwards(tmp_path):
    place = tmp_path / "vehicle"
    open_endpoint(f"pty:{place}").close()
    assert not place.is_symlink()
    place.symlink_to("/dev/pts/no-such")  # as a killed run leaves it
    open_endpoint(f"pty:{place}").close()
    place.write_text("a person's file")
    with pytest.raises(InputError, match=rf"'pty:{place}': there is something else"):
        open_endpoint(f"pty:{place}")
    assert place.read_text() == "a person's file"
    with pytest.raises(InputError, match="No such file or directory"):
        open_endpoint(f"pty:{tmp_path}/no-such/vehicle")


def test_a_device_that_is_not_there_is_named(monkeypatch):
    monkeypatch.setenv(ALLOWED, "1")
    with pytest.raises(InputError, match=r"cannot open the link 'serial:/dev/no-such:9600'"):
        open_endpoint("serial:/dev/no-such:9600")


@pytest.mark.parametrize(
    ("url", "expected"),
    [
        ("upd:127.0.0.1:14550", "unknown kind of link 'upd'"),
        ("udpinn:127.0.0.1:14550", "did you mean 'udpin'"),
        ("", "unknown kind of link ''"),
        ("udpin", "is not of the form 'udpin:127.0.0.1:14551'"),
        ("udpin:127.0.0.1", "is not of the form"),
        ("udpin://127.0.0.1:14550", "is not of the form"),
        ("tcpin:127.0.0.1:http", "is not of the form"),
        ("tcpin:1:2:3", "is not of the form"),
        ("serial:/dev/ttyS0", "is not of the form 'serial:/dev/ttyUSB0:57600'"),
        ("udpin:127.0.0.1:65536", "the port is 65536, allowed 0 to 65535"),
        ("udpout:127.0.0.1:0", "the port is 0, allowed 1 to 65535"),
        ("serial:/dev/ttyS0:0", "the baud rate is 0"),
        ("pty:", "is not of the form 'pty:/tmp/vehicle'"),
        (f"udpout:{'x' * 64}:14550", f"host '{'x' * 64}'"),  # refused without a look-up
        ("udpin:192.0.2.1:0", "link 'udpin:192.0.2.1:0' listens at"),
    ],
)
def test_a_bad_url_is_refused_with_the_url(url, expected):
    with pytest.raises(InputError, match=re.escape(expected)) as caught:
        open_endpoint(url)
    assert repr(url) in str(caught.value)


@pytest.mark.parametrize("kind", ["udpin", "tcpin"])
def test_a_port_in_use_is_named_with_its_cause(opened, kind):
    first = opened(f"{kind}:127.0.0.1:0")
    with pytest.raises(InputError, match=f"{first.url}.*[Aa]ddress already in use"):
        open_endpoint(first.url)
    first.close()
    opened(first.url)  # closed, it is free again
