"""Recorded sentences, AIS' among them, at their times; those of pyais and pynmea2."""

from __future__ import annotations

import pynmea2
import pytest
from pyais import NMEAMessage, encode_dict

from seatrial.errors import InputError
from seatrial.links.text import Inbox
from seatrial_kits.nmea.nmea0183.player import Nmea0183Player


def heading(degrees):
    return str(pynmea2.HDT("HE", "HDT", (f"{degrees:.1f}", "T")))


def rmc(clock):
    fields = (clock, "A", "4500.0", "N", "00700.0", "E", "1.0", "0.0", "010524", "", "")
    return str(pynmea2.RMC("GP", "RMC", fields))


def ais(mmsi):
    return encode_dict({"type": 1, "mmsi": mmsi, "lat": 1.0, "lon": 2.0})[0]


def played(path, *, steps=400, h=0.01, **parameters):
    player = Nmea0183Player("boat")
    for name, value in {"file": str(path), **parameters}.items():
        player.set(name, value)
    player.setup(0.0)
    player.initialise()
    player.begin()
    boxes = {"tx": {}, "ais": {}}
    found = {"tx": [], "ais": []}
    for number in range(steps):
        player.advance(number * h, h)
        for port, box in boxes.items():
            found[port] += [(when / 1e9, data) for when, data in Inbox(box).take(player.get(port))]
    return found, player


@pytest.mark.parametrize(
    "before",
    [
        lambda k: f"{1.7e9 + k:.3f} ",
        lambda k: f"{(1_700_000_000 + k) * 1000} ",
        lambda k: f"2024-05-01T12:00:{k:02d}.000Z;",
        lambda k: f"23:59:{58 + k:02d}.000 " if k < 2 else f"00:00:{k - 2:02d}.000 ",
        lambda k: f"\\s:gps,c:{1_700_000_000 + k}*00\\",
    ],
)
def test_at_the_times_before_the_lines(tmp_path, before):
    path = tmp_path / "boat.nmea"
    lines = [heading(k) if k != 1 else ais(123456789) for k in range(4)]
    path.write_text("".join(f"{before(k)}{line}\r\n" for k, line in enumerate(lines)))
    found, player = played(path)
    assert [when for when, _ in found["tx"]] == pytest.approx([0.0, 2.0, 3.0])
    assert found["tx"][0][1] == lines[0].encode() + b"\r\n"
    assert [when for when, _ in found["ais"]] == pytest.approx([1.0])
    assert NMEAMessage(found["ais"][0][1].strip()).decode().mmsi == 123456789
    assert player.get("played") == 4


def test_at_the_times_in_the_sentences(tmp_path):
    """Two headings follow each position: half a second apart."""
    path = tmp_path / "boat.nmea"
    lines = []
    for k in range(3):
        lines += [rmc(f"12000{k}.00"), heading(2 * k), "$HEHDT,1.0,T*00", heading(2 * k + 1)]
    path.write_text("\n".join(lines) + "\n")
    found, player = played(path)
    times = [when for when, _ in found["tx"]]
    assert times == pytest.approx([k / 3.0 for k in range(9)], abs=1e-6)
    assert player.get("skipped") == 3


def test_those_that_are_named_alone(tmp_path):
    path = tmp_path / "boat.nmea"
    path.write_text(
        "".join(f"{k} {line}\n" for k, line in enumerate([rmc("120000"), heading(1), ais(1)]))
    )
    assert [len(each) for each in played(path, sentences="HE")[0].values()] == [1, 0]
    assert [len(each) for each in played(path, leave_out="!AI GPRMC")[0].values()] == [1, 0]
    with pytest.raises(InputError, match=r"no sentence is left to be played; it has !AIVD"):
        played(path, sentences="IIMWV")


def test_without_a_time(tmp_path):
    path = tmp_path / "boat.nmea"
    path.write_text(heading(1) + "\n" + heading(2) + "\n")
    with pytest.raises(InputError, match="has no times: set interval"):
        played(path)
    found, _ = played(path, interval=0.5)
    assert [when for when, _ in found["tx"]] == pytest.approx([0.0, 0.5])
