"""Questions to a campaign: runs where the answer needs them, and the answer in a folder."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import closing
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from seatrial.errors import InputError, unknown
from seatrial.system.files import FileModel
from seatrial.trial.running.hooks import Hooks
from seatrial.trial.running.measuring import Measured
from seatrial.trial.running.output import claim_folder, write_json
from seatrial_kits.campaigns.asked import Asked, asked_of
from seatrial_kits.campaigns.campaign import INDEX, Campaign
from seatrial_kits.campaigns.columns import table_columns
from seatrial_kits.campaigns.ended import Ended
from seatrial_kits.campaigns.ended_log import EndedLog, ended_cases
from seatrial_kits.campaigns.evaluator import Plan
from seatrial_kits.campaigns.identity import identity_of
from seatrial_kits.campaigns.questions import (
    LimitsQuestion,
    Questions,
    RareQuestion,
    SensitivityQuestion,
    TuneQuestion,
    WorstCaseQuestion,
)
from seatrial_kits.campaigns.results.finding import ANSWER, Finding, read_answer
from seatrial_kits.campaigns.resuming import cut_aside
from seatrial_kits.campaigns.sampled_checks import check
from seatrial_kits.campaigns.sweep import Done, How, Sweep, changes_of, index_of, workers_of
from seatrial_kits.campaigns.table import Tables, arrow

from .asking import Asking, stopped
from .limits_answer import limits_question
from .rare import rare_question
from .sensitivity import sensitivity_question
from .space import Space, space_of
from .tune import tune_question
from .worst_case import worst_case_question

_ANSWERS: dict[str, tuple[type[FileModel], Callable[[Any, Asking], Callable[[], Finding]]]] = {
    "limits": (LimitsQuestion, limits_question),
    "rare": (RareQuestion, rare_question),
    "sensitivity": (SensitivityQuestion, sensitivity_question),
    "tune": (TuneQuestion, tune_question),
    "worst-case": (WorstCaseQuestion, worst_case_question),
}
"""Settings of each question, and what checks them and returns what answers it."""
_MOST = 10_000_000
"""Runs of a question: no number in a log is greater."""


def ask(
    campaign: Campaign,
    question: str,
    out: Path | None,
    how: How,
    hooks: Hooks | None = None,
    done: Done = lambda _case, _ended: None,
    expect: Callable[[int], None] = lambda _runs: None,
) -> tuple[Finding, Path]:
    """Ask a campaign a question, and return the answer and the folder that has it.

    The folder is as for `run_sweep`, with ``results.parquet`` of all runs in the order in which
    they were asked for, and ``answer.json`` with its tables and drawings. The answer depends on
    the campaign's files alone. ``expect`` is given the number of runs, if that is known before.

    Raises InputError for bad input before the first run, and for a library that is not installed;
    SimulationError for a stop.
    """
    hooks = hooks or Hooks()
    arrow()
    if question not in _ANSWERS:
        raise InputError(f"--ask: {unknown('question', question, _ANSWERS)}")
    cases = asked_of(campaign, question)
    settings = campaign.file.ask or Questions()
    space = space_of(campaign, question, f"{campaign.read_from.path}: ask")
    asking = Asking(campaign, cases, space, expect, how.engine, hooks, settings.seed)
    kind, prepared = _ANSWERS[question]
    entry = getattr(settings, question.replace("-", "_")) or kind()
    answer, space = prepared(entry, asking), asking.space
    plan = Plan(how.engine, how.keep or campaign.file.keep or "none", campaign.file.samples)
    identity = identity_of(campaign)
    index = index_of(campaign, identity, how.engine, 0, [question, settings.model_dump()])
    left = out if how.resume and out is not None and (out / INDEX).is_file() else None
    kept: dict[int, Ended] = {}
    if left is not None:
        changes = changes_of(left / INDEX, index, identity, how, hooks.note)
        if not changes and (left / ANSWER).is_file():
            try:
                return read_answer(left), left
            except InputError as error:
                cut_aside(left / ANSWER, error, hooks.note)
        kept = {} if changes else ended_cases(left, _MOST, hooks.note)
    plan = replace(plan, recorded=check(_edges(cases, space), plan, hooks))
    columns = table_columns(campaign, [cases.base], _values(cases, space))
    with closing(workers_of(campaign, cases, plan, how, hooks)) as workers:
        folder = left or claim_folder(out, f"{campaign.read_from.name}-{question}", INDEX)
        write_json(folder / INDEX, {**index, "cases": []})
        sweep = Sweep(cases, workers, folder, hooks)
        with EndedLog(folder) as log, Tables(folder, columns) as tables:
            runs = _Runs(sweep, log, tables, kept, done)
            asking.folder, asking.measured = folder, runs.measured
            finding = answer()
    finding.runs = len(cases)
    whole = {**index, "count": len(cases), "cases": sweep.summary.kept}
    write_json(folder / ANSWER, finding.content(), synced=True)
    write_json(folder / INDEX, whole, synced=True)
    log.path.unlink()
    return finding, folder


@dataclass
class _Runs:
    """Runs of a question, one batch after the other."""

    sweep: Sweep
    log: EndedLog
    tables: Tables
    kept: dict[int, Ended]
    done: Done

    def measured(self, numbers: range) -> list[Measured]:
        """Run the cases that were added last. Raises SimulationError if they were stopped."""
        found: dict[int, Measured] = {}

        def done(case: Any, ended: Ended) -> None:
            found[ended.number] = ended.measured
            self.done(case, ended)

        self.sweep.run(self.log, self.tables, self.kept, done)
        if len(found) < len(numbers):
            raise stopped(self.sweep.summary.ended, self.sweep.summary.folder)
        return [found[number] for number in numbers]


def _edges(cases: Asked, space: Space) -> Asked:
    """Return the middle of the space, and the ends of each key."""
    shares = np.full((1 + 2 * len(space.keys), len(space.keys)), 0.5)
    for i in range(len(space.keys)):
        shares[1 + 2 * i, i], shares[2 + 2 * i, i] = 0.0, 1.0
    edges = replace(cases, rows={})
    edges.add(space.settings(space.numbers(shares)))
    return edges


def _values(cases: Asked, space: Space) -> dict[str, list[Any]]:
    """Return what all cases set, and of each key that varies values of the kind that it has."""
    rows = space.settings(space.numbers(np.full((1, len(space.keys)), 0.3)))
    return {key: [value] for key, value in {**cases.common, **rows[0]}.items()}
