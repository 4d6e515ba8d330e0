"""Trial files that are written: a trial as it was changed, to run again from another folder."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from seatrial.errors import InputError
from seatrial.trial.files.trial import Trial

from .searching import needed


def refuse_unwritable(trial: Trial, origin: str) -> None:
    """Raise InputError for a trial that no trial file says: of a package, with another step."""
    needed("tomli_w")
    if trial.read_from.path.suffix != ".toml":
        raise InputError(f"{origin}: {trial.name} is a package, and no trial file can change it")
    if trial.rig_changes or trial.isolated:
        raise InputError(
            f"{origin}: {', '.join([*trial.rig_changes, *trial.isolated])}: a trial file cannot "
            "say that: write it in the rig"
        )


def write_trial(trial: Trial, path: Path, notes: Sequence[str]) -> None:
    """Write a trial with all of its changes; names of files are then relative to ``path``."""
    file = trial.file
    content = file.model_dump(mode="json", by_alias=True, exclude_unset=True)
    content = {key: value for key, value in content.items() if value not in (None, {}, [])}
    content["set"] = {**file.set, **{key: written for key, written, _ in trial.overrides}}
    moved = _moved(content, trial, path.parent)
    head = "".join(f"# {note}\n" for note in notes)
    path.write_text(f"{head}\n{needed('tomli_w').dumps(moved)}", "utf-8", newline="\n")


def _moved(value: Any, trial: Trial, folder: Path) -> Any:
    """Return a value of the file with the names of files as they are from ``folder``."""
    if isinstance(value, dict):
        return {key: _moved(each, trial, folder) for key, each in value.items() if each is not None}
    if isinstance(value, list):
        return [_moved(each, trial, folder) for each in value]
    if not isinstance(value, str) or "\n" in value or len(value) > 255:
        return value
    for base in (trial.read_from.path.parent, Path.cwd()):
        if value.strip(". ") and (base / value).is_file():
            return Path(os.path.relpath(base / value, folder.resolve())).as_posix()
    return value
