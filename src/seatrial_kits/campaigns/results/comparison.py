"""Comparison of two campaigns, case by case: rates of verdicts, columns, and worst cases."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from seatrial.model.readable import number

from .finding import Shown
from .outcomes import Outcomes, read_outcomes, setting_text
from .paired import CONFIDENCE, mcnemar, mean_difference, rate_difference
from .pairs import Pairs, paired

ALL = "all criteria"
MOST_CASES = 200
"""Rows of a table of cases; the summary says how many there are."""


@dataclass(frozen=True)
class Rate:
    """Share of pairs that pass, of one criterion or of all, in both campaigns."""

    name: str
    pairs: int
    a: float
    b: float
    difference: float
    """b less a."""
    low: float
    high: float
    mcnemar: float
    """Probability of a change as uneven, if both rates are the same."""
    broken: int
    """Pairs from pass to fail."""
    repaired: int
    """Pairs from fail to pass."""


@dataclass(frozen=True)
class ColumnDifference:
    """Mean paired difference of a column of numbers."""

    name: str
    unit: str
    pairs: int
    """Where both have a number."""
    a: float
    b: float
    difference: float
    """b less a."""
    low: float
    high: float


@dataclass(frozen=True)
class VerdictChange:
    """A case whose verdict changed, or of the whole campaign a criterion's."""

    name: str
    a: str
    b: str
    criteria: str = ""
    """Of a case: its criteria that changed."""
    case_a: int = 0
    case_b: int = 0

    @property
    def is_worse(self) -> bool:
        """Whether it went from pass to fail."""
        return (self.a, self.b) == ("pass", "fail")


@dataclass(frozen=True)
class Worst:
    """The case of least robustness of a criterion in one campaign, beside the other's."""

    criterion: str
    worst_in: str
    case: str
    case_a: int
    case_b: int
    a: float
    b: float


