"""Reading the folder that a run leaves: the record, what was run, the verdicts, the timing."""

from __future__ import annotations

import csv
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import InputError
from ...files.reading import json_content
from ...system.rig import LONGEST_S
from ..criteria.expressions import FloatArray
from .ending import is_whole

SIGNALS = "signals.csv"
MANIFEST = "manifest.json"
VERDICTS = "verdicts.json"
TIMING = "timing.json"
CAMPAIGN = "campaign.json"
"""Of a campaign's folder, which has the run folders of its cases."""

_CHUNK_ROWS = 10_000


@dataclass(frozen=True)
class Run:
    """A run folder, read; `load_run` makes one.

    ``time`` in s; ``signals`` by name, arrays of numbers (Booleans are 0 and 1) or lists of
    text; ``units`` by name; ``manifest``, ``verdicts`` and ``timing`` as the files have them.
    """

    folder: Path
    time: FloatArray
    signals: Mapping[str, Any]
    units: dict[str, str]
    manifest: dict[str, Any]
    verdicts: list[dict[str, Any]]
    timing: dict[str, Any]
    truncated: bool
    """The last line of the record was cut, and was dropped."""
    notes: tuple[str, ...]
    """For a person: what the folder lacks."""

    @property
    def name(self) -> str:
        """Name of the trial."""
        return str(self.manifest["trial"]["name"])

    @property
    def passed(self) -> bool | None:
        """Whether the run came to an end of its own, all criteria as expected.

        None without any, and of a run that was stopped.
        """
        if self.manifest["status"] == "stopped":
            return None
        if not is_whole(self.manifest["status"]):
            return False
        if not self.manifest["criteria"]:
            return None
        return bool(self.verdicts) and all(map(is_as_expected, self.verdicts))


def is_as_expected(verdict: Mapping[str, Any]) -> bool:
    """Say if a verdict is what the trial says it will be; those of before expect that all hold."""
    return bool(verdict["passed"] == (verdict.get("expected", "pass") == "pass"))


def viewed(
    manifest: Mapping[str, Any], kind: str
) -> Iterator[tuple[str, dict[str, Any], dict[str, str]]]:
    """Yield name, entry and ports of the components that have a view (`ports.VIEWS`)."""
    for name, component in manifest["components"].items():
        ports = component.get("views", {}).get(kind)
        if ports is not None:
            yield name, component, ports


def load_run(folder: Path | str, signals_wanted: Collection[str] | None = None) -> Run:
    """Read a run folder; of the record, where they are named, some signals alone.

    A run that was killed may lack verdicts, timing and its last line; one that failed at its
    start, the whole record, which then is empty, as is one whose file is.

    Raises InputError for a folder that is not a run, and for files that cannot be read or
    contradict each other.
    """
    folder = Path(folder)
    manifest = read_manifest(folder)
    evaluated = manifest["status"] != "stopped"  # one that was stopped is not
    files = (SIGNALS, VERDICTS, TIMING) if evaluated else (SIGNALS, TIMING)
    notes = [f"{name} is missing" for name in files if not _has_content(folder / name)]
    time: FloatArray = np.empty(0)
    signals: dict[str, Any] = {}
    truncated = False
    if _has_content(folder / SIGNALS):
        time, signals, truncated = _read_signals(folder / SIGNALS, _texts(manifest), signals_wanted)
        _check_signals(folder / SIGNALS, time, signals, manifest)
    elif is_whole(manifest["status"]) or manifest["status"] in ("ended", "stopped"):
        raise InputError(f"{folder} has no {SIGNALS}")
    if truncated:
        notes.append(f"the last line of {SIGNALS} is cut and was dropped")
    return Run(
        folder=folder,
        time=time,
        signals=signals,
        units=_units(folder, signals, manifest),
        manifest=manifest,
        verdicts=read_verdicts(folder),
        timing=_read_timing(folder),
        truncated=truncated,
        notes=tuple(notes),
    )


def _has_content(path: Path) -> bool:
    return path.is_file() and path.stat().st_size > 0


def _texts(manifest: dict[str, Any]) -> set[str]:
    """Return the signals that hold text, even if each of them looks like a number."""
    signals = manifest["signals"].items()
    return {name for name, signal in signals if signal.get("type") in ("String", "Binary")}


def _check_signals(
    path: Path, time: FloatArray, signals: Mapping[str, Any], manifest: dict[str, Any]
) -> None:
    """Raise InputError for a time that cannot be, and for columns that are not of their type."""
    if not np.isfinite(time).all() or np.abs(time).max(initial=0.0) > LONGEST_S:
        raise InputError(f"{path}: a time is not finite, or beyond {LONGEST_S:g} s")
    if np.any(np.diff(time) < 0.0):
        row = int(np.argmax(np.diff(time) < 0.0))
        raise InputError(
            f"{path}: the time goes back from {time[row]:.9g} to {time[row + 1]:.9g} s"
        )
    for name, column in signals.items():
        kind = manifest["signals"].get(name, {}).get("type")
        is_text = isinstance(column, list)
        if kind in ("Real", "Integer", "Boolean") and is_text:
            raise InputError(f"{path}: {name!r} has text, {MANIFEST} says {kind}")
        if kind in ("Integer", "Boolean") and not np.isfinite(column).all():
            raise InputError(f"{path}: {name!r} is not finite, {MANIFEST} says {kind}")


