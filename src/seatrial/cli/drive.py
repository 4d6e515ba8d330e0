"""``seatrial drive``: drive a VideoRay Pro 4, simulated or real, from a terminal."""

from __future__ import annotations

import signal
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.live import Live

from ..component import Component
from ..cosim.profile import load_profile
from ..errors import INTERRUPTED, SimulationError
from ..links.hardware import allow_devices, allow_network
from ..links.serial_gateway import SerialGateway
from ..links.videoray.topside import Pro4Topside
from .drive_keys import Gamepad, pressed_keys, raw_terminal
from .drive_pilot import Pilot
from .drive_screen import picture
from .show import console

_STEP = 0.01
_PICTURES = 10
"""Steps from one picture to the next."""


def drive(
    link: Annotated[
        str | None, typer.Argument(help="URL of the vehicle's port (default: the profile's).")
    ] = None,
    profile: Annotated[str, typer.Option(help="A profile: a name or a .toml file.")] = "videoray",
    gamepad: Annotated[
        Path | None, typer.Option(help="A gamepad of Linux, such as /dev/input/js0.")
    ] = None,
    record: Annotated[
        Path | None, typer.Option(help="An existing folder for topside.stream.")
    ] = None,
    hardware: Annotated[
        bool, typer.Option("--hardware", help="Allow devices; what is behind them may move.")
    ] = False,
    network: Annotated[
        bool, typer.Option("--network", help="Allow other hosts, and connections from them.")
    ] = False,
) -> None:
    """Drive a VideoRay Pro 4 with keys or a gamepad, and see its heading, depth and attitude."""
    if hardware:
        allow_devices()
    if network:
        allow_network()
    loaded = load_profile(profile)
    topside, gateway = Pro4Topside("topside"), SerialGateway("topside-port")
    _start(topside, {**loaded.parameters("links.topside"), "run_folder": str(record or "")})
    own = loaded.parameters("links.topside-port")
    pad = Gamepad(gamepad) if gamepad else None
    try:
        _start(gateway, {**own, "links": link} if link else own)
        with _terminated(), raw_terminal():
            _run(topside, gateway, Pilot(), pad)
    finally:
        gateway.close()  # sends what stops the thrusters
        topside.close()
        if pad is not None:
            pad.close()


def _start(component: Component, parameters: dict[str, Any]) -> None:
    for name, value in parameters.items():
        component.set(name, value)
    component.setup(0.0)
    component.initialise()
    component.begin()


def _run(topside: Pro4Topside, gateway: SerialGateway, pilot: Pilot, pad: Gamepad | None) -> None:
    begun, steps = time.monotonic(), 0
    with Live(console=console, screen=True, auto_refresh=False) as live:
        while not pilot.quits:
            now = time.monotonic()
            for key in pressed_keys():
                pilot.press(key, now)
            if pad is not None:
                pad.poll(pilot)
            pilot.depth, pilot.heading = topside.get("depth"), topside.get("attitude")[2]
            manual = pilot.manual(now) if pilot.armed else (0.0, 0.0, 0.0)
            _order(topside, pilot, manual)
            connected = topside.get("connected")
            exchange(topside, gateway, steps * _STEP)
            if connected and pilot.armed and not topside.get("connected"):
                pilot.toggle_armed()  # it is not to start again by itself
            if steps % _PICTURES == 0:
                live.update(picture(topside, pilot, manual), refresh=True)
            steps += 1
            late = time.monotonic() - begun - steps * _STEP
            if late > _STEP * _PICTURES:  # it was suspended: what was missed is over
                begun += late
            time.sleep(max(-late, 0.0))


def exchange(topside: Component, gateway: Component, t: float) -> None:
    """Step topside and gateway, connected to each other, from ``t`` on."""
    sent, received = topside.get("tx"), gateway.get("tx")
    topside.set("rx", received)
    gateway.set("rx", sent)
    topside.advance(t, _STEP)
    gateway.advance(t, _STEP)


def _order(topside: Pro4Topside, pilot: Pilot, manual: tuple[float, float, float]) -> None:
    topside.set("armed", pilot.armed)
    topside.set("manual", list(manual))
    for name in ("lights", "camera_tilt", "manipulator", "hold_depth", "hold_heading"):
        topside.set(name, getattr(pilot, name))
    topside.set("depth_wanted", pilot.depth_wanted)
    topside.set("heading_wanted", pilot.heading_wanted)


@contextmanager
def _terminated() -> Iterator[None]:
    """Make a termination signal or a lost terminal end the loop in order, as Ctrl-C does."""

    def end(_number: int, _frame: object) -> None:
        raise SimulationError(INTERRUPTED)

    numbers = [signal.SIGTERM, signal.SIGINT]
    if hasattr(signal, "SIGHUP"):
        numbers.append(signal.SIGHUP)
    before = {number: signal.signal(number, end) for number in numbers}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
