"""The turning circle as a log of each format, by the formats' own software.

Instruments have rates of their own: positions come some tenths of a second after headings.
"""

import contextlib
import io
import json
import math
import struct
from types import SimpleNamespace

import can
import numpy as np
import pandas as pd
import pynmea2
from mcap.writer import Writer as McapWriter
from pymavlink import mavutil
from pymavlink.DFReader import FORMAT_TO_STRUCT, DFFormat, DFReader_binary
from pymavlink.dialects.v20 import ardupilotmega as mavlink
from pyulog import ULog
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from tests.kits.logs.circle import UNIX, circle, degrees

RUDDER_MOST = math.radians(35.0)
SERVO = {"SERVO1_FUNCTION": 26, "SERVO1_MIN": 1100, "SERVO1_TRIM": 1500, "SERVO1_MAX": 1900}
"""Parameters of an ArduPilot whose first output steers."""


def in_order(*streams):
    """Return entries (time, write) of several streams by their times."""
    return sorted((entry for stream in streams for entry in stream), key=lambda entry: entry[0])


def pulses(helm):
    """Return the pulse of the steering servo, whole us."""
    return round(1500.0 + 400.0 * helm / RUDDER_MOST)


# ---------------------------------------------------------------------- tables


def frame():
    motion = circle()
    return pd.DataFrame(
        {
            "UTC": pd.to_datetime((UNIX + motion.time) * 1e9, utc=True).round("ms"),
            "Lat [deg]": motion.latitude,
            "Lon [deg]": motion.longitude,
            "HDG [deg]": np.degrees(motion.heading) % 360.0,
            "RUD [deg]": np.degrees(motion.helm),
        }
    )


def write_csv(path):
    """Write ISO 8601, semicolons and decimal commas, as spreadsheets of half of Europe do."""
    table = frame()
    table["UTC"] = table["UTC"].map(lambda each: each.isoformat())
    table.to_csv(path, sep=";", decimal=",", index=False, float_format="%.9f")


def write_parquet(path):
    frame().to_parquet(path)


def write_mcap(path):
    """Write positions, headings and helm as JSON, each at rates of its own, by Foxglove's writer."""
    with path.open("wb") as file:
        writer = McapWriter(file)
        writer.start(profile="", library="test")

        def channel(topic, **units):
            properties = {name: {"type": "number", "unit": unit} for name, unit in units.items()}
            schema = json.dumps({"type": "object", "properties": properties}).encode()
            number = writer.register_schema(topic, "jsonschema", schema)
            return writer.register_channel(f"/{topic}", "json", number)

        place, compass = (
            channel("gnss", latitude="deg", longitude="deg"),
            channel("compass", heading="deg"),
        )
        rudder = channel("rudder", helm="deg")
        slow, fast = circle(1.0, 0.3), circle(0.5)
        for time, number, content in in_order(
            [(t, place, {"latitude": a, "longitude": b})
             for t, a, b in zip(slow.time, slow.latitude, slow.longitude, strict=True)],
            [(t, compass, {"heading": math.degrees(h) % 360.0})
             for t, h in zip(fast.time, fast.heading, strict=True)],
            [(t, rudder, {"helm": math.degrees(d)}) for t, d in zip(fast.time, fast.helm, strict=True)],
        ):  # fmt: skip
            at = round((UNIX + time) * 1e9)
            writer.add_message(number, at, json.dumps(content).encode(), at)
        writer.finish()


# ---------------------------------------------------------------------- NMEA


def write_nmea0183(path):
    """Write RMC and GGA at 1 Hz, headings at 2 Hz and rudder at 1 Hz; over noon."""

    def minutes(value, digits):
        size = abs(value)
        return f"{int(size):0{digits}}{(size % 1.0) * 60.0:07.4f}"

    def clock(time):
        return pd.Timestamp((UNIX + time) * 1e9).round("ms").strftime("%H%M%S.%f")[:9]

    def lines_of(motion, made):
        return [(motion.time[k], f"{made(motion, k)}") for k in range(len(motion.time))]

    def rmc(m, k):
        place = (minutes(m.latitude[k], 2), "N", minutes(m.longitude[k], 3), "E")
        return pynmea2.RMC(
            "GP", "RMC", (clock(m.time[k]), "A", *place, "15.5", "0.0", "010524", "", "")
        )

    def gga(m, k):
        place = (minutes(m.latitude[k], 2), "N", minutes(m.longitude[k], 3), "E")
        return pynmea2.GGA(
            "GP", "GGA", (clock(m.time[k]), *place, "1", "9", "0.9", "3", "M", "", "M", "", "")
        )

    positions = circle()
    entries = in_order(
        lines_of(positions, rmc),
        lines_of(positions, gga),
        lines_of(
            circle(0.5),
            lambda m, k: pynmea2.HDT("HE", "HDT", (f"{degrees(m.heading[k]):.1f}", "T")),
        ),
        lines_of(
            positions,
            lambda m, k: pynmea2.RSA("AG", "RSA", (f"{math.degrees(m.helm[k]):.1f}", "A", "", "V")),
        ),
    )
    path.write_text("\r\n".join(line for _, line in entries) + "\r\n", "ascii")


