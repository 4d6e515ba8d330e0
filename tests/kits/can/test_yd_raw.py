"""The gateway of Yacht Devices: its lines by hand and by canboat, and a program behind it."""

import socket

import pytest
from hypothesis import given
from hypothesis import strategies as st

from seatrial.errors import InputError
from seatrial_kits.can.frame import Frame
from seatrial_kits.can.gateways.url import check_link, open_gateway
from seatrial_kits.can.gateways.yd_raw import read_line, written_line

from .served import WAIT_S, Served

FRAME = Frame(0x19F51323, bytes.fromhex("012F3070002F3070"), extended=True)


def test_a_line_is_the_manuals():
    """YDWG-02 user manual, appendix E."""
    time_ns = ((17 * 60 + 33) * 60 + 21) * 10**9 + 107_999_999
    line = "17:33:21.107 R 19F51323 01 2F 30 70 00 2F 30 70"
    assert written_line(time_ns, FRAME) == f"{line}\r\n"
    assert read_line(line) == FRAME
    assert read_line("19F51323 01 2f 30 70 00 2f 30 70\r") == FRAME
    assert written_line(86_400 * 10**9, Frame(1, b"", True)) == "00:00:00.000 R 00000001 \r\n"


@given(st.integers(0, 2**29 - 1), st.binary(max_size=8), st.integers(0, 10**15))
def test_a_line_is_read_as_it_was_written(identifier, data, time_ns):
    frame = Frame(identifier, data, extended=True)
    assert read_line(written_line(time_ns, frame).strip()) == frame


@pytest.mark.parametrize(
    "line", ["hello", "19F51323 1FF", "FFFFFFFF 01", "1 " + "00 " * 9, "12:00 R"]
)
def test_other_lines_are_refused(line):
    with pytest.raises((ValueError, InputError)):
        read_line(line)


def test_a_program_reads_the_bus_and_sends_to_it():
    with Served("yd-raw-tcp:127.0.0.1:0") as served:
        host, _, port = served.at.removeprefix("yd-raw-tcp:").partition(":")
        with socket.create_connection((host, int(port)), timeout=WAIT_S) as connection:
            file = connection.makefile("rwb", buffering=0)
            file.write(b"nonsense\r\n19F51323 01 2F 30 70 00 2F 30 70\r\n")
            served.wait(lambda: [frame for _, frame in served.received] == [FRAME])
            other = Frame(0x09F80123, bytes(8), True)
            served.send(Frame(0x123, b"base"), other)  # the first has no line
            line = file.readline().decode()
            assert line.endswith(" R 09F80123 00 00 00 00 00 00 00 00\r\n")
            assert read_line(line) == other


def test_everything_goes_to_one_address_by_udp():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as listener:
        listener.bind(("127.0.0.1", 0))
        listener.settimeout(WAIT_S)
        port = listener.getsockname()[1]
        with Served(f"yd-raw-udp:127.0.0.1:{port}") as served:
            served.send(FRAME)
            data, address = listener.recvfrom(1000)
            assert read_line(data.decode()) == FRAME
            listener.sendto(b"09F80123 01\r\n", address)
            served.wait(lambda: [f for _, f in served.received] == [Frame(0x09F80123, b"\1", True)])


def test_mistakes_are_named():
    with pytest.raises(InputError, match=r"is not of the form 'yd-raw-tcp:127\.0\.0\.1:1457'"):
        check_link("yd-raw-tcp:here")
    with pytest.raises(InputError, match="did you mean"):
        open_gateway("yd-raw:127.0.0.1:0")
