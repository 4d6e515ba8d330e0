"""Lengths of frames on the bus: by hand, by an independent construction, by published bounds."""

import random
from statistics import fmean

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from seatrial_kits.can.bits import INTERMISSION, crc15, first_difference, length, stuffed
from seatrial_kits.can.frame import FD_LENGTHS, Frame

from . import reference_bits

# Worked out by hand. "0 x 12" are twelve zeros; | is where a stuff bit goes in.
#
# Base, 0x000, no data: SOF, 11 of identifier, RTR, IDE, r0 and 4 of DLC are 19 zeros; the CRC of
#   zeros is 0, so 15 more: 34 zeros, a stuff bit after each 5: 6. 19 + 15 + 10 + 6 = 50.
# Base, 0x000, remote, requests 0 bytes: 0 x 12, RTR 1, 0 x 6. The register of the CRC becomes
#   4599 with the one, then, a zero each: 4EAB, 58CF, 7407, 2D97, 5B2E, 73C5 = 111 0011 1100 0101.
#   00000|00000|00 1 00000|0 111 00 1111 000 1 0 1: 3. 44 + 3 = 47.
# Extended, 0, no data: 0 x 12, SRR 1, IDE 1, then 18 of identifier, RTR, r1, r0, 4 of DLC: 0 x 25.
#   CRC: 4599, 0B32 (the second one), 1664 2CC8 5990 76B9 28EB 51D6 6635 09F3 13E6 27CC 4F98 5AA9
#   70CB 240F 481E 55A5 6ED3 183F 307E 60FC 0461 08C2 1184 2308 4610 = 100 0110 0001 0000.
#   00000|00000|00 11 00000|00000|00000|00000|00000| 1 000 11 0000 1 0000: 7. 64 + 7 = 71.
# FD, base, 0x000, no data, one rate: SOF, 11, RRS, IDE: 0 x 14, FDF 1, then res, BRS, ESI and 4 of
#   DLC: 0 x 7. 00000|00000|0000 1 00000|00: 3. 17 + 5 + 3, then 4 of stuff count, 17 of CRC, 6 fixed
#   stuff bits, then 10: 62.
# The same with a switch: BRS is 1, and after it 0 x 5: the fifth is the last before the CRC field, whose
#   fixed stuff bit takes the stuff bit's place: 2. Nominal: 17 + 2 + 10, data: 5 + 27; BRS and the
#   delimiter are cut in two, half of each at either rate, which makes 28 and 33.
# FD, extended, 0, no data, one rate: 0 x 12, 11, 18 of identifier and RRS: 0 x 19, FDF 1, 0 x 7.
#   00000|00000|00 11 00000|00000|00000|0000 1 00000|00: 6. 36 + 5 + 6 + 27 + 10 = 84.
# FD, base, 0x555, switch: 0 10101010101 00 1 0 1 0, DLC, data: no run of 5 before the data.
#   12 zero bytes, DLC 1001: 0 x 96, 19 stuff bits: 5 + 96 + 19 + 27 + 1 = 148 at the data rate.
#   16 zero bytes, DLC 1010: 0 x 129, 25: 5 + 128 + 25 + 27 + 1 = 186.
#   20 zero bytes, DLC 1011: 0 x 160, the 32nd would come after the very last bit: 31. Above 16 bytes
#   the CRC has 21 bits, 7 fixed stuff bits: 5 + 160 + 31 + 32 + 1 = 229.
#   64 bytes 01010101, DLC 1111: none: 5 + 512 + 32 + 1 = 550.
BY_HAND = [
    (Frame(0), (50, 0)),
    (Frame(0, remote=True), (47, 0)),
    (Frame(0, extended=True), (71, 0)),
    (Frame(0, fd=True), (62, 0)),
    (Frame(0, fd=True, bit_rate_switch=True), (28, 33)),
    (Frame(0, extended=True, fd=True), (84, 0)),
    (Frame(0x555, bytes(12), fd=True, bit_rate_switch=True), (26, 148)),
    (Frame(0x555, bytes(16), fd=True, bit_rate_switch=True), (26, 186)),
    (Frame(0x555, bytes(20), fd=True, bit_rate_switch=True), (26, 229)),
    (Frame(0x555, b"\x55" * 64, fd=True, bit_rate_switch=True), (26, 550)),
]


