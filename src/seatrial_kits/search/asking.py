"""Runs that a question asks for, and what they come to: batch by batch, in order."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from seatrial.errors import InputError, SimulationError, unknown
from seatrial.system.system import Engine
from seatrial.trial.running.hooks import Hooks
from seatrial.trial.running.measuring import Measured
from seatrial_kits.campaigns.asked import Asked
from seatrial_kits.campaigns.campaign import Campaign
from seatrial_kits.campaigns.results.finding import Finding

from .space import Space

Values = Callable[[np.ndarray], np.ndarray]
"""Of points, a row each with a number of each key in its unit: a number for each."""
BROKEN = -1.0
"""Robustness of a run that could not go on, and of one that does not pass and has none."""


@dataclass
class Asking:
    """A question under way: its trial, its space, its folder, and runs on demand."""

    campaign: Campaign
    asked: Asked
    space: Space
    expect: Callable[[int], None]
    """Is given how many runs there will be, if that is known."""
    engine: Engine
    hooks: Hooks
    seed: int = 0
    folder: Path = Path()
    measured: Callable[[range], list[Measured]] = lambda _numbers: []
    """Runs cases, and returns what they come to; these two are there once the question is put."""

    @property
    def origin(self) -> str:
        """Where the question is written, for messages."""
        return f"{self.campaign.read_from.path}: ask.{self.asked.question}"

    def run(self, numbers: np.ndarray) -> list[Measured]:
        """Run the trial at points. Raises SimulationError once it is to stop."""
        return self.measured(self.asked.add(self.space.settings(numbers)))

    def robustness(self, criterion: str) -> Values:
        """Return the robustness of a criterion over the space; of all, the least, if it is empty.

        It is a share of the criterion's limit. A run that could not go on has `BROKEN`. Raises
        InputError for a criterion that does not exist.
        """
        names = self.criteria(criterion)

        def value(numbers: np.ndarray) -> np.ndarray:
            return np.array([robustness_of(each, names) for each in self.run(numbers)])

        return value

    def criteria(self, criterion: str) -> list[str]:
        """Return the names of the criteria that are meant. Raises InputError."""
        names = [name for name, _ in self.asked.base.criteria]
        if not names:
            raise InputError(f"{self.origin}: {self.asked.base.name} has no criterion to ask about")
        if criterion and criterion not in names:
            raise InputError(f"{self.origin}: {unknown('criterion', criterion, names)}")
        return [criterion] if criterion else names

    def finding(self) -> Finding:
        """Return an answer with nothing in it yet."""
        return Finding(self.asked.question, self.campaign.read_from.name, len(self.asked))


def robustness_of(measured: Measured, names: list[str]) -> float:
    """Return the least robustness of criteria in a run."""
    found = [v for v in measured.verdicts if v["name"] in names]
    if measured.status == "failed" or not found:
        return BROKEN
    return min(_robustness(verdict) for verdict in found)


def _robustness(verdict: dict[str, object]) -> float:
    value = verdict["robustness"]
    if isinstance(value, (int, float)) and math.isfinite(value):
        return float(value)
    return -BROKEN if verdict["passed"] else BROKEN


def stopped(ended: int, folder: Path) -> SimulationError:
    """Return what is said of a question that was stopped."""
    return SimulationError(f"stopped; {ended} runs came to an end: --out {folder} --resume goes on")
