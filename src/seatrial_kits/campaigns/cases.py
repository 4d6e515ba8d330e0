"""Cases of a campaign: trials with their settings, run side by side, their results in order."""

from __future__ import annotations

import re
from collections.abc import Callable, Generator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from seatrial.system.system import Engine
from seatrial.trial.files.trial import Trial
from seatrial.trial.running.hooks import Hooks
from seatrial.trial.running.run import Result
from seatrial.trial.running.supervised import Page

from .pool import Pool, cores
from .resuming import set_aside


@dataclass(frozen=True)
class Case:
    """One run of a campaign."""

    name: str
    made: Callable[[], Trial]
    """Makes its trial. Raises what `Trial.changed` raises."""
    set: dict[str, Any]
    trial_name: str

    @property
    def trial(self) -> Trial:
        """Its trial, made anew. Raises what `Trial.changed` raises."""
        return self.made()


def changed_cases(trial: Trial, settings: Sequence[Mapping[str, Any]], origin: str) -> list[Case]:
    """Return a case of ``trial`` for each of ``settings``: values by the keys they change.

    Keys and values are checked by `run_cases`, with errors that name ``origin``.
    """
    made = (partial(trial.changed, each, origin) for each in settings)
    pairs = zip(settings, made, strict=True)
    return [Case(case_name(trial, s), each, {**s}, trial.name) for s, each in pairs]


def case_name(trial: Trial, chosen: Mapping[str, Any]) -> str:
    """Return the name of ``trial`` and what was chosen, by the last part of its keys."""
    short = [key.rpartition(".")[2] for key in chosen]
    parts = [
        f"{name if short.count(name) == 1 else key} {value}"
        for name, (key, value) in zip(short, chosen.items(), strict=True)
    ]
    return ", ".join([trial.name, *parts])


def case_folders(cases: Sequence[Case]) -> list[str]:
    """Return the name of each case's folder: its number, from 1, and its name."""
    return [case_folder(number, case) for number, case in enumerate(cases, 1)]


def case_folder(number: int, case: Case) -> str:
    """Return the name of the folder of a case, by its number from 1."""
    return f"{number:02d}-{_slug(case.name)}"


def run_cases(
    cases: Sequence[Case],
    folder: Callable[[], Path],
    *,
    engine: Engine = "fmu",
    jobs: int | None = None,
    page: Page | None = None,
    hooks: Hooks | None = None,
    kept: Mapping[int, Result] | None = None,
    ended: Callable[[int, Result], None] = lambda _number, _result: None,
) -> Generator[tuple[int, Result], None, None]:
    """Run ``cases``, and yield index (from 0) and result of each, in the order of the cases.

    All cases are checked before the first one runs; then ``folder`` is called, once, and returns
    the folder they run below, each in its own (`case_folders`). What is there of a case already
    is renamed. ``jobs`` cases run side by side, None: as many as there are cores; no result
    depends on it. ``page`` writes the report of each case. ``kept`` has results, by index, of
    cases that need not run; they are yielded with the others. ``ended`` is called as each case
    comes to its end, in whatever order that is.

    After a case that was asked to stop no other one begins; those that had begun are still
    yielded in order, with gaps. Closing the iterator ends the cases that run. A case that ends
    its process has failed. Raises InputError for bad input in any case, and StoppedError, before
    the first one runs.
    """
    results = dict(kept or {})
    shown = 0
    with Pool([case.trial for case in cases], engine, hooks, jobs or cores(), page) as pool:
        pool.check()
        below = folder()
        names = enumerate(case_folders(cases))
        waiting = {number: below / name for number, name in names if number not in results}
        set_aside(list(waiting.values()))
        while shown in results:
            yield shown, results.pop(shown)
            shown += 1
        for number, result in pool.run(waiting):
            results[number] = result
            ended(number, result)
            while shown in results:
                yield shown, results.pop(shown)
                shown += 1
    yield from sorted(results.items())  # of cases that were stopped


def _slug(name: str) -> str:
    return re.sub(r"[^A-Za-z0-9.]+", "-", name).strip("-")[:80]
