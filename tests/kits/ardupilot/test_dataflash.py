"""ArduPilot's own logs: units, sensors, dates, and bytes that are no message."""

import struct

import numpy as np
import pytest

from seatrial.errors import InputError
from seatrial.trial.logs.formats import read_log

LETTERS = {
    "Q": "Q",
    "B": "B",
    "f": "f",
    "L": "i",
    "H": "H",
    "I": "I",
    "c": "h",
    "C": "H",
    "N": "16s",
    "Z": "64s",
    "b": "b",
    "d": "d",
    "n": "4s",
}
FMT = ("FMT", 0x80, "BBnNZ", "Type,Length,Name,Format,Columns")


def message(number, letters, *values):
    texts = (each.encode() if isinstance(each, str) else each for each in values)
    return struct.pack(
        "<BBB" + "".join(LETTERS[each] for each in letters), 0xA3, 0x95, number, *texts
    )


class Log:
    """Bytes of a log, laid out as libraries/AP_Logger/LogStructure.h has them."""

    def __init__(self):
        self.kinds, self.content = {}, b""
        self.declare(*FMT)

    def declare(self, name, number, letters, columns):
        self.kinds[name] = (number, letters)
        length = 3 + struct.calcsize("<" + "".join(LETTERS[each] for each in letters))
        self.content += message(0x80, FMT[2], number, length, name, letters, columns)

    def put(self, name, *values):
        self.content += message(*self.kinds[name], *values)


@pytest.fixture
def log():
    made = Log()
    made.declare("GPS", 1, "QBBIHLLfC", "TimeUS,I,Status,GMS,GWk,Lat,Lng,Spd,GCrs")
    made.declare("ATT", 2, "QccC", "TimeUS,Roll,Pitch,Yaw")
    made.declare("UNIT", 10, "QbZ", "TimeUS,Id,Label")
    made.declare("MULT", 11, "Qbd", "TimeUS,Id,Mult")
    made.declare("FMTU", 12, "QBNN", "TimeUS,FmtType,UnitIds,MultIds")
    for letter, label in ((b"s", "s"), (b"#", "instance"), (b"D", "deglatitude"), (b"U", "deglongitude"),
                          (b"n", "m/s"), (b"h", "degheading"), (b"d", "deg"), (b"-", "")):  # fmt: skip
        made.put("UNIT", 4_000_000, letter[0], label)
    for letter, factor in ((b"F", 1e-6), (b"G", 1e-7), (b"B", 1e-2), (b"0", 1.0), (b"-", 0.0)):
        made.put("MULT", 4_000_000, letter[0], factor)
    made.put("FMTU", 4_000_000, 1, "s#---DUnh", "F----GG0B")
    made.put("FMTU", 4_000_000, 2, "sddh", "FBBB")
    return made


@pytest.fixture
def read(tmp_path):
    def read(content):
        path = tmp_path / "boat.bin"
        path.write_bytes(content)
        return read_log(path)

    return read


def test_units_sensors_and_the_date(log, read):
    # 2024-05-01T12:00:00Z is GPS week 2312, second 302418 of it (18 leap seconds).
    for k in range(3):
        for sensor in (0, 1):
            fix = 1 if (k, sensor) == (0, 0) else 3
            log.put(
                "GPS",
                5_000_000 + 200_000 * k,
                sensor,
                fix,
                302_418_000 + 200 * k,
                2312,
                634000000 + k,
                104000000,
                2.5,
                9000,
            )
        log.put("ATT", 5_000_000 + 200_000 * k, 100, -250, 18000 + k)
    found = read(log.content)
    first, second = found.channels["GPS.Lat"], found.channels["GPS[1].Lat"]
    np.testing.assert_allclose(first.values, [63.4000001, 63.4000002], atol=1e-12)
    np.testing.assert_allclose(second.time, [1.0, 1.2, 1.4])  # from the first message on
    assert (first.unit, found.channels["GPS.Spd"].unit) == ("deg", "m/s")
    assert found.channels["ATT.Yaw"].values.tolist() == [180.0, 180.01, 180.02]
    assert (found.channels["ATT.Pitch"].values[0], found.channels["ATT.Pitch"].unit) == (
        -2.5,
        "deg",
    )
    assert found.notes == ("1 messages GPS without a fix are left out",)
    assert found.start.isoformat()[:19] == "2024-05-01T11:59:59"


def test_bytes_that_are_no_message_are_skipped(log, read):
    log.put("ATT", 1_000_000, 1, 2, 3)
    log.content += b"\0" * 40
    log.put("ATT", 2_000_000, 1, 2, 3)
    log.put("ATT", 3_000_000, 1, 2, 3)
    assert read(log.content[:-4]).channels["ATT.Yaw"].time.tolist() == [0.0, 1.0]


@pytest.mark.parametrize(
    "content", [b"\xa3\x95\x80", b"FMT, 128, 89, FMT, BBnNZ, Type\n", b"\xa3" * 600]
)
def test_no_log(tmp_path, content):
    (tmp_path / "boat.bin").write_bytes(content)
    with pytest.raises(InputError, match="no log of ArduPilot"):
        read_log(tmp_path / "boat.bin", "ardupilot")
