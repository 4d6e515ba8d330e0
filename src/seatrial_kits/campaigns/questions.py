"""Questions to a campaign, as its file has them: ``[ask]``, ``[ask.limits]`` and the others."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import Field, model_validator

from seatrial.system.files import FileModel

from .distributions import Distribution, Written


class LimitsQuestion(FileModel):
    """Where is the boundary of the region that passes?"""

    criterion: str = ""
    """Empty: all criteria, by the least robustness."""
    keys: list[str] = Field(default_factory=list, max_length=3)
    """Two or three of those that vary; the others stay as the trial has them. Empty: all."""
    runs: int = Field(default=100, ge=20, le=2000)


class RareQuestion(FileModel):
    """How likely is it that a criterion fails, if that is rare?"""

    criterion: str = ""
    """Empty: that any fails."""
    per_level: int = Field(default=2000, ge=100, le=1_000_000)
    """Runs of each tenth of probability."""
    least: float = Field(default=1e-9, ge=1e-12, lt=1.0)
    """A probability below which the search ends."""


class SensitivityQuestion(FileModel):
    """How much does each key matter?"""

    of: list[str] = Field(default_factory=list)
    """Criteria by name, and figures such as "last hull.position.x". Empty: all."""
    samples: int = Field(default=128, ge=0, le=2**20)
    """Of Sobol's indices, each with as many runs as keys and two more; a power of 2, or 0."""
    trajectories: int = Field(default=10, ge=0, le=10_000)
    """Of Morris's effects, each with as many runs as keys and one more."""


class Objective(FileModel):
    """A column of the table that gains are tuned for, over the cases of a candidate."""

    maximise: str | None = None
    """Such as "robustness of NAME" and "last hull.position.x"; one of these two."""
    minimise: str | None = None
    """Such as "worst of NAME"."""
    over: str = "worst"
    """Of the cases: worst, mean, or "quantile 90 %": as good in so many of them."""

    @model_validator(mode="after")
    def _one(self) -> Objective:
        if (self.maximise is None) == (self.minimise is None):
            raise ValueError('either maximise = "COLUMN" or minimise = "COLUMN" is needed')
        return self


class TuneQuestion(FileModel):
    """Which values of gains, or of a design, are the best over all that varies?"""

    keys: dict[str, list[Written]] = Field(default_factory=dict)
    """Low and high end of each."""
    objectives: list[Objective] = Field(default_factory=list)
    """Several have a Pareto front; empty: the least robustness of all criteria."""
    candidates: int = Field(default=60, ge=10, le=10_000)
    """Sets of values that are tried."""
    cases: int = Field(default=10, ge=1, le=10_000)
    """Runs of each candidate, the same for all: points of the varied keys."""


class WorstCaseQuestion(FileModel):
    """Which case is the worst, and how small a change from nominal fails?"""

    criterion: str = ""
    """Empty: all criteria, by the least robustness."""
    method: Literal["cma-es", "bayesian"] = "cma-es"
    runs: int = Field(default=200, ge=20, le=100_000)
    """Of the search; making it small takes some more."""
    nominal: dict[str, Any] = Field(default_factory=dict)
    """Values of keys; of others the median."""
    first: Literal["keys", "distance"] = "keys"
    """What is made small first: the number of keys that change, or the distance."""


class Questions(FileModel):
    """Which trial is asked about, what varies, and settings of each question."""

    trial: str = ""
    """Of the campaign's; needed if it has several."""
    set: dict[str, Any] = Field(default_factory=dict)
    """In place of what the campaign's ``set`` and ``grid`` say."""
    vary: dict[str, Distribution] = Field(default_factory=dict)
    """Empty: what the campaign's design varies."""
    seed: int = Field(default=0, ge=0)
    limits: LimitsQuestion | None = None
    rare: RareQuestion | None = None
    sensitivity: SensitivityQuestion | None = None
    tune: TuneQuestion | None = None
    worst_case: WorstCaseQuestion | None = Field(default=None, alias="worst-case")
