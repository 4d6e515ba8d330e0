"""Gateways with the programs that they are for."""

import logging
import socket
import sys
import threading
import time

import can
import pytest
from dronecan.driver.slcan import SLCAN
from hypothesis import given, settings
from hypothesis import strategies as st

from seatrial.errors import InputError
from seatrial.links.endpoints.endpoint import Channel, Endpoint
from seatrial.links.hardware import ALLOWED
from seatrial_kits.can.component_gateway import CanGateway
from seatrial_kits.can.frame import Frame
from seatrial_kits.can.gateways.slcan import SlcanGateway
from seatrial_kits.can.gateways.socketcand import SocketcandGateway
from seatrial_kits.can.messages import frame_of, message

from .served import WAIT_S, Served

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="pseudo-terminals")

COUNT = 1500
OURS = [
    Frame(n % 0x7FF if n % 2 else 0x18FF0000 + n, bytes([n % 251] * (n % 9)), n % 2 == 0)
    for n in range(COUNT)
]
THEIRS = [Frame(0x123, n.to_bytes(8, "big")) for n in range(COUNT)]


@pytest.fixture(autouse=True)
def _quiet():
    """python-can's socketcand client warns of every text that comes in two parts."""
    logging.getLogger("can").setLevel(logging.ERROR)


def open_bus(served, **options):
    """Return python-can's bus at a gateway."""
    kind, _, place = served.at.partition(":")
    if kind == "socketcand":
        host, _, port = place.partition(":")
        return can.Bus("can0", "socketcand", host=host, port=int(port), ignore_config=True)
    if kind == "virtual":
        return can.Bus(place, "virtual", ignore_config=True)
    return can.Bus(
        served.at, "slcan", bitrate=1_000_000, sleep_after_open=0, ignore_config=True, **options
    )


def read(bus, count):
    """Return the messages that come until there are so many."""
    found, deadline = [], time.monotonic() + WAIT_S
    while len(found) < count and time.monotonic() < deadline:
        received = bus.recv(1.0)
        if received is not None:
            found.append(received)
    return found


GATEWAYS = ["socketcand:127.0.0.1:0", "slcan-tcp:127.0.0.1:0", "slcan-pty", "virtual:gateway-{}"]


@pytest.mark.slow
@pytest.mark.parametrize("gateway", GATEWAYS)
def test_nothing_is_lost_either_way_at_a_thousand_frames_a_second(gateway, request):
    with Served(gateway.format(request.node.name)) as served, open_bus(served) as bus:
        served.wait(lambda: served.gateway.get("clients") == 1)
        served.send(Frame(0x7F0))
        while bus.recv(1.0) is None:  # it is attached
            pass
        served.send(*OURS)
        sender = threading.Thread(target=lambda: [bus.send(message(f, 0.0)) for f in THEIRS])
        sender.start()
        arrived = read(bus, COUNT)
        sender.join(WAIT_S)
        served.wait(lambda: len(served.received) == COUNT)
        assert [frame for _, frame in served.received] == THEIRS
        assert [frame_of(each) for each in arrived] == OURS
        assert served.gateway.get("frames_in") == COUNT
        assert served.gateway.get("forgotten") == 0


@pytest.mark.parametrize("gateway", ["socketcand:127.0.0.1:0", "virtual:gateway-{}"])
def test_times_are_simulated(gateway, request):
    """An extended frame of 8 bytes lasts 131 to 143 us, and its peer requested it at a whole 2 ms."""
    with Served(gateway.format(request.node.name)) as served, open_bus(served) as bus:
        served.wait(lambda: served.now > 500_000_000)
        served.send(Frame(0x18FF0000, b"12345678", True))
        (found,) = read(bus, 1)
        assert 0.5 < found.timestamp < served.now / 1e9
        assert 118e-6 <= found.timestamp % 0.002 <= 143e-6


@pytest.mark.parametrize("gateway", ["slcan-tcp:127.0.0.1:0", "virtual:gateway-{}"])
def test_remote_and_fd_frames(gateway, request):
    frames = [
        Frame(0x321, remote=True, requested=5),
        Frame(0x1ABCDEF0, extended=True, remote=True, requested=8),
        Frame(0x222, bytes(range(24)), fd=True),
        Frame(0x1ABCDEF0, bytes(range(64)), True, fd=True, bit_rate_switch=True),
    ]
    with Served(gateway.format(request.node.name)) as served, open_bus(served) as bus:
        served.send(Frame(0x7F0))
        read(bus, 1)
        served.send(*frames)
        assert [frame_of(each) for each in read(bus, 4)] == frames
        for frame in frames:
            bus.send(message(frame, 0.0))
        served.wait(lambda: len(served.received) == 4)
        assert [frame for _, frame in served.received] == frames


