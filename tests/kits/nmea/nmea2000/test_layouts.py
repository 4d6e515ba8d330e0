"""Messages bit by bit: what a node sends and receives, at offsets written out here a second time.

Source: canboat.json 6.2.0 (bit offsets from the first byte's lowest bit, resolutions). The package
that writes and reads the messages is not used here, so that a field that is swapped on both ways
is seen. Fast packets: 6 bytes in the first frame after a counter and the length, 7 in each other.
"""

import math

import pytest

from seatrial_kits.can.frame import Frame
from seatrial_kits.nmea.nmea2000.codec import GLOBAL, Decoder

from .network import Network

FAST = {127237: 21, 127489: 26, 129029: 43}
INPUTS = {
    "heading": 1.2345,
    "deviation": -0.0123,
    "variation": 0.0456,
    "heading_reference": "magnetic",
    "rate_of_turn": -0.02,
    "attitude": [0.11, -0.22, 0.33],
    "rudder": 0.1357,
    "rudder_order": -0.2468,
    "water_speed": 3.21,
    "depth": 45.67,
    "transducer_offset": -0.75,
    "position_n": [0.0, 0.0, -12.5],
    "velocity_n": [-3.0, -4.0, 0.0],
    "latitude": math.radians(12.5),
    "longitude": math.radians(-34.25),
    "wind_speed": 7.89,
    "wind_angle": 0.5,
    "engine_speed": [100.0, 1e30, 1e30, 1e30],
    "engine_voltage": [13.8, 1e30, 1e30, 1e30],
    "engine_temperature": [345.67, 1e30, 1e30, 1e30],
    "engine_load": [0.42, 1e30, 1e30, 1e30],
    "steering_mode": 4,
    "heading_to_steer": 2.3456,
    "track": 2.4567,
    "commanded_rudder": 0.1234,
    "rudder_limit": 0.6,
}
COURSE = math.atan2(-4.0, -3.0) + math.tau
# First bit, bits, signed, resolution, value; LSB first.
LAYOUTS = {
    127237: [
        (8, 3, False, 1, 4),
        (14, 2, False, 1, 0),
        (21, 3, False, 1, 1),
        (24, 16, True, 1e-4, 0.1234),
        (40, 16, False, 1e-4, 2.3456),
        (56, 16, False, 1e-4, 2.4567),
        (72, 16, False, 1e-4, 0.6),
    ],
    127245: [
        (0, 8, False, 1, 0),
        (8, 3, False, 1, 2),
        (16, 16, True, 1e-4, -0.2468),
        (32, 16, True, 1e-4, 0.1357),
    ],
    127250: [
        (8, 16, False, 1e-4, 1.2345),
        (24, 16, True, 1e-4, -0.0123),
        (40, 16, True, 1e-4, 0.0456),
        (56, 2, False, 1, 1),
    ],
    127251: [(8, 32, True, 3.125e-8, -0.02)],
    127257: [
        (8, 16, True, 1e-4, 0.33),
        (24, 16, True, 1e-4, -0.22),
        (40, 16, True, 1e-4, 0.11),
    ],
    127488: [(0, 8, False, 1, 0), (8, 16, False, 0.25, 100.0 * 60.0 / math.tau)],
    127489: [
        (0, 8, False, 1, 0),
        (40, 16, False, 0.01, 345.67),
        (56, 16, True, 0.01, 13.8),
        (192, 8, True, 1, 42),
    ],
    128259: [(8, 16, False, 0.01, 3.21), (24, 16, False, 0.01, 5.0)],
    128267: [(8, 32, False, 0.01, 45.67), (40, 16, True, 1e-3, -0.75)],
    129025: [(0, 32, True, 1e-7, 12.5), (32, 32, True, 1e-7, -34.25)],
    129026: [
        (8, 2, False, 1, 0),
        (16, 16, False, 1e-4, COURSE),
        (32, 16, False, 0.01, 5.0),
    ],
    129029: [
        (8, 16, False, 1, 20454),  # 2026-01-01
        (56, 64, True, 1e-16, 12.5),
        (120, 64, True, 1e-16, -34.25),
        (184, 64, True, 1e-6, 12.5),
        (252, 4, False, 1, 1),
    ],
    130306: [
        (8, 16, False, 0.01, 7.89),
        (24, 16, False, 1e-4, 0.5 + math.pi),
        (40, 3, False, 1, 2),
    ],
}
RECEIVED = {
    "bus_heading": 1.2345 - 0.0123 + 0.0456,
    "bus_rate_of_turn": -0.02,
    "bus_attitude": [0.11, -0.22, 0.33],
    "bus_rudder": 0.1357,
    "bus_rudder_order": -0.2468,
    "bus_rudder_direction": -1,
    "bus_water_speed": 3.21,
    "bus_depth": 45.67,
    "bus_position_n": [0.0, 0.0, -12.5],
    "bus_velocity_n": [-3.0, -4.0],
    "bus_wind_speed": 7.89,
    "bus_wind_angle": 0.5,
    "bus_engine_speed": [100.0, 0.0, 0.0, 0.0],
    "bus_steering_mode": 4,
    "bus_heading_to_steer": 2.3456,
    "bus_track": 2.4567,
    "bus_commanded_rudder": 0.1234,
}


