"""Campaigns: one or more trials over a set of parameters (``harness/campaigns/*.toml``)."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from pydantic import Field

from ..cosim.fault_entry import FaultEntry
from ..cosim.files import FileModel, Source, find_file, read_toml, validated
from ..cosim.system import Engine
from ..errors import InputError
from .cases import Case, case_folders, case_name, run_cases
from .designs import Design, drawn
from .hooks import Hooks
from .output import claim_folder, write_json
from .resuming import kept_results
from .run import Result
from .supervised import Page
from .trial import Trial, load_trial

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


@dataclass(frozen=True)
class Campaign:
    """A campaign file, read, with its trials."""

    file: CampaignFile
    read_from: Source
    trials: tuple[Trial, ...]
    """Those of ``file.trials``, in that order."""

    def cases(self) -> list[Case]:
        """Return all cases, in the order of the file."""
        pairs = zip(self.trials, self.file.trials, strict=True)
        return [case for trial, entry in pairs for case in self._cases(trial, entry)]

    def _cases(self, trial: Trial, entry: str | TrialEntry) -> Iterator[Case]:
        origin = str(self.read_from.path)
        own = TrialEntry(trial=entry) if isinstance(entry, str) else entry
        common, grid = {**self.file.set, **own.set}, {**self.file.grid, **own.grid}
        base = trial.changed(common, f"{origin}: set")
        for chosen, where in self._chosen(grid, origin):
            varied = base.changed(chosen, where)
            for named, failing in self._failing(varied):
                found = {**chosen, **named}
                yield Case(case_name(trial, found), failing, {**common, **found})
                yield from self._scaled(failing, common, found)

    def _chosen(
        self, grid: Mapping[str, list[Any]], origin: str
    ) -> Iterator[tuple[dict[str, Any], str]]:
        """Yield the settings of each case of grid and design, and where they are written."""
        design, where = self.file.design, f"{origin}: grid"
        rows: list[dict[str, Any]] = [{}]
        if design is not None:
            where = f"{origin}: grid and design"
            if twice := design.vary.keys() & grid.keys():
                raise InputError(f"{origin}: design: vary: {min(twice)} is a key of grid too")
            rows = drawn(design, f"{origin}: design")
        for values in itertools.product(*grid.values()):
            for row in rows:
                yield {**dict(zip(grid, values, strict=True)), **row}, where

    def _failing(self, trial: Trial) -> Iterator[tuple[dict[str, str], Trial]]:
        """Yield the trial with the faults of each name; without any, as it is."""
        if not self.file.faults:
            yield {}, trial
        for name, entries in self.file.faults.items():
            yield {"faults": name}, trial.with_faults(entries)

    def _scaled(
        self, trial: Trial, common: Mapping[str, Any], chosen: dict[str, Any]
    ) -> Iterator[Case]:
        for key, factors in self.file.scale.items():
            for factor in factors:
                scaled = trial.scaled(key, factor, f"{self.read_from.path}: scale")
                shown = {**chosen, f"{key} times": factor}
                yield Case(case_name(trial, shown), scaled, {**common, **shown})


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
        kept = {folders.index(r.folder.name): r for r in kept_results(left / INDEX, known)}
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
            "trial": cases[number].trial.name,
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
    write_json(out / INDEX, index)
