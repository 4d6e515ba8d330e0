"""Distributions as a campaign file says them: ``{ normal = ["22 kg", "1 kg"] }``."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from pydantic import Field

from seatrial.errors import InputError
from seatrial.model.units import conversion
from seatrial.system.files import FileModel

Written = str | float | int
_CONTINUOUS = (
    "normal", "uniform", "lognormal", "triangular", "weibull", "rayleigh", "exponential"
)  # fmt: skip
_FORMS = (*_CONTINUOUS, "bins", "integers", "levels", "spaced")
_DIGITS = 12
"""Of a level between two others: 0.3, not 0.30000000000000004."""
_PARTS = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(\S.*?)?\s*$")


class Distribution(FileModel):
    """One of the forms, and for the numbers limits to cut it at."""

    normal: list[Written] | None = Field(default=None, min_length=2, max_length=2)
    uniform: list[Written] | None = Field(default=None, min_length=2, max_length=2)
    lognormal: list[Written] | None = Field(default=None, min_length=2, max_length=2)
    triangular: list[Written] | None = Field(default=None, min_length=3, max_length=3)
    weibull: list[Written] | None = Field(default=None, min_length=2, max_length=2)
    rayleigh: Written | None = None
    exponential: Written | None = None
    bins: list[Written] | None = Field(default=None, min_length=2)
    """Limits of bins, of which ``weights`` says how often each is drawn: a histogram."""
    integers: list[int] | None = Field(default=None, min_length=2, max_length=2)
    levels: list[Any] | None = Field(default=None, min_length=1)
    weights: list[float] | None = None
    """How often each of ``levels`` or ``bins`` is drawn, in proportion; levels alike without."""
    spaced: list[Written] | None = Field(default=None, min_length=3, max_length=3)
    between: list[Written] | None = Field(default=None, min_length=2, max_length=2)


@dataclass(frozen=True)
class Law:
    """A distribution that has been read."""

    quantiles: Callable[[np.ndarray], np.ndarray]
    """Inverse of the cumulative distribution: probabilities in (0, 1) to numbers."""
    unit: str = ""
    """Of the numbers; empty if none was written."""
    is_whole: bool = False
    """Numbers are whole: seeds, places among ``levels``."""
    levels: Sequence[Any] = ()
    """All values there are, if numbers are places among them."""
    edges: np.ndarray = field(default_factory=lambda: np.empty(0))
    """Limits of the bins of a histogram."""

    def settings(self, numbers: np.ndarray) -> list[Any]:
        """Return numbers as a campaign sets them: text with the unit, if there is one."""
        if self.is_whole:
            whole = [int(number) for number in numbers.tolist()]
            return [self.levels[place] for place in whole] if self.levels else whole
        return [f"{n!r} {self.unit}" if self.unit else n for n in numbers.tolist()]

    def drawn(self, probabilities: np.ndarray) -> list[Any]:
        """Return the settings at probabilities in (0, 1)."""
        return self.settings(self.quantiles(probabilities))


def read_distribution(entry: Distribution, origin: str) -> Law:
    """Return the distribution that a file says.

    normal: mean, standard deviation; lognormal: those of the quantity itself, not of its logarithm;
    uniform: low, high; triangular: low, mode, high; weibull: scale, shape; rayleigh and
    exponential: mean; bins: limits of bins, one is drawn by ``weights``, uniform inside it;
    integers: first, last, all alike; levels and spaced: as `levels_of` returns them, all alike or
    by ``weights``. ``between`` cuts off what is outside of a
    continuous one. Settings are text in the unit that the first number has, or numbers if none has
    a unit. Raises InputError.
    """
    form = _form(entry, origin)
    here = f"{origin}: {form}"
    written = getattr(entry, form)
    if entry.weights is not None and form not in ("levels", "bins"):
        raise InputError(f"{origin}: weights: they go with levels or bins, not with {form}")
    if form == "bins":
        return _histogram(entry, origin)
    if form not in _CONTINUOUS:
        return _one_of(levels_of(entry, origin), entry.weights, f"{origin}: weights")
    written = written if isinstance(written, list) else [written]
    own, shape = (written[:1], written[1:]) if form == "weibull" else (written, [])
    numbers, unit = _numbers([*own, *(entry.between or [])], form == "normal", here)
    law = _law(form, [*numbers[: len(own)], *_numbers(shape or [1], False, here)[0]], here)
    low, high = 0.0, 1.0
    if entry.between:
        first, last = numbers[len(own) :]
        low, high = float(law.cdf(first)), float(law.cdf(last))
        if not high > low:
            raise InputError(f"{origin}: between: nothing of it lies there, found {entry.between}")

    def quantiles(probability: np.ndarray) -> np.ndarray:
        values = np.asarray(law.ppf(low + (high - low) * probability))
        return np.clip(values, first, last) if entry.between else values

    return Law(quantiles, unit)


def levels_of(entry: Distribution, origin: str) -> Sequence[Any]:
    """Return all values of a distribution that has but some, in the order written.

    levels: any values; spaced: so many numbers from low to high, both among them, in equal steps;
    integers: first to last. Raises InputError for the continuous forms.
    """
    form = _form(entry, origin)
    here, written = f"{origin}: {form}", getattr(entry, form)
    if form not in ("integers", "levels", "spaced"):
        raise InputError(f"{here}: levels, spaced or integers are needed here")
    if entry.between:
        raise InputError(f"{origin}: between: it cuts continuous distributions, not {form}")
    if form == "levels":
        if len({repr(value) for value in written}) < len(written):
            raise InputError(f"{here}: each level once, found {written}")
        return list(written)
    if form == "integers":
        _needed(written[0] <= written[1], "first up to last", here, written)
        return range(written[0], written[1] + 1)
    *ends, count = written
    (low, high), unit = _numbers(ends, False, here)
    whole = isinstance(count, int) and count >= 2
    _needed(whole and low < high, "low below high, and how many from 2 on", here, written)
    values = (float(f"{v:.{_DIGITS}g}") for v in np.linspace(low, high, int(count)))
    return [f"{value!r} {unit}" if unit else value for value in values]


def drawn_cells(weights: np.ndarray, probabilities: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the cells at probabilities, drawn by weight, and the share of the way through each."""
    last = int(np.flatnonzero(weights)[-1])
    ends = np.cumsum(weights) / np.sum(weights)
    cells = np.minimum(np.searchsorted(ends[:-1], probabilities, side="right"), last)
    begins, sizes = np.append(0.0, ends)[cells], np.asarray(weights)[cells] / np.sum(weights)
    return cells, np.clip((probabilities - begins) / sizes, 0.0, 1.0)


