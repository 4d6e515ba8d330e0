"""CSR memory map of the Pro 4: addresses, scales, access.

Source: VideoRay, PRO4_CSR_memory_map.xls, revision 3; lowest byte first, two's complement. Where
it does not mark as read only what the device itself measures or counts (power manager, internal
temperatures, humidity, errors, run time, greatest values, terms of the controllers, magnetometer,
sensor status, copy of the version), it is read only here.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from seatrial.errors import InputError, unknown

COMMAND_END = 0x0F
"""Where the command block ends, which is most of the traffic."""
TOP = 0xF0
"""Where the special registers begin: what is below is one memory."""
OFF = 0xFFFF
"""A target of auto depth or auto heading that is none."""

CUSTOM_COMMAND = 0xF0
CONFIG_SIZE = 0xF5
CONFIG = 0xF7
FIRMWARE_VERSION = 0xF8
NODE_ID = 0xFB
GROUP_ID = 0xFC
SERIAL_NUMBER = 0xFD
UTILITY = 0xFE
COMMIT = 0xEE


@dataclass(frozen=True)
class Register:
    """One datum of the map: value = raw number times ``scale``, in ``unit``."""

    name: str
    address: int
    size: int
    signed: bool
    scale: float
    unit: str
    writable: bool
    stored: bool
    """Whether it outlives a reboot."""
    default: int
    """Raw number of the captured vehicle."""
    description: str

    @property
    def lowest(self) -> int:
        """The lowest raw number."""
        return -(1 << (8 * self.size - 1)) if self.signed else 0

    @property
    def highest(self) -> int:
        """The highest raw number."""
        return (1 << (8 * self.size - self.signed)) - 1

    def bytes_of(self, raw: int) -> bytes:
        """Return a raw number's bytes. Raises InputError for one that does not fit."""
        if not self.lowest <= raw <= self.highest:
            raise InputError(f"{self.name}: {raw} is not from {self.lowest} to {self.highest}")
        return raw.to_bytes(self.size, "little", signed=self.signed)

    def raw_in(self, memory: bytes | bytearray) -> int:
        """Return the raw number that a memory has."""
        own = memory[self.address : self.address + self.size]
        return int.from_bytes(own, "little", signed=self.signed)

    def clipped(self, value: float) -> int:
        """Return the raw number nearest to a value that this register can hold."""
        return min(max(round(value / self.scale), self.lowest), self.highest)


def _many(
    names: str,
    address: int,
    kind: str,
    scale: float = 1.0,
    unit: str = "1",
    *,
    access: str = "r",
    default: Iterable[int] = (),
    note: str = "",
) -> list[Register]:
    """Return registers that follow each other; ``access``: r, rw, or rws for stored ones."""
    size, signed = int(kind[1:]) // 8, kind[0] == "i"
    listed = names.split()
    defaults = [*default] or [0] * len(listed)
    return [
        Register(
            name,
            address + number * size,
            size,
            signed,
            scale,
            unit,
            "w" in access,
            "s" in access,
            raw,
            note,
        )
        for number, (name, raw) in enumerate(zip(listed, defaults, strict=True))
    ]


_THRUSTERS = ("port", "starboard", "vertical")


def _thrusters(what: str, address: int, scale: float, default: Iterable[int], note: str) -> list:  # type: ignore[type-arg]
    names = " ".join(f"{thruster}_{what}" for thruster in _THRUSTERS)
    return _many(names, address, "u16", scale, access="rws", default=default, note=note)


def _controller(name: str, address: int, default: Iterable[int]) -> list:  # type: ignore[type-arg]
    names = " ".join(f"{name}_{part}" for part in "pidk")
    return _many(
        names, address, "i16", 1e-4, access="rws", default=default, note="P, I, D; K multiplies"
    )


def _terms(name: str, address: int) -> list:  # type: ignore[type-arg]
    names = " ".join(f"{name}_{part}" for part in ("p_term", "i_term", "d_term", "output"))
    return _many(names, address, "i16", 1e-4, note="terms of the controller, and their sum")


_SHARE = "share of the power, per loop"

