"""The codec against the layered standard's definitions: codes, sizes, bytes written out."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from seatrial.errors import InputError
from seatrial_kits.can.frame import Frame
from seatrial_kits.can.operations import (
    ArbitrationLost,
    BitRate,
    Buffering,
    BusError,
    Confirm,
    Error,
    FormatError,
    State,
    Status,
    Transmit,
    Wakeup,
    decode,
    encode,
)

from .test_bits import frames

# FMI-LS-BUS 1.3, section CAN: code and length (4 bytes each), then the arguments, low byte first.
# Lengths: transmit 16 + n, FD 17 + n, confirm and arbitration lost 12, bus error 15, configuration
# 9 and its arguments (4 of a rate, 1 of a behaviour), status 9, wake-up 8, format error 10 + n.
EXAMPLES = [
    (
        Transmit(Frame(0x123, b"\x01\x02\x03")),
        "10000000 13000000 23010000 00 00 0300 010203",
    ),
    (
        Transmit(Frame(0x09F11217, b"\xff" * 8, extended=True)),
        "10000000 18000000 1712F109 01 00 0800 FFFFFFFFFFFFFFFF",
    ),
    (
        Transmit(Frame(0x18EAFFFE, extended=True, remote=True)),
        "10000000 10000000 FEFFEA18 01 01 0000",
    ),
    (
        Transmit(Frame(0x7FF, b"\xaa" * 12, fd=True, bit_rate_switch=True)),
        "11000000 1D000000 FF070000 00 01 00 0C00 AAAAAAAAAAAAAAAAAAAAAAAA",
    ),
    (
        Transmit(Frame(1, b"", extended=True, fd=True, error_state=True)),
        "11000000 11000000 01000000 01 00 01 0000",
    ),
    (Confirm(0x1FFFFFFF), "20000000 0C000000 FFFFFF1F"),
    (ArbitrationLost(0x100), "30000000 0C000000 00010000"),
    (BusError(0x100, Error.ACK, True, True), "31000000 0F000000 00010000 05 01 01"),
    (BusError(0x100, Error.CRC, False, False), "31000000 0F000000 00010000 04 02 00"),
    (BitRate(250_000), "40000000 0D000000 01 90D00300"),
    (BitRate(2_000_000, fd=True), "40000000 0D000000 02 80841E00"),
    (Buffering(True), "40000000 0A000000 04 01"),
    (Buffering(False), "40000000 0A000000 04 02"),
    (Status(State.ERROR_ACTIVE), "41000000 09000000 01"),
    (Status(State.BUS_OFF), "41000000 09000000 03"),
    (Wakeup(), "42000000 08000000"),
    (FormatError(b"\x99\x00"), "01000000 0C000000 0200 9900"),
]


@pytest.mark.parametrize(("operation", "written"), EXAMPLES)
def test_operations_are_the_standards_bytes(operation, written):
    assert encode(operation) == bytes.fromhex(written)
    assert decode(bytes.fromhex(written)) == [operation]


def test_several_operations_in_a_row():
    operations = [operation for operation, _ in EXAMPLES]
    assert decode(b"".join(map(encode, operations))) == operations


def test_a_remote_frame_keeps_the_length_it_requests():
    requested = Transmit(Frame(0x321, remote=True, requested=5))
    assert decode(encode(requested)) == [requested]


@pytest.mark.parametrize(
    ("written", "what"),
    [
        ("12000000 17000000 23010000 00 00 00 00 00000000 0100 AA", "0x12"),  # CAN XL
        ("40000000 0D000000 03 80969800", "03"),  # the rate of CAN XL
        ("10000000", "too short"),
        ("42000000 07000000", "7 bytes"),
        ("42000000 09000000", "9 bytes"),
        ("42000000 09000000 00", "0x42"),
        ("10000000 12000000 23010000 00 00 0300 0102", "announced"),
        ("10000000 10000000 00080000 00 00 0000", "0x800"),
        ("10000000 10000000 23010000 02 00 0000", "neither"),
        ("11000000 1A000000 23010000 00 00 00 0900 010203040506070809", "9 bytes"),
        ("31000000 0F000000 00010000 07 01 01", "7 is not"),
        ("31000000 0F000000 00010000 01 03 01", "flag 3"),
        ("41000000 09000000 04", "4 is not"),
        ("99000000 08000000", "0x99"),
    ],
)
def test_what_is_no_operation_is_refused(written, what):
    with pytest.raises(InputError, match=what):
        decode(bytes.fromhex(written))


@settings(deadline=None)
@given(st.one_of(frames(), frames(fd=True)))
def test_frames_come_back(frame):
    assert decode(encode(Transmit(frame))) == [Transmit(frame)]


@settings(deadline=None)
@given(st.one_of(st.binary(max_size=60), frames().map(lambda f: encode(Transmit(f)))), st.data())
def test_any_bytes_are_operations_or_refused(octets, data):
    spoiled = bytearray(octets)
    for _ in range(data.draw(st.integers(0, 3)) if spoiled else 0):
        spoiled[data.draw(st.integers(0, len(spoiled) - 1))] = data.draw(st.integers(0, 255))
    try:
        found = decode(bytes(spoiled))
    except InputError:
        return
    # Padding of remote frames is not kept: their length is.
    assert decode(b"".join(map(encode, found))) == found
