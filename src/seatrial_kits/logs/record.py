"""Record of a run as typed columns."""

from __future__ import annotations

import base64
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from seatrial.errors import InputError
from seatrial.model.component import NS
from seatrial.trial.records.run_folder import Run


@dataclass(frozen=True)
class Column:
    """One signal: ``type`` is that of the manifest, ``values`` are Python's own numbers or text."""

    name: str
    type: str
    """Real, Integer, Boolean, String or Binary."""
    unit: str
    description: str
    values: Sequence[Any]


def nanoseconds(run: Run) -> list[int]:
    """Return the times of the record in whole nanoseconds."""
    return [round(t * NS) for t in run.time.tolist()]


def columns(run: Run) -> list[Column]:
    """Return the recorded signals. Raises InputError for one that is not of its type."""
    return [_column(run, name) for name in run.signals]


def _column(run: Run, name: str) -> Column:
    described, recorded = run.manifest["signals"][name], run.signals[name]
    kind = described["type"]
    try:
        values = _VALUES[kind](recorded)
    except (KeyError, TypeError, ValueError):
        raise InputError(f"{run.folder}: {name} is not of the type {kind!r}") from None
    return Column(name, kind, described["unit"], described["description"], values)


def _reals(recorded: Any) -> list[float]:
    values = np.asarray(recorded, dtype=float)
    if not np.isfinite(values).all():
        raise ValueError
    found: list[float] = values.tolist()
    return found


def _integers(recorded: Any) -> list[int]:
    reals = _reals(recorded)
    if any(not value.is_integer() for value in reals):
        raise ValueError
    return [int(value) for value in reals]


def _booleans(recorded: Any) -> list[bool]:
    integers = _integers(recorded)
    if not {0, 1}.issuperset(integers):
        raise ValueError
    return [bool(value) for value in integers]


_VALUES: dict[str, Any] = {
    "Real": _reals,
    "Integer": _integers,
    "Boolean": _booleans,
    "String": list,
    "Binary": lambda recorded: [base64.b64decode(text, validate=True) for text in recorded],
}
