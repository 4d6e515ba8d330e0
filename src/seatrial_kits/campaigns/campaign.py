"""Campaigns: one or more trials over a set of parameters (``harness/campaigns/*.toml``)."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Literal

from pydantic import Field

from seatrial.errors import InputError, unknown
from seatrial.plugins import Registry
from seatrial.system.fault_entry import FaultEntry
from seatrial.system.files import FileModel, Source, find_file, read_toml, validated
from seatrial.trial.files.fault_keys import is_choice
from seatrial.trial.files.limit_entry import LimitEntry
from seatrial.trial.files.map_entry import MapEntry
from seatrial.trial.files.trial import Trial, load_trial
from seatrial.trial.records.run_folder import CAMPAIGN

from .acceptance import Acceptance, AcceptanceEntry, read_acceptance
from .case_list import FAULTS, Block, Cases
from .designs import Design, drawn
from .questions import Questions
from .stopping_rule import StoppingRule

INDEX = CAMPAIGN
CONDITIONS = Registry("seatrial.conditions", "condition of campaigns", {})
"""Functions of kits: of a `Trial`, why it does not apply to its rig, None if it does."""
PAGES = Registry("seatrial.pages", "page of campaigns", {})
"""Functions of kits: they write a page into a campaign's folder, and return its path and what does
not hold by it."""


class TrialEntry(FileModel):
    """A trial of a campaign with keys of its own, beside those of the whole campaign."""

    trial: str
    set: dict[str, Any] = Field(default_factory=dict)
    grid: dict[str, list[Any]] = Field(default_factory=dict)


class CampaignFile(FileModel):
    """The content of a campaign file.

    Every combination of ``grid`` values, and of ``faults``, is one case of every trial; with
    ``design``, each combination is run over all that it draws. With
    ``scale``, each case is run as it is and then with one parameter at a time multiplied by each
    factor.
    """

    title: str = ""
    trials: list[str | TrialEntry] = Field(min_length=1)
    set: dict[str, Any] = Field(default_factory=dict)
    grid: dict[str, list[Any]] = Field(default_factory=dict)
    faults: dict[str, list[FaultEntry]] = Field(default_factory=dict)
    """Faults by the names of cases: each is one more value of every combination."""
    scale: dict[str, list[float]] = Field(default_factory=dict)
    design: Design | None = None
    figures: list[str] = Field(default_factory=list)
    """Signals of which the table has the least, the greatest and the last value."""
    keep: Literal["all", "failed", "none"] | None = None
    """Whose run folders stay beside a table of all cases; None: all, without a table."""
    criteria: list[AcceptanceEntry] = Field(default_factory=list)
    """What all cases together must show; the campaign leaves a table then."""
    samples: int = Field(default=0, ge=0)
    """With ``keep``: one case in so many keeps its folder whatever becomes of it."""
    limit: LimitEntry = Field(default_factory=LimitEntry)
    """Limits of the run of each case, in place of its trial's."""
    until: StoppingRule | None = None
    condition: str | None = None
    """Of a kit: what says which trials do not apply, and why; they are left out."""
    page: str | None = None
    """Of a kit: a page of all run folders, beside the report."""
    ask: Questions | None = None
    """Settings of the questions that can be asked."""
    map: MapEntry | None = None
    """What the page draws; None: the keys of a grid by themselves."""


@dataclass(frozen=True)
class Campaign:
    """A campaign file, read, with its trials."""

    file: CampaignFile
    read_from: Source
    trials: tuple[Trial, ...]
    """Those of ``file.trials``, in that order."""
    changes: Mapping[str, Any] = field(default_factory=dict)
    """What was set in place of what the file says."""
    limit: Mapping[str, str] = field(default_factory=dict)
    """Limits of each run that were set in place of those of the files."""
    left_out: Mapping[str, str] = field(default_factory=dict)
    """Why trials of the file do not apply, by their names."""

    @property
    def has_table(self) -> bool:
        """Whether it leaves a table by what its file says."""
        file = self.file
        return file.keep is not None or file.until is not None or bool(file.criteria)

    @property
    def acceptance(self) -> list[Acceptance]:
        """What the cases together must show. Raises InputError for what cannot be asked."""
        where = str(self.read_from.path)
        return [read_acceptance(entry, where) for entry in self.file.criteria]

    def is_enough(self, failed: int, count: int) -> bool:
        """Say if the first ``count`` cases, of which some have ``failed``, end the campaign."""
        rule = self.file.until
        if rule is None or not rule.decided:
            return rule is not None and rule.met(failed, count)
        return count >= rule.least and all(
            each.of_failures(failed, count, at_any_case=True) != "undecided"
            for each in self.acceptance
        )

    def cases(self) -> Cases:
        """Return all cases, in the order of the file. Raises InputError."""
        rows: list[dict[str, Any]] = [{}]
        if self.file.design is not None:
            rows = drawn(self.file.design, f"{self.read_from.path}: design")
        pairs = zip(self.trials, self.file.trials, strict=True)
        return Cases(self._block(trial, entry, rows) for trial, entry in pairs)

    def limited(self, trial: Trial) -> Trial:
        """Return one of its trials with the campaign's limits in place of the trial's."""
        own = self.file.limit.model_dump(exclude_unset=True)
        return trial.limited(own, f"{self.read_from.path}: limit").limited(self.limit, "--limit")

    @property
    def setter(self) -> str:
        """Who sets what all cases set, for messages."""
        return f"{self.read_from.path}: set" + (", --set" if self.changes else "")

    def _block(self, trial: Trial, entry: str | TrialEntry, rows: list[dict[str, Any]]) -> Block:
        file, origin = self.file, str(self.read_from.path)
        own = TrialEntry(trial=entry) if isinstance(entry, str) else entry
        common, grid = {**file.set, **own.set}, {**file.grid, **own.grid}
        keys = rows[0].keys()
        if twice := keys & grid.keys():
            raise InputError(f"{origin}: design: vary: {min(twice)} is a key of grid too")
        if FAULTS in keys and (lost := {row[FAULTS] for row in rows} - file.faults.keys()):
            said = unknown("name of faults", min(lost), file.faults)
            raise InputError(f"{origin}: design: {FAULTS}: {said}")
        base = self.limited(trial.changed(common, self.setter))
        return Block(
            replace(base, figures=tuple(file.figures)),
            common,
            grid,
            rows,
            file.faults,
            [None] if FAULTS in keys or not file.faults else list(file.faults),
            [None, *((key, factor) for key, each in file.scale.items() for factor in each)],
            f"{origin}: grid" + (" and design" if file.design is not None else ""),
            f"{origin}: scale",
        )


