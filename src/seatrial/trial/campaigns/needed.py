"""The files of a user that a campaign needs, wherever its own say that they are."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path, PurePath
from typing import Any

from ...kits import kits
from ...shipped import content_of, shipped_folder
from ...system.files import find_file, read_toml
from ...system.parameters import split_reference
from ...system.profile.data_sheets import data_sheets_of
from ...system.rig import Rig
from ...vehicle_folders import FOLDERS
from .campaign import Campaign

_SHIPPED = ("fmus", "harness", "hil_profiles", "vehicles")
_NAMED = re.compile(r".+?\.(?:fmu|py|toml)(?=[.:]|$)")
"""The file in ``boat.py:Boat`` and ``boat.toml.hull``."""


def needed_files(campaign: Campaign) -> list[Path]:
    """Return a user's files among those of a campaign: trials, rigs, vehicles, profiles.

    With them comes what they name by a relative path that leads out of their own folder: files and
    folders. What is beside them is found with them; an absolute path is the same wherever it is
    read. Shipped files are not among them. A vehicle or profile that is found by its name below
    the current folder brings that with it. Trials are looked at as they are, not with what cases
    choose in them.
    """
    ours = [shipped_folder(each).resolve() for each in _SHIPPED]
    ours += [content_of(kit).resolve() for kit in kits().found]
    sources = [campaign.read_from]
    pending: list[Path] = []
    for trial in campaign.trials:
        sources += [trial.read_from, trial.rig.read_from, *trial.rig.sources]
        pending += _of_components(trial.rig)
    pending += [source.path.resolve() for source in sources]
    found: dict[Path, None] = {}
    while pending:
        path = pending.pop()
        if path not in found and not any(path.is_relative_to(folder) for folder in ours):
            found[path] = None
            pending += _named_elsewhere(path)
    return list(found)


def _of_components(rig: Rig) -> Iterator[Path]:
    """Yield the files of vehicles and profiles, which may be below the current folder."""
    for placed in rig.components.values():
        folder = placed.scope.read_from.path.parent
        if placed.entry.parameters:
            name, _ = split_reference(placed.entry.parameters, placed.entry.fmu)
            yield from _found("vehicles", name, folder)
        own, _, section = (placed.entry.profile or "").rpartition(":")
        if profile := own or (section and placed.scope.file.profile):
            yield from _found("hil_profiles", profile, folder)
            yield from data_sheets_of(find_file("hil_profiles", profile, folder))


def _found(kind: str, name: str, folder: Path) -> Iterator[Path]:
    path, here = find_file(kind, name, folder).resolve(), Path.cwd().resolve()
    yield path
    is_below = path.parent in (here / kind, here / FOLDERS / name)
    if is_below and not name.endswith(".toml") and not _is_shipped(path):
        yield here


def _is_shipped(path: Path) -> bool:
    return any(path.is_relative_to(shipped_folder(each).resolve()) for each in _SHIPPED)


def _named_elsewhere(path: Path) -> Iterator[Path]:
    if path.suffix != ".toml" or not path.is_file():
        return
    for text in _texts(read_toml(path)[0]):
        match = _NAMED.match(text)
        name = match[0] if match else text
        if ".." in PurePath(name).parts and (named := (path.parent / name).resolve()).exists():
            yield named


def _texts(content: Any) -> Iterator[str]:
    if isinstance(content, str):
        yield content
    elif isinstance(content, (dict, list)):
        for value in content.values() if isinstance(content, dict) else content:
            yield from _texts(value)
