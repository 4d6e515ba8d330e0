"""The question of tuning: the best values of gains, or of a design, over all varied keys."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from seatrial.trial.running.measuring import Measured
from seatrial_kits.campaigns.questions import TuneQuestion
from seatrial_kits.campaigns.results.finding import Finding, Shown

from .asking import Asking
from .drawing import drawn
from .nominal import nominal_values
from .objectives import Goal, compromise, front, goals_of
from .searches import search_front, search_refined
from .searching import needed
from .space import Space, tuned_space
from .trial_writing import refuse_unwritable, write_trial

TRIAL = "tuned.toml"
_DECADE = 10.0
"""A range of positive numbers that spans so much is searched by logarithm."""
_DIGITS = 4
_MOST_WRITTEN = 50
_FRESH = 1_000_003
"""Beside the seed: of the cases that no candidate was chosen by."""


def tune_question(entry: TuneQuestion, asking: Asking) -> Callable[[], Finding]:
    """Return the function that tunes and writes the trial with the tuned values.

    Raises InputError for a column that does not exist, and a trial that no trial file says.
    """
    goals = goals_of(entry.objectives, asking)
    for library in ("cma", "optuna", "matplotlib"):
        needed(library)
    refuse_unwritable(asking.asked.base, asking.origin)
    where = f"{asking.campaign.read_from.path}: ask.tune"
    tuning = _Tuning(entry, asking, goals, tuned_space(asking.campaign, where))
    return tuning.finding


class _Tuning:
    def __init__(
        self, entry: TuneQuestion, asking: Asking, goals: list[Goal], tuned: Space
    ) -> None:
        self._entry, self._asking, self._goals, self._tuned = entry, asking, goals, tuned
        self._varies = len(asking.space.keys) > len(tuned.keys)
        self._count = entry.cases if self._varies else 1
        self._cases = self._drawn(asking.seed)

    def finding(self) -> Finding:
        """Search, check on fresh cases, write the tuned trial, and return the answer."""
        asking, entry = self._asking, self._entry
        asking.expect((entry.candidates + 2 * self._varies) * self._count)
        present, notes = nominal_values(replace(asking, space=self._tuned), {})
        points, costs = self._searched(self._shares(present))
        numbers = self._numbers(points)
        numbers[0] = present
        best = front(costs)
        chosen = best[compromise(costs[best])]
        finding = asking.finding()
        finding.lines += notes
        self._say(finding, numbers, costs, chosen)
        if self._varies:
            self._check(finding, numbers[[0, chosen]])
        if len(self._goals) > 1:
            self._say_front(finding, numbers, costs, best)
        self._write(numbers[chosen], TRIAL)
        finding.lines.append(f"{TRIAL} has it, for seatrial run")
        self._draw(costs, best)
        finding.figures.append("tune.svg")
        return finding

    # ------------------------------------------------------------------ points and runs

    def _drawn(self, seed: int) -> np.ndarray:
        """Return cases of the varied keys: a Latin hypercube through their distributions."""
        from scipy import special
        from scipy.stats import qmc

        size = len(self._tuned.keys)
        space = self._asking.space
        if not self._varies:
            return np.empty((1, 0))
        lower = space.lower[size:, size:]
        sample = qmc.LatinHypercube(len(lower), seed=np.random.default_rng(seed))
        scores = special.ndtri(np.clip(sample.random(self._count), 1e-12, 1.0 - 1e-12)) @ lower.T
        whole = np.hstack([np.full((self._count, size), 0.5), special.ndtr(scores)])
        return space.quantiles(whole)[:, size:]

    @property
    def _logarithmic(self) -> np.ndarray:
        low, high = self._tuned.ends.T
        result: np.ndarray = (low > 0.0) & (high >= _DECADE * low)
        return result

    def _numbers(self, shares: np.ndarray) -> np.ndarray:
        """Return values at shares of their ranges, with as many digits as are tried."""
        low, high = self._tuned.ends.T
        positive = np.where(self._logarithmic, low, 1.0)
        ratio = np.where(self._logarithmic, high / positive, 1.0)
        numbers = np.where(self._logarithmic, positive * ratio**shares, low + (high - low) * shares)
        rounded = np.vectorize(lambda value: float(f"{value:.{_DIGITS}g}"))(numbers)
        result: np.ndarray = np.clip(rounded, low, high)
        return result

    def _shares(self, numbers: np.ndarray) -> np.ndarray:
        low, high = self._tuned.ends.T
        log = self._logarithmic
        ends = [
            np.where(log, np.log(np.where(log, each, 1.0)), each) for each in (low, high, numbers)
        ]
        result: np.ndarray = (ends[2] - ends[0]) / (ends[1] - ends[0])
        return np.asarray(np.clip(result, 0.0, 1.0))

    def _measured(self, numbers: np.ndarray, cases: np.ndarray) -> list[list[Measured]]:
        """Run every candidate on every case."""
        rows = np.hstack(
            [np.repeat(numbers, len(cases), axis=0), np.tile(cases, (len(numbers), 1))]
        )
        runs = self._asking.run(rows)
        return [runs[i : i + len(cases)] for i in range(0, len(runs), len(cases))]

    def _costs(self, shares: np.ndarray) -> np.ndarray:
        found = self._measured(self._numbers(shares), self._cases)
        return np.array([[goal.cost(runs) for goal in self._goals] for runs in found])

    def _searched(self, start: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the candidates and their costs; the first is the present one."""
        count, seed = self._entry.candidates, self._asking.seed
        if len(self._goals) > 1:
            return search_front(self._costs, start, count, seed)
        points, costs = search_refined(lambda s: self._costs(s)[:, 0], start, count, seed)
        return points, costs[:, None]

    # ------------------------------------------------------------------ the answer

    def _say(self, finding: Finding, numbers: np.ndarray, costs: np.ndarray, chosen: int) -> None:
        pairs = [
            (g.shown(costs[0, i]), g.shown(costs[chosen, i])) for i, g in enumerate(self._goals)
        ]
        for goal, (before, after) in zip(self._goals, pairs, strict=True):
            finding.lines.append(f"{goal.name}: {_text(before)} at present, {_text(after)} tuned")
        titles = self._tuned.titles()
        rows = [
            [title, float(numbers[0, i]), float(numbers[chosen, i])]
            for i, title in enumerate(titles)
        ]
        finding.tables.append(Shown("Values", ["key", "present", "tuned"], rows))
        finding.values = {
            "present": self._settings(numbers[0]),
            "tuned": self._settings(numbers[chosen]),
            "objectives": {
                goal.name: {"present": before, "tuned": after}
                for goal, (before, after) in zip(self._goals, pairs, strict=True)
            },
            "trial": TRIAL,
        }

    def _check(self, finding: Finding, both: np.ndarray) -> None:
        """Run the present and the tuned values on cases that chose neither."""
        found = self._measured(both, self._drawn(self._asking.seed + _FRESH))
        rows = [
            [goal.name, *(_text(goal.shown(goal.cost(runs))) for runs in found)]
            for goal in self._goals
        ]
        passed = [sum(each.passed for each in runs) for runs in found]
        rows.append(["cases that pass", *(f"{n} of {self._count}" for n in passed)])
        title = "On fresh cases, which chose nothing"
        finding.tables.append(Shown(title, ["objective", "present", "tuned"], rows))
        finding.values["fresh"] = {
            "cases": self._count,
            "passed": {"present": passed[0], "tuned": passed[1]},
        }

    def _say_front(
        self, finding: Finding, numbers: np.ndarray, costs: np.ndarray, best: list[int]
    ) -> None:
        """Say and write the candidates that no other one is better than in every objective."""
        rows = []
        for number, row in enumerate(best[:_MOST_WRITTEN], 1):
            name = f"tuned-{number}.toml"
            self._write(numbers[row], name)
            shown = [goal.shown(costs[row, i]) for i, goal in enumerate(self._goals)]
            rows.append([name, *map(_text, shown), *(float(each) for each in numbers[row])])
        columns = ["trial", *(goal.name for goal in self._goals), *self._tuned.titles()]
        finding.tables.append(Shown("Pareto front", columns, rows))
        finding.lines.append(
            f"candidates on the Pareto front: {len(best)}; tuned is the one nearest to the best of "
            "all objectives, as shares of the front's ranges"
        )

    def _settings(self, numbers: np.ndarray) -> dict[str, object]:
        return self._tuned.settings(numbers[None])[0]

    def _write(self, numbers: np.ndarray, name: str) -> None:
        asked, campaign = self._asking.asked, self._asking.campaign.read_from.name
        row = self._settings(numbers)
        notes = [
            f"{asked.base.name} with the values that were found by",
            f"seatrial campaign {campaign} --ask tune: {', '.join(row)}.",
            "Names of files are relative to this one.",
        ]
        write_trial(asked.base.changed(row, asked.where), self._asking.folder / name, notes)

    def _draw(self, costs: np.ndarray, best: list[int]) -> None:
        shown = np.array(
            [[np.nan if (v := g.shown(row[i])) is None else v for i, g in enumerate(self._goals)]
             for row in costs]
        )  # fmt: skip
        with drawn(self._asking.folder, "tune") as [axes]:
            if len(self._goals) == 1:
                axes.scatter(np.arange(1, len(shown) + 1), shown[:, 0], s=8, color="#0b6ea8")
                axes.axhline(shown[0, 0], color="#8a94a0", linewidth=0.8)
                axes.set_xlabel("candidate; the line is the present one")
                axes.set_ylabel(self._goals[0].name)
                return
            axes.scatter(shown[:, 0], shown[:, 1], s=8, color="#8a94a0")
            axes.plot(shown[best, 0], shown[best, 1], "o-", markersize=4, color="#0b6ea8")
            axes.scatter(*shown[0, :2], marker="x", color="#b3261e")
            axes.set_xlabel(f"{self._goals[0].name} (cross: the present one)")
            axes.set_ylabel(self._goals[1].name)


def _text(value: float | None) -> str:
    return "a case has no value" if value is None else f"{value:.4g}"
