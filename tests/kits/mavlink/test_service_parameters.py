"""The parameter protocol, with pymavlink's messages and a client that reads what it misses."""

from __future__ import annotations

import random
import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pymavlink.dialects.v20 import all as mavlink

from seatrial_kits.mavlink.modes import dialect
from seatrial_kits.mavlink.parameters.definition import (
    INT8,
    INT16,
    INT32,
    REAL32,
    Definition,
)
from seatrial_kits.mavlink.parameters.table import ParameterTable
from seatrial_kits.mavlink.services.parameters import RATE, ParameterService
from seatrial_kits.mavlink.settings import Settings
from seatrial_kits.mavlink.vehicle import Identity, Vehicle

from .bench import ORIGIN, OTHER_STATION, STATION, Bench, RecordingTransport

BOAT = Identity(7, 1, mavlink.MAV_TYPE_SURFACE_BOAT, False, "4.5.1", 1, 0)
COUNT = 120
DEFINITIONS = [
    Definition("SMALL", INT8, 5, -128, 127),
    Definition("SHORT", INT16, -300, -32768, 32767),
    Definition("LONG", INT32, 16777216, -4000000, 2**31 - 1),
    Definition("REAL", REAL32, 2.5, -1e6, 1e6),
    Definition("STAYS", INT8, 1, fixed="it belongs to the trial"),
    *(Definition(f"P{n}", REAL32, n / 8) for n in range(COUNT - 5)),
]


class ParameterBench:
    """The service alone; time passes in steps of 10 ms."""

    def __init__(self, autopilot: str = "ardupilotmega") -> None:
        kind = dialect(autopilot, submerged=False)
        self.vehicle = Vehicle(BOAT, kind, ORIGIN, kind.mode("hold"))
        self.transport = RecordingTransport()
        self.table = ParameterTable(DEFINITIONS, Settings())
        self.service = ParameterService(self.vehicle, self.transport, self.table)
        self.ticks = 0

    def receive(self, message, sender=STATION) -> None:
        self.service.receivers[message.get_msgId()](message, sender, self.ticks / 100)

    def wait(self, seconds: float) -> None:
        for _ in range(round(seconds * 100)):
            self.ticks += 1
            self.service.tick(self.ticks / 100)

    def request_list(self, sender=STATION) -> None:
        self.receive(mavlink.MAVLink_param_request_list_message(7, 1), sender)

    def read(self, name: str = "", index: int = -1, sender=STATION) -> list:
        self.receive(mavlink.MAVLink_param_request_read_message(7, 1, name.encode(), index), sender)
        return self.transport.take(link=sender.link)

    def set(self, name: str, value: float, kind: int = REAL32, sender=STATION) -> None:
        self.receive(mavlink.MAVLink_param_set_message(7, 1, name.encode(), value, kind), sender)


@pytest.fixture
def bench() -> ParameterBench:
    return ParameterBench()


def identity(message) -> tuple:
    return message.param_id, message.param_index, message.param_count, message.param_type


def test_a_list_is_complete_in_order_and_paced(bench: ParameterBench) -> None:
    bench.request_list()
    bench.wait(0.5)
    first = bench.transport.take("PARAM_VALUE", link=0)
    assert len(first) == pytest.approx(0.5 * RATE, abs=1)
    bench.wait(1.0)
    got = [*first, *bench.transport.take("PARAM_VALUE", link=0)]
    kinds = {d.name: d.kind for d in DEFINITIONS}
    assert [identity(m) for m in got] == [
        (d.name, i, COUNT, kinds[d.name]) for i, d in enumerate(DEFINITIONS)
    ]
    assert [m.param_value for m in got[5:]] == [n / 8 for n in range(COUNT - 5)]
    bench.wait(1.0)
    assert bench.transport.take() == []


