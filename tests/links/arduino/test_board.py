"""A board at a serial port: a pseudo-terminal here, with the test in the place of the sketch."""

import os
import time
import tty

import pytest

from seatrial.errors import InputError
from seatrial.links.arduino.component import Arduino
from seatrial.links.text import decode, encode

WAIT_S = 30.0


@pytest.fixture
def line():
    """What the sketch would have, and the device."""
    own, other = os.openpty()
    tty.setraw(other)
    os.set_blocking(own, False)
    yield own, os.ttyname(other)
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


def test_bytes_go_both_ways_and_a_farewell(line):
    own, device = line
    board = started(links=f"1=serial:{device}:38400", farewell="580A")
    os.write(own, b"from the board")
    board.set("rx.uart1", encode(1, [(0, b"to the board")]))
    heard, said, seen, now = b"", b"", 0, 0.0
    deadline = time.monotonic() + WAIT_S
    while (heard, said) != (b"to the board", b"from the board"):
        assert time.monotonic() < deadline
        board.advance(now, 0.02)
        now += 0.02
        number, chunks = decode(board.get("tx.uart1"))
        if number != seen:
            seen = number
            said += b"".join(data for _, data in chunks)
        heard += read(own)
    board.close()
    while not (last := read(own)):
        assert time.monotonic() < deadline
    assert last == b"X\n"


def test_a_real_port_needs_leave_and_pins_are_out_of_reach(monkeypatch):
    monkeypatch.delenv("SEATRIAL_HARDWARE", raising=False)
    with pytest.raises(InputError, match="--hardware"):
        started(links="0=serial:/dev/ttyACM0:115200")
    with pytest.raises(InputError, match="only its UARTs"):
        started(links="0=serial:/dev/ttyACM0:115200", wires="9 servo 1")
    with pytest.raises(InputError, match="not UART=URL"):
        started(links="/dev/ttyACM0")
