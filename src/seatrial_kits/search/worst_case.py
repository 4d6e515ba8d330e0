"""The question of the worst case: which one fails, and how small a change makes it fail."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from seatrial_kits.campaigns.questions import WorstCaseQuestion
from seatrial_kits.campaigns.results.finding import Finding, Shown

from .asking import Asking
from .drawing import drawn
from .nominal import nominal_values, written_nominal
from .searches import search
from .searching import needed
from .shrinking import Shrinking, rounded
from .trial_writing import refuse_unwritable, write_trial

TRIAL = "worst-case.toml"
_LIBRARIES = {"cma-es": "cma", "bayesian": "optuna"}


def worst_case_question(entry: WorstCaseQuestion, asking: Asking) -> Callable[[], Finding]:
    """Return what searches for the worst case, shrinks it and writes it as a trial file.

    Raises InputError for a criterion that does not exist, a nominal value that is none, and a trial
    that no trial file says.
    """
    needed(_LIBRARIES[entry.method])
    needed("matplotlib")
    value = asking.robustness(entry.criterion)
    nominal = written_nominal(entry.nominal, asking.space, asking.origin)
    refuse_unwritable(asking.asked.base, asking.origin)

    def answer() -> Finding:
        asking.expect(entry.runs)
        numbers, notes = nominal_values(asking, nominal)
        finding = _Search(entry, asking, value, numbers).finding()
        finding.lines += notes
        return finding

    return answer


class _Search:
    def __init__(
        self,
        entry: WorstCaseQuestion,
        asking: Asking,
        value: Callable[[np.ndarray], np.ndarray],
        nominal: np.ndarray,
    ) -> None:
        self._entry, self._asking, self._value, self._nominal = entry, asking, value, nominal
        self._space = asking.space

    def finding(self) -> Finding:
        """Search, shrink, and say what was found."""
        space, entry = self._space, self._entry
        start = space.shares(self._nominal[None])[0]
        points, values = search(entry.method, self._of_shares, start, entry.runs, self._asking.seed)
        finding = self._asking.finding()
        failing = values <= 0
        worst = int(np.argmin(values))
        finding.lines.append(
            f"{int(failing.sum())} of {len(values)} runs of the search fail; "
            f"the least robustness is {values[worst]:.4g}, nominal has {values[0]:.4g}"
        )
        worst_numbers = space.numbers(points[worst])
        finding.values = {
            "failed": int(failing.sum()),
            "searched": len(values),
            "nominal": {"robustness": float(values[0]), **self._settings(self._nominal)},
            "worst": {"robustness": float(values[worst]), **self._settings(worst_numbers)},
        }
        columns = [("nominal", self._nominal), ("worst", worst_numbers)]
        if failing[0]:
            finding.lines.append("nominal fails: there is no change to make small")
        elif not failing.any():
            finding.lines.append("none fails")
        else:
            columns.append(("smallest change", self._shrunk(finding, points, failing)))
        rows = [
            [title, *(float(numbers[i]) for _, numbers in columns)]
            for i, title in enumerate(space.titles())
        ]
        finding.tables.append(Shown("Cases", ["key", *(name for name, _ in columns)], rows))
        self._draw(values)
        finding.figures.append("worst-case.svg")
        return finding

    def _of_shares(self, shares: np.ndarray) -> np.ndarray:
        return self._value(self._space.numbers(shares))

    def _settings(self, numbers: np.ndarray) -> dict[str, Any]:
        return {"set": self._space.settings(numbers[None])[0]}

    def _shrunk(self, finding: Finding, points: np.ndarray, failing: np.ndarray) -> np.ndarray:
        """Shrink the failing run that is nearest to nominal, and write it."""
        space = self._space
        shrinking = Shrinking(self._of_shares, points[0])
        place = min(np.flatnonzero(failing), key=lambda i: shrinking.distance(points[i]))
        point = shrinking.shrunk(points[place], self._entry.first)
        numbers: np.ndarray = np.where(point == points[0], self._nominal, space.numbers(point))
        numbers = rounded(numbers, self._nominal, space, self._value)
        [robustness] = self._value(numbers[None])
        shares = space.shares(numbers[None])[0]
        changed = [k for k, a, b in zip(space.keys, numbers, self._nominal, strict=True) if a != b]
        distance = shrinking.distance(shares)
        finding.lines += [
            f"smallest change that fails: {', '.join(changed)}; "
            f"distance {distance:.4g} of the ranges, robustness {robustness:.4g}",
            f"{TRIAL} has it, for seatrial run",
        ]
        finding.values["smallest"] = {
            "robustness": float(robustness),
            "distance": distance,
            "changed": changed,
            "trial": TRIAL,
            **self._settings(numbers),
        }
        self._write(numbers, changed, float(robustness), distance)
        return numbers

    def _write(
        self, numbers: np.ndarray, changed: list[str], robustness: float, distance: float
    ) -> None:
        asked, campaign = self._asking.asked, self._asking.campaign.read_from.name
        row = self._space.settings(numbers[None])[0]
        criterion = self._entry.criterion or "a criterion"
        notes = [
            f"{asked.base.name} in the smallest change from nominal that was found to fail, by",
            f"seatrial campaign {campaign} --ask worst-case: {criterion} has a robustness of "
            f"{robustness:.4g}.",
            f"Changed: {', '.join(changed)}; distance {distance:.4g}. Names of files are relative "
            "to this one.",
        ]
        write_trial(asked.base.changed(row, asked.where), self._asking.folder / TRIAL, notes)

    def _draw(self, values: np.ndarray) -> None:
        with drawn(self._asking.folder, "worst-case") as [axes]:
            numbers = np.arange(1, len(values) + 1)
            axes.scatter(numbers, values, s=8, c=np.where(values > 0, "#1f7a4d", "#b3261e"))
            axes.plot(numbers, np.minimum.accumulate(values), color="#22303c", linewidth=1.0)
            axes.axhline(0.0, color="#8a94a0", linewidth=0.8)
            axes.set_xlabel("run of the search")
            axes.set_ylabel("robustness, and the least so far")
