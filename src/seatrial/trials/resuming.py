"""A campaign that was stopped goes on: what is whole in its folder is kept."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ..errors import InputError
from . import run_schema
from .run import Result
from .run_folder import read_manifest
from .run_schema import checked_json
from .supervision import result_of


def kept_results(index: Path, folders: Mapping[str, tuple[str, dict[str, Any]]]) -> list[Result]:
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
        error = read_manifest(folder).get("error")
        verdicts = [_row(verdict) for verdict in entry["verdicts"]]
        content = {"status": entry["status"], "error": error, "verdicts": verdicts, "notes": []}
        results.append(result_of(folder, content))
    return results


def _row(written: dict[str, Any]) -> tuple[str, str, dict[str, Any]]:
    rest = {key: value for key, value in written.items() if key not in ("name", "check")}
    return written["name"], written["check"], rest


def set_aside(folders: Sequence[Path]) -> None:
    """Rename the folders that are there, of cases that were stopped: nothing is lost."""
    for folder in folders:
        if folder.exists():
            names = (f"{folder.name}.stopped-{n}" for n in itertools.count(1))
            folder.rename(next(p for n in names if not (p := folder.with_name(n)).exists()))