def test_stations_on_two_links_get_a_list_each(bench: ParameterBench) -> None:
    bench.request_list()
    bench.wait(0.3)
    bench.request_list(OTHER_STATION)
    bench.wait(1.5)
    for link in (0, 1):
        got = bench.transport.take("PARAM_VALUE", link=link)
        assert [m.param_index for m in got] == list(range(COUNT))


def test_repeated_requests_get_the_list_all_the_same(bench: ParameterBench) -> None:
    """A list takes 1.2 s; a station that requests it each second would never see its end."""
    for _ in range(3):
        bench.request_list()
        bench.wait(1.0)
    indices = [m.param_index for m in bench.transport.take("PARAM_VALUE", link=0)]
    assert indices == [i % COUNT for i in range(len(indices))]
    assert len(indices) == pytest.approx(3.0 * RATE, abs=3)
    bench.wait(2.0)
    last = [m.param_index for m in bench.transport.take("PARAM_VALUE", link=0)]
    assert set(indices[200:] + last) == set(range(COUNT))  # since the last request, after 2 s


def test_a_slow_vehicle_sends_as_many_a_second(bench: ParameterBench) -> None:
    bench.request_list()
    for tick in range(1, 6):
        bench.service.tick(0.2 * tick)
    assert len(bench.transport.take("PARAM_VALUE")) == 101  # of 1 s, both ends counted


def test_a_list_for_a_link_that_is_gone_ends(bench: ParameterBench) -> None:
    bench.request_list()
    bench.wait(0.2)
    bench.transport.there = [1]
    bench.transport.take()
    bench.wait(0.5)
    bench.transport.there = [0, 1]
    bench.wait(0.5)
    assert bench.transport.take() == []


def test_reads_by_index_and_by_name_agree(bench: ParameterBench) -> None:
    for index, definition in enumerate(DEFINITIONS):
        (by_index,), (by_name,) = bench.read(index=index), bench.read(definition.name)
        assert identity(by_index) == identity(by_name) == (
            definition.name, index, COUNT, definition.kind,
        )  # fmt: skip
        assert by_index.param_value == by_name.param_value == definition.default


@pytest.mark.parametrize(
    ("name", "index"), [("NONE", -1), ("", -1), ("REAL", COUNT), ("REAL", -2), ("X" * 16, -1)]
)
def test_what_there_is_not_is_an_error_message(
    bench: ParameterBench, name: str, index: int
) -> None:
    (answer,) = bench.read(name, index)
    assert answer.get_type() == "PARAM_ERROR"
    assert (answer.target_system, answer.target_component) == (STATION.system, STATION.component)
    assert answer.error == mavlink.MAV_PARAM_ERROR_DOES_NOT_EXIST
    assert (answer.param_id, answer.param_index) == (name if index == -1 else "", index)
    bench.set("NONE", 1.0)
    assert [m.get_type() for m in bench.transport.take()] == ["PARAM_ERROR"]


def test_what_is_set_is_sent_to_all(bench: ParameterBench) -> None:
    sent = struct.unpack("<f", struct.pack("<f", 0.1))[0]
    bench.set("REAL", sent)
    ((link, answer),) = bench.transport.sent
    assert (link, answer.get_type(), answer.param_value) == (None, "PARAM_VALUE", 0.1)
    assert bench.table["REAL"] == 0.1
    assert identity(answer) == ("REAL", 3, COUNT, REAL32)


