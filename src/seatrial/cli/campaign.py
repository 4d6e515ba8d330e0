"""``seatrial campaign``: one case of a campaign again."""

from __future__ import annotations

from typing import Annotated

import typer

from ..errors import InputError, SimulationError
from ..trials.campaign import load_campaign
from ..trials.hooks import Hooks
from ..trials.report import write_report
from ..trials.supervision import run_supervised
from .answer import answer
from .options import EngineName, Out, engine_named
from .show import console, print_verdicts, run_entry
from .statuses import FAILED
from .stopping import stoppable

campaign_app = typer.Typer(no_args_is_help=True, pretty_exceptions_enable=False)


@campaign_app.callback()
def campaign() -> None:
    """Run a case of a campaign again."""


@campaign_app.command()
def rerun(
    name: Annotated[str, typer.Argument(metavar="CAMPAIGN", help="A campaign: a name or a file.")],
    number: Annotated[int, typer.Option("--case", metavar="N", help="Number of the case, from 1.")],
    engine: EngineName = "fmu",
    out: Out = None,
) -> None:
    """Run one case of a campaign again, with its record and its report."""
    cases = load_campaign(name).cases()
    if not 1 <= number <= len(cases):
        raise InputError(f"--case: a number from 1 to {len(cases)} is needed, found {number}")
    case = cases[number - 1]
    with stoppable() as stop:
        hooks = Hooks(stop_requested=stop.requested, interruptible=stop.interruptible)
        result = run_supervised(case.trial, out, engine=engine_named(engine), hooks=hooks)
        console.print(f"case {number}: {case.name}", soft_wrap=True)
        print_verdicts(result)
        answer.result = {"case": case.name, "set": case.set, "runs": [run_entry(result)]}
        console.print(f"report: {write_report(result.folder)}", soft_wrap=True)
    if result.status in ("failed", "stopped"):
        raise SimulationError(result.error or "stopped; the signals recorded so far are on disk")
    if not result.passed:
        raise typer.Exit(FAILED)
