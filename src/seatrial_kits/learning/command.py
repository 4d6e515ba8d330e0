"""The learn command: a network of what a model leaves out, from runs and logs."""

from __future__ import annotations

import io
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from rich.box import SIMPLE
from rich.markup import escape
from rich.table import Table

from seatrial.cli.answer import answer
from seatrial.cli.show import console, print_notes, print_table
from seatrial.errors import InputError
from seatrial.files.whole_file import write_whole
from seatrial.model.readable import number
from seatrial.system.files import find_file
from seatrial.trial.records.run_folder import load_run

from .lesson import Lesson, Remainder

FOLDER = "harness/lessons"
MOST_LEFT = 0.5
"""Share of an output that a network may leave in a run that it did not learn from."""


def learn(
    lesson: Annotated[str, typer.Argument(help="A lesson: a name or a .toml file.")],
    runs: Annotated[
        list[Path], typer.Argument(help="Run folders to learn from, of imports and shadows too.")
    ],
    check: Annotated[
        list[Path] | None,
        typer.Option("--check", metavar="RUN", help="A run folder that it does not learn from."),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option("--out", "-o", help="The network, not yet there (default: the policy's)."),
    ] = None,
) -> None:
    """Train a network on runs; status 1 if it leaves more than half of an output of a check."""
    read = Lesson(find_file(FOLDER, lesson))
    path = out or read.meaning.network
    if path.suffix != ".npz":
        raise InputError(f"{path}: a network is written as .npz")
    if path.exists():
        raise InputError(f"{path}: exists already and is not replaced")
    taught = [read.rows(load_run(folder)) for folder in runs]
    checks = [read.rows(load_run(folder)) for folder in check or []]
    arrays = read.learned(taught)
    learned = [each for rows in taught for each in read.remainders(arrays, rows)]
    checked = [each for rows in checks for each in read.remainders(arrays, rows)]
    content = io.BytesIO()
    np.savez(content, **arrays)
    path.parent.mkdir(parents=True, exist_ok=True)
    write_whole(path, content.getvalue())
    answer.result = {
        "network": str(path),
        "learned": [asdict(each) for each in learned],
        "checked": [asdict(each) for each in checked],
    }
    print_table(_table(learned, checked))
    if not checks:
        print_notes(["nothing is checked: --check names runs that it does not learn from"])
    failed = [each for each in checked if each.share > MOST_LEFT]
    for each in checked:
        console.print(
            f"{'FAIL' if each in failed else 'PASS'}  {escape(each.output)} of {escape(each.run)}: "
            f"{100 * each.share:.0f} % is left, at most {100 * MOST_LEFT:.0f} % are allowed",
            soft_wrap=True,
        )
    console.print(f"network: {escape(str(path))}", soft_wrap=True)
    if failed:
        raise typer.Exit(1)


def _table(learned: list[Remainder], checked: list[Remainder]) -> Table:
    table = Table(box=SIMPLE, padding=(0, 1, 0, 0))
    for title, justify in (("run", "left"), ("output", "left"), ("RMS", "right")):
        table.add_column(title, justify=justify)  # type: ignore[arg-type]
    for title in ("left", "share", "rows outside"):
        table.add_column(title, justify="right")
    for each in [*learned, *checked]:
        table.add_row(
            escape(each.run) + ("" if each in learned else " (check)"),
            escape(each.output),
            f"{number(each.before, 3)} {each.unit}",
            f"{number(each.after, 3)} {each.unit}",
            f"{100 * each.share:.0f} %",
            f"{100 * each.outside:.0f} %",
        )
    return table