@pytest.mark.parametrize(
    ("name", "value", "error", "expected"),
    [
        (
            "REAL",
            2e6,
            mavlink.MAV_PARAM_ERROR_VALUE_OUT_OF_RANGE,
            "REAL stays 2.5: -1e+06 to 1e+06",
        ),
        ("SMALL", 128.0, mavlink.MAV_PARAM_ERROR_VALUE_OUT_OF_RANGE, "SMALL stays 5"),
        ("REAL", float("nan"), mavlink.MAV_PARAM_ERROR_VALUE_OUT_OF_RANGE, "REAL stays 2.5"),
        ("STAYS", 2.0, mavlink.MAV_PARAM_ERROR_READ_ONLY, "STAYS stays 1: it belongs to the trial"),
    ],
)
def test_what_is_refused_is_sent_to_the_sender_alone(
    bench: ParameterBench, name, value, error, expected
) -> None:
    before = bench.table[name]
    bench.set(name, value, sender=OTHER_STATION)
    refusal, value_sent = bench.transport.take(link=OTHER_STATION.link)
    assert bench.transport.sent == []
    assert (value_sent.get_type(), value_sent.param_value) == ("PARAM_VALUE", before)
    assert (refusal.get_type(), refusal.param_id, refusal.error) == ("PARAM_ERROR", name, error)
    (text,) = bench.vehicle.texts
    assert text.text.startswith(expected)


# ------------------------------------------------------------------ integers


def test_ardupilot_sends_integers_as_numbers(bench: ParameterBench) -> None:
    assert [bench.read(name)[0].param_value for name in ("SMALL", "SHORT", "LONG")] == [
        5.0, -300.0, 16777216.0,
    ]  # fmt: skip
    bench.set("SHORT", 41.6, INT16)
    assert bench.table["SHORT"] == 42.0
    assert bench.vehicle.capabilities & mavlink.MAV_PROTOCOL_CAPABILITY_PARAM_ENCODE_C_CAST


@given(st.data())
def test_px4_sends_the_bytes_of_integers(data) -> None:
    bench = ParameterBench("px4")
    limits = {"SMALL": (INT8, "<b", 127), "SHORT": (INT16, "<h", 32767), "LONG": (INT32, "<i", 2**31 - 1)}  # fmt: skip
    name = data.draw(st.sampled_from(sorted(limits)))
    kind, layout, high = limits[name]
    low = -4000000 if name == "LONG" else -high - 1
    number = data.draw(st.integers(low, high))
    union = struct.pack(layout, number).ljust(4, b"\0")
    bench.set(name, struct.unpack("<f", union)[0], kind)
    assert bench.table[name] == number
    (answer,) = bench.transport.take("PARAM_VALUE")
    frame = answer.pack(mavlink.MAVLink(None, 7, 1))
    payload = frame[10:-2].ljust(25, b"\0")  # MAVLink 2 cuts zeros off
    assert payload[:4] == union


def test_px4_refuses_another_type(bench: ParameterBench) -> None:
    px4 = ParameterBench("px4")
    px4.set("SMALL", 6.0, REAL32)
    assert px4.table["SMALL"] == 5.0
    assert px4.transport.take("PARAM_ERROR")
    assert px4.vehicle.capabilities & mavlink.MAV_PROTOCOL_CAPABILITY_PARAM_ENCODE_BYTEWISE
    bench.set("SMALL", 6.0, REAL32)
    assert bench.table["SMALL"] == 6.0


# ------------------------------------------------------------------ bad links


class Client:
    """Requests the list, then each half second for what it has not got, as ground stations do."""

    def __init__(self) -> None:
        self.values: dict[int, tuple[str, float]] = {}
        self.count: int | None = None

    def take(self, message) -> None:
        if message.get_type() == "PARAM_VALUE":
            self.count = message.param_count
            entry = (message.param_id, message.param_value)
            assert self.values.setdefault(message.param_index, entry) == entry

    @property
    def complete(self) -> bool:
        return self.count is not None and len(self.values) == self.count

    def requests(self) -> list:
        if self.count is None:
            return [mavlink.MAVLink_param_request_list_message(7, 1)]
        gaps = [i for i in range(self.count) if i not in self.values]
        return [mavlink.MAVLink_param_request_read_message(7, 1, b"", i) for i in gaps[:10]]


