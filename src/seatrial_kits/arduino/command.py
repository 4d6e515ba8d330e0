"""``seatrial sketch``: begin, check, build and run Arduino sketches."""

from __future__ import annotations

import re
import time
from pathlib import Path
from typing import Annotated, Any

import typer

from seatrial.cli.making.templates import checked_name, texts, write
from seatrial.errors import InputError
from seatrial.printable import printable
from seatrial.system.profile.profile import load_profile

from .build import build_host
from .component import Arduino
from .emulator import build_emulator, build_firmware
from .mcus import MCUS, Mcu
from .sources.boards import board_mcu
from .sources.libraries import read_source
from .sources.limits import LIMITS
from .sources.sketch import Sketch, find_sketch
from .sources.target_board import target_text
from .wiring import Wire, read_uarts, read_wires

sketch_app = typer.Typer(no_args_is_help=True, pretty_exceptions_enable=False)

_STEP = 0.02
_SOFT_SERIAL = re.compile(r"\bSoftwareSerial\s+\w+\s*[({]\s*(\d+)\s*,\s*(\d+)")
_SOFT = ("soft_rx", "soft_tx")
_SERIAL = re.compile(r"\bSerial([123]?)\s*\.\s*begin\s*\(\s*(\d*)")
_FOLDER = Annotated[str, typer.Argument(metavar="SKETCH", help="A sketch's folder or .ino.")]
_BACKEND = Annotated[str, typer.Option(help="'host' or 'simavr'.")]
_MCU = Annotated[str, typer.Option(help="atmega2560, atmega328p, esp32, esp32s3 or esp32c3.")]
_PROFILE = Annotated[str, typer.Option(help="PROFILE:LINK whose parameters to use: gloria:mega.")]
_LIBRARIES = Annotated[str, typer.Option(help="Folders of libraries, from the sketch's on; with ;")]
_ENVIRONMENT = Annotated[str, typer.Option(help="Environment of platformio.ini (default_envs).")]
_FLAGS = Annotated[str, typer.Option(help="Options of the compiler, as '-DNAME=VALUE'.")]


@sketch_app.callback()
def _options() -> None:
    """Begin, check, build and run Arduino sketches."""


@sketch_app.command()
def new(
    name: Annotated[
        str, typer.Argument(metavar="NAME", help="Letters, digits, '-' and '_', 40 at most.")
    ],
) -> None:
    """Write a sketch with its profile, rig and trial that run at once, below the current folder."""
    sketch = texts(checked_name(name), "sketch-of", "harness/firmware")
    steps = [
        (f"seatrial run {name}", "on the shipped catamaran"),
        (f"seatrial run {name} --set autopilot.mega.backend=simavr", "its firmware"),
        (f"seatrial sketch check harness/firmware/{name} --profile {name}:mega", "its lines"),
        (f"seatrial sketch run harness/firmware/{name} --profile {name}:mega", "with a terminal"),
        (f"seatrial describe sil --autopilot {name}", "what is connected to it"),
    ]
    write({**sketch, **texts(name, "sketch")}, "replace the sketch by yours", steps)


@sketch_app.command()
def check(
    sketch: _FOLDER,
    profile: _PROFILE = "",
    backend: _BACKEND = "host",
    mcu: _MCU = "",
    libraries: _LIBRARIES = "",
    flags: _FLAGS = "",
    environment: _ENVIRONMENT = "",
) -> None:
    """Check a sketch: its parts, unsupported calls, and its lines against a profile."""
    values = _values(profile, mcu=mcu, libraries=libraries, flags=flags, environment=environment)
    found = _found(sketch, values)
    board = _mcu(sketch, values)
    print(printable(f"{found.name} on the {board.board} ({board.name})"))
    if project := found.project:
        print(printable(f"  environment {project.environment}, board {project.board}"))
        for flag in project.ignored:
            print(printable(f"  flag that changes nothing here: {flag}"))
    for kind, files in (
        ("tab", found.tabs),
        ("source", found.others),
        ("library", found.libraries),
    ):
        for file in files:
            print(printable(f"  {kind} {file}"))
    for wire in read_wires(values.get("wires", ""), board):
        print(printable(f"  {wire}"))
    if target := target_text(found, board.family):
        print(printable(f"  {target}"))
    if _checked_backend(backend) == "host":
        print("what the back end 'host' does not show:")
        for limit in LIMITS[board.family]:
            print(printable(f"  {limit}"))
    problems = _lines(found, values)
    try:
        _built(found, board, backend)
    except InputError as error:
        problems.insert(0, str(error))
    if problems:
        raise InputError("\n".join(problems))
    print(f"it builds for the back end {backend!r}: nothing is unsupported")


@sketch_app.command()
def build(
    sketch: _FOLDER,
    profile: _PROFILE = "",
    backend: _BACKEND = "host",
    mcu: _MCU = "",
    libraries: _LIBRARIES = "",
    flags: _FLAGS = "",
    environment: _ENVIRONMENT = "",
) -> None:
    """Build a sketch, and say where the program or the firmware is."""
    values = _values(profile, mcu=mcu, libraries=libraries, flags=flags, environment=environment)
    found = _found(sketch, values)
    board = _mcu(sketch, values)
    print(_built(found, board, _checked_backend(backend)))


