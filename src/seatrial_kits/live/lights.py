"""Verdict lights: each criterion on what is recorded so far, with its margin."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape
from typing import Any

import numpy as np

from seatrial.errors import InputError
from seatrial.trial.criteria.criteria import Criterion, parse
from seatrial.trial.criteria.expressions import FloatArray
from seatrial.trial.criteria.formulas import Temporal

_MOST_ROWS = 800
"""Of the record that a light is of."""
_COLOURS = {"holds": "#1f9d5c", "open": "#d79a00", "broken": "#c62f24"}
_WORDS = {"holds": "holds so far", "open": "not yet", "broken": "broken"}


class Lights:
    """The criteria of a manifest; `html` shows them for a record that goes on."""

    def __init__(self, manifest: Mapping[str, Any]) -> None:
        self._units = {name: of["unit"] for name, of in manifest["signals"].items()}
        self._criteria: list[tuple[str, Criterion]] = []
        for entry in manifest["criteria"]:
            try:
                criterion = parse(entry["check"])
                names = {name: name for name in criterion.signals} | entry.get("paths", {})
                criterion = criterion.renamed(names)
            except InputError:  # of another version: the report says so
                continue
            self._criteria.append((entry["name"], criterion))

    @property
    def signals(self) -> set[str]:
        """What the criteria need."""
        return set().union(*(criterion.signals for _, criterion in self._criteria))

    def states(
        self, time: FloatArray, signals: Mapping[str, Any], *, is_over: bool
    ) -> list[tuple[str, str, str]]:
        """Return (name, holds, open or broken, margin or detail) of each on rows of a record."""
        rows = _chosen(len(time))
        found = []
        for name, criterion in self._criteria:
            state, said = "open", ""
            if criterion.signals <= signals.keys() and len(rows):
                columns = {s: _rows(signals[s], rows) for s in criterion.signals}
                try:
                    verdict = criterion.evaluate(time[rows], columns, self._units)
                except InputError as error:
                    found.append((name, "open", str(error)))
                    continue
                said = verdict.margin or verdict.detail
                always = isinstance(criterion.says, Temporal) and criterion.says.name == "always"
                decided = verdict.robustness is not None and (always or is_over)
                state = "holds" if verdict.passed else "broken" if decided else "open"
            found.append((name, state, said))
        return found


def html_of(states: Sequence[tuple[str, str, str]]) -> str:
    """Return states as a list with lights; names and details are escaped."""
    rows = "".join(
        f'<div style="display:flex;gap:.5em;margin:.25em 0;font-size:.85em;line-height:1.25">'
        f'<span style="flex:none;width:.85em;height:.85em;margin-top:.15em;border-radius:50%;'
        f'background:{_COLOURS[state]}"></span><span data-verdict="{state}">{escape(name)}'
        f'<br><span style="opacity:.65">{_WORDS[state]}{": " if said else ""}{escape(said)}'
        f"</span></span></div>"
        for name, state, said in states
    )
    return f'<div style="padding:0 .8em">{rows}</div>'


def _chosen(count: int) -> Any:
    """Return as many rows as a light looks at, with the first and the last."""
    return np.unique(np.linspace(0, count - 1, min(count, _MOST_ROWS)).astype(int))


def _rows(column: Any, rows: Any) -> Any:
    return column[rows] if isinstance(column, np.ndarray) else [column[i] for i in rows.tolist()]