REGISTERS: tuple[Register, ...] = (
    *_many(
        "port_target starboard_target vertical_target",
        0x00,
        "i16",
        0.01,
        "1",
        access="rw",
        note="-1 to 1",
    ),
    *_many("lights", 0x06, "u8", 0.01, access="rw", note="0 to 1"),
    *_many("camera_tilt", 0x07, "i8", 1.0, "deg", access="rw", note="-90 to 90"),
    *_many("camera_focus", 0x08, "i8", 0.01, access="rw", note="-1 to 1"),
    *_many("camera_control", 0x09, "u8", access="rw", note="bit 1: camera selected"),
    *_many(
        "camera_buttons",
        0x0A,
        "u8",
        access="rw",
        note="bits: menu, up, down, left, right, menu off",
    ),
    *_many("auto_depth_target", 0x0B, "u16", 1.0, "mbar", access="rw", default=[OFF]),
    *_many("auto_heading_target", 0x0D, "u16", 1.0, "deg", access="rw", default=[OFF]),
    *_many("power_manager", 0x13, "u8", 0.01, default=[100], note="power it allows"),
    *_thrusters("dead_band", 0x14, 1e-3, (380, 380, 400), "multiplier, 0 to 1"),
    *_thrusters("max_limit", 0x1A, 1e-3, (920, 920, 900), "multiplier, 0 to 1"),
    *_thrusters("slew_rate", 0x20, 1e-4, (50, 50, 50), "0 to 1"),
    *_controller("auto_depth", 0x26, (-200, -4, 0, 10000)),
    *_controller("auto_heading", 0x2E, (600, 40, 8000, 1000)),
    *_many("max_current", 0x46, "u16", 0.01, "A", access="rws", default=[3300]),
    *_many("min_voltage", 0x48, "u16", 0.01, "V", access="rws", default=[3800]),
    *_many("voltage_decrement", 0x4A, "u16", 1e-3, access="rws", default=[1], note=_SHARE),
    *_many("voltage_increment", 0x4C, "u16", 1e-4, access="rws", default=[1], note=_SHARE),
    *_many("current_decrement", 0x4E, "u16", 1e-3, access="rws", default=[1], note=_SHARE),
    *_many("current_increment", 0x50, "u16", 1e-4, access="rws", default=[1], note=_SHARE),
    *_many("max_thruster_delta", 0x52, "u16", 1e-3, access="rws", default=[10]),
    *_many("thrust_delta_clamp", 0x54, "u16", 0.01, access="rws", default=[500]),
    *_many("thrust_delta_increment", 0x56, "u16", 1e-4, access="rws", default=[11]),
    *_many("min_power", 0x58, "u8", 0.01, access="rws", default=[50]),
    *_many("max_power", 0x59, "u8", 0.01, access="rws", default=[100]),
    *_many("total_power", 0x5F, "u8", 0.01, default=[100], note="power available"),
    *_many("voltage_drop", 0x60, "u8", 0.1, "V", note="across the tether at the start"),
    *_many("horizontal_limit", 0x61, "u8", 0.01, default=[92], note="reserved"),
    *_many("attitude_sensor", 0x64, "u8", default=[1], note="0 KCF, 1 VN100"),
    *_many("pressure_sensor", 0x65, "u8", note="0 standard"),
    *_many("pressure", 0x66, "u16", 1.0, "mbar", note="absolute"),
    *_many("heading pitch roll", 0x68, "i16", 0.1, "deg"),
    *_many(
        "yaw_acceleration pitch_acceleration roll_acceleration",
        0x6E,
        "i16",
        note="depends on the sensor",
    ),
    *_many(
        "surge_acceleration sway_acceleration heave_acceleration",
        0x74,
        "i16",
        1e-3,
        "m/s2",
        note="specific force; scale found in captures",
    ),
    *_many("water_temperature", 0x7A, "i16", 0.01, "degC"),
    *_many("tether_voltage", 0x7C, "u16", 0.01, "V"),
    *_many("bus_voltage", 0x7E, "u16", 0.01, "V", note="of the 12 V supply"),
    *_many("bus_current", 0x80, "u16", 1e-3, "A", note="of the 12 V supply"),
    *_many("cpu_temperature power_temperature", 0x82, "u8", note="reserved"),
    *_many("humidity", 0x84, "u16", 0.01, note="relative, inside"),
    *_many("communication_errors", 0x86, "u16"),
    *_many("max_depth", 0x88, "u16", 1.0, "mbar", access="rs", note="reserved"),
    *_many("max_humidity", 0x8A, "u16", 0.01, note="reserved"),
    *_many("run_time", 0x8C, "u32", 1.0, "s", access="rs"),
    *_many(" ".join(f"adc_{n}" for n in range(8)), 0x90, "u16", note="raw"),
    *_many(
        " ".join(f"servo_{n}" for n in range(1, 10)),
        0xA0,
        "u16",
        access="rw",
        default=[2764] * 5 + [2914] + [2764] * 3,
        note="clock ticks",
    ),
    *_many("servo_timebase", 0xB2, "u16", access="rw", note="clock ticks"),
    *_terms("auto_depth", 0xB4),
    *_terms("auto_heading", 0xBC),
    *_many("magnetometer_x magnetometer_y magnetometer_z", 0xC4, "i16", note="raw"),
    *_many(
        " ".join(f"magnetometer_{what}_{axis}" for what in ("offset", "scale") for axis in "xyz"),
        0xCA,
        "i16",
        access="rws",
        note="reserved for its calibration",
    ),
    *_many("calibration_key", 0xE2, "u8", access="rws", note="calibration is valid"),
    *_many("attitude_status", 0xE3, "u16"),
    *_many("attitude_reset", 0xE5, "u8", access="rw", note="command"),
    *_many("version_copy", 0xEB, "u24", default=[0x060602], note="of the firmware"),
    *_many("commit", COMMIT, "u16", access="rw", note="keeps the stored ones, written with any"),
)
"""All data of the map below 0xF0, in its order. Bytes without one are plain memory."""

