"""A user's vehicle from files in several folders to one: ``harness/vehicles/NAME``.

Before, its numbers stood in ``vehicles/NAME.toml``, its rig in ``harness/rigs/vehicles/NAME.toml``,
its pilot's in ``harness/rigs/pilots/NAME.toml``, and parts of these in
``harness/rigs/GROUP/NAME-PART.toml``. Their text stays as it is, comments too; headers of tables
get where they stand now, and relative paths of files lead where they did.
"""

from __future__ import annotations

import os
import re
import shutil
import tempfile
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..errors import InputError
from ..files.reading import toml_content
from ..files.vehicle_folders import FOLDERS, PILOT, VEHICLE
from .flattening import load_rig
from .parameters import load_vehicle
from .rig import Scope

_HEADER = re.compile(r"^(\s*)(\[\[?)\s*([^\[\]]+?)\s*(\]\]?)(\s*(?:#.*)?)$")
_TEXT = re.compile(r'"([^"\\\n]+)"')
_FILE = re.compile(r".+?\.(?:fmu|py|toml)(?=[.:]|$)")
_RIGS = Path("harness/rigs")


@dataclass(frozen=True)
class Old:
    """A file of before: where its content goes, and which of it is there."""

    path: Path
    file: str
    """`VEHICLE` or `PILOT`."""
    table: tuple[str, ...]


def old_files(name: str, root: Path) -> list[Old]:
    """Return the files below ``root`` that a vehicle's folder is made of.

    Parts are those that the rigs of vehicle and pilot name. Raises InputError if there are none.
    """
    main = [
        Old(root / "vehicles" / f"{name}.toml", VEHICLE, ()),
        Old(root / _RIGS / "vehicles" / f"{name}.toml", VEHICLE, ("rig",)),
        Old(root / _RIGS / "pilots" / f"{name}.toml", PILOT, ()),
    ]
    found = [old for old in main if old.path.is_file()]
    if not found:
        raise InputError(
            f"{name}: there is none of the files {', '.join(str(old.path) for old in main)}"
        )
    said = "".join(old.path.read_text("utf-8") for old in found)
    for path in sorted((root / _RIGS).glob(f"*/{name}-*.toml")):
        group, part = path.parent.name, path.stem.removeprefix(f"{name}-")
        if f'"{group}/{name}-' in said:
            file = PILOT if group == "pilots" else VEHICLE
            found.append(Old(path, file, ("rigs", group, part)))
    return found


def folder_files(name: str, root: Path) -> dict[str, str]:
    """Return the texts of the folder's files by name, from the files of before.

    Raises InputError for one that is not TOML, or whose tables cannot be moved line by line.
    """
    folder = root / FOLDERS / name
    files: dict[str, str] = {}
    for old in sorted(old_files(name, root), key=lambda old: len(old.table)):
        text = with_paths(old.path.read_text("utf-8"), old.path.parent, folder)
        new = within(text, old.table, old.path)
        files[old.file] = f"{files[old.file]}\n{new}" if old.file in files else new
    return files


def within(text: str, table: tuple[str, ...], path: Path) -> str:
    """Return the text of a TOML file as that of a table of another one.

    Raises InputError, naming ``path``, if that cannot be done by headers alone.
    """
    if not table:
        return text
    content = toml_content(text.encode(), str(path))
    lines, prefix, is_headed = [], ".".join(_key(each) for each in table), False
    for line in text.splitlines():
        header = _HEADER.match(line)
        if not is_headed and line.strip() and not line.lstrip().startswith("#"):
            is_headed = True
            lines.append(f"[{prefix}]")
        if header is not None:
            lead, begin, inside, end, rest = header.groups()
            line = f"{lead}{begin}{prefix}.{inside}{end}{rest}"
        lines.append(line)
    new = "\n".join(lines) + "\n"
    wanted: Any = content
    for key in reversed(table):
        wanted = {key: wanted}
    try:
        is_same = tomllib.loads(new) == wanted
    except tomllib.TOMLDecodeError:
        is_same = False
    if not is_same:
        raise InputError(f"{path}: its tables cannot be moved line by line: write them by hand")
    return new


def with_paths(text: str, before: Path, after: Path) -> str:
    """Return a text whose relative names of files lead from ``after`` where they did before."""

    def led(match: re.Match[str]) -> str:
        written = match[1]
        found = _FILE.match(written)
        name = found[0] if found else written
        if Path(name).is_absolute() or not (before / name).is_file():
            return match[0]
        path = Path(os.path.relpath(before / name, after)).as_posix()
        return f'"{path}{written.removeprefix(name)}"'

    return _TEXT.sub(led, text)


def move_vehicle(name: str, root: Path) -> dict[str, list[Path]]:
    """Move a vehicle into its folder; return the files that are new, and those that are gone.

    What the rigs and the numbers amount to is compared before and after; if anything differs,
    all is left as it was. Raises InputError.
    """
    folder = root / FOLDERS / name
    if folder.exists():
        raise InputError(f"{folder} is there already")
    old, texts = [each.path for each in old_files(name, root)], folder_files(name, root)
    before = _meaning(name, old)
    with tempfile.TemporaryDirectory(dir=root, prefix=".moving-") as kept:
        held = {path: Path(kept) / f"{number}.toml" for number, path in enumerate(old)}
        try:
            for path, aside in held.items():
                path.rename(aside)
            folder.mkdir(parents=True)
            for file, text in texts.items():
                (folder / file).write_text(text, "utf-8")
            after = _meaning(name, old)
            if differing := [key for key in before if before[key] != after.get(key)]:
                raise InputError(f"{name}: {', '.join(differing)} would not be the same: not moved")
        except BaseException:
            shutil.rmtree(folder, ignore_errors=True)
            for path, aside in held.items():
                if aside.exists():
                    aside.rename(path)
            raise
    return {"written": [folder / file for file in texts], "removed": old}


def _meaning(name: str, old: list[Path]) -> dict[str, Any]:
    """Return what a vehicle's files amount to: numbers in all variants, and flattened rigs."""
    groups = {path.parent.name for path in old if path.parent.parent.name == "rigs"}
    meaning: dict[str, Any] = {}
    if any(path.parent.parent.name != "rigs" for path in old):
        vehicle = load_vehicle(name)
        meaning["numbers"] = {
            (variant, table): vehicle.entries(variant).table(table)
            for variant in [*vehicle.file.variants, vehicle.file.default]
            for table in vehicle.tables
        }
    for kind in ("vehicles", "pilots"):
        if kind in groups:
            top = load_rig(f"{kind}/{name}").top
            meaning[f"the rig {kind}/{name}"] = [_flat(scope) for scope in top.all()]
    return meaning


def _flat(scope: Scope) -> dict[str, Any]:
    content = scope.file.model_dump(exclude={"components"})
    folder = scope.read_from.path.parent
    components = {
        name: _resolved(entry.model_dump(), folder) for name, entry in scope.file.components.items()
    }
    return {"path": scope.path, "components": components, **content}


def _resolved(written: Any, folder: Path) -> Any:
    """Return an entry with the names of files in it as they are read."""
    if isinstance(written, Mapping):
        return {key: _resolved(value, folder) for key, value in written.items()}
    if not isinstance(written, str):
        return written
    found = _FILE.match(written)
    name = found[0] if found else written
    path = (folder / name).resolve()
    return f"{path}{written.removeprefix(name)}" if name and path.is_file() else written


def _key(name: str) -> str:
    return name if re.fullmatch(r"[\w-]+", name, re.ASCII) else f'"{name}"'
