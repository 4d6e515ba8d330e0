"""``seatrial run`` of a campaign that leaves a table."""

from __future__ import annotations

from pathlib import Path

import typer
from rich.markup import escape

from seatrial.cli.answer import answer
from seatrial.cli.running.twice import exit_unless, repeat
from seatrial.cli.show import console, print_notes
from seatrial.cli.statuses import FAILED
from seatrial.cli.stopping import stoppable
from seatrial.cli.watch import Watch
from seatrial.errors import InputError, SimulationError
from seatrial.trial.running.hooks import Hooks
from seatrial.trial.running.twice import First, has_ended, sample

from ..campaign import Campaign
from ..case_list import Cases
from ..cases import Case, case_folder
from ..ended import Ended
from ..results.page import write_table_page
from ..sweep import How, Summary, run_sweep
from ..table import RESULTS, read_rows

_SHOWN = {"pass": ("green", "PASS"), "fail": ("red", "FAIL"), "undecided": ("yellow", "UNDECIDED")}
_SAID = 20
"""Failed cases that have a line; the table has all."""


def run_table(
    campaign: Campaign, out: Path | None, how: How, *, junit: Path | None, report: bool, twice: bool
) -> None:
    """Run a campaign into its table, and say what came of it."""
    if junit is not None:
        raise InputError("--junit works with a campaign whose every case leaves a folder")
    cases = campaign.cases()
    planned = len(cases)
    with stoppable() as stop, Watch(campaign.read_from.name) as watch:
        watch.expect(planned)
        failed = 0

        def done(case: Case, ended: Ended) -> None:
            nonlocal failed
            if not ended.measured.passed:
                failed += 1
                if failed <= _SAID:
                    watch.log(lambda: _print_failed(case, ended))

        def under_way(ended: int, case: int, wall: float) -> None:
            watch.cases(ended, failed)
            watch.under_way(ended, case, wall)

        hooks = Hooks(
            stop_requested=stop.requested,
            under_way=under_way,
            interruptible=stop.interruptible,
            note=lambda text: print_notes([text]),
        )
        summary = run_sweep(campaign, out, how, hooks, done)
    page = write_table_page(summary.folder) if report else None
    if failed > _SAID:
        console.print(f"... and {failed - _SAID} more that failed")
    _say(campaign, summary, page)
    is_same = True
    if twice and summary.whole:
        with stoppable() as stop:
            is_same = repeat(_firsts(cases, summary), how.engine, stop)
    _exit_with(summary)
    exit_unless(is_same)


def _firsts(cases: Cases, summary: Summary) -> list[First]:
    """Return the cases that are repeated, of those that have come to their end."""
    rows = read_rows(summary.folder / RESULTS, ["status"])
    ended = [number for number, row in enumerate(rows) if has_ended(row["status"])]
    firsts = []
    for number in (ended[place] for place in sample(len(ended))):
        case = cases[number]
        folder = summary.folder / case_folder(number + 1, case)
        firsts.append(First(case.name, case.trial, folder if folder.is_dir() else None))
    return firsts


def _print_failed(case: Case, ended: Ended) -> None:
    measured = ended.measured
    said = [v["name"] for v in measured.verdicts if v["passed"] != (v["expected"] == "pass")]
    mark = "FAILED" if measured.status == "failed" else "FAIL"
    why = measured.error or ", ".join(said) or measured.status
    line = f"{escape(case.name)}  ({escape(why)})"
    console.print(f"[red]{mark}[/red]  case {ended.number + 1}: {line}", soft_wrap=True)


def _say(campaign: Campaign, summary: Summary, page: Path | None) -> None:
    passed, folder = summary.ended - summary.failed, summary.folder
    console.print(f"{passed} of {summary.ended} cases pass")
    if summary.enough:
        console.print(f"enough: {_why_enough(campaign)}; {summary.planned} were planned")
    for each in summary.accepted:
        style, word = _SHOWN[each.verdict]
        line = f"{escape(each.name)}: {escape(each.check)}: {each.detail}"
        console.print(f"[{style}]{word}[/]  {line}", soft_wrap=True)
    answer.result = {
        "campaign": campaign.read_from.name,
        "folder": str(folder),
        "cases": summary.ended,
        "failed": summary.failed,
        "criteria": [each.content() for each in summary.accepted],
    }
    if page is not None:
        console.print(f"report: {page}", soft_wrap=True)
    if not summary.whole:
        raise SimulationError(
            f"stopped; {summary.ended} of {summary.planned} cases came to an end: "
            f"--out {folder} --resume goes on"
        )


def _exit_with(summary: Summary) -> None:
    """End with the status of a campaign. Raises SimulationError, typer.Exit."""
    if summary.accepted:
        if any(each.verdict != "pass" for each in summary.accepted):
            raise typer.Exit(FAILED)
        return
    if summary.broken:
        raise SimulationError(f"{summary.broken} cases could not go on: results.parquet says why")
    if summary.failed:
        raise typer.Exit(FAILED)


def _why_enough(campaign: Campaign) -> str:
    rule = campaign.file.until
    is_decided = rule is not None and rule.decided
    return "the criteria are decided" if is_decided else "the interval is as narrow as wanted"
