"""A campaign run into its tables: cases to workers, what they leave in case order."""

from __future__ import annotations

import hashlib
import json
import math
import shutil
import time
from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, wait
from contextlib import closing
from dataclasses import dataclass, field, replace
from itertools import islice
from pathlib import Path
from typing import Any, get_args

from seatrial.errors import InputError, unknown
from seatrial.shipped import provided_folders
from seatrial.system.system import Engine
from seatrial.trial.records.identity import IDENTITY, Changes, Identity
from seatrial.trial.records.run_schema import CAMPAIGN, checked_json
from seatrial.trial.running.hooks import Hooks
from seatrial.trial.running.measuring import Measured
from seatrial.trial.running.output import claim_folder, write_json

from .acceptance import Accepted, accepted, check_columns
from .asked import Asked
from .campaign import INDEX, Campaign
from .case_list import Cases
from .cases import Case
from .cluster import Cluster, check_address
from .columns import columns_of
from .ended import Ended
from .ended_log import ENDED_LOG, EndedLog, ended_cases
from .evaluator import Keep, Plan
from .identity import changes_since, identity_of
from .resuming import Note, cut_aside, has_index, set_aside
from .sampled_checks import check
from .shipment import unpack_folder
from .table import RESULTS, Tables, arrow, read_rows
from .workers import Here, Task, Workers

Done = Callable[[Case, Ended], None]
_UNDECIDING = {"title", "keep", "samples", "ask", "map", "criteria", "limit"}
"""Keys of a campaign that change no run that comes to an end."""
_SLICE_S = 0.2
"""A stop is noticed within this time."""


@dataclass(frozen=True)
class How:
    """How a campaign is run: on this machine, ``jobs`` side by side, or on a cluster.

    Raises InputError for a cluster of another host, unless that is allowed.
    """

    engine: Engine = "fmu"
    jobs: int | None = None
    cluster: str | None = None
    keep: Keep | None = None
    """In place of what the campaign says."""
    resume: bool = False
    rerun_changed: bool = False
    """With ``resume``: cases of trials whose files have changed run again, or are refused."""

    def __post_init__(self) -> None:
        if self.cluster is not None:
            check_address(self.cluster)


def keep_named(keep: str | None, origin: str) -> Keep | None:
    """Return what ``keep`` names, None for None. Raises InputError, naming ``origin``."""
    for known in get_args(Keep):
        if keep == known:
            return keep  # type: ignore[return-value]
    if keep is None:
        return None
    raise InputError(f"{origin}: {unknown('choice', keep, get_args(Keep))}")


@dataclass
class Summary:
    """What a campaign has come to."""

    folder: Path
    planned: int
    ended: int = 0
    failed: int = 0
    """Cases that did not pass."""
    broken: int = 0
    """Of them those whose run could not go on."""
    enough: bool = False
    """The campaign's stopping rule was met before all cases had run."""
    kept: list[dict[str, Any]] = field(default_factory=list)
    """Entries of the cases whose folders stay, for the index."""
    accepted: list[Accepted] = field(default_factory=list)
    """What became of the campaign's own criteria."""

    @property
    def whole(self) -> bool:
        """True if there is nothing left to run."""
        return self.enough or self.ended == self.planned

    def count(self, case: Case, ended: Ended) -> None:
        """Count a case."""
        measured = ended.measured
        self.ended += 1
        self.failed += not measured.passed
        self.broken += measured.status == "failed"
        if ended.folder:
            self.kept.append(_entry(case, ended))


def run_sweep(
    campaign: Campaign,
    out: Path | None,
    how: How,
    hooks: Hooks | None = None,
    done: Done = lambda _case, _ended: None,
) -> Summary:
    """Run a campaign into ``results.parquet`` and ``timing.parquet`` below ``out``.

    ``out`` must not hold anything yet; None makes a new folder ``runs/NAME-DATE-TIME``. With
    ``how.resume`` it may be what this campaign has left. ``done`` is called for each case, in case
    order. Stops, keeping what is there, once ``hooks.stop_requested``. The table of results
    depends on the campaign's files alone, not on who runs it.

    Raises InputError for bad input before the first case runs (see `sampled_checks`), StoppedError.
    """
    hooks = hooks or Hooks()
    arrow()
    cases, file = campaign.cases(), campaign.file
    plan = Plan(how.engine, how.keep or file.keep or "all", file.samples)
    identity = identity_of(campaign)
    index = index_of(campaign, identity, how.engine, len(cases))
    left = out if how.resume and out is not None and (out / INDEX).is_file() else None
    kept: dict[int, Ended] = {}
    if left is not None:
        changes = changes_of(left / INDEX, index, identity, how, hooks.note)
        if not changes and (left / RESULTS).is_file() and not (left / ENDED_LOG).is_file():
            try:
                return _summary(left, len(cases), campaign)
            except InputError as error:
                cut_aside(left / RESULTS, error, hooks.note)
        kept = without_touched(ended_cases(left, len(cases), hooks.note), cases, changes, left)
    columns = columns_of(campaign)
    check_columns(campaign.acceptance, [column.name for column in columns])
    plan = replace(plan, recorded=check(cases, plan, hooks))
    with closing(workers_of(campaign, cases, plan, how, hooks)) as workers:
        folder = left or claim_folder(out, campaign.read_from.name, INDEX)
        write_json(folder / INDEX, {**index, "cases": []}, synced=True)
        sweep = Sweep(cases, workers, folder, hooks, campaign.is_enough)
        with EndedLog(folder) as log, Tables(folder, columns) as tables:
            sweep.run(log, tables, kept, done)
    summary = sweep.summary
    write_json(folder / INDEX, {**index, "cases": summary.kept}, synced=True)
    summary.accepted = _accepted(campaign, folder)
    said = {"criteria": [each.content() for each in summary.accepted]}
    write_json(folder / INDEX, {**index, **said, "cases": summary.kept}, synced=True)
    if summary.whole:
        log.path.unlink()
    return summary


