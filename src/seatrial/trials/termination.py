"""Criteria that end a run: after a capsize there is nothing left to try."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ..cosim.master import Master
from ..units import unit
from .expressions import Comparison, FloatArray, Logic
from .trial import Trial


class TerminationConditions:
    """Looks at every communication point whether a criterion with ``ends`` is broken."""

    def __init__(self, trial: Trial, master: Master, units: Mapping[str, str]) -> None:
        self._master = master
        self._conditions: list[Comparison | Logic] = []
        needed: set[str] = set()
        for entry, (_, criterion) in zip(trial.file.criteria, trial.criteria, strict=True):
            if entry.ends:
                assert isinstance(criterion.subject, (Comparison, Logic))
                self._conditions.append(criterion.subject)
                needed |= criterion.signals
        places = {".".join(name): place for place, name in enumerate(master.names)}
        self._scales = {name: (places[name], unit(units[name])) for name in needed}

    def broken(self) -> bool:
        """Say if one of them is broken now."""
        if not self._conditions:
            return False
        values: dict[str, FloatArray] = {
            name: np.array([float(self._master.signals[place]) * measure.factor + measure.offset])
            for name, (place, measure) in self._scales.items()
        }
        return not all(condition.holds(values).all() for condition in self._conditions)
