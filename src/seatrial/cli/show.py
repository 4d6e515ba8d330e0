"""What the terminal shows: progress, verdicts, listings."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from types import TracebackType

from rich.console import Console
from rich.markup import escape
from rich.progress import BarColumn, Progress, TextColumn

from ..component import Component
from ..fmi.description import summary
from ..trials.campaign import Case
from ..trials.run import Result

console = Console(highlight=False, emoji=False)


class Watch:
    """A progress bar with simulated time and real-time factor; silent if not on a terminal."""

    def __init__(self, name: str) -> None:
        self._name = name
        self._cases, self._case = 1, 0
        self._started = time.perf_counter()
        self._progress = Progress(
            TextColumn("{task.description}"),
            BarColumn(),
            TextColumn("{task.fields[state]}"),
            console=console,
            transient=True,
        )
        self._task = self._progress.add_task(escape(name), total=1.0, state="")

    def __enter__(self) -> Watch:
        if console.is_terminal:
            self._progress.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if console.is_terminal:
            self._progress.stop()

    def expect(self, cases: int) -> None:
        """Say how many runs there will be."""
        self._cases = cases

    def building(self, what: str) -> None:
        """Show which component is being built or loaded."""
        self._progress.update(self._task, state=escape(f"loading {what}"))
        self._started = time.perf_counter()

    def progress(self, passed: float, whole: float) -> None:
        """Show how far the run is, simulated time in s."""
        elapsed = time.perf_counter() - self._started
        factor = passed / elapsed if elapsed > 0 else 0.0
        case = f" ({self._case + 1} of {self._cases})" if self._cases > 1 else ""
        share = (self._case + passed / whole) / self._cases
        state = f"{passed:.1f} of {whole:g} s, {factor:.1f} x real time{case}"
        self._progress.update(self._task, completed=share, state=state)

    def log(self, show: Callable[[], None]) -> None:
        """Print something above the bar, at the end of a case."""
        self._case += 1
        show()


def print_notes(notes: Iterable[str]) -> None:
    """Print what a user should know and what is no error."""
    for note in notes:
        console.print(f"[dim]note: {escape(note)}[/dim]", soft_wrap=True)


def print_reachable(name: str, where: str) -> None:
    """Print what programs outside connect to, one a line, to be copied."""
    console.print(f"{escape(name)}: connect to", soft_wrap=True)
    for each in where.split():
        console.print(f"  [bold]{escape(each)}[/bold]", soft_wrap=True)


def print_verdicts(result: Result) -> None:
    """Print the verdict of each criterion and how the run went."""
    print_notes(result.notes)
    for name, _, verdict in result.verdicts:
        mark = "[green]PASS[/green]" if verdict.passed else "[red]FAIL[/red]"
        console.print(f"{mark}  {escape(name)}: {escape(verdict.detail)}", soft_wrap=True)
    if not result.verdicts and result.status == "complete":
        console.print("the trial has no criteria")
    if result.status != "complete":
        console.print(f"[red]{result.status.upper()}[/red]")


def print_case(case: Case, result: Result) -> None:
    """Print one line for a finished case of a campaign."""
    failed = [name for name, _, verdict in result.verdicts if not verdict.passed]
    mark = "[green]PASS[/green]" if result.passed else "[red]FAIL[/red]"
    if result.status != "complete":
        mark = f"[red]{result.status.upper()}[/red]"
    why = f"  ({', '.join(failed)})" if failed else ""
    console.print(f"{mark}  {escape(case.name)}{escape(why)}", soft_wrap=True)


def print_listing(
    files: Mapping[str, Mapping[str, Path]], components: Mapping[str, type[Component]]
) -> None:
    """Print all that can be named on the command line and in files."""
    for kind, found in files.items():
        console.print(f"[bold]{kind}[/bold]")
        for name, path in found.items():
            console.print(f"  {name:28} [dim]{escape(_title(path))}[/dim]", soft_wrap=True)
    console.print("[bold]FMUs[/bold]")
    for name, component in components.items():
        console.print(f"  {name:28} [dim]{escape(summary(component))}[/dim]", soft_wrap=True)


def _title(path: Path) -> str:
    import tomllib

    try:
        return str(tomllib.loads(path.read_text("utf-8")).get("title", ""))
    except (tomllib.TOMLDecodeError, OSError, UnicodeDecodeError):
        return "(cannot be read)"
