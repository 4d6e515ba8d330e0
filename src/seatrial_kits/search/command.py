"""``seatrial campaign``: a question to a campaign, or one of its cases again."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer
from typer.core import TyperCommand, TyperGroup

from seatrial.cli.answer import answer
from seatrial.cli.options import EngineName, Out, engine_named
from seatrial.cli.show import console, print_verdicts, run_entry
from seatrial.cli.statuses import FAILED
from seatrial.cli.stopping import stoppable
from seatrial.errors import InputError, SimulationError
from seatrial.trial.reports.playing import play
from seatrial.trial.reports.report import write_report
from seatrial.trial.running.hooks import Hooks
from seatrial.trial.running.supervision import run_supervised
from seatrial_kits.campaigns.campaign import INDEX, Campaign, load_campaign
from seatrial_kits.campaigns.cases import Case
from seatrial_kits.campaigns.identity import identity_of, refuse_changed

from .asked_run import asked_run
from .command_ask import ask

_NAME = "CAMPAIGN"
"""Stands for a name in the list of commands."""


class CampaignGroup(TyperGroup):
    """A command of the group, or the name of a campaign: then it is asked."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Put the command first that takes names."""
        if args and args[0] not in (*self.commands, *ctx.help_option_names):
            args = [_NAME, *args]
        return super().parse_args(ctx, args)


class AskCommand(TyperCommand):
    """The command that names stand for: its argument is its own name."""

    def collect_usage_pieces(self, ctx: Any) -> list[str]:
        """Return what follows the name."""
        return [self.options_metavar or ""]


campaign_app = typer.Typer(cls=CampaignGroup, no_args_is_help=True, pretty_exceptions_enable=False)
campaign_app.command(_NAME, cls=AskCommand)(ask)


@campaign_app.callback()
def campaign() -> None:
    """Ask a campaign a question, or run one of its cases again."""


@campaign_app.command()
def rerun(
    name: Annotated[str, typer.Argument(metavar="CAMPAIGN", help="A campaign: a name or a file.")],
    number: Annotated[int, typer.Option("--case", metavar="N", help="Number of the case, from 1.")],
    asked: Annotated[
        Path | None,
        typer.Option("--asked", metavar="FOLDER", help="A question's folder: one of its runs."),
    ] = None,
    of: Annotated[
        Path | None,
        typer.Option(
            "--of", metavar="FOLDER", help="The campaign's folder: refuse files changed since."
        ),
    ] = None,
    engine: EngineName = "fmu",
    out: Out = None,
) -> None:
    """Run one case of a campaign again, with its record and its report."""
    campaign = load_campaign(name)
    if of is not None:
        refuse_changed(of / INDEX, identity_of(campaign))
    case = _case(campaign, asked, number)
    with stoppable() as stop:
        hooks = Hooks(stop_requested=stop.requested, interruptible=stop.interruptible)
        result = run_supervised(case.trial, out, engine=engine_named(engine), hooks=hooks)
        console.print(f"case {number}: {case.name}", soft_wrap=True)
        print_verdicts(result)
        answer.result = {"case": case.name, "set": case.set, "runs": [run_entry(result)]}
        console.print(f"report: {write_report(result.folder, play=play)}", soft_wrap=True)
    if result.status in ("failed", "stopped"):
        raise SimulationError(result.error or "stopped; the signals recorded so far are on disk")
    if not result.passed:
        raise typer.Exit(FAILED)


def _case(campaign: Campaign, asked: Path | None, number: int) -> Case:
    if asked is not None:
        return asked_run(campaign, asked, number)
    cases = campaign.cases()
    if not 1 <= number <= len(cases):
        raise InputError(f"--case: a number from 1 to {len(cases)} is needed, found {number}")
    return cases[number - 1]
