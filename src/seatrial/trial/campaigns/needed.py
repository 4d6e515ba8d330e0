"""The files of a user that a campaign needs, wherever its own say that they are."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product
from pathlib import Path

from ...vehicle_folders import FOLDERS
from ..files.trial import Trial, is_choice
from ..records.deciding import deciding_files, found_by_name, named_in, our_folders
from .campaign import Campaign


def needed_files(campaign: Campaign) -> list[Path]:
    """Return a user's files and folders that a campaign needs, for another machine.

    Those that decide its cases (`files_of`), but not those named by an absolute path, which
    is the same wherever it is read; with the current folder where a vehicle or profile is found by
    its name below that.
    """
    found = {
        path: None
        for trial in campaign.trials
        for path in files_of(campaign, trial, is_absolute_too=False)
    }
    here, ours = Path.cwd().resolve(), our_folders()
    for trial in campaign.trials:
        for kind, name, path in found_by_name(trial.rig):
            is_below = path.parent in (here / kind, here / FOLDERS / name)
            if is_below and not name.endswith(".toml") and not any(map(path.is_relative_to, ours)):
                found[here] = None
    return list(found)


def files_of(campaign: Campaign, trial: Trial, *, is_absolute_too: bool = True) -> list[Path]:
    """Return the user's files that decide the cases of one of a campaign's trials, and folders.

    The campaign, and what decides the trial by all choices that cases make (`deciding_files`),
    without the campaign's other trials.
    """
    others = {each.read_from.path.resolve() for each in campaign.trials if each is not trial}
    above = [campaign.read_from.path, *named_in(campaign.changes, Path.cwd(), is_absolute_too)]
    chosen = _by_choices(campaign, trial)
    return deciding_files(chosen, above, others, is_absolute_too=is_absolute_too)


def _by_choices(campaign: Campaign, trial: Trial) -> Iterator[Trial]:
    """Yield a trial with each combination of choices that the campaign's cases make."""
    blocks = [block for block in campaign.cases().blocks if block.base.name == trial.name]
    for block in blocks:
        values = {key: each for key, each in block.grid.items() if is_choice(key)}
        drawn = {tuple((k, v) for k, v in row.items() if is_choice(k)) for row in block.rows}
        for picked in product(*values.values()):
            for row in sorted(drawn):
                changes = dict(zip(values, picked, strict=True)) | dict(row)
                yield block.base.changed(changes, block.where) if changes else block.base
