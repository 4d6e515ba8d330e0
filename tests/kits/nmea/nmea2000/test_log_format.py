"""Logs of candump and Vector, with frames packed as canboat documents them."""

import math
import struct

import can
import numpy as np
import pytest
from nmea2000 import NMEA2000Field, NMEA2000Message, create_encoder
from nmea2000.input_formats import N2KFormat

from seatrial.errors import InputError
from seatrial.trial.logs.formats import format_of, read_log

MAGNETIC, TRUE = 0xFD, 0xFC


def line(time, pgn, data, source=0x23):
    return f"({time:.6f}) can0 {2 << 26 | pgn << 8 | source:08X}#{data.hex().upper()}"


def heading(angle, deviation=None, variation=None, reference=TRUE):
    angles = (0x7FFF if each is None else round(each * 1e4) for each in (deviation, variation))
    return struct.pack("<BHhhB", 0xFF, round(angle * 1e4), *angles, reference)


@pytest.fixture
def read(write):
    return lambda *lines: read_log(write("boat.log", "\n".join(lines) + "\n"))


def test_a_magnetic_compass_is_corrected_by_its_message_or_the_network(read):
    found = read(
        line(9.0, 127250, heading(1.0, reference=MAGNETIC)),  # no variation is known yet
        line(10.0, 127250, heading(1.0, 0.02, -0.05, MAGNETIC)),
        line(10.2, 127258, struct.pack("<BBHhH", 0xFF, 0xF4, 0xFFFF, 1000, 0xFFFF), source=0x0A),
        line(10.5, 127250, heading(1.0, reference=MAGNETIC)),
        line(11.0, 127250, heading(2.0)),
    )
    compass = found.channels["127250.heading"]
    np.testing.assert_allclose(compass.values, [0.97, 1.1, 2.0], atol=1e-9)
    np.testing.assert_allclose(compass.time, [1.0, 1.5, 2.0])
    assert compass.rows.tolist() == [2, 4, 5]
    magnetic = found.channels["127250.magnetic_heading"]
    np.testing.assert_allclose(magnetic.values, [1.0, 1.02, 1.0], atol=1e-9)
    assert found.notes == ("1 magnetic directions (127250) before the first variation",)


def test_a_fast_packet_of_another_encoder(read):
    """129029, 43 bytes in seven frames; one with the method 0 has no fix."""
    encoder = create_encoder(N2KFormat.PYTHON_CAN)
    lines = []
    for k, method in enumerate((1, 0, 1)):
        fields = {"sid": k, "date": 19844, "time": 43200.0 + k, "latitude": 63.4 + k, "longitude": 10.4,
                  "altitude": 3.0, "gnssType": 0, "method": method, "integrity": 0, "numberOfSvs": 9,
                  "hdop": 1.0, "pdop": 1.5, "geoidalSeparation": 40.0, "referenceStations": 0}  # fmt: skip
        message = NMEA2000Message(
            PGN=129029, id="gnssPositionData", priority=3, source=0x11, destination=255,
            fields=[NMEA2000Field(name, value=v, raw_value=v) for name, v in fields.items()],
        )  # fmt: skip
        lines += [
            f"({100.0 + k:.6f}) can0 {each.arbitration_id:08X}#{bytes(each.data).hex()}"
            for each in encoder.encode(message)
        ]
    assert len(lines) == 21
    found = read(*lines)
    np.testing.assert_allclose(found.channels["129029.latitude"].values, [63.4, 65.4], atol=1e-9)
    assert found.notes == ("1 positions (129029) without a fix are left out",)


def test_two_sources_and_what_is_not_read(read):
    found = read(
        line(1.0, 128267, struct.pack("<BIhB", 0, 1234, 500, 0xFF)),
        line(1.1, 128267, struct.pack("<BIhB", 0, 2000, 500, 0xFF), source=0x24),
        line(1.2, 127508, bytes(8)),
        "(1.3) can0 123#00",
        "candump was here",
    )
    assert found.channels["128267.depth"].values.tolist() == [12.34]
    assert found.channels["36/128267.depth"].values.tolist() == [20.0]
    assert found.notes == (
        "1 lines that are no frame are skipped",
        "PGNs that are not read: 127508 (1)",
    )


def test_a_network_of_other_messages_names_them(read):
    """Most frequent first, ten of them."""
    lines = [line(1.0, 130820 + k, bytes(8)) for k in range(14) for _ in range(2 if k == 13 else 1)]
    with pytest.raises(InputError, match="no channel was found") as refused:
        read(*lines)
    said = str(refused.value)
    assert "PGNs that are not read: 130833 (2), 130820 (1)," in said
    assert said.endswith("130828 (1), 4 others (4)")


