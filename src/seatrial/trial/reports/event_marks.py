"""Events and faults of a run as a report lists and draws them."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from ...errors import InputError
from ...model.units import quantity
from ..records.run_folder import Run
from .plots import Event

_FLAGGED = 40
"""Events that have a number in the figures; of more nobody could read them."""


@dataclass(frozen=True)
class Happening:
    """A row of the list: ``label`` is its number, as figures show it."""

    label: str
    at: str
    lasts: str
    what: str


def happenings(run: Run) -> list[Happening]:
    """Return events, then faults, as the manifest has them."""
    return [Happening(str(number), *_texts(written)) for number, written in enumerate(_all(run), 1)]


def events_of(run: Run) -> list[Event]:
    """Return those whose time is known, for figures."""
    listed = happenings(run)
    found = []
    for written, row in zip(_all(run), listed, strict=True):
        at, lasts = _seconds(written, "at"), _seconds(written, "for")
        if at is not None:
            label = row.label if len(listed) <= _FLAGGED else ""
            end = None if lasts is None else at + lasts
            found.append(Event(label, f"{row.label}: {row.what}", at, end))
    return found


def _all(run: Run) -> Sequence[Any]:
    return [*run.manifest.get("events", []), *run.manifest.get("faults", [])]


def _seconds(written: Any, key: str) -> float | None:
    try:
        return quantity(written[key], "s")
    except (InputError, KeyError, TypeError):
        return None


def _texts(written: Any) -> tuple[str, str, str]:
    """Return when it happens, how long it lasts, and what, as texts."""
    if not isinstance(written, dict):
        return "", "", str(written)
    named = {key: value for key, value in written.items() if key not in ("at", "for")}
    keys = {key: value for key, value in named.items() if value not in (None, "", {}, [])}
    if set(keys) == {"set"}:
        keys = keys["set"]
    what = ", ".join(
        f"{key} = {value if isinstance(value, str) else json.dumps(value)}"
        for key, value in keys.items()
    )
    return str(written.get("at") or ""), str(written.get("for") or ""), what
