"""``seatrial drive``: drive a VideoRay Pro 4, simulated or real, from a terminal."""

from __future__ import annotations

import os
import time
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.live import Live

from seatrial.cli.options import Hardware, Network
from seatrial.cli.show import console
from seatrial.cli.stopping import stoppable
from seatrial.errors import INTERRUPTED, InputError, SeatrialError, SimulationError
from seatrial.links.hardware import allow_devices, allow_network
from seatrial.links.serial_gateway import SerialGateway
from seatrial.model.component import Component
from seatrial.system.profile.profile import Profile, load_profile
from seatrial.trial.running.call_trace import IN_REAL_TIME
from seatrial.trial.running.forked import Forked
from seatrial.trial.running.forked_child import Child
from seatrial.trial.running.link import Frame

from ..frame import encode
from ..station import NEUTRAL
from ..topside import Pro4Topside
from .keys import Gamepad, pressed_keys, raw_terminal, restored_terminal
from .pilot import Pilot
from .screen import picture

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
    hardware: Hardware = False,
    network: Network = False,
) -> None:
    """Drive a VideoRay Pro 4 with keys or a gamepad, and see its heading, depth and attitude."""
    if hardware:
        allow_devices()
    if network:
        allow_network()
    loaded = load_profile(profile)
    if not hasattr(os, "fork"):
        _drive(loaded, link, record, gamepad, None)
        return

    def driven(child: Child) -> None:
        try:
            with child.interruptible():
                _drive(loaded, link, record, gamepad, child)
            child.link.send("done", "", "")
        except KeyboardInterrupt:
            child.link.send("error", SimulationError.__name__, INTERRUPTED)
        except SeatrialError as error:
            child.link.send("error", type(error).__name__, str(error))
        except BaseException as error:
            child.link.send("error", SimulationError.__name__, repr(error))

    forked = Forked(driven)
    forked.call_trace.limits, forked.call_trace.devices = IN_REAL_TIME, int(hardware)
    _supervised(forked)


def _supervised(forked: Forked) -> None:
    """Wait for the end of a drive; the terminal, and the vehicle, are left as they should be."""
    outcome: Frame | None = None
    with stoppable() as stop, restored_terminal():
        try:
            while (frames := forked.frames(2 * stop.requested())) is not None:
                outcome = frames[-1] if frames else outcome
            how = forked.how()  # which the end below forgets
        finally:
            forked.end(2)
    if outcome is None:
        raise SimulationError("; ".join([f"the process of the drive {how}", *forked.sent]))
    kind, name, text = outcome
    if kind == "error":
        raise InputError(text) if name == InputError.__name__ else SimulationError(text)


def _drive(
    loaded: Profile,
    link: str | None,
    record: Path | None,
    gamepad: Path | None,
    child: Child | None,
) -> None:
    """Drive until the pilot quits; a port without a safe state gets the protocol's own."""
    topside, gateway = Pro4Topside("topside"), SerialGateway("topside-port")
    _start(topside, {**loaded.parameters("links.topside"), "run_folder": str(record or "")})
    neutral = encode(replace(NEUTRAL, id=int(topside.node_id)))
    own = {"safe_state": neutral.hex(), **loaded.parameters("links.topside-port")}
    pad = Gamepad(gamepad) if gamepad else None
    try:
        _start(gateway, {**own, "links": link} if link else own)
        with raw_terminal():
            _run(topside, gateway, Pilot(), pad, child)
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


def _run(
    topside: Pro4Topside,
    gateway: SerialGateway,
    pilot: Pilot,
    pad: Gamepad | None,
    child: Child | None,
) -> None:
    begun, steps = time.monotonic(), 0
    if child is not None:
        child.begun()
    with Live(console=console, screen=True, auto_refresh=False) as live:
        while not pilot.quits:
            now = time.monotonic()
            if child is not None:
                child.asked()  # the keeper sees that it goes on
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
