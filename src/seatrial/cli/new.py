"""``seatrial new``: the files of a vehicle of one's own, from templates."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Annotated

import typer
from rich.markup import escape

from ..errors import InputError, unknown
from ..shipped import shipped_folder
from .answer import answer
from .show import console

new_app = typer.Typer(no_args_is_help=True, pretty_exceptions_enable=False)

TEMPLATES = Path(__file__).parents[1] / "templates"
"""A folder per kind of vehicle, laid out as the user's own."""
KINDS = ("usv", "rov")
_PLACEHOLDER = "@NAME@"
_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_-]{0,39}")
_RESERVED = re.compile(r"con|prn|aux|nul|(com|lpt)[0-9]", re.IGNORECASE)
"""Names that Windows keeps for devices."""


@new_app.callback()
def _options() -> None:
    """Write the files of a vehicle of your own."""


@new_app.command()
def vehicle(
    name: Annotated[
        str, typer.Argument(metavar="NAME", help="Letters, digits, '-' and '_', 40 at most.")
    ],
    like: Annotated[
        str, typer.Option(help="'usv': a catamaran, two thrusters; 'rov': eight thrusters.")
    ] = "usv",
) -> None:
    """Write a vehicle that runs at once, its numbers invented, below the current folder."""
    if like not in KINDS:
        raise InputError(f"--like: {unknown('kind of vehicle', like, KINDS)}")
    files = vehicle_files(_checked(name), like)
    _refuse_existing(files)
    for path, text in files.items():
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, "utf-8", newline="\n")
    answer.result = {"files": [str(path) for path in files]}
    _say(name, like, files)


def vehicle_files(name: str, like: str) -> dict[Path, str]:
    """Return the texts of a vehicle's files, by path relative to the user's folder."""
    folder = TEMPLATES / like
    return {
        Path(str(path.relative_to(folder)).replace(_PLACEHOLDER, name)): path.read_text(
            "utf-8"
        ).replace(_PLACEHOLDER, name)
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }


def _checked(name: str) -> str:
    if not _NAME.fullmatch(name) or _RESERVED.fullmatch(name):
        raise InputError(
            f"NAME {name!r}: letters (a to z), digits, '-' and '_' are allowed, 40 at most, the "
            "first a letter or a digit, and no name of a device of Windows, such as 'con'"
        )
    return name


def _refuse_existing(files: dict[Path, str]) -> None:
    """Raise InputError for a file that is there, and for one that would hide a shipped one."""
    folders = {parent for path in files for parent in path.parents}
    there = [path for path in files if path.exists() or path.is_symlink()]
    there += [folder for folder in folders if folder.exists() and not folder.is_dir()]
    if there:
        raise InputError(f"nothing is written, for there is already {_listed(there)}")
    hidden = [path for path in files if _shipped(path).exists()]
    if hidden:
        raise InputError(
            f"nothing is written: seatrial ships {_listed(hidden)}, which yours would hide: take "
            "another name"
        )


def _shipped(path: Path) -> Path:
    return shipped_folder(path.parts[0]).joinpath(*path.parts[1:])


def _listed(paths: list[Path]) -> str:
    return ", ".join(sorted(str(path) for path in paths))


def _say(name: str, like: str, files: dict[Path, str]) -> None:
    """Print what was written, and what to do with it."""
    console.print("wrote")
    for path in files:
        console.print(f"  {escape(str(path))}", soft_wrap=True)
    console.print("every number in them is invented. Next:")
    steps = [
        (f"seatrial run {name}", "a course of waypoints, with criteria"),
        (f"seatrial describe sil --vehicle {name}", "its components and connections"),
        (f"seatrial run {name} --autopilot nmea0183", "the same, with a feed for chart plotters"),
        (f"seatrial run {name}-mission", "for a ground station at UDP port 14550"),
        (f"seatrial run square --vehicle {name} --autopilot ardupilot=PROGRAM", "under ArduPilot"),
    ]
    if like == "usv":
        steps.append((f"seatrial run {name}-sketch", "its Arduino sketch; needs g++"))
    width = max(len(command) for command, _ in steps)
    for command, purpose in steps:
        console.print(f"  {escape(command.ljust(width))}  {purpose}", soft_wrap=True)
