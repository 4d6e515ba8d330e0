"""The Arduino component's parameters, inputs and outputs."""

from __future__ import annotations

import ipaddress
import math
from typing import ClassVar

from seatrial.errors import InputError
from seatrial.links.parameter_validation import start_date
from seatrial.links.safe_state import UNSET, safe_state_bytes
from seatrial.model.component import (
    Component,
    Input,
    Output,
    Parameter,
    Reachable,
    Terminal,
    terminal,
)
from seatrial.model.unit_table import STANDARD_GRAVITY

from .mcus import MCUS
from .sources.sketch import read_flags
from .wiring import (
    BLOCKS,
    GROUP,
    OTHERS,
    SERVOS,
    STEPPERS,
    UARTS,
    check_wires,
    read_links,
    read_monitors,
    read_uarts,
)

BACKENDS = ("host", "simavr", "board")
_UARTS = tuple(f"uart{i}" for i in range(UARTS))


def _axes(letter: str, count: int = OTHERS) -> tuple[str, ...]:
    return tuple(f"{letter}{i}" for i in range(1, count + 1))


def check_network(text: str) -> None:
    """Raise InputError for what is no IPv4 address; '' is none."""
    if text:
        try:
            ipaddress.IPv4Address(text)
        except ValueError:
            raise InputError(f"network: {text!r} is no IPv4 address, such as 127.0.0.2") from None


