"""Campaigns: one or more trials over a set of parameters (``harness/campaigns/*.toml``)."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import closing
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any, Literal

from pydantic import Field

from ...errors import InputError, unknown
from ...system.fault_entry import FaultEntry
from ...system.files import FileModel, Source, find_file, read_toml, validated
from ...system.system import Engine
from ..files.map_entry import MapEntry
from ..files.trial import Trial, load_trial
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
        base = trial.changed(common, f"{origin}: set")
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


def load_campaign(name: str) -> Campaign:
    """Read the campaign ``name`` (shipped, in ``harness/campaigns``, or a path).

    Raises InputError for anything wrong in it or in its trials.
    """
    path = find_file("harness/campaigns", name)
    content, read_from = read_toml(path)
    file = validated(CampaignFile, content, path)
    trials = []
    for entry in file.trials:
        name = entry if isinstance(entry, str) else entry.trial
        try:
            trials.append(load_trial(name, path.parent))
        except InputError as error:
            raise InputError(f"{path}: trials: {error}") from None
    return Campaign(file, read_from, tuple(trials))


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
    index = {"name": campaign.read_from.name, "title": campaign.file.title, "cases": rows}
    write_json(out / INDEX, index, synced=True)