def test_socketcands_clients_receive_each_other_and_not_themselves():
    with (
        Served("socketcand:127.0.0.1:0") as served,
        open_bus(served) as one,
        open_bus(served) as two,
    ):
        served.wait(lambda: served.gateway.get("clients") == 2)
        one.send(message(Frame(0x100, b"one"), 0.0))
        assert frame_of(read(two, 1)[0]) == Frame(0x100, b"one")
        two.send(message(Frame(0x200, b"two"), 0.0))
        assert frame_of(read(one, 1)[0]) == Frame(0x200, b"two")
        served.send(Frame(0x300))
        assert [frame_of(read(each, 1)[0]) for each in (one, two)] == [Frame(0x300)] * 2
    assert [frame for _, frame in served.received] == [Frame(0x100, b"one"), Frame(0x200, b"two")]


def test_what_a_client_sends_before_it_goes_arrives():
    with Served("socketcand:127.0.0.1:0") as served:
        for number in range(10):
            with open_bus(served) as bus:
                for _ in range(20):
                    bus.send(message(Frame(number), 0.0))
        served.wait(lambda: len(served.received) == 200)


def test_error_frames_reach_socketcands_clients():
    with Served("socketcand:127.0.0.1:0") as served, open_bus(served) as bus:
        served.bus.set("receive_error_rate.n2", 1.0)
        served.send(Frame(0x100))
        found = read(bus, 3)
        assert all(each.is_error_frame for each in found)


@pytest.mark.slow
def test_the_handshake_stands_alone_on_a_busy_bus():
    """python-can's client wants each reply in a read of its own, whatever is on the bus."""
    with Served("socketcand:127.0.0.1:0") as served:
        served.send(*[Frame(0x100 + n % 256) for n in range(10_000)])
        for _ in range(5):
            with open_bus(served) as bus:
                assert read(bus, 1)
        served.wait(lambda: served.gateway.get("clients") == 0)


def text_client(served):
    where = served.at.removeprefix("socketcand:").removeprefix("socket://")
    host, _, port = where.partition(":")
    made = socket.create_connection((host, int(port)), timeout=WAIT_S)
    return made, made.makefile("rwb", buffering=0)


def until(file, end):
    found = b""
    while not found.endswith(end):
        found += file.read(1)
    return found.decode()


def test_socketcands_words_that_python_can_does_not_have():
    """As in the protocol's description: echo, FD, remote frames, and what is not understood."""
    with Served("socketcand:127.0.0.1:0") as served:
        connection, file = text_client(served)
        with connection, file:
            assert until(file, b">") == "< hi >"
            file.write(b"< send 123 0 >")  # there is no bus yet
            assert until(file, b">") == "< error unknown command >"
            file.write(b"< open can0 >")
            assert until(file, b">") == "< ok >"
            file.write(b"< rawmode >")
            assert until(file, b">") == "< ok >"
            file.write(b"< echo >")
            assert until(file, b">") == "< echo >"
            file.write(b"< fdsend 123 01 12 1 2 3 4 5 6 7 8 9 a b c >< send 1AAAAAAA 2 1 F1 >")
            file.write(b"< sendrtr 1F334455 3 >")
            served.wait(lambda: len(served.received) == 3)
            served.send(Frame(0x7FF, bytes(12), fd=True, bit_rate_switch=True))
            assert until(file, b">").startswith("< fdframe 7FF 01 ")
            served.send(Frame(0x7FF, remote=True, requested=2))
            assert until(file, b">").startswith("< rtr 7FF ")
            for wrong in (
                "< dance >",
                "< send 123 9 1 >",
                "< send 800 0 >",
                "< send >",
                "< send x 0 >",
            ):
                file.write(wrong.encode())
                assert until(file, b">") == "< error unknown command >"
        fd = Frame(0x123, bytes(range(1, 13)), fd=True, bit_rate_switch=True)
        assert [frame for _, frame in served.received] == [
            fd,
            Frame(0x1AAAAAAA, b"\x01\xf1", True),
            Frame(0x1F334455, extended=True, remote=True, requested=3),
        ]


