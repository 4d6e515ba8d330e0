"""The recording whose values reach a rig (tests/kits/nmea/nmea2000), as canboat reads it."""

import pytest

from tests.interop import canboat
from tests.kits.nmea.nmea2000.whole_network import LOG, MESSAGES

pytestmark = canboat.needed


def test_canboat_reads_the_values_that_the_rig_has():
    """126720 apart, whose proprietary fields the recording makes up."""
    wanted = [sent for _, sent in MESSAGES if sent.pgn != 126720]
    found = [m for m in canboat.read(LOG.read_text().splitlines()) if m["pgn"] != 126720]
    assert [(m["pgn"], m["src"]) for m in found] == [(s.pgn, s.source) for s in wanted]
    for message, sent in zip(found, wanted, strict=True):
        for name, value in sent.fields.items():
            read = message["fields"][name]
            if isinstance(value, float):
                assert float(read) == pytest.approx(value, rel=2e-6, abs=1e-7), (sent.pgn, name)
            elif name == "instance":
                continue  # by name or number
            else:
                assert str(read) == str(value), (sent.pgn, name)
