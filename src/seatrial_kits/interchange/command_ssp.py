"""``seatrial ssp``: write SSP packages, and check them for other tools."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer
from rich.markup import escape

from seatrial.cli.answer import answer
from seatrial.cli.options import Autopilot, Choices, Settings, Variant, Vehicle, changes_of
from seatrial.cli.show import console, print_notes
from seatrial.errors import InputError, unknown

from .export import export_ssp
from .ssp.reading import read_ssp
from .ssp.shapes import Version
from .ssp.tools import TOOLS, findings

_VERSIONS: dict[str, Version] = {"1.0": "1.0", "2.0": "2.0"}

ssp_app = typer.Typer(no_args_is_help=True, pretty_exceptions_enable=False)


@ssp_app.command()
def export(
    name: Annotated[
        str, typer.Argument(metavar="NAME", help="A trial or rig: a name or a .toml file.")
    ],
    out: Annotated[
        Path | None,
        typer.Option("--out", "-o", help="The package (default: NAME.ssp in this folder)."),
    ] = None,
    settings: Settings = None,
    variant: Variant = None,
    choices: Choices = None,
    vehicle: Vehicle = None,
    autopilot: Autopilot = None,
    tool: Annotated[
        str | None, typer.Option("--for", help=f"A tool that must take it: {', '.join(TOOLS)}.")
    ] = None,
    version: Annotated[
        str, typer.Option(help="Version of SSP: 1.0, or 2.0 with the types and arrays of FMI 3.")
    ] = "1.0",
) -> None:
    """Write a rig, or a trial with its settings, as an SSP package.

    Rigs inside rigs are systems inside systems. For a tool that takes none of these, all
    components stand in one system.
    """
    _refuse_unknown(tool)
    changes = changes_of(settings, choices, vehicle, autopilot)
    path, notes = export_ssp(
        name, out, variant, changes=changes, tool=tool, version=_version(version)
    )
    print_notes(notes)
    answer.result = {"file": str(path)}
    console.print(f"{path}  ({path.stat().st_size / 1000:.0f} kB)", soft_wrap=True)


@ssp_app.command()
def check(
    package: Annotated[Path, typer.Argument(metavar="FILE", help="An SSP package.")],
    tool: Annotated[
        str | None, typer.Option("--for", help=f"One tool: {', '.join(TOOLS)}; default: all.")
    ] = None,
    strict: Annotated[
        bool, typer.Option("--strict", help="Reject also what seatrial notes and passes over.")
    ] = False,
) -> None:
    """Say what seatrial and other tools reject or ignore in a package; status 1 if any rejects."""
    _refuse_unknown(tool)
    if strict and tool is not None:
        raise InputError("--strict is about seatrial's own reader: it has no effect with --for")
    found = [one for one in findings(package) if tool in (None, one.tool)]
    rejected = _own_view(package, strict) if tool is None else False
    for one in TOOLS if tool is None else (tool,):
        mine = [finding for finding in found if finding.tool == one]
        console.print(f"[bold]{one}[/bold]: {'' if mine else 'nothing found'}", soft_wrap=True)
        for finding in mine:
            mark = "[red]rejects[/red]" if finding.rejects else "[yellow]differs[/yellow]"
            console.print(
                f"  {mark}  {escape(finding.where)}: {escape(finding.text)}", soft_wrap=True
            )
    answer.result = {"rejected": rejected, "findings": [asdict(one) for one in found]}
    if rejected or any(one.rejects for one in found):
        raise typer.Exit(1)


def _version(text: str) -> Version:
    if text not in _VERSIONS:
        raise InputError(f"--version: 1.0 or 2.0 is needed, found {text!r}")
    return _VERSIONS[text]


def _refuse_unknown(tool: str | None) -> None:
    if tool is not None and tool not in TOOLS:
        raise InputError(f"--for: {unknown('tool', tool, TOOLS)}")


def _own_view(package: Path, strict: bool) -> bool:
    """Show what seatrial says of a package; return whether it rejects it."""
    try:
        notes = read_ssp(package.resolve(), strict=strict).notes
    except InputError as error:
        console.print("[bold]seatrial[/bold]:", soft_wrap=True)
        for line in str(error).splitlines():
            console.print(f"  [red]rejects[/red]  {escape(line)}", soft_wrap=True)
        return True
    console.print(f"[bold]seatrial[/bold]: {'' if notes else 'nothing found'}", soft_wrap=True)
    print_notes(notes)
    return False
