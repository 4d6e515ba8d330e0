"""Cases that have come to an end: a row of the tables for each, and perhaps a folder."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any

from seatrial.trial.running.measuring import Measured


@dataclass
class Ended:
    """A case that has come to its end."""

    number: int
    """From 0."""
    measured: Measured
    folder: str = ""
    """Name of its folder in the campaign's, if that is kept."""
    host: str = ""
    begun: float = 0.0
    """Wall clock, s since 1970."""
    files: bytes | None = None
    """The folder packed, of a case that ran on another machine."""

    def line(self) -> str:
        """Return it as a line of JSON, without the files."""
        measured = dict(vars(self.measured))
        keys = ("name", "check", "passed", "detail", "robustness", "worst", "unit", "expected")
        measured["verdicts"] = [{k: v[k] for k in keys} for v in self.measured.verdicts]
        content = {"number": self.number, "measured": measured, "folder": self.folder}
        return json.dumps({**content, "host": self.host, "begun": self.begun})

    @classmethod
    def of_line(cls, line: str) -> Ended:
        """Return what `line` has written. Raises ValueError, KeyError, TypeError."""
        content: dict[str, Any] = json.loads(line)
        return cls(**{**content, "measured": Measured(**content["measured"])})