def load_campaign(
    name: str, changes: Mapping[str, Any] | None = None, limit: Mapping[str, str] | None = None
) -> Campaign:
    """Read the campaign ``name`` (shipped, in ``harness/campaigns``, or a path).

    ``changes`` are set in all cases, in place of what its file sets; keys are those of
    `Trial.changed`. ``limit`` replaces limits of the runs. Trials that do not apply, by its
    ``condition``, are left out.

    Raises InputError for anything wrong in it or in its trials, for a change of a key that has
    several values, and if no trial applies.
    """
    path = find_file("harness/campaigns", name)
    content, read_from = read_toml(path)
    file = _with(validated(CampaignFile, content, path), changes or {}, path)
    _check_criteria(file, path)
    if file.page is not None:
        _named(PAGES.target, file.page, f"{path}: page")
    chosen = {key: value for key, value in (changes or {}).items() if is_choice(key)}
    trials = []
    for entry in file.trials:
        name = entry if isinstance(entry, str) else entry.trial
        try:
            trials.append(load_trial(name, path.parent, chosen, "--choose"))
        except InputError as error:
            raise InputError(f"{path}: trials: {error}") from None
    return _applying(Campaign(file, read_from, tuple(trials), changes or {}, limit or {}))


def _with(file: CampaignFile, changes: Mapping[str, Any], path: Path) -> CampaignFile:
    """Return a campaign's file with ``changes`` in place of what it, and its trials, set."""
    entries: list[str | TrialEntry] = []
    for entry in file.trials:
        grids = [file.grid] if isinstance(entry, str) else [file.grid, entry.grid]
        for key in changes:
            if any(key in grid for grid in grids):
                raise InputError(f"{path}: grid: {key} has a list of values here: it cannot be set")
        if not isinstance(entry, str):
            own = {key: value for key, value in entry.set.items() if key not in changes}
            entry = entry.model_copy(update={"set": own})
        entries.append(entry)
    return file.model_copy(update={"trials": entries, "set": {**file.set, **changes}})


def _check_criteria(file: CampaignFile, path: Path) -> None:
    criteria = [read_acceptance(entry, str(path)) for entry in file.criteria]
    if file.criteria and file.page is not None:
        raise InputError(f"{path}: criteria leave a table, and this campaign makes a page of all")
    if file.until is None or not file.until.decided:
        return
    others = [each.name for each in criteria if not each.is_of_failure]
    if others or not criteria:
        said = f"{others[0]!r} is of something else" if others else "there are none"
        raise InputError(
            f"{path}: until: decided needs criteria of the probability of failure or success of "
            f"cases, and {said}"
        )


def _named(look_up: Callable[[str], Any], name: str, where: str) -> Any:
    try:
        return look_up(name)
    except InputError as error:
        raise InputError(f"{where}: {error}") from None


def _applying(campaign: Campaign) -> Campaign:
    """Return a campaign without the trials that do not apply. Raises InputError without any."""
    file = campaign.file
    if file.condition is None:
        return campaign
    where = f"{campaign.read_from.path}: condition"
    for grid in (file.grid, *(e.grid for e in file.trials if isinstance(e, TrialEntry))):
        for key in filter(is_choice, grid):
            raise InputError(f"{where}: grid has values of {key}: one rig is needed")
    reason_of = _named(CONDITIONS.load, file.condition, where)
    kept, left_out = [], {}
    for trial, entry in zip(campaign.trials, file.trials, strict=True):
        own = {} if isinstance(entry, str) else entry.set
        reason = reason_of(trial.changed({**file.set, **own}, campaign.setter))
        if reason is None:
            kept.append((trial, entry))
        else:
            left_out[trial.name] = reason
    if not kept:
        reasons = ", ".join(dict.fromkeys(left_out.values()))
        raise InputError(f"{campaign.read_from.path}: no trial applies: {reasons}")
    file = file.model_copy(update={"trials": [entry for _, entry in kept]})
    return replace(campaign, file=file, trials=tuple(t for t, _ in kept), left_out=left_out)
