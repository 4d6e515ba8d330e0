"""Floods at a gateway, in a bounded number of polls: frames taken in, and that others are served."""

import os
import socket
import time
import tty

import can
import pytest

from seatrial.links.endpoints.budget import MOST
from seatrial.links.endpoints.udp import MOST_READS
from seatrial_kits.can.frame import Frame
from seatrial_kits.can.gateways.gateway import FRAME_BYTES, LEAST
from seatrial_kits.can.gateways.python_can import PythonCanGateway
from seatrial_kits.can.gateways.url import open_gateway

WAIT_S = 10.0
FLOOD, HONEST = Frame(0x100, b"f", extended=True), Frame(0x200, b"h", extended=True)
LINES = {
    "socketcand": (b"< open can0 >< rawmode >", b"< send 00000100 1 66 >", b"< send 00000200 1 68 >"),
    "slcan-tcp": (b"O\r", b"T00000100166\r", b"T00000200168\r"),
    "yd-raw-tcp": (b"", b"00000100 66\r\n", b"00000200 68\r\n"),
}  # fmt: skip


@pytest.fixture
def opened(monkeypatch):
    """Return a function that opens a gateway whose budget is the least, closed after the test."""
    monkeypatch.setattr("seatrial_kits.can.gateways.clients.RATE", 0.0)
    monkeypatch.setattr("seatrial_kits.can.gateways.python_can.RATE", 0.0)
    gateways = []

    def open_(url):
        gateways.append(open_gateway(url))
        return gateways[-1]

    yield open_
    for gateway in gateways:
        gateway.close()


def until(gateway, frame, count):
    """Poll until a frame has come so often; return what each poll took in."""
    polls, deadline = [], time.monotonic() + WAIT_S
    while sum(f == frame for poll in polls for _, f in poll) < count:
        assert time.monotonic() < deadline
        polls.append(gateway.poll())
    return polls


@pytest.mark.parametrize("kind", LINES)
def test_a_client_that_floods_waits_and_others_are_served(opened, kind):
    gateway = opened(f"{kind}:127.0.0.1:0")
    hello, flood, honest = LINES[kind]
    at = ("127.0.0.1", int(gateway.reached_at.rpartition(":")[2]))
    with socket.create_connection(at) as one, socket.create_connection(at) as other:
        count = 4000
        one.sendall(hello + flood * count)
        other.sendall(hello + honest)
        polls = until(gateway, HONEST, 1)
        assert len(polls) <= 4
        polls += until(gateway, FLOOD, count - sum(f == FLOOD for poll in polls for _, f in poll))
        assert len(polls) > (count * len(flood) - MOST) // LEAST  # and nothing is lost
        assert gateway.budget.exceeded > 0


def test_a_program_that_floods_an_adapter_waits(opened):
    gateway = opened("slcan-pty")
    hello, flood, _ = LINES["slcan-tcp"]
    descriptor = os.open(gateway.reached_at, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
    try:
        count = (os.write(descriptor, hello + flood * 250) - len(hello)) // len(flood)
        polls = until(gateway, FLOOD, count)
        assert len(polls) >= count * len(flood) // LEAST
    finally:
        os.close(descriptor)


@pytest.mark.slow
def test_a_line_that_never_ends_is_refused():
    """python-can's driver for serial adapters keeps what has come until a line is whole."""
    ours, theirs = os.openpty()
    tty.setraw(theirs)
    device = os.ttyname(theirs)
    url = f"python-can:slcan:{device}@500000"
    gateway = PythonCanGateway(url, "slcan", device, 500_000)
    try:
        os.write(ours, b"t" * 900)
        gateway.poll()
        assert gateway.refused == 0
        for _ in range(20):
            os.write(ours, b"t" * 900)
            gateway.poll()
            assert len(gateway._bus._buffer) <= 2000
        assert gateway.refused == 10
        os.write(ours, b"\r")  # the end of what is left of it
        gateway.poll()
        os.write(ours, b"t12320102\r")
        found, until = [], time.monotonic() + WAIT_S
        while not found and time.monotonic() < until:
            found = gateway.poll()
        assert [frame for _, frame in found] == [Frame(0x123, b"\x01\x02")]
    finally:
        gateway.close()
        os.close(ours)
        os.close(theirs)


def test_a_bus_that_is_flooded_is_read_by_and_by(opened):
    gateway = opened("virtual:flooded")
    with can.Bus("flooded", "virtual", ignore_config=True) as other:
        for _ in range(1000):
            other.send(can.Message(arbitration_id=0x100, data=b"f", is_extended_id=True))
        polls = until(gateway, FLOOD, 1000)
    assert max(map(len, polls)) <= MOST // FRAME_BYTES
    assert len(polls) > (1000 * FRAME_BYTES - MOST) // LEAST
    assert gateway.budget.exceeded > 0


def test_datagrams_of_a_flood_are_dropped(opened):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as peer:
        peer.bind(("127.0.0.1", 0))
        gateway = opened(f"yd-raw-udp:127.0.0.1:{peer.getsockname()[1]}")
        gateway.send(0, HONEST)
        _, at = peer.recvfrom(100)
        for _ in range(200):
            peer.sendto(LINES["yd-raw-tcp"][1], at)
        polls = [gateway.poll() for _ in range(10)]
    assert 0 < max(map(len, polls)) <= MOST_READS
