"""Parameters that a rig names, for values that other components take while they run."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from seatrial.errors import InputError

from ..settings import Settings
from .definition import REAL32, Definition

MOST_TUNABLES = 64


def tunable_parameters(text: str) -> list[Definition]:
    """Return the parameters of ``NAME START LOW HIGH; NAME START LOW HIGH; ...``.

    Raises InputError for one that is written otherwise, that starts outside its limits, and for
    too many.
    """
    entries = [entry.split() for entry in text.split(";") if entry.strip()]
    if len(entries) > MOST_TUNABLES:
        raise InputError(f"{len(entries)} tunables, at most {MOST_TUNABLES} are allowed")
    return [_tunable(entry) for entry in entries]


def with_tunables(
    definitions: Sequence[Definition], tunables: Sequence[Definition], settings: Settings
) -> list[Definition]:
    """Return all parameters, the vehicle's first.

    A tunable may have the name of one of the vehicle's that is a real number and can be set: it
    is this one then, moves what this one moves, with a start value and limits of its own.
    """
    ours = {tunable.name: tunable for tunable in tunables}
    merged = []
    for definition in definitions:
        tunable = ours.pop(definition.name, None)
        if tunable is None:
            merged.append(definition)
            continue
        if definition.fixed or definition.kind != REAL32:
            raise InputError(f"tunable {definition.name} is a parameter of the vehicle already")
        merged.append(replace(tunable, apply=definition.apply))
        if definition.apply is not None:
            definition.apply(settings, tunable.default)
    return [*merged, *ours.values()]


def _tunable(entry: list[str]) -> Definition:
    if len(entry) != 4:
        raise InputError(
            f"tunable {' '.join(entry)!r}: a name, a start value, a low and a high limit are needed"
        )
    name, *written = entry
    start, low, high = (_number(name, text) for text in written)
    if low > high:
        raise InputError(f"tunable {name}: its low limit {low:g} is above its high limit {high:g}")
    return Definition(name, REAL32, start, low, high)


def _number(name: str, text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise InputError(f"tunable {name}: {text!r} is no number")
    return value
