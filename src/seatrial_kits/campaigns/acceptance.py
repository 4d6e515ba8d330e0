"""Acceptance: what the cases of a campaign together say of a probability, a mean or a quantile.

Of a limit and a confidence 1 - alpha each criterion has a one-sided bound on either side. It passes
if the bound that is worse for it keeps the limit, it fails if the better one does not, and is
undecided between: a wrong verdict has a probability of at most alpha.

- Probability of failure, k of n cases: Clopper and Pearson [Clopper1934], exact for any n. Where
  the campaign may end at any case (``until.decided``), a confidence sequence by a uniform mixture
  ([Robbins1970]): with probability 1 - alpha no n at all has B(k + 1, n - k + 1) above p^k (1 -
  p)^(n - k) / alpha at the true p, so that looking after every case costs nothing.
- Mean: Student's t, exact of normal values, of many cases of others.
- Quantile: order statistics, whose counts are binomial; exact of any continuous distribution.
"""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any, Literal, cast

import numpy as np

from seatrial.errors import InputError, unknown
from seatrial.model.readable import number, quantity_text
from seatrial.model.units import quantity
from seatrial.system.files import FileModel

Outcome = Literal["pass", "fail", "undecided"]
What = Literal["failure", "success", "mean", "quantile"]
_CHECK = re.compile(
    r"(?P<what>probability of (?:failure|success)|mean|quantile\s+(?P<share>[\d.]+\s*%?))"
    r'(?:\s+of\s+"(?P<of>[^"]+)")?\s*(?P<sign><=|>=|<|>)\s*(?P<limit>.+?)'
    r"(?:\s+at\s+(?P<confidence>[\d.]+\s*%?))?\s*"
)
_FORMS = (
    "'probability of failure < 10 % at 95 %', 'probability of success of \"NAME\" > 90 %', "
    "'mean of \"worst of NAME\" < 3 deg', 'quantile 95 % of \"COLUMN\" < 5 m'"
)
_USUAL = 0.95
_PREFIX = re.compile("^(?:worst|robustness) of ")


class AcceptanceEntry(FileModel):
    """A criterion of a whole campaign."""

    name: str
    check: str


@dataclass(frozen=True)
class Acceptance:
    """A criterion of a whole campaign, read."""

    name: str
    check: str
    what: What
    column: str
    """A criterion of probabilities, a column of the table of means and quantiles; empty: cases."""
    is_below: bool
    limit: str
    confidence: float
    share: float = 0.0
    """Of a quantile."""

    @property
    def is_of_failure(self) -> bool:
        """Whether the number of failed cases decides it."""
        return self.what in ("failure", "success") and not self.column

    def highest(self) -> float:
        """Return the limit of the probability of failure: p must be below it, or above."""
        limit = quantity(self.limit, "1")
        return limit if self.what == "failure" else 1.0 - limit

    def of_failures(self, failed: int, count: int, *, at_any_case: bool) -> Outcome:
        """Return the verdict of the first ``count`` cases, of which some have ``failed``."""
        must_be_below = self.is_below == (self.what == "failure")
        limit = self.highest()
        if not at_any_case:
            low, high = failure_bounds(failed, count, self.confidence)
            return outcome(low, high, limit, is_below=must_be_below)
        if not count or log_mixture(failed, count, limit) <= -math.log(1.0 - self.confidence):
            return "undecided"
        return "pass" if (failed / count < limit) == must_be_below else "fail"


@dataclass(frozen=True)
class Accepted:
    """What became of a criterion of a campaign."""

    name: str
    check: str
    verdict: Outcome
    detail: str

    def content(self) -> dict[str, Any]:
        """Return it as JSON has it."""
        return asdict(self)


def read_acceptance(entry: AcceptanceEntry, where: str) -> Acceptance:
    """Return what a criterion of a campaign asks. Raises InputError for what is none."""
    found = _CHECK.fullmatch(entry.check)
    origin = f"{where}: criteria: {entry.name}: {entry.check!r}"
    if found is None:
        raise InputError(f"{origin} is none of the forms {_FORMS}")
    words, of = found["what"].split(), found["of"] or ""
    what = words[-1] if words[0] == "probability" else words[0]
    if what in ("mean", "quantile") and not of:
        raise InputError(f'{origin}: a column is needed: {what} of "COLUMN"')
    try:
        confidence = quantity(found["confidence"], "1") if found["confidence"] else _USUAL
        share = quantity(found["share"], "1") if found["share"] else 0.0
        if what in ("failure", "success"):
            _require_share("the limit", quantity(found["limit"], "1"))
        _require_share("the confidence", confidence)
        if what == "quantile":
            _require_share("the quantile", share)
    except InputError as error:
        raise InputError(f"{origin}: {error}") from None
    is_below = found["sign"] in ("<", "<=")
    kind, limit = cast(What, what), str(found["limit"])
    return Acceptance(entry.name, entry.check, kind, of, is_below, limit, confidence, share)


def _require_share(what: str, value: float) -> None:
    if not 0.0 < value < 1.0:
        raise InputError(f"{what} must lie between 0 and 100 %, found {number(100 * value)} %")


def outcome(low: float, high: float, limit: float, *, is_below: bool) -> Outcome:
    """Return the verdict of bounds against a limit that the value has to be below, or above."""
    good, bad = (high <= limit, low >= limit) if is_below else (low >= limit, high <= limit)
    return "pass" if good else "fail" if bad else "undecided"


