"""A campaign run case by case, each into a folder of its own."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import closing
from dataclasses import asdict
from pathlib import Path

from seatrial.system.system import Engine
from seatrial.trial.records.identity import IDENTITY, Identity
from seatrial.trial.running.hooks import Hooks
from seatrial.trial.running.output import claim_folder, write_json
from seatrial.trial.running.run import Result
from seatrial.trial.running.supervised import Page

from .campaign import INDEX, Campaign
from .cases import Case, case_folders, run_cases
from .identity import changes_since, identity_of
from .resuming import Note, has_index, kept_results, set_aside

_UNWRITTEN = 0.01
"""Share of the cases in the index that may have ended since it was written, while others run.

It bounds what is written in all by some hundred times the index, however many cases there are.
"""


def run_campaign(
    campaign: Campaign,
    out: Path | None,
    *,
    engine: Engine = "fmu",
    jobs: int | None = None,
    page: Page | None = None,
    resume: bool = False,
    rerun_changed: bool = False,
    hooks: Hooks | None = None,
    done: Callable[[Case, Result], None] = lambda _case, _result: None,
) -> tuple[Path, list[tuple[Case, Result]]]:
    """Run every case into a folder of its own below ``out``, which must not hold anything yet.

    None makes a new folder ``runs/NAME-DATE-TIME``. With ``resume`` ``out`` may be what this
    campaign has left: cases that came to an end are kept, the others run again; with
    ``rerun_changed`` also those of trials whose files have changed since, which are refused
    without (`identity`). ``jobs`` cases run side by side, None: as many as there are cores; what
    they leave does not depend on it. ``page`` writes the report of each case, by its folder.
    ``done`` is called after each case, in the order of the cases. Stops after the cases that were
    asked to stop. A case that ends its process has failed.

    Returns the folder and the results of the cases that began. Raises InputError for bad input, in
    any case, and StoppedError, before the first one runs.
    """
    cases = campaign.cases()
    identity = identity_of(campaign)
    left = out if resume and out is not None and (out / INDEX).is_file() else None
    kept: dict[int, Result] = {}
    if left is not None:
        kept = _kept(left, cases, identity, (hooks or Hooks()).note, rerun_changed=rerun_changed)
    results = dict(kept)
    folder = Path()
    written = -1

    def write() -> None:
        nonlocal written
        _write_index(campaign, identity, folder, cases, results)
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


def _kept(
    left: Path, cases: Sequence[Case], identity: Identity, note: Note, *, rerun_changed: bool
) -> dict[int, Result]:
    """Return the results that stay of a folder's, by number; folders of others are set aside."""
    if not has_index(left / INDEX, note):
        return {}
    folders = case_folders(cases)
    known = {f: (case.name, case.set) for f, case in zip(folders, cases, strict=True)}
    found = {folders.index(r.folder.name): r for r in kept_results(left / INDEX, known, note)}
    changes = changes_since(left / INDEX, identity, note, rerun_changed=rerun_changed)
    touched = [n for n in found if changes.touches(cases[n].trial_name)]
    set_aside([left / folders[n] for n in touched])
    return {n: result for n, result in found.items() if n not in touched}


def _write_index(
    campaign: Campaign,
    identity: Identity,
    out: Path,
    cases: Sequence[Case],
    results: Mapping[int, Result],
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
        IDENTITY: identity.content(),
        "cases": rows,
    }
    write_json(out / INDEX, index, synced=True)
