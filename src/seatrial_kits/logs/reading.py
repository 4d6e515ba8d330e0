"""Logs read by commands, with the progress shown."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from seatrial.cli.watch import Watch
from seatrial.trial.logs.reading_progress import told


@contextmanager
def reading(path: Path) -> Iterator[None]:
    """Show how far the log at ``path`` has been read inside the block."""
    with Watch(f"reading {path.name}") as watch, told(watch.reading):
        yield
