"""Terminal output of campaigns: finished cases, tables of an answer or a comparison."""

from __future__ import annotations

from rich.box import SIMPLE
from rich.markup import escape
from rich.table import Table

from seatrial.cli.show import console, print_table
from seatrial.trial.records.ending import is_whole
from seatrial.trial.running.run import Result

from ..cases import Case
from ..results.finding import Shown


def print_shown(shown: Shown) -> None:
    """Print a table of a campaign's answer, or of a comparison."""
    table = Table(title=escape(shown.title), title_justify="left", box=SIMPLE, padding=(0, 1, 0, 0))
    for place, column in enumerate(shown.columns):
        is_number = all(isinstance(row[place], (int, float)) for row in shown.rows)
        table.add_column(escape(column), justify="right" if is_number else "left")
    for row in shown.rows:
        table.add_row(*(escape(_written(each)) for each in row))
    print_table(table)


def _written(value: object) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def print_case(case: Case, result: Result) -> None:
    """Print one line for a finished case of a campaign."""
    failed = [name for name, _, verdict in result.verdicts if not verdict.as_expected]
    mark = "[green]PASS[/green]" if result.passed else "[red]FAIL[/red]"
    if not is_whole(result.status):
        mark = f"[red]{result.status.upper()}[/red]"
    why = f"  ({', '.join(failed)})" if failed else ""
    console.print(f"{mark}  {escape(case.name)}{escape(why)}", soft_wrap=True)
