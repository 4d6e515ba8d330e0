"""Text logs of sentences: public examples, and the ways in which loggers put times before them."""

from functools import reduce
from operator import xor

import numpy as np
import pytest

from seatrial.errors import InputError
from seatrial.trial.logs.formats import read_log


def sentence(body):
    return f"${body}*{reduce(xor, body.encode()):02X}"


def rmc(clock, date="010524", status="A", talker="GP"):
    return sentence(f"{talker}RMC,{clock},{status},4807.038,N,01131.000,E,022.4,084.4,{date},,")


@pytest.fixture
def read(write):
    return lambda *lines: read_log(write("boat.nmea", "\r\n".join(lines) + "\r\n"))


def test_sentences_of_the_textbook(read):
    """The examples of "NMEA Revealed", and what its tables say that they mean."""
    found = read(
        "$GPRMC,123519,A,4807.038,N,01131.000,E,022.4,084.4,230394,003.1,W*6A",
        "$GPGGA,123519,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,*47",
        sentence("HCHDG,101.1,2.0,E,7.1,W"),
        sentence("TIROT,-3.4,A"),
        sentence("AGRSA,-5.2,A,,V"),
        sentence("YXXDR,A,-0.8,D,PTCH,A,12.1,D,ROLL"),
        sentence("SDDPT,2.4,0.5,"),
        sentence("GPVTG,054.7,T,034.4,M,005.5,N,010.2,K"),
    )
    values = {name: (each.values[0], each.unit) for name, each in found.channels.items()}
    assert values["GGA.lat"] == (pytest.approx(48.0 + 7.038 / 60.0), "deg")
    assert values["RMC.spd"] == (22.4, "knot")
    assert values["HDG.true"] == (pytest.approx(101.1 + 2.0 - 7.1), "deg")
    assert values["ROT.rot"] == (-3.4, "deg/min")
    assert values["RSA.stbdangle"] == (-5.2, "deg")
    assert values["XDR.PTCH"] == (-0.8, "deg")
    assert values["XDR.ROLL"] == (12.1, "deg")
    assert values["DPT.depth"] == (2.4, "m")
    assert values["VTG.cogt"] == (54.7, "deg")
    assert found.start.isoformat() == "1994-03-23T12:35:19+00:00"


def test_midnight_is_passed(read):
    found = read(rmc("235958.50", "310524"), rmc("235959.50", "310524"), rmc("000000.50", "010624"))
    assert found.channels["RMC.lat"].time.tolist() == [0.0, 1.0, 2.0]
    assert found.start.isoformat() == "2024-05-31T23:59:58.500000+00:00"


def test_sentences_without_a_time_are_spread_over_the_interval(read):
    heading = [sentence(f"HEHDT,{k}.0,T") for k in range(8)]
    found = read(
        heading[7],
        rmc("120000"),
        *heading[:4],
        rmc("120001"),
        *heading[4:5],
        rmc("120002"),
        *heading[5:7],
    )
    assert found.channels["HDT.headingT"].time.tolist() == [0.0, 0.25, 0.5, 0.75, 1.0, 2.0, 2.5]
    assert found.channels["HDT.headingT"].values.tolist() == [0, 1, 2, 3, 4, 5, 6]
    assert found.notes == ("1 sentences before the first time are left out",)


@pytest.mark.parametrize(
    "prefixes",
    [
        ("1714564770.25 ", "1714564771.50 "),
        ("1714564770250,", "1714564771500,"),
        ("2024-05-01T11:59:30.250Z ", "2024-05-01T11:59:31.500Z "),
        ("[2024-05-01 11:59:30.250] ", "[2024-05-01 11:59:31.500] "),
        ("11:59:30.250;", "11:59:31.500;"),
        ("\\s:boat,c:1714564770250*00\\", "\\c:1714564771500,s:boat*00\\"),
    ],
)
def test_times_before_the_sentences(read, prefixes):
    found = read(*(prefix + sentence(f"HEHDT,{k}.0,T") for k, prefix in enumerate(prefixes)))
    np.testing.assert_allclose(found.channels["HDT.headingT"].time, [0.0, 1.25], atol=1e-6)
    if "11:59:30.250;" not in prefixes:
        assert found.start.isoformat() == "2024-05-01T11:59:30.250000+00:00"


def test_what_is_invalid_is_left_out_with_a_count(read):
    found = read(
        rmc("120000"),
        rmc("120001", status="V"),
        sentence("GPGGA,120001,4807.038,N,01131.000,E,0,08,0.9,545.4,M,46.9,M,,"),
        rmc("120002").replace("12000", "12999"),
        "half a line $GPRM",
        sentence("GPGSV,1,1,00"),
    )
    assert found.notes == (
        "2 lines without a sentence of good checksum are skipped",
        "1 sentences RMC are marked invalid and left out",
        "1 sentences GGA are marked invalid and left out",
        "sentences that are not read: GSV (1)",
    )
    assert found.channels["RMC.lat"].rows.tolist() == [1]


def test_two_receivers_are_distinguished(read):
    found = read(rmc("120000"), rmc("120000", talker="GN"), rmc("120001"))
    assert len(found.channels["RMC.lat"].values) == 2
    assert len(found.channels["GN/RMC.lat"].values) == 1


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        ([sentence("HEHDT,1.0,T")], "no sentence has a time .*, and none stands before each"),
        ([sentence("GPGSV,1,1,00")], r"no sentence with a good checksum .* read: GSV \(1\)$"),
    ],
)
def test_logs_that_tell_nothing(write, lines, message):
    with pytest.raises(InputError, match=message):
        read_log(write("boat.nmea", "\n".join(lines)), "nmea0183")


def test_times_before_the_lines_of_a_text_of_windows(read):
    """A byte order mark before the first time does not take the times from all lines."""
    found = read(*(f"{mark}{t} {sentence('HEHDT,100.0,T')}" for mark, t in
                   (("\ufeff", 1714564800.25), ("", 1714564800.5), ("", 1714564801.0))))  # fmt: skip
    np.testing.assert_allclose(found.channels["HDT.headingT"].time, [0.0, 0.25, 0.75])
