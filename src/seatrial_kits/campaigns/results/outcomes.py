"""Outcomes of a campaign's cases, read from its folder: from its table, or case by case."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from urllib.parse import quote

from seatrial.errors import InputError
from seatrial.model.readable import number
from seatrial.trial.records import run_schema
from seatrial.trial.records.identity import IDENTITY
from seatrial.trial.records.run_schema import checked_json
from seatrial.trial.reports.report import REPORT

from ..campaign import INDEX
from ..columns import settings_in
from ..distributions import number_and_unit
from ..table import RESULTS, read_rows, units_of

SEED = "seed"
Setting = tuple[float, str] | str
"""A number with its unit, or text."""


@dataclass(frozen=True)
class CaseOutcome:
    """A case that has ended: its settings, verdicts and values."""

    number: int
    """From 1."""
    settings: Mapping[str, Setting]
    """Trial and seed among them."""
    passed: bool
    criteria: Mapping[str, bool]
    values: Mapping[str, float]
    """Numbers by column: robustness, worst values, figures."""


@dataclass(frozen=True)
class Outcomes:
    """All cases of a campaign's folder."""

    folder: Path
    title: str
    cases: list[CaseOutcome]
    units: dict[str, set[str]]
    """Of the columns of numbers; more than one where trials differ."""
    accepted: dict[str, str] = field(default_factory=dict)
    """Verdicts of the campaign's own criteria."""
    files: dict[str, str] = field(default_factory=dict)
    """Hashes of the files that decide the cases, and versions, by name."""
    links: dict[str, str] = field(default_factory=dict)
    """Addresses of the cases that have a folder, from the campaign's, by number."""


def read_outcomes(folder: Path) -> Outcomes:
    """Return the outcomes of a campaign's folder. Raises InputError for one without a case."""
    index = checked_json(folder / INDEX, run_schema.CAMPAIGN)
    has_table = (folder / RESULTS).is_file()
    cases, units = _of_table(folder / RESULTS) if has_table else _of_index(index["cases"])
    if not cases:
        raise InputError(f"{folder}: no case of this campaign has ended")
    identity = index.get(IDENTITY) or {}
    files = dict(identity.get("program", {}))
    for each in identity.get("files", {}).values():
        files.update(each)
    return Outcomes(
        folder,
        index.get("title") or index["name"],
        cases,
        units,
        {each["name"]: each["verdict"] for each in index.get("criteria", [])},
        files,
        links_of(folder, index["cases"]),
    )


def links_of(folder: Path, entries: Iterable[Mapping[str, Any]]) -> dict[str, str]:
    """Return the addresses of the cases that have a folder, by number: their reports."""
    links = {}
    for entry in entries:
        name = str(entry["folder"])
        number_text = name.partition("-")[0]
        page = f"{name}/{REPORT}" if (folder / name / REPORT).is_file() else f"{name}/"
        if number_text.isdecimal():
            links[str(int(number_text))] = quote(page)
    return links


def setting_text(setting: Setting | None) -> str:
    """Return a setting as a person reads it."""
    if setting is None:
        return "–"
    if isinstance(setting, str):
        return setting
    return f"{number(setting[0], 6)} {setting[1]}".rstrip()


def _of_table(path: Path) -> tuple[list[CaseOutcome], dict[str, set[str]]]:
    units = units_of(path)
    names = list(units)
    if lacking := {"case", "trial", "status", "passed", "error"} - {*names}:
        raise InputError(f"{path}: this is no table of a campaign: it has no {min(lacking)}")
    settings = settings_in(names)
    found = names[names.index("error") + 1 :]
    kinds: dict[str, set[str]] = {name: {units[name]} for name in found if units[name]}
    cases = []
    for row in read_rows(path):
        if not isinstance(row["passed"], bool) or not isinstance(row["case"], int):
            raise InputError(f"{path}: this is no table of a campaign: case {row['case']!r} in it")
        for name in found:
            if name.startswith("unit of ") and row[name]:
                kinds.setdefault(f"worst of {name.removeprefix('unit of ')}", set()).add(
                    str(row[name])
                )
        cases.append(
            CaseOutcome(
                row["case"],
                {k: _setting(row[k], units[k]) for k in settings if row[k] is not None},
                row["passed"],
                {name: row[name] for name in found if isinstance(row[name], bool)},
                dict(_numbers((name, row[name]) for name in found)),
            )
        )
    return cases, kinds


def _of_index(entries: list[dict[str, Any]]) -> tuple[list[CaseOutcome], dict[str, set[str]]]:
    units: dict[str, set[str]] = {}
    cases = []
    for place, entry in enumerate(entries, 1):
        values: dict[str, Any] = {}
        for verdict in entry["verdicts"]:
            name = verdict["name"]
            values[f"robustness of {name}"] = verdict.get("robustness")
            values[f"worst of {name}"] = verdict.get("worst")
            if verdict.get("unit"):
                units.setdefault(f"worst of {name}", set()).add(verdict["unit"])
        settings = {"trial": entry.get("trial", ""), **entry["set"]}
        cases.append(
            CaseOutcome(
                place,
                {key: _setting(value, "") for key, value in settings.items()},
                entry["passed"],
                {verdict["name"]: verdict["passed"] for verdict in entry["verdicts"]},
                dict(_numbers(values.items())),
            )
        )
    return cases, units


def _setting(value: Any, unit: str) -> Setting:
    """Return a setting so that tables and lists of cases have the same for the same."""
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        return float(value), unit
    if not isinstance(value, str):
        return json.dumps(value)
    size, own = number_and_unit(value)
    return value if own is None else (size, own)


def _numbers(pairs: Iterable[tuple[str, Any]]) -> Iterator[tuple[str, float]]:
    for name, value in pairs:
        if isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value):
            yield name, float(value)
