"""A run compared with a log: residual, lag and coherence of each signal that both have."""

from __future__ import annotations

from pathlib import Path

from rich.markup import escape

from seatrial.cli.answer import answer
from seatrial.cli.show import console, print_notes, print_table, text_table
from seatrial.trial.logs.formats import read_log
from seatrial.trial.logs.quantities import read_columns
from seatrial.trial.records.run_folder import load_run, read_manifest

from .paired.pairing import compared_signals, pairs, read_matches
from .paired.residuals import HEADINGS, resampling_notes, residual_of
from .paired.steady_clock import steady
from .reading import reading


def compare_with_log(
    folder: Path, path: Path, match: list[str], columns: list[str], format_name: str | None
) -> None:
    """Print what is left between a run's signals and a log's channels. Raises InputError."""
    matches, named = read_matches(match, "--match"), read_columns(columns) if columns else {}
    described = read_manifest(folder)["signals"].items()
    numbers = [name for name, each in described if each.get("type") not in ("String", "Binary")]
    with reading(path):
        log = steady(read_log(path, format_name, named.pop("time", None)))
    run = load_run(folder, compared_signals(numbers, log, matches))
    found, notes = pairs(run, log, matches, named)
    residuals = [residual_of(signal, channel) for signal, channel in found]
    residuals.sort(key=lambda each: 1.0 if each.fit is None else each.fit)
    notes = [*run.notes, *log.notes, *notes]
    print_notes(notes)
    print_table(text_table(HEADINGS, [each.cells() for each in residuals]))
    for line in resampling_notes(residuals):
        console.print(escape(line), soft_wrap=True)
    answer.result = {"notes": notes, "signals": [each.figures() for each in residuals]}
