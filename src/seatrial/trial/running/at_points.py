"""Formulas of criteria that are known at each communication point, evaluated as a trial runs."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping

import numpy as np

from ...model.component import seconds
from ...model.units import unit
from ...sim.master import Master
from ..criteria.criteria import Criterion
from ..criteria.formulas import Formula, Temporal
from ..criteria.predicates import Comparison, Kind, Record
from ..criteria.robustness import Evaluation
from ..files.trial import Trial


class AtPoints:
    """Evaluates formulas of ``criteria`` of which each needs the signals of one point alone."""

    def __init__(
        self, criteria: Iterable[Criterion], master: Master, units: Mapping[str, str]
    ) -> None:
        self._master = master
        kinds: dict[str, set[Kind]] = {}
        for criterion in criteria:
            for name, wanted in criterion.kinds.items():
                kinds.setdefault(name, set()).update(wanted)
        places = {".".join(name): place for place, name in enumerate(master.names)}
        self._texts = {name: places[name] for name, wanted in kinds.items() if "text" in wanted}
        self._scales = {
            name: (places[name], unit(units[name]))
            for name, wanted in kinds.items()
            if wanted != {"text"}
        }

    def numbers(self) -> dict[str, float]:
        """Return the signals that are numbers, in their units, at the master's time."""
        signals = self._master.signals
        return {
            name: float(signals[place]) * measure.factor + measure.offset
            for name, (place, measure) in self._scales.items()
        }

    def holds(self, formula: Formula, numbers: Mapping[str, float]) -> bool:
        """Return whether a formula holds with these numbers."""
        if isinstance(formula, Comparison):  # nearly all are: arrays of one value cost ten times
            return formula.holds_of(numbers)
        signals = self._master.signals
        texts = {name: [str(signals[place])] for name, place in self._texts.items()}
        now = Record(np.zeros(1), {n: np.array([value]) for n, value in numbers.items()}, texts)
        return bool(Evaluation(now).margins(formula)[0][0] > 0)


class TerminationConditions:
    """Criteria with ``ends``, evaluated at every communication point.

    One that must always hold ends the run where it is broken, one that must hold eventually
    where it holds for the first time.
    """

    def __init__(self, trial: Trial, master: Master, units: Mapping[str, str]) -> None:
        ending = [
            criterion
            for entry, (_, criterion) in zip(trial.file.criteria, trial.criteria, strict=True)
            if entry.ends
        ]
        self._conditions = [c.condition for c in ending if c.condition is not None]
        self._goals = [c.goal for c in ending if c.condition is None and c.goal is not None]
        self._points = AtPoints(ending, master, units)

    @property
    def has_any(self) -> bool:
        """Whether there are such criteria."""
        return bool(self._conditions or self._goals)

    def status(self) -> str | None:
        """Return the status of a run that is over now, ended or complete; else None."""
        if not self.has_any:
            return None
        numbers = self._points.numbers()
        if not all(self._points.holds(condition, numbers) for condition in self._conditions):
            return "ended"
        if any(self._points.holds(goal, numbers) for goal in self._goals):
            return "complete"
        return None


class Standing:
    """Tells components how the criteria stand, at points where that changes.

    The text of their parameter of the role ``verdicts`` is JSON: by name of the criterion "holds"
    until it is "broken", or "open" until it is "met" or "missed"; "later" if the end decides.
    """

    def __init__(self, trial: Trial, master: Master, units: Mapping[str, str]) -> None:
        self._writers = [
            part.instance.writer([port])
            for part in master.system.parts.values()
            for port in part.instance.variables.of_role("verdicts")
        ]
        known = [(n, c) for n, c in trial.criteria if c.condition is not None or c.goal is not None]
        self._conditions = {n: c.condition for n, c in known if c.condition is not None}
        self._goals = {n: c.goal for n, c in known if c.goal is not None}
        self._last = {n: c.says.interval.last for n, c in known if isinstance(c.says, Temporal)}
        """By name, the time from the start on until which a goal may be met, s; None: the end."""
        self._master, self._points = master, AtPoints([c for _, c in known], master, units)
        self._states = {n: "later" for n, _ in trial.criteria}
        self._states |= dict.fromkeys(self._conditions, "holds") | dict.fromkeys(
            self._goals, "open"
        )
        self._told: dict[str, str] = {}

    @property
    def has_any(self) -> bool:
        """Whether somebody is told."""
        return bool(self._writers and self._states)

    def look(self) -> None:
        """Evaluate what is not decided, and tell what has changed."""
        if not self.has_any:
            return
        numbers = self._points.numbers()
        for name, condition in self._conditions.items():
            if self._states[name] == "holds" and not self._points.holds(condition, numbers):
                self._states[name] = "broken"
        elapsed = seconds(self._master.time_ns - self._master.start_ns)
        for name, goal in self._goals.items():
            last = self._last[name]
            if self._states[name] != "open":
                continue
            if last is not None and elapsed > last:
                self._states[name] = "missed"
            elif self._points.holds(goal, numbers):
                self._states[name] = "met"
        if self._states != self._told:
            self._told = dict(self._states)
            for write in self._writers:
                write([json.dumps(self._told)])
