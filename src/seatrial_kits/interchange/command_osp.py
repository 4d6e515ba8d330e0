"""``seatrial osp``: write system structures of OSP-IS."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from seatrial.cli.options import Autopilot, Choices, Settings, Variant, Vehicle, changes_of
from seatrial.cli.show import console, print_notes

from .export import export_osp

osp_app = typer.Typer(no_args_is_help=True, pretty_exceptions_enable=False)


@osp_app.callback()
def _osp() -> None:
    """Export system structures of OSP-IS, for libcosim."""


@osp_app.command()
def export(
    name: Annotated[
        str, typer.Argument(metavar="NAME", help="A trial or rig: a name, a file or a package.")
    ],
    out: Annotated[
        Path | None,
        typer.Option("--out", "-o", help="The folder (default: NAME-osp in this folder)."),
    ] = None,
    settings: Settings = None,
    variant: Variant = None,
    choices: Choices = None,
    vehicle: Vehicle = None,
    autopilot: Autopilot = None,
) -> None:
    """Write a rig, or a trial with its settings, as an OspSystemStructure.xml with its FMUs."""
    changes = changes_of(settings, choices, vehicle, autopilot)
    folder, notes = export_osp(name, out, variant, changes=changes)
    print_notes(notes)
    console.print(str(folder / "OspSystemStructure.xml"), soft_wrap=True)