def _units(folder: Path, signals: Iterable[str], manifest: dict[str, Any]) -> dict[str, str]:
    described = manifest["signals"]
    for name in signals:
        if name not in described:
            raise InputError(f"{folder}: {SIGNALS} has {name!r}, which {MANIFEST} does not know")
    return {name: described[name]["unit"] for name in signals}


def read_manifest(folder: Path) -> dict[str, Any]:
    """Return the manifest of a run folder.

    Raises InputError if there is none, or it is not one of this format.
    """
    path = folder / MANIFEST
    if not path.is_file():
        raise InputError(f"{folder} is not a run folder: it has no {MANIFEST}")
    manifest: dict[str, Any] = _checked(path, "MANIFEST")
    return manifest


def written_status(folder: Path) -> Any:
    """Return the status in a manifest that this program has just written; None without one.

    Raises InputError if it cannot be read.
    """
    path = folder / MANIFEST
    try:
        content = json_content(path.read_bytes(), str(path))
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror}") from None
    return content.get("status") if isinstance(content, dict) else None


def read_verdicts(folder: Path) -> list[dict[str, Any]]:
    """Return the verdicts of a run; none if it has no file of them. Raises InputError."""
    path = folder / VERDICTS
    return _checked(path, "VERDICTS") if path.is_file() else []


def _read_timing(folder: Path) -> dict[str, Any]:
    path = folder / TIMING
    return _checked(path, "TIMING") if path.is_file() else {}


def _checked(path: Path, schema: str) -> Any:
    from . import run_schema  # building the schemata takes longer than starting a run's process

    return run_schema.checked_json(path, getattr(run_schema, schema))


def _read_signals(
    path: Path, texts: set[str], wanted: Collection[str] | None
) -> tuple[FloatArray, dict[str, Any], bool]:
    """Return times, the columns that are wanted by name, and whether the last line was cut.

    A column is numbers if every cell is one, unless it is one of ``texts``.
    """
    with path.open(encoding="utf-8", errors="replace", newline="") as file:
        header = _header(csv.reader(file, strict=True), path)
    if not header or header[0] != "time":
        raise InputError(f"{path}: the first column is not 'time'")
    if len(set(header)) != len(header):
        raise InputError(f"{path}: a column occurs twice")

    rows = _Rows(path, len(header))
    chunks: list[list[FloatArray]] = [[np.empty(0)] for _ in header]
    kept = [i for i, name in enumerate(header) if i == 0 or wanted is None or name in wanted]
    text: dict[int, list[str]] = {i: [] for i in kept if header[i] in texts}
    iterator = iter(rows)
    while chunk := list(islice(iterator, _CHUNK_ROWS)):
        columns_read = list(zip(*chunk, strict=True))
        for index in kept:
            if index not in text:
                try:
                    chunks[index].append(np.array(columns_read[index], dtype=float))
                except ValueError:
                    text[index] = []
    if 0 in text:
        raise InputError(f"{path}: a time is not a number")
    if text:
        for row in rows:
            for index, column in text.items():
                column.append(row[index])
    columns: dict[str, Any] = {}
    for index in kept:
        columns[header[index]] = text[index] if index in text else np.concatenate(chunks[index])
        chunks[index].clear()  # a long record is in memory once
    return columns.pop("time"), columns, rows.cut


def _header(reader: Iterator[list[str]], path: Path) -> list[str]:
    try:
        return next(reader, [])
    except csv.Error as error:
        raise InputError(f"{path}, line 1: {error}") from None


class _Rows:
    """The rows of a CSV file below its header, all of the same width; a cut last one left out."""

    def __init__(self, path: Path, width: int) -> None:
        self.path, self.width = path, width
        self.cut = not ends_with_newline(path)

    def __iter__(self) -> Iterator[list[str]]:
        rows = self._parsed()
        line, row = next(rows, (0, None))
        while row is not None:
            next_line, following = next(rows, (0, None))
            last = following is None
            if len(row) != self.width and not last:
                raise InputError(
                    f"{self.path}, line {line}: {len(row)} values, the header has {self.width}"
                )
            if last and len(row) != self.width:
                self.cut = True
            elif not (last and self.cut):
                yield row
            line, row = next_line, following

    def _parsed(self) -> Iterator[tuple[int, list[str] | None]]:
        with self.path.open(encoding="utf-8", errors="replace", newline="") as file:
            reader = csv.reader(file, strict=True)
            _header(reader, self.path)
            try:
                for row in reader:
                    yield reader.line_num, row
            except csv.Error as error:
                if file.read(1):
                    raise InputError(f"{self.path}, line {reader.line_num}: {error}") from None
                # A text that the end of the file cuts; it is taken for a row without values.
                self.cut = True
                yield reader.line_num, []


def ends_with_newline(path: Path) -> bool:
    """Return whether the last line of a text is whole, or the text is empty."""
    with path.open("rb") as file:
        file.seek(0, 2)
        if file.tell() == 0:
            return True
        file.seek(-1, 2)
        return file.read(1) == b"\n"