def test_socketcands_unknown_bus_is_refused_and_the_connection_ended():
    """As state_nobus.c has it; python-can's client raises."""
    with Served("socketcand:127.0.0.1:0") as served:
        connection, file = text_client(served)
        with connection, file:
            assert until(file, b">") == "< hi >"
            file.write(b"< open vcan7 >< rawmode >")
            assert file.read() == b"< error could not open bus >"
        host, _, port = served.at.removeprefix("socketcand:").partition(":")
        with pytest.raises(can.CanError, match="could not open bus"):
            can.Bus("vcan7", "socketcand", host=host, port=int(port), ignore_config=True)
        served.wait(lambda: served.gateway.get("clients") == 0)


def test_socketcands_subscriptions():
    """As in the mode BCM: the identifiers subscribed to alone, bytes with spaces (state_bcm.c)."""
    with Served("socketcand:127.0.0.1:0") as served:
        connection, file = text_client(served)
        with connection, file:
            file.write(b"< open can0 >< subscribe 0 0 123 >< subscribe 600 0 00000456 >< echo >")
            assert until(file, b"echo >") == "< hi >< ok >< echo >"
            other, slow = Frame(0x124), [Frame(0x456, bytes([n]), True) for n in range(3)]
            served.send(other, Frame(0x123, b"\x01\xab"), *slow, Frame(0x456), Frame(0x123))
            first = until(file, b">")
            assert first.startswith("< frame 123 ")
            assert first.endswith(" 01 AB  >")
            assert until(file, b">").endswith(" 00  >")  # the others of it are too early
            assert until(file, b">").startswith("< frame 123 ")
            file.write(b"< unsubscribe 123 >< send 321 1 7 >< subscribe 0 >< echo >")
            assert until(file, b"echo >") == "< error unknown command >< echo >"
            served.wait(lambda: len(served.received) == 1)
            file.write(b"< subscribe 0 200000 00000456 >< echo >")
            assert until(file, b"echo >") == "< echo >"
            served.send(Frame(0x123), *slow)
            assert until(file, b">").endswith(" 00  >")
            assert until(file, b">").endswith(" 02  >")  # the newest, when its time has come


def test_socketcands_statistics():
    """``< stat rbytes rpackets tbytes tpackets >`` at the interval, in the control mode alone."""
    with Served("socketcand:127.0.0.1:0") as served:
        connection, file = text_client(served)
        with connection, file:
            file.write(b"< open can0 >< send 321 3 1 2 3 >< statistics 10 >< controlmode >")
            assert until(file, b"< ok >< error unknown command >< ok >")
            served.send(Frame(0x123, bytes(5)), Frame(0x124, bytes(2)))
            served.wait(lambda: served.gateway.get("frames_out") == 2)
            for wrong in (b"-1", b"x", b"9" * 400):
                file.write(b"< statistics " + wrong + b" >")
                assert until(file, b">") == "< error unknown command >"
            file.write(b"< statistics 10 >")
            assert [until(file, b">") for _ in range(3)] == ["< stat 7 2 3 1 >"] * 3
            file.write(b"< statistics 0 >< bcmmode >")
            assert until(file, b"ok >").endswith("< ok >")
            file.write(b"< echo >")
            assert until(file, b">") == "< echo >"


def test_an_adapter_answers_every_command():
    with Served("slcan-tcp:127.0.0.1:0") as served:
        connection, file = text_client(served)

        def answer(command):
            file.write(command.encode() + b"\r")
            found = b""
            while found[-1:] not in (b"\r", b"\a"):
                found += file.read(1)
            return found.decode()

        with connection, file:
            assert [answer(each) for each in ("", "C", "S8", "s031C", "M00000000", "X1")] == [
                "\r"
            ] * 6
            assert answer("t1230") == "\a"  # closed
            assert answer("V") == "V1010\r"
            assert answer("N") == "NSIMU\r"
            assert answer("F") == "F00\r"
            assert [answer(each) for each in ("Z1", "O", "t12321122", "T1234567800")] == [
                "\r",
                "\r",
                "\r",
                "\a",
            ]
            for wrong in (
                "t",
                "t123",
                "tXYZ0",
                "t8000",
                "t1239112233445566778899",
                "T200000000",
                "?",
                "S9",
                "S",
                "S88",
            ):
                assert answer(wrong) == "\a"
            served.send(Frame(0x321, b"\xab"))
            line = until(file, b"\r")
            assert line[:7] == "t3211AB"
            assert 0 <= int(line[7:11], 16) < 60_000
            assert answer("L") == "\r"
            assert answer("t1230") == "\a"  # it only listens
        assert [frame for _, frame in served.received] == [Frame(0x123, b"\x11\x22")]


