"""Campaigns: one or more trials over a set of parameters (``harness/campaigns/*.toml``)."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import closing
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any, Literal

from pydantic import Field

from ...errors import InputError, unknown
from ...plugins import Registry
from ...system.fault_entry import FaultEntry
from ...system.files import FileModel, Source, find_file, read_toml, validated
from ...system.system import Engine
from ..files.map_entry import MapEntry
from ..files.trial import Trial, is_choice, load_trial
from ..running.hooks import Hooks
from ..running.output import claim_folder, write_json
from ..running.resuming import has_index, kept_results
from ..running.run import Result
from ..running.supervised import Page
from .case_list import FAULTS, Block, Cases
from .cases import Case, case_folders, run_cases
from .designs import Design, drawn
from .questions import Questions
from .stopping_rule import StoppingRule

INDEX = "campaign.json"
CONDITIONS = Registry("seatrial.conditions", "condition of campaigns", {})
"""Functions of kits: of a `Trial`, why it does not apply to its rig, None if it does."""
PAGES = Registry("seatrial.pages", "page of campaigns", {})
"""Functions of kits that write a page into a campaign's folder, and return it: `Written`."""
_UNWRITTEN = 0.01
"""Share of the cases in the index that may have ended since it was written, while others run.

It bounds what is written in all by some hundred times the index, however many cases there are.
"""


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
    samples: int = Field(default=0, ge=0)
    """With ``keep``: one case in so many keeps its folder whatever becomes of it."""
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
    left_out: Mapping[str, str] = field(default_factory=dict)
    """Why trials of the file do not apply, by their names."""

    @property
    def has_table(self) -> bool:
        """Whether it leaves a table by what its file says."""
        return self.file.keep is not None or self.file.until is not None

    def cases(self) -> Cases:
        """Return all cases, in the order of the file. Raises InputError."""
        rows: list[dict[str, Any]] = [{}]
        if self.file.design is not None:
            rows = drawn(self.file.design, f"{self.read_from.path}: design")
        pairs = zip(self.trials, self.file.trials, strict=True)
        return Cases(self._block(trial, entry, rows) for trial, entry in pairs)

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
        base = trial.changed(common, self.setter)
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


def load_campaign(name: str, changes: Mapping[str, Any] | None = None) -> Campaign:
    """Read the campaign ``name`` (shipped, in ``harness/campaigns``, or a path).

    ``changes`` are set in all cases, in place of what its file sets; keys are those of
    `Trial.changed`. Trials that do not apply, by its ``condition``, are left out.

    Raises InputError for anything wrong in it or in its trials, for a change of a key that has
    several values, and if no trial applies.
    """
    path = find_file("harness/campaigns", name)
    content, read_from = read_toml(path)
    file = _with(validated(CampaignFile, content, path), changes or {}, path)
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
    return _applying(Campaign(file, read_from, tuple(trials), changes or {}))


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


def run_campaign(
    campaign: Campaign,
    out: Path | None,
    *,
    engine: Engine = "fmu",
    jobs: int | None = None,
    page: Page | None = None,
    resume: bool = False,
    hooks: Hooks | None = None,
    done: Callable[[Case, Result], None] = lambda _case, _result: None,
) -> tuple[Path, list[tuple[Case, Result]]]:
    """Run every case into a folder of its own below ``out``, which must not hold anything yet.

    None makes a new folder ``runs/NAME-DATE-TIME``. With ``resume`` ``out`` may be what this
    campaign has left: cases that came to an end are kept, the others run again. ``jobs`` cases run
    side by side, None: as many as there are cores; what they leave does not depend on it. ``page``
    writes the report of each case, by its folder. ``done`` is called after each case, in the order
    of the cases. Stops after the cases that were asked to stop. A case that ends its process has
    failed.

    Returns the folder and the results of the cases that began. Raises InputError for bad input, in
    any case, and StoppedError, before the first one runs.
    """
    cases = campaign.cases()
    left = out if resume and out is not None and (out / INDEX).is_file() else None
    kept: dict[int, Result] = {}
    if left is not None:
        folders = case_folders(cases)
        known = {f: (case.name, case.set) for f, case in zip(folders, cases, strict=True)}
        note = (hooks or Hooks()).note
        if has_index(left / INDEX, note):
            found = kept_results(left / INDEX, known, note)
            kept = {folders.index(r.folder.name): r for r in found}
    results = dict(kept)
    folder = Path()
    written = -1

    def write() -> None:
        nonlocal written
        _write_index(campaign, folder, cases, results)
        written = len(results)

    def begin() -> Path:
        nonlocal folder
        folder = left or claim_folder(out, campaign.read_from.name, INDEX)
        write()
        return folder

    def ended(number: int, result: Result) -> None:
        results[number] = result
        if len(results) - written > written * _UNWRITTEN:
            write()

    finished = run_cases(
        cases, begin, engine=engine, jobs=jobs, page=page, hooks=hooks, kept=kept, ended=ended
    )
    try:
        with closing(finished):
            for number, result in finished:
                done(cases[number], result)
    finally:
        if 0 <= written < len(results):
            write()
    return folder, [(cases[n], results[n]) for n in sorted(results)]


def _write_index(
    campaign: Campaign, out: Path, cases: Sequence[Case], results: Mapping[int, Result]
) -> None:
    rows = [
        {
            "name": cases[number].name,
            "folder": result.folder.name,
            "trial": cases[number].trial_name,
            "set": cases[number].set,
            "passed": result.passed,
            "status": result.status,
            "verdicts": [
                {"name": name, "check": check, **asdict(verdict)}
                for name, check, verdict in result.verdicts
            ],
        }
        for number, result in sorted(results.items())
    ]
    index = {
        "name": campaign.read_from.name,
        "title": campaign.file.title,
        "page": campaign.file.page,
        "left_out": campaign.left_out,
        "cases": rows,
    }
    write_json(out / INDEX, index, synced=True)
