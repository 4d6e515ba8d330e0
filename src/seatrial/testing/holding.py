"""``assert_holds``: a condition on recorded signals, and a message that shows where it breaks."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from ..api.written import as_duration
from ..errors import InputError
from ..model.readable import number
from ..system.rig import duration_ns
from ..trial.criteria.course import Course, course
from ..trial.criteria.criteria import Criterion, parse
from ..trial.criteria.expressions import FloatArray

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


WIDTH, HEIGHT = 64, 9
_SHARE = 0.1
"""Part of the record before the limit is broken and after the moment."""
_LEAST_ROWS = 8


def plot(of: Course) -> list[str]:
    """Return the lines of a plot: ``*`` the signal, ``-`` its limit, ``^`` the moment."""
    reach = max(int(_SHARE * len(of.time)), _LEAST_ROWS)
    rows = slice(max(of.first - reach, 0), of.row + reach + 1)
    time, values, bound = of.time[rows], of.values[rows], of.bound[rows]
    finite = np.isfinite(values)
    if not finite.any():
        return []
    both = np.concatenate([values[finite], bound[np.isfinite(bound)]])
    low, high = float(both.min()), float(both.max())
    if high == low:
        low, high = low - 1.0, high + 1.0
    canvas = [[" "] * WIDTH for _ in range(HEIGHT)]
    span = float(time[-1] - time[0]) or 1.0
    # Of many rows in a column the farthest from the limit is drawn, of few all columns between.
    columns = np.minimum(((time - time[0]) / span * WIDTH).astype(int), WIDTH - 1)
    for mark, line_of in (("-", bound), ("*", values)):
        for column in range(WIDTH):
            inside = columns == column
            at = time[0] + (column + 0.5) / WIDTH * span
            drawn = line_of[inside] if inside.any() else np.array([np.interp(at, time, line_of)])
            for value in (np.min(drawn), np.max(drawn)):
                if np.isfinite(value):
                    line = round((high - float(value)) / (high - low) * (HEIGHT - 1))
                    canvas[line][column] = mark
    labels = [number(high), *[""] * (HEIGHT - 2), number(low)]
    width = max(map(len, labels))
    moment = int(columns[min(of.row - rows.start, len(columns) - 1)])
    unit = f", {of.unit}" if of.unit not in ("", "1") else ""
    axis = f"{number(time[0], 6)} s".ljust(WIDTH - 12) + f"{number(time[-1], 6)} s".rjust(12)
    return [
        f"{of.name}{unit} (*), limit (-), {number(of.time[of.row], 6)} s (^)",
        *(f"{label:>{width}} |{''.join(line)}" for label, line in zip(labels, canvas, strict=True)),
        f"{'':>{width}} +{'-' * moment}^{'-' * (WIDTH - moment - 1)}",
        f"{'':>{width}}  {axis}",
    ]
