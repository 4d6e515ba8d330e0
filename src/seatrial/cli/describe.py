"""``seatrial describe``: what a rig is made of, and every connection in it."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from rich.markup import escape

from ..cosim.assembly import assemble
from ..cosim.flattening import load_rig
from ..cosim.packages import is_package, read_package
from ..cosim.paths import joined
from ..cosim.rig import Rig, Scope
from ..cosim.system import Joint, System
from ..cosim.unread import leave_out_unread
from ..trials.naming import by_path, named_components
from ..trials.trial import choices_in, is_trial, load_trial
from .options import Autopilot, Choices, Vehicle, changes_of
from .show import console, print_notes


def describe(
    rig: Annotated[str, typer.Argument(help="A rig or a trial: a name, a file or a package.")],
    choices: Choices = None,
    vehicle: Vehicle = None,
    autopilot: Autopilot = None,
) -> None:
    """Show a rig's components, rigs inside it, every connection, and what is left open."""
    changes = changes_of(None, choices, vehicle, autopilot)
    if is_package(rig) and not changes:  # no trial: it may name no stop time
        package = read_package(Path(rig).resolve(), {})
        print_notes(package.notes)
        trial, loaded = None, package.rig
    else:
        trial = load_trial(rig, changes=changes, origin="--choose") if is_trial(rig) else None
        loaded = trial.rig if trial else load_rig(rig, None, choices_in(changes, "--choose"))
    system = assemble(loaded, "direct" if _in_process(loaded) else "fmu")
    try:
        named = (
            named_components(by_path(trial.scheduled(system), system), system) if trial else set()
        )
        leave_out_unread(system, named)
        _print_rig(system)
    finally:
        system.free()


def _in_process(rig: Rig) -> bool:
    """Say if all components can be shown without making or opening an FMU."""
    return not any(
        placed.entry.fmu.endswith(".fmu") or placed.entry.isolated
        for placed in rig.components.values()
    )


def _print_rig(system: System) -> None:
    top = system.rig.top
    console.print(f"[bold]{escape(top.file.title or top.read_from.name)}[/bold]")
    for name, value in top.choices.items():
        console.print(f"  {escape(name)} = {escape(value)}", soft_wrap=True)
    _print_components(top, "", system.left_out)
    width = max((len(joint.source) for joint in system.joints), default=0)
    lines = [
        f"{joint.source:{width}} -> {joint.target}{_transformed(joint)}" for joint in system.joints
    ]
    _print_list(f"{len(lines)} connections", lines)
    _print_list("not made", system.open)
    _print_list("inputs that nothing feeds", system.unconnected_inputs())
    optional = system.unconnected_inputs(optional=True)
    _print_list("optional inputs that nothing feeds", optional)
    shown = [f"{name} = {value!r}" for name, value in top.file.shows.items()]
    _print_list("shows", shown)


def _transformed(joint: Joint) -> str:
    if (joint.factor, joint.offset) == (1.0, 0.0):
        return ""
    return f"  (times {joint.factor:g}" + (f", plus {joint.offset:g})" if joint.offset else ")")


def _print_components(scope: Scope, indent: str, left_out: list[str]) -> None:
    for name, entry in scope.file.components.items():
        if name not in scope.inner:
            out = "  (left out: nothing reads it)" if joined(scope.path, name) in left_out else ""
            console.print(f"{indent}  {escape(name)}: {escape(entry.what)}{out}", soft_wrap=True)
            continue
        inner = scope.inner[name]
        title = inner.file.title or inner.read_from.name
        console.print(f"{indent}  [bold]{escape(name)}[/bold]: {escape(title)}", soft_wrap=True)
        _print_components(inner, f"{indent}  ", left_out)


def _print_list(title: str, lines: list[str]) -> None:
    if lines:
        console.print(f"\n[bold]{title}[/bold]")
    for line in lines:
        console.print(f"  {escape(line)}", soft_wrap=True)
