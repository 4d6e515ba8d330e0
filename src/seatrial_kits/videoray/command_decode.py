"""``seatrial decode``: recorded streams as text."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Annotated

import typer

from seatrial.printable import printable

from . import registers as csr
from .frame import BROADCAST, GROUP_BIT, PRO4, READ_BIT, VRCSR, Frame
from .identity import read_config
from .node import MANIPULATOR, MANIPULATOR_COMMANDS
from .parser import Parser
from .replies import Reading, read, read_memory
from .stream_file import Piece, read_stream
from .vrcsr import read_health

decode_app = typer.Typer(no_args_is_help=True, pretty_exceptions_enable=False)


@decode_app.callback()
def _options() -> None:
    """Show what a recorded stream says."""


@decode_app.command()
def videoray(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="A recorded stream, NAME.stream.")],
) -> None:
    """Show the frames of a VideoRay stream, PRO4 and VRCSR, one a line."""
    for line in describe_stream(read_stream(file)):
        print(printable(line))


_NS = 1_000_000_000
_TIMEOUT_NS = 50_000_000
_OFF = ("auto_depth_target", "auto_heading_target")
_MANIPULATOR = {0: "stop", -1: "close", 1: "open"}


def describe_stream(pieces: Iterable[Piece]) -> Iterator[str]:
    """Yield a line per frame of a recorded stream, and one for each count of broken bytes."""
    parsers = {way: Parser(_TIMEOUT_NS, (PRO4, VRCSR)) for way in "><"}
    broken = dict.fromkeys(parsers, 0)
    for time_ns, way, data in pieces:
        parser = parsers[way]
        for _, frame in parser.feed(data, time_ns):
            yield f"{_seconds(time_ns)} {way} {describe(frame)}"
        errors = parser.checksum_errors + parser.broken_off
        if errors > broken[way]:
            yield f"{_seconds(time_ns)} {way} ! {errors - broken[way]} broken"
            broken[way] = errors


def describe(frame: Frame) -> str:
    """Return one line that describes a frame."""
    return _response(frame) if frame.is_response else _request(frame)


def _request(frame: Frame) -> str:
    parts = [f"to {_name(frame.id)}:", _written(frame)]
    if frame.flags & READ_BIT:
        count = frame.flags & ~READ_BIT
        until = f"{count} bytes" if count else "all"
        parts.append(f"read {until} from 0x{frame.address:02X}")
    elif frame.flags:
        parts.append(f"reply {frame.flags}")
    return " ".join(filter(None, parts))


def _written(frame: Frame) -> str:
    data = frame.payload
    if not data:
        return ""
    if frame.address == csr.CUSTOM_COMMAND:
        if frame.id == MANIPULATOR and len(data) == 8 and data[6] in MANIPULATOR_COMMANDS:
            return f"manipulator {_MANIPULATOR[MANIPULATOR_COMMANDS[data[6]]]}"
        return f"custom command {data.hex(' ').upper()}"
    if frame.address >= csr.TOP:
        return f"write 0x{frame.address:02X}: {data.hex(' ').upper()}"
    return f"write {_values(read_memory(frame.address, data[: csr.TOP - frame.address]))}"


def _response(frame: Frame) -> str:
    head = f"from {_name(frame.id)}:"
    health = read_health(frame)
    if health is not None:
        return (
            f"{head} {health.rpm:.0f} rpm {health.voltage:.1f} V {health.current:.2f} A "
            f"{health.temperature:.1f} degC fault {health.fault}"
        )
    data = frame.payload[1:]
    if frame.flags == READ_BIT and frame.address < csr.TOP:
        return f"{head} {_values(read_memory(frame.address, data))}"
    if frame.flags == READ_BIT and frame.address == csr.CONFIG and len(data) >= 292:
        serial, boards = read_config(data)
        named = " ".join(f"{name}={board}" for name, board in boards.items())
        return f"{head} serial number {serial}, {named}"
    reading = read(frame.flags, data)
    if reading is not None:
        return f"{head} reply {frame.flags}: {_values(reading)}"
    return f"{head} flags 0x{frame.flags:02X} from 0x{frame.address:02X}: {data.hex(' ').upper()}"


def _values(reading: Reading) -> str:
    parts = []
    for name, number in reading.values.items():
        unit = csr.BY_NAME[name].unit
        if name in _OFF and number == csr.OFF:
            parts.append(f"{name}=off")
        else:
            parts.append(f"{name}={number:.6g}{'' if unit == '1' else unit}")
    return " ".join(parts)


def _name(node: int) -> str:
    if node == BROADCAST:
        return "all"
    if node & GROUP_BIT:
        return f"group {node & ~GROUP_BIT}"
    return "manipulator" if node == MANIPULATOR else f"node {node}"


def _seconds(time_ns: int) -> str:
    return f"{time_ns // _NS}.{time_ns % _NS // 1000:06}"