def failure_bounds(
    failed: int, count: int, confidence: float, *, at_any_case: bool = False
) -> tuple[float, float]:
    """Return one-sided bounds of the probability of failure, each of that confidence.

    With ``at_any_case`` they hold for all counts at once; see the module.
    """
    from scipy.stats import beta  # half a second, of every command if it stood above

    alpha, passed = 1.0 - confidence, count - failed
    if at_any_case:
        return _sequence(failed, count, alpha)
    low = float(beta.ppf(alpha, failed, passed + 1)) if failed else 0.0
    high = float(beta.ppf(confidence, failed + 1, passed)) if passed else 1.0
    return low, high


def log_mixture(failed: Any, count: Any, p: Any) -> Any:
    """Return the logarithm of the likelihood of a uniform mixture over that of p.

    At the true p it is a martingale of mean 1: it exceeds 1 / alpha at any count with a probability
    of at most alpha (Ville).
    """
    from scipy.special import betaln, xlog1py, xlogy

    passed = count - failed
    return betaln(failed + 1, passed + 1) - xlogy(failed, p) - xlog1py(passed, -p)


def _sequence(failed: int, count: int, alpha: float) -> tuple[float, float]:
    from scipy.optimize import brentq

    if not count:
        return 0.0, 1.0
    best, tiny = failed / count, 1e-15

    def beyond(p: float) -> float:
        return float(log_mixture(failed, count, p)) + math.log(alpha)

    low = brentq(beyond, tiny, best) if failed and beyond(tiny) > 0 else 0.0
    high = brentq(beyond, best, 1 - tiny) if failed < count and beyond(1 - tiny) > 0 else 1.0
    return float(low), float(high)


def mean_bounds(values: Sequence[float], confidence: float) -> tuple[float, float]:
    """Return one-sided bounds of a mean, each of that confidence; infinite of a single value."""
    from scipy.stats import t

    if len(values) < 2:
        return -math.inf, math.inf
    half = float(t.ppf(confidence, len(values) - 1)) * float(np.std(values, ddof=1))
    half /= math.sqrt(len(values))
    return float(np.mean(values)) - half, float(np.mean(values)) + half


def quantile_bounds(
    values: Sequence[float], share: float, confidence: float
) -> tuple[float, float]:
    """Return one-sided bounds of a quantile, each of that confidence; infinite of too few."""
    from scipy.stats import binom

    ordered, count = np.sort(values), len(values)
    # x_(j) is above the quantile if fewer than j values are below that.
    above = int(binom.ppf(confidence, count, share)) + 1
    below = int(binom.ppf(1.0 - confidence, count, share))
    low = float(ordered[below - 1]) if below >= 1 else -math.inf
    high = float(ordered[above - 1]) if above <= count else math.inf
    return low, high


def check_columns(criteria: Iterable[Acceptance], columns: Collection[str]) -> None:
    """Raise InputError for a criterion of a column that a table has not."""
    for each in criteria:
        if each.column and each.column not in columns:
            raise InputError(f"criteria: {each.name}: {unknown('column', each.column, columns)}")


def accepted(
    criteria: Iterable[Acceptance],
    rows: Sequence[Mapping[str, Any]],
    trials: Mapping[str, Collection[str]],
    *,
    at_any_case: bool = False,
) -> list[Accepted]:
    """Return what becomes of criteria on the rows of a table.

    ``trials`` are, by criterion of a trial, the trials that have it: the cases of others say
    nothing of it. Raises InputError as `_column` does.
    """
    found = []
    for each in criteria:
        having = trials.get(_PREFIX.sub("", each.column))
        of_them = rows if having is None else [row for row in rows if row["trial"] in having]
        found.append(_accepted(each, of_them, at_any_case))
    return found


def _accepted(
    criterion: Acceptance, rows: Sequence[Mapping[str, Any]], at_any_case: bool
) -> Accepted:
    if criterion.what in ("failure", "success"):
        column = criterion.column or "passed"
        failed = sum(row[column] is not True for row in rows)
        any_case = at_any_case and criterion.is_of_failure
        found = criterion.of_failures(failed, len(rows), at_any_case=any_case)
        low, high = failure_bounds(failed, len(rows), criterion.confidence, at_any_case=any_case)
        kept = failed if criterion.what == "failure" else len(rows) - failed
        if criterion.what == "success":
            low, high = 1.0 - high, 1.0 - low
        text = f"{kept} of {len(rows)}, {_percent(low)} to {_percent(high)} %"
    else:
        values, unit = _column(criterion, rows)
        lacking = len(rows) - len(values)
        low, high = (
            mean_bounds(values, criterion.confidence)
            if criterion.what == "mean"
            else quantile_bounds(values, criterion.share, criterion.confidence)
        )
        limit = quantity(criterion.limit, unit) if values else math.nan  # no value, no unit
        found = outcome(low, high, limit, is_below=criterion.is_below)
        text = f"{quantity_text(low, unit, 4)} to {quantity_text(high, unit, 4)}"
        if lacking:
            found, text = "undecided", f"{text}; {lacking} cases have no value"
    detail = f"{text}, each bound at {_percent(criterion.confidence)} %"
    return Accepted(criterion.name, criterion.check, found, detail)


def _column(criterion: Acceptance, rows: Sequence[Mapping[str, Any]]) -> tuple[list[float], str]:
    """Return the values of a column and their unit. Raises InputError for several units."""
    values = [row[criterion.column] for row in rows]
    known = [float(v) for v in values if isinstance(v, (int, float)) and math.isfinite(v)]
    key = f"unit of {criterion.column.removeprefix('worst of ')}"
    units = {row[key] for row in rows if row.get(key)} if key in (rows[0] if rows else ()) else {""}
    if len(units) > 1:
        raise InputError(f"criteria: {criterion.name}: values are in {' and '.join(sorted(units))}")
    return known, next(iter(units), "") or "1"


def _percent(share: float) -> str:
    return number(100.0 * share, 4)
