"""Identity of a campaign: the program and the files that decide its cases, by content."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ...errors import InputError
from ..records.program import program
from ..records.run_schema import CAMPAIGN, checked_json
from ..running.resuming import Note
from .campaign import Campaign
from .needed import deciding_files, files_in

IDENTITY = "identity"
"""Its key in the index of a campaign's folder."""
_MOST_SHOWN = 3


@dataclass(frozen=True)
class Identity:
    """Content that decides the cases of a campaign; equal contents leave equal tables."""

    program: Mapping[str, str]
    """As `records.program.program` has it."""
    files: Mapping[str, Mapping[str, str]]
    """SHA-256 of a user's files, by trial and by path from the campaign's folder."""

    def content(self) -> dict[str, Any]:
        """Return it as JSON has it."""
        return {"program": dict(self.program), "files": {k: dict(v) for k, v in self.files.items()}}

    def changed(self, before: Mapping[str, Any]) -> Changes:
        """Return how it differs from the content of another one."""
        old = before.get("files", {})
        return Changes(
            tuple(_differing(before.get("program", {}), self.program)),
            {
                trial: names
                for trial, files in self.files.items()
                if (names := tuple(_differing(old.get(trial, {}), files)))
            },
        )


@dataclass(frozen=True)
class Changes:
    """What differs between two identities."""

    program: tuple[str, ...]
    files: Mapping[str, tuple[str, ...]]
    """Names of files, by the trials that they decide."""

    def __bool__(self) -> bool:
        """Whether there are any."""
        return bool(self.program or self.files)

    def touches(self, trial: str) -> bool:
        """Say whether the cases of a trial have to run again."""
        return bool(self.program) or trial in self.files

    def text(self) -> str:
        """Return them for a person: names, at most `_MOST_SHOWN` of files."""
        names = dict.fromkeys(name for each in self.files.values() for name in each)
        shown = [*self.program, *list(names)[:_MOST_SHOWN]]
        more = len(names) - _MOST_SHOWN
        return ", ".join(shown) + (f" and {more} more" if more > 0 else "")


def identity_of(campaign: Campaign) -> Identity:
    """Return the identity of a campaign as its files are now. Raises InputError."""
    base = campaign.read_from.path.resolve().parent
    return Identity(
        program(),
        {
            trial.name: dict(sorted(_hashes(deciding_files(campaign, trial), base)))
            for trial in campaign.trials
        },
    )


def changes_since(index: Path, identity: Identity, note: Note, *, rerun_changed: bool) -> Changes:
    """Return what has changed since a campaign's index was written; note it if there is any.

    Raises InputError for changes unless the cases that they touch are to run again.
    """
    changes = identity.changed(checked_json(index, CAMPAIGN).get(IDENTITY) or {})
    if not changes:
        return changes
    if not rerun_changed:
        raise InputError(
            f"{index}: changed since: {changes.text()}; --rerun-changed runs again what these "
            "touch and keeps the rest; or name another folder without --resume"
        )
    touched = "all cases" if changes.program else f"the cases of {', '.join(changes.files)}"
    note(f"changed since: {changes.text()}: {touched} run again")
    return changes


def _hashes(paths: list[Path], base: Path) -> Iterator[tuple[str, str]]:
    for path in paths:
        for file in files_in(path) if path.is_dir() else [path]:
            with file.open("rb") as stream:
                digest = hashlib.file_digest(stream, "sha256").hexdigest()
            yield Path(os.path.relpath(file, base)).as_posix(), digest


def _differing(before: Mapping[str, str], now: Mapping[str, str]) -> Iterator[str]:
    for name in dict.fromkeys([*now, *before]):
        if before.get(name) != now.get(name):
            yield name
