"""Options that several commands share, and what is made of them."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..errors import InputError
from ..files.reading import toml_content
from ..shipped import available
from .show import MOST_SHOWN

if TYPE_CHECKING:
    from ..system.system import Engine

Settings = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Set component.port, or a trial's key."),
]
Choices = Annotated[
    list[str] | None,
    typer.Option("--choose", metavar="NAME=VALUE", help="Make one of the rig's choices."),
]
Vehicle = Annotated[
    str | None, typer.Option("--vehicle", metavar="NAME", help="Short for --choose vehicle=NAME.")
]
Autopilot = Annotated[
    str | None,
    typer.Option(
        "--autopilot",
        metavar="NAME[=PROGRAM]",
        help="Short for --choose autopilot=NAME, and program=PROGRAM, which it starts.",
    ),
]
Faults = Annotated[
    list[str] | None,
    typer.Option(
        "--fault",
        metavar="PLACE=FAULT,KEY=VALUE",
        help="Let something fail, such as 'gnss=off, at=10 s, for=5 s'; as faults of a trial.",
    ),
]
EngineName = Annotated[
    str,
    typer.Option(
        "--engine",
        help="'fmu': every component is an FMU; 'direct': in process; 'native': an FMU in C where "
        "there is one, else in process.",
    ),
]
Out = Annotated[
    Path | None,
    typer.Option("--out", "-o", help="Folder of the run (default: runs/NAME-DATE-TIME)."),
]
LogColumns = Annotated[
    list[str] | None,
    typer.Option(
        "--columns",
        metavar="WHAT=NAME[:UNIT],...",
        help="Columns or channels of a log by quantity; -NAME is of opposite sign.",
    ),
]
LogFormat = Annotated[
    str | None,
    typer.Option("--format", metavar="NAME", help="Format of a log (default: by its content)."),
]
Hardware = Annotated[
    bool, typer.Option("--hardware", help="Allow devices; equipment behind them may move.")
]
Network = Annotated[
    bool, typer.Option("--network", help="Allow other hosts, and connections from them.")
]
Variant = Annotated[
    str | None, typer.Option("--variant", help="Variant of the vehicle's parameters.")
]
Match = Annotated[str, typer.Option("--match", help="Only those of this name, such as 'wing.*'.")]
Every = Annotated[
    bool, typer.Option("--all", help=f"All of a list; default: its first {MOST_SHOWN}.")
]


def engine_named(name: str) -> Engine:
    """Return the engine that ``--engine`` names. Raises InputError."""
    from ..system.system import ENGINES

    for engine in ENGINES:
        if name == engine:
            return engine
    raise InputError(f"--engine: 'fmu', 'direct' or 'native' is needed, found {name!r}")


def changes_of(
    settings: list[str] | None,
    choices: list[str] | None = None,
    vehicle: str | None = None,
    autopilot: str | None = None,
) -> dict[str, Any]:
    """Return what the command line changes in a trial, by key. Raises InputError.

    ``autopilot`` is a name, or NAME=PROGRAM for one that starts a program of the user's.
    """
    changes = dict(setting(text) for text in settings or [])
    for text in choices or []:
        name, equals, value = text.partition("=")
        if not equals or not name or not value:
            raise InputError(f"--choose: NAME=VALUE is needed, found {text!r}")
        changes[f"choices.{name.strip()}"] = value.strip()
    autopilot, equals, program = (autopilot or "").partition("=")
    if equals and not (autopilot and program):
        raise InputError(f"--autopilot: NAME or NAME=PROGRAM is needed, found {equals + program!r}")
    named = {
        "choices.vehicle": vehicle,
        "choices.autopilot": autopilot or None,
        "choices.program": program or None,
    }
    return {**changes, **{key: value for key, value in named.items() if value is not None}}


def setting(text: str) -> tuple[str, Any]:
    """Return ``KEY=VALUE`` parsed: a number, a list, true or false as in TOML; else a text."""
    key, equals, value = text.partition("=")
    if not equals or not key:
        raise InputError(f"--set: KEY=VALUE is needed, found {text!r}")
    plain = value.strip()
    if plain.lstrip("+-") in ("nan", "inf"):  # TOML takes these words for numbers
        return key.strip(), plain
    try:
        return key.strip(), toml_content(f"x = {value}".encode(), text)["x"]
    except (InputError, UnicodeEncodeError):
        return key.strip(), plain


def is_campaign(name: str) -> bool:
    """Say if ``name`` is a campaign: a name, or a file that lists trials."""
    if name.endswith(".toml"):
        path = Path(name)
        return path.is_file() and "trials" in _top_keys(path)
    return name in available("harness/campaigns") and name not in available("harness/trials")


def _top_keys(path: Path) -> set[str]:
    try:
        return set(toml_content(path.read_bytes(), str(path)))
    except (InputError, OSError):
        return set()  # the reader of the trial will say what is wrong
