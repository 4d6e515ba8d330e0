"""Termination conditions: criteria that end a run, as after a capsize or at the last waypoint."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ...model.units import unit
from ...sim.master import Master
from ..criteria.formulas import Formula
from ..criteria.predicates import Comparison, Kind, Record
from ..criteria.robustness import Evaluation
from ..files.trial import Trial


class TerminationConditions:
    """Criteria with ``ends``, evaluated at every communication point.

    One that must always hold ends the run where it is broken, one that must hold eventually
    where it holds for the first time.
    """

    def __init__(self, trial: Trial, master: Master, units: Mapping[str, str]) -> None:
        self._master = master
        self._conditions: list[Formula] = []
        self._goals: list[Formula] = []
        kinds: dict[str, set[Kind]] = {}
        for entry, (_, criterion) in zip(trial.file.criteria, trial.criteria, strict=True):
            if entry.ends:
                if criterion.condition is not None:
                    self._conditions.append(criterion.condition)
                elif criterion.goal is not None:
                    self._goals.append(criterion.goal)
                for name, wanted in criterion.kinds.items():
                    kinds.setdefault(name, set()).update(wanted)
        places = {".".join(name): place for place, name in enumerate(master.names)}
        self._texts = {name: places[name] for name, wanted in kinds.items() if "text" in wanted}
        self._scales = {
            name: (places[name], unit(units[name]))
            for name, wanted in kinds.items()
            if wanted != {"text"}
        }

    @property
    def has_any(self) -> bool:
        """Whether there are such criteria."""
        return bool(self._conditions or self._goals)

    def status(self) -> str | None:
        """Return the status of a run that is over now, ended or complete; else None."""
        if not self.has_any:
            return None
        signals = self._master.signals
        numbers = {
            name: float(signals[place]) * measure.factor + measure.offset
            for name, (place, measure) in self._scales.items()
        }
        if not all(self._holds(condition, numbers) for condition in self._conditions):
            return "ended"
        if any(self._holds(goal, numbers) for goal in self._goals):
            return "complete"
        return None

    def _holds(self, formula: Formula, numbers: Mapping[str, float]) -> bool:
        if isinstance(formula, Comparison):  # nearly all are: arrays of one value cost ten times
            return formula.holds_of(numbers)
        signals = self._master.signals
        texts = {name: [str(signals[place])] for name, place in self._texts.items()}
        now = Record(np.zeros(1), {n: np.array([value]) for n, value in numbers.items()}, texts)
        return bool(Evaluation(now).margins(formula)[0][0] > 0)
