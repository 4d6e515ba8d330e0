"""Trials measured one after the other in one compiled program, which starts anew for each."""

from __future__ import annotations

import hashlib
import time
from collections import Counter, OrderedDict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from seatrial.errors import InputError
from seatrial.model.component import NS
from seatrial.model.units import split_quantity, unit
from seatrial.trial.criteria.criteria import Criterion
from seatrial.trial.criteria.formulas import Formula
from seatrial.trial.criteria.predicates import Record
from seatrial.trial.criteria.robustness import Evaluation
from seatrial.trial.files.naming import by_path
from seatrial.trial.files.surroundings import GROUPS
from seatrial.trial.files.trial import Trial
from seatrial.trial.running.checks import check_criteria
from seatrial.trial.running.hooks import Hooks
from seatrial.trial.running.measuring import Measured, verdict_row
from seatrial.trial.running.stepping import watched_signals

from .batch import Batch

Floats = NDArray[np.float64]

_WORTH = 30
"""So many trials must share a program before it is compiled, which takes seconds."""
_MOST_PROGRAMS = 4
_BLOCK = 2000
"""Communication steps between two looks at orders to stop, and at criteria that end a run."""


@dataclass
class _Program:
    """A program that is kept, with what is built into it."""

    batch: Batch
    units: dict[str, str]
    built_in: frozenset[str]
    """Keys of settings, of which it has the values that it was made with."""
    values: Mapping[str, Any]


_SEEN: Counter[str] = Counter()
"""How many trials there were, by what they share."""
_PROGRAMS: OrderedDict[str, _Program | None] = OrderedDict()
"""By what trials share; None: they have no program."""


def measured(trial: Trial, hooks: Hooks) -> Measured | None:
    """Measure a trial as `measure_trial` does with the engine "native"; None if C cannot.

    Then, and of a mistake or a failure, `measure_trial` says what there is to say. Verdicts and
    figures have the same bytes. Raises StoppedError.
    """
    if not _is_plain(trial):
        return None
    begun = time.perf_counter()
    shared, values = _parted(trial)
    _SEEN[shared] += 1
    if _SEEN[shared] <= _WORTH:
        return None
    with hooks.interruptible():
        try:
            program = _program(shared, values, trial)
            if program is None:
                return None
            fresh = {k: v for k, v in values.items() if k not in program.built_in}
            program.batch.reset(set=fresh, seed=[trial.file.seed])
        except InputError:
            return None
    hooks.refuse_if_stopped()
    hooks.assembled(program.batch.system, {"components": dict.fromkeys(program.batch.system.parts)})
    hooks.begun()
    try:
        with hooks.interruptible():
            found = _run(trial, program, hooks)
    except KeyboardInterrupt:
        found = Measured("stopped", None, trial.file.seed)
    if found is not None:
        found.wall = time.perf_counter() - begun
    return found


def _is_plain(trial: Trial) -> bool:
    """Say if a trial has nothing that the program has not."""
    file, limit = trial.file, trial.file.limit
    special = file.real_time or file.utc or trial.scenario or trial.scales or trial.isolated
    texts = any("text" in kinds for _, c in trial.criteria for kinds in c.kinds.values())
    limited = limit.is_of_run or limit.call is not None  # who dies of one says in which call
    return not (special or texts or trial.start_ns or limited)


def _parted(trial: Trial) -> tuple[str, dict[str, Any]]:
    """Return what cases with one program share, and the numbers that each may have of its own."""
    content = trial.file.model_dump(exclude={"seed", "title", "limit"}, exclude_none=True)
    values: dict[str, Any] = {}
    for group in GROUPS:
        for key, value in list(content.get(group, {}).items()):
            if key != "douglas" and _is_number(value):
                values[f"{group}.{key}"] = value
                content[group][key] = "a number"
    rest = []
    for key, written, _ in trial.overrides:
        if _is_number(written):
            values[key] = written
            rest.append((key, "a number"))
        else:
            rest.append((key, repr(written)))
    rig = trial.rig.read_from.path, repr(trial.rig_changes)
    shared = repr((trial.read_from.path, rig, content, rest))
    return hashlib.sha256(
        shared.encode()
    ).hexdigest(), values  # short: there may be as many as cases


def _is_number(written: Any) -> bool:
    if isinstance(written, (list, tuple)):
        return all(map(_is_number, written))
    if isinstance(written, str):
        return split_quantity(written) is not None
    return isinstance(written, (int, float)) and not isinstance(written, bool)


