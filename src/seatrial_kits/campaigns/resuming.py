"""A campaign that was stopped goes on: what is whole in its folder is kept.

A loss of power may leave files cut or empty that had been written whole. They are renamed, which
is said (``note``), and what they held runs again.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from seatrial.errors import InputError
from seatrial.files.reading import json_content
from seatrial.trial.records import run_schema
from seatrial.trial.records.run_folder import read_manifest
from seatrial.trial.records.run_schema import checked_json
from seatrial.trial.running.run import Result
from seatrial.trial.running.supervision import result_of

Note = Callable[[str], None]


def kept_results(
    index: Path, folders: Mapping[str, tuple[str, dict[str, Any]]], note: Note
) -> list[Result]:
    """Return the results of the cases in a campaign's ``index`` that came to an end.

    ``folders`` has name and settings of each case by its folder. Raises InputError for an index
    that is of other cases, or cannot be read.
    """
    results = []
    for entry in checked_json(index, run_schema.CAMPAIGN)["cases"]:
        name, settings = folders.get(entry["folder"], ("", {}))
        if (name, settings) != (entry["name"], entry["set"]):
            raise InputError(
                f"{index}: it has the case {entry['name']!r}, which this campaign has not: name "
                "the folder that this campaign has left, or another one without --resume"
            )
        if entry["status"] == "stopped":
            continue
        folder = index.parent / entry["folder"]
        if not is_whole(folder, note):
            continue
        error = read_manifest(folder).get("error")
        verdicts = [_row(verdict) for verdict in entry["verdicts"]]
        content = {"status": entry["status"], "error": error, "verdicts": verdicts, "notes": []}
        results.append(result_of(folder, content))
    return results


def _row(written: dict[str, Any]) -> tuple[str, str, dict[str, Any]]:
    rest = {key: value for key, value in written.items() if key not in ("name", "check")}
    return written["name"], written["check"], rest


def is_whole(folder: Path, note: Note) -> bool:
    """Say if the folder of a case has a manifest that can be read; note that it runs again."""
    try:
        read_manifest(folder)
    except InputError as error:
        note(f"{error}; this case runs again")
        return False
    return True


def has_index(index: Path, note: Note) -> bool:
    """Say if a campaign's ``index`` is JSON; else move all of its folder into one inside.

    Nothing then says of which campaign the rest is.
    """
    try:
        json_content(index.read_bytes(), str(index))
    except InputError as error:
        inside = [*index.parent.iterdir()]
        aside = _free(index.parent / "cut")
        aside.mkdir()
        for path in inside:
            path.rename(aside / path.name)
        note(f"{error}; all that was there is in {aside} now, and all cases run")
        return False
    return True


def cut_aside(path: Path, why: object, note: Note) -> Path:
    """Rename a file that is cut, and return its new name."""
    aside = path.rename(_free(path.with_name(f"{path.name}.cut")))
    note(f"{why}; it is {aside.name} now, and what it held runs again")
    return aside


def set_aside(folders: Sequence[Path]) -> None:
    """Rename the folders that are there, of cases that were stopped: nothing is lost."""
    for folder in folders:
        if folder.exists():
            folder.rename(_free(folder.with_name(f"{folder.name}.stopped")))


def _free(path: Path) -> Path:
    """Return a path with a number at its end that nothing has."""
    paths = (path.with_name(f"{path.name}-{n}") for n in itertools.count(1))
    return next(free for free in paths if not free.exists())
