"""Address claims of others: whole ones as the package reads them, short ones without effect."""

import random

import pytest
from nmea2000 import NMEA2000Decoder

from seatrial_kits.can.frame import Frame
from seatrial_kits.can.messages import message
from seatrial_kits.nmea.nmea2000.address_claim import name_of
from seatrial_kits.nmea.nmea2000.codec import Decoder

CLAIM = 0x18EEFF21


def test_a_claim_is_what_the_package_makes_of_it() -> None:
    source = random.Random(1)
    for _ in range(200):
        frame = Frame(CLAIM, source.randbytes(8), extended=True)
        reference = {
            f.id: f.raw_value for f in NMEA2000Decoder().decode(message(frame, 1.0)).fields
        }
        found = Decoder({}).decode(frame)
        assert found is not None
        assert found.fields == reference
        assert (found.pgn, found.source) == (60928, 0x21)


def test_a_short_claim_is_none_or_has_a_name() -> None:
    """The package raises for one of three bytes: that ended the node, and the rig with it."""
    with pytest.raises(ValueError, match="deviceFunction"):
        NMEA2000Decoder().decode(message(Frame(CLAIM, b"\xdd\xcc\x8b", extended=True), 1.0))
    for length in range(1, 8):
        for byte in (b"\0", b"\x8b", b"\xff"):
            found = Decoder({}).decode(Frame(CLAIM, byte * length, extended=True))
            assert found is None or 0 <= name_of(found.fields) < 2**64