class ArduinoPorts(Reachable, Component):
    """Parameters, inputs and outputs of `Arduino`."""

    backend = Parameter("host", "1", "what runs the sketch", choices=BACKENDS)
    mcu = Parameter("atmega2560", "1", "microcontroller", choices=tuple(MCUS))
    sketch = Parameter(
        "", "1", "folder of the sketch, its .ino, or a folder with a platformio.ini", role="file"
    )
    firmware = Parameter(
        "", "1", "simavr: a .hex or .elf file in the place of a sketch", role="file"
    )
    libraries = Parameter("", "1", "folders of libraries, relative to the sketch's folder; with ;")
    environment = Parameter(
        "", "1", "of a project's platformio.ini; none: default_envs, or the only one"
    )
    flags = Parameter(
        "", "1", "options of the compiler, as -DNAME=VALUE; separated by spaces", check=read_flags
    )
    eeprom = Parameter(
        "", "1", "bytes that the EEPROM begins with, a binary file; none: erased", role="file"
    )
    eeprom_after = Parameter("", "1", "binary file for what the EEPROM holds at the end")
    flash = Parameter(
        "",
        "1",
        "ESP32: folder (littlefs, spiffs, nvs) that its flash begins with",
        role="file",
    )
    flash_after = Parameter("", "1", "ESP32: folder for what the flash holds at the end")
    network = Parameter(
        "",
        "1",
        "ESP32: address of its WiFi on this machine, as 127.0.0.2; none: it is alone",
        check=check_network,
    )
    card = Parameter(
        "", "1", "image that an SD card begins with; none: an empty FAT16 of 32 MiB", role="file"
    )
    card_after = Parameter("", "1", "file for the image of the SD card at the end")
    uarts = Parameter("0 115200", "1", "UART BAUD of each line; with ;", check=read_uarts)
    wires = Parameter(
        "",
        "1",
        "PIN KIND NUMBER or PLACE PART NUMBER of all that is connected; with ;",
        check=check_wires,
    )
    links = Parameter(
        "",
        "1",
        "board: UART=URL of each, separated by spaces, as 0=serial:/dev/ttyACM0:115200",
        check=read_links,
    )
    monitors = Parameter(
        "",
        "1",
        "UART=URL where programs listen in and type, as 0=pty:/tmp/uart0",
        check=read_monitors,
    )
    safe_state = Parameter(
        UNSET, "1", "board: safe-state bytes, hexadecimal; empty for none", check=safe_state_bytes
    )
    timeout = Parameter(
        2.0,
        "s",
        "board: silence after which an input is stale, or a link lost: the safe state is sent",
        min=1e-3,
    )
    patience = Parameter(
        5.0,
        "s",
        "time for which a sketch may run without calling anything: longer, it hangs",
        min=1e-3,
    )
    magnetic_field = Parameter(
        0.0,
        "T",
        "field of the earth, north-east-down; 0: that of the home and date",
        axes=("north", "east", "down"),
    )
    latitude = Parameter(0.0, "rad", "of the home, WGS 84", min=-1.5707964, max=1.5707964)
    longitude = Parameter(0.0, "rad", "of the home, WGS 84", min=-3.1415927, max=3.1415927)
    altitude = Parameter(0.0, "m", "of the home")
    date = start_date()
    supply_min = Parameter(
        3.7, "V", "supply below which it is off: reset at 2.7 V behind a regulator", min=0.0
    )
    view_width = Parameter(
        math.radians(75.0), "rad", "field of view over the 320 pixels of a pixy", min=0.1, max=3.1
    )
    water_density = Parameter(1000.0, "kg/m3", "of the water over the pressure sensor", min=0.0)
    gravity = Parameter(STANDARD_GRAVITY, "m/s2", "acceleration of gravity", min=0.0)

    rx = Input(
        "1",
        "bytes that arrive at each UART, as text",
        type=str,
        role="bytes",
        axes=_UARTS,
        optional=True,
    )
    can_rx = Input("1", "ESP32: operations from the CAN bus", type=str, role="can", optional=True)
    cut = Input(
        "1", "whether each UART's line is cut, both ways", type=bool, axes=_UARTS, optional=True
    )
    wind_speed = Input("m/s", "speed of the wind at cups", optional=True)
    wind_angle = Input(
        "rad", "where it blows to from the bow, to starboard, at the vane", optional=True
    )
    gyro = Input("rad/s", "angular velocity, body axes", axes="xyz", frame="b", optional=True)
    accelerometer = Input(
        "m/s2",
        "specific force, body axes",
        axes="xyz",
        frame="b",
        start=(0.0, 0.0, -STANDARD_GRAVITY),
        optional=True,
    )
    attitude = Input(
        "rad",
        "Euler angles, ZYX, for the magnetometer",
        axes=("phi", "theta", "psi"),
        optional=True,
    )
    supply = Input("V", "voltage of its supply", start=7.4, optional=True)
    sight_bearing = Input(
        "rad",
        "bearing of what a pixy detects, to starboard",
        axes=_axes("d", BLOCKS),
        optional=True,
    )
    sight_size = Input("rad", "apparent diameter of it", axes=_axes("d", BLOCKS), optional=True)
    sight_kind = Input("1", "signature of it", type=int, axes=_axes("d", BLOCKS), optional=True)
    sight_count = Input("1", "how many it detects in the frame", type=int, optional=True)
    sight_frame = Input("1", "number of the frame", type=int, optional=True)
    depth = Input("m", "depth of the pressure sensor", optional=True)
    water_temperature = Input("K", "temperature of the water", start=293.15, optional=True)
    angle = Input("rad", "angles that parts measure", axes=_axes("a", GROUP), optional=True)
    distance = Input("m", "distances that parts measure", axes=_axes("d", GROUP), optional=True)
    temperature = Input(
        "K",
        "temperatures that parts measure",
        axes=_axes("t", GROUP),
        start=(293.15,) * GROUP,
        optional=True,
    )
    receiver = Input(
        "s", "pulses of the RC receiver's channels, 0 for none", axes=_axes("c"), optional=True
    )
    voltage = Input("V", "at analogue inputs", axes=_axes("v"), optional=True)
    level = Input("1", "at digital inputs", type=bool, axes=_axes("i"), optional=True)

    tx = Output("1", "bytes that left each UART, as text", type=str, role="bytes", axes=_UARTS)
    can_tx = Output("1", "ESP32: operations to the CAN bus", type=str, role="can")
    pulse = Output("s", "width of the last servo pulse, 0 for none", axes=_axes("s", SERVOS))
    duty = Output("1", "share of time that PWM outputs are high", axes=_axes("p"))
    output = Output("1", "levels of digital outputs", type=bool, axes=_axes("o"))
    steps = Output(
        "1", "step pulses, less those while direction was low", type=int, axes=_axes("m", STEPPERS)
    )
    powered = Output("1", "whether its supply is enough", type=bool)
    connected = Output("1", "board: whether one has sent, and all that have still do", type=bool)
    on_wall_clock = Output("1", "whether it needs real time: board", type=bool, role="wall-clock")
    resets = Output(
        "1", "times that the board started again, by its watchdog or its supply", type=int
    )
    bytes_sent = Output("1", "bytes that left the UARTs", type=int)
    bytes_received = Output("1", "bytes that were put on the lines to the UARTs", type=int)

    terminals: ClassVar = {
        "sensors": terminal("gyro", "accelerometer", "wind_speed", "wind_angle", "depth"),
        "truth": terminal("attitude"),
        "bus": terminal(tx="can_tx", rx="can_rx"),
        "camera": terminal(
            bearing="sight_bearing",
            size="sight_size",
            kind="sight_kind",
            detected="sight_count",
            frame="sight_frame",
        ),
        "pulses": Terminal({f"ch{n}": f"pulse.s{n}" for n in range(1, SERVOS + 1)}),
        # What drives the board, or is its instrument, is above it.
        **{uart: terminal(down=f"rx.{uart}", up=f"tx.{uart}") for uart in _UARTS},
    }
