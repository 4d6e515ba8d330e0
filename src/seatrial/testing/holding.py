"""``assert_holds``: a condition on recorded signals, and a message that shows where it breaks."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from ..api.written import as_duration
from ..errors import InputError
from ..system.rig import duration_ns
from ..trial.criteria.course import Course, course
from ..trial.criteria.criteria import Criterion, parse
from ..trial.criteria.expressions import FloatArray
from .text_plot import plot

During = tuple[float | str, float | str] | float | str | None
"""From and to, or from; s or text, as ``("4 s", "12 s")``."""

_HALF_NS = 0.5e-9


def hold_or_fail(
    condition: str,
    during: During,
    time: FloatArray,
    signals: Mapping[str, Any],
    units: Mapping[str, str],
    where: str,
    path: Callable[[str], str],
) -> None:
    """Raise AssertionError, with a plot, for a condition that does not hold; InputError.

    ``path`` returns the name as it is recorded of one that a rig shows.
    """
    __tracebackhide__ = True
    criterion = parse(condition)
    criterion = criterion.renamed({name: path(name) for name in criterion.signals})
    criterion.check_units(units)
    rows = _rows(time, during)
    chosen = {
        name: [value for value, inside in zip(signals[name], rows, strict=True) if inside]
        if "text" in kinds
        else np.asarray(signals[name])[rows]
        for name, kinds in criterion.kinds.items()
    }
    verdict = criterion.evaluate(time[rows], chosen, units)
    if not verdict.passed:
        found = course(criterion, time[rows], chosen, units)
        raise AssertionError(failure(condition, verdict.detail, found, where))


def failure(condition: str, detail: str, found: Course | None, where: str) -> str:
    """Return what a person should see of a condition that does not hold."""
    lines = [f"{condition}: does not hold in {where}", f"  {detail}"]
    if found is not None:
        lines += ["", *(f"  {line}" for line in plot(found))]
    return "\n".join(lines)


def failure_of(criterion: Criterion, detail: str, signals: Any, where: str) -> str:
    """Return the same of a criterion of a trial that was recorded."""
    try:
        time = np.asarray(signals.t)
        chosen = {name: signals[name] for name in criterion.signals}
        units = {name: chosen[name].unit for name in chosen}
        found = course(criterion, time, chosen, units)
    except (InputError, KeyError):
        found = None  # it is not recorded
    return failure(criterion.text, detail, found, where)


def _rows(time: FloatArray, during: During) -> Any:
    if during is None:
        return np.ones(len(time), dtype=bool)
    first, last = during if isinstance(during, tuple) else (during, None)
    rows = time >= _seconds(first) - _HALF_NS
    if last is not None:
        rows &= time <= _seconds(last) + _HALF_NS
    return rows


def _seconds(written: float | str) -> float:
    return duration_ns(str(as_duration(written)), "during") / 1e9
