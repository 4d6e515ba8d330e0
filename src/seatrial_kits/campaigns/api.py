"""Campaigns run whole: a result per case."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from seatrial.api.results import TrialResult
from seatrial.api.written import as_engine
from seatrial.errors import InputError

if TYPE_CHECKING:
    import pandas

    from seatrial.trial.running.hooks import Hooks

    from .campaign import Campaign
    from .sweep import How

Done = Callable[[object, object], None]


@dataclass(frozen=True)
class CaseResult:
    """One run of a campaign."""

    name: str
    trial: str
    """Name of its trial."""
    set: dict[str, Any]
    """Settings of the campaign, as written: ``component.port`` or a key of the trial."""
    folder: Path
    status: str
    passed: bool

    @cached_property
    def result(self) -> TrialResult:
        """The run. Raises InputError if its folder cannot be read."""
        return TrialResult(self.folder)


class CampaignResult:
    """The cases of a campaign: a view of its folder. Raises InputError for another folder."""

    def __init__(self, folder: Path | str) -> None:
        from seatrial.trial.records import run_schema
        from seatrial.trial.records.run_folder import CAMPAIGN

        self.folder = Path(folder)
        """The campaign's folder: ``campaign.json``, and the run folder of each case."""
        if not (self.folder / CAMPAIGN).is_file():
            raise InputError(f"{self.folder} is not a campaign folder: it has no {CAMPAIGN}")
        index = run_schema.checked_json(self.folder / CAMPAIGN, run_schema.CAMPAIGN)
        self.name = str(index["name"])
        table = index.get("table")
        self.table = None if table is None else self.folder / table
        """The table of all cases, ``results.parquet``, if the campaign has one."""
        self.cases = [self._case(entry) for entry in index["cases"]]
        """In the order of the campaign; beside a table those that have kept their folders."""
        self.criteria: list[dict[str, str]] = index.get("criteria", [])
        """Campaign's own criteria: ``name``, ``check``, ``verdict`` and ``detail``."""

    @cached_property
    def passed(self) -> bool:
        """True if the campaign's own criteria pass; without any, if every case does."""
        if self.criteria:
            return all(each["verdict"] == "pass" for each in self.criteria)
        return self._counted[0] == self._counted[1]

    @cached_property
    def _counted(self) -> tuple[int, int]:
        """Numbers of cases that passed, and of all cases."""
        if self.table is None:
            return sum(case.passed for case in self.cases), len(self.cases)
        from .table import read_rows

        found = [row["passed"] for row in read_rows(self.table, ["passed"])]
        return sum(found), len(found)

    def report(self) -> Path:
        """Write the pages of all cases and of the campaign; return the path of the latter.

        A page that a kit makes of the campaign comes too.
        """
        from .results.campaign_report import write_campaign_report
        from .results.further_page import write_further_page
        from .results.page import write_table_page

        if self.table is not None:
            return write_table_page(self.folder)
        for case in self.cases:
            case.result.report()
        write_further_page(self.folder)
        return write_campaign_report(self.folder)

    def to_pandas(self) -> pandas.DataFrame:
        """Return a table with a row per case, indexed by its name.

        Columns: ``trial``, ``status``, ``passed``, what was set, and of each criterion by its
        name whether it holds, and as ``NAME [UNIT]`` its worst value. Of a campaign with a table it
        is that, indexed by the number of the case. Raises InputError if pandas is not installed.
        """
        from seatrial.api.signals import needed

        library = needed("pandas", "to_pandas")
        if self.table is not None:
            whole: pandas.DataFrame = library.read_parquet(self.table).set_index("case")
            return whole
        rows = []
        for case in self.cases:
            row = {"trial": case.trial, "status": case.status, "passed": case.passed, **case.set}
            for verdict in case.result.verdicts:
                row[verdict.name] = verdict.passed
                row[f"{verdict.name} [{verdict.unit}]"] = verdict.worst
            rows.append(row)
        names = library.Index([case.name for case in self.cases], name="case")
        table: pandas.DataFrame = library.DataFrame(rows, index=names)
        return table

    def __repr__(self) -> str:
        passed, count = self._counted
        return f"<{self.name}: {passed} of {count} cases pass; {self.folder}>"

    def _case(self, entry: dict[str, Any]) -> CaseResult:
        return CaseResult(
            entry["name"],
            entry.get("trial", ""),
            entry["set"],
            self.folder / entry["folder"],
            entry["status"],
            entry["passed"],
        )