def test_rudder_attitude_and_motion(read):
    found = read(
        line(1.0, 127245, struct.pack("<BBhhH", 0, 0xFF, 0x7FFF, -1234, 0xFFFF)),
        line(1.0, 127245, struct.pack("<BBhhH", 1, 0xFF, 0x7FFF, 100, 0xFFFF)),
        line(1.0, 127257, struct.pack("<BhhhB", 0, 0x7FFF, 200, -300, 0xFF)),
        line(1.0, 129026, struct.pack("<BBHHH", 0, TRUE, 31416, 250, 0xFFFF)),
        line(1.0, 128259, struct.pack("<BHHBB", 0, 260, 0xFFFF, 0, 0xFF)),
        line(1.0, 127251, struct.pack("<Bih", 0, round(-0.05 / 3.125e-8), -1)),
    )
    values = {name: each.values[0] for name, each in found.channels.items()}
    expected = {"127245.rudder": -0.1234, "127245.rudder[1]": 0.01, "127257.pitch": 0.02, "127257.roll": -0.03,
                "129026.speed": 2.5, "129026.course": math.pi, "128259.water_speed": 2.6,
                "127251.rate_of_turn": -0.05}  # fmt: skip
    for name, value in expected.items():
        assert values[name] == pytest.approx(value, abs=1e-5), name


def test_engines_navigation_and_wind_as_displays_show_them(read):
    """Winds are those that the message has: where they come from."""
    found = read(
        line(0.9, 127258, struct.pack("<BBHhH", 0xFF, 0xF4, 0xFFFF, 500, 0xFFFF)),
        line(1.0, 127488, struct.pack("<BHHbH", 1, 7200, 0xFFFF, 0x7F, 0xFFFF)),
        line(1.0, 130306, struct.pack("<BHHBH", 0, 700, 15000, 0xF8 | 2, 0xFFFF)),
        line(1.0, 130306, struct.pack("<BHHBH", 0, 800, 60000, 0xF8 | 4, 0xFFFF)),
        line(1.0, 130306, struct.pack("<BHHBH", 0, 900, 20000, 0xF8 | 1, 0xFFFF)),
        line(1.0, 129283, struct.pack("<BBiH", 0, 0x3F, -1250, 0xFFFF)),
        line(1.0, 127251, struct.pack("<Bih", 0, 0x7FFFFFFF, -1)),
    )
    values = {name: each.values[0] for name, each in found.channels.items()}
    expected = {"127488.engine_speed 1": 7200 * 0.25 * math.tau / 60, "130306.wind_angle": 1.5,
                "130306.wind_speed": 7.0, "130306.water_wind_angle": 6.0,
                "130306.wind_direction": 2.05, "129283.cross_track": -12.5}  # fmt: skip
    for name, value in expected.items():
        assert values[name] == pytest.approx(value, abs=1e-5), name
    assert found.notes == ("messages without a value, by PGN: 127251 (1)",)


def test_fuel_of_an_engine(read):
    """The first bytes of 127489 in three of four frames of a fast packet, and then the fourth."""
    content = struct.pack("<BHHHhhIHH", 0, 4000, 0xFFFF, 36315, 1375, 155, 0, 0xFFFF, 0xFFFF)
    content = content.ljust(26, b"\xff")
    parts = [bytes([26]) + content[:6], *(content[k : k + 7] for k in range(6, 26, 7))]
    lines = [line(1.0, 127489, bytes([n]) + each) for n, each in enumerate(parts)]
    values = {name: each.values[0] for name, each in read(*lines).channels.items()}
    assert values["127489.engine_fuel_rate 0"] == pytest.approx(15.5e-3 / 3600.0)
    assert values["127489.engine_temperature 0"] == pytest.approx(363.15)
    assert values["127489.engine_oil_pressure 0"] == pytest.approx(400e3)
    assert values["127489.engine_voltage 0"] == pytest.approx(13.75)


def test_frames_without_times_are_no_log(read):
    with pytest.raises(InputError, match=r"line 1: the frame has no time, .* with -L or -t a"):
        read("can0  09F11223   [8]  FF 10 3B FF 7F CE F5 FC")


def test_what_candump_prints(read):
    data = heading(1.0)
    found = read(
        f" (1436509052.249713)  can0  {2 << 26 | 127250 << 8 | 5:08X}   [8]  {data.hex(' ').upper()}",
        f" (1436509052.349713)  can0  {2 << 26 | 127250 << 8 | 5:08X}   [8]  {data.hex(' ').upper()}",
    )
    np.testing.assert_allclose(found.channels["127250.heading"].time, [0.0, 0.1], atol=1e-6)


def test_a_log_of_vector(tmp_path):
    path = tmp_path / "boat.blf"
    with can.BLFWriter(str(path)) as writer:
        for k in range(3):
            identifier = 2 << 26 | 127250 << 8 | 5
            writer.on_message_received(
                can.Message(1.7e9 + k, identifier, True, data=heading(0.1 * k))
            )
    assert format_of(path) == "nmea2000"
    found = read_log(path).channels["127250.heading"]
    np.testing.assert_allclose(found.values, [0.0, 0.1, 0.2])
    np.testing.assert_allclose(found.time, [0.0, 1.0, 2.0])


@pytest.mark.parametrize("name", ["boat.asc", "boat.trc"])
def test_the_content_tells_the_tool(write, name):
    found = read_log(write(name, line(1.0, 127250, heading(1.0)) + "\n"))
    assert found.channels["127250.heading"].values.tolist() == [1.0]


@pytest.mark.parametrize("content", [b"LOGG nothing", b"1,2,3\n"])
def test_no_log_of_a_bus(tmp_path, content):
    (tmp_path / "boat.log").write_bytes(content)
    with pytest.raises(InputError, match=r"boat\.log: no "):
        read_log(tmp_path / "boat.log", "nmea2000")
