"""The mark ``trial``: what is run, and once for which vehicles, autopilots and seeds."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from ..api.written import as_engine, as_settings
from ..system.system import Engine

if TYPE_CHECKING:
    from ..trial.files.trial import Trial

_LISTS = {"vehicles": "choices.vehicle", "autopilots": "choices.autopilot", "seeds": "seed"}
"""Settings of a mark's list, one at a time."""


@dataclass(frozen=True)
class Variant:
    """One run of a trial."""

    name: str
    set: dict[str, Any]
    engine: Engine
    limit: dict[str, str]
    id: str

    def loaded(self, folder: Path) -> Trial:
        """Return the trial; a file is looked for in ``folder`` first. Raises InputError."""
        from ..trial.files.trial import load_trial

        beside = folder / self.name
        name = str(beside) if self.name.endswith(".toml") and beside.is_file() else self.name
        loaded = load_trial(name, changes=as_settings(self.set), origin="mark trial")
        return loaded.limited(self.limit, "mark trial: limit")


def variants(marks: Sequence[pytest.Mark]) -> list[Variant]:
    """Return all runs of some marks, the one nearest to the test last."""
    return [variant for mark in reversed(marks) for variant in _variants(*mark.args, **mark.kwargs)]


def _variants(
    name: str | Path,
    *,
    set: dict[str, Any] | None = None,
    engine: str = "direct",
    limit: dict[str, str] | None = None,
    **lists: Iterable[Any] | None,
) -> list[Variant]:
    for key in lists:
        if key not in _LISTS:
            raise pytest.UsageError(f"mark trial: unknown {key!r} (known: {', '.join(_LISTS)})")
    given = {_LISTS[key]: list(values) for key, values in lists.items() if values is not None}
    found = []
    for chosen in itertools.product(*given.values()):
        own = dict(zip(given, chosen, strict=True))
        label = "-".join(
            [Path(name).stem, *(f"seed{v}" if k == "seed" else str(v) for k, v in own.items())]
        )
        found.append(
            Variant(str(name), {**(set or {}), **own}, as_engine(engine), limit or {}, label)
        )
    return found
