"""Files of a user's own, from templates."""

from __future__ import annotations

import re
from collections.abc import Iterable
from pathlib import Path

from rich.markup import escape

from ...errors import InputError
from ...shipped import provided_folders
from ..answer import answer
from ..show import console

FOLDER = Path(__file__).parents[2] / "templates"
"""A folder per kind of files, laid out as the user's own."""
_PLACEHOLDER = "@NAME@"
_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_-]{0,39}")
_RESERVED = re.compile(r"con|prn|aux|nul|(com|lpt)[0-9]", re.IGNORECASE)
"""Names that Windows keeps for devices."""
_ADDED = ".add"
_TABLE = re.compile(r"^\s*(\[[^\]\n]+\])", re.M)


def texts(name: str, kind: str, part: str = "") -> dict[Path, str]:
    """Return the texts of a kind's files, or of its ``part``, by path from the user's folder on."""
    folder = FOLDER / kind
    return {
        Path(str(path.relative_to(folder)).replace(_PLACEHOLDER, name)): path.read_text(
            "utf-8"
        ).replace(_PLACEHOLDER, name)
        for path in sorted((folder / part).rglob("*"))
        if path.is_file()
    }


def checked_name(name: str) -> str:
    """Return a name. Raises InputError for one that files cannot have everywhere."""
    if not _NAME.fullmatch(name) or _RESERVED.fullmatch(name):
        raise InputError(
            f"NAME {name!r}: letters (a to z), digits, '-' and '_' are allowed, 40 at most, the "
            "first a letter or a digit, and no name of a device of Windows, such as 'con'"
        )
    return name


def write(files: dict[Path, str], about: str, steps: list[tuple[str, str]]) -> None:
    """Write texts below the current folder; print that, and commands with their purpose.

    A text whose path ends in ``.add`` goes to the end of the file before it, which must be there
    without the tables that it has. Raises InputError for another file that is there, and for one
    that would hide a shipped one.
    """
    added = {path.with_suffix(""): text for path, text in files.items() if path.suffix == _ADDED}
    files = {path: text for path, text in files.items() if path.suffix != _ADDED}
    _refuse_existing(files)
    for path, text in added.items():
        _refuse_adding(path, text)
    for path, text in files.items():
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, "utf-8", newline="\n")
    for path, text in added.items():
        with path.open("a", encoding="utf-8", newline="\n") as file:
            file.write(text)
    answer.result = {"files": [str(path) for path in [*files, *added]]}
    _say("wrote", files)
    if added:
        _say("added to", added)
    console.print(f"{about}. Next:")
    width = max(len(command) for command, _ in steps)
    for command, purpose in steps:
        console.print(f"  {escape(command.ljust(width))}  {purpose}", soft_wrap=True)


def _say(done: str, paths: Iterable[Path]) -> None:
    console.print(done)
    for path in paths:
        console.print(f"  {escape(str(path))}", soft_wrap=True)


def _refuse_existing(files: Iterable[Path]) -> None:
    folders = {parent for path in files for parent in path.parents}
    there = [path for path in files if path.exists() or path.is_symlink()]
    there += [folder for folder in folders if folder.exists() and not folder.is_dir()]
    if there:
        raise InputError(f"nothing is written, for there is already {_listed(there)}")
    hidden = [path for path in files if _is_shipped(path)]
    if hidden:
        raise InputError(
            f"nothing is written: seatrial ships {_listed(hidden)}, which yours would hide: take "
            "another name"
        )


def _refuse_adding(path: Path, text: str) -> None:
    """Raise InputError unless a file takes the tables of ``text``."""
    if not path.is_file():
        raise InputError(
            f"nothing is written, for there is no {path} to add to: seatrial new vehicle "
            f"{path.stem} writes one"
        )
    there = path.read_text("utf-8")
    for table in _TABLE.findall(text):
        if table in _TABLE.findall(there):
            raise InputError(f"nothing is written, for {path} has a table {table} already")


def _is_shipped(path: Path) -> bool:
    folders = provided_folders(path.parent.as_posix())
    return any((folder / path.name).exists() for folder in folders)


def _listed(paths: list[Path]) -> str:
    return ", ".join(sorted(str(path) for path in paths))