@pytest.mark.parametrize("seed", range(20))
def test_a_bad_link_loses_nothing_for_good(seed: int) -> None:
    """10 % of the messages are lost each way, some come twice, all up to 0.1 s late."""
    bench, client, rng = ParameterBench(), Client(), random.Random(seed)
    on_the_way: list[tuple[int, int, bool, object]] = []
    sent = 0

    def through(messages, down: bool) -> None:
        nonlocal sent
        for message in messages:
            for _ in range(rng.choices((0, 1, 2), (10, 80, 10))[0]):
                sent += 1
                on_the_way.append((bench.ticks + rng.randint(0, 10), sent, down, message))

    while not client.complete:
        if bench.ticks % 50 == 0:
            through(client.requests(), down=False)
        bench.wait(0.01)
        through(bench.transport.take(link=0), down=True)
        arrived = sorted(each for each in on_the_way if each[0] <= bench.ticks)
        on_the_way[:] = [each for each in on_the_way if each[0] > bench.ticks]
        for _, _, down, message in arrived:
            client.take(message) if down else bench.receive(message)
        assert bench.ticks < 2000, "no list after 20 s"
    assert [client.values[i] for i in range(COUNT)] == [(d.name, d.default) for d in DEFINITIONS]


@given(
    st.sampled_from(("PARAM_SET", "PARAM_REQUEST_READ", "PARAM_REQUEST_LIST")),
    st.binary(min_size=16, max_size=16),
    st.floats(width=32),
    st.integers(0, 255),
    st.integers(-32768, 32767),
)
def test_nothing_crashes_it(kind, name, value, number, index) -> None:
    bench = ParameterBench("px4" if number % 2 else "ardupilotmega")
    bench.receive(
        {
            "PARAM_SET": lambda: mavlink.MAVLink_param_set_message(7, 1, name, value, number),
            "PARAM_REQUEST_READ": lambda: mavlink.MAVLink_param_request_read_message(
                7, 1, name, index
            ),
            "PARAM_REQUEST_LIST": lambda: mavlink.MAVLink_param_request_list_message(7, 1),
        }[kind]()
    )
    bench.wait(0.02)
    for _, message in bench.transport.sent:
        assert message.get_type() in ("PARAM_VALUE", "PARAM_ERROR")


def crc32_of_px4(data, state=0):
    """CRC-32 bit by bit, reflected, without the inversions that are usual."""
    for byte in data:
        state ^= byte
        for _ in range(8):
            state = state >> 1 ^ 0xEDB88320 * (state & 1)
    return state


def test_a_px4_gives_its_hash_first_and_ends_the_list_of_who_has_it():
    bench = Bench(autopilot="px4")
    bench.transport.take()
    bench.receive(mavlink.MAVLink_param_request_list_message(7, 1))
    (first,) = bench.transport.take("PARAM_VALUE", STATION.link)
    assert (first.param_id, first.param_index) == ("_HASH_CHECK", 65535)
    table = bench.parameters
    layouts = {mavlink.MAV_PARAM_TYPE_INT32: "<i", mavlink.MAV_PARAM_TYPE_REAL32: "<f"}
    state = 0
    for name in sorted(table.names):
        value, layout = table[name], layouts[table.kind(name)]
        data = struct.pack(layout, int(value) if layout == "<i" else value)
        state = crc32_of_px4(name.encode() + data, state)
    assert struct.pack("<f", first.param_value) == struct.pack("<I", state)
    kind = mavlink.MAV_PARAM_TYPE_UINT32
    known = mavlink.MAVLink_param_set_message(7, 1, b"_HASH_CHECK", first.param_value, kind)
    bench.receive(known)
    bench.wait(1.0)
    assert bench.transport.take("PARAM_VALUE") == []
    assert table.put("NAV_ACC_RAD", 9.0) is None
    bench.receive(mavlink.MAVLink_param_request_list_message(7, 1))
    bench.receive(known)  # of other values
    bench.wait(1.0)
    assert len(bench.transport.take("PARAM_VALUE", STATION.link)) == len(table.names) + 1
