"""Random messages and frames: any message of the dialect, with any content, of any length."""

import math
import struct

from pymavlink.dialects.v20 import all as mavlink

# What a vehicle listens to is tried more often than the rest of the dialect.
RECEIVED = [
    mavlink.mavlink_map[number]
    for number in (
        0,
        4,
        11,
        20,
        21,
        23,
        39,
        40,
        41,
        43,
        44,
        45,
        47,
        48,
        51,
        66,
        69,
        70,
        73,
        75,
        76,
        82,
        84,
        86,
        110,
        111,
        243,
        256,
    )
]
ALL = [m for number, m in sorted(mavlink.mavlink_map.items()) if number >= 0]
COMMANDS = [
    16,
    20,
    176,
    178,
    179,
    181,
    183,
    192,
    193,
    207,
    222,
    224,
    241,
    246,
    300,
    400,
    401,
    410,
    420,
    510,
    511,
    512,
    519,
    520,
]
NAMES = [b"FS_ACTION", b"ARMING_CHECK", b"CRUISE_SPEED", b"WP_RADIUS", b"SYSID_THISMAV", b"NO_SUCH"]
SYSTEM, OTHER = 7, 8

_FLOATS = [0.0, 1.0, -1.0, 4.0, 21196.0, math.nan, math.inf, -math.inf, 3.4e38, 1e-40]
_INTEGERS = [0, 1, 2, 3, 4, 7, 10, 15]
_BITS = {f"{sign}int{n}_t": (sign, n) for sign in ("", "u") for n in (8, 16, 32, 64)}
_LONGEST = 255


def value(random, kind):
    """Return a number of a field's type, often one that means something."""
    if kind in ("float", "double"):
        if random.random() < 0.6:
            return random.choice(_FLOATS)
        return struct.unpack("<f", random.randbytes(4))[0]
    sign, bits = _BITS[kind]
    low, high = (0, 2**bits - 1) if sign else (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)
    if random.random() < 0.5:
        return random.choice(_INTEGERS)
    return random.choice([low, high, random.randint(low, high)])


def message(random, system=None):
    """Return any message with any content, meant for ``system`` or for all."""
    cls = random.choice(RECEIVED if random.random() < 0.7 else ALL)
    # Lengths are given in the order of the frame.
    lengths = dict(zip(cls.ordered_fieldnames, cls.array_lengths, strict=True))
    fields = []
    for name, kind in zip(cls.fieldnames, cls.fieldtypes, strict=True):
        fields.append(_field(random, cls, name, kind, lengths[name], system))
    return cls(*fields)


def _field(random, cls, name, kind, length, system):
    if name in ("target_system", "target"):
        return random.choice([SYSTEM, SYSTEM, SYSTEM, 0, OTHER]) if system is None else system
    if name == "target_component":
        return random.choice([1, 1, 1, 0, 2])
    if name == "param_id" and random.random() < 0.7:
        return random.choice(NAMES)
    if kind == "char":
        return random.randbytes(random.randint(0, length or 1)) if length else b"x"
    if length:
        return [value(random, kind) for _ in range(length)]
    if name == "command" and cls.id in (75, 76) and random.random() < 0.9:
        return random.choice(COMMANDS)
    return value(random, kind)


def sized(random, mav):
    """Return a frame of MAVLink 1 or 2 with a good checksum, and a payload of any length."""
    cls = random.choice(RECEIVED if random.random() < 0.7 else ALL)
    payload = random.randbytes(random.randint(0, _LONGEST))
    sequence, system, component = random.randrange(256), mav.srcSystem, mav.srcComponent
    if cls.id < 256 and random.random() < 0.3:
        start, header = b"\xfe", bytes([len(payload), sequence, system, component, cls.id])
    else:
        start = b"\xfd"
        header = bytes(
            [len(payload), 0, 0, sequence, system, component, *cls.id.to_bytes(3, "little")]
        )
    checksum = mavlink.x25crc(header + payload)
    checksum.accumulate(bytes([cls.crc_extra]))
    return start + header + payload + checksum.crc.to_bytes(2, "little")
