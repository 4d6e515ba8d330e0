"""Packets byte by byte: offsets of VideoRay's documents, written out here a second time.

Source: videoray/VRCommsProtocol_doc, "PRO4 application layer.docx" (replies, command block) and
PRO4_CSR_memory_map.xls, revision 3 (addresses). Neither builder nor reader of the package is
trusted: each is compared with ``struct`` at these offsets.
"""

import struct

import pytest

from seatrial_kits.videoray import registers as csr
from seatrial_kits.videoray.frame import VRCSR, Frame, encode
from seatrial_kits.videoray.replies import payload, read, read_memory
from seatrial_kits.videoray.rov import Pro4Rov
from seatrial_kits.videoray.station import Commands
from seatrial_kits.videoray.topside import Pro4Topside
from seatrial_kits.videoray.vrcsr import Health, ThrusterNode, propulsion_request, read_health

from .bench import PACKETS, Line, frames, request

# Of a reply, after the type of device: offset, register, address in the map, unit of a count.
HEAD = [
    (0, "heading", 0x68, 0.1),
    (2, "pitch", 0x6A, 0.1),
    (4, "roll", 0x6C, 0.1),
    (6, "pressure", 0x66, 1.0),
]
TEMPERATURE = (8, "water_temperature", 0x7A, 0.01)
REPLIES = {
    1: HEAD,
    2: HEAD,
    3: [*HEAD, TEMPERATURE],
    4: [*HEAD, TEMPERATURE, (10, "humidity", 0x84, 0.01)],
    5: [
        *HEAD,
        (8, "yaw_acceleration", 0x6E, 1.0),
        (10, "pitch_acceleration", 0x70, 1.0),
        (12, "roll_acceleration", 0x72, 1.0),
        (14, "surge_acceleration", 0x74, 1e-3),
        (16, "sway_acceleration", 0x76, 1e-3),
        (18, "heave_acceleration", 0x78, 1e-3),
        (20, "magnetometer_x", 0xC4, 1.0),
        (22, "magnetometer_y", 0xC6, 1.0),
        (24, "magnetometer_z", 0xC8, 1.0),
        (26, "attitude_status", 0xE3, 1.0),
        (28, "humidity", 0x84, 0.01),
        (30, "water_temperature", 0x7A, 0.01),
        (32, "total_power", 0x5F, 0.01),
    ],
}
LENGTHS = {1: 8, 2: 8, 3: 10, 4: 12, 5: 33}
COMMANDS = [
    (0x00, "<h", "port_target", 0.01),
    (0x02, "<h", "starboard_target", 0.01),
    (0x04, "<h", "vertical_target", 0.01),
    (0x06, "<B", "lights", 0.01),
    (0x07, "<b", "camera_tilt", 1.0),
    (0x08, "<b", "camera_focus", 0.01),
    (0x09, "<B", "camera_control", 1.0),
    (0x0A, "<B", "camera_buttons", 1.0),
    (0x0B, "<H", "auto_depth_target", 1.0),
    (0x0D, "<H", "auto_heading_target", 1.0),
]
MEMORY = [
    *((0x14, "<H", "port_dead_band", 1e-3), (0x18, "<H", "vertical_dead_band", 1e-3)),
    *((0x1A, "<H", "port_max_limit", 1e-3), (0x1E, "<H", "vertical_max_limit", 1e-3)),
    *((0x20, "<H", "port_slew_rate", 1e-4), (0x24, "<H", "vertical_slew_rate", 1e-4)),
    *((0x26, "<h", "auto_depth_p", 1e-4), (0x28, "<h", "auto_depth_i", 1e-4)),
    *((0x2A, "<h", "auto_depth_d", 1e-4), (0x2C, "<h", "auto_depth_k", 1e-4)),
    *((0x2E, "<h", "auto_heading_p", 1e-4), (0x30, "<h", "auto_heading_i", 1e-4)),
    *((0x32, "<h", "auto_heading_d", 1e-4), (0x34, "<h", "auto_heading_k", 1e-4)),
    *((0x46, "<H", "max_current", 0.01), (0x48, "<H", "min_voltage", 0.01)),
    *((0x58, "<B", "min_power", 0.01), (0x59, "<B", "max_power", 0.01)),
    *((0x13, "<B", "power_manager", 0.01), (0x5F, "<B", "total_power", 0.01)),
    *((0x60, "<B", "voltage_drop", 0.1), (0x64, "<B", "attitude_sensor", 1.0)),
    *((0x66, "<H", "pressure", 1.0), (0x68, "<h", "heading", 0.1)),
    *((0x6A, "<h", "pitch", 0.1), (0x6C, "<h", "roll", 0.1)),
    *((0x6E, "<h", "yaw_acceleration", 1.0), (0x70, "<h", "pitch_acceleration", 1.0)),
    *((0x72, "<h", "roll_acceleration", 1.0), (0x74, "<h", "surge_acceleration", 1e-3)),
    *((0x76, "<h", "sway_acceleration", 1e-3), (0x78, "<h", "heave_acceleration", 1e-3)),
    *((0x7A, "<h", "water_temperature", 0.01), (0x7C, "<H", "tether_voltage", 0.01)),
    *((0x7E, "<H", "bus_voltage", 0.01), (0x80, "<H", "bus_current", 1e-3)),
    *((0x84, "<H", "humidity", 0.01), (0x86, "<H", "communication_errors", 1.0)),
    *((0x8C, "<I", "run_time", 1.0), (0x90, "<H", "adc_0", 1.0), (0x9E, "<H", "adc_7", 1.0)),
    *((0xC4, "<h", "magnetometer_x", 1.0), (0xC8, "<h", "magnetometer_z", 1.0)),
]


