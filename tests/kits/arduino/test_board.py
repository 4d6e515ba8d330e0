"""A board at a serial port: a pseudo-terminal here, with the test in the place of the sketch."""

import os
import time
import tty

import pytest

from seatrial import Simulation
from seatrial.errors import InputError
from seatrial.links.endpoints.url import open_endpoint
from seatrial.links.hardware import ALLOWED
from seatrial.links.text import decode, encode
from seatrial.trial.files.trial import load_trial
from seatrial.trial.running.run import run_trial
from seatrial_kits.arduino.component import Arduino

WAIT_S = 30.0
RIG = """\
step = "20 ms"
[components.mega]
fmu = "arduino"
set = { backend = "board", links = "1=serial:DEVICE:38400", safe_state = "" }
"""


def opened():
    """Return what the sketch would have, the other end, and the device."""
    own, other = os.openpty()
    tty.setraw(other)
    os.set_blocking(own, False)
    return own, other, os.ttyname(other)


@pytest.fixture
def line(monkeypatch):
    """The sketch's end of the line, and the device."""
    monkeypatch.setenv(ALLOWED, "1")
    own, other, device = opened()
    yield own, device
    os.close(own)
    os.close(other)


@pytest.fixture
def lines(line):
    """Two of them."""
    own, other, device = opened()
    yield line, (own, device)
    os.close(own)
    os.close(other)


def started(**values):
    board = Arduino("mega")
    for name, value in {"backend": "board", "wires": "", **values}.items():
        board.set(name, value)
    board.initialise()
    board.begin()
    return board


def read(descriptor: int) -> bytes:
    try:
        return os.read(descriptor, 1000)
    except BlockingIOError:
        return b""


def test_bytes_go_both_ways_and_a_safe_state(line):
    own, device = line
    board = started(links=f"1=serial:{device}:38400", safe_state="580A")
    os.write(own, b"from the board")
    board.set("rx.uart1", encode(1, [(0, b"to the board")]))
    received, sent, seen, now = b"", b"", 0, 0.0
    deadline = time.monotonic() + WAIT_S
    while (received, sent) != (b"to the board", b"from the board"):
        assert time.monotonic() < deadline
        board.advance(now, 0.02)
        now += 0.02
        number, chunks = decode(board.get("tx.uart1"))
        if number != seen:
            seen = number
            sent += b"".join(data for _, data in chunks)
        received += read(own)
    board.close()
    while not (last := read(own)):
        assert time.monotonic() < deadline
    assert last == b"X\n"


def step(board, start, count, descriptor):
    """Step by 20 ms from a step on; return what the descriptor got of each, and the next step."""
    received = []
    for k in range(start, start + count):
        board.advance(k * 0.02, 0.02)
        time.sleep(0.005)  # of a pseudo-terminal
        received.append(read(descriptor))
    return received, start + count


def test_a_stale_input_is_sent_safe_state_once_and_may_come_again(line):
    own, device = line
    board = started(links=f"1=serial:{device}:38400", safe_state="580A", timeout=0.2)
    received, now = step(board, 0, 20, own)
    assert b"".join(received) == b""  # nothing was there that could be stale
    for number in (1, 2):
        board.set("rx.uart1", encode(number, [(0, b"go")]))
        received, now = step(board, now, 20, own)
        assert b"".join(received) == b"goX\n"
        assert b"".join(received[:11]) == b"go"  # for 0.2 s
    board.close()


def test_a_lost_link_stops_the_others_until_it_is_back(lines):
    (first, device), (telling, second) = lines
    links = f"0=serial:{device}:38400 1=serial:{second}:38400"
    board = started(links=links, safe_state="580A", timeout=0.2)
    now, number = 0, 0

    def feed(count):
        nonlocal now, number
        received = []
        for _ in range(count):
            number += 1
            board.set("rx.uart0", encode(number, [(0, b"go ")]))
            more, now = step(board, now, 1, first)
            received += more
        return received

    def feed_until(connected):
        received, deadline = [], time.monotonic() + WAIT_S
        while board.get("connected") != connected:
            assert time.monotonic() < deadline
            received += feed(1)
        return b"".join(received + feed(5))

    assert b"X" not in b"".join(feed(15))  # one that never spoke is not missed
    os.write(telling, b"alive")
    feed_until(True)
    assert feed_until(False).endswith(b"go X\n")
    os.write(telling, b"again")
    assert feed_until(True).endswith(b"go go ")
    board.close()


def test_a_safe_state_is_written_on_purpose(line):
    own, device = line
    with pytest.raises(InputError, match=f"safe_state is not set, and 'serial:{device}:38400'"):
        started(links=f"1=serial:{device}:38400")
    board = started(links=f"1=serial:{device}:38400", safe_state="")
    board.close()
    assert read(own) == b""


def test_it_is_connected_once_something_was_received(line):
    own, device = line
    board = started(links=f"1=serial:{device}:38400", safe_state="")
    step(board, 0, 5, own)
    assert not board.get("connected")
    os.write(own, b"here")
    _, now = step(board, 5, 1, own)
    deadline = time.monotonic() + WAIT_S
    while not board.get("connected"):
        assert time.monotonic() < deadline
        _, now = step(board, now, 1, own)
    board.close()


@pytest.mark.parametrize("engine", ["direct", pytest.param("fmu", marks=pytest.mark.interop)])
def test_it_runs_in_real_time_alone(line, engine, write, tmp_path):
    _, device = line
    rig = RIG.replace("DEVICE", device)
    write("rig.toml", rig)
    for pace in ("", "[real_time]\nfactor = 2.0\n"):
        trial = load_trial(str(write("trial.toml", f'rig = "rig.toml"\nstop = "0.1 s"\n{pace}')))
        with pytest.raises(InputError, match=r"mega lives on the wall clock.*--real-time 1"):
            run_trial(trial, tmp_path / "run", engine=engine)
    assert not (tmp_path / "run").exists()
    trial = load_trial(str(write("trial.toml", 'rig = "rig.toml"\nstop = "0.1 s"\n[real_time]\n')))
    assert run_trial(trial, tmp_path / "run", engine=engine).status == "complete"


def test_a_simulation_in_python_has_no_real_time(write):
    other = open_endpoint("pty")  # a terminal of a run
    rig = write("rig.toml", RIG.replace("DEVICE", other.url))
    with pytest.raises(InputError, match="mega lives on the wall clock"):
        Simulation(rig)
    other.close()


def test_a_real_port_needs_leave_and_pins_are_out_of_reach(monkeypatch):
    monkeypatch.delenv(ALLOWED, raising=False)
    with pytest.raises(InputError, match="--hardware"):
        started(links="0=serial:/dev/ttyACM0:115200", safe_state="")
    with pytest.raises(InputError, match="only its UARTs"):
        started(links="0=serial:/dev/ttyACM0:115200", wires="9 servo 1")
    with pytest.raises(InputError, match="not UART=URL"):
        started(links="/dev/ttyACM0")
