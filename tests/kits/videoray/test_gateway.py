"""The gateway and streams through real terminals and sockets, with pyserial at the other end."""

import socket
import sys
import time

import pytest
import serial

from seatrial.errors import InputError
from seatrial.links.hardware import ALLOWED
from seatrial.links.serial_gateway import SerialGateway
from seatrial_kits.videoray.frame import encode
from seatrial_kits.videoray.station import NEUTRAL, Commands
from seatrial_kits.videoray.topside import Pro4Topside

from .bench import PACKETS, Line, request
from .live import STEP, WAIT_S, LiveRov

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="pseudo-terminals")


def started(cls, **parameters):
    component = cls(cls.__name__)
    for name, value in parameters.items():
        component.set(name, value)
    component.setup(0.0)
    component.initialise()
    component.begin()
    return component


def test_a_program_with_pyserial_talks_to_the_vehicle(tmp_path):
    with (
        LiveRov(f"pty:{tmp_path}/rov") as live,
        serial.Serial(live.at, 115_200, timeout=WAIT_S) as port,
    ):
        port.write(PACKETS[2])
        assert port.read(len(PACKETS[3])) == PACKETS[3]
        port.write(PACKETS[6][:10])
        time.sleep(0.02)
        port.write(PACKETS[6][10:])
        assert port.read(42)[:7] == PACKETS[7][:7]


def test_over_tcp():
    with LiveRov("tcpin:127.0.0.1:0") as live:
        _, host, number = live.at.split(":")
        with socket.create_connection((host, int(number)), timeout=WAIT_S) as client:
            client.sendall(PACKETS[0])
            received = b""
            while len(received) < 17:
                received += client.recv(100)
            assert received[:7] == PACKETS[1][:7]


def cycles(topside, gateway, seconds):
    """Run a topside in real time; return the round trips of its cycles in wall time, s."""
    begun, steps, trips, asked, answered = time.monotonic(), 0, [], 0.0, 0
    while steps * STEP < seconds:
        sent, received = topside.get("tx"), gateway.get("tx")
        topside.set("rx", received)
        gateway.set("rx", sent)
        before = topside.get("cycles")
        for component in (topside, gateway):
            component.advance(steps * STEP, STEP)
        if topside.get("cycles") > before:
            asked = time.monotonic()
        received = gateway.get("received")
        if received > answered:
            trips.append(time.monotonic() - asked)
            answered = received
        steps += 1
        time.sleep(max(begun + steps * STEP - time.monotonic(), 0.0))
    return trips


@pytest.mark.slow
def test_the_topside_drives_a_vehicle_over_a_terminal(tmp_path):
    with LiveRov(f"pty:{tmp_path}/rov") as live:
        topside = started(Pro4Topside, manual_limit=0.5, timeout=5.0)
        gateway = started(
            SerialGateway, links=f"serial:{live.at}:115200", safe_state=encode(NEUTRAL).hex()
        )
        try:
            topside.set("armed", True)
            topside.set("manual", [1.0, 0.0, 0.0])
            cycles(topside, gateway, 2.0)
            live.wait(lambda: live.rov.get("commanded"))
            assert topside.get("connected")
            assert topside.get("depth") == pytest.approx(3.0, abs=0.01)
            assert live.rov.get("duty")[0] > 0.38
        finally:
            gateway.close()  # the safe-state bytes
        live.wait(lambda: live.rov.get("duty") == [0.0, 0.0, 0.0])


def test_the_safe_state_of_the_profile_stops_the_thrusters():
    from seatrial.system.profile.profile import load_profile

    safe_state = load_profile("videoray").parameters("links.topside-port")["safe_state"]
    assert bytes.fromhex(safe_state) == encode(NEUTRAL)
    line = Line(Pro4Topside)
    assert request(payload=Commands().block()) == NEUTRAL
    assert line["connected"] is False


def test_a_real_port_needs_leave(monkeypatch):
    monkeypatch.delenv(ALLOWED, raising=False)
    with pytest.raises(InputError, match="--hardware"):
        started(SerialGateway, links="serial:/dev/ttyS0:115200", safe_state="")


def test_a_safe_state_is_written_on_purpose(monkeypatch):
    monkeypatch.setenv(ALLOWED, "1")
    remedy = r"safe_state is not set, and 'serial:/dev/null:9600' reaches a device: .* ''"
    with pytest.raises(InputError, match=remedy):
        started(SerialGateway, links="serial:/dev/null:9600")
    with pytest.raises(InputError, match="cannot open the link"):  # the next mistake
        started(SerialGateway, links="serial:/dev/null:9600", safe_state="")


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        ({"links": "tcp:1"}, "kind of link 'tcp'"),
        ({"safe_state": "FAA"}, "is not bytes such as"),
    ],
)
def test_mistakes_are_reported(parameters, message):
    with pytest.raises(InputError, match=message):
        started(SerialGateway, **parameters)
