"""``seatrial run`` of a campaign."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from pathlib import Path

import typer
from rich.markup import escape

from ...errors import InputError, SimulationError
from ...system.system import Engine
from ...trial.campaigns.campaign import Campaign
from ...trial.campaigns.cases import Case
from ...trial.campaigns.in_folders import run_campaign
from ...trial.campaigns.results.further_page import write_further_page
from ...trial.campaigns.sweep import How as SweepHow
from ...trial.campaigns.sweep import keep_named
from ...trial.campaigns.twice import First, check_repeatable, has_ended, sample
from ...trial.reports.campaign_report import write_campaign_report, write_case_report
from ...trial.reports.playing import play
from ...trial.running.hooks import Hooks
from ...trial.running.run import Result
from ..answer import answer
from ..leaves import Leaves, exit_with
from ..show import console, print_case, print_notes, run_entry
from ..statuses import FAILED
from ..stopping import stoppable
from ..watch import Watch
from .table_run import run_table
from .twice import exit_unless, repeat


@dataclass(frozen=True)
class How:
    """How the cases of a campaign are run, as the command line says it."""

    engine: Engine
    jobs: int | None
    resume: bool
    rerun_changed: bool
    cluster: str | None
    keep: str | None
    keep_going: bool
    twice: bool


def run_cases(campaign: Campaign, out: Path | None, how: How, leaves: Leaves) -> None:
    """Run a campaign into its table, or each case into a folder. Raises InputError."""
    for trial in campaign.trials if how.twice else ():
        check_repeatable(trial)
    print_notes([f"{trial} is left out: {why}" for trial, why in campaign.left_out.items()])
    if how.keep is not None or how.cluster is not None or campaign.has_table:
        if campaign.file.page is not None:
            raise InputError(
                "--keep and --cluster leave a table: this campaign makes a page of all"
            )
        keep = keep_named(how.keep, "--keep")
        sweep = SweepHow(how.engine, how.jobs, how.cluster, keep, how.resume, how.rerun_changed)
        run_table(campaign, out, sweep, junit=leaves.junit, report=leaves.report, twice=how.twice)
    else:
        _run_folders(campaign, out, how, leaves)


def _run_folders(campaign: Campaign, out: Path | None, how: How, leaves: Leaves) -> None:
    cases = campaign.cases()
    with stoppable() as stop:
        with Watch(campaign.read_from.name) as watch:

            def done(case: Case, result: Result) -> None:
                watch.log(lambda: print_case(case, result))
                watch.count(failed=not result.passed)

            hooks = Hooks(
                building=watch.building,
                progress=watch.campaign,
                under_way=watch.under_way,
                stop_requested=stop.requested,
                interruptible=stop.interruptible,
                note=lambda text: print_notes([text]),
                keep_going=how.keep_going,
            )
            watch.expect(len(cases))
            folder, finished = run_campaign(
                campaign,
                out,
                engine=how.engine,
                jobs=how.jobs,
                resume=how.resume,
                rerun_changed=how.rerun_changed,
                page=partial(write_case_report, play=play) if leaves.report else None,
                hooks=hooks,
                done=done,
            )
        results = [result for _, result in finished]
        leaves.write_junit([(case.name, result) for case, result in finished])
        passed = sum(result.passed for result in results)
        console.print(f"{passed} of {len(cases)} cases pass")
        entries = [{"case": case.name, "set": case.set, **run_entry(r)} for case, r in finished]
        answer.result = {
            "campaign": campaign.read_from.name,
            "folder": str(folder),
            "runs": entries,
        }
        leaves.write_page(lambda: write_campaign_report(folder), results)
        failed = _further_page(folder) if leaves.report else []
        whole = sum(result.status != "stopped" for result in results)
        is_same = True
        if how.twice and whole == len(cases):
            ended = [pair for pair in finished if has_ended(pair[1].status)]
            chosen = [ended[number] for number in sample(len(ended))]
            firsts = [First(case.name, case.trial, result.folder) for case, result in chosen]
            is_same = repeat(firsts, how.engine, stop)
    if whole < len(cases):
        raise SimulationError(
            f"stopped; {whole} of {len(cases)} cases came to an end: "
            f"--out {folder} --resume goes on"
        )
    exit_with(results)
    exit_unless(is_same)
    if failed:
        raise typer.Exit(FAILED)


def _further_page(folder: Path) -> list[str]:
    """Write the page of a kit, if the campaign has one, and return what does not hold by it."""
    page = write_further_page(folder)
    if page is None:
        return []
    answer.result["page"] = str(page.path)
    console.print(f"page: {page.path}", soft_wrap=True)
    for what in page.failed:
        console.print(f"[red]FAIL[/red]  {escape(what)}", soft_wrap=True)
    return page.failed