def run_campaign(
    campaign: str | Path,
    *,
    set: Mapping[str, Any] | None = None,
    out: str | Path | None = None,
    engine: str = "direct",
    jobs: int | None = None,
    keep: str | None = None,
    cluster: str | None = None,
    resume: bool = False,
    rerun_changed: bool = False,
    progress: Callable[[int, int], None] | None = None,
) -> CampaignResult:
    """Run every case of a campaign, as ``seatrial run`` does, and return what they left.

    ``campaign`` is a name or the path of a ``.toml`` file; ``set`` changes all cases, with keys as
    for `run_trial`; ``out`` and ``engine`` are as there, too. ``jobs`` cases run side by side,
    None: as many as there are cores; what they leave does not depend on it. ``keep`` ("all",
    "failed" or "none"), or that of the campaign's file, leaves a table of all cases, with the
    folders of those; ``cluster`` runs it on the workers of a Dask scheduler, ``HOST:PORT`` or
    ``tls://HOST:PORT``, on another host only if the environment has SEATRIAL_NETWORK=1. With
    ``resume``, ``out`` may be what the campaign has left: it goes on from there, unless files,
    seatrial or libraries have changed since; ``rerun_changed`` runs again what these touch.
    ``progress`` is called after each case with how many are done, and of how many. A case that
    could not go on, or whose process died, has the status ``failed`` and does not end the campaign.

    Raises InputError for bad input in any case, before the first one runs; KeyboardInterrupt for
    a campaign that was interrupted: its folder holds the cases so far, for
    `load_campaign_result`.
    """
    from seatrial.links.hardware import confined

    from .campaign import load_campaign
    from .sweep import How, keep_named

    loaded, kept = load_campaign(str(campaign), set), keep_named(keep, "keep")
    target = None if out is None else Path(out)
    count, finished = len(loaded.cases()), 0

    def done(_case: object, _ended: object) -> None:
        nonlocal finished
        finished += 1
        if progress is not None:
            progress(finished, count)

    how = How(as_engine(engine), jobs, cluster, kept, resume, rerun_changed)
    with confined():
        if loaded.has_table or kept is not None or cluster is not None:
            return CampaignResult(_swept(loaded, target, how, done))
        return CampaignResult(_run(loaded, target, how, done))


def _swept(campaign: Campaign, out: Path | None, how: How, done: Done) -> Path:
    from .sweep import run_sweep

    summary = run_sweep(campaign, out, how, _warning(), done)
    if not summary.whole:
        raise KeyboardInterrupt
    return summary.folder


def _warning() -> Hooks:
    from seatrial.trial.running.hooks import Hooks

    return Hooks(note=lambda text: warnings.warn(text, stacklevel=2))


def _run(campaign: Campaign, out: Path | None, how: How, done: Done) -> Path:
    from .in_folders import run_campaign as run

    folder, results = run(
        campaign,
        out,
        engine=how.engine,
        jobs=how.jobs,
        resume=how.resume,
        rerun_changed=how.rerun_changed,
        hooks=_warning(),
        done=done,
    )
    if any(result.status == "stopped" for _, result in results):
        raise KeyboardInterrupt
    return folder


def ask_campaign(
    campaign: str | Path,
    question: str,
    *,
    out: str | Path | None = None,
    engine: str = "direct",
    jobs: int | None = None,
    progress: Callable[[int], None] | None = None,
) -> dict[str, Any]:
    """Ask a campaign a question, as ``seatrial campaign NAME --ask`` does, and return the answer.

    It is what ``answer.json`` has (``values`` by name, ``lines`` in words, ``tables``,
    ``figures``), and ``folder``, a path. ``campaign``, ``out``, ``engine`` and ``jobs`` are as for
    `run_campaign`; ``progress`` is called after each run with how many are done. Raises InputError
    for bad input before the first run, and for a library that is not installed.
    """
    from seatrial.links.hardware import confined
    from seatrial.plugins import service

    from .campaign import load_campaign
    from .cases import Case
    from .ended import Ended
    from .sweep import How

    finished = 0

    def done(_case: Case, _ended: Ended) -> None:
        nonlocal finished
        finished += 1
        if progress is not None:
            progress(finished)

    with confined():
        target = None if out is None else Path(out)
        how = How(as_engine(engine), jobs)
        ask = service("search.ask")
        finding, folder = ask(load_campaign(str(campaign)), question, target, how, done=done)
    return {**finding.content(), "folder": folder}


def load_campaign_result(folder: str | Path) -> CampaignResult:
    """Read the folder that a campaign left. Raises InputError for another folder."""
    return CampaignResult(folder)