@pytest.mark.parametrize(("frame", "bits"), BY_HAND)
def test_frames_worked_out_by_hand(frame, bits):
    assert length(frame) == bits


@st.composite
def frames(draw, fd=False):
    extended = draw(st.booleans())
    identifier = draw(st.integers(0, (1 << (29 if extended else 11)) - 1))
    remote = not fd and draw(st.booleans())
    size = draw(st.sampled_from(FD_LENGTHS if fd else range(9)))
    # Runs of equal bits are what matters.
    byte = st.one_of(st.sampled_from((0x00, 0xFF, 0x0F, 0xF8, 0x1F)), st.integers(0, 255))
    data = bytes(draw(st.lists(byte, min_size=size, max_size=size)))
    if remote:
        return Frame(identifier, b"", extended, True, requested=size)
    switch, state = (draw(st.booleans()), draw(st.booleans())) if fd else (False, False)
    return Frame(identifier, data, extended, fd=fd, bit_rate_switch=switch, error_state=state)


@settings(deadline=None)
@given(frames())
def test_classic_frames_are_as_long_as_their_construction(frame):
    assert length(frame) == (len(reference_bits.classic(frame)), 0)


@settings(deadline=None)
@given(frames(fd=True))
def test_fd_frames_are_as_long_as_their_construction(frame):
    slow, fast, tail = reference_bits.fd(frame)
    if frame.bit_rate_switch:  # BRS and the CRC delimiter are half of one rate, half of the other
        assert length(frame) == (len(slow) + len(tail) - 1, len(fast) + 1)
    else:
        assert length(frame) == (len(slow + fast + tail), 0)


@settings(deadline=None)
@given(frames())
def test_classic_frames_keep_to_the_bounds_of_the_standard(frame):
    """From the start of frame to the CRC there are n bits, and at most (n - 1) / 4 stuff bits."""
    covered = (54 if frame.extended else 34) + 8 * len(frame.data)
    assert covered + 10 <= length(frame).nominal <= covered + 10 + (covered - 1) // 4


def test_the_worst_case_is_reached():
    """Five equal bits, then each stuff bit begins the next run of four: 11111 | 0000 | 1111 ..."""
    assert stuffed(0b11111_0000_1111_0000_1111, 21) == 5 == (21 - 1) // 4


@settings(deadline=None)
@given(st.binary(max_size=80))
def test_the_crc_is_that_of_the_bitwise_definition(data):
    bits = [int(digit) for byte in data for digit in format(byte, "08b")]
    assert crc15(int.from_bytes(data, "big"), 8 * len(data)) == reference_bits.crc15(bits)


def test_the_crc_has_its_catalogued_check_value():
    """CRC-15/CAN of the catalogue of parametrised CRC algorithms: 059E."""
    assert crc15(int.from_bytes(b"123456789", "big"), 72) == 0x059E


@pytest.mark.parametrize(
    ("extended", "least", "mean", "most"), [(True, 131, 135, 143), (False, 111, 114, 121)]
)
def test_random_frames_of_eight_bytes(extended, least, mean, most):
    """Published measurements of another implementation, intermission included."""
    rng = random.Random(7)
    largest = 1 << (29 if extended else 11)
    found = [
        length(Frame(rng.randrange(largest), rng.randbytes(8), extended)).nominal + INTERMISSION
        for _ in range(4000)
    ]
    assert least <= min(found) <= least + 1
    assert fmean(found) == pytest.approx(mean, abs=0.6)
    assert most - 3 <= max(found) <= most + 5


@settings(max_examples=50, deadline=None)
@given(frames(), st.integers(0, 63))
def test_the_first_difference_is_where_the_bits_part(frame, which):
    if not frame.data:
        return
    place, bit = divmod(which % (8 * len(frame.data)), 8)
    data = bytearray(frame.data)
    data[place] ^= 1 << bit
    other = Frame(frame.identifier, bytes(data), frame.extended)
    one, two = reference_bits.classic(frame), reference_bits.classic(other)
    expected = next(n for n, (a, b) in enumerate(zip(one, two, strict=False)) if a != b)
    assert first_difference(frame, other) == (expected, one[expected] == 1)