def payloads(frames):
    """Return the bytes of the last whole message of each PGN."""
    found, parts = {}, {}
    for _, frame in frames:
        pgn, counter = frame.identifier >> 8 & 0x3FFFF, frame.data[0] & 31
        if pgn not in FAST:
            found[pgn] = frame.data
        elif counter == 0:
            parts[pgn] = frame.data[2:]
        elif pgn in parts:
            parts[pgn] += frame.data[1:]
        if len(parts.get(pgn, b"")) >= FAST.get(pgn, 1 << 20):
            found[pgn] = parts.pop(pgn)[: FAST[pgn]]
    return found


def packed(pgn):
    """Return a message of a PGN that has the values of its layout; all else not available."""
    size = FAST.get(pgn, 8)
    bits = (1 << 8 * size) - 1
    for first, width, _, resolution, value in LAYOUTS[pgn]:
        mask = (1 << width) - 1
        bits = bits & ~(mask << first) | (round(value / resolution) & mask) << first
    return bits.to_bytes(size, "little")


def frames_of(pgn, data):
    identifier = 3 << 26 | pgn << 8 | 77
    parts = [data]
    if pgn in FAST:
        parts = [bytes((0, len(data))) + data[:6]]
        rest = [data[k : k + 7].ljust(7, b"\xff") for k in range(6, len(data), 7)]
        parts += [bytes((number,)) + part for number, part in enumerate(rest, 1)]
    return [Frame(identifier, part, extended=True) for part in parts]


@pytest.fixture(scope="module")
def sent():
    sends = " ".join(map(str, LAYOUTS))
    network = Network({"node": {**INPUTS, "sends": sends}})
    network.run(2.0)
    return payloads(network.frames)


@pytest.mark.parametrize("pgn", LAYOUTS)
def test_a_node_sends_each_field_in_its_place(sent, pgn):
    data = sent[pgn]
    assert len(data) == FAST.get(pgn, 8)
    bits = int.from_bytes(data, "little")
    for first, width, signed, resolution, value in LAYOUTS[pgn]:
        raw = bits >> first & (1 << width) - 1
        if signed and raw >> width - 1:
            raw -= 1 << width
        assert raw * resolution == pytest.approx(value, abs=0.51 * resolution, rel=1e-12), first


@pytest.fixture(scope="module")
def reader():
    network = Network({"node": {"latitude": INPUTS["latitude"], "longitude": INPUTS["longitude"]}})
    network.run(1.0)
    for pgn in LAYOUTS:
        for frame in frames_of(pgn, packed(pgn)):
            network.send(frame)
    network.run(0.1)
    return network.nodes["node"]


@pytest.mark.parametrize("name", RECEIVED)
def test_a_node_receives_each_field_from_its_place(reader, name):
    found = reader.get(name)
    found = found[: len(RECEIVED[name])] if isinstance(RECEIVED[name], list) else found
    assert found == pytest.approx(RECEIVED[name], rel=2e-4, abs=2e-3)


def sent_field(pgn, first, width, **inputs):
    """Return a field, as a whole number, of what a node with these inputs sends."""
    network = Network({"node": {**inputs, "sends": str(pgn)}})
    network.run(1.5)
    return int.from_bytes(payloads(network.frames)[pgn], "little") >> first & (1 << width) - 1


@pytest.mark.parametrize("turns", [-1, 0, 1])
def test_angles_are_sent_within_their_circle(turns):
    circle = round(math.tau * 1e4)
    for angle in (-3.0, -0.5, 0.5, 3.0):
        turned = angle + turns * math.tau
        whole = round(angle % math.tau * 1e4)
        assert sent_field(127250, 8, 16, heading=turned) == whole < circle
        yaw = sent_field(127257, 8, 16, attitude=[0.0, 0.0, turned])
        assert yaw == round(angle * 1e4) % (1 << 16)  # from -pi to pi, two's complement


def received_angle(pgn, fields, name):
    """Return what a node makes of a message whose raw fields are (first bit, bits, number)."""
    bits = (1 << 64) - 1
    for first, width, raw in fields:
        bits = bits & ~(((1 << width) - 1) << first) | raw << first
    network = Network({"node": {}})
    network.run(1.0)
    network.send(Frame(3 << 26 | pgn << 8 | 77, bits.to_bytes(8, "little"), extended=True))
    network.run(0.1)
    return network.nodes["node"].get(name)