BY_NAME = {register.name: register for register in REGISTERS}

WRITABLE = bytes(
    all(r.writable for r in REGISTERS if r.address <= a < r.address + r.size) for a in range(TOP)
)
"""1 for each address below 0xF0 that a request may write."""
STORED = tuple(a for r in REGISTERS if r.stored for a in range(r.address, r.address + r.size))
"""Addresses that outlive a reboot."""


def factory_memory() -> bytearray:
    """Return the memory below 0xF0 of a new vehicle."""
    memory = bytearray(TOP)
    for register in REGISTERS:
        put(memory, register.name, register.default)
    return memory


def put(memory: bytearray, name: str, raw: int) -> None:
    """Set a register to a raw number. Raises InputError for one that does not fit."""
    register = BY_NAME[name]
    memory[register.address : register.address + register.size] = register.bytes_of(raw)


def value(memory: bytes | bytearray, name: str) -> float:
    """Return a register's value in its unit."""
    register = BY_NAME[name]
    return register.raw_in(memory) * register.scale


def read_settings(text: str) -> dict[str, int]:
    """Return raw numbers by register from ``NAME VALUE; NAME VALUE``, values in their units.

    Raises InputError for what is not a stored register or does not fit.
    """
    found = {}
    for entry in filter(None, map(str.strip, text.split(";"))):
        name, _, written = entry.partition(" ")
        known = [r.name for r in REGISTERS if r.stored]
        if name not in known:
            raise InputError(unknown("stored register", name, known))
        register = BY_NAME[name]
        try:
            raw = round(float(written) / register.scale)
        except (ValueError, OverflowError):
            raise InputError(f"{name}: a number is needed, found {written!r}") from None
        register.bytes_of(raw)
        found[name] = raw
    return found


GAINS: dict[str, dict[str, int]] = {
    "captured": {},
    "holding": {
        **dict(zip((f"auto_depth_{x}" for x in "pidk"), (-1000, -1, -12000, 1000), strict=True)),
        **dict(zip((f"auto_heading_{x}" for x in "pidk"), (410, 12, 6400, 100), strict=True)),
        **{f"{name}_slew_rate": 10000 for name in ("port", "starboard", "vertical")},
    },
}
"""Raw numbers by register, where they differ from the captured vehicle's.

With the capture's slew of 0.005 per loop of 0.1 s it takes 20 s to full thrust, and oscillates.
``holding`` is ours, for the vehicle videoray: the natural frequencies are 1.4 rad/s in depth and
1.1 rad/s in heading, and the slew is no limit.
"""
