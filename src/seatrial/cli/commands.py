"""The commands by name: where each is, and its line in the listing. No module is imported."""

from __future__ import annotations

from importlib import import_module
from typing import Any, NamedTuple

import typer
from typer.core import TyperCommand, TyperGroup

from ..errors import SimulationError
from .starting import ending_at_once


class Command(NamedTuple):
    """A command, or a group of commands."""

    place: str
    """``module:object`` in this package; the object is a function or a Typer application."""
    help: str
    """The first line of the function's docstring."""


COMMANDS = {
    "run": Command("run:run", "Run a trial, or a campaign of trials, and say what holds."),
    "campaign": Command(
        "campaign:campaign_app", "Ask a campaign a question, or run one of its cases again."
    ),
    "convergence": Command(
        "convergence:convergence",
        "Halve a trial's communication step: order and error of each output; status 1 if erratic.",
    ),
    "list": Command(
        "listing:list_all",
        "List trials, campaigns, rigs, vehicles, profiles, experiments and FMUs by name.",
    ),
    "describe": Command(
        "describe:describe",
        "Show a rig's components, rigs inside it, every connection, and what is left open.",
    ),
    "new": Command("new:new_app", "Write the files of a vehicle of your own."),
    "report": Command("report:report", "Write the report of a run again."),
    "compare": Command(
        "compare:compare", "Compare two runs signal by signal; status 1 if their signals differ."
    ),
    "design": Command(
        "design:design",
        "Design a heading autopilot: poles over the gain, gains for a damping ratio, stability.",
    ),
    "doctor": Command(
        "doctor:doctor",
        "Show what works on this machine, what is missing, and how to fix it.",
    ),
    "drive": Command(
        "drive:drive",
        "Drive a VideoRay Pro 4 with keys or a gamepad, and see its heading, depth and attitude.",
    ),
    "estimate": Command(
        "estimate:estimate",
        "Estimate the damping of a hull from its dimensions, as lines of a vehicle file too.",
    ),
    "export": Command(
        "export:export", "Write the record of a run as MCAP, Parquet or a ROS 2 bag."
    ),
    "identify": Command(
        "identify:identify",
        "Identify an axis of a vehicle from a log; status 1 if the model is to be rejected.",
    ),
    "plan": Command(
        "plan:plan",
        "Plan a vessel's motion from wanted speeds; status 1 if its thrusters cannot do it.",
    ),
    "play": Command("play:play", "Play a run back in three dimensions, in a browser."),
    "live": Command(
        "live:live", "Run a rig in real time and show it in three dimensions, in a browser."
    ),
    "fmu": Command("fmu:fmu_app", "List, build, check, describe and survey FMUs."),
    "profile": Command("profile:profile_app", "Check and describe profiles of electronics."),
    "decode": Command("decode:decode_app", "Show recorded streams as text."),
    "sketch": Command("sketch:sketch_app", "Begin, check, build and run Arduino sketches."),
    "osp": Command("osp:osp_app", "Export system structures of OSP-IS, for libcosim."),
    "ssp": Command("ssp:ssp_app", "Export and check SSP packages."),
}


class LazyGroup(TyperGroup):
    """The group of all commands: lists them from the table, and imports the one that is run."""

    def __init__(self, **attributes: Any) -> None:
        super().__init__(**attributes)
        self.commands.update(
            {name: TyperCommand(name, help=command.help) for name, command in COMMANDS.items()}
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
    """Return the command ``name`` with its options, imported."""
    module, _, attribute = COMMANDS[name].place.partition(":")
    with ending_at_once():
        found = getattr(import_module(f".{module}", __package__), attribute)
    parent = typer.Typer(rich_markup_mode=None)
    if isinstance(found, typer.Typer):
        parent.add_typer(found, name=name, help=COMMANDS[name].help)
    else:
        parent.command(name)(found)
    from .answer import with_options

    return with_options(typer.main.get_group(parent).commands[name])
