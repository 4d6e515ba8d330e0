"""Received sentences: those that pynmea2 wrote, sentences as plotters send them, and noise."""

import random

import pynmea2
import pytest

from .bench import DEG, VALID, Bench

HOME = {"latitude": -22.862 * DEG, "longitude": -43.223 * DEG, "variation": -23.0 * DEG}


def sent(name, *fields):
    return (
        f"{pynmea2.NMEASentence.parse(f'$II{name},' + ','.join(fields), check=False)}\r\n".encode()
    )


def apb(heading="45.0", reference="T", error="0.10", side="L", gps="A"):
    return sent(
        "APB",
        gps,
        "A",
        error,
        side,
        "N",
        "V",
        "V",
        "40.0",
        "T",
        "MARK",
        "41.0",
        "T",
        heading,
        reference,
    )


def rmb(status="A", arrived="V"):
    return sent(
        "RMB",
        status,
        "0.05",
        "R",
        "START",
        "MARK",
        "2251.000",
        "S",
        "04313.000",
        "W",
        "1.3",
        "40.0",
        "2.0",
        arrived,
    )


def received(*sentences, **values):
    bench = Bench(**{**HOME, "sentences": "", **values})
    bench.receive(*sentences)
    bench.run(0.2)
    return bench


def test_a_heading_is_commanded():
    bench = received(sent("HSC", "123.5", "T", "", "M"))
    assert bench.one.get("target_valid")
    assert bench.one.get("target_kind") == "heading"
    assert bench.one.get("target_heading") == pytest.approx(123.5 * DEG)
    magnetic = received(sent("HSC", "", "T", "10.0", "M"))
    assert magnetic.one.get("target_heading") == pytest.approx(347.0 * DEG)
    report = received(sent("HSC", "123.5", "T", "", "M", "R"))
    assert (report.one.get("lines_refused"), report.one.get("sentences_received")) == (0, 1)
    assert not report.one.get("target_valid")


def test_an_autopilot_is_steered():
    bench = received(apb())
    assert bench.one.get("target_heading") == pytest.approx(45.0 * DEG)
    assert bench.one.get("cross_track") == pytest.approx(185.2)  # to starboard: it is to go left
    assert bench.one.get("waypoint") == "MARK"
    assert received(apb(side="R")).one.get("cross_track") == pytest.approx(-185.2)
    assert received(apb("45.0", "M")).one.get("target_heading") == pytest.approx(22.0 * DEG)
    assert not received(apb(gps="V")).one.get("target_valid")
    both = received(sent("HSC", "123.5", "T", "", "M"), apb())
    assert both.one.get("target_heading") == pytest.approx(123.5 * DEG)
    assert both.one.get("cross_track") == pytest.approx(185.2)


def test_a_waypoint_is_named():
    bench = received(rmb())
    assert bench.one.get("target_kind") == "position"
    north, east, down = bench.one.get("target_position")
    assert north == pytest.approx(0.012 * 60.0 * 1852.0, rel=5e-3)
    assert east == pytest.approx(0.38 / 60 * 60.0 * 1852.0 * 0.9215, rel=5e-3)
    assert down == 0.0
    assert bench.one.get("cross_track") == pytest.approx(-92.6)
    assert not bench.one.get("arrived")
    assert received(rmb(arrived="A")).one.get("arrived")
    assert not received(rmb(status="V")).one.get("target_valid")
    assert received(rmb(), apb()).one.get("target_kind") == "heading"


def test_orders_apply_for_their_time():
    bench = received(apb(), order_timeout=2.0)
    bench.run(1.7)
    assert bench.one.get("target_valid")
    bench.run(0.3)
    assert not bench.one.get("target_valid")
    assert not bench.one.get("cross_track_valid")
    bench.receive(apb())
    bench.run(0.1)
    assert bench.one.get("target_valid")


def test_sentences_of_plotters():
    """As the manuals and logs of others have them; other sentences and AIS are no mistakes."""
    bench = received(
        b"$GPAPB,A,A,0.10,R,N,V,V,011,M,DEST,011,M,011,M*3C\r\n",
        b"$GPRMB,A,0.66,L,003,004,4917.24,N,12309.57,W,001.3,052.5,000.5,V*20\r\n",
        b"$GPGGA,123519,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,*47\r\n",
        b"!AIVDM,1,1,,B,177KQJ5000G?tO`K>RA1wUbN0TKH,0*5C\r\n",
        b"$PMGNST,02.12,3,T,534,05.0,+03327,00*40\r\n",
    )
    assert bench.one.get("lines_refused") == 0
    assert bench.one.get("sentences_received") == 4
    assert bench.one.get("waypoint") == "004"
    assert bench.one.get("target_heading") == pytest.approx(348.0 * DEG)


def test_pieces_and_wrong_lines():
    whole = apb()
    bench = received(whole[:10], whole[10:40])
    assert bench.one.get("sentences_received") == 0
    bench.receive(whole[40:])
    bench.run(0.1)
    assert bench.one.get("target_valid")
    wrong = (
        whole.replace(b"45.0", b"46.0"),  # another checksum
        whole.partition(b"*")[0] + b"\r\n",  # none
        b"\xff\x00\x80\r\n",
        b"$\r\n",
        b"$II\r\n",
        sent("HSC", "nan", "T", "", "M"),
        sent("HSC", "x", "T", "", "M"),
        sent("RMB", "A", "0.05", "R", "A", "M\0"),  # a right checksum
    )
    bench = received(*wrong)
    assert bench.one.get("lines_refused") == len(wrong)
    assert not bench.one.get("target_valid")
    garbled = received(b"$GPGGA,1235" + whole)  # a line that was cut by another
    assert garbled.one.get("target_valid")


def test_noise_is_survived():
    """Any bytes, and sentences with any fields and a right checksum."""
    draw = random.Random(1)
    bench = Bench(**{**HOME, "sentences": ""})
    texts = ["", "A", "V", "1", "-1", "1e308", "1e400", "9" * 30, "inf", "T", "M", "N", "99999.9"]
    for _ in range(300):
        fields = ",".join(draw.choice(texts) for _ in range(draw.randrange(18)))
        body = f"II{draw.choice(('APB', 'RMB', 'HSC', 'XYZ', 'RMC', 'XDR'))},{fields}".encode()
        xor = 0
        for octet in body:
            xor ^= octet
        bench.receive(b"$" + body + f"*{xor:02X}\r\n".encode(), draw.randbytes(60))
        bench.run(0.05)
    bench.receive(b"\n", apb())
    bench.set(**VALID)
    bench.run(0.05)
    bench.run(0.05)
    assert bench.one.get("target_valid")
    assert bench.one.get("lines_refused") > 20
