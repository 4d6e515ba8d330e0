"""A page and a JUnit file that ``seatrial run`` leaves, and the status it ends with."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import typer

from ..errors import InputError, SimulationError
from ..trial.running.run import Result
from .junit import write_junit
from .show import console, print_notes
from .statuses import FAILED


@dataclass(frozen=True)
class Leaves:
    """What a command leaves besides run folders."""

    junit: Path | None
    report: bool

    def write_page(self, write: Callable[[], Path], results: list[Result]) -> None:
        """Write a page and say where, if one is wanted.

        Raises SimulationError: nothing that a person wrote is wrong with it. Of runs that have
        failed it is a note.
        """
        if not self.report:
            return
        try:
            page = write()
        except (OSError, InputError) as error:
            where = f"{error.filename}: {error.strerror}" if isinstance(error, OSError) else error
            message = f"cannot write the report: {where}"
            if not any(result.status == "failed" for result in results):
                raise SimulationError(message) from None
            print_notes([message])
        else:
            console.print(f"report: {page}", soft_wrap=True)

    def write_junit(self, runs: list[tuple[str, Result]]) -> None:
        """Write the JUnit file, if one is wanted. Raises OSError."""
        if self.junit is not None:
            write_junit(self.junit, runs)


def exit_with(results: list[Result]) -> None:
    """End with the status of runs. Raises SimulationError, typer.Exit."""
    if any(result.status == "failed" for result in results):
        first = next(result.error for result in results if result.status == "failed")
        raise SimulationError(str(first))
    if any(result.status == "stopped" for result in results):
        raise SimulationError("stopped; the signals recorded so far are on disk")
    if not all(result.passed for result in results):
        raise typer.Exit(FAILED)
