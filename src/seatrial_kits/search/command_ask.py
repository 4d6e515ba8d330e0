"""``seatrial campaign NAME --ask QUESTION``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from rich.markup import escape

from seatrial.cli.answer import answer
from seatrial.cli.options import EngineName, Network, Out, engine_named
from seatrial.cli.running.run_options import Cluster, Jobs, KeepName, NoReport, RerunChanged, Resume
from seatrial.cli.show import console, print_notes
from seatrial.cli.stopping import stoppable
from seatrial.cli.watch import Watch
from seatrial.errors import InputError
from seatrial.links.hardware import allow_network
from seatrial.trial.running.hooks import Hooks
from seatrial_kits.campaigns.campaign import load_campaign
from seatrial_kits.campaigns.cases import Case
from seatrial_kits.campaigns.commands.shown import print_shown
from seatrial_kits.campaigns.ended import Ended
from seatrial_kits.campaigns.results.finding import Finding
from seatrial_kits.campaigns.results.page import write_table_page
from seatrial_kits.campaigns.sweep import How, keep_named

from .ask import ask as ask_campaign


def ask(
    name: Annotated[str, typer.Argument(metavar="CAMPAIGN", hidden=True)],
    question: Annotated[
        str,
        typer.Option(
            "--ask",
            metavar="QUESTION",
            help="'limits': the boundary of the passing region; 'worst-case': the least "
            "robustness, and the smallest change that fails; 'sensitivity': how much each key "
            "matters; 'rare': how likely a failure is; 'tune': the best values of gains over all "
            "that varies.",
        ),
    ],
    engine: EngineName = "fmu",
    out: Out = None,
    jobs: Jobs = None,
    cluster: Cluster = None,
    network: Network = False,
    keep: KeepName = None,
    resume: Resume = False,
    rerun_changed: RerunChanged = False,
    no_report: NoReport = False,
) -> None:
    """Run the trials that the answer to a question to a campaign needs, and print the answer."""
    if resume and out is None:
        raise InputError("--resume needs the question's folder, --out FOLDER")
    if network:
        allow_network()
    campaign = load_campaign(name)
    keep_kind = keep_named(keep, "--keep")
    how = How(engine_named(engine), jobs, cluster, keep_kind, resume, rerun_changed)
    with stoppable() as stop, Watch(campaign.read_from.name) as watch:
        ended_count = failed = 0
        expected = 1

        def expect(runs: int) -> None:
            nonlocal expected
            expected = runs

        def done(_case: Case, ended: Ended) -> None:
            nonlocal ended_count, failed
            ended_count += 1
            failed += not ended.measured.passed
            watch.expect(max(expected, ended_count))
            watch.cases(ended_count, failed)

        hooks = Hooks(
            stop_requested=stop.requested,
            interruptible=stop.interruptible,
            note=lambda text: print_notes([text]),
            under_way=watch.under_way,
        )
        finding, folder = ask_campaign(campaign, question, out, how, hooks, done, expect)
    _say(finding, folder, None if no_report else write_table_page(folder))


def _say(finding: Finding, folder: Path, page: Path | None) -> None:
    console.print(f"{finding.question}: {finding.runs} runs")
    for line in finding.lines:
        console.print(f"  {escape(line)}", soft_wrap=True)
    for shown in finding.tables:
        print_shown(shown)
    answer.result = {**finding.content(), "folder": str(folder)}
    console.print(f"answer: {folder}", soft_wrap=True)
    if page is not None:
        console.print(f"report: {page}", soft_wrap=True)