def workers_of(
    campaign: Campaign, cases: Cases | Asked, plan: Plan, how: How, hooks: Hooks
) -> Workers:
    """Return who runs the cases. Raises what `Cluster` raises."""
    if how.cluster is None:
        return Here(cases, plan, how.jobs, hooks)
    asked = cases if isinstance(cases, Asked) else None
    return Cluster(how.cluster, campaign, plan, asked)


class Sweep:
    """Cases under way: some wait, some run, some have ended before others that come first.

    There may be more of them after a run: the next one begins there.
    """

    def __init__(
        self,
        cases: Cases | Asked,
        workers: Workers,
        folder: Path,
        hooks: Hooks,
        is_enough: Callable[[int, int], bool] = lambda _failed, _count: False,
    ) -> None:
        self._cases, self._ends = cases, is_enough
        self._workers, self._folder, self._hooks = workers, folder, hooks
        self._running: dict[Future[list[Ended | None]], Task] = {}
        self._begun: dict[Future[list[Ended | None]], float] = {}
        """When tasks were first seen to run, monotonic wall time, s."""
        self._again: deque[Task] = deque()
        self._early: dict[int, Ended] = {}
        self._stopping = False
        self._wall = math.inf
        """Of a case, on average so far, s."""
        self.summary = Summary(folder, len(self._cases))

    def run(self, log: EndedLog, tables: Tables, kept: dict[int, Ended], done: Done) -> None:
        """Run all cases but those ``kept``, and write each."""
        planned = range(self.summary.ended, len(self._cases))
        self.summary.planned = len(self._cases)
        self._early = {n: kept[n] for n in planned if n in kept}
        numbers = (n for n in planned if n not in kept)

        def hand_on(number: int) -> None:
            case, ended = self._cases[number], self._early.pop(number)
            tables.add(case, ended)
            self.summary.count(case, ended)
            done(case, ended)

        while True:
            while not self.summary.enough and self.summary.ended in self._early:
                hand_on(self.summary.ended)
                self.summary.enough = self._ends(self.summary.failed, self.summary.ended)
            self._stopping |= self.summary.enough or self._hooks.stop_requested() > 0
            self._submit(numbers)
            if not self._running:
                break
            for ended in self._ready():
                log.add(ended)
                self._early[ended.number] = ended
            self._say_longest()
        for number in sorted(self._early):  # of a stop: behind a case that has not ended
            if self.summary.enough:
                self._drop(self._early[number])
            else:
                hand_on(number)

    # ------------------------------------------------------------------ inside

    def _submit(self, numbers: Iterator[int]) -> None:
        """Begin tasks for all places; once it is to stop, cancel what has not begun."""
        if self._stopping:
            for future in list(self._running):
                if future.cancel() or self.summary.enough or self._hooks.stop_requested() > 1:
                    del self._running[future]
                    self._begun.pop(future, None)
            return
        places = self._workers.places - len(self._running)
        for _ in range(places):
            size = self._workers.size(self._wall)
            task = self._again.popleft() if self._again else tuple(islice(numbers, size))
            if not task:
                return
            self._running[self._workers.submit(task, self._folder)] = task

    def _ready(self) -> Iterator[Ended]:
        """Wait a moment, and yield what has ended."""
        ready, _ = wait(self._running, _SLICE_S, FIRST_COMPLETED)
        for future in ready:
            task = self._running.pop(future)
            self._begun.pop(future, None)
            if (error := future.exception()) is not None:
                if not self._workers.lost(error):
                    raise error
                if len(task) == 1:
                    yield Ended(task[0], Measured("failed", "each worker that ran it has died"))
                self._again += [(number,) for number in task if len(task) > 1]
                continue
            for ended in filter(None, future.result()):
                if ended.files is not None:
                    unpack_folder(ended.files, self._folder)
                known = math.isfinite(self._wall)
                wall = ended.measured.wall
                self._wall = 0.9 * self._wall + 0.1 * wall if known else wall
                yield ended

    def _say_longest(self) -> None:
        now = time.monotonic()
        for future in self._running:
            if future.running():
                self._begun.setdefault(future, now)
        if self._begun:
            oldest = min(self._begun, key=self._begun.__getitem__)
            number, wall = self._running[oldest][0], now - self._begun[oldest]
            self._hooks.under_way(self.summary.ended + len(self._early), number, wall)

    def _drop(self, ended: Ended) -> None:
        """Remove what a case has left that ran though those before it were enough."""
        if ended.folder:
            shutil.rmtree(self._folder / ended.folder, ignore_errors=True)


