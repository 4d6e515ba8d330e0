"""Findings of a question: lines, tables and figures, for people and for programs."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from seatrial.errors import InputError
from seatrial.files.reading import json_content

ANSWER = "answer.json"


@dataclass
class Shown:
    """A table to show: its columns, and its rows of numbers and texts."""

    title: str
    columns: list[str]
    rows: list[list[Any]]


@dataclass
class Finding:
    """The answer to a question."""

    question: str
    campaign: str
    runs: int = 0
    lines: list[str] = field(default_factory=list)
    """In words."""
    values: dict[str, Any] = field(default_factory=dict)
    """For programs; each question has its own keys."""
    tables: list[Shown] = field(default_factory=list)
    figures: list[str] = field(default_factory=list)
    """Names of drawings (SVG) in the folder."""

    def content(self) -> dict[str, Any]:
        """Return it as plain data."""
        return asdict(self)

    @classmethod
    def of(cls, content: dict[str, Any]) -> Finding:
        """Return what `content` has given. Raises TypeError."""
        tables = [Shown(**table) for table in content["tables"]]
        return cls(**{**content, "tables": tables})


def read_answer(folder: Path) -> Finding:
    """Return the answer in a folder. Raises InputError."""
    path = folder / ANSWER
    try:
        return Finding.of(json_content(path.read_bytes(), str(path)))
    except (OSError, TypeError, KeyError) as error:
        raise InputError(f"{path}: this is no answer of a campaign: {error}") from None
