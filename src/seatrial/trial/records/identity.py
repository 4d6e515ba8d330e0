"""Identity of runs: the program and the files that decide them, by content."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..files.trial import Trial
from .deciding import deciding_files, files_in, named_in
from .program import program

IDENTITY = "identity"
"""Its key in the index of a campaign's folder, and in the manifest of a run."""
_MOST_SHOWN = 3


@dataclass(frozen=True)
class Identity:
    """Content that decides runs: equal contents leave equal signals and tables."""

    program: Mapping[str, str]
    """As `records.program.program` has it."""
    files: Mapping[str, Mapping[str, str]]
    """SHA-256 of a user's files, by trial; and by path, from its folder or the campaign's."""

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


def identity_of_run(trial: Trial) -> Identity:
    """Return the identity of a run of ``trial``, as its files are now. Raises InputError."""
    set_outside = [value for _, value, _ in trial.overrides]
    above = named_in(set_outside, Path.cwd(), True)
    found = deciding_files([trial], above)
    return Identity(program(), {trial.name: hashes(found, trial.read_from.path.resolve().parent)})


def hashes(paths: Iterable[Path], base: Path) -> dict[str, str]:
    """Return the SHA-256 of files, and of those in folders, by path from ``base``."""
    return dict(sorted(_hashes(paths, base)))


def _hashes(paths: Iterable[Path], base: Path) -> Iterator[tuple[str, str]]:
    for path in paths:
        for file in files_in(path) if path.is_dir() else [path]:
            with file.open("rb") as stream:
                digest = hashlib.file_digest(stream, "sha256").hexdigest()
            yield Path(os.path.relpath(file, base)).as_posix(), digest


def _differing(before: Mapping[str, str], now: Mapping[str, str]) -> Iterator[str]:
    for name in dict.fromkeys([*now, *before]):
        if before.get(name) != now.get(name):
            yield name
