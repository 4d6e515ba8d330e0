"""Keys among settings of faults and choices.

``faults.0.at`` of a trial, ``faults.NAME.at`` of a campaign, ``choices.NAME``.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from ...errors import InputError, unknown
from ...system.fault_entry import FaultEntry

CHOICES = "choices."
"""What the key of a choice begins with, among settings."""
PREFIX = "faults."


def with_fault_keys(
    faults: Sequence[Mapping[str, Any]], changes: Mapping[str, Any], origin: str
) -> list[dict[str, Any]]:
    """Return a trial's faults, as written, with keys replaced: ``faults.N.KEY``, N from 0.

    Raises InputError for a fault that the trial does not have, or a key that no fault has.
    """
    changed = [dict(each) for each in faults]
    for key, value in changes.items():
        number, name = _split(key, origin)
        places = {str(place): each for place, each in enumerate(changed)}
        if number not in places:
            has = f"the trial has {len(changed)}, from 0" if changed else "the trial has none"
            raise InputError(f"{origin}: {key}: there is no fault {number}: {has}")
        places[number][name] = value
    return changed


def named_keys(settings: Mapping[str, Any], names: Mapping[str, object]) -> dict[str, str]:
    """Return the keys among ``settings`` that are of a campaign's faults, each with its name."""
    found = {key: key.removeprefix(PREFIX).rpartition(".")[0] for key in settings if _is(key)}
    return {key: name for key, name in found.items() if name in names}


def changed_faults(
    faults: Sequence[FaultEntry], changes: Mapping[str, Any], origin: str
) -> list[FaultEntry]:
    """Return faults of one name with keys of all of them replaced: ``faults.NAME.KEY``.

    Raises InputError for a key that no fault has, or a value that does not fit.
    """
    if not changes:
        return list(faults)
    new = {_split(key, origin)[1]: value for key, value in changes.items()}
    return [_validated({**each.written, **new}, origin) for each in faults]


def _is(key: str) -> bool:
    return key.startswith(PREFIX)


def _validated(written: Mapping[str, Any], origin: str) -> FaultEntry:
    from pydantic import ValidationError

    try:
        return FaultEntry.model_validate(written)
    except ValidationError as error:
        first = error.errors()[0]
        raise InputError(
            f"{origin}: faults: {first['loc'][0]}: {first['msg']}, found {first['input']!r}"
        ) from None


def _split(key: str, origin: str) -> tuple[str, str]:
    """Return which fault a key means, and which key of it."""
    which, _, name = key.removeprefix(PREFIX).rpartition(".")
    if name not in _KEYS:
        raise InputError(f"{origin}: {key}: {unknown('key of a fault', name, _KEYS)}")
    return which, name


_KEYS = {field.alias or name: None for name, field in FaultEntry.model_fields.items()}


def is_choice(key: str) -> bool:
    """Return whether a key of settings is that of a choice."""
    return key.startswith(CHOICES)


def choices_in(changes: Mapping[str, Any], origin: str) -> dict[str, str]:
    """Return the choices among settings, by name. Raises InputError for one that is no text."""
    found = {k.removeprefix(CHOICES): v for k, v in changes.items() if is_choice(k)}
    for name, value in found.items():
        if not isinstance(value, str):
            raise InputError(f"{origin}: {CHOICES}{name}: a text is needed, found {value!r}")
    return found
