"""The files of a user that decide runs, wherever their trials say that they are."""

from __future__ import annotations

import ast
import os
import re
from collections.abc import Collection, Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

from ...errors import InputError
from ...fmi.building.bundle import bundled
from ...fmi.cache import cache_folder
from ...fmi.components.source import ComponentSource, find_source
from ...kits import kits
from ...shipped import content_of, shipped_folder
from ...system.files import find_file, read_toml
from ...system.parameters import split_reference
from ...system.profile.data_sheets import data_sheets_of
from ...system.rig import Placed, Rig
from ..files.trial import Trial

_SHIPPED = ("fmus", "harness", "hil_profiles", "vehicles")
_NAMED = re.compile(r".+?\.(?:fmu|py|toml)(?=[.:]|$)")
"""The file in ``boat.py:Boat`` and ``boat.toml.hull``."""
_LEFT_OUT = {"runs", "__pycache__", "node_modules", "site-packages"}
_OF_THE_SYSTEM = tuple(Path(each) for each in ("/proc", "/sys", "/dev", "/run"))
"""Folders whose files are no content, and may never end."""
_SKETCH = ".ino"
_MODULE = ".py"


def deciding_files(
    trials: Iterable[Trial],
    above: Iterable[Path] = (),
    apart: Collection[Path] = (),
    *,
    is_absolute_too: bool = True,
) -> list[Path]:
    """Return the user's files that decide the runs of ``trials``, and folders.

    The trials, their rigs, vehicles, profiles and their data sheets, components with the modules
    that they import, FMUs, what ``above`` names; and files and folders that a text in one of these
    names by a path from its own folder, of a sketch its whole folder. Shipped files, those of kits,
    what is unpacked in the cache, the system's own, and those ``apart`` are not among them, nor are
    folders that code names by an absolute path: ``/home/me`` in it may be anything.
    """
    pending = [path.resolve() for path in above]
    for chosen in trials:
        scenario = [] if chosen.scenario is None else [chosen.scenario.read_from]
        sources = [chosen.read_from, chosen.rig.read_from, *chosen.rig.sources, *scenario]
        pending += [source.path.resolve() for source in sources]
        pending += [path for _, _, path in found_by_name(chosen.rig)]
        for placed in chosen.rig.components.values():
            pending += _of_code(placed)
    found: dict[Path, None] = {}
    ours = our_folders()
    while pending:
        path = pending.pop()
        if path not in found and path not in apart and not any(map(path.is_relative_to, ours)):
            found[path] = None
            pending += _named_by(path, is_absolute_too)
    return list(found)


def our_folders() -> list[Path]:
    """Return the folders of what is shipped, of kits, and of what is unpacked from FMUs."""
    folders = [shipped_folder(each) for each in _SHIPPED]
    folders += [content_of(kit) for kit in kits().found]
    folders.append(cache_folder("unpacked"))
    return [folder.resolve() for folder in folders]


def files_in(top: Path) -> Iterator[Path]:
    """Yield the files of a user's folder, but not what is hidden, and what runs have left."""
    for folder, folders, names in os.walk(top):
        folders[:] = sorted(f for f in folders if f not in _LEFT_OUT and not f.startswith("."))
        if "campaign.json" in names or "manifest.json" in names:  # what runs have left
            folders.clear()
            continue
        files = (Path(folder, name) for name in sorted(names) if not name.startswith("."))
        yield from (file for file in files if file.is_file())


def found_by_name(rig: Rig) -> Iterator[tuple[str, str, Path]]:
    """Yield kind, name and file of vehicles, profiles and data sheets of a rig's components."""
    for placed in rig.components.values():
        folder = placed.scope.read_from.path.parent
        if placed.entry.parameters:
            name, _ = split_reference(placed.entry.parameters, placed.entry.fmu)
            yield "vehicles", name, find_file("vehicles", name, folder).resolve()
        own, _, section = (placed.entry.profile or "").rpartition(":")
        if profile := own or (section and placed.scope.file.profile):
            file = find_file("hil_profiles", profile, folder).resolve()
            yield "hil_profiles", profile, file
            for sheet in data_sheets_of(file):
                yield "hil_profiles", sheet.name, sheet.resolve()


def _of_code(placed: Placed) -> Iterator[Path]:
    """Yield the file of an FMU or table, or those of a user's component, with what it imports."""
    try:
        source = find_source(placed.entry.fmu, placed.scope.read_from.path.parent)
        if not isinstance(source, ComponentSource):
            yield source.resolve()
        elif source.folder is not None:
            folder = source.folder.resolve()
            read = (path.resolve() for path in bundled(source).read)
            yield from (path for path in read if path.is_relative_to(folder))
    except InputError:  # of a component that cannot be built: the run says it
        return


def _named_by(path: Path, is_absolute_too: bool) -> Iterator[Path]:
    """Yield what a file names by a path from its folder."""
    if path.suffix == ".toml" and path.is_file():
        yield from named_in(read_toml(path)[0], path.parent, is_absolute_too)
    elif path.suffix == _MODULE and path.is_file():
        try:
            nodes = ast.walk(ast.parse(path.read_bytes()))
        except (SyntaxError, ValueError):
            return
        constants = [node.value for node in nodes if isinstance(node, ast.Constant)]
        absolute = {
            text for text in constants if isinstance(text, str) and Path(text).is_absolute()
        }
        yield from named_in([c for c in constants if c not in absolute], path.parent, False)
        if is_absolute_too:
            found = named_in(sorted(absolute), path.parent, True)
            yield from (named for named in found if named.is_file())


def named_in(content: Any, folder: Path, is_absolute_too: bool) -> Iterator[Path]:
    """Yield the files and folders that texts name by a path from a folder."""
    for text in _texts(content):
        match = _NAMED.match(text)
        name = match[0] if match else text
        try:
            named = (folder / name).resolve()
            is_content = named.is_file() or named.is_dir()  # no pipe, no device
            is_there = Path(name).name not in ("", ".", "..") and is_content
        except (OSError, ValueError):  # of a text that can be no path
            continue
        is_ours = is_there and not any(map(named.is_relative_to, _OF_THE_SYSTEM))
        if is_ours and (is_absolute_too or not Path(name).is_absolute()):
            yield named.parent if named.suffix == _SKETCH else named


def _texts(content: Any) -> Iterator[str]:
    if isinstance(content, str):
        yield content
    elif isinstance(content, (Mapping, list)):
        for value in content.values() if isinstance(content, Mapping) else content:
            yield from _texts(value)