@dataclass(frozen=True)
class CampaignComparison:
    """Differences between two campaigns on the cases that both have."""

    names: tuple[str, str]
    outcomes: tuple[Outcomes, Outcomes]
    pairs: Pairs
    rates: list[Rate]
    columns: list[ColumnDifference]
    skipped: dict[str, str]
    """Columns that are not compared, with the reason."""
    changed: list[VerdictChange]
    """Cases, those from pass to fail first."""
    criteria: list[VerdictChange]
    """Criteria of both campaigns as a whole, changed or not."""
    worst: list[Worst]

    @property
    def is_worse(self) -> bool:
        """Whether a verdict went from pass to fail.

        The campaigns' own criteria decide where both have some, the cases' verdicts otherwise.
        """
        return any(each.is_worse for each in (self.criteria or self.changed))

    @property
    def lines(self) -> list[str]:
        """The summary in words."""
        a, b = self.names
        first, worse = self.rates[0], sum(each.is_worse for each in self.changed)
        lines = [
            f"{len(self.pairs.found)} cases in both; {len(self.pairs.only[0])} only in {a}, "
            f"{len(self.pairs.only[1])} only in {b}",
            f"cases from pass to fail: {worse}; from fail to pass: {len(self.changed) - worse}",
            f"pass: {_percent(first.a)} % in {a}, {_percent(first.b)} % in {b}; difference "
            f"{_percent(first.difference)} %, with a confidence of {_percent(CONFIDENCE)} % "
            f"between {_percent(first.low)} % and {_percent(first.high)} % (Newcombe)",
        ]
        lines += [f"not compared: {name}: {why}" for name, why in self.skipped.items()]
        if self.is_worse:
            names = [each.name for each in self.criteria if each.is_worse]
            lines.append(f"went from pass to fail: {', '.join(names) or f'{worse} cases'}")
        return lines

    def content(self) -> dict[str, Any]:
        """Return it for programs."""
        a, b = self.pairs.only
        return {
            "names": self.names,
            "worse": self.is_worse,
            "pairs": len(self.pairs.found),
            "only": [[case.number for case in a], [case.number for case in b]],
            "rates": [asdict(each) for each in self.rates],
            "columns": [asdict(each) for each in self.columns],
            "changed": [asdict(each) for each in self.changed],
            "criteria": [asdict(each) for each in self.criteria],
            "worst_cases": [asdict(each) for each in self.worst],
            "changes": [{"name": row[0], "a": row[1], "b": row[2]} for row in _changes(self).rows],
            "summary": self.lines,
            "tables": [asdict(each) for each in self.tables()],
        }

    def tables(self) -> list[Shown]:
        """Return the tables to show: those that have a row."""
        a, b = self.names
        rates = Shown(
            f"Rates of pass, %; interval of {_percent(CONFIDENCE)} % ([Newcombe1998])",
            ["criterion", "pairs", a, b, "difference", "from", "to", "McNemar p",
             "pass to fail", "fail to pass"],
            [[r.name, r.pairs, *(100.0 * x for x in (r.a, r.b, r.difference, r.low, r.high)),
              r.mcnemar, r.broken, r.repaired] for r in self.rates],
        )  # fmt: skip
        columns = Shown(
            f"Means, and mean of the paired differences with its interval of "
            f"{_percent(CONFIDENCE)} % (Student)",
            ["column", "unit", "pairs", a, b, "difference", "from", "to"],
            [list(asdict(each).values()) for each in self.columns],
        )
        whole = Shown(
            "Criteria of the campaigns",
            ["criterion", a, b],
            [[c.name, c.a, c.b] for c in self.criteria],
        )
        changed = Shown(
            "Cases whose verdict changed",
            ["case", f"number in {a}", f"number in {b}", a, b, "criteria that changed"],
            [[c.name, c.case_a, c.case_b, c.a, c.b, c.criteria] for c in self.changed[:MOST_CASES]],
        )
        worst = Shown(
            "Worst cases, by robustness",
            ["criterion", "worst in", "case", f"number in {a}", f"number in {b}", a, b],
            [[w.criterion, w.worst_in, w.case, w.case_a, w.case_b, w.a, w.b] for w in self.worst],
        )
        only = [
            [name, case.number, self.pairs.name(case), "pass" if case.passed else "fail"]
            for name, cases in zip(self.names, self.pairs.only, strict=True)
            for case in cases[:MOST_CASES]
        ]
        alone = Shown("Cases that only one has", ["campaign", "number", "case", "verdict"], only)
        tables = [_changes(self), whole, rates, columns, changed, worst, alone]
        return [table for table in tables if table.rows]


def compare_campaigns(folder_a: Path, folder_b: Path) -> CampaignComparison:
    """Return how two campaigns differ on the cases that both have.

    Raises InputError for a folder that is no campaign's, and if no case is in both.
    """
    a, b = read_outcomes(folder_a), read_outcomes(folder_b)
    same = folder_a.name == folder_b.name
    names = (str(folder_a), str(folder_b)) if same else (folder_a.name, folder_b.name)
    pairs = paired(a, b)
    columns, skipped = _columns(pairs, a, b, names)
    return CampaignComparison(
        names,
        (a, b),
        pairs,
        list(_rates(pairs)),
        columns,
        skipped,
        sorted(_changed(pairs), key=lambda each: not each.is_worse),
        [
            VerdictChange(name, verdict, b.accepted[name])
            for name, verdict in a.accepted.items()
            if name in b.accepted
        ],
        list(_worst(pairs, names)),
    )


def _rates(pairs: Pairs) -> Iterator[Rate]:
    yield _rate(ALL, [(one.passed, other.passed) for one, other in pairs.found])
    for name in _names(pairs, "criteria"):
        yield _rate(
            name,
            [
                (one.criteria[name], other.criteria[name])
                for one, other in pairs.found
                if name in one.criteria and name in other.criteria
            ],
        )


