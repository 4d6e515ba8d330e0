"""``seatrial run`` of a campaign."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import typer
from rich.markup import escape

from seatrial.cli.answer import answer
from seatrial.cli.leaves import Leaves, exit_with
from seatrial.cli.running.twice import exit_unless, repeat
from seatrial.cli.show import console, print_notes, run_entry
from seatrial.cli.statuses import FAILED
from seatrial.cli.stopping import stoppable
from seatrial.cli.watch import Watch
from seatrial.errors import InputError, SimulationError
from seatrial.system.system import Engine
from seatrial.trial.files.trial import Trial
from seatrial.trial.reports.playing import play
from seatrial.trial.running.hooks import Hooks
from seatrial.trial.running.run import Result
from seatrial.trial.running.twice import First, check_repeatable, has_ended, sample

from ..campaign import Campaign, load_campaign
from ..cases import Case
from ..in_folders import run_campaign
from ..results.campaign_report import write_campaign_report, write_case_report
from ..results.further_page import write_further_page
from ..sweep import How as SweepHow
from ..sweep import keep_named
from .shown import print_case
from .table_run import run_table


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


def run_named(
    name: str,
    changes: Mapping[str, Any],
    limits: Mapping[str, Any],
    out: Path | None,
    leaves: Leaves,
    *,
    check: Callable[[list[Trial]], None],
    **how: Any,
) -> None:
    """Run the campaign of a name, unless ``check`` refuses its trials; ``how`` is `How`'s.

    Raises InputError.
    """
    campaign = load_campaign(name, changes, limits)
    check([block.base for block in campaign.cases().blocks])
    run_cases(campaign, out, How(**how), leaves)


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
