"""Questions to a campaign, as its file has them: ``[ask]``, ``[ask.limits]`` and the others."""

from __future__ import annotations

from typing import Any

from pydantic import Field

from ..cosim.files import FileModel
from .distributions import Distribution


class LimitsQuestion(FileModel):
    """Where is the boundary of the region that passes?"""

    criterion: str = ""
    """Empty: all criteria, by the least robustness."""
    keys: list[str] = Field(default_factory=list, max_length=3)
    """Two or three of those that vary; the others stay as the trial has them. Empty: all."""
    runs: int = Field(default=100, ge=20, le=2000)


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