def test_angles_that_are_received_are_within_their_circle():
    # A magnetic heading of 6.2 rad and a variation of 0.2 rad east lead across north.
    magnetic = [(8, 16, 62000), (40, 16, 2000), (56, 2, 1)]
    assert received_angle(127250, magnetic, "bus_heading") == pytest.approx(
        6.4 - math.tau, abs=1e-4
    )
    # Wind from 0.5 rad blows to the other side, wind from 6 rad too: -pi to pi.
    for from_, to in ((0.5, 0.5 - math.pi), (6.0, 6.0 - math.pi), (3.2, 3.2 - math.pi)):
        wind = [(8, 16, 500), (24, 16, round(from_ * 1e4)), (40, 3, 2)]
        assert received_angle(130306, wind, "bus_wind_angle") == pytest.approx(to, abs=1e-4)


def test_a_request_has_the_pgn_in_three_bytes():
    network = Network({"node": {"sends": "127250", "heading": 1.0}})
    network.run(1.0)
    address = network.nodes["node"].get("claimed_address")
    before = len(network.frames)
    request = Frame(6 << 26 | 0xEA << 16 | address << 8 | 9, bytes.fromhex("14F001"), extended=True)
    network.send(request)  # 126996, product information
    network.run(0.1)
    pgns = {frame.identifier >> 8 & 0x3FFFF for _, frame in network.frames[before:]}
    assert 126996 in pgns


def test_a_claim_is_the_name_in_eight_bytes():
    """ISO 11783-5: serial number 21 bits, manufacturer 11, instances 8, function 8, class 7..."""
    network = Network(
        {
            "node": {
                "uid": "1234567",
                "manufacturer_code": 381.0,
                "device_function": 140.0,
                "device_class": 60.0,
                "device_instance": 0x2B,
                "system_instance": 5.0,
            }
        }
    )
    network.run(1.0)
    claims = [f.data for _, f in network.frames if f.identifier >> 16 & 0x3FF == 0xEE]
    bits = int.from_bytes(claims[-1], "little")
    fields = [(21, 11), (32, 8), (40, 8), (49, 7), (56, 4), (60, 3), (63, 1)]
    found = [bits >> first & (1 << width) - 1 for first, width in fields]
    assert found == [381, 0x2B, 140, 60, 5, 4, 1]  # industry 4, marine; arbitrary address
    assert bits & 0x1FFFFF == 1234567
    assert GLOBAL == 0xFF


RUDDERS = ("rudder", "rudder_order", "commanded_rudder")


def test_a_rudder_that_is_positive_to_port_has_the_other_sign_on_the_bus():
    here = {name: -INPUTS[name] for name in RUDDERS}
    network = Network({"node": {**here, "rudder_positive": "port", "sends": "127237 127245"}})
    network.run(2.0)
    data = payloads(network.frames)
    for pgn, first in ((127237, 24), (127245, 16), (127245, 32)):
        (value,) = (value for bit, *_, value in LAYOUTS[pgn] if bit == first)
        raw = int.from_bytes(data[pgn], "little") >> first & 0xFFFF
        assert raw == round(value * 1e4) % (1 << 16)
    for pgn in (127237, 127245):
        for frame in frames_of(pgn, packed(pgn)):
            network.send(frame)
    network.run(0.1)
    node = network.nodes["node"]
    found = [node.get(f"bus_{name}") for name in RUDDERS]
    assert found == pytest.approx([here[name] for name in RUDDERS], abs=1e-4)
    assert node.get("bus_rudder_direction") == -1  # to port, whatever the sign


def test_a_rudder_that_is_not_connected_is_not_available_with_either_sign():
    for positive in ("port", "starboard"):
        assert sent_field(127245, 32, 16, rudder_positive=positive) == 0x7FFF


@pytest.mark.parametrize("pgn", FAST)
def test_what_a_cut_fast_packet_has_is_the_whole_one_s(pgn):
    """A field is read if all its bits came, and then as in the whole message."""

    def read(data):
        decoder = Decoder({})
        message = [decoder.decode(frame) for frame in frames_of(pgn, data)][-1]
        return None if message is None else message.fields

    whole = packed(pgn)
    for length in range(1, len(whole)):
        cut = read(whole[:length])
        if cut is None:  # shorter than its variant's fixed fields
            continue
        kept = {name: value for name, value in cut.items() if value is not None}
        assert kept.items() <= read(whole).items()
        assert len(kept) >= sum(first + width <= 8 * length for first, width, *_ in LAYOUTS[pgn])