def _rate(name: str, verdicts: Sequence[tuple[bool, bool]]) -> Rate:
    count = len(verdicts)
    both, lost = verdicts.count((True, True)), verdicts.count((True, False))
    gained, neither = verdicts.count((False, True)), verdicts.count((False, False))
    difference, low, high = rate_difference(both, lost, gained, neither)
    of_a, of_b = (both + lost) / count, (both + gained) / count
    return Rate(name, count, of_a, of_b, difference, low, high, mcnemar(lost, gained), lost, gained)


def _names(pairs: Pairs, of: str) -> list[str]:
    """Return the criteria, or the columns, that some pair has on both sides, in their order."""
    return list(
        dict.fromkeys(
            name
            for one, other in pairs.found
            for name in getattr(one, of)
            if name in getattr(other, of)
        )
    )


def _columns(
    pairs: Pairs, a: Outcomes, b: Outcomes, names: tuple[str, str]
) -> tuple[list[ColumnDifference], dict[str, str]]:
    columns, skipped = [], {}
    for name in _names(pairs, "values"):
        units = a.units.get(name, set()) | b.units.get(name, set())
        if len(units) > 1:
            skipped[name] = f"its values are in {' and '.join(sorted(units))}"
            continue
        found = [
            (one.values[name], other.values[name])
            for one, other in pairs.found
            if name in one.values and name in other.values
        ]
        of_a, of_b = ([row[side] for row in found] for side in (0, 1))
        mean_a, mean_b = math.fsum(of_a) / len(of_a), math.fsum(of_b) / len(of_b)
        unit = next(iter(units), "")
        columns.append(
            ColumnDifference(name, unit, len(found), mean_a, mean_b, *mean_difference(of_a, of_b))
        )
    for cases, other, campaign in ((a, b, names[0]), (b, a, names[1])):
        has = {name for case in cases.cases for name in case.values}
        lacks = has - {name for case in other.cases for name in case.values}
        skipped.update(dict.fromkeys(sorted(lacks), f"only {campaign} has it"))
    return columns, skipped


def _changed(pairs: Pairs) -> Iterator[VerdictChange]:
    for one, other in pairs.found:
        if one.passed != other.passed:
            criteria = [
                name
                for name, passed in one.criteria.items()
                if other.criteria.get(name, passed) != passed
            ]
            said = ["pass" if case.passed else "fail" for case in (one, other)]
            yield VerdictChange(
                pairs.name(one), said[0], said[1], ", ".join(criteria), one.number, other.number
            )


def _worst(pairs: Pairs, names: tuple[str, str]) -> Iterator[Worst]:
    for criterion in _names(pairs, "criteria"):
        column = f"robustness of {criterion}"
        found = [p for p in pairs.found if all(column in case.values for case in p)]
        if not found:
            continue
        robustness = [[case.values[column] for case in pair] for pair in found]
        worst = [found[int(place)] for place in np.argmin(robustness, axis=0)]
        is_same = worst[0] is worst[1]
        for name, (one, other) in zip(("both",) if is_same else names, worst, strict=False):
            yield Worst(
                criterion, name, pairs.name(one), one.number, other.number,
                one.values[column], other.values[column],
            )  # fmt: skip


def _changes(comparison: CampaignComparison) -> Shown:
    """Return the settings, and the files, that are not the same for all cases."""
    a, b = comparison.outcomes
    rows = [[key, setting_text(x), setting_text(y)] for key, x, y in comparison.pairs.changed]
    for name in dict.fromkeys([*a.files, *b.files]):
        one, other = a.files.get(name), b.files.get(name)
        if one != other:
            rows.append([name, *(_short(each) for each in (one, other))])
    return Shown("Set differently", ["setting or file", *comparison.names], rows)


def _short(content: str | None) -> str:
    """Return the beginning of a hash, or a version; a dash where the file is missing."""
    return "–" if content is None else content[:12]


def _percent(share: float) -> str:
    return number(100.0 * share, 3)
