"""The content of a task's file (``tasks/*.toml``)."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import Field, model_validator
from pydantic_core import PydanticCustomError

from seatrial.system.files import FileModel
from seatrial_kits.campaigns.distributions import Distribution

Written = str | float | int


class ObserveEntry(FileModel):
    """An element of the observation: an expression, and the range that becomes -1 to 1."""

    value: str
    range: list[Written] = Field(min_length=2, max_length=2)


class ActEntry(FileModel):
    """An element of the action: the port that it sets, and the range that -1 to 1 becomes."""

    to: str
    """An input that nothing feeds or a tunable parameter is set, an output overridden."""
    range: list[Written] = Field(min_length=2, max_length=2)


class RewardEntry(FileModel):
    """A term of the reward, per decision: a number without a unit, or the margin of a formula.

    A formula that looks ahead is that of an episode: its margin is due at the end.
    """

    name: str
    value: str | None = None
    margin: str | None = None
    weight: float = Field(default=1.0, allow_inf_nan=False)
    between: list[float] | None = Field(default=None, min_length=2, max_length=2)
    """Limits before the weight; of a margin -1 and 1 if none are given."""

    @model_validator(mode="after")
    def _is_one(self) -> RewardEntry:
        if (self.value is None) == (self.margin is None):
            raise PydanticCustomError("one", "Exactly one of value and margin is needed")
        return self


class EndEntry(FileModel):
    """What ends an episode before its time, and what it is worth."""

    name: str
    when: str
    outcome: Literal["success", "failure"] = "failure"
    reward: float = Field(default=0.0, allow_inf_nan=False)


class TaskFile(FileModel):
    """The content of a task's file."""

    title: str = ""
    rig: str
    """A rig, or a trial with its settings, weather, events and faults."""
    variant: str | None = None
    choices: dict[str, str] = Field(default_factory=dict)
    set: dict[str, Any] = Field(default_factory=dict)
    decision: str
    """Time from one action to the next."""
    episode: str
    """Time after which an episode is cut."""
    vary: dict[str, Distribution] = Field(default_factory=dict)
    """What each episode draws anew."""
    observe: list[ObserveEntry] = Field(min_length=1)
    act: list[ActEntry] = Field(min_length=1)
    reward: list[RewardEntry] = Field(min_length=1)
    ends: list[EndEntry] = Field(default_factory=list)