def counted(size):
    """Return bytes of which no two are alike."""
    return bytes((37 * k + 11) % 251 for k in range(size))


@pytest.mark.parametrize("number", REPLIES)
def test_a_reply_is_built_of_the_bytes_at_the_maps_addresses(number):
    memory = counted(csr.TOP)
    expected = bytearray(LENGTHS[number])
    for offset, name, address, _ in REPLIES[number]:
        size = 1 if name == "total_power" else 2
        expected[offset : offset + size] = memory[address : address + size]
    assert payload(number, memory) == expected


@pytest.mark.parametrize("number", REPLIES)
def test_a_reply_is_read_from_its_offsets(number):
    data = counted(LENGTHS[number])
    values = read(number, data).values
    expected = {
        name: struct.unpack_from("<B" if name == "total_power" else "<h", data, offset)[0] * unit
        for offset, name, _, unit in REPLIES[number]
    }
    assert values == pytest.approx(expected)
    assert list(values) == list(expected)


def test_memory_is_read_from_the_maps_addresses():
    data = counted(csr.TOP)
    values = read_memory(0, data).values
    for address, form, name, unit in COMMANDS + MEMORY:
        assert values[name] == pytest.approx(struct.unpack_from(form, data, address)[0] * unit), (
            name
        )


def test_a_vehicle_puts_each_measurement_where_the_document_says():
    """Reply 5 of the component, its rates in mrad/s: yaw first, roll last."""
    rov = Line(Pro4Rov)
    for name, value in {
        "attitude": [0.1, -0.2, 1.0],
        "rates": [0.101, 0.202, -0.303],
        "specific_force": [1.001, -2.002, -9.003],
        "magnetometer": [11.0, -22.0, 33.0],
    }.items():
        rov.component.set(name, value)
    (answer,) = rov.exchange(request(flags=5))
    words = struct.unpack_from("<16h", answer.payload, 1)
    assert words[:3] == (573, -115, 57)  # 57.3, -11.5 and 5.7 deg
    assert words[4:7] == (-303, 202, 101)
    assert words[7:10] == (1001, -2002, -9003)
    assert words[10:13] == (11, -22, 33)


def test_a_command_block_is_built_at_its_offsets():
    commands = Commands(
        thrust=(0.11, -0.22, 0.33),
        lights=0.44,
        camera_tilt=-55.0,
        camera_focus=0.66,
        camera_control=2,
        camera_buttons=0b101,
        auto_depth=1234.0,
        auto_heading=321.0,
    )
    raw = (11, -22, 33, 44, -55, 66, 2, 5, 1234, 321)
    assert commands.block() == struct.pack("<hhhBbbBBHH", *raw)
    values = read_memory(0, commands.block()).values
    for (_, _, name, unit), count in zip(COMMANDS, raw, strict=True):
        assert values[name] == pytest.approx(count * unit), name


def test_a_topside_shows_what_a_captured_reply_has_at_its_offsets():
    topside = Line(Pro4Topside)
    for answer in PACKETS[1], PACKETS[3], PACKETS[5], PACKETS[7]:
        topside.step(20)
        topside.send(answer)
    topside.step(20)
    (frame,) = frames(PACKETS[7])
    words = struct.unpack_from("<16h", frame.payload, 1)
    degree = 0.017453292519943295
    shown = topside.component.get("attitude")
    assert shown == pytest.approx(
        [words[2] / 10 * degree, words[1] / 10 * degree, words[0] / 10 * degree]
    )
    assert topside.component.get("specific_force") == pytest.approx([w / 1e3 for w in words[7:10]])


# ---------------------------------------------------------------------- thrusters, VRCSR


def test_a_thrusters_answer_is_four_floats_and_a_fault_after_its_type():
    node = ThrusterNode(3, 0)
    node.report(Health(1500.5, 47.25, 2.5, 20.75, 9), 0.0)
    (command,) = frames(encode(propulsion_request([0.5], 3), VRCSR), VRCSR)
    answer = node.handle(command)
    assert answer.payload == bytes((0x81,)) + struct.pack("<4fB", 1500.5, 47.25, 2.5, 20.75, 9)
    packed = b"\x81" + struct.pack("<4fB", -1.5, 2.25, 3.5, -4.75, 7)
    assert read_health(Frame(True, 3, 2, 0, packed)) == Health(-1.5, 2.25, 3.5, -4.75, 7)


def test_a_propulsion_command_is_a_float_per_thruster_after_two_bytes():
    command = propulsion_request([0.25, -0.5, 1.0], 2)
    assert (command.id, command.flags, command.address) == (0x81, 0x02, 0xF0)
    assert command.payload == b"\xaa\x02" + struct.pack("<3f", 0.25, -0.5, 1.0)
    for place, power in enumerate((0.25, -0.5, 1.0)):
        node = ThrusterNode(9, place)
        node.handle(command)
        assert node.power == power