def number_and_unit(text: str) -> tuple[float, str | None]:
    """Return number and unit, perhaps empty, of a quantity; the unit None for other text."""
    part = _PARTS.match(text)
    return (math.nan, None) if part is None else (float(part[1]), part[2] or "")


def _histogram(entry: Distribution, origin: str) -> Law:
    """Return the distribution of bins with weights: piecewise uniform."""
    here, written, weights = f"{origin}: bins", entry.bins or [], entry.weights
    if entry.between:
        raise InputError(f"{origin}: between: it cuts other distributions, not bins")
    numbers, unit = _numbers(written, False, here)
    edges = np.array(numbers)
    _needed(bool((np.diff(edges) > 0.0).all()), "limits in increasing order", here, written)
    _needed(weights is not None, f"weights = [...], {len(edges) - 1} of them,", here, written)
    _check_weights(weights or [], len(edges) - 1, f"{origin}: weights")
    shares = np.array(weights)

    def quantiles(probability: np.ndarray) -> np.ndarray:
        cells, within = drawn_cells(shares, probability)
        result: np.ndarray = edges[cells] + np.diff(edges)[cells] * within
        return result

    return Law(quantiles, unit, edges=edges)


def _check_weights(weights: list[float], count: int, where: str) -> None:
    is_right = len(weights) == count and sum(weights) > 0.0
    is_right &= all(weight >= 0.0 and math.isfinite(weight) for weight in weights)
    _needed(is_right, f"{count} numbers from 0 on, not all 0,", where, weights)