def write_candump(path):
    """Write PGN 129025 and 127250 at 10 and 2 Hz as canboat's documentation lays them out."""

    def frames(motion, pgn, pack):
        return [(motion.time[k], pgn, pack(motion, k)) for k in range(len(motion.time))]

    def place(m, k):
        return struct.pack("<ii", round(m.latitude[k] * 1e7), round(m.longitude[k] * 1e7))

    def heading(m, k):
        return struct.pack(
            "<BHhhB", 0xFF, round(m.heading[k] % math.tau * 1e4) % 62832, 0x7FFF, 0x7FFF, 0xFC
        )

    def rudder(m, k):
        return struct.pack("<BBhhH", 0, 0xFF, 0x7FFF, round(m.helm[k] * 1e4), 0xFFFF)

    entries = in_order(
        frames(circle(1.0, 0.3), 129025, place),
        frames(circle(0.5), 127250, heading),
        frames(circle(1.0, 0.1), 127245, rudder),
    )
    with can.CanutilsLogWriter(str(path)) as writer:
        for time, pgn, data in entries:
            identifier = 2 << 26 | pgn << 8 | 0x23
            writer.on_message_received(
                can.Message(UNIX + time, identifier, True, data=data, channel="can0", is_rx=True)
            )


# ---------------------------------------------------------------------- ArduPilot


def write_tlog(path):
    """Write what a ground station records: received with 50 to 150 ms of delay."""
    mav = mavlink.MAVLink(None, 1, 1)
    station = mavlink.MAVLink(None, 255, 190)
    delays = np.random.default_rng(1).uniform(0.05, 0.15, 10_000)

    def sent(motion, made):
        return [
            (motion.time[k], made(motion, k, round(1000.0 * motion.time[k]) + 5000))
            for k in range(len(motion.time))
        ]

    def position(m, k, ms):
        lat, lon = round(m.latitude[k] * 1e7), round(m.longitude[k] * 1e7)
        return mavlink.MAVLink_global_position_int_message(
            ms, lat, lon, 0, 0, 0, 0, 0, round(100 * degrees(m.heading[k]))
        )

    def attitude(m, k, ms):
        return mavlink.MAVLink_attitude_message(
            ms, 0.01, -0.02, math.remainder(m.heading[k], math.tau), 0, 0, 0
        )

    def servo(m, k, ms):
        return mavlink.MAVLink_servo_output_raw_message(ms * 1000, 0, pulses(m.helm[k]), *[0] * 7)

    entries = in_order(
        sent(circle(1.0, 0.3), position), sent(circle(0.5), attitude), sent(circle(1.0, 0.1), servo)
    )
    with contextlib.closing(mavutil.mavlogfile(str(path), write=True)) as log:

        def put(time, message, sender):
            log.write(struct.pack(">Q", round(1e6 * (UNIX + time))) + message.pack(sender))

        put(0.0, mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3), station)
        put(0.0, mavlink.MAVLink_heartbeat_message(11, 3, 81, 0, 4, 3), mav)
        for name, value in SERVO.items():
            put(0.0, mavlink.MAVLink_param_value_message(name.encode(), value, 9, 4, 0), mav)
        for (time, message), delay in zip(entries, delays, strict=False):
            put(time + delay, message, mav)


def dataflash(path):
    """Return pymavlink's packer of messages, and those of the circle: format, values."""
    seed = path.with_suffix(".seed")
    seed.write_bytes(
        b"\xa3\x95\x80"
        + struct.pack("<BB4s16s64s", 0x80, 89, b"FMT", b"BBnNZ", b"Type,Length,Name,Format,Columns")
    )
    with contextlib.redirect_stderr(io.StringIO()):
        packer = DFReader_binary(str(seed))
    seed.unlink()
    kinds = {
        "PARM": ("QNf", "TimeUS,Name,Value"),
        "ATT": ("QffC", "TimeUS,Roll,Pitch,Yaw"),
        "POS": ("QLL", "TimeUS,Lat,Lng"),
        "RCOU": ("QHH", "TimeUS,C1,C3"),
    }
    formats = {
        name: packer.add_format(DFFormat(0, name, 0, letters, columns))
        for name, (letters, columns) in kinds.items()
    }

    def stamped(motion, name, made):
        return [
            (t, name, (round(1e6 * t) + 7_000_000, *made(motion, k)))
            for k, t in enumerate(motion.time)
        ]

    entries = in_order(
        [(0.0, "PARM", (7_000_000, key.encode(), value)) for key, value in SERVO.items()],
        stamped(
            circle(1.0, 0.3),
            "POS",
            lambda m, k: (round(m.latitude[k] * 1e7), round(m.longitude[k] * 1e7)),
        ),
        stamped(
            circle(0.5),
            "ATT",
            lambda m, k: (0.5, -1.5, round(100.0 * degrees(m.heading[k])) % 36000),
        ),
        stamped(circle(1.0, 0.1), "RCOU", lambda m, k: (pulses(m.helm[k]), 1500)),
    )
    return packer, formats, entries


