"""Trials measured in the copies of one compiled program, which start anew for each."""

from __future__ import annotations

import hashlib
import time
from collections import Counter, OrderedDict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

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
from .settings import Each

Floats = NDArray[np.float64]

_WORTH = 30
"""So many trials must share a program before it is compiled, which takes seconds."""
_MANY = 300
"""So many trials in all are worth a program for the first of them."""
_MOST_PROGRAMS = 4
_COPIES = 32
"""Trials that a program measures at once."""
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


class _Case(NamedTuple):
    place: int
    trial: Trial
    values: dict[str, Any]
    """Numbers of its own."""


_SEEN: Counter[str] = Counter()
"""How many trials there were, by what they share."""
_PROGRAMS: OrderedDict[str, _Program | None] = OrderedDict()
"""By what trials share; None: they have no program."""


def measured(trials: Sequence[Trial], hooks: Hooks, planned: int = 1) -> list[Measured | None]:
    """Measure trials as `measure_trial` does with the engine "native"; None for each that C cannot.

    Of those, and of a mistake or a failure, `measure_trial` says what there is to say. Verdicts and
    figures have the same bytes. Once a stop is asked for, the first of those under way has stopped.
    ``planned`` is how many there are in all: the first of many have their program at once. Raises
    StoppedError.
    """
    found: list[Measured | None] = [None] * len(trials)
    alike: dict[str, list[_Case]] = {}
    for place, trial in enumerate(trials):
        if _is_plain(trial):
            shared, values = _parted(trial)
            _SEEN[shared] += 1
            alike.setdefault(shared, []).append(_Case(place, trial, values))
    for shared, cases in alike.items():
        first_of_many = planned > _MANY and (not _PROGRAMS or shared in _PROGRAMS)
        while (first_of_many or _SEEN[shared] > _WORTH) and cases:
            now, cases = cases[:_COPIES], cases[_COPIES:]
            for case, each in zip(now, _measured(shared, now, hooks), strict=True):
                found[case.place] = each
    return found


def _measured(shared: str, cases: Sequence[_Case], hooks: Hooks) -> list[Measured | None]:
    """Measure cases that share a program, no more than it has copies."""
    with hooks.interruptible():
        program = _program(shared, cases[0].values, cases[0].trial)
        begun = time.perf_counter()
        if program is None:
            return [None] * len(cases)
        try:
            _start(program, cases)
        except InputError:
            alone = len(cases) == 1
            return [None if alone else _measured(shared, [case], hooks)[0] for case in cases]
    hooks.refuse_if_stopped()
    hooks.assembled(program.batch.system, {"components": dict.fromkeys(program.batch.system.parts)})
    hooks.begun()
    try:
        with hooks.interruptible():
            found = _run([case.trial for case in cases], program, hooks)
    except KeyboardInterrupt:
        found = [Measured("stopped", None, cases[0].trial.file.seed), *[None] * (len(cases) - 1)]
    for each in filter(None, found):
        each.wall = (time.perf_counter() - begun) / len(cases)
    return found


def _start(program: _Program, cases: Sequence[_Case]) -> None:
    """Start a copy for each case. Raises InputError."""
    for key in program.built_in:
        if any(case.values[key] != program.values[key] for case in cases):
            raise InputError(f"{key} is built into the program")
    copies = [*cases, *[cases[0]] * (_COPIES - len(cases))]
    fresh = [key for key in cases[0].values if key not in program.built_in]
    program.batch.reset(
        _first(len(cases)),
        set={key: Each([case.values[key] for case in copies]) for key in fresh},
        seed=[case.trial.file.seed for case in copies],
    )


def _first(count: int) -> NDArray[np.bool_]:
    """Return the mask of the first copies."""
    return np.arange(_COPIES) < count


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
    shared = repr((trial.read_from.path, rig, content, rest, trial.figures))
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
    batch = Batch(trial, _COPIES)
    try:
        units = check_criteria(by_path(trial, batch.system), batch.system)
        built_in = frozenset(key for key in values if batch.is_built_in(key))
    except BaseException:
        batch.close()
        raise
    return _Program(batch, units, built_in, values)


def _run(trials: Sequence[Trial], program: _Program, hooks: Hooks) -> list[Measured | None]:
    """Step copies that have started, one for each trial, and return what these come to."""
    trial = by_path(trials[0], program.batch.system)  # others differ in numbers of components
    batch, steps, seeds = program.batch, trial.steps, [each.file.seed for each in trials]
    names = watched_signals(trial)
    ends = _Ends(trial, names, program.units)
    begun = batch.get(*names).reshape(_COPIES, 1, -1) if names else np.empty((_COPIES, 1, 0))
    blocks, taken = [begun[: len(trials)]], 0
    ended: dict[int, tuple[str, int]] = {}
    """Of copies that are over before their time: status, and how many rows they have."""
    going = _first(len(trials))
    # An event of the start may have ended one, as its values show once they are read.
    _look(begun, 0, going, ends, ended, batch.failures)
    while going.any() and taken < steps:
        if hooks.stop_requested():
            return [Measured("stopped", None, seeds[0]), *[None] * (len(trials) - 1)]
        count = min(_BLOCK, steps - taken)
        rows = batch.record(count, *names, mask=going)
        _look(rows, taken + 1, going, ends, ended, batch.failures)
        blocks.append(rows[: len(trials)].copy())  # a long trial is measured alone
        taken += count
    table = np.ascontiguousarray(np.concatenate(blocks, axis=1).swapaxes(1, 2))
    instants = (trial.start_ns + np.arange(table.shape[2]) * trial.rig.step_ns) / NS
    found: list[Measured | None] = []
    for copy, seed in enumerate(seeds):
        status, length = ended.get(copy, ("complete", table.shape[2]))
        if not going[copy] and copy not in ended:
            found.append(None)
            continue
        columns = {name: table[copy, i, :length] for i, name in enumerate(names)}
        found.append(_come_to(status, seed, trial, instants[:length], columns, program.units))
    return found


def _look(
    rows: Floats,
    before: int,
    going: NDArray[np.bool_],
    ends: _Ends,
    ended: dict[int, tuple[str, int]],
    failures: Mapping[int, str],
) -> None:
    """Note which of the copies that go on are over at one of the rows; ``before`` came earlier."""
    for copy in np.flatnonzero(going).tolist():
        status, row = (None, 0) if copy in failures else ends.status(rows[copy])
        if status is not None:
            ended[copy] = status, before + row + 1
        going[copy] = status is None and copy not in failures


def _come_to(
    status: str,
    seed: int,
    trial: Trial,
    instants: Floats,
    columns: Mapping[str, Floats],
    units: Mapping[str, str],
) -> Measured:
    verdicts = [
        verdict_row(name, entry.check, _verdict(criterion, entry, instants, columns, units))
        for entry, (name, criterion) in zip(trial.file.criteria, trial.criteria, strict=True)
    ]
    figures = [
        [float(c.min()), float(c.max()), float(c[-1])]
        for c in (columns[name] for name in trial.figures)
    ]
    return Measured(status, None, seed, verdicts, figures)


def _verdict(
    criterion: Criterion,
    entry: Any,
    instants: Floats,
    columns: Mapping[str, Floats],
    units: Mapping[str, str],
) -> Any:
    verdict = criterion.evaluate(instants, columns, units)
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
