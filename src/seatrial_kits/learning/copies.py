"""A task's copies: episodes begin, agents act, rewards and ends follow."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from seatrial.errors import InputError
from seatrial.model.units import unit
from seatrial.trial.criteria.formulas import kinds, looks_ahead
from seatrial.trial.criteria.predicates import Record
from seatrial.trial.criteria.robustness import Evaluation
from seatrial_kits.batch.batch import Batch

from .margins import Margins, is_of_past
from .task import Reward, Task, in_port_unit

Floats = NDArray[np.float64]
Mask = NDArray[np.bool_]

_TIME_UP = "time"
_TINY = 2.0**-40
"""How near to 0 and 1 a probability comes, as in campaigns."""


@dataclass(frozen=True)
class Made:
    """What came of a decision, of each copy."""

    rewards: Floats
    terminated: Mask
    truncated: Mask
    is_success: Mask
    ended_by: Any
    """Name of the end, ``time``, or why the copy cannot go on; of others empty."""


class Copies:
    """Raises InputError for a task that does not fit its system."""

    def __init__(self, task: Task, batch: Batch) -> None:
        self._task, self._batch, self._count = task, batch, batch.count
        described = {**batch.parameters, **batch.inputs, **batch.signals}
        units = {name: signal.unit for name, signal in described.items() if signal.type is not str}
        for name in task.signals:
            task.require(name, units)
        task.check(units)
        self._observed, self._acted = task.observed(units), task.acted(units)
        step_ns = round(batch.step_size * 1e9)
        self._steps, rest = divmod(task.decision_ns, step_ns)
        if rest:
            raise InputError(
                f"{task.path}: decision: {task.file.decision!r} is not a whole number of "
                f"communication steps of {step_ns / 1e6:g} ms"
            )
        self._outputs = set(batch.signals)
        for at, acted in enumerate(self._acted):
            signal = described[acted.name]
            if acted.name not in self._outputs and not signal.tunable:
                why = f"it is fed by {signal.feeder}" if signal.feeder else "it is fixed in a run"
                raise InputError(f"{task.path}: act.{at}.to: {acted.name} cannot be set: {why}")
        self._names = task.signals
        scales = [unit(units[name]) for name in self._names]
        self._scale = np.array([scale.factor for scale in scales])
        self._offset = np.array([scale.offset for scale in scales])
        self._vary_units = {key: _port_unit(task, batch, units, key) for key in task.laws}
        count, period = self._count, task.decision
        self._margins = [
            Margins(r.says, count, period) if r.is_margin and is_of_past(r.says) else None  # type: ignore[arg-type]
            for r in task.rewards
        ]
        self._ends = [Margins(end.when, count, period) for end in task.ends]
        self._decided = np.zeros(count, dtype=np.int64)
        """Decisions since the start."""
        self._whole = {
            name
            for reward in task.rewards
            if reward.is_margin and not is_of_past(reward.says)  # type: ignore[arg-type]
            for name in kinds(reward.says)  # type: ignore[arg-type]
        }
        rows = task.decisions + 1 if self._whole else 0
        self._history = {name: np.zeros((rows, count)) for name in self._whole}
        self._now = self._read()

    # ------------------------------------------------------------------ episodes

    def begin(self, mask: Mask, randoms: Sequence[np.random.Generator]) -> None:
        """Start the copies of the mask anew, each with what its generator draws."""
        laws, count = self._task.laws, self._count
        drawn, seeds = np.full((count, len(laws)), 0.5), self._batch.seeds.copy()
        for i in np.flatnonzero(mask).tolist():
            seeds[i] = randoms[i].integers(2**31)
            drawn[i] = randoms[i].random(len(laws))
        drawn = np.clip(drawn, _TINY, 1.0 - _TINY)
        settings = {
            key: in_port_unit(law, self._vary_units[key], law.quantiles(drawn[:, column]))
            for column, (key, law) in enumerate(laws.items())
        }
        self._batch.reset(mask, set=settings, seed=seeds.tolist())
        self._decided[mask] = 0
        for margins in (*self._ends, *self._margins):
            if margins is not None:
                margins.start(mask)
        self._now = self._read()
        self._remember(mask)
        for margins in (*self._ends, *self._margins):
            if margins is not None:
                margins.at(self._now, mask)

    def act(self, actions: Floats, acting: Mask) -> Made:
        """Act, in [-1, 1], and go on to the next decision; copies that rest go on, too."""
        for column, acted in enumerate(self._acted):
            share = 0.5 * (actions[:, column] + 1.0)
            value = acted.low + share * (acted.high - acted.low)
            call = self._batch.override if acted.name in self._outputs else self._batch.set
            call(acted.name, value)
        self._batch.step(self._steps)
        self._now = now = self._read()
        self._decided += 1
        self._remember(acting)
        failures = self._batch.failures
        ended_by = np.full(self._count, "", dtype=object)
        terminated, is_success = (np.zeros(self._count, dtype=bool) for _ in range(2))
        rewards = np.zeros(self._count)
        for end, decisive in zip(self._task.ends, self._ends, strict=True):
            met = (decisive.at(now) > 0.0) & ~terminated
            ended_by[met], is_success[met] = end.name, end.is_success
            rewards[met] += end.reward
            terminated |= met
        for copy, why in failures.items():
            terminated[copy], is_success[copy], ended_by[copy] = True, False, why
        truncated = (self._decided >= self._task.decisions) & ~terminated
        ended_by[truncated] = _TIME_UP
        over = (terminated | truncated) & acting
        for reward, margins in zip(self._task.rewards, self._margins, strict=True):
            rewards += self._of(reward, margins, now, over)
        failed = np.fromiter(failures, dtype=np.int64)
        rewards[failed] = np.nan_to_num(rewards[failed], posinf=0.0, neginf=0.0)
        return Made(rewards, terminated, truncated, is_success, ended_by)

    def observation(self) -> NDArray[np.float32]:
        """Return what agents see now, a row for each copy, in [-1, 1]."""
        seen = np.empty((self._count, len(self._observed)), dtype=np.float32)
        for column, each in enumerate(self._observed):
            value = np.asarray(each.value.evaluate(self._now.values), dtype=np.float64)
            seen[:, column] = 2.0 * (value - each.low) / (each.high - each.low) - 1.0
        return np.clip(np.nan_to_num(seen), -1.0, 1.0)

    # ------------------------------------------------------------------ inside

    def _read(self) -> Record:
        values = self._batch.get(*self._names).reshape(self._count, -1) * self._scale + self._offset
        numbers = {name: values[:, column] for column, name in enumerate(self._names)}
        time: Floats = self._batch.time
        return Record(time, numbers)

    def _remember(self, mask: Mask) -> None:
        """Keep a row of what formulas of whole episodes are about."""
        copies = np.flatnonzero(mask)
        for name, rows in self._history.items():
            rows[self._decided[copies], copies] = self._now.numbers[name][copies]

    def _of(self, reward: Reward, margins: Margins | None, now: Record, over: Mask) -> Floats:
        says: Any = reward.says
        if margins is not None:
            value = margins.at(now)
        elif reward.is_margin:
            value = np.zeros(self._count)
            for copy in np.flatnonzero(over).tolist():
                value[copy] = np.clip(self._of_episode(says, copy), reward.low, reward.high)
            return reward.weight * value
        else:
            value = np.asarray(says.evaluate(now.values), dtype=np.float64)
        return reward.weight * np.clip(value, reward.low, reward.high)

    def _of_episode(self, formula: Any, copy: int) -> float:
        rows = int(self._decided[copy]) + 1
        time = np.arange(rows, dtype=np.float64) * np.float64(self._task.decision)
        record = Record(time, {n: values[:rows, copy] for n, values in self._history.items()})
        low, high = Evaluation(record).margins(formula)
        return float(low[0] if np.isfinite(low[0]) or not looks_ahead(formula) else high[0])


def _port_unit(task: Task, batch: Batch, units: dict[str, str], key: str) -> str:
    """Return the unit of what a key of ``vary`` sets. Raises InputError."""
    name = batch.made.named(key)[0]
    for unit_text in (units.get(name), *(u for n, u in units.items() if n.startswith(f"{name}."))):
        if unit_text is not None:
            return unit_text
    task.require(name, units, key=f"vary: {key}")
    return "1"