@sketch_app.command()
def run(
    sketch: _FOLDER,
    profile: _PROFILE = "",
    backend: _BACKEND = "host",
    mcu: _MCU = "",
    libraries: _LIBRARIES = "",
    flags: _FLAGS = "",
    environment: _ENVIRONMENT = "",
    seconds: Annotated[float, typer.Option(help="How long.")] = float("inf"),
) -> None:
    """Run a sketch in real time, each UART at a pseudo-terminal that any terminal program opens.

    Its sensors rest: for a boat around it, run a rig. Ends with Ctrl-C.
    """
    board = Arduino(Path(sketch).stem)
    values = _values(profile, mcu=mcu, libraries=libraries, flags=flags, environment=environment)
    values |= {"backend": _checked_backend(backend), "sketch": sketch}
    if not profile and (opened := _opened(_found(sketch, values))):
        values["uarts"] = opened
    for name, value in values.items():
        board.set(name, value)
    listened = read_uarts(board.uarts)
    board.set("monitors", " ".join(f"{uart}=pty" for uart in listened))
    board.initialise()
    board.begin()
    try:
        for uart, place in zip(listened, board.get("reached_at").split(), strict=True):
            print(f"UART {uart}: {place}", flush=True)
        begun, steps = time.monotonic(), 0
        while steps * _STEP < seconds:
            board.advance(steps * _STEP, _STEP)
            steps += 1
            time.sleep(max(0.0, begun + steps * _STEP - time.monotonic()))
    except KeyboardInterrupt:
        print("ended")
    finally:
        board.close()


def _mcu(place: str, values: dict[str, Any]) -> Mcu:
    """Return the microcontroller of a sketch's board; keep it in the values."""
    found = board_mcu(place, values.get("environment", ""), values["mcu"])
    values["mcu"] = found.name
    return found


def _built(sketch: Sketch, board: Mcu, backend: str) -> Path:
    """Return a sketch's program or firmware, built."""
    if backend == "host":
        return build_host(sketch, board)
    build_emulator(board)
    return build_firmware(sketch, board)


def _opened(sketch: Sketch) -> str:
    """Return the UARTs that a sketch opens at rates written as numbers, as `uarts` has it."""
    found = {
        int(match[1] or 0): match[2]
        for file in (*sketch.tabs, *sketch.others)
        for match in _SERIAL.finditer(read_source(file))
        if match[2]
    }
    return "; ".join(f"{uart} {rate}" for uart, rate in sorted(found.items()))


def _checked_backend(backend: str) -> str:
    if backend not in ("host", "simavr"):
        raise InputError(f"back end {backend!r}: 'host' or 'simavr' is needed")
    return backend


def _found(sketch: str, values: dict[str, Any]) -> Sketch:
    given = (str(values.get(name, "")) for name in ("libraries", "flags", "environment"))
    return find_sketch(sketch, *given)


def _values(profile: str, **given: str) -> dict[str, Any]:
    """Return the parameters of a profile's board, as PROFILE:LINK says, with those given."""
    values: dict[str, Any] = {}
    if profile:
        name, _, link = profile.rpartition(":")
        if not name:
            raise InputError(f"--profile {profile!r} is not PROFILE:LINK, as gloria:mega")
        values = load_profile(name).parameters(f"links.{link}")
        if not values.keys() <= Arduino.ports.keys():
            raise InputError(f"{profile} is not a link of the kind 'arduino'")
    values = {"mcu": "atmega2560", **values, **{k: v for k, v in given.items() if v}}
    if values["mcu"] not in MCUS:
        raise InputError(f"mcu {values['mcu']!r}: {' or '.join(MCUS)} is needed")
    return values


def _lines(sketch: Sketch, values: dict[str, Any]) -> list[str]:
    """Return the lines that the sketch opens and the board or the profile has not."""
    wires = read_wires(values.get("wires", ""), MCUS[values["mcu"]])
    problems = []
    for file in (*sketch.tabs, *sketch.others):
        for number, line in enumerate(read_source(file).splitlines(), 1):
            code, place = line.split("//")[0], f"{file}:{number}"
            for match in _SERIAL.finditer(code):
                problems += [f"{place}: {each}" for each in _no_uart(int(match[1] or 0), values)]
            for match in _SOFT_SERIAL.finditer(code) if "uarts" in values else ():
                rx, tx = int(match[1]), int(match[2])
                problems += [f"{place}: {each}" for each in _no_pins(rx, tx, wires)]
    return problems


def _no_pins(rx: int, tx: int, wires: list[Wire]) -> list[str]:
    """Return which pins of a UART in software have no line of a profile."""
    lines = {wire.kind: wire for wire in wires if wire.place in (rx, tx)}
    if not any(kind in lines for kind in _SOFT):
        return [
            f"the profile has no line at pins {rx} and {tx}: "
            f"wires of '{rx} soft_rx 1; {tx} soft_tx 1' bring that of UART 1 there"
        ]
    problems = []
    for kind, pin, does in (("soft_rx", rx, "reads"), ("soft_tx", tx, "writes")):
        at = [wire.place for wire in wires if wire.kind == kind]
        if at and pin not in at:
            there = " and ".join(map(str, at))
            problems.append(f"it {does} at pin {pin}, and {kind} of the profile is at pin {there}")
    return problems


def _no_uart(uart: int, values: dict[str, Any]) -> list[str]:
    if uart >= MCUS[values["mcu"]].uarts:
        return [f"this board has no UART {uart}"]
    if "uarts" in values and uart not in read_uarts(values["uarts"]):
        return [f"the profile has no line at UART {uart}"]
    return []
