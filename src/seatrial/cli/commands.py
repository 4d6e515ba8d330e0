"""The commands by name, the core's and those of kits. No module of one is imported."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from pkgutil import resolve_name
from typing import Any, NamedTuple

import typer
from typer.core import TyperCommand, TyperGroup

from ..errors import InputError, SimulationError
from ..kits import kits
from .starting import ending_at_once


class Command(NamedTuple):
    """A command, or a group of commands."""

    place: str
    """``module:object``; the object is a function or a Typer application."""
    help: str
    """The first line of the function's docstring."""


@cache
def _own() -> dict[str, Any]:
    return tomllib.loads(Path(__file__).with_name("commands.toml").read_text("utf-8"))


def commands() -> dict[str, Command]:
    """Return every command by name; of a name that two have, the first: `loaded` refuses it."""
    found = {n: Command(row["call"], row["help"]) for n, row in _own()["commands"].items()}
    for entry in kits().entries("commands"):
        found.setdefault(entry.name, Command(entry.target, entry.text))
    return {name: found[name] for name in sorted(found, key=_place)}


_FIRST = ("run", "campaign", "convergence", "list", "describe", "new", "report", "compare")


def _place(name: str) -> tuple[int, str]:
    """Return where a command stands in the listing: those that everybody needs come first."""
    return (_FIRST.index(name) if name in _FIRST else len(_FIRST), name)


class LazyGroup(TyperGroup):
    """The group of all commands: lists them from the table, and imports the one that is run."""

    def __init__(self, **attributes: Any) -> None:
        super().__init__(**attributes)
        self.commands.update(
            {name: TyperCommand(name, help=command.help) for name, command in commands().items()}
        )

    def invoke(self, ctx: Any) -> Any:
        """Run the command; for a pipe that breaks, Typer would have the status of a verdict."""
        try:
            return super().invoke(ctx)
        except BrokenPipeError as error:
            raise SimulationError(f"cannot write: {error.strerror}") from None

    def resolve_command(self, ctx: Any, args: list[str]) -> tuple[str | None, Any, list[str]]:
        """Return the command that ``args`` begin with, imported, and its own arguments."""
        name, found, rest = super().resolve_command(ctx, args)
        return name, found if name is None else loaded(name), rest


def loaded(name: str) -> Any:
    """Return the command ``name`` with its options, imported.

    Raises InputError for a name that two have; other commands are not affected.
    """
    entry = commands()[name]
    for other in kits().entries("commands"):
        if other.name == name and other.target != entry.place:
            raise InputError(
                f"the command {name!r} is {entry.place} and, of the kit {other.kit}, {other.target}"
            )
    with ending_at_once():
        found = resolve_name(entry.place)
    parent = typer.Typer(rich_markup_mode=None)
    if isinstance(found, typer.Typer):
        parent.add_typer(found, name=name, help=entry.help)
    else:
        parent.command(name)(found)
    from .answer import with_options

    return _with_examples(
        with_options(typer.main.get_group(parent).commands[name]), name, examples()
    )


def examples() -> dict[str, str]:
    """Return an example by command, its group first."""
    of_kits = {name: text for kit in kits().found for name, text in kit.examples.items()}
    return {**_own()["examples"], **of_kits}


def _with_examples(command: Any, path: str, examples: Mapping[str, str]) -> Any:
    """Return a command whose help, and that of those below, ends with an example."""
    if path in examples:
        command.epilog = f"Example: {examples[path]}"
    for name, below in getattr(command, "commands", {}).items():
        _with_examples(below, f"{path} {name}", examples)
    return command
