"""The content of a lesson's file: what a network learns, of which signals of runs."""

from __future__ import annotations

from pydantic import Field

from seatrial.system.files import FileModel

Elements = dict[str, str | dict[str, str]]
"""Expressions by element, or by port and axis."""


class LessonFile(FileModel):
    """The content of a lesson's file."""

    policy: str
    """File of the policy whose network learns, relative to this file."""
    inputs: Elements = Field(min_length=1)
    """For each element of the policy's inputs an expression of a run's signals."""
    outputs: Elements = Field(min_length=1)
    """For each element of its outputs what it is to be."""
    where: list[str] = Field(default_factory=list)
    """Comparisons: rows in which one does not hold are left out."""
    every: str | None = None
    """Rows within this time are one, their mean."""
    hidden: list[int] = Field(default=[12], min_length=1, max_length=8)
    """Neurons of each layer but the last."""
    decay: float = Field(default=0.3, ge=0.0, allow_inf_nan=False)
    """Weight of the sum of all squared weights."""
    iterations: int = Field(default=400, ge=1, le=100_000)
    seed: int = Field(default=0, ge=0)