def write_bin(path):
    packer, formats, entries = dataflash(path)
    content = b"".join(
        packer.make_format_msgbuf(each) for each in (packer.formats[0x80], *formats.values())
    )
    path.write_bytes(
        content + b"".join(packer.make_msgbuf(formats[name], values) for _, name, values in entries)
    )
    packer.close()


def write_text_log(path):
    """Write the text that ground stations make of a .bin."""
    packer, formats, entries = dataflash(path)
    lines = [
        f"FMT, {f.type}, {3 + struct.calcsize(f.msg_struct)}, {f.name}, {f.format}, {','.join(f.columns)}"
        for f in (packer.formats[0x80], *formats.values())
    ]
    for _, name, values in entries:
        scales = [FORMAT_TO_STRUCT[letter][1] for letter in formats[name].format]
        cells = [
            each.decode()
            if isinstance(each, bytes)
            else repr(each if scale is None else each * scale)
            for each, scale in zip(values, scales, strict=True)
        ]
        lines.append(", ".join((name, *cells)))
    path.write_text("\n".join(lines) + "\n", "ascii")
    packer.close()


# ---------------------------------------------------------------------- PX4, ROS 2


def write_ulog(path):
    topics = {
        "vehicle_local_position": (circle(1.0, 0.3), ("float x", "float y", "float z", "bool xy_valid"),
                                   lambda m: (m.north, m.east, 0.0 * m.east, m.east == m.east)),
        "vehicle_attitude": (circle(0.5), ("float q[4]",),
                             lambda m: (np.cos(m.heading / 2), 0.0 * m.time, 0.0 * m.time, np.sin(m.heading / 2))),
        "actuator_servos": (circle(1.0, 0.1), ("float control[1]",), lambda m: (m.helm / RUDDER_MOST,)),
    }  # fmt: skip
    log = ULog(None)
    log._start_timestamp, log._file_version = 3_000_000, 1
    for number, (name, (motion, declared, columns)) in enumerate(topics.items()):
        fields = [("uint64_t", 0, "timestamp"), *(_declared(each) for each in declared)]
        log._message_formats[name] = SimpleNamespace(name=name, fields=fields)
        members = [SimpleNamespace(field_name="timestamp", type_str="uint64_t")]
        for kind, size, field in fields[1:]:
            names = [f"{field}[{k}]" for k in range(size)] if size else [field]
            members += [SimpleNamespace(field_name=each, type_str=kind) for each in names]
        stamps = np.round(1e6 * motion.time).astype(np.uint64) + np.uint64(3_000_000)
        values = (stamps, *columns(motion))
        data = {each.field_name: value for each, value in zip(members, values, strict=True)}
        log._data_list.append(
            SimpleNamespace(name=name, multi_id=0, msg_id=number, field_data=members, data=data)
        )
    log.write_ulog(str(path))


def _declared(text):
    kind, name = text.split()
    name, _, size = name.partition("[")
    return kind, int(size.rstrip("]") or 0), name


def write_bag(path):
    store = get_typestore(Stores.ROS2_HUMBLE)
    types = store.types
    geometry = "geometry_msgs/msg"

    def header(time):
        seconds, ns = divmod(round(1e9 * (UNIX + time)), 10**9)
        return types["std_msgs/msg/Header"](
            types["builtin_interfaces/msg/Time"](seconds, ns), "map"
        )

    def pose(m, k):
        yaw = math.pi / 2 - m.heading[k]
        turn = types[f"{geometry}/Quaternion"](0.0, 0.0, math.sin(yaw / 2), math.cos(yaw / 2))
        point = types[f"{geometry}/Point"](m.east[k], m.north[k], 0.0)
        return types[f"{geometry}/PoseStamped"](
            header(m.time[k]), types[f"{geometry}/Pose"](point, turn)
        )

    poses, helms = circle(0.5), circle(1.0, 0.1)
    with Writer(path, version=9, storage_plugin=StoragePlugin.SQLITE3) as bag:

        def topic(name, kind, motion, made):
            connection = bag.add_connection(name, kind, typestore=store)
            return [
                (motion.time[k], connection, kind, made(motion, k)) for k in range(len(motion.time))
            ]

        entries = in_order(
            topic("/pose", f"{geometry}/PoseStamped", poses, pose),
            topic(
                "/rudder",
                "std_msgs/msg/Float64",
                helms,
                lambda m, k: types["std_msgs/msg/Float64"](m.helm[k]),
            ),
        )
        for time, connection, kind, message in entries:
            bag.write(connection, round(1e9 * (UNIX + time)), store.serialize_cdr(message, kind))
