"""``seatrial live`` and ``seatrial run --live``: shown in three dimensions as it runs."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from seatrial.cli.options import (
    Autopilot,
    Choices,
    EngineName,
    Hardware,
    Network,
    Out,
    Settings,
    Vehicle,
    changes_of,
    engine_named,
)
from seatrial.cli.running.run_options import LiveControl, Open, Port
from seatrial.cli.show import console, print_notes, print_reachable
from seatrial.cli.stopping import stoppable
from seatrial.cli.watch import Watch
from seatrial.errors import InputError
from seatrial.links.hardware import allow_devices, allow_network
from seatrial.model.component import NS
from seatrial.system.flattening import load_rig
from seatrial.system.rig import duration_ns
from seatrial.system.system import Engine
from seatrial.trial.files.fault_keys import choices_in
from seatrial.trial.files.trial import Trial
from seatrial.trial.files.trial_file import RecordEntry, TrialFile
from seatrial.trial.running.hooks import Hooks
from seatrial.trial.running.run import Result
from seatrial.trial.running.supervision import run_supervised

from .command_play import show_address, show_refused

if TYPE_CHECKING:
    from .session import Session

_RECORD_NS = NS // 10
"""Simulated time between two rows of a rig that nobody wrote a trial for."""


@dataclass(frozen=True)
class Page:
    """How a run is shown."""

    port: int = 0
    open_: bool = False
    may_command: bool = True


def page_of(port: int, open_: bool, hardware: bool, live_control: bool) -> Page:
    """Return how a run is shown; a page commands what may move only if that is said.

    Raises InputError for --live-control without --hardware.
    """
    if live_control and not hardware:
        raise InputError("--live-control goes with --hardware: a simulation alone obeys the page")
    return Page(port, open_, live_control or not hardware)


def run_watched(trial: Trial, out: Path | None, engine: Engine, hooks: Hooks, page: Page) -> Result:
    """Run a trial with its page, anew with another seed as often as the page wants it."""
    session = _session(page)
    number = 1
    folder = out
    while True:
        with session.of(trial):
            watched = replace(hooks, observer=session.observer)
            result = run_supervised(trial, folder, engine=engine, hooks=watched)
        seed = session.restart_seed
        if seed is None or hooks.stop_requested():
            show_refused(session.refused)
            return result
        console.print(f"begun anew with seed {seed}; so far: {result.folder}", soft_wrap=True)
        trial = trial.changed({"seed": seed}, "the page")
        number += 1
        folder = None if out is None else out.with_name(f"{out.name}-{number}")


def _session(page: Page) -> Session:
    from .session import Session

    announce: Callable[[str], None] = lambda address: show_address(address, page.open_)  # noqa: E731
    return Session(announce, page.port, may_command=page.may_command)


def live(
    rig: Annotated[str, typer.Argument(help="A rig: a name or a file.")],
    settings: Settings = None,
    choices: Choices = None,
    vehicle: Vehicle = None,
    autopilot: Autopilot = None,
    engine: EngineName = "fmu",
    out: Out = None,
    stop: Annotated[
        str, typer.Option("--stop", metavar="TIME", help="Simulated time at which it ends.")
    ] = "3600 s",
    port: Port = 0,
    open_: Open = False,
    hardware: Hardware = False,
    network: Network = False,
    live_control: LiveControl = False,
) -> None:
    """Run a rig in real time and show it in three dimensions, in a browser."""
    chosen = engine_named(engine)
    if hardware:
        allow_devices()
    if network:
        allow_network()
    page = page_of(port, open_, hardware, live_control)
    changes = changes_of(settings, choices, vehicle, autopilot)
    trial = trial_of(rig, stop, changes)
    with stoppable() as stopped, Watch(trial.name) as watch:
        hooks = Hooks(
            building=watch.building,
            progress=watch.progress,
            stop_requested=stopped.requested,
            interruptible=stopped.interruptible,
            reachable=print_reachable,
        )
        result = run_watched(trial, out, chosen, hooks, page)
    print_notes(result.notes)
    console.print(f"{result.status}: {result.folder}", soft_wrap=True)


def trial_of(name: str, stop: str, changes: dict[str, object]) -> Trial:
    """Return a trial of a rig without criteria, recorded ten times a second. Raises InputError."""
    rig = load_rig(name, Path.cwd(), choices_in(changes, "--choose"))
    steps = max(1, math.ceil(_RECORD_NS / rig.step_ns))
    whole = duration_ns(stop, "--stop") // (steps * rig.step_ns) * steps * rig.step_ns
    if whole <= 0:
        raise InputError(f"--stop: {stop!r} is shorter than a step of the rig")
    file = TrialFile(
        title=rig.file.title,
        rig=name,
        stop=f"{whole / NS!r} s",
        record=RecordEntry(every=f"{steps * rig.step_ns / NS!r} s"),
        choices=choices_in(changes, "--choose"),
    )
    return Trial(file, rig.read_from, rig, ()).changed(changes, "--set")
