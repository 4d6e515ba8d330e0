"""Cases of two campaigns paired: by trial, seed and all settings that vary in either."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from seatrial.errors import InputError

from .outcomes import SEED, CaseOutcome, Outcomes, Setting, setting_text

_Key = tuple[Setting | int | None, ...]


@dataclass(frozen=True)
class Pairs:
    """Cases of two campaigns with the same settings, and the cases that one alone has."""

    found: list[tuple[CaseOutcome, CaseOutcome]]
    only: tuple[list[CaseOutcome], list[CaseOutcome]]
    varying: list[str]
    """Settings by which cases are paired."""
    changed: list[tuple[str, Setting | None, Setting | None]]
    """Settings that all cases of a campaign share, and that differ between the two."""

    def name(self, case: CaseOutcome) -> str:
        """Return a case's settings that vary, as text."""
        parts = [
            f"{key} {setting_text(case.settings[key])}"
            for key in self.varying
            if key in case.settings
        ]
        return ", ".join(parts) or f"case {case.number}"


def paired(a: Outcomes, b: Outcomes) -> Pairs:
    """Return the pairs of two campaigns, in the order of the first.

    A setting that has one value in all cases of each campaign pairs nothing: where the two values
    differ, they are the change that is compared. Cases whose settings are the same are paired in
    their order. Raises InputError if no case has its like.
    """
    constants, varying = _split(a.cases, b.cases)
    by_key = dict(zip(_keys(b.cases, varying), b.cases, strict=True))
    found, only_a = [], []
    for key, case in zip(_keys(a.cases, varying), a.cases, strict=True):
        other = by_key.pop(key, None)
        if other is None:
            only_a.append(case)
        else:
            found.append((case, other))
    if not found:
        raise InputError(
            f"{a.folder} and {b.folder} have no case in common; cases are paired by "
            f"{', '.join(varying)}"
        )
    changed = [(k, one, other) for k, (one, other) in constants.items() if one != other]
    return Pairs(found, (only_a, list(by_key.values())), varying, changed)


def _split(
    a: Sequence[CaseOutcome], b: Sequence[CaseOutcome]
) -> tuple[dict[str, tuple[Setting | None, Setting | None]], list[str]]:
    """Return the settings with one value in each campaign, and the names of all others."""
    constants, varying = {}, []
    names = dict.fromkeys(key for case in (*a, *b) for key in case.settings)
    for key in names:
        in_a, in_b = ({case.settings.get(key) for case in cases} for cases in (a, b))
        if key == SEED and {None} in (in_a, in_b):
            continue  # folders of single cases do not say the seed
        if len(in_a) == len(in_b) == 1:
            constants[key] = (in_a.pop(), in_b.pop())
        else:
            varying.append(key)
    return constants, varying


def _keys(cases: Sequence[CaseOutcome], varying: Sequence[str]) -> list[_Key]:
    seen: Counter[_Key] = Counter()
    keys = []
    for case in cases:
        key: _Key = tuple(case.settings.get(name) for name in varying)
        keys.append((*key, seen[key]))
        seen[key] += 1
    return keys