def _one_of(levels: Sequence[Any], weights: list[float] | None, where: str) -> Law:
    first, last = (levels[0], levels[-1]) if isinstance(levels, range) else (0, len(levels) - 1)
    named = () if isinstance(levels, range) else levels
    if weights is not None:
        _check_weights(weights, len(levels), where)
        ends = np.cumsum(weights) / sum(weights)
        return Law(lambda p: np.searchsorted(ends[:-1], p, side="right"), "", True, named)
    return Law(lambda p: first + np.floor(p * (last - first + 1)), "", True, named)


def _form(entry: Distribution, origin: str) -> str:
    """Return the one form that is given."""
    given = [form for form in _FORMS if getattr(entry, form) is not None]
    if len(given) != 1:
        found = ", ".join(given) or "none"
        raise InputError(f"{origin}: exactly one of {', '.join(_FORMS)} is needed, found {found}")
    return given[0]


def _numbers(written: list[Written], spread: bool, here: str) -> tuple[list[float], str]:
    """Return the numbers in the unit of the first; a spread has no offset (1 degC is 1 K)."""
    parts = [_PARTS.match(str(each)) for each in written]
    for each, part in zip(written, parts, strict=True):
        if isinstance(each, bool) or part is None:
            raise InputError(f"{here}: {each!r} is not a number, or a quantity such as '22 kg'")
    split = [(float(part[1]), part[2] or "") for part in parts if part]
    unit = split[0][1]
    if any(bool(own) != bool(unit) for _, own in split):
        raise InputError(f"{here}: all numbers with a unit, or none, found {written}")
    numbers = []
    for i, (number, own) in enumerate(split):
        try:
            factor, offset = conversion(own or "1", unit or "1")
        except InputError as error:
            raise InputError(f"{here}: {error}") from None
        numbers.append(number * factor + (0.0 if spread and i == 1 else offset))
    if not all(map(math.isfinite, numbers)):
        raise InputError(f"{here}: finite numbers are needed, found {written}")
    return numbers, unit


@dataclass(frozen=True)
class _Scaled:
    """A standard distribution that is stretched and moved."""

    location: float
    scale: float
    quantile: Callable[[np.ndarray], np.ndarray]
    probability: Callable[[float], Any]

    def ppf(self, probability: np.ndarray) -> np.ndarray:
        """Return the values below which it is with these probabilities."""
        return self.quantile(probability) * self.scale + self.location

    def cdf(self, value: float) -> Any:
        """Return the probability to be below a value."""
        return self.probability((value - self.location) / self.scale)


def _law(form: str, numbers: list[float], here: str) -> Any:
    """Return a form's ``ppf`` and ``cdf``, with the bits of SciPy's."""
    a, b = numbers[:2]
    if form == "uniform":
        _needed(b > a, "low below high", here, numbers)
        return _Scaled(a, b - a, lambda p: p, lambda x: np.clip(x, 0.0, 1.0))
    if form == "normal":
        from scipy import special  # dear to import, and no other command needs it

        _needed(b > 0.0, "a positive standard deviation", here, numbers)
        return _Scaled(a, b, special.ndtri, special.ndtr)
    from scipy import stats  # half a second more

    if form == "triangular":
        high = numbers[2]
        _needed(a <= b <= high and a < high, "low, mode, high in that order", here, numbers)
        return stats.triang((b - a) / (high - a), a, high - a)
    if form in ("weibull", "rayleigh", "exponential"):
        _needed(a > 0.0 and b > 0.0, "positive numbers", here, numbers)
        laws = {
            "weibull": stats.weibull_min(b, scale=a),
            "rayleigh": stats.rayleigh(scale=a * math.sqrt(2.0 / math.pi)),
            "exponential": stats.expon(scale=a),
        }
        return laws[form]
    _needed(b > 0.0, "a positive standard deviation", here, numbers)
    _needed(a > 0.0, "a positive mean", here, numbers)
    spread = math.sqrt(math.log1p((b / a) ** 2))  # of the logarithm
    return stats.lognorm(spread, scale=a * math.exp(-(spread**2) / 2.0))


def _needed(met: bool, what: str, here: str, found: Sequence[Any]) -> None:
    if not met:
        raise InputError(f"{here}: {what} is needed, found {found}")