def _program(shared: str, values: Mapping[str, Any], trial: Trial) -> _Program | None:
    kept = _PROGRAMS.get(shared)
    if shared in _PROGRAMS:
        _PROGRAMS.move_to_end(shared)
        if kept is None or all(kept.values[key] == values[key] for key in kept.built_in):
            return kept
        kept.batch.close()
    try:
        made = _made(trial, values)
    except InputError:
        made = None  # the system is run as it always is
    _PROGRAMS[shared] = made
    while len(_PROGRAMS) > _MOST_PROGRAMS:
        _, oldest = _PROGRAMS.popitem(last=False)
        if oldest is not None:
            oldest.batch.close()
    return made


def _made(trial: Trial, values: Mapping[str, Any]) -> _Program:
    batch = Batch(trial, 1)
    try:
        units = check_criteria(by_path(trial, batch.system), batch.system)
        built_in = frozenset(key for key in values if batch.is_built_in(key))
    except BaseException:
        batch.close()
        raise
    return _Program(batch, units, built_in, values)


def _run(trial: Trial, program: _Program, hooks: Hooks) -> Measured | None:
    trial = by_path(trial, program.batch.system)
    names = watched_signals(trial)
    batch, steps, seed = program.batch, trial.steps, trial.file.seed
    ends = _Ends(trial, names, program.units)
    blocks = [batch.get(*names).reshape(1, -1) if names else np.empty((1, 0))]
    if batch.failures:  # an event of the start has ended it, as its values show once they are read
        return None
    taken, status = 0, ends.status(blocks[0])[0]
    while status is None and taken < steps:
        if hooks.stop_requested():
            return Measured("stopped", None, seed)
        count = min(_BLOCK, steps - taken)
        rows = batch.record(count, *names)[0]
        if batch.failures:
            return None
        status, row = ends.status(rows)
        blocks.append(rows[: row + 1] if status else rows)
        taken += count
    table = np.concatenate(blocks)
    step_ns = trial.rig.step_ns
    instants = (trial.start_ns + np.arange(len(table)) * step_ns) / NS
    columns = {name: np.ascontiguousarray(table[:, i]) for i, name in enumerate(names)}
    verdicts = [
        verdict_row(name, entry.check, _verdict(criterion, entry, instants, columns, program))
        for entry, (name, criterion) in zip(trial.file.criteria, trial.criteria, strict=True)
    ]
    figures = [
        [float(c.min()), float(c.max()), float(c[-1])]
        for c in (columns[name] for name in trial.figures)
    ]
    return Measured(status or "complete", None, seed, verdicts, figures)


def _verdict(
    criterion: Criterion, entry: Any, instants: Floats, columns: Mapping[str, Floats], of: _Program
) -> Any:
    verdict = criterion.evaluate(instants, columns, of.units)
    return replace(verdict, expected=entry.expect, why=entry.why)


class _Ends:
    """Criteria with ``ends``, as `TerminationConditions` evaluates them, of many rows at once."""

    def __init__(self, trial: Trial, names: Sequence[str], units: Mapping[str, str]) -> None:
        self._conditions: list[Formula] = []
        self._goals: list[Formula] = []
        for entry, (_, criterion) in zip(trial.file.criteria, trial.criteria, strict=True):
            if entry.ends and criterion.condition is not None:
                self._conditions.append(criterion.condition)
            elif entry.ends and criterion.goal is not None:
                self._goals.append(criterion.goal)
        self._names = names
        self._scales = [unit(units[name]) for name in names]

    def status(self, rows: Floats) -> tuple[str | None, int]:
        """Return the status of a run that is over at one of the rows, and which it is."""
        if not self._conditions and not self._goals:
            return None, 0
        numbers = {
            name: rows[:, i] * scale.factor + scale.offset
            for i, (name, scale) in enumerate(zip(self._names, self._scales, strict=True))
        }
        evaluation = Evaluation(Record(np.zeros(len(rows)), numbers))
        holds = [evaluation.margins(each)[0] > 0.0 for each in (*self._conditions, *self._goals)]
        broken = ~np.logical_and.reduce(
            holds[: len(self._conditions)] or [np.ones(len(rows), bool)]
        )
        met = np.logical_or.reduce(holds[len(self._conditions) :] or [np.zeros(len(rows), bool)])
        over = np.flatnonzero(broken | met)
        if not len(over):
            return None, 0
        return ("ended" if broken[over[0]] else "complete"), int(over[0])
