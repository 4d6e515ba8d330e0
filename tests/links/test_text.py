import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from seatrial.errors import InputError, SimulationError
from seatrial.links.text import Inbox, Outbox, decode, encode
from seatrial.model.component import Component, Input, Output

numbers = st.integers(0, 2**63)
chunks = st.lists(st.tuples(numbers, st.binary(max_size=40)), max_size=8)


@given(numbers, chunks)
def test_round_trip(sequence, items):
    text = encode(sequence, items)
    assert decode(text) == (sequence, items)
    assert text.isascii()
    assert text.isprintable()  # no NUL, nothing a C string or a log line would trip over


def test_written_form():
    assert encode(3, [(1_500_000_000, b"$HEHDT,"), (1_600_000_000, b"")]) == (
        "3;1500000000:JEhFSERULA==;1600000000:"
    )


def test_empty_text_is_a_port_that_never_sent():
    assert decode("") == (0, [])


@pytest.mark.parametrize(
    "text",
    [
        "x",
        "-1",
        "1.0",
        "1;",
        "1;2",
        "1;:QQ==",
        "1;-2:QQ==",
        "1;2:QQ==;",
        " 1",
        "1\n",
        "1;2:Q",
        "1;2:QQ=",
        "1;2:QQ==QQ==",
        "1;2:====",
        "1;2:Q Q=",
        "1;2:Q\0==",
        "01",
        "1;02:",
        "1;2:QQ==;3",
        "1;2;3:QQ==",
        "\x00",
        "1;2:ÄÖ==",
    ],
)
def test_malformed_text_is_refused(text):
    with pytest.raises(InputError, match=r"is not a bytes text|is not base64"):
        decode(text)


@given(st.text(max_size=30))
def test_any_text_is_decoded_or_refused(text):
    try:
        sequence, items = decode(text)
    except InputError:
        return
    assert decode(encode(sequence, items)) == (sequence, items)


def test_long_malformed_text_is_shown_in_part():
    with pytest.raises(InputError) as caught:
        decode("?" * 10_000)
    assert len(str(caught.value)) < 300


@pytest.mark.parametrize(("sequence", "items"), [(-1, []), (1, [(-5, b"")])])
def test_negative_numbers_are_refused(sequence, items):
    with pytest.raises(InputError, match="cannot be negative"):
        encode(sequence, items)


# ------------------------------------------------------------------ boxes


def test_reader_gets_each_chunk_once():
    out, into = Outbox({}), Inbox({})
    assert into.take(out.text) == []
    out.put(10, b"a")
    out.put(20, b"b")
    assert out.text == ""  # not before the step ends
    text = out.flush()
    assert into.take(text) == [(10, b"a"), (20, b"b")]
    assert into.take(text) == []
    assert out.flush() == text  # the port keeps what it holds
    assert into.take(out.text) == []
    out.put(30, b"b")
    assert into.take(out.flush()) == [(30, b"b")]


def test_the_same_bytes_twice_are_two_messages():
    out, into = Outbox({}), Inbox({})
    for _ in range(2):
        out.put(10, b"same")
        assert into.take(out.flush()) == [(10, b"same")]


def test_missed_text_is_an_error():
    out, into = Outbox({}), Inbox({})
    for time in (1, 2):
        out.put(time, b"x")
        out.flush()
    with pytest.raises(SimulationError, match="number 2 came after number 0"):
        into.take(out.text)


def test_text_from_the_past_is_an_error():
    into = Inbox({"sequence": 5})
    with pytest.raises(SimulationError, match="number 4 came after number 5"):
        into.take(encode(4, []))


@given(st.lists(chunks, max_size=10))
def test_everything_put_arrives_in_order(steps):
    out, into = Outbox({}), Inbox({})
    arrived = []
    for step in steps:
        for time, data in step:
            out.put(time, data)
        arrived += into.take(out.flush())
        arrived += into.take(out.text)
    assert arrived == [item for step in steps for item in step]


class Echo(Component):
    """Sends back what it receives."""

    rx = Input("1", "received", type=str)
    tx = Output("1", "sent", type=str)

    def start(self, t):
        self._in, self._out = {}, {}

    def step(self, t, h):
        for time, data in Inbox(self._in).take(self.rx):
            Outbox(self._out).put(time, data.upper())
        Outbox(self._out).flush()

    def outputs(self, t):
        self.tx = Outbox(self._out).text


def test_boxes_keep_their_memory_in_the_components_state():
    echo = Echo()
    echo.initialise()
    echo.begin()
    echo.set("rx", encode(1, [(0, b"one")]))
    echo.advance(0.0, 0.1)
    state = json.loads(json.dumps(echo.get_state()))  # plain data
    echo.set("rx", encode(2, [(5, b"two")]))
    echo.advance(0.1, 0.1)
    first = echo.get("tx")
    assert decode(first) == (2, [(5, b"TWO")])
    echo.set_state(state)
    echo.set("rx", encode(2, [(5, b"two")]))
    echo.advance(0.1, 0.1)
    assert echo.get("tx") == first