def index_of(
    campaign: Campaign, identity: Identity, engine: Engine, count: int, question: Any = None
) -> dict[str, Any]:
    """Return the index of a campaign's folder, or of a question's, without its cases."""
    file = campaign.file.model_dump(exclude=_UNDECIDING)
    asked = [] if question is None else [question]
    said = json.dumps([engine, file, *asked], default=str)
    drawn = campaign.file.map if question is None else None
    return {
        "name": campaign.read_from.name,
        "file": _called(campaign.read_from.path),
        "engine": engine,
        "title": campaign.file.title,
        "table": RESULTS,
        "count": count,
        "map": None if drawn is None else drawn.model_dump(),
        "of": hashlib.sha256(said.encode()).hexdigest(),
        IDENTITY: identity.content(),
    }


def _called(path: Path) -> str:
    """Return what a command calls a campaign by, in the folder of its file or of its harness."""
    of_user = path.parent.name == "campaigns" and path.parent.parent.name == "harness"
    is_named = of_user or path.parent in provided_folders("harness/campaigns")
    return path.stem if is_named else path.name


def refuse_other(path: Path, index: Mapping[str, Any]) -> None:
    """Raise InputError for the index of another campaign."""
    if checked_json(path, CAMPAIGN).get("of") != index["of"]:
        raise InputError(
            f"{path}: it is of another campaign, of this one before its file changed, or of "
            "another engine: name the folder that this campaign has left, or another one without "
            "--resume"
        )


def changes_of(
    path: Path, index: Mapping[str, Any], identity: Identity, how: How, note: Note
) -> Changes:
    """Return what has changed since a folder's index was written (`changes_since`).

    Raises InputError for the index of another campaign.
    """
    if not has_index(path, note):
        return Changes((), {})
    refuse_other(path, index)
    return changes_since(path, identity, note, rerun_changed=how.rerun_changed)


def without_touched(
    kept: dict[int, Ended], cases: Sequence[Case], changes: Changes, folder: Path
) -> dict[int, Ended]:
    """Return the cases that changes do not touch; folders of the others are set aside."""
    touched = {n for n in kept if changes.touches(cases[n].trial_name)}
    set_aside([folder / kept[n].folder for n in sorted(touched) if kept[n].folder])
    return {n: ended for n, ended in kept.items() if n not in touched}


def _accepted(campaign: Campaign, folder: Path) -> list[Accepted]:
    """Return what becomes of a campaign's own criteria on the table in its folder."""
    until = campaign.file.until
    rows = list(read_rows(folder / RESULTS)) if campaign.file.criteria else []
    is_sequential = until is not None and until.decided
    trials: dict[str, set[str]] = {}
    for trial in campaign.trials:
        for name, _ in trial.criteria:
            trials.setdefault(name, set()).add(trial.name)
    return accepted(campaign.acceptance, rows, trials, at_any_case=is_sequential)


def _summary(folder: Path, planned: int, campaign: Campaign) -> Summary:
    """Return the summary of a folder whose campaign has come to its end."""
    summary = Summary(folder, planned)
    for row in read_rows(folder / RESULTS, ["passed", "status"]):
        summary.ended += 1
        summary.failed += not row["passed"]
        summary.broken += row["status"] == "failed"
    summary.enough = summary.ended < planned
    summary.accepted = _accepted(campaign, folder)
    return summary


def _entry(case: Case, ended: Ended) -> dict[str, Any]:
    measured = ended.measured
    keys = ("name", "check", "passed", "detail", "worst", "unit", "robustness", "expected")
    return {
        "name": case.name,
        "folder": ended.folder,
        "trial": case.trial_name,
        "set": case.set,
        "passed": measured.passed,
        "status": measured.status,
        "verdicts": [{key: v[key] for key in keys} for v in measured.verdicts],
    }
