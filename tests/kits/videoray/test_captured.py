"""VideoRay's captured packets: parsed, written again, and answered."""

import pytest

from seatrial_kits.videoray import registers as csr
from seatrial_kits.videoray.command_decode import describe
from seatrial_kits.videoray.frame import VRCSR, encode
from seatrial_kits.videoray.identity import read_config
from seatrial_kits.videoray.replies import read, read_memory
from seatrial_kits.videoray.rov import Pro4Rov
from seatrial_kits.videoray.vrcsr import Health, ThrusterNode, propulsion_request, read_health

from .bench import PACKETS, Line, frames, make_node

PAIRS = list(zip(PACKETS[::2], PACKETS[1::2], strict=True))
M5_COMMAND = bytes.fromhex("f55f8102f00a807cd6ecaa010000003f0000803e9a4c1893")


def memory_of(dump):
    (frame,) = frames(dump)
    return bytearray(frame.payload[1:])


def memory_behind(number):
    """Return the memory that a captured reply shows, as far as it does."""
    if number < 3:
        return memory_of(PACKETS[5])
    memory = memory_of(PACKETS[5] if number < 4 else PACKETS[9])
    if number == 3:  # reply 5: its own content
        (frame,) = frames(PACKETS[7])
        for name, value in read(5, frame.payload[1:]).values.items():
            csr.put(memory, name, csr.BY_NAME[name].clipped(value))
    return memory


@pytest.mark.parametrize("data", PACKETS, ids=lambda data: data[:6].hex())
def test_every_packet_is_one_frame_and_the_same_bytes_again(data):
    (frame,) = frames(data)
    assert encode(frame) == data
    assert describe(frame)


@pytest.mark.parametrize("number", range(5))
def test_a_vehicle_in_that_state_answers_byte_for_byte(number):
    asked, answered = PAIRS[number]
    memory = memory_behind(number)
    if number == 0:  # the heading was another then
        csr.put(memory, "heading", 494)
    node = make_node(memory)
    assert encode(node.handle(frames(asked)[0])) == answered


def test_what_the_primary_request_says():
    (frame,) = frames(PACKETS[6])
    values = read_memory(0, frame.payload).values
    assert values["vertical_target"] == pytest.approx(0.99)
    assert values["port_target"] == values["lights"] == 0.0
    assert values["auto_depth_target"] == values["auto_heading_target"] == csr.OFF


def test_what_the_reply_says():
    (frame,) = frames(PACKETS[7])
    values = read(5, frame.payload[1:]).values
    expected = {
        "heading": 49.3,
        "pitch": 3.7,
        "roll": -3.0,
        "pressure": 0.0,
        "surge_acceleration": 0.615,
        "sway_acceleration": 0.510,
        "heave_acceleration": -9.035,
        "humidity": 0.48,
        "water_temperature": 11.1,
        "total_power": 1.0,
    }
    assert {name: values[name] for name in expected} == pytest.approx(expected)


def test_negative_headings_are_understood():
    assert read_memory(0, frames(PACKETS[9])[0].payload[1:]).values["heading"] == pytest.approx(
        -13.2
    )


def test_configuration():
    serial, boards = read_config(frames(PACKETS[3])[0].payload[1:])
    assert serial == "J14461"
    assert boards["horizontal_thruster"] == "ThrustBL01"
    assert boards["cpu"] == "Pro4CPU20"


def test_the_component_answers_as_captured_where_no_measurement_matters():
    line = Line(Pro4Rov)
    line.send(PACKETS[2])
    assert [data for _, data in line.step(5)] == [PACKETS[3]]


def test_propulsion_command_of_the_m5():
    assert encode(propulsion_request([0.5, 0.25], 1), VRCSR) == M5_COMMAND
    (frame,) = frames(M5_COMMAND, VRCSR)
    node = ThrusterNode(1, 1)
    node.report(Health(1500.0, 47.5, 2.5, 20.0, 0), 0.0)
    answer = node.handle(frame)
    assert node.power == 0.25
    assert read_health(answer) == Health(1500.0, 47.5, 2.5, 20.0, 0)
    assert (answer.id, answer.flags, answer.address, len(answer.payload)) == (1, 2, 0, 18)
    assert ThrusterNode(2, 0).handle(frame) is None
