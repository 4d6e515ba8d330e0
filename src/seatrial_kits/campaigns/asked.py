"""Cases that a question asks for as it goes on: settings of one trial over what may vary."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from seatrial.errors import InputError, unknown
from seatrial.trial.files.trial import Trial

from .campaign import Campaign, TrialEntry
from .cases import Case, case_name
from .questions import Questions


@dataclass
class Asked:
    """The trial of a question, and the cases so far: what each sets, by its number from 0."""

    question: str
    base: Trial
    """With what all cases set."""
    common: Mapping[str, Any]
    where: str
    """Of the settings, for messages."""
    rows: dict[int, Mapping[str, Any]] = field(default_factory=dict)

    def __len__(self) -> int:
        return len(self.rows)

    def __getitem__(self, number: int) -> Case:
        row = self.rows[number]
        name = case_name(self.base, row)
        settings = {**self.common, **row}
        return Case(name, lambda: self.base.changed(row, self.where), settings, self.base.name)

    def changes(self, number: int) -> tuple[Mapping[str, Any], str]:
        """Return what a case sets, and who says so."""
        return self.rows[number], self.where

    def add(self, rows: Sequence[Mapping[str, Any]]) -> range:
        """Add cases, and return their numbers."""
        first = len(self.rows)
        self.rows.update(enumerate(rows, first))
        return range(first, len(self.rows))


def asked_of(campaign: Campaign, question: str) -> Asked:
    """Return the cases of a question, of which there are none yet. Raises InputError."""
    file, origin = campaign.file, f"{campaign.read_from.path}: ask"
    ask = file.ask or Questions()
    trial, own = _trial(campaign, ask.trial, origin)
    varied = {*(ask.vary or (file.design.keys if file.design else ()))}
    tuned = {*(ask.tune.keys if question == "tune" and ask.tune is not None else ())}
    common: dict[str, Any] = {**file.set, **own.set}
    for key, values in {**file.grid, **own.grid}.items():
        if key in ask.set or key in varied or (key in tuned and len(values) > 1):
            continue
        if len(values) > 1:
            raise InputError(
                f"{origin}: it is about one trial, and grid has {len(values)} values of {key}: "
                "say which in [ask.set], or vary it"
            )
        common[key] = values[0]
    common = {key: v for key, v in {**common, **ask.set}.items() if key not in varied}
    base = campaign.limited(trial.changed(common, f"{origin}: set"))
    base = replace(base, figures=tuple(file.figures))
    common = {key: v for key, v in common.items() if key not in tuned}  # the base's is the present
    return Asked(question, base, common, f"{origin}: vary")


def _trial(campaign: Campaign, name: str, origin: str) -> tuple[Trial, TrialEntry]:
    """Return the trial that a question is about, with its entry in the campaign."""
    entries = [TrialEntry(trial=e) if isinstance(e, str) else e for e in campaign.file.trials]
    pairs = list(zip(campaign.trials, entries, strict=True))
    if not name:
        if len(pairs) > 1:
            names = ", ".join(trial.name for trial in campaign.trials)
            raise InputError(
                f"{origin}: it is about one trial, and the campaign has {len(pairs)}: "
                f'trial = "NAME" is needed, one of {names}'
            )
        return pairs[0]
    for trial, own in pairs:
        if name in (trial.name, own.trial):
            return trial, own
    known = [trial.name for trial in campaign.trials]
    raise InputError(f"{origin}: trial: {unknown('trial', name, known)}")
