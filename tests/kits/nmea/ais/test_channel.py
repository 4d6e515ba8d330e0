"""Range, loss and ships of a file on the VHF channel."""

import math

import pytest

from seatrial.errors import InputError
from seatrial_kits.nmea.ais.vhf_channel import read_traffic

from .sea import KNOT, Sea

TRAFFIC = """
[[ships]]
mmsi      = 235009802
name      = "Ever Late"
ship_type = 71
length    = "200 m"
beam      = "32 m"
antenna   = "30 m"
track     = [["0 s", "2 km", "0 m"], ["600 s", "2 km", "6 km"]]

[[ships]]
mmsi      = 235009803
equipment = "B-CS"
track     = [["100 s", "0 m", "-1 km"], ["200 s", "300 m", "-1 km"], ["400 s", "300 m", "-1 km"]]
"""


@pytest.fixture
def traffic(tmp_path):
    path = tmp_path / "traffic.toml"
    path.write_text(TRAFFIC, "utf-8")
    return str(path)


def away(east):
    """Positions of two ships east of each other."""
    return {"a": {"velocity_n": [8.0, 0.0, 0.0]}, "b": {"position_n": [0.0, east, 0.0]}}


@pytest.mark.parametrize(("kilometres", "received"), [(10.0, True), (16.0, True), (17.0, False)])
def test_the_radio_horizon_ends_the_range(kilometres, received):
    """Antennas 4 m high: 4.12 km (2 + 2) = 16.5 km, as the usual formula has it."""
    sea = Sea({"falloff": 1e6}, **away(1e3 * kilometres))
    sea.run(60.0)
    assert bool(sea.received("b", 1)) is received


def test_high_antennas_reach_farther_up_to_the_greatest_distance():
    high = {"mount": [-100.0] * 8, "falloff": 1e6}
    for kilometres, received in ((70.0, True), (75.0, False)):
        sea = Sea(high, **away(1e3 * kilometres))
        sea.run(30.0)
        assert bool(sea.received("b", 1)) is received


def test_an_antenna_under_water_receives_nothing():
    sea = Sea({}, a={}, b={"position_n": [0.0, 100.0, 5.0]})
    sea.run(30.0)
    assert not sea.received("b", 1)
    assert not sea.received("a", 1)


@pytest.mark.slow
def test_loss_is_its_share():
    sea = Sea({"loss": 0.5}, **away(1000.0))
    sea.run(600.0)
    share = len(sea.received("b", 1)) / (600.0 / 6.0)
    assert share == pytest.approx(0.5, abs=4.0 * math.sqrt(0.25 / 100.0))


def test_a_report_takes_a_slot():
    sea = Sea({}, **away(3000.0))
    sea.run(60.0)
    sent = [t for t, data in sea.bursts if len(data) == 21]  # message 1: 168 bits
    way = 3000.0 / 299_792_458.0
    late = [when - begun for (when, _), begun in zip(sea.received("b", 1), sent, strict=False)]
    assert len(late) >= 8
    assert late == pytest.approx([256.0 / 9600.0 + way] * len(late), abs=1e-8)


def test_scripted_ships_are_received_where_they_are(traffic):
    sea = Sea({"traffic": traffic}, a={}, b={})
    sea.run(300.0)
    late = [(t, m) for t, m in sea.received("a", 1) if m.mmsi == 235009802]
    assert len(late) == pytest.approx(300.0 / 6.0, abs=2)  # 19.4 knots
    for when, found in late:
        # On the equator, at the origin: a degree is 110.574 km north, 111.320 km east.
        assert found.lat == pytest.approx(2.0 / 110.574, abs=2e-6)
        assert found.lon == pytest.approx((when - 0.0267) * 0.01 / 111.320, abs=3e-6)
        assert (found.speed, found.course, found.heading) == (round(10.0 / KNOT, 1), 90.0, 90)
    (_, static), *_ = [each for each in sea.received("a", 5) if each[1].mmsi == 235009802]
    assert (static.shipname, static.to_bow, static.to_port) == ("EVER LATE", 100, 16)
    small = [(t, m) for t, m in sea.received("b", 18) if m.mmsi == 235009803]
    assert all(100.0 <= t < 400.1 for t, _ in small)
    assert {m.speed for t, m in small if t < 200.0} == {round(3.0 / KNOT, 1)}
    assert sea.ships["a"].get("targets") == 3


@pytest.mark.slow
def test_fifty_ships_lose_few_of_their_reports(tmp_path):
    """Who finds the channel busy waits; only those that wait for one burst begin together."""
    ship = '[[ships]]\nmmsi = {}\ntrack = [["0 s", "{} m", "0 m"], ["100 s", "{} m", "0 m"]]\n'
    text = "".join(ship.format(235000000 + k, 100 * k, 100 * k + 500) for k in range(1, 51))
    path = tmp_path / "many.toml"
    path.write_text(text, "utf-8")
    sea = Sea({"traffic": str(path)}, a={}, b={})
    sea.run(60.0)
    received = [m.mmsi for _, m in sea.received("a", 1)]
    assert {m for m in received if m > 235000000 and m < 236000000} == set(
        range(235000001, 235000051)
    )
    assert len(received) > 50 * 60 / 10 * 0.9
    assert sea.channel.get("lost")[0] < 0.06 * len(received)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", r"tables \[\[ships\]\] are needed"),
        ("ship = 1", "'ship'"),
        ("[[ships]]\nmmsi = 5", r"ships\[0\]: track is missing"),
        ("[[ships]]\ntrack = []", r"ships\[0\]: mmsi is missing"),
        ("[[ships]]\nmmsi = 'x'\ntrack = []", r"ships\[0\].mmsi is 'x', a whole number"),
        ("[[ships]]\nmmsi = 5\nnmae = 'x'\ntrack = []", r"ships\[0\]: .*'nmae'.*name"),
        ("[[ships]]\nmmsi = 5\ntrack = []", r"ships\[0\].track: two points"),
        ("[[ships]]\nmmsi = 5\ntrack = [[0, 0], [1, 0]]", r"track\[0\] is \[0, 0\]"),
        ("[[ships]]\nmmsi = 5\ntrack = [['0 s', '1 kg', 0], [1, 0, 0]]", r"track\[0\], north.*kg"),
        ("[[ships]]\nmmsi = 5\ntrack = [[1, 0, 0], [1, 0, 0]]", r"track\[1\]: 1 s is not after"),
        (
            "[[ships]]\nmmsi = 5\nequipment = 'C'\ntrack = [[0, 0, 0], [1, 0, 0]]",
            "allowed: A, B-SO",
        ),
        (
            "[[ships]]\nmmsi = 5\nantenna = '-1 m'\ntrack = [[0, 0, 0], [1, 0, 0]]",
            "antenna is -1 m",
        ),
        ("[[ships]]\nmmsi = 5\nstatus = 16\ntrack = [[0, 0, 0], [1, 0, 0]]", "status is 16"),
        (2 * "[[ships]]\nmmsi = 5\ntrack = [[0, 0, 0], [1, 0, 0]]\n", r"ships\[1\].mmsi: 5"),
    ],
)
def test_files_that_cannot_be(tmp_path, text, message):
    path = tmp_path / "ships.toml"
    path.write_text(text, "utf-8")
    with pytest.raises(InputError, match=message) as caught:
        read_traffic(path)
    assert "ships.toml" in str(caught.value)
