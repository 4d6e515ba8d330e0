"""Terminal output: notes, addresses, verdicts."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from rich.box import SIMPLE
from rich.console import Console, ConsoleOptions, Group, RenderableType
from rich.markup import escape
from rich.segment import Segment
from rich.table import Table

from ..model.readable import number
from ..printable import printable
from ..trial.records.ending import is_whole
from .answer import answer

if TYPE_CHECKING:
    from ..trial.criteria.verdict import Verdict
    from ..trial.running.run import Result


MOST_SHOWN = 200
"""Lines of a list; more are no longer read from top to bottom."""


class SafeConsole(Console):
    """A console on which no text acts: control characters are shown, colours are rich's own."""

    def print(self, *objects: Any, **options: Any) -> None:
        """Print, unless the user wants nothing but errors."""
        if not answer.quiet:
            super().print(*objects, **options)

    def render(
        self, renderable: RenderableType, options: ConsoleOptions | None = None
    ) -> Iterable[Segment]:
        """Return what is printed."""
        for text, style, control in super().render(renderable, options):
            yield Segment(text if control else printable(text), style, control)


console = SafeConsole(highlight=False, emoji=False)
_UNBOUNDED = console.options.update_width(10_000)


def print_notes(notes: Iterable[str]) -> None:
    """Print what a user should know and what is no error."""
    for note in notes:
        answer.notes.append(note)
        console.print(f"[dim]note: {escape(note)}[/dim]", soft_wrap=True)


def print_table(table: Table | Group) -> None:
    """Print a table: as wide as a terminal is, and for programs as wide as its lines are."""
    if console.is_terminal:
        console.print(table)
    else:
        width = console.measure(table, options=_UNBOUNDED).maximum
        SafeConsole(highlight=False, emoji=False, width=width).print(table)


def text_table(headings: Sequence[str], rows: Iterable[Sequence[str]]) -> Table:
    """Return a table of texts: the first column to the left, the others to the right."""
    table = Table(box=SIMPLE, padding=(0, 1, 0, 0))
    for place, heading in enumerate(headings):
        table.add_column(
            escape(heading), justify="left" if place == 0 else "right", no_wrap=place > 0
        )
    for row in rows:
        table.add_row(*map(escape, row))
    return table


def print_more(count: int) -> None:
    """Print that a list has so many lines more."""
    console.print(
        f"... and {count} more: --match 'wing.*' shows those of a name, --all all", soft_wrap=True
    )


def print_reachable(name: str, where: str) -> None:
    """Print what programs outside connect to, one a line, to be copied."""
    console.print(f"{escape(name)}: connect to", soft_wrap=True)
    for each in where.split():
        console.print(f"  [bold]{escape(each)}[/bold]", soft_wrap=True)


def print_verdicts(result: Result) -> None:
    """Print the verdict of each criterion and how the run went."""
    print_notes(result.notes)
    for name, _, verdict in result.verdicts:
        said = verdict.detail
        if answer.verbose and verdict.margin:
            said += f", margin {verdict.margin}"
        if verdict.expected == "fail":
            said += f"; expected to fail: {verdict.why}"
        console.print(f"{_mark(verdict)}  {escape(name)}: {escape(said)}", soft_wrap=True)
    if not result.verdicts and is_whole(result.status):
        console.print("the trial has no criteria")
    if result.status == "stopped":
        console.print("the criteria were not evaluated")
    if answer.verbose:
        for what, seconds in result.wall.items():
            console.print(f"{what}: {number(seconds)} s of wall time", soft_wrap=True)
    if result.status != "complete":
        colour = "yellow" if is_whole(result.status) else "red"
        console.print(f"[{colour}]{escape(result.status.upper())}[/{colour}]", soft_wrap=True)


def _mark(verdict: Verdict) -> str:
    """Return the mark of a verdict: XFAIL fails as expected, XPASS holds though it should not."""
    word = ("PASS" if verdict.passed else "FAIL") if verdict.expected == "pass" else ""
    word = word or ("XPASS" if verdict.passed else "XFAIL")
    colour = "green" if verdict.as_expected else "red"
    return f"[{colour}]{word}[/{colour}]"


def run_entry(result: Result) -> dict[str, Any]:
    """Return a run for programs."""
    return {
        "folder": str(result.folder),
        "status": result.status,
        "error": result.error,
        "passed": result.passed,
        "wall_s": result.wall,
        "verdicts": [
            {"name": name, "check": check, **asdict(verdict)}
            for name, check, verdict in result.verdicts
        ],
    }
