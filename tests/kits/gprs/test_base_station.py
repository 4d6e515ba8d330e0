"""Marks to a boat and reports from it, over the connection of a modem."""

import math

import pynmea2
import pytest
from hypothesis import given
from hypothesis import strategies as st

from seatrial.errors import InputError
from seatrial_kits.gprs.base_station import BaseStation
from seatrial_kits.gprs.sentences import Mark, Report, decode, encode
from tests.devices.running import started

from .dialogue import Dialogue, lines

TWO = {
    "count": 2,
    "waypoint_1": [10.04, -20.0, 0],
    "waypoint_2": [300, 7, 0],
    "sides": "port any",
    "radius": 8.0,
}
numbers = st.integers(-999_999_999, 999_999_999)


@given(
    st.builds(Report, *[numbers] * 7)
    | st.builds(Mark, *[numbers] * 5, st.sampled_from("psn"), numbers)
)
def test_sentences_come_back_and_their_checksum_is_that_of_another_library(sentence):
    line = encode(sentence).decode()
    assert decode(line.strip()) == sentence
    body, _, check = line.strip()[1:].partition("*")
    assert int(check, 16) == pynmea2.NMEASentence.checksum(body)


@pytest.mark.parametrize("line", ["", "$", "$PGLT*00", "$PGLT,1,2,3*11", "$PGLM,1,1,1,x,0,p,1*22"])
def test_what_is_no_sentence(line):
    assert decode(line) is None


def test_a_boat_gets_all_marks_and_those_that_it_lacks_again():
    shore = Dialogue(base={**TWO, "resend": 5.0})
    said = lines(shore.connect())
    marks = [decode(line) for line in said if "PGLM" in line]
    assert marks == [Mark(1, 1, 2, 100, -200, "p", 80), Mark(1, 2, 2, 3000, 70, "n", 80)]
    report(shore, Report(1, 0b01, 0, 123, -45, 2705, 150))
    assert shore.base.get("held") == 1
    again = [decode(line) for line in lines(shore.run(4)) if "PGLM" in line]
    assert again == [marks[1]]
    report(shore, Report(1, 0b11, 1, 123, -45, 2705, 150))
    assert b"PGLM" not in shore.run(12)
    base = shore.base
    assert base.get("position") == [12.3, -4.5]
    assert base.get("heading") == pytest.approx(math.radians(270.5))
    assert (base.get("speed"), base.get("passed"), base.get("held")) == (1.5, 1, 2)
    assert (base.get("reports"), base.get("bad")) == (2, 0)
    assert 12.0 < base.get("age") < 16.0


def report(shore, what):
    data = encode(what)
    shore.say(f"AT+CIPSEND={len(data)}")
    assert "SEND OK" in lines(shore.send(data, 2))


def test_a_new_list_takes_the_place_of_the_old():
    shore = Dialogue(base=TWO)
    shore.connect()
    report(shore, Report(1, 0b11, 0, 0, 0, 0, 0))
    shore.base.set("first", 2)
    marks = [decode(line) for line in lines(shore.run(2)) if "PGLM" in line]
    assert marks == [Mark(2, 1, 1, 3000, 70, "n", 80)]
    assert shore.base.get("held") == 0


def test_an_old_report_says_nothing_of_a_new_list():
    shore = Dialogue(base=TWO)
    shore.connect()
    shore.base.set("first", 2)
    report(shore, Report(1, 0b11, 0, 0, 0, 0, 0))
    assert shore.base.get("held") == 0


def test_only_its_own_name_and_port():
    shore = Dialogue(base={"host": "shore", "port": 5000})
    assert "CONNECT FAIL" in lines(shore.connect(host="elsewhere"))
    assert not shore.base.get("connected")


@pytest.mark.parametrize(
    ("settings", "named"), [({"sides": "left"}, "left"), ({"sides": "port port"}, "2 words")]
)
def test_sides_that_cannot_be(settings, named):
    with pytest.raises(InputError, match=named):
        started(BaseStation, **settings)
