"""Termination conditions: criteria that end a run, as after a capsize or at the last waypoint."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ..cosim.master import Master
from ..units import unit
from .criteria import Criterion
from .expressions import Comparison, FloatArray, Logic
from .trial import Trial


class TerminationConditions:
    """Criteria with ``ends``, evaluated at every communication point.

    One that must always hold ends the run where it is broken, one that must hold ``within`` a
    duration where it holds for the first time.
    """

    def __init__(self, trial: Trial, master: Master, units: Mapping[str, str]) -> None:
        self._master = master
        ending = [
            criterion
            for entry, (_, criterion) in zip(trial.file.criteria, trial.criteria, strict=True)
            if entry.ends
        ]
        self._kept = _conditions(ending, "always")
        self._wanted = _conditions(ending, "within")
        places = {".".join(name): place for place, name in enumerate(master.names)}
        needed = set().union(*(criterion.signals for criterion in ending))
        self._scales = {name: (places[name], unit(units[name])) for name in needed}

    def status(self) -> str | None:
        """Return the status of a run that is over now, ended or complete; else None."""
        if not self._kept and not self._wanted:
            return None
        values: dict[str, FloatArray] = {
            name: np.array([float(self._master.signals[place]) * measure.factor + measure.offset])
            for name, (place, measure) in self._scales.items()
        }
        if not all(condition.holds(values).all() for condition in self._kept):
            return "ended"
        if any(condition.holds(values).all() for condition in self._wanted):
            return "complete"
        return None


def _conditions(criteria: Sequence[Criterion], form: str) -> list[Comparison | Logic]:
    found = [criterion.subject for criterion in criteria if criterion.form == form]
    return [subject for subject in found if isinstance(subject, (Comparison, Logic))]