@pytest.mark.slow
def test_dronecans_slcan_driver_at_a_pseudo_terminal():
    with Served("slcan-pty") as served:
        driver = SLCAN(served.at, bitrate=1_000_000)
        try:
            driver.send(0x1401557F, b"\x01\x02", extended=True)
            served.wait(lambda: len(served.received) == 1)
            served.send(*(Frame(0x1401557F + n, bytes([n]), True) for n in range(100)))
            found = [driver.receive(WAIT_S) for _ in range(100)]
        finally:
            driver.close()
        assert served.received[0][1] == Frame(0x1401557F, b"\x01\x02", True)
        assert [(f.id, f.data, f.extended) for f in found] == [
            (0x1401557F + n, bytes([n]), True) for n in range(100)
        ]


def gateway(link):
    made = CanGateway("gateway")
    made.set("link", link)
    made.initialise()
    return made


@pytest.mark.parametrize(
    ("link", "what"),
    [
        ("socketcnd:127.0.0.1:1", "did you mean 'socketcand'"),
        ("socketcand:127.0.0.1", "of the form 'socketcand:127.0.0.1:29536'"),
        ("socketcand:127.0.0.1:99999", "cannot open the gateway"),
        ("slcan-tcp:no.such.host.invalid:1", "host 'no.such.host.invalid'"),
        ("slcan-pty:7", "of the form 'slcan-pty'"),
        ("virtual:", "of the form 'virtual:can0'"),
    ],
)
def test_gateways_that_cannot_be_are_named(link, what, monkeypatch):
    monkeypatch.delenv(ALLOWED, raising=False)
    with pytest.raises(InputError, match=what):
        gateway(link)


def test_an_unknown_bus_is_named_where_hardware_is_allowed(monkeypatch):
    monkeypatch.setenv(ALLOWED, "1")
    with pytest.raises(InputError, match="cannot open the gateway 'python-can:nosuchbus:x'"):
        gateway("python-can:nosuchbus:x")


def test_a_port_in_use_is_named():
    first = gateway("socketcand:127.0.0.1:0")
    with pytest.raises(InputError, match="in use"):
        gateway(first.get("reached_at"))
    first.close()
    gateway(first.get("reached_at")).close()


@pytest.mark.slow
def test_a_real_adapters_program_is_a_gateway_too(monkeypatch):
    """python-can's slcan interface at this side of a pseudo-terminal, an adapter at the other."""
    monkeypatch.delenv(ALLOWED, raising=False)
    with Served("slcan-pty") as adapter, Served(f"python-can:slcan:{adapter.at}:1000000") as served:
        adapter.send(Frame(0x7F0))
        served.wait(lambda: len(served.received) == 1)
        served.send(Frame(0x111, b"there"))
        adapter.wait(lambda: len(adapter.received) == 1)
        assert adapter.received[0][1] == Frame(0x111, b"there")


class Blocked(Channel):
    def __init__(self):
        self.sent = b""

    def send(self, data):
        self.sent += data


class Fed(Endpoint):
    """An endpoint whose one peer sends what it is given."""

    url = "tcpin:127.0.0.1:1"

    def __init__(self):
        self.peer, self.next = Blocked(), []

    def channels(self):
        return [self.peer]

    def poll(self):
        found, self.next = [(self.peer, each) for each in self.next], []
        return found

    def close(self):
        pass


@pytest.mark.parametrize("kind", [SocketcandGateway, SlcanGateway])
@settings(deadline=None)
@given(data=st.data())
def test_no_text_whatsoever_breaks_a_gateway(kind, data):
    endpoint = Fed()
    gateway = kind(endpoint)
    words = [
        b"< ",
        b" >",
        b"send",
        b" 123",
        b" 8",
        b"fdsend",
        b"sendrtr",
        b"< open can0 >",
        b"< rawmode >",
        b"< controlmode >",
        b"statistics",
        b"subscribe",
        b"\r",
        b"O\r",
        b"t1232",
        b"T",
        b"B",
    ]
    part = st.one_of(st.sampled_from(words), st.binary(max_size=12))
    for _ in range(3):
        endpoint.next = [b"".join(data.draw(st.lists(part, max_size=12)))]
        for _, frame in gateway.poll():
            gateway.send(0, frame)
